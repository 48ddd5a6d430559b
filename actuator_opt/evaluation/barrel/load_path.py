"""Axial force in the barrel wall: from mount, load direction, stop and tie rods.

The ends are never assumed open or closed. Tie rods clamp the barrel with their preload and carry
their share of the separating force. The default preload keeps the joint closed at proof pressure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.numeric import Array, maximum
from ...design.model import Design
from ...joints.joint import Clamp
from ...models import barrel_ends
from ..geometry import Geometry, Numbers, clamped, end_at, joint_of
from ..limits import MaterialValues
from ..state import LoadState
from ..values import Values

NONE = "no axial load"
STOP = "piston at the end stop"
LARGEST = "largest axial load"


@dataclass(frozen=True, slots=True)
class Swelling:
    """Response of the wall to pressure and axial force, far from its ends, (designs,).

    `growth` and `shortening` are bore growth [m/Pa] and axial strain [1/Pa] per pressure at no
    axial force, `stretch` the axial strain per axial force [1/N]; growth per axial force is
    shortening/(2 pi r_i) by reciprocity.
    """

    growth: Array
    shortening: Array
    stretch: Array
    growth_by_force: Array


@dataclass(frozen=True, slots=True)
class LoadPath:
    """Axial forces in the wall.

    `per_pressure` by name (designs,) [m^2]; `held` without pressure [N]; `cases` at the chamber
    pressures (cases, designs) [N], including `held`; `share` is the barrel's share of a separating
    force.
    """

    per_pressure: dict[str, Array]
    held: Array
    cases: Array
    clamp: Clamp | None = None
    share: Array = 1.0


def largest_area(design: Design, g: Geometry) -> Array:
    """Largest area on which supply pressure separates the ends: end stop or mount."""
    if design.cylinder.end_stop == "internal":
        return g.area_a
    return g.area_b if design.cylinder.mount.startswith("cap") else g.area_a


def derive(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    swelling: Swelling,
) -> LoadPath:
    """The load paths of a design with known wall stiffness."""
    if design.cylinder.mount.startswith("cap"):
        cases = barrel_ends.axial_force_cap_mounted(
            rod_side_pressure=state.moving_b, rod_side_area=g.area_b, stop_force=0.0
        )
    else:
        cases = barrel_ends.axial_force_head_mounted(
            cap_side_pressure=state.moving_a, cap_side_area=g.area_a
        )
    none = 0.0 * np.atleast_1d(np.asarray(g.area_a))
    name = STOP if design.cylinder.end_stop == "internal" else LARGEST
    worst = {name: none + largest_area(design, g)}
    if not clamped(design):
        return LoadPath({NONE: none, **worst}, 0.0, cases)
    return _clamped(v, design, stock, g, state, swelling, worst, cases)


def clamp_stiffness(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> Array:
    """Axial stiffness of the parts that clamp the barrel between both ends."""
    joint = joint_of(design)
    assert joint is not None
    assert joint.stiffness is not None
    return joint.stiffness(end_at(design, Numbers(v), g), stock)


def _clamped(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    state: LoadState,
    swelling: Swelling,
    worst: dict[str, Array],
    cases: Array,
) -> LoadPath:
    """A barrel between tie rods: two springs in parallel with preload.

    `worst` is the separating area of the pressure, by name of the load path.
    """
    springs = {
        "barrel_stiffness": 1 / (swelling.stretch * g.barrel_length),
        "tie_rod_stiffness": clamp_stiffness(v, design, stock, g),
    }
    supply = v["supply.pressure"]
    proof = v["supply.proof_ratio"] * supply
    slack = -swelling.shortening * g.barrel_length

    def shared(force: Array, pressure: Array) -> tuple[Array, Array]:
        return barrel_ends.tie_rod_forces(
            axial_force=force, preload=0.0, free_shortening=slack * pressure, **springs
        )

    ((name, area),) = worst.items()
    unit, _ = shared(area, 1.0)
    relaxed, _ = shared(0.0 * area, 1.0)
    preload = v.get("retention.preload", None)
    if preload is None:
        preload = proof * unit
    pressure = maximum(state.moving_a, state.moving_b)
    barrel, _ = shared(cases, pressure)
    return LoadPath(
        {NONE: relaxed, name: unit},
        -preload,
        barrel - preload,
        Clamp(preload, supply * (area - unit) + preload, preload / (proof * unit)),
        springs["barrel_stiffness"] / (springs["barrel_stiffness"] + springs["tie_rod_stiffness"]),
    )
