"""Moved: see `gland`."""

from __future__ import annotations

from .gland import groove_width as groove_width
