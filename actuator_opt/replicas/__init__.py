"""Three papers re-created: published values beside ours, for designs of the papers' cylinders.

The published values are data with their place in the paper (``notes/``). Everything else in these
tables is computed when the report is made: the paper's own formula (`*_as_published`) with the
paper's numbers, and this project's models on the design.

No module imports this package. Reports load it by name, and the wheel does not contain it.
"""

from __future__ import annotations

from importlib import import_module

from ..evaluation import Evaluation
from ..rendering.blocks import Block

MODULES = {"ElAsswad2018": "elasswad", "AaltoThesis": "aalto", "Huang2017": "huang"}
"""The module of each paper that `Design.reproduces` can name."""


def published(evaluation: Evaluation) -> list[Block]:
    """Tables and drawings of the paper that a design reproduces; none for other designs."""
    paper = evaluation.design.reproduces
    if paper is None:
        return []
    blocks: list[Block] = import_module(f".{MODULES[paper]}", __name__).blocks(evaluation)
    return blocks
