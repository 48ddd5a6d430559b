"""Records of EXUDYN [Exudyn2022] beside our runs, sample by sample: a lifted arm and a press.

The arm is a test model of EXUDYN, which stores a number of its end. The press is our circuit.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from math import cos, hypot, sin

from ..base.dataclass import dataclass
from ..pages.measured import channel_words
from ..pages.simulation_figures import curve, scaled, timed, titled
from ..rendering import text
from ..rendering.blocks import Block, Chart, Notes, Table, text_table
from ..rendering.chart import Curve, Panel
from ..simulation import Simulation
from ..simulation.measured.record import (
    AlignedRecord,
    ChannelResidual,
    Overlay,
    overlay,
    parse_measured,
)
from .cases import ComparedValue, comparison_table
from .papers import percent, published_numbers

RECORDS = {"Exudyn2022": "notes/exudyn_arm.csv", "ExudynPress": "notes/exudyn_press.csv"}
"""The record of each case."""


@dataclass(frozen=True, slots=True)
class ExudynCase:
    """Numbers of the arm's model and of its ends, SI; ``notes/exudyn.yaml`` states where."""

    stored: float
    shipped_length: float
    shipped_pressure_a: float
    shipped_pressure_b: float
    fine_norm: float
    end: float
    volume: float
    bulk_modulus: float
    arm_length: float


CASE = published_numbers(ExudynCase, "exudyn")


@cache
def record(case: str) -> AlignedRecord:
    """EXUDYN's position and pressures over time, with steps of 10 µs."""
    name = RECORDS[case]
    return parse_measured((files(__package__) / name).read_text("utf-8"), name=name)


def compared(simulation: Simulation) -> Overlay:
    """Our run with EXUDYN's record, and the differences."""
    return overlay(simulation, record(str(simulation.scenario.reproduces)))


def norm_as_published(simulation: Simulation) -> float:
    """The number that the test suite stores, of our last sample.

    The norm of the coordinates of the arm, which are the motion of its centre [m] and its angle
    [rad], plus the norm of both pressures [MPa].
    """
    signals = simulation.signals
    angle = float(signals["joint_angle"][-1] - signals["joint_angle"][0])
    half = CASE.arm_length / 2
    moved = hypot(half * (cos(angle) - 1), half * sin(angle), angle)
    return moved + 1e-6 * hypot(float(signals["pressure_a"][-1]), float(signals["pressure_b"][-1]))


def end_values(simulation: Simulation) -> list[ComparedValue]:
    """The arm's end with EXUDYN's own steps, beside ours; empty for other cases and other ends."""
    arm = simulation.scenario.reproduces == "Exudyn2022"
    if not arm or abs(float(simulation.time[-1]) - CASE.end) > 1e-9:
        return []
    signals = simulation.signals
    length = simulation.plant.closed_length + float(signals["position"][-1])
    bar = 1e-5
    a, b = (bar * float(signals[f"pressure_{side}"][-1]) for side in "ab")
    shipped = "run of the model, 1 ms"
    norm = norm_as_published(simulation)
    return [
        ComparedValue("number of the test suite", CASE.stored, norm, "", "stored in its suite", 6),
        ComparedValue("same, steps of 10 µs", CASE.fine_norm, norm, "", "run of the model", 6),
        ComparedValue(
            "distance of the pins", 1e3 * CASE.shipped_length, 1e3 * length, "mm", shipped, 6
        ),
        ComparedValue("pressure A", bar * CASE.shipped_pressure_a, a, "bar", shipped, 5),
        ComparedValue("pressure B", bar * CASE.shipped_pressure_b, b, "bar", shipped, 5),
    ]


def share_of_supply(simulation: Simulation, residual: ChannelResidual) -> float:
    """Largest difference of a pressure as a share of the supply pressure."""
    return residual.largest / simulation.plant.supply_pressure


def blocks(simulation: Simulation) -> list[Block]:
    """Tables and charts of the record beside our run, and what the source leaves open."""
    overlaid = compared(simulation)
    ends = end_values(simulation)
    at_end = [comparison_table("EXUDYN's end at 0.4 s, and ours", ends, STEPS)] if ends else []
    return [
        _differences(overlaid),
        *at_end,
        Chart("EXUDYN and ours", [_panel(overlaid, name) for name in overlaid.residuals]),
        Notes("EXUDYN's model and ours", OPEN[str(simulation.scenario.reproduces)]),
    ]


STEPS = (
    "EXUDYN holds the valve for the length of a step, 1 ms as shipped: its own steps of 10 µs "
    "lower its number by 0.37 %."
)
OPEN = {
    "Exudyn2022": (
        "EXUDYN's chambers hold 1 m³ at 100 GPa whatever the position; ours hold 50 litres at 5 "
        "GPa at the start, the same spring, which changes by 0.1 % on the way.",
        "EXUDYN's valve follows its signal at once, our spool at 100 kHz. The moment of EXUDYN's "
        "weight falls with the cosine of the angle, by 0.03 % at the end; our torque is constant.",
        "The comments of the model print 6441296 and 3008420 Pa for a start at 2 rad/s with steps "
        "of 1 µs. That start contradicts the joint, for the centre of the arm is at rest, so it is "
        "not repeated here; EXUDYN 1.13.6 gives the same pressures to 1 Pa.",
        "EXUDYN has no stops and states no stroke; they are our choice, and the piston does not "
        "reach them.",
    ),
    "ExudynPress": (
        "The circuit and its numbers are ours: EXUDYN ships none with unequal areas and volumes "
        "that change. Only the computation is EXUDYN's.",
        "EXUDYN's valve follows its signal at once, our spool at 100 kHz.",
        "EXUDYN has no vapour pressure: its pressures may fall below a vacuum, so the circuit is "
        "driven by ramps that keep them above 5 bar.",
    ),
}
"""Differences of both models, and gaps of the source, by case."""


def _differences(overlaid: Overlay) -> Table:
    """Table of the largest differences over time."""
    simulation, rows = overlaid.simulation, []
    for name, residual in overlaid.residuals.items():
        quantity = simulation.told[name].quantity
        supply = "pressure" in name
        rows.append(
            [
                channel_words(name),
                quantity.text(residual.span),
                quantity.text(residual.largest),
                text.with_unit(text.number(residual.time, 3), "s"),
                percent(residual.largest / residual.span, 2),
                percent(share_of_supply(simulation, residual), 2) if supply else text.DASH,
            ]
        )
    heads = ("signal", "span", "largest difference", "at", "of the span", "of the supply")
    return text_table("EXUDYN's record, steps of 10 µs, and ours", heads, rows)


def _panel(overlaid: Overlay, name: str) -> Panel:
    simulation = overlaid.simulation
    quantity = simulation.told[name].quantity
    time, values = overlaid.measured.channels[name]
    words = channel_words(name)
    panel = Panel(
        titled(words[:1].upper() + words[1:], quantity),
        curves=[
            Curve("EXUDYN", time, scaled(quantity, values), weight="broad"),
            curve(simulation, name, "ours"),
        ],
    )
    return timed(panel, (0.0, float(simulation.time[-1])))
