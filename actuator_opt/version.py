"""The version of the program, in a module that every other module may import."""

from __future__ import annotations

VERSION = "0.6.0"
