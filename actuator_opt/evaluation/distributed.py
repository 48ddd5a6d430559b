"""Dynamic stiffness with transmission lines, to assess the lumped model."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from ..base.numeric import Array
from ..design.circuit import Line
from ..design.model import Design
from ..models import line_ends, lines, transmission_line as transmission, water_hammer
from ..models.line_ends import LineEnd
from .circuit import CHAMBERS, Chamber, wall_compliance
from .motion import Motion
from .state import LoadState
from .values import Values, of_case


def _end(end: LineEnd, frequencies: Array, index: int) -> Array:
    """Admittance of a line end; infinite at constant pressure."""
    alone = LineEnd(
        tuple(of_case(c, index) for c in end.numerator),
        tuple(of_case(c, index) for c in end.denominator),
    )
    return line_ends.end_admittance(end=alone, frequency=frequencies)


def port_admittance(
    v: Values,
    design: Design,
    state: LoadState,
    motion: Motion,
    chamber: Chamber,
    index: int,
    frequencies: Array,
) -> Array:
    """Flow into everything behind a chamber port per pressure, complex, over frequency."""
    modulus = of_case(state.bulk_modulus_a if chamber == "a" else state.bulk_modulus_b, index)
    viscosity = state.dynamic_viscosity_a if chamber == "a" else state.dynamic_viscosity_b
    density = of_case(state.density, index)
    admittance = _end(motion.held[chamber], frequencies, index)
    own = [(i, line) for i, line in enumerate(design.lines) if line.chamber == chamber]
    ways = motion.throttles.get(chamber)
    throttle = None if ways is None else ways.toward(motion.push)
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
                dynamic_viscosity=of_case(viscosity, index),
                friction="distributed",
            )
            admittance = transmission.input_admittance(matrix=matrix, end_admittance=admittance)
        return admittance

    admittance = through(admittance, beyond)
    if throttle is not None:
        g = of_case(throttle, index)
        series = g * admittance / (g + admittance) if g else 0 * admittance
        admittance = np.where(np.isinf(admittance), g, series)
    return through(admittance, near)


def dynamic_stiffness(
    v: Values,
    design: Design,
    state: LoadState,
    motion: Motion,
    index: int,
    position: float,
    frequencies: Array,
) -> Array:
    """Complex dynamic stiffness at a position, with transmission lines.

    k_p = k_s + B s + s a^T M^-1 a, with M from chambers and port admittances; the rod compliance is
    in series, with the mass behind it.
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
        own = of_case(total, index) - of_case(lines_of_it, index)
        diagonal[chamber] = s * own + of_case(motion.leakage, index) + port
    cross = s * of_case(whole.ab, index) - of_case(motion.leakage, index)
    a, b = of_case(budget.geometry.area_a, index), of_case(budget.geometry.area_b, index)
    with np.errstate(all="ignore"):
        det = diagonal["a"] * diagonal["b"] - cross * cross
        held = (a * a * diagonal["b"] + b * b * diagonal["a"] + 2 * a * b * cross) / det
        rigid = np.isinf(diagonal["a"]), np.isinf(diagonal["b"])  # constant pressure at the port
        held = np.where(
            rigid[0], b * b / diagonal["b"], np.where(rigid[1], a * a / diagonal["a"], held)
        )
    seals = 0.0 if budget.seals is None else of_case(budget.seals, index)
    piston = seals + s * of_case(motion.damping, index) + s * held
    flexibility = of_case(budget.series_compliance(), index)
    return piston / (1 + flexibility * piston) + s * s * of_case(motion.mass, index)
