"""The textbook servo of [FOSSEE788]: natural frequency, lag at full speed, error at rest."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, pi, sqrt

import numpy as np

from ..base.dataclass import dataclass
from ..rendering.blocks import Block, Notes
from ..rendering.text import number
from ..simulation import Simulation
from .cases import ComparedValue, comparison_table
from .papers import published_numbers

INCH, CENTIMETRE = 0.0254, 0.01
"""In metres."""


@dataclass(frozen=True, slots=True)
class TextbookServo:
    """Data of the examples, in their units; ``notes/fossee.yaml`` states them."""

    valve_gain: float
    cylinder_gain: float
    transducer_gain: float
    load: float
    oil_volume: float
    dead_band: float
    bulk_modulus: float
    area: float
    metric_valve_gain: float
    metric_cylinder_gain: float
    metric_transducer_gain: float
    metric_load: float
    metric_oil_volume: float
    metric_bulk_modulus: float
    metric_area: float
    limit: float
    amplifier_gain: float
    other_transducer_gain: float

    @property
    def natural_frequency(self) -> float:
        """Example 17.1, A sqrt(2 B/(V M)) [rad/s]."""
        return self.area * sqrt(2 * self.bulk_modulus / (self.oil_volume * self.load))

    @property
    def computed_gain(self) -> float:
        """Example 17.1, amplifier gain: a third of the frequency over the other gains [mA/V]."""
        others = self.valve_gain * self.cylinder_gain * self.transducer_gain
        return self.natural_frequency / 3 / others

    @property
    def metric_gain(self) -> float:
        """Example 17.2, the same in its metric data [mA/V]."""
        area, volume = 1e-4 * self.metric_area, 1e-6 * self.metric_oil_volume
        frequency = area * sqrt(2e6 * self.metric_bulk_modulus / (volume * self.metric_load))
        others = self.metric_valve_gain * self.metric_cylinder_gain * self.metric_transducer_gain
        return frequency / 3 / others

    @property
    def rest_error(self) -> float:
        """Example 17.1, repeatable error [in], as printed: five decimals."""
        return round(self.dead_band / (self.computed_gain * self.transducer_gain), 5)

    @property
    def metric_rest_error(self) -> float:
        """Example 17.2, repeatable error [cm], as printed: rounded up to five decimals."""
        error = self.dead_band / (self.metric_gain * self.metric_transducer_gain)
        return ceil(1e5 * error) / 1e5

    @property
    def lag(self) -> float:
        """Example 17.3, tracking error [in], as printed: three decimals."""
        return round(self.limit / (self.amplifier_gain * self.transducer_gain), 3)

    @property
    def metric_lag(self) -> float:
        """Example 17.3, tracking error [cm], as printed: three decimals."""
        return round(self.limit / (self.amplifier_gain * self.other_transducer_gain), 3)


CASE = published_numbers(TextbookServo, "fossee")


def _errors(simulation: Simulation) -> tuple[float, float, float] | None:
    """Error at the end of the first ramp, and at rest after the next two [m].

    None if the reference has other parts than three ramps, or moves to the end.
    """
    control = simulation.scenario.control
    if control is None:
        return None
    parts = sorted(control.position, key=lambda part: part.start)
    if [part.shape for part in parts] != ["ramp"] * 3:
        return None
    ends = [part.end or 0.0 for part in parts]
    rests = [parts[2].start, float(simulation.time[-1])]
    if not (ends[1] < rests[0] and ends[2] < rests[1]):
        return None
    error = np.interp([ends[0], *rests], simulation.time, simulation.signals["error"])
    lag, below, above = map(float, error)
    return lag, below, above


def values(simulation: Simulation) -> list[ComparedValue]:
    """Published values beside ours; those over time only with the scenario's own reference."""
    rows = []
    ultimate = None if simulation.tuned is None else simulation.tuned.ultimate
    if ultimate is not None:
        frequency = 2 * pi / ultimate.period
        rows.append(
            ComparedValue("natural frequency", CASE.natural_frequency, frequency, "rad/s", "17.1")
        )
    errors = _errors(simulation)
    if errors is None:
        return rows
    lag, below, above = errors
    inch, centimetre = 1 / INCH, 1 / CENTIMETRE
    return [
        *rows,
        ComparedValue("lag at full speed", CASE.lag, lag * inch, "in", "17.3"),
        ComparedValue("same, metric", CASE.metric_lag, lag * centimetre, "cm", "17.3"),
        ComparedValue("error at rest, from below", CASE.rest_error, below * inch, "in", "17.1"),
        ComparedValue("error at rest, from above", CASE.rest_error, -above * inch, "in", "17.1"),
        ComparedValue("same, metric", CASE.metric_rest_error, -above * centimetre, "cm", "17.2", 3),
    ]


def damping_ratio(simulation: Simulation) -> float:
    """Damping ratio by the leakage across the piston, C/A sqrt(B M/(2 V)), at the start."""
    plant = simulation.plant
    volume = plant.dead_a + plant.area_a * float(simulation.signals["position"][0])
    spring = plant.oil.bulk_modulus * plant.mass / (2 * volume)
    return plant.leakage / plant.area_a * sqrt(spring)


def blocks(simulation: Simulation) -> list[Block]:
    """Table of the published values beside ours, and what the source leaves open."""
    return [
        comparison_table("Textbook examples and ours", values(simulation), ROUNDED),
        Notes("Contradictions and gaps of the source", open_points(simulation)),
    ]


ROUNDED = (
    "Published: the formulas of the source with its data, rounded as it prints them. Natural "
    "frequency of ours: where the linear loop lags by 180°."
)


def open_points(simulation: Simulation) -> Sequence[str]:
    """Sentences on contradictions of the source, and on our assumptions."""
    tuned = simulation.tuned
    margin = None if tuned is None or tuned.margins is None else tuned.margins.gain
    ours = "" if margin is None else f" Ours has a gain margin of {number(margin, 3)}."
    return [
        f"The amplifier gain is {number(CASE.computed_gain, 4)} mA/V by the formula of 17.1, but "
        f"{number(CASE.amplifier_gain, 3)} in 17.3, which is used here.",
        f"The transducer has {number(CASE.metric_transducer_gain, 1)} V/cm in 17.2 and "
        f"{number(CASE.other_transducer_gain, 3)} V/cm in 17.3; 17.1 has "
        f"{number(CASE.transducer_gain, 1)} V/in. The first gives an amplifier gain of "
        f"{number(CASE.metric_gain, 3)} mA/V; it cancels in the error at rest.",
        "17.3 refers to an example 14-3 for its data, which are those of 17.1.",
        f"A loop gain of a third of the natural frequency is stable only above a damping ratio of "
        "1/6. The source states no damping; the leakage across our piston, assumed, gives "
        f"{number(damping_ratio(simulation), 2)}.{ours}",
        "The volume under compression is taken as that of each chamber, as the formula requires. "
        "As the total of both, the frequency would be "
        f"{number(sqrt(2) * CASE.natural_frequency, 3)} rad/s.",
        "The dead band is taken as 4 mA to either side. As the whole width, it halves the error at "
        "rest.",
        "Not stated, so assumed: supply pressure, stroke, spool, friction (none).",
    ]
