"""Strength of the rod in an evaluation: yield, plies and metal layers, local buckling.

Push and pull are the largest the supply makes. Bending of side load and own weight comes on top,
grown by the push; the part of the rod inside chamber B bears its pressure while it pulls.
"""

from __future__ import annotations

import numpy as np

from ..design.model import Design
from ..models import beam_column, rod, shell_buckling, yielding
from ..models.strength_modes import Stress, load_multiplier
from ..numeric import Array, real, where
from . import plies
from .allow import Stock
from .beam import Beam
from .geometry import Geometry
from .rods import FORCE, OUTSIDE, WARMTH, Rod
from .rows import Computed
from .state import State


def yields(
    stock: Stock, design: Design, g: Geometry, state: State, section: Rod, beam: Beam
) -> dict[str, Array]:
    """Yield over working stress of a rod of one metal, at the pressure of every case."""
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
    design: Design, section: Rod, beam: Beam, supply: Array, push: Array, pull: Array, out: Computed
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
    out: Computed,
) -> None:
    """Strength ratio of every layer, mode and direction; both sides of the bent rod."""
    if not section.layers:
        out.skip("rod_factor", "the rod is of one metal: yield_factor judges it")
        return
    pressed, drawn = (
        beam_column.bending_axial_force(
            bending_moment=moment,
            radius=section.outer_diameter / 2,
            axial_stiffness=section.axial_stiffness,
            bending_stiffness=section.bending_stiffness,
        )
        for moment in moments
    )
    none = 0.0 * drawn
    factors: dict[str, Array] = {}
    for direction, loads in (
        ("push", [(-push - pressed, none), (pressed - push, none)]),
        (
            "pull",
            [
                (pull + side * drawn, none + pressure)
                for side in (1, -1)
                for pressure in (0.0, supply)
            ],
        ),
    ):
        forces, pressures = (
            np.stack(np.broadcast_arrays(*[np.atleast_2d(load[k]) for load in loads]))
            for k in (0, 1)
        )
        factors |= _direction(design, section, direction, forces, pressures)
    if factors:
        out.put("rod_factor", factors)
    else:
        out.skip("rod_factor", section.missing[0])


def _direction(
    design: Design, section: Rod, direction: str, forces: Array, pressures: Array
) -> dict[str, Array]:
    """Factors of one direction; forces and outside pressures are (sides, cases, designs)."""
    factors = {}
    brittle = [i for i, layer in enumerate(section.layers) if layer.strengths]
    if brittle:
        modes = plies.utilisations(
            design.barrel.criterion,
            [section.layers[i] for i in brittle],
            _load(section, brittle, forces, pressures),
            _residual(section, brittle),
        )
        for mode, used in modes.items():
            multiple = load_multiplier(plies.worst(used, (0, 2, 3)))
            for k, i in enumerate(brittle):
                factors[f"{section.layers[i].label} {mode}, {direction}"] = multiple[k]
    for i, layer in enumerate(section.layers):
        if layer.yields:
            rows = np.stack(np.broadcast_arrays(*[np.atleast_1d(one) for one in layer.yields]))
            used = yielding.yield_utilisation(
                stress=_load(section, [i], forces, pressures),
                yield_strength=rows[None, None, :, None, None],
                residual=_residual(section, [i]),
            )
            label = f"{layer.label} yield, {direction}"
            factors[label] = load_multiplier(plies.worst(used, (0, 1, 2, 3)))
    return factors


def _unit(section: Rod, rows: list[int], load: int) -> list[Array]:
    """Ply stresses of some layers per unit load, (faces, layers, 1, 1, 1, designs)."""
    assert section.unit is not None
    return [part[:, rows][:, :, load][:, :, None, None, None] for part in section.unit]


def _load(section: Rod, rows: list[int], forces: Array, pressures: Array) -> Stress:
    """Stresses of the load, (faces, layers, 1, sides, cases, designs)."""
    one, two, three, slip = (
        pulled * forces + pressed * pressures
        for pulled, pressed in zip(
            _unit(section, rows, FORCE), _unit(section, rows, OUTSIDE), strict=True
        )
    )
    return one, two, three, slip


def _residual(section: Rod, rows: list[int]) -> Stress | None:
    """Cure stresses, (faces, layers, climates, 1, 1, designs)."""
    if not any(np.any(real(state.change)) for state in section.climates):
        return None
    change = np.stack(
        np.broadcast_arrays(*[np.atleast_1d(state.change) for state in section.climates])
    )[:, None, None]
    one, two, three, slip = (part * change for part in _unit(section, rows, WARMTH))
    return one, two, three, slip
