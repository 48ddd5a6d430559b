"""Strength of the rod in an evaluation: yield, plies and metal layers, local buckling.

Push and pull are the largest forces of the supply. Bending by side load and own weight is added,
amplified by the push; the rod inside chamber B is under its pressure while pulling.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from ..base.numeric import Array, maximum, where
from ..design.model import Design
from ..models import column, rod, shell_buckling, strength
from ..models.strength_modes import Stress, load_multiplier
from . import plies
from .barrel import Cycle
from .beam import Beam
from .geometry import Geometry
from .limits import MaterialValues, MetricArrays
from .rods import FORCE, OUTSIDE, WARMTH, Rod
from .state import LoadState


def yields(
    stock: MaterialValues, design: Design, g: Geometry, state: LoadState, section: Rod, beam: Beam
) -> dict[str, Array]:
    """Yield over working stress of a single-metal rod, at the pressure of every case."""
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
    section: Rod,
    beam: Beam,
    supply: Array,
    push: Array,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Strength of the layers, and of the wall against local buckling."""
    bent = beam.under(push)
    _layers(design, section, (bent, beam.moment), supply, push, pull, out)
    if not section.hollow:
        out.skip("local_buckling_factor", "the rod is solid")
        return
    shell = {
        "youngs_modulus": section.shell_modulus,
        "poissons_ratio": section.shell_ratio,
        "thickness": section.wall,
        "radius": section.middle,
    }
    used = push / shell_buckling.local_shell_force(**shell)
    used = used + bent / shell_buckling.local_shell_moment(**shell)
    out.put("local_buckling_factor", 1 / used)


def _layers(
    design: Design,
    section: Rod,
    moments: tuple[Array, Array],
    supply: Array,
    push: Array,
    pull: Array,
    out: MetricArrays,
) -> None:
    """Strength ratio of every layer, mode and direction, on both sides of the bent rod."""
    if not section.layers:
        out.skip("rod_factor", "the rod is a single metal: see yield_factor")
        return
    pressed, drawn = (
        column.bending_axial_force(
            bending_moment=moment,
            radius=section.outer_diameter / 2,
            axial_stiffness=section.axial_stiffness,
            bending_stiffness=section.bending_stiffness,
        )
        for moment in moments
    )
    loads = [(side * pressed - push, 0.0) for side in (1, -1)]
    loads += [(pull + side * drawn, outside) for side in (1, -1) for outside in (0.0, supply)]
    forces, pressures = (
        np.stack(np.broadcast_arrays(*[np.atleast_2d(load[k] + 0.0 * drawn) for load in loads]))
        for k in (0, 1)
    )
    factors = _factors(design, section, forces, pressures)
    if factors:
        out.put("rod_factor", factors)
    else:
        out.skip("rod_factor", section.missing[0])


DIRECTIONS = {"push": slice(0, 2), "pull": slice(2, 6)}
"""Sides of the bent rod in either direction; pulling with and without outside pressure."""


def _factors(design: Design, section: Rod, forces: Array, pressures: Array) -> dict[str, Array]:
    """Factors of all layers; forces and outside pressures are (sides, cases, designs)."""
    factors: dict[str, Array] = {}
    brittle = [i for i, layer in enumerate(section.layers) if layer.strengths]
    if brittle:
        modes = plies.utilisations(
            design.barrel.criterion,
            [section.layers[i] for i in brittle],
            _load(section, brittle, forces, pressures),
            _residual(section, brittle),
        )
        for group, used in plies.grouped(modes).items():
            for k, i in enumerate(brittle):
                factors |= _rows(section, f"{section.layers[i].label} {group}", used[:, k])
    for i, layer in enumerate(section.layers):
        if layer.yields:
            strengths = np.broadcast_arrays(*[np.atleast_1d(one) for one in layer.yields])
            used = strength.yield_utilisation(
                stress=_load(section, [i], forces, pressures),
                yield_strength=np.stack(strengths)[None, None, :, None, None],
                residual=_residual(section, [i]),
            )
            factors |= _rows(section, f"{layer.label} yield", used[:, 0])
    return factors


def _rows(section: Rod, label: str, used: Array) -> dict[str, Array]:
    """A factor for each climate and direction of (faces, climates, sides, cases, designs)."""
    rows = {}
    for direction, sides in DIRECTIONS.items():
        multiple = load_multiplier(plies.worst(used[:, :, sides], (0, 2)))
        for i, state in enumerate(section.climates):
            place = ", ".join(x for x in (state.name, direction) if x)
            rows[f"{label}, {place}"] = multiple[i]
    return rows


def cycles(
    design: Design, section: Rod, supply: Array, push: Array, pull: Array
) -> dict[str, Cycle]:
    """Stress of the rod's metals between push and pull; a compressive mean gives no credit.

    The stress of a metal layer includes its cure stress and, while pulling, the pressure of chamber
    B; its mean is the equivalent stress of the pull minus half the range.
    """
    if not section.layers:
        size = {"outer_diameter": section.outer_diameter, "inner_diameter": section.inner_diameter}
        return {"rod": Cycle(design.rod.material, (push + pull) / rod.section_area(**size), 0.0)}
    found = {}
    for i, layer in enumerate(section.layers):
        if not layer.isotropic:
            continue
        forces = np.stack(np.broadcast_arrays(*[np.atleast_2d(x) for x in (-push, pull, pull)]))
        pressures = np.stack(
            np.broadcast_arrays(*[np.atleast_2d(x + 0.0 * supply) for x in (0.0, 0.0, supply)])
        )
        ends = [part[:, 0, :, :, 0] for part in _load(section, [i], forces, pressures)]
        rest = _residual(section, [i])
        equivalent = partial(strength.yield_utilisation, yield_strength=1.0)
        span = equivalent(stress=_stress([part[:, :, 1:] - part[:, :, :1] for part in ends]))
        if rest is not None:
            ends = [part + own[:, 0, :, :, 0] for part, own in zip(ends, rest, strict=True)]
        drawn = equivalent(stress=_stress([part[:, :, 1:] for part in ends]))
        mean = plies.worst(maximum(drawn - span / 2, 0.0 * span), (0, 1, 2))
        found[f"rod, {layer.label}"] = Cycle(layer.name, plies.worst(span, (0, 1, 2)), mean)
    return found


def _stress(parts: Sequence[Array]) -> Stress:
    one, two, three, slip = parts
    return one, two, three, slip


def _unit_load(section: Rod, rows: list[int], load: int) -> list[Array]:
    """Ply stresses of these layers per unit load, (faces, layers, 1, 1, 1, designs)."""
    assert section.unit is not None
    return [part[:, rows][:, :, load][:, :, None, None, None] for part in section.unit]


def _load(section: Rod, rows: list[int], forces: Array, pressures: Array) -> Stress:
    """Stresses of the load, (faces, layers, 1, sides, cases, designs)."""
    units = (_unit_load(section, rows, load) for load in (FORCE, OUTSIDE))
    return _stress([f * forces + p * pressures for f, p in zip(*units, strict=True)])


def _residual(section: Rod, rows: list[int]) -> Stress | None:
    """Cure stresses, (faces, layers, climates, 1, 1, designs)."""
    if not section.cured:
        return None
    change = np.stack(
        np.broadcast_arrays(*[np.atleast_1d(state.change) for state in section.climates])
    )[:, None, None]
    return _stress([part * change for part in _unit_load(section, rows, WARMTH)])
