"""The terminal: read arguments, call the library, print. No physics."""

from .app import app, main

__all__ = ["app", "main"]
