"""Published cases repeated: papers on designs and cases in time, published values beside ours.

The published values are data with their place in the paper (``notes/``). Everything else in these
tables is computed when the report is made: the paper's own formula (`*_as_published`) with the
paper's numbers, and this project's models on the design.

No module imports this package. Reports load it by name, and the wheel does not contain it.
"""

from __future__ import annotations

from importlib import import_module

from ..evaluation import Evaluation
from ..rendering.blocks import Block
from ..simulation import Simulation

MODULES = {"ElAsswad2018": "elasswad", "AaltoThesis": "aalto", "Huang2017": "huang"}
"""The module of each paper that `Design.reproduces` can name."""
CASES = {"Exudyn2022": "exudyn", "ExudynPress": "exudyn", "FOSSEE788": "fossee"}
"""The module of each case that `Scenario.reproduces` can name."""


def published(subject: Evaluation | Simulation) -> list[Block]:
    """Tables and drawings of the source that a design or scenario reproduces; none for others."""
    holder = subject.scenario if isinstance(subject, Simulation) else subject.design
    if holder.reproduces is None:
        return []
    module = (MODULES | CASES)[holder.reproduces]
    blocks: list[Block] = import_module(f".{module}", __name__).blocks(subject)
    return blocks
