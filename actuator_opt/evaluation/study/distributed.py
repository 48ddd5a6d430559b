"""Dynamic stiffness with the lines as transmission lines, to judge the lumped ones by."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from ...design.circuit import Line
from ...design.model import Design
from ...models import line_ends, lines, water_hammer
from ...models import transmission_line as transmission
from ...models.line_ends import LineEnd
from ...numeric import Array
from ..circuit import CHAMBERS, Chamber, wall_compliance
from ..motion import Motion
from ..state import State
from ..values import Values


def _one(value: Array, index: int) -> float:
    """One case's number."""
    array = np.atleast_2d(np.asarray(value))
    return float(array[min(index, array.shape[0] - 1), 0])


def _end(end: LineEnd, frequencies: Array, index: int) -> Array:
    """Admittance of a line's end; infinite at constant pressure."""
    alone = LineEnd(
        tuple(_one(c, index) for c in end.numerator),
        tuple(_one(c, index) for c in end.denominator),
    )
    return line_ends.end_admittance(end=alone, frequency=frequencies)


def port_admittance(
    v: Values,
    design: Design,
    state: State,
    motion: Motion,
    chamber: Chamber,
    index: int,
    frequencies: Array,
) -> Array:
    """Flow into everything behind a chamber's port per its pressure, complex, over frequency."""
    modulus = _one(state.bulk_modulus_a if chamber == "a" else state.bulk_modulus_b, index)
    viscosity = state.dynamic_viscosity_a if chamber == "a" else state.dynamic_viscosity_b
    density = _one(state.density, index)
    admittance = _end(motion.ends[chamber], frequencies, index)
    own = [(i, line) for i, line in enumerate(design.lines) if line.chamber == chamber]
    throttle = motion.throttles.get(chamber)
    beyond = [one for one in own if one[1].beyond_throttle] if throttle is not None else []
    near = [one for one in own if one not in beyond]

    def through(admittance: Array, chain: Sequence[tuple[int, Line]]) -> Array:
        for i, _ in reversed(chain):
            at = f"lines[{i}]."
            size = {
                "inner_diameter": float(np.squeeze(v[at + "inner_diameter"])),
                "length": float(np.squeeze(v[at + "length"])),
            }
            wall = float(np.squeeze(wall_compliance(v, design.lines[i], at)))
            matrix = transmission.line_matrix(
                frequency=frequencies,
                **size,
                density=density,
                sound_speed=water_hammer.wave_speed(
                    bulk_modulus=modulus,
                    density=density,
                    volume=lines.line_volume(**size),
                    wall_compliance=wall,
                ),
                dynamic_viscosity=_one(viscosity, index),
                friction="distributed",
            )
            admittance = transmission.input_admittance(matrix=matrix, end_admittance=admittance)
        return admittance

    admittance = through(admittance, beyond)
    if throttle is not None:
        g = _one(throttle, index)
        series = g * admittance / (g + admittance) if g else 0 * admittance
        admittance = np.where(np.isinf(admittance), g, series)
    return through(admittance, near)


def dynamic_stiffness(
    v: Values,
    design: Design,
    state: State,
    motion: Motion,
    index: int,
    position: float,
    frequencies: Array,
) -> Array:
    """Complex dynamic stiffness at a position, lines as transmission lines.

    k_p = k_s + B s + s a^T M^-1 a with M of the chambers and port admittances; the rod's
    flexibility in series, the mass behind it.
    """
    s = 2j * pi * frequencies
    budget = motion.springs
    whole = budget.total().at(position, budget.geometry.stroke)
    oil = {"a": state.bulk_modulus_a, "b": state.bulk_modulus_b}
    diagonal = {}
    for chamber, total in zip(CHAMBERS, (whole.a, whole.b), strict=True):
        branch = motion.branches[chamber]
        lines_of_it = branch.volume / oil[chamber] + branch.pipes + branch.hoses
        port = port_admittance(v, design, state, motion, chamber, index, frequencies)
        own = _one(total, index) - _one(lines_of_it, index)
        diagonal[chamber] = s * own + _one(motion.leakage, index) + port
    cross = s * _one(whole.ab, index) - _one(motion.leakage, index)
    a, b = _one(budget.geometry.area_a, index), _one(budget.geometry.area_b, index)
    with np.errstate(all="ignore"):
        det = diagonal["a"] * diagonal["b"] - cross * cross
        held = (a * a * diagonal["b"] + b * b * diagonal["a"] + 2 * a * b * cross) / det
        rigid = np.isinf(diagonal["a"]), np.isinf(diagonal["b"])  # constant pressure at the port
        held = np.where(
            rigid[0], b * b / diagonal["b"], np.where(rigid[1], a * a / diagonal["a"], held)
        )
    seals = 0.0 if budget.seals is None else _one(budget.seals, index)
    piston = seals + s * _one(motion.damping, index) + s * held
    flexibility = _one(budget.flexibility(), index)
    return piston / (1 + flexibility * piston) + s * s * _one(motion.mass, index)
