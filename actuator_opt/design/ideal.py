"""A cylinder stated by its numbers instead of designed: a file of ten lines, for simulations.

The block `ideal` takes the place of all blocks that describe parts. The models need such blocks, so
`completed` adds a plain steel cylinder that no result shows: the plant of the simulation takes its
areas, volumes, mass, stiffness and leakage from `ideal`.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Annotated, Any

from ..base.errors import Diagnostic, Fault, InputError
from .kinds import Of, Section

_PARTS: Mapping[str, Any] = {
    "cylinder": {"bore": "40 mm", "stroke": "100 mm"},
    "barrel": {"layup": [{"material": "steel_e355", "thickness": "5 mm"}]},
    "rod": {"material": "steel_42crmo4", "outer_diameter": "22 mm"},
    "piston": {"material": "steel_42crmo4", "length": "30 mm", "clearance": "50 um"},
    "caps": {"material": "steel_42crmo4", "thickness": "10 mm"},
    "seals": {
        place: {"type": "o_ring", "compound": "nbr_90", "section": "3.53 mm", "squeeze": "12 %"}
        for place in ("piston", "rod")
    },
    "load_cases": [{"name": "none", "direction": "push", "force": "1 N", "speed": "0.1 m/s"}],
}
"""The cylinder that completes the file; its sizes are of no effect."""

_UNUSED = (
    *_PARTS, "second_rod", "head", "retention", "clevis", "sensor", "cushion", "extra_masses",
    "stiffness", "duty", "variables", "choices", "requirements", "waivers", "measured",
    "uncertainty", "objective",
)  # fmt: skip
"""Blocks that mean nothing beside `ideal`."""


class Ideal(Section):
    """A cylinder stated by its numbers, for a simulation; it has no parts.

    Walls are rigid, and seals have the friction that the scenario states.
    """

    area_a: Annotated[float, Of("piston_area", "area of the piston at side A, the cap side")]
    area_b: Annotated[float, Of("piston_area", "area of the piston at side B, the rod side")]
    stroke: Annotated[float, Of("stroke", "travel of the piston")]
    mass: Annotated[float, Of("load_mass", "moving mass without load.mass")]
    dead_volume_a: Annotated[float, Of("volume", "oil of side A at zero stroke")] = 0.0
    dead_volume_b: Annotated[float, Of("volume", "oil of side B at full stroke")] = 0.0
    stiffness: Annotated[
        float | None, Of("stiffness", "of rod and mount in series; default: rigid")
    ] = None
    leakage: Annotated[float, Of("conductance", "flow across the piston per pressure")] = 0.0
    closed_length: Annotated[
        float | None, Of("part_length", "from pin to pin at zero stroke; for a linkage")
    ] = None


def completed(tree: dict[str, Any]) -> tuple[dict[str, Any], list[Fault]]:
    """The tree of a file with the parts that it needs, and its blocks that mean nothing.

    Without a block `ideal`, the tree itself.
    """
    if not isinstance(tree.get("ideal"), dict):
        return tree, []
    faults = [
        Fault((name,), "has no effect: ideal states the cylinder", "remove it, or remove ideal",
              at_key=True)
        for name in _UNUSED
        if name in tree
    ]  # fmt: skip
    faults += _closed_length(tree)
    parts = copy.deepcopy(dict(_PARTS))
    if (stroke := tree["ideal"].get("stroke")) is not None:  # positions are checked against it
        parts["cylinder"]["stroke"] = stroke
    return parts | {key: value for key, value in tree.items() if key not in _UNUSED}, faults


def _closed_length(tree: Mapping[str, Any]) -> list[Fault]:
    """The fault of a linkage without the length of the cylinder, or of a length without linkage."""
    stated, linked = "closed_length" in tree["ideal"], "linkage" in tree
    if stated == linked:
        return []
    if stated:
        message, remedy = "has no effect without linkage", "remove it, or add linkage"
        return [Fault(("ideal", "closed_length"), message, remedy, at_key=True)]
    message = "closed_length: missing beside a linkage"
    return [Fault(("ideal",), message, 'add e.g. "closed_length: 300 mm", from pin to pin')]


def has_effect(path: str, stated: Ideal | None) -> bool:
    """Whether the number at a PATH can have an effect: not that of a part beside `ideal`."""
    return stated is None or path.partition(".")[0].partition("[")[0] not in _UNUSED


def require_parts(stated: Ideal | None) -> None:
    """Refuse a design that only states a cylinder where its parts are needed.

    Raises
    ------
    InputError : the design has a block `ideal`
    """
    if stated is not None:
        message = "the cylinder is stated, not designed: it has no parts to evaluate"
        remedy = "use simulate, or describe cylinder, barrel, rod, piston and seals"
        raise InputError(Diagnostic(message, remedy, path="ideal"))


def assumptions(stated: Ideal | None) -> list[str]:
    """A sentence on what a stated cylinder leaves out; empty for a designed one."""
    if stated is None:
        return []
    words = ["rigid walls", "seals without friction of their own"]
    words += ["a rigid rod"] if stated.stiffness is None else []
    words += [] if stated.leakage else ["no leakage across the piston"]
    words += [] if stated.dead_volume_a and stated.dead_volume_b else ["no dead volume"]
    return [f"The cylinder is stated by its numbers: it has {', '.join(words)}."]
