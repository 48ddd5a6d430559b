"""The static test of [AaltoThesis]: a force on the closed cylinder, its displacement, by position.

Walls count as oil of the same compliance, so that `trapped_air_load_step` serves them too: its
volumes are K C of oil and barrel. Rod and load cell give way behind the chambers, for the position
is measured there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from ..design.model import Design
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..models.stiffness import LoadStep, trapped_air_load_step
from .aalto import MARGIN, PAPER, first, pipes, variant

INDEX = 1.4
"""Polytropic index of the thesis, eq. 5."""
UP, DOWN = sum(PAPER.load_up) / 2, sum(PAPER.load_down) / 2
"""Mean force steps of both piston directions [N]."""
ENTRAINED = 0.005
"""Air content of a usual mineral oil."""
CONTENTS = (0.001, 0.15)
"""Air contents searched for the one behind a displacement."""


class Bypass(NamedTuple):
    """Force on the chambers by the pressures of figure 41 [N]; share of the load beside them."""

    force: float
    share: float


@dataclass(frozen=True, slots=True)
class Air:
    """Air in both chambers, stated at atmospheric pressure [m^3]."""

    a: Array
    b: Array


@dataclass(frozen=True, slots=True)
class Answer:
    """What one assumption makes of a load step; arrays along `position`, SI.

    Displacements are magnitudes, NaN where no state of the chambers carries the load (cavitation).
    """

    displacement: Array
    pressure_a: float
    pressure_b: float
    """At 185 mm, as figure 41."""

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest displacement over the positions that have one; NaN without any."""
        found = self.displacement[np.isfinite(self.displacement)]
        if not found.size:
            return float("nan"), float("nan")
        return float(found.min()), float(found.max())

    @property
    def cavitating(self) -> int:
        """Positions without a state."""
        return int(np.count_nonzero(np.isnan(self.displacement)))


@dataclass(frozen=True, slots=True)
class Assumption:
    """A reading of the static test, loaded up and down."""

    name: str
    up: Answer
    down: Answer


class Bench:
    """The closed cylinder with its pipes, K 1600 MPa, at the thesis' 22 positions."""

    def __init__(self, design: Design) -> None:
        springs = variant(design, lines=pipes(design), bulk_modulus=PAPER.bulk_modulus)
        self.geometry, self.flexibility = springs.geometry, springs.series_compliance()
        stroke = springs.geometry.stroke
        self.position = np.linspace(MARGIN, stroke - MARGIN, 22)
        self.place = float(np.squeeze(np.minimum(PAPER.place, 0.99 * stroke)))
        places = np.append(self.position, self.place)
        oil = springs.total(springs.oil).at(places, stroke)
        walls = springs.total((*springs.oil, "barrel")).at(places, stroke)
        scale = PAPER.bulk_modulus
        self.oil = Air(scale * first(oil.a), scale * first(oil.b))
        self.volume = Air(scale * first(walls.a), scale * first(walls.b))

    def bypass(self, loaded: tuple[float, float], load: float) -> Bypass:
        """What the measured pressures say of the force beside the chambers."""
        a = (loaded[0] - PAPER.pressure_a) * self.geometry.area_a
        b = (loaded[1] - PAPER.pressure_b) * self.geometry.area_b
        force = abs(float(a - b))
        return Bypass(force, 1 - force / load)

    def entrained(self, content: float) -> Air:
        """Air spread evenly through the oil, by volume at atmospheric pressure."""
        content = min(content, CONTENTS[1])
        return Air(content * self.oil.a, content * self.oil.b)

    def bubbles(self, *, compressed: bool) -> Air:
        """The thesis' 0.4 and 0.08 ml, read at atmospheric or at the working pressures."""
        volumes = []
        for bubble, pressure in (
            (PAPER.bubble_a, PAPER.pressure_a),
            (PAPER.bubble_b, PAPER.pressure_b),
        ):
            ratio = (pressure + ATMOSPHERIC_PRESSURE) / ATMOSPHERIC_PRESSURE
            volumes.append(bubble * (ratio ** (1 / INDEX) if compressed else 1.0))
        return Air(volumes[0], volumes[1])

    def step(self, force: float, air: Air) -> LoadStep:
        """The chambers under a step of the rod's force (> 0: the load pushes it in)."""
        return trapped_air_load_step(
            force=force,
            area_a=self.geometry.area_a,
            area_b=self.geometry.area_b,
            volume_a=self.volume.a,
            volume_b=self.volume.b,
            air_volume_a=air.a,
            air_volume_b=air.b,
            initial_pressure_a=PAPER.pressure_a,
            initial_pressure_b=PAPER.pressure_b,
            bulk_modulus=PAPER.bulk_modulus,
            polytropic_index=INDEX,
        )

    def answer(self, load: float, air: Air, *, share: float = 0.0) -> Answer:
        """Displacement behind the load cell; `share` of the load passes the chambers by."""
        found = self.step((1 - share) * load, air)
        moved = np.abs(found.displacement) + abs(load) * self.flexibility
        return Answer(
            displacement=np.broadcast_to(moved, self.oil.a.shape)[:-1],
            pressure_a=float(found.pressure_a[-1]),
            pressure_b=float(found.pressure_b[-1]),
        )

    def air_needed(self, load: float, most: float, *, share: float) -> float:
        """Entrained air at which the largest displacement is the measured one.

        0 where the least of `CONTENTS` already moves more, infinite where the most moves less.
        """
        content = np.linspace(*CONTENTS, 300)
        air = Air(content[:, None] * self.oil.a, content[:, None] * self.oil.b)
        moved = np.abs(self.step((1 - share) * load, air).displacement)
        known = np.where(np.isfinite(moved), moved, -np.inf)[:, :-1]
        largest = known.max(axis=1) + abs(load) * self.flexibility
        held = np.isfinite(largest)
        if not held.any():
            return float("inf")
        return float(np.interp(most, largest[held], content[held], left=0.0, right=np.inf))


@dataclass(frozen=True, slots=True)
class StaticTest:
    """The static test under every assumption."""

    position: Array
    place: float
    """Of the pressures of every answer."""
    up: Bypass
    down: Bypass
    assumptions: tuple[Assumption, ...]
    air_up: tuple[float, float]
    """Entrained air behind the largest displacement: all of the load on the chambers, and less
    the measured by-pass. 0 and infinite beyond `CONTENTS`."""
    air_down: tuple[float, float]


def static_test(design: Design) -> StaticTest:
    """Force step to displacement over position, in both directions."""
    bench = Bench(design)
    up, down = bench.bypass(PAPER.loaded_up, UP), bench.bypass(PAPER.loaded_down, DOWN)
    air_up = _needed(bench, -UP, sum(PAPER.most_up) / 2, up)
    air_down = _needed(bench, DOWN, sum(PAPER.most_down) / 2, down)
    usual = bench.entrained(ENTRAINED)
    small, large = (bench.bubbles(compressed=held) for held in (False, True))
    airs = (
        ("no air", bench.entrained(0.0), bench.entrained(0.0), False),
        ("0.5 % entrained", usual, usual, False),
        ("0.5 %, by-pass", usual, usual, True),
        (
            "air for largest, by-pass",
            bench.entrained(air_up[1]),
            bench.entrained(air_down[1]),
            True,
        ),
        ("bubbles at 1 bar, by-pass", small, small, True),
        ("bubbles as held, by-pass", large, large, True),
    )
    return StaticTest(
        position=bench.position,
        place=bench.place,
        up=up,
        down=down,
        assumptions=tuple(
            Assumption(
                name,
                bench.answer(-UP, risen, share=up.share if passed else 0.0),
                bench.answer(DOWN, sunk, share=down.share if passed else 0.0),
            )
            for name, risen, sunk, passed in airs
        ),
        air_up=air_up,
        air_down=air_down,
    )


def _needed(bench: Bench, load: float, most: float, bypass: Bypass) -> tuple[float, float]:
    without, with_bypass = (
        bench.air_needed(load, most, share=share) for share in (0.0, bypass.share)
    )
    return without, with_bypass
