"""Faults of a cylinder's type: what a second rod needs and excludes, and types without a model."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from ..base.errors import Fault
from ..base.quantities import length_text
from ..models.thread import minor_diameter
from .structure import FileView, Loc

_SECOND = "second_rod"
_TYPE = ("cylinder", "type")
_ONE_ROD = 'or write "cylinder.type: differential"'
UNMODELLED = ("plunger", "telescopic")
"""Types of a cylinder that a file may name, and that no model covers."""


def has_second_rod(view: FileView) -> bool:
    """Whether a rod passes through the cap, too."""
    return view.text(*_TYPE) == "double_rod"


def rod_size(
    view: FileView, end: Literal["head", "cap"], key: str = "outer_diameter"
) -> tuple[Loc, float | None]:
    """Location and number of a size of the rod that passes an end.

    What the block `second_rod` does not state is that of `rod`.
    """
    own = (_SECOND, key)
    loc: Loc = own if end == "cap" and view.has(*own) else ("rod", key)
    return loc, view.number(*loc)


def rod_ends(view: FileView) -> tuple[Literal["head", "cap"], ...]:
    """The ends that a rod passes."""
    return ("head", "cap") if has_second_rod(view) else ("head",)


def thickest_rod(view: FileView) -> float | None:
    """Diameter of the thickest rod; None if a diameter is unknown."""
    sizes = [rod_size(view, end)[1] for end in rod_ends(view)]
    known = [size for size in sizes if size is not None]
    return max(known) if len(known) == len(sizes) else None


def cylinder_type(view: FileView) -> Iterator[Fault]:
    """Refuse types without a model, and whatever does not fit the type."""
    name = view.text(*_TYPE)
    if name in UNMODELLED:
        yield Fault(
            _TYPE,
            f"{name}: no model of this package covers such a cylinder",
            'write "type: differential" or "type: double_rod"',
        )
    if name != "double_rod":
        if view.has(_SECOND):
            yield Fault(
                (_SECOND,),
                "only a double-rod cylinder has a second rod",
                'write "cylinder.type: double_rod", or remove the block',
                at_key=True,
            )
        return
    if view.text("cylinder", "mount") == "cap_clevis":
        yield Fault(
            ("cylinder", "mount"),
            "cap_clevis: a rod passes through the cap, which has no eye",
            "write mount: head_trunnion, head_flange or cap_flange",
        )
    yield from _excluded(view)
    yield from _sizes(view)
    yield from _nut(view)


_EXCLUDED: tuple[tuple[Loc, str], ...] = (
    (("sensor",), "the sensor would pass through the cap, where the second rod is"),
    (("cushion",), "cushions are not modelled with a second rod"),
    (("linkage",), "a linkage needs an eye at the cap, where the second rod is"),
    (("rod", "layup"), "a laminated rod is not modelled in a double-rod cylinder"),
    (("clevis", "neck"), "without effect: there is no eye at the cap, where the second rod is"),
)


def _excluded(view: FileView) -> Iterator[Fault]:
    """Refuse blocks that no model covers beside a second rod."""
    for loc, why in _EXCLUDED:
        if view.value(*loc):  # an empty list or a length of zero states nothing
            yield Fault(loc, why, f"remove {'.'.join(map(str, loc))}, {_ONE_ROD}", at_key=True)
    if view.text("stiffness", "topology") != "per_chamber":
        yield Fault(
            ("stiffness", "topology"),
            "the published formulas hold for one rod",
            'write "topology: per_chamber"',
        )
    for index in range(len(view.items("extra_masses"))):
        loc = ("extra_masses", index)
        if view.text(*loc, "place") == "cap" and view.number(*loc, "length"):
            yield Fault(
                (*loc, "length"),
                "no component fits between the cap and an eye, because a rod passes the cap",
                "remove the line",
                at_key=True,
            )


def _sizes(view: FileView) -> Iterator[Fault]:
    """Check that the second rod fits into the bore, and its own bore into it."""
    bore = view.number("cylinder", "bore")
    (loc, diameter), (inner_loc, inner) = (
        rod_size(view, "cap", key) for key in ("outer_diameter", "inner_diameter")
    )
    if diameter is None:
        return
    if bore is not None and loc[0] == _SECOND and diameter >= bore:
        yield Fault(
            loc,
            f"{length_text(diameter)}: must be smaller than cylinder.bore ({length_text(bore)})",
            f"write less than {length_text(bore)}",
        )
    if inner is not None and inner >= diameter and _SECOND in (loc[0], inner_loc[0]):
        yield Fault(
            inner_loc if inner_loc[0] == _SECOND else loc,
            f"the bore of the second rod, {length_text(inner)}, is not smaller than its diameter "
            f"({length_text(diameter)})",
            f"write second_rod.inner_diameter of less than {length_text(diameter)}, 0 if solid",
        )


def _nut(view: FileView) -> Iterator[Fault]:
    """Check that the nut of the piston passes over the second rod."""
    diameter, pitch = (view.number("piston", "nut", key) for key in ("diameter", "pitch"))
    loc, rod = rod_size(view, "cap")
    if diameter is None or pitch is None or rod is None:
        return
    hole = float(minor_diameter(diameter=diameter, pitch=pitch))
    if rod > hole and not view.has("variables", ".".join(map(str, loc))):
        yield Fault(
            ("piston", "nut"),
            f"its hole of {length_text(hole)} does not pass the second rod ({length_text(rod)}), "
            "over which it is set",
            f"write second_rod.outer_diameter of at most {length_text(hole)}, or remove the nut",
            at_key=True,
        )
