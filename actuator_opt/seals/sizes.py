"""Sizes of seal types besides section and squeeze, as keys of a design file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from ..base.numeric import Array


class Size(NamedTuple):
    """A size of a seal, as a key of the design file.

    Parameters
    ----------
    key : key in the design file
    quantity : its name in `quantities.INPUTS`
    help : its meaning, for the JSON Schema
    example : valid value, for messages
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
    default : function of default value from the preceding numbers (SI), such as `section` and
        `gland_depth`; None if the design must state the size
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
    "axial width of the face in contact without pressure; default: half the width of a "
    "step ring, the whole width of a compact seal; for a U-cup twice its rim radius, "
    "default a tenth of the lip length",
    "2 mm",
)
RELIEF = Size(
    "relief",
    "length",
    "pressure-wetted face of a step ring in front of its land; default: half of the "
    "width outside the land",
    "1 mm",
)
TAPER = Size(
    "taper",
    "taper",
    "angle between the counterface and the tapers beside a step ring's land; default: 6 deg",
    "6 deg",
)
ROOT_CLEARANCE = Size(
    "root_clearance",
    "length",
    "gap under a U-cup's lip at the body; default: its interference",
    "0.3 mm",
)
SHARED = (THICKNESS, WIDTH, GROOVE_WIDTH, LAND, RELIEF, TAPER, ROOT_CLEARANCE)
"""Sizes in the order of a design file; a type may have further sizes."""
