"""The notes below the dynamic tests, the orifice and the peak of [AaltoThesis].

Every verdict is printed only where the numbers of the design at hand bear it, else its opposite;
shares are of the static stiffness with hoses at mid-stroke.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..base.numeric import Array
from ..design.materials import load_library
from ..design.model import Design
from ..rendering import text
from .aalto import PAPER
from .aalto_dynamic import DynamicTest, Neighbour, Response
from .aalto_text import area_text, other_cylinder
from .paper_text import close, listed, percent

NOTHING = 0.06
"""Change of a stiffness, over the static one, that counts as none."""
OPENINGS_SAY = 1.02
"""Ratio of two peaks that counts as none."""


def shares(test: DynamicTest, responses: Sequence[Response]) -> Array:
    """Dynamic over static stiffness: (openings, tested frequencies)."""
    return np.array([np.abs(one.tested) / test.static for one in responses])


def _range(values: Array) -> str:
    low, high = (text.trimmed(float(f(values)), 3) for f in (np.min, np.max))
    return f"{low} times" if low == high else f"{low} to {high} times"


def _times(values: Array) -> str:
    """First to last throttle."""
    return f"{text.trimmed(float(values[0]), 3)} to {text.trimmed(float(values[-1]), 3)} times"


def told(share: Array) -> tuple[tuple[str, bool, Array], ...]:
    """What the thesis tells of the stiffness, whether these shares do it, and those concerned."""
    slow, twenty, above, last = share[:, :2], share[:, 2], share[:, 3], share[:, 4]
    return (
        ("soft up to 15 Hz", bool(np.all(slow < 1)), slow),
        ("more than twice the static stiffness at 20 Hz", bool(np.all(twenty > 2)), twenty),
        (
            "a little above the static stiffness at 25 Hz",
            bool(np.all((above > 1) & (above < 1.3))),
            above,
        ),
        ("at the static stiffness at 30 Hz", bool(np.all(np.abs(last - 1) < 0.1)), last),
    )


def does_it(test: DynamicTest) -> bool:
    """Whether the valve, at every throttle and needle, does what the thesis tells, and is stable.

    Sections 4.2.2, 5.2 and 5.5: soft up to 15 Hz, "more than doubled" at 20 Hz, "slightly higher"
    at 25 Hz, static at 30 Hz.
    """
    both = [*test.stated["reducing_valve"], *test.read_back["reducing_valve"]]
    return test.peak.slowest_decay < 0 and all(holds for _, holds, _ in told(shares(test, both)))


def _valve(test: DynamicTest) -> str:
    """What the valve makes of the stiffness, against what the thesis tells."""
    both = [*test.stated["reducing_valve"], *test.read_back["reducing_valve"]]
    found = told(shares(test, both))
    if all(holds for _, holds, _ in found):
        words = (
            "what the thesis tells of the stiffness happens: soft up to 15 Hz, more than twice the "
            "static stiffness at 20 Hz, a little above it at 25, the static one at 30 Hz."
        )
    else:
        met = [name for name, holds, _ in found if holds]
        missed = [f"not {name} ({_range(share)})" for name, holds, share in found if not holds]
        part = f"happens only in part: {listed(met)}" if met else "does not happen"
        words = f"what the thesis tells of the stiffness {part}."
        words += f" With these numbers the cylinder is {listed(missed)}."
    if test.peak.slowest_decay >= 0:
        words += (
            " And it is not stable: the valve feeds the swing, which then grows by itself, so that "
            "these stiffnesses would not be seen."
        )
    return words


def _moves(share: Array, *, more: str, less: str, none: str) -> tuple[str, bool]:
    """What throttling does, words and whether it does anything."""
    if np.ptp(share) < NOTHING:
        return none, False
    return more if share[-1] > share[0] else less, True


def throttle_explained(test: DynamicTest) -> bool:
    """Whether the needle behind the measured drop does what the thesis tells of throttling.

    It stiffens at 10 Hz, lowers the peak and is "inconsequential" at 30 Hz.
    """
    at = shares(test, test.read_back["reducing_valve"])
    return bool(
        at[-1, 0] - at[0, 0] > NOTHING
        and at[0, 2] - at[-1, 2] > NOTHING
        and np.ptp(at[:, 4]) < NOTHING
    )


def _throttle(test: DynamicTest) -> str:
    at = shares(test, test.read_back["reducing_valve"])
    slow, _ = _moves(
        at[:, 0], more="stiffens at 10 Hz", less="softens at 10 Hz", none="does nothing at 10 Hz"
    )
    peak = "the peak" if np.all(np.argmax(at, axis=1) == 2) else "the stiffness at 20 Hz"
    twenty, _ = _moves(
        at[:, 2], more=f"raises {peak}", less=f"lowers {peak}", none=f"leaves {peak} as it is"
    )
    last, acts = _moves(
        at[:, 4], more="stiffens at 30 Hz", less="softens at 30 Hz", none="does nothing at 30 Hz"
    )
    return (
        "The throttle, if its needle drops what was measured, "
        f"{slow} ({_times(at[:, 0])} the static stiffness), {twenty} ({_times(at[:, 2])}) and "
        f"{last}{f' ({_times(at[:, 4])})' if acts else ''}."
    )


def _alike(one: Neighbour) -> bool:
    """Whether a neighbour does much the same: stable, soft, about twice at 20 Hz, then static."""
    return bool(
        one.slowest_decay < 0
        and np.all(one.ratio[:2] < 0.95)
        and one.ratio[2] > 1.85
        and abs(one.ratio[4] - 1) < 0.1
    )


def _neighbours(test: DynamicTest) -> str:
    """Whether the answer hangs on the valve's exact numbers, and on its opening."""
    frequencies = [one.valve.natural_frequency for one in test.neighbours]
    dampings = [one.valve.damping_ratio for one in test.neighbours]
    open_needle = shares(test, test.stated["reducing_valve"])[0]
    ours = _alike(Neighbour(test.valve, open_needle, test.peak.slowest_decay))
    alike = [_alike(one) for one in test.neighbours]
    verdict = "do not all do the same"
    if ours and all(alike):
        verdict = "do much the same"
    elif not ours and not any(alike):
        verdict = "do not do it either"
    words = (
        f"Valves of {text.trimmed(min(frequencies))} to {text.trimmed(max(frequencies))} Hz with a "
        f"damping ratio of {text.trimmed(min(dampings), 3)} to {text.trimmed(max(dampings), 3)} "
        f"{verdict}"
    )
    if test.valve.passive_conductance == 0 or test.peak.slowest_decay >= 0:
        return words + "."
    feeds = "would feed the swing" if test.without_opening >= 0 else "would be stable as well"
    return f"{words}; without the opening beside it the valve {feeds}."


def _closed(test: DynamicTest) -> str:
    closed = np.abs(test.closed.tested)
    static = text.number(test.static * 1e-6, 3)
    if abs(closed[0] / closed[-1] - 1) < 0.05:
        words = "Closed ports are as stiff at 10 as at 30 Hz"
    else:
        ends = (text.number(float(k) * 1e-6, 3) for k in closed[[0, -1]])
        words = "Closed ports are not as stiff at 10 as at 30 Hz ({} and {} kN/mm)".format(*ends)
    if np.min(closed) > 1.001 * test.static:
        return (
            f"{words}, and stiffer than the {static} kN/mm with hoses, which a shut throttle "
            "keeps out."
        )
    return f"{words}, and not at every frequency stiffer than the {static} kN/mm with hoses."


def _constant(test: DynamicTest) -> str:
    over = [
        np.abs(one.over)
        for found in (test.stated, test.read_back)
        for one in found["constant_pressure"]
    ]
    highest = max(float(one.max()) for one in over) / test.static
    rises = all(bool(np.all(np.diff(one) > 0)) for one in over)
    if rises and highest < 1:
        return (
            "With constant pressure nothing peaks: the cylinder is soft at every frequency and the "
            "oil in the hoses moves as one mass."
        )
    words = "nothing peaks" if rises else "the stiffness does not only rise with frequency"
    if highest < 1:
        return f"With constant pressure {words}, but the cylinder is soft at every frequency."
    return (
        f"With constant pressure {words}, but the cylinder is not soft at every frequency: it "
        f"comes to {text.trimmed(highest, 3)} times the static stiffness."
    )


def dynamic_note(design: Design, test: DynamicTest) -> str:
    """Below the dynamic tests."""
    low, high = (float(f(test.peak.ratio)) for f in (np.min, np.max))
    place = 1e3 * float(test.peak.position[int(np.argmax(test.peak.ratio))])
    valve = test.valve
    numbers = (
        f"{text.trimmed(valve.natural_frequency)} Hz, damping ratio "
        f"{text.trimmed(valve.damping_ratio)}, regulating "
        f"{text.trimmed(valve.conductance * 1e11, 2)} ml/s/bar beside an opening of "
        f"{text.trimmed(valve.passive_conductance * 1e11, 2)}"
    )
    end = "So such a valve would not do it with these numbers."
    if does_it(test):
        end = "It shows that such a valve would do it, not that this one did."
    return (
        "kN/mm at mid-stroke; line end: constant pressure, or a reducing valve. "
        f"{other_cylinder(design)}The thesis prints no number of these curves. {_closed(test)} "
        "That full throttling measured more than eq. 38 at 10 and 20 Hz the thesis puts down "
        "to oil that the check valves let in (rod chamber at 70 bar), which no linear model has. "
        f"{_constant(test)} With a reducing valve of our numbers, not the thesis' ({numbers}), "
        f"{_valve(test)} {_throttle(test)} {_neighbours(test)} Along the stroke 20 Hz gives "
        f"{text.trimmed(low, 2)} to {text.trimmed(high, 2)} times the static stiffness, most at "
        f"{text.trimmed(place, 3)} mm. {end} The check valves, which open in every half cycle, "
        "are not in a linear model: it overstates the throttle."
    )


def needles_caption(test: DynamicTest) -> str:
    """Below the curves over frequency: which needle is where, and whether it throttles."""
    peaks = shares(test, test.stated["reducing_valve"])[:, 2]
    change = float(np.max(peaks) / np.min(peaks))
    whose = "as the thesis states it"
    if not close(test.area, PAPER.throttle):
        whose = f"of this design, {area_text(test.area)}"
    verdict = "which throttles nothing at these flows"
    if change >= OPENINGS_SAY:
        verdict = f"which changes the stiffness at 20 Hz by up to {percent(change - 1)}"
    return (
        "Mid-stroke, oil as designed, friction left out. Above: the needle "
        f"{whose}, {verdict}. Below: the needle that drops the measured 0.4 bar."
    )


def _oil(design: Design) -> str:
    """Name of the oil; that of the thesis has the viscosity of a VG 32."""
    name, library = design.fluid.material, load_library()
    if name == "aalto_thesis_oil":
        return "a VG 32"
    return library.get(name).label.partition(",")[0] if name in library else name


def peak_note(design: Design, test: DynamicTest) -> str:
    """Below the orifice and the peak."""
    needle = test.needle
    low, high = PAPER.temperatures
    viscosity = f"ν = {text.trimmed(1e6 * needle.viscosity, 3)} mm²/s"
    warm = f"{text.trimmed(needle.temperature - 273.15, 3)} °C"
    if math.isnan(needle.temperature):
        source = f"which {_oil(design)} has at no temperature"
    elif low <= needle.temperature <= high:
        source = f"{_oil(design)} at {warm}: within the 25 to 30 °C of the tests"
    else:
        source = f"{_oil(design)} at {warm}: outside the 25 to 30 °C of the tests"
    loss = percent(1 - needle.flow_coefficient / PAPER.flow_coefficient, 1)
    there = f"There C_q is already {loss} below"
    if abs(needle.reynolds / PAPER.reynolds - 1) > 0.05:
        there = f"At our Re = {text.trimmed(needle.reynolds, 3)} C_q is {loss} below"
    return (
        f"Re = 100.8 is U d/ν with U = v A_A/A_o of eq. 46 at 20 mm/s and {viscosity}, {source}. "
        f"{there} 0.611 by laminar and turbulent losses in series, and it falls to zero twice in "
        f"every cycle. {_drop(design, test)}"
    )


def _drop(design: Design, test: DynamicTest) -> str:
    """Whether flow, area and pressure drop fit together."""
    less = PAPER.cracking_pressure / test.needle.drop
    theirs = close(test.area, PAPER.throttle) and close(design.cylinder.bore, PAPER.bore)
    if 0.8 < less < 1.25:
        return (
            "At 20 mm/s the open needle drops about the 0.4 bar that opened the check valve: flow, "
            "area and pressure fit together."
        )
    times = f"{text.trimmed(less, 2)} times less than"
    if less < 1:
        times = f"{text.trimmed(1 / less, 2)} times"
    size = "smaller" if less > 1 else "larger"
    role = ", which explains the throttle's effect, is a guess"
    if not throttle_explained(test):
        role = ", which does not explain the throttle's effect either, is a guess"
    return (
        f"But at 20 mm/s the open needle drops {times} the 0.4 bar that opened the check "
        f"valve: flow, area and pressure {'of the thesis' if theirs else 'of this design'} do not "
        f"fit together. We do not know which is wrong; the {size} area{role}."
    )
