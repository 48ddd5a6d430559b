"""Strength of the rod: yield, strength of plies and metal layers, buckling, bending.

Push and pull are the largest forces that supply pressure can cause. The actuator is a slender
beam. A push amplifies the bending moment of side load and own weight, the more, the closer it is to
the critical load (`Beam.under`). In a pull, the chamber pressure acts on the rod inside chamber B.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, minimum, where
from ..design.model import Design
from ..models import column, rod, shell_buckling, stepped, strength
from ..models.strength_modes import Stress, load_multiplier
from . import plies, weight
from .barrel import Cycle, Wall
from .geometry import Geometry
from .guides import side_reactions
from .limits import MaterialValues, MetricArrays
from .rods import FORCE, OUTSIDE, WARMTH, RodSection, material_of
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


class Seat(NamedTuple):
    """Support of a rod: by a flange (`fixed`) or free to swing, and directly or by the `cylinder`.

    A mount at the end that the rod passes supports the rod directly; one at the other end supports
    it by the cylinder, which bends with it.
    """

    fixed: bool
    cylinder: bool


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


def lengths(
    g: Geometry, state: LoadState, end: Literal["head", "cap"] = "head"
) -> tuple[Array, Array]:
    """Lengths of the cylinder and of the rod outside an end of it.

    Of the rod through the head, their sum is the eye-to-eye distance. A second rod is longest
    outside the cap in the retracted actuator.
    """
    cylinder = g.cap_eye + 2 * g.plate + g.spigot + g.cap_bush + g.barrel_length + g.head_bush
    if end == "head":
        return cylinder, maximum(state.reach + g.rod_extension + g.rod_stack + g.eye_offset, LEAST)
    return cylinder, maximum(g.rods[1].outside - state.withdrawn, LEAST)


CriticalLoad: TypeAlias = Callable[[Seat, Wall, RodSection, tuple[Array, Array]], Array]
"""Function that returns the critical load of a rod, from its seat, the wall, the section of the
rod, and the lengths of the cylinder and of the exposed rod."""


def seat(design: Design, end: Literal["head", "cap"]) -> Seat:
    """Support of the rod that passes an end of the cylinder.

    >>> from types import SimpleNamespace as Stub
    >>> design = Stub(cylinder=Stub(mount="head_trunnion"))
    >>> seat(design, "head"), seat(design, "cap")
    (Seat(fixed=False, cylinder=False), Seat(fixed=False, cylinder=True))
    """
    mount = design.cylinder.mount
    return Seat(fixed=mount.endswith("flange"), cylinder=not mount.startswith(end))


def derive(
    v: Values,
    design: Design,
    g: Geometry,
    state: LoadState,
    wall: Wall,
    sections: Sequence[RodSection],
    parts: Mapping[str, Array],
    *,
    critical_load: CriticalLoad,
) -> tuple[Beam, ...]:
    """Critical load and bending moment of every rod in every load case.

    The actuator is taken as horizontal. The side load acts on the rod through the head. The tip of
    a second rod may be free, so its weight bends it as a cantilever from the cap, w L^2/2; the
    force of its gland bends it at the piston. The larger moment counts.
    """
    beams = []
    for through, section in zip(g.rods, sections, strict=True):
        segments = lengths(g, state, through.end)
        if through.end == "head":
            moment = _weight(v, design, g, state, sections, parts, segments)
            moment = moment + state.side_load * overhang(g, state)
        else:
            moment = GRAVITY * section.mass_per_length * segments[1] * segments[1] / 2
            moment = maximum(moment, side_reactions(g, state, sections).second_moment)
        critical = critical_load(seat(design, through.end), wall, section, segments)
        beams.append(Beam(critical=critical, moment=moment))
    return tuple(beams)


def critical_load(seat: Seat, wall: Wall, rod: RodSection, lengths: tuple[Array, Array]) -> Array:
    """Critical load of barrel and rod, or, if the mount supports the rod directly, of it alone.

    Shear deformation is included.
    """
    if not seat.cylinder:
        factor = FIXED_PINNED if seat.fixed else 1.0
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
    ends: stepped.Ends = ("fixed" if seat.fixed else "pinned", "pinned")
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
    sections: Sequence[RodSection],
    parts: Mapping[str, Array],
    lengths: tuple[Array, Array],
) -> Array:
    """Largest bending moment in the rod through the head by the actuator's own weight.

    With a cap mount, the actuator is calculated as pinned at both eyes; a fixed cap would be
    stronger. With a head mount, the rod spans from the head to its eye. Its moment is w L^2/8, with
    weight per length w and span L, whether the rod is pinned or fixed at the head. On trunnions,
    the barrel behind the head is a cantilever.
    """
    rod = sections[0]
    outside = rod.mass_per_length * (state.reach + g.rod_extension)
    for through, section in zip(g.rods[1:], sections[1:], strict=True):
        outside = outside + section.mass_per_length * (through.outside - state.withdrawn)
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
    sections: Sequence[RodSection],
    beams: Sequence[Beam],
) -> dict[str, Array]:
    """Yield strength divided by stress of rods of one metal, at the pressure of each load case.

    Each rod may carry the whole load. What pulls the rod through the head pushes a second rod.
    """
    force = state.driven_pressure * where(state.push, g.area_a, g.area_b)
    factors = {}
    for through, section, beam in zip(g.rods, sections, beams, strict=True):
        name = material_of(design, through)
        strength = stock.allowable(name, "yield_strength", "strength_1_compression")
        if section.layers or strength is None:
            continue
        size = {"outer_diameter": section.outer_diameter, "inner_diameter": section.inner_diameter}
        axial = rod.rod_stress(force=force, **size)
        pushed = (force, 0.0) if through.end == "head" else (0.0, force)
        moment = beam.under(where(state.push, *pushed))
        bending = rod.bending_stress(bending_moment=moment, **size)
        factors[through.name] = strength / (axial + bending)
    return factors


def pushes(g: Geometry, push: Array, pull: Array) -> list[Array]:
    """Compressive force of every rod: the push, and for a second rod the pull of the first."""
    return [push if through.end == "head" else pull for through in g.rods]


def buckling(g: Geometry, beams: Sequence[Beam], push: Array, pull: Array) -> dict[str, Array]:
    """Critical load of every rod divided by its push; the only rod has no name."""
    factors = [
        beam.critical / force for beam, force in zip(beams, pushes(g, push, pull), strict=True)
    ]
    names = [through.name for through in g.rods] if len(g.rods) > 1 else [""]
    return dict(zip(names, factors, strict=True))


def compute(
    design: Design,
    g: Geometry,
    sections: Sequence[RodSection],
    beams: Sequence[Beam],
    supply: Array,
    push: Array,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Compute the strength of a rod's layers, and of hollow rods against local buckling."""
    section, beam = sections[0], beams[0]
    _layers(design, section, (beam.under(push), beam.moment), supply, push, pull, out)
    factors: dict[str, Array] = {}
    for through, tube, bent, force in zip(
        g.rods, sections, beams, pushes(g, push, pull), strict=True
    ):
        if not tube.hollow:
            continue
        shell = {
            "youngs_modulus": tube.shell_modulus,
            "poissons_ratio": tube.shell_ratio,
            "thickness": tube.wall,
            "radius": tube.middle,
        }
        utilisation = force / shell_buckling.local_shell_force(**shell)
        utilisation = utilisation + bent.under(force) / shell_buckling.local_shell_moment(**shell)
        factors[through.name if len(g.rods) > 1 else ""] = 1 / utilisation
    if factors:
        out.put("local_buckling_factor", factors)
    else:
        out.skip("local_buckling_factor", "the rod is solid")


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
    design: Design,
    g: Geometry,
    sections: Sequence[RodSection],
    supply: Array,
    push: Array,
    pull: Array,
) -> dict[str, Cycle]:
    """Stresses of the rods' metals while push and pull alternate: range and mean.

    A compressive mean counts as zero. The stress of a metal layer includes its cure stress and, in
    a pull, the effect of the pressure of chamber B. Its mean is the equivalent stress in the pull
    minus half the range.
    """
    section = sections[0]
    if not section.layers:
        return {
            through.name: Cycle(
                material_of(design, through),
                (push + pull)
                / rod.section_area(
                    outer_diameter=bar.outer_diameter, inner_diameter=bar.inner_diameter
                ),
                0.0,
            )
            for through, bar in zip(g.rods, sections, strict=True)
        }
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
