"""Dynamic requirements checked in time, each by an experiment of its own."""

from .verify import DYNAMIC, Row, Verification, verify

__all__ = ["DYNAMIC", "Row", "Verification", "verify"]
