"""Sizes a seal type can have beside section and squeeze: their keys in a design file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from ..base.numeric import Array


class Size(NamedTuple):
    """A size of a seal, a key of the design file.

    Parameters
    ----------
    key : in the design file
    quantity : name of its `quantities.INPUTS`
    help : its meaning, for the JSON Schema
    example : a good value, for messages
    """

    key: str
    quantity: str
    help: str
    example: str


class SizeField(NamedTuple):
    """A size that a seal type has.

    Parameters
    ----------
    size : the size
    default : its value where the design states none, of the numbers before it (SI), among them
        `section` and `gland_depth`; None where the design must state it
    """

    size: Size
    default: Callable[[Mapping[str, Array]], Array] | None

    @property
    def key(self) -> str:
        """Key in the design file."""
        return self.size.key


THICKNESS = Size(
    "thickness", "part_length", "radial thickness of a step ring, or of a lip at its root", "1.5 mm"
)
WIDTH = Size(
    "width",
    "part_length",
    "axial width of a step ring or compact seal, or length of a lip",
    "4 mm",
)
GROOVE_WIDTH = Size(
    "groove_width",
    "groove_width",
    "axial width of the groove; default: the standard gland",
    "6.3 mm",
)
LAND = Size(
    "land",
    "part_length",
    "axial width of the face that touches without pressure; default: half of a step "
    "ring's width, all of a compact seal's; of a U-cup twice the radius of its rim, "
    "default a tenth of the lip's length",
    "2 mm",
)
RELIEF = Size(
    "relief",
    "length",
    "face of a step ring before its land, wetted by the pressure; default: half of what "
    "the land leaves",
    "1 mm",
)
TAPER = Size(
    "taper",
    "taper",
    "angle between the flanks of a step ring's land and its counterface; default: 6 deg",
    "6 deg",
)
ROOT_CLEARANCE = Size(
    "root_clearance",
    "length",
    "gap under a U-cup's lip where it leaves the body; default: its interference",
    "0.3 mm",
)
SHARED = (THICKNESS, WIDTH, GROOVE_WIDTH, LAND, RELIEF, TAPER, ROOT_CLEARANCE)
"""Sizes in the order of a design file; a type may have more of its own."""
