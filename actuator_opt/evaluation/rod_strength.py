"""Strength of the rod: yield, strength of plies and metal layers, buckling, bending.

Push and pull are the largest forces that supply pressure can cause. The actuator is a slender
beam. A push amplifies the bending moment of side load and own weight, the more, the closer it is to
the critical load (`Beam.under`). In a pull, the chamber pressure acts on the rod inside chamber B.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, minimum, where
from ..design.model import Design
from ..models import column, rod, shell_buckling, stepped, strength
from ..models.strength_modes import Stress, load_multiplier
from . import plies, weight
from .barrel import Cycle, Wall
from .geometry import Geometry
from .limits import MaterialValues, MetricArrays
from .rods import FORCE, OUTSIDE, WARMTH, RodSection
from .state import LoadState, overhang
from .values import Values

FIXED_PINNED = 0.6992
"""Effective length factor of a column fixed at one end, pinned at the other: pi/4.4934."""

GRAVITY = 9.80665
"""Standard gravity, m/s^2 (3rd CGPM, 1901)."""

NEAR = 0.75
"""Share of the critical load above which the curve of the amplified moment is replaced by its
tangent. Our choice: results are then finite even for designs far beyond buckling, which the
buckling check rejects."""

LEAST = 1e-6
"""Smallest rod length outside the head in calculations [m]; avoids a division by zero."""


@dataclass(frozen=True, slots=True)
class Beam:
    """Critical load [N] and largest bending moment [N m] of the rod in each load case.

    The moment is that before axial compression amplifies it.
    """

    critical: Array
    moment: Array

    def under(self, push: Array) -> Array:
        """Bending moment, amplified by a push [N].

        Above the share `NEAR` of the critical load, it rises linearly with the push.
        """
        share = push / self.critical
        near = minimum(share, NEAR)
        amplified = column.amplified_moment(
            bending_moment=self.moment, axial_force=near, critical_load=1.0
        )
        return amplified + self.moment * (share - near) / (1 - NEAR) ** 2


def lengths(g: Geometry, state: LoadState) -> tuple[Array, Array]:
    """Lengths of the cylinder and of the rod outside it; their sum is the eye-to-eye distance."""
    cylinder = g.cap_face + 2 * g.plate + g.spigot + g.cap_bush + g.barrel_length + g.head_bush
    return cylinder, maximum(state.reach + g.rod_extension + g.rod_stack + g.eye_offset, LEAST)


CriticalLoad: TypeAlias = Callable[[Design, Wall, RodSection, tuple[Array, Array]], Array]
"""Function that returns a design's critical load, from its wall, its rod, and the lengths of the
cylinder and the exposed rod."""


def derive(
    v: Values,
    design: Design,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    rod: RodSection,
    parts: Mapping[str, Array],
    *,
    critical_load: CriticalLoad,
) -> Beam:
    """Critical load and bending moment in every load case; the actuator is taken as horizontal."""
    segments = lengths(g, state)
    weight_moment = _weight(v, design, g, state, rod, parts, segments)
    return Beam(
        critical=critical_load(design, wall, rod, segments),
        moment=weight_moment + state.side_load * overhang(g, state),
    )


def critical_load(
    design: Design, wall: Wall, rod: RodSection, lengths: tuple[Array, Array]
) -> Array:
    """Critical load of barrel and rod, or, if mounted at the head, of the rod alone.

    Shear deformation is included.
    """
    mount = design.cylinder.mount
    if mount.startswith("head"):
        factor = FIXED_PINNED if mount == "head_flange" else 1.0
        return column.engesser_load(
            critical_load=column.euler_load(
                bending_stiffness=rod.bending_stiffness, effective_length=factor * lengths[1]
            ),
            shear_stiffness=rod.shear_stiffness,
        )
    segments = {
        "bending_stiffness_1": wall.bending_stiffness,
        "length_1": lengths[0],
        "bending_stiffness_2": rod.bending_stiffness,
        "length_2": lengths[1],
    }
    ends: stepped.Ends = ("fixed" if mount == "cap_flange" else "pinned", "pinned")
    load = stepped.stepped_column_load(**segments, ends=ends)
    shear = stepped.mode_shear_stiffness(
        critical_load=load,
        shear_stiffness_1=wall.shear_stiffness,
        shear_stiffness_2=rod.shear_stiffness,
        **segments,
        ends=ends,
    )
    return column.engesser_load(critical_load=load, shear_stiffness=shear)


def _weight(
    v: Values,
    design: Design,
    g: Geometry,
    state: LoadState,
    rod: RodSection,
    parts: Mapping[str, Array],
    lengths: tuple[Array, Array],
) -> Array:
    """Largest bending moment in the rod by the actuator's own weight.

    With a cap mount, the actuator is calculated as pinned at both eyes; a fixed cap would be
    stronger. With a head mount, the rod spans from the head to its eye. Its moment is w L^2/8, with
    weight per length w and span L, whether the rod is pinned or fixed at the head. On trunnions,
    the barrel behind the head is a cantilever.
    """
    outside = rod.mass_per_length * (state.reach + g.rod_extension)
    inside = sum(parts.values()) - parts["clevises"] - outside
    inside = inside + weight.oil(v, design, g, position=state.reach)
    heavy = GRAVITY * inside / lengths[0]
    light = GRAVITY * rod.mass_per_length
    mount = design.cylinder.mount
    if not mount.startswith("head"):
        *_, largest = column.self_weight_moments(
            weight_1=heavy, length_1=lengths[0], weight_2=light, length_2=lengths[1]
        )
        return largest
    half = lengths[1] / 2
    span, *_ = column.self_weight_moments(
        weight_1=light, length_1=half, weight_2=light, length_2=half
    )
    if mount == "head_flange":
        return span
    return maximum(span, heavy * lengths[0] * lengths[0] / 2)


def yields(
    stock: MaterialValues,
    design: Design,
    g: Geometry,
    state: LoadState,
    section: RodSection,
    beam: Beam,
) -> dict[str, Array]:
    """Yield strength divided by stress of a rod of one metal, at the pressure of each load case."""
    if section.layers:
        return {}
    strength = stock.allowable(design.rod.material, "yield_strength", "strength_1_compression")
    if strength is None:
        return {}
    force = state.driven_pressure * where(state.push, g.area_a, g.area_b)
    size = {"outer_diameter": section.outer_diameter, "inner_diameter": section.inner_diameter}
    axial = rod.rod_stress(force=force, **size)
    moment = beam.under(where(state.push, force, 0.0))
    return {"rod": strength / (axial + rod.bending_stress(bending_moment=moment, **size))}


def compute(
    design: Design,
    section: RodSection,
    beam: Beam,
    supply: Array,
    push: Array,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Compute the strength of a rod's layers, and of its wall against local buckling."""
    push_moment = beam.under(push)
    _layers(design, section, (push_moment, beam.moment), supply, push, pull, out)
    if not section.hollow:
        out.skip("local_buckling_factor", "the rod is solid")
        return
    shell = {
        "youngs_modulus": section.shell_modulus,
        "poissons_ratio": section.shell_ratio,
        "thickness": section.wall,
        "radius": section.middle,
    }
    utilisation = push / shell_buckling.local_shell_force(**shell)
    utilisation = utilisation + push_moment / shell_buckling.local_shell_moment(**shell)
    out.put("local_buckling_factor", 1 / utilisation)


def _layers(
    design: Design,
    section: RodSection,
    moments: tuple[Array, Array],
    supply: Array,
    push: Array,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Compute strength ratios by layer, mode and direction, on both sides of the bent rod."""
    if not section.layers:
        out.skip("rod_factor", "the rod is made of a single metal: see yield_factor")
        return
    push_bending, pull_bending = (
        column.bending_axial_force(
            bending_moment=moment,
            radius=section.outer_diameter / 2,
            axial_stiffness=section.axial_stiffness,
            bending_stiffness=section.bending_stiffness,
        )
        for moment in moments
    )
    loads = [(side * push_bending - push, 0.0) for side in (1, -1)]
    loads += [
        (pull + side * pull_bending, outside) for side in (1, -1) for outside in (0.0, supply)
    ]
    forces, pressures = (
        np.stack(
            np.broadcast_arrays(*[np.atleast_2d(load[k] + 0.0 * pull_bending) for load in loads])
        )
        for k in (0, 1)
    )
    factors = _factors(design, section, forces, pressures)
    if factors:
        out.put("rod_factor", factors)
    else:
        out.skip("rod_factor", section.missing[0])


DIRECTIONS = {"push": slice(0, 2), "pull": slice(2, 6)}
"""Indices of the stress states on both sides of the bent rod. There are two in a push and four in a
pull, with and without outside pressure."""


def _factors(
    design: Design, section: RodSection, forces: Array, pressures: Array
) -> dict[str, Array]:
    """Strength ratios of all layers.

    Forces and outside pressures are (states, cases, designs). The states are the stress states on
    both sides of the bent rod, in the order of `DIRECTIONS`.
    """
    factors: dict[str, Array] = {}
    brittle = [i for i, layer in enumerate(section.layers) if layer.strengths]
    if brittle:
        modes = plies.utilisations(
            design.barrel.criterion,
            [section.layers[i] for i in brittle],
            _load(section, brittle, forces, pressures),
            _residual(section, brittle),
        )
        for group, utilisation in plies.grouped(modes).items():
            for k, i in enumerate(brittle):
                factors |= _rows(section, f"{section.layers[i].label} {group}", utilisation[:, k])
    for i, layer in enumerate(section.layers):
        if layer.yields:
            strengths = np.broadcast_arrays(*[np.atleast_1d(value) for value in layer.yields])
            utilisation = strength.yield_utilisation(
                stress=_load(section, [i], forces, pressures),
                yield_strength=np.stack(strengths)[None, None, :, None, None],
                residual=_residual(section, [i]),
            )
            factors |= _rows(section, f"{layer.label} yield", utilisation[:, 0])
    return factors


def _rows(section: RodSection, label: str, utilisation: Array) -> dict[str, Array]:
    """Strength ratios by service temperature and load direction, from the utilisation.

    The utilisation is the inverse of the strength ratio.
    """
    rows = {}
    for direction, sides in DIRECTIONS.items():
        multiple = load_multiplier(plies.worst(utilisation[:, :, sides], (0, 2)))
        for i, state in enumerate(section.climates):
            place = ", ".join(x for x in (state.name, direction) if x)
            rows[f"{label}, {place}"] = multiple[i]
    return rows


def cycles(
    design: Design, section: RodSection, supply: Array, push: Array, pull: Array
) -> dict[str, Cycle]:
    """Stresses of the rod's metals while push and pull alternate: range and mean.

    A compressive mean counts as zero. The stress of a metal layer includes its cure stress and, in
    a pull, the effect of the pressure of chamber B. Its mean is the equivalent stress in the pull
    minus half the range.
    """
    if not section.layers:
        size = {"outer_diameter": section.outer_diameter, "inner_diameter": section.inner_diameter}
        return {"rod": Cycle(design.rod.material, (push + pull) / rod.section_area(**size), 0.0)}
    metal_cycles = {}
    for i, layer in enumerate(section.layers):
        if not layer.isotropic:
            continue
        forces = np.stack(np.broadcast_arrays(*[np.atleast_2d(x) for x in (-push, pull, pull)]))
        pressures = np.stack(
            np.broadcast_arrays(*[np.atleast_2d(x + 0.0 * supply) for x in (0.0, 0.0, supply)])
        )
        ends = [part[:, 0, :, :, 0] for part in _load(section, [i], forces, pressures)]
        residual = _residual(section, [i])
        equivalent = partial(strength.yield_utilisation, yield_strength=1.0)
        span = equivalent(
            stress=plies.stress_of([part[:, :, 1:] - part[:, :, :1] for part in ends])
        )
        if residual is not None:
            ends = [
                part + residual_part[:, 0, :, :, 0]
                for part, residual_part in zip(ends, residual, strict=True)
            ]
        pulled = equivalent(stress=plies.stress_of([part[:, :, 1:] for part in ends]))
        mean = plies.worst(maximum(pulled - span / 2, 0.0 * span), (0, 1, 2))
        metal_cycles[f"rod, {layer.label}"] = Cycle(layer.name, plies.worst(span, (0, 1, 2)), mean)
    return metal_cycles


def _unit_load(section: RodSection, rows: list[int], load: int) -> list[Array]:
    """Ply stresses of layers `rows` under a unit load, (faces, layers, 1, 1, 1, designs).

    The faces are the inner and outer face of each layer.
    """
    assert section.unit is not None
    return [part[:, rows][:, :, load][:, :, None, None, None] for part in section.unit]


def _load(section: RodSection, rows: list[int], forces: Array, pressures: Array) -> Stress:
    """Ply stresses of layers `rows` under axial force and outside pressure.

    They are (faces, layers, 1, states, cases, designs): the faces are the inner and outer face of
    each layer, the states those of `forces` and `pressures`, such as both sides of the bent rod.
    """
    units = (_unit_load(section, rows, load) for load in (FORCE, OUTSIDE))
    return plies.stress_of([f * forces + p * pressures for f, p in zip(*units, strict=True)])


def _residual(section: RodSection, rows: list[int]) -> Stress | None:
    """Cure stresses of the layers in `rows`, (faces, layers, climates, 1, 1, designs).

    The faces are the inner and outer face of each layer, the climates the service temperatures.
    """
    if not section.cured:
        return None
    change = np.stack(
        np.broadcast_arrays(*[np.atleast_1d(state.change) for state in section.climates])
    )[:, None, None]
    return plies.stress_of([part * change for part in _unit_load(section, rows, WARMTH)])
