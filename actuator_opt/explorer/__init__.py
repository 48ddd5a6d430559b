"""The explorer: show a stored sweep as an interactive offline page."""

from .page import ExplorerFile, design_beside, page, write_explorer

__all__ = ["ExplorerFile", "design_beside", "page", "write_explorer"]
