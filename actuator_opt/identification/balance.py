"""Friction over time from the force balance of the rod."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..studies.bench import Bench
from .conditioning import ConditionedRecord, RecordSection

RESTING, CREEP = 3.0, 2e-5
"""Noise multiple, in standard deviations of the velocity, below which the rod may be at rest, and
least such speed [m/s] (choices: 0.3 % of the samples at rest are faster; two steps of 10 um in a
second)."""
OPPOSED = 0.5
"""Least share of the friction's power that must oppose motion; less means a wrong sign (a choice: a
quarter of the power then drives the rod, more than noise and offsets explain)."""
SLIDES = 5e-4
"""Travel of a section that counts as sliding [m] (a choice: ten breakaway travels of 50 um; below
it bristles return much of their energy)."""
SURE = 0.8
"""Driving share above which a swap of channels is suggested (a choice: a tenth of the power then
drives the rod: plausible if the record itself fails `OPPOSED`)."""


@dataclass(frozen=True, slots=True, eq=False)
class Sliding:
    """Friction along one section of a record, SI; arrays (samples).

    Parameters
    ----------
    piece : the motion
    hydraulic : p_1 A_1 - p_2 A_2 [N]
    resisting : F_L + m a [N], the part that is not friction
    pressure : the higher of both chambers, gauge [Pa]
    resting : velocity below which the rod may be at rest [m/s]
    """

    piece: RecordSection
    hydraulic: Array
    resisting: Array
    pressure: Array
    resting: float

    @property
    def friction(self) -> Array:
        """F_r = p_1 A_1 - p_2 A_2 - F_L - m a [N]."""
        return self.hydraulic - self.resisting

    @property
    def moving(self) -> Array:
        """Samples at which the rod certainly moves."""
        return self.piece.sound & (np.abs(self.piece.velocity) > self.resting)


def velocity_noise(motion: ConditionedRecord) -> float:
    """Standard deviation of the velocity due to noise and resolution of the position [m/s].

    White noise s of a sample, filtered to f_c and differentiated: s_v = 2 pi f_c s sqrt(2 f_c dt/3)
    [derived]; a sensor step q counts as q/sqrt 12.
    """
    quality = motion.quality["x"]
    sample = max(quality.noise, quality.resolution / np.sqrt(12))
    band = 2 * motion.cutoff * motion.sample_time
    return float(2 * np.pi * motion.cutoff * sample * np.sqrt(band / 3))


def slide(
    motion: ConditionedRecord, bench: Bench, *, mass: float, load_force: float | None
) -> list[Sliding]:
    """Friction along every section of a record.

    F_r = p_1 A_1 - p_2 A_2 - F_L - m a, [Huang2017] eq. 1; areas in the bore as grown.

    Parameters
    ----------
    motion : conditioned record; without a channel p2 the rod end is open to the air
    bench : the actuator's areas
    mass : moving mass inside the force sensor [kg]
    load_force : of the load if no channel F_L measures it [N]

    Returns
    -------
    friction by section
    """
    resting = max(RESTING * velocity_noise(motion), CREEP)
    return [_one(piece, bench, mass, load_force or 0.0, resting) for piece in motion.pieces]


def _one(
    piece: RecordSection, bench: Bench, mass: float, load_force: float, resting: float
) -> Sliding:
    first = piece["p1"]
    second = piece["p2"] if "p2" in piece else np.zeros_like(first)
    highest = np.maximum(np.maximum(first, second), 0.0)
    area_1, area_2 = bench.areas(highest)
    load = piece.channels.get("F_L", load_force)
    return Sliding(
        piece,
        first * area_1 - second * area_2,
        load + mass * piece.acceleration,
        highest,
        resting,
    )


def opposed(slidings: Sequence[Sliding]) -> float:
    """Share of the friction's power that opposes motion: 1 all, -1 none.

    If the record hardly slides, the share of its changes that oppose motion, dF dx, as friction
    then acts as a spring.
    """
    work = np.concatenate([_work(sliding) for sliding in slidings])
    whole = float(np.sum(np.abs(work)))
    return float(np.sum(work)) / whole if whole else 0.0


def _work(sliding: Sliding) -> Array:
    """F v of the samples after sliding, else dF v."""
    velocity = sliding.piece.velocity
    if _slides(sliding):
        return (sliding.friction * velocity)[sliding.moving]
    return (np.gradient(sliding.friction) * velocity)[sliding.moving]


def _slides(sliding: Sliding) -> bool:
    return float(np.ptp(sliding.piece["x"])) > SLIDES


def check_signs(slidings: Sequence[Sliding], bench: Bench, *, mass: float, name: str) -> None:
    """Reject a record whose friction drives the rod, which means a channel has the wrong sign.

    Raises
    ------
    InputError
        names the single change that helps, if any: the change with least friction, x last, as its
        sign does not change the size of the friction
    """
    share = opposed(slidings)
    slid = any(_slides(sliding) for sliding in slidings)
    if share >= (OPPOSED if slid else 0.0):
        return
    found = []
    for pressures, force, way in product((False, True), repeat=3):
        changed = pressures + force + way
        if changed != 1:
            continue
        turned = [_turned(sliding, bench, mass, pressures, force, way) for sliding in slidings]
        if opposed(turned) > SURE and (way or _size(turned) < _size(slidings)):
            found.append((_size(turned), pressures, force))
    about = (
        f"the friction drives the rod instead of opposing it (only {100 * share:.0f} % of its "
        "power opposes motion)"
    )
    if not found:
        remedy = "check signs and zeros of all channels, bore and rod of the design, mass and load"
        raise InputError(Diagnostic(about, remedy, file=name))
    _, pressures, force = min(found)
    if pressures:
        what, remedy = (
            "p1 and p2 seem swapped",
            "swap them, e.g. with --column p1=... --column p2=...",
        )
    elif force:
        what, remedy = (
            ("F_L seems to have the wrong sign"),
            "F_L is positive against extension: reverse its sign",
        )
    else:
        what, remedy = (
            ("x seems to have the wrong sign"),
            "x increases as the rod extends: reverse its sign",
        )
    raise InputError(Diagnostic(f"{what}: {about}", remedy, file=name))


def _size(slidings: Sequence[Sliding]) -> float:
    """Mean size of the friction [N]."""
    return float(
        np.mean(np.concatenate([np.abs(sliding.friction[sliding.moving]) for sliding in slidings]))
    )


def _turned(
    sliding: Sliding, bench: Bench, mass: float, pressures: bool, force: bool, way: bool
) -> Sliding:
    """The friction with one channel reversed."""
    piece = sliding.piece
    channels = dict(piece.channels)
    if pressures and "p2" in channels:
        channels["p1"], channels["p2"] = channels["p2"], channels["p1"]
    if force and "F_L" in channels:
        channels["F_L"] = -channels["F_L"]
    sign = -1.0 if way else 1.0
    other = RecordSection(
        piece.time, channels, sign * piece.velocity, sign * piece.acceleration, piece.sound
    )
    load = sliding.resisting[0] - mass * piece.acceleration[0] if "F_L" not in channels else 0.0
    return _one(other, bench, mass, float(load), sliding.resting)
