"""Equivalent stiffness and radial expansion along a pressure record, as figure 10 of the paper.

The text of the paper gives no number of its record, so the record is one of our own.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ..base.numeric import Array
from ..evaluation import Evaluation
from ..models import barrel, forces, stiffness, stiffness_published as published
from .elasswad_friction import chord
from .elasswad_paper import PAPER
from .elasswad_text import value, wall_thickness

SPEED = 0.1
"""Largest piston speed of the record where no load case states one (m/s)."""


@dataclass(frozen=True, slots=True)
class Record:
    """Time [s], pressure difference [Pa] and place of the piston as a share of the stroke."""

    time: Array
    pressure: Array
    place: Array


@dataclass(frozen=True, slots=True)
class Along:
    """Radial expansion [m] and equivalent stiffness [N/m] at every time of a record.

    By the published formulas; by the same numbers in the right ones, per chamber; as designed.
    """

    growth_published: Array
    growth_inner: Array
    growth_designed: Array
    stiffness_published: Array
    stiffness_chambers: Array
    stiffness_designed: Array


def pressure_record(
    *, average: float, largest: float, stroke: float, speed: float, count: int = 241
) -> Record:
    """One stroke out and back: a pulse of pressure each way, zero where the piston turns.

    x = s/2 (1 - cos(wt)), s w/2 the largest speed; p = p_max (a q + (1 - a) q^2), q = sin^2(wt),
    whose mean is p_max (3 + a)/8.

    Parameters
    ----------
    average, largest : pressure difference [Pa]
    stroke : [m]
    speed : largest piston speed [m/s]
    count : of times

    Returns
    -------
    the record
    """
    turn = np.linspace(0.0, 2 * pi, count)
    pulse = np.sin(turn) ** 2
    share = 8 * average / largest - 3
    return Record(
        time=turn * stroke / (2 * speed),
        pressure=largest * pulse * (share + (1 - share) * pulse),
        place=(1 - np.cos(turn)) / 2,
    )


def own_record(evaluation: Evaluation) -> Record:
    """The record whose pressures give the published friction, 166 N on average and 400 N at most.

    By eq. 15 to 20 with the published coefficient and the design's ring.
    """
    width = chord(evaluation.design.seals.piston)
    return pressure_record(
        average=PAPER.pressure(force=PAPER.friction_average, contact_width=width),
        largest=PAPER.pressure(force=PAPER.friction_largest, contact_width=width),
        stroke=evaluation.design.cylinder.stroke,
        speed=max(case.speed for case in evaluation.design.load_cases) or SPEED,
    )


def chambers(place: Array, *, growth_per_pressure: float) -> Array:
    """Stiffness per chamber with the paper's own numbers, at places of the piston.

    A^2/C of both chambers, C = V/K + dV/dp of the swelling bore, in series with k_rod. V holds the
    line volume behind the published k_oil.
    """
    line = PAPER.line_volume(bore=PAPER.bore)
    areas = (
        PAPER.area,
        float(forces.annulus_area(bore=PAPER.bore, rod_diameter=PAPER.rod_diameter)),
    )
    compliances = [
        stiffness.chamber_compliance(
            volume=area * length + line,
            bulk_modulus=PAPER.bulk_modulus,
            wall_compliance=barrel.chamber_compliance(
                inner_radius=PAPER.bore / 2, growth_per_pressure=growth_per_pressure, length=length
            ),
        )
        for area, length in zip(
            areas, (PAPER.stroke * place, PAPER.stroke * (1 - place)), strict=True
        )
    ]
    hydraulic = stiffness.hydraulic_stiffness(
        area_a=areas[0], compliance_a=compliances[0], area_b=areas[1], compliance_b=compliances[1]
    )
    return stiffness.series(hydraulic, PAPER.rod_stiffness)


def along(evaluation: Evaluation, record: Record) -> Along:
    """Published and derived values at every time of a record."""
    wall = PAPER.wall(wall_thickness(evaluation))
    printed, grown = published.equivalent_stiffness_as_published(
        pressure=record.pressure,
        bore=PAPER.bore,
        outer_diameter=2 * wall["outer_radius"],
        youngs_modulus=wall["youngs_modulus"],
        poissons_ratio=wall["poissons_ratio"],
        stroke=PAPER.stroke,
        oil=PAPER.oil_stiffness,
        rod=PAPER.rod_stiffness,
    )
    unit = float(barrel.bore_growth(pressure=1.0, **wall))
    curve, design = evaluation.curve, evaluation.design
    ours = value(evaluation, "bore_growth") / design.supply.pressure
    return Along(
        growth_published=grown,
        growth_inner=unit * record.pressure,
        growth_designed=ours * record.pressure,
        stiffness_published=printed,
        stiffness_chambers=chambers(record.place, growth_per_pressure=unit),
        stiffness_designed=np.interp(
            record.place * design.cylinder.stroke, curve.position, curve.stiffness
        ),
    )
