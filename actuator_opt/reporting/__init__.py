"""Reports: one page of data, drawn as PDF and PNG, or as text for the terminal."""

from __future__ import annotations

from .blocks import ExtraTable
from .writer import Attachment, ReportFile, read_attachment, write_report

__all__ = ["Attachment", "ExtraTable", "ReportFile", "read_attachment", "write_report"]
