"""The explorer: a kept sweep as one page to look through, offline."""

from .page import ExplorerFile, design_beside, page, write_explorer

__all__ = ["ExplorerFile", "design_beside", "page", "write_explorer"]
