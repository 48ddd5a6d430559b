"""Pages of reports as data, rendered as PDF and PNG, as HTML, or as text for the terminal."""

from __future__ import annotations

from ..rendering.attachments import Attachment, read_attachment
from ..rendering.blocks import ReportFile, Table

__all__ = ["Attachment", "ReportFile", "Table", "read_attachment"]
