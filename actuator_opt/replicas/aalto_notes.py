"""Sentences that compare [AaltoThesis] with this project's models.

Verdicts follow from the values of the given design. Shares are relative to the static stiffness
with hoses at mid-stroke.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..base.numeric import Array
from ..design.materials import load_library
from ..design.model import Design
from ..rendering import text
from .aalto_figures import area_text
from .aalto_models import (
    CONTENTS,
    ENTRAINED,
    PAPER,
    Answer,
    DynamicTest,
    Neighbour,
    StaticTest,
    StiffnessResponse,
    Theory,
    air_behind,
    evaluated,
    places,
)
from .papers import (
    SLASH,
    close,
    listed,
    of_another_cylinder,
    percent,
    scaled,
)


def air_text(content: float) -> str:
    """Air content in words; beyond the searched range, the end of that range."""
    if content == 0:
        return f"less than {percent(CONTENTS[0])}"
    return percent(content) if math.isfinite(content) else f"more than {percent(CONTENTS[1])}"


def other_cylinder(design: Design) -> str:
    """Note that the thesis measured another cylinder; empty if it is the same."""
    return of_another_cylinder(design, "thesis", (PAPER.bore, PAPER.rod, PAPER.stroke))


SAME = 0.1
"""Relative difference up to which two air contents, or two displacements, count as the same."""


def _moduli(design: Design) -> str:
    """Words on Young's moduli of rod and barrel; empty for a laminate."""
    library, moduli = load_library(), []
    names = [design.rod.material, *(layer.material for layer in design.barrel.layup)]
    for name in names:
        known = library.get(name).numbers if name in library else {}
        modulus = {**known, **design.materials.get(name, {})}.get("youngs_modulus")
        if modulus is not None:
            moduli.append(text.trimmed(float(modulus) * 1e-9))
    return f" and E {SLASH.join(dict.fromkeys(moduli))} GPa" if moduli else ""


def stiffness_note(design: Design, figures: Sequence[Theory]) -> str:
    """Note below figures 5, 29 and 32; `figures` are the results of figures 29 and 32."""
    geometry = evaluated(design).geometry
    bore = design.cylinder.bore
    outer = bore + 2 * sum(layer.thickness for layer in design.barrel.layup)
    excess = [float(np.max(theory.published / theory.per_chamber)) - 1 for theory in figures]
    ratio = float(np.squeeze(geometry.area_a / geometry.area_b))
    parts = [
        f"Rod length {text.trimmed(1e3 * float(np.squeeze(geometry.rod_length)))} mm",
        f"barrel {text.trimmed(1e3 * bore)}/{text.trimmed(1e3 * outer)} mm",
    ]
    return (
        f"Stiffness in kN/mm at positions of {scaled(places(design), 1e3)} mm. "
        f"{other_cylinder(design)}{', '.join(parts)}{_moduli(design)} are assumed. The "
        "thesis prints no values of its curves, so only their form is compared. Why our "
        "values per chamber are lower: eq. 3 puts the totals of oil, barrel and hoses in "
        "series, as if the hose of one chamber could support the oil of the other; and "
        "eq. 23 uses the annulus area for the wall too (too stiff by A_A/A_B = "
        f"{text.trimmed(ratio, 3)}). Together, they make the printed form up to "
        f"{percent(excess[0])} (eq. 37) and {percent(excess[1])} (eq. 38) stiffer. The "
        "last column adds the barrel's axial stretch, which the thesis leaves out. Eq. 5 "
        f"gives K = 1300 MPa with {percent(air_behind(PAPER.pressure_a))} of air at 20.5 bar or "
        f"{percent(air_behind(PAPER.pressure_b))} at 42 bar: a single air content does not "
        "give the same modulus in both chambers."
    )


def static_note(design: Design, test: StaticTest) -> str:
    """Note below the static test."""
    return other_cylinder(design) + " ".join((*_air(test), _pressures(test), _by_pass(test)))


def _air(test: StaticTest) -> tuple[str, ...]:
    """Sentences on the air content that explains the largest displacements, and on the bubbles."""
    up, down = test.air_up[1], test.air_down[1]
    alike = math.isfinite(up * down) and up > 0 and abs(down / up - 1) < SAME
    if alike and test.assumptions[3].down.range[0] > (1 - SAME) * PAPER.moved_down[0]:
        return (
            _air_up(test),
            _air_down(test),
            _bubbles(test),
            "The same oil explains both directions.",
        )
    suspect = (
        "The thesis suspects that air leaves the oil at 17 to 19 bar. We do not know if it does."
    )
    return _air_up(test), _air_down(test), _bubbles(test), suspect


def _air_up(test: StaticTest) -> str:
    content = test.air_up[1]
    if math.isinf(content):
        return (
            f"Load up: not even {percent(CONTENTS[1])} of entrained air gives the largest "
            "measured displacement."
        )
    words = f"Load up: {air_text(content)} of entrained air"
    if content > 0:
        words += f", {text.trimmed(content / ENTRAINED, 2)} times the usual {percent(ENTRAINED)},"
    if test.up.share > 0:
        return (
            f"{words} and leakage past the seals (by-pass) give the largest measured displacement."
        )
    return (
        f"{words} gives the largest measured displacement, under the force that the "
        "measured pressures imply."
    )


def _air_down(test: StaticTest) -> str:
    """Sentence on the air content and the least displacement when the load acts downwards."""
    up, down = test.air_up[1], test.air_down[1]
    if math.isinf(down):
        words = f"Load down: not even {percent(CONTENTS[1])} is enough"
    else:
        words = f"Load down: the largest displacement takes {air_text(down)}"
    if math.isfinite(up * down) and up * down > 0:
        alike = abs(down / up - 1) < SAME
        words += f", {'about' if alike else text.trimmed(down / up, 2) + ' times'} as much, "
        words += "although it is the same oil"
    largest = test.assumptions[3].down
    share = largest.range[0] / PAPER.moved_down[0]
    if math.isnan(share):
        return f"{words}; our model then predicts cavitation at every position."
    if share > 1 - SAME:
        return f"{words}; our model then moves at least as far as was measured, at every position."
    place = test.position[int(np.nanargmin(largest.displacement))] / test.position[-1]
    where = "near the cap end" if place < 1 / 3 else "in the middle"
    where = "near the rod end" if place > 2 / 3 else where
    return (
        f"{words}; {where} our model still moves only {_fraction(share)} of the least "
        "measured displacement."
    )


def _fraction(share: float) -> str:
    for value, words in ((1 / 3, "a third"), (1 / 2, "half"), (2 / 3, "two thirds")):
        if abs(share - value) < 0.03:
            return words
    return percent(share)


def _judged(answer: Answer, measured: tuple[float, float]) -> str:
    """Verdict on the largest computed displacement against the largest measured one."""
    if answer.cavitating:
        return "into cavitation"
    if answer.range[1] < min(measured):
        return "too little"
    return "too much" if answer.range[1] > max(measured) else "as much as measured"


def _bubbles(test: StaticTest) -> str:
    """Sentence on the air bubbles that the thesis states, in both readings of their volume."""
    fits, words = [], []
    for assumption in test.assumptions[4:6]:
        up, down = _judged(assumption.up, PAPER.most_up), _judged(assumption.down, PAPER.most_down)
        fits.append((up == "as much as measured", down == "as much as measured"))
        words.append(up if up == down else f"{up} (load up) and {down} (load down)")
    if (True, True) in fits:
        fit = "fit both directions"
    elif any(up for up, _ in fits) and any(down for _, down in fits):
        fit = "fit each direction, but not both in one reading"
    elif any(up or down for up, down in fits):
        fit = f"fit load {'up' if any(up for up, _ in fits) else 'down'} only"
    else:
        fit = "fit neither direction"
    return (
        f"The bubbles of the thesis' own simulation (0.4 and 0.08 ml) {fit}: with these volumes "
        f"at atmospheric pressure the piston moves {words[0]}, at 20.5 and 42 bar {words[1]}."
    )


def softer(loaded: tuple[float, float]) -> float:
    """Ratio of the pressure change in the rod chamber to that in the head chamber."""
    return abs((loaded[1] - PAPER.pressure_b) / (loaded[0] - PAPER.pressure_a))


def _pressures(test: StaticTest) -> str:
    """Sentences on which chamber is softer according to the measured pressures."""
    ours = test.assumptions[1]
    even = [softer((answer.pressure_a, answer.pressure_b)) for answer in (ours.up, ours.down)]
    measured = [softer(PAPER.loaded_up), softer(PAPER.loaded_down)]
    words = (
        f"The pressures show which chamber is softer: at {text.trimmed(1e3 * test.place)} "
        f"mm the rod chamber's pressure changes {text.trimmed(measured[0], 2)} (load up) and "
        f"{text.trimmed(measured[1], 2)} (load down) times as much as the head chamber's; evenly "
        "spread air would give "
    )
    if not all(map(math.isfinite, even)):
        return words + "cavitation."
    words += f"{text.trimmed(even[0], 2)} and {text.trimmed(even[1], 2)}. "
    if all(m < e for m, e in zip(measured, even, strict=True)):
        return words + (
            "The rod chamber, at the top of the upright cylinder, is softer than that, as if most "
            "of the air were there and not in the head chamber."
        )
    if all(m > e for m, e in zip(measured, even, strict=True)):
        return words + (
            "The head chamber is softer than that, as if most of the air were there and not in the "
            "rod chamber."
        )
    return words + "The two directions do not agree on the softer chamber."


def _by_pass(test: StaticTest) -> str:
    up, down = test.up.share, test.down.share
    if min(up, down) >= 0:
        return (
            "The by-pass is the share of the load that the measured pressures do not "
            f"account for: {percent(up)} up, {percent(down)} down."
        )
    return (
        "With the areas of this design, the pressures of the thesis correspond to "
        f"{percent(1 - up)} (up) and {percent(1 - down)} (down) of the test load; a by-pass "
        "cannot explain more than the whole load."
    )


NOTHING = 0.06
"""Change of a stiffness, as a share of the static stiffness, that counts as no change."""


OPENINGS_SAY = 1.02
"""Ratio of two peaks up to which they count as equal."""


def shares(test: DynamicTest, responses: Sequence[StiffnessResponse]) -> Array:
    """Ratio of dynamic to static stiffness, by (opening, tested frequency)."""
    return np.array([np.abs(response.tested) / test.static for response in responses])


def _range(values: Array) -> str:
    low, high = (text.trimmed(float(f(values)), 3) for f in (np.min, np.max))
    return f"{low} times" if low == high else f"{low} to {high} times"


def _times(values: Array) -> str:
    """Ratios at the first and the last throttle setting, in words."""
    return f"{text.trimmed(float(values[0]), 3)} to {text.trimmed(float(values[-1]), 3)} times"


def judged_statements(share: Array) -> tuple[tuple[str, bool, Array], ...]:
    """Statements of the thesis on stiffness, whether our values confirm them, and these values."""
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
    """Whether the model with the valve is stable and confirms every statement for every needle.

    Sections 4.2.2, 5.2 and 5.5: soft up to 15 Hz, "more than doubled" at 20 Hz, "slightly higher"
    at 25 Hz, static at 30 Hz.
    """
    both = [*test.stated["reducing_valve"], *test.read_back["reducing_valve"]]
    return test.peak.slowest_decay < 0 and all(
        holds for _, holds, _ in judged_statements(shares(test, both))
    )


def _valve(test: DynamicTest) -> str:
    """The stiffness with the valve, against the statements of the thesis."""
    both = [*test.stated["reducing_valve"], *test.read_back["reducing_valve"]]
    judged = judged_statements(shares(test, both))
    if all(holds for _, holds, _ in judged):
        words = (
            "the stiffness behaves as the thesis says: soft up to 15 Hz, more than twice the "
            "static stiffness at 20 Hz, a little above it at 25 Hz, and equal to it at 30 Hz."
        )
    else:
        met = [name for name, holds, _ in judged if holds]
        missed = [f"not {name} ({_range(share)})" for name, holds, share in judged if not holds]
        part = f"happens only in part: {listed(met)}" if met else "does not happen"
        words = f"the behaviour of the stiffness in the thesis {part}."
        words += f" With these parameters the cylinder is {listed(missed)}."
    if test.peak.slowest_decay >= 0:
        words += (
            " And it is not stable: the valve feeds energy into the oscillation, which "
            "then grows, so that these stiffnesses could not be measured."
        )
    return words


def _moves(share: Array, *, more: str, less: str, none: str) -> tuple[str, bool]:
    """Words on the effect of throttling, and whether there is an effect."""
    if np.ptp(share) < NOTHING:
        return none, False
    return more if share[-1] > share[0] else less, True


def throttle_explained(test: DynamicTest) -> bool:
    """Whether the needle that explains the measured pressure drop throttles as the thesis states.

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
        at[:, 0],
        more="stiffens the cylinder at 10 Hz",
        less="softens the cylinder at 10 Hz",
        none="changes nothing at 10 Hz",
    )
    peak = "the peak" if np.all(np.argmax(at, axis=1) == 2) else "the stiffness at 20 Hz"
    twenty, _ = _moves(
        at[:, 2], more=f"raises {peak}", less=f"lowers {peak}", none=f"does not change {peak}"
    )
    last, acts = _moves(
        at[:, 4],
        more="stiffens it at 30 Hz",
        less="softens it at 30 Hz",
        none="changes nothing at 30 Hz",
    )
    return (
        f"With a needle that has the measured pressure drop, throttling {slow} "
        f"({_times(at[:, 0])} the static stiffness), {twenty} ({_times(at[:, 2])}) and "
        f"{last}{f' ({_times(at[:, 4])})' if acts else ''}."
    )


def _alike(neighbour: Neighbour) -> bool:
    """Whether a valve with slightly different values behaves like ours.

    It must be stable, soft at low frequency, about twice as stiff as static at 20 Hz, and then as
    stiff as static.
    """
    return bool(
        neighbour.slowest_decay < 0
        and np.all(neighbour.ratio[:2] < 0.95)
        and neighbour.ratio[2] > 1.85
        and abs(neighbour.ratio[4] - 1) < 0.1
    )


def _neighbours(test: DynamicTest) -> str:
    """Sentences on how the result depends on the valve's exact values and on its opening."""
    frequencies = [neighbour.valve.natural_frequency for neighbour in test.neighbours]
    dampings = [neighbour.valve.damping_ratio for neighbour in test.neighbours]
    open_needle = shares(test, test.stated["reducing_valve"])[0]
    ours = _alike(Neighbour(test.valve, open_needle, test.peak.slowest_decay))
    alike = [_alike(neighbour) for neighbour in test.neighbours]
    verdict = "do not all behave alike"
    if ours and all(alike):
        verdict = "behave alike"
    elif not ours and not any(alike):
        verdict = "do not behave so either"
    words = (
        f"Valves of {text.trimmed(min(frequencies))} to {text.trimmed(max(frequencies))} Hz with a "
        f"damping ratio of {text.trimmed(min(dampings), 3)} to {text.trimmed(max(dampings), 3)} "
        f"{verdict}"
    )
    if test.valve.passive_conductance == 0 or test.peak.slowest_decay >= 0:
        return words + "."
    feeds = "would feed the oscillation" if test.without_opening >= 0 else "would be stable as well"
    return f"{words}; without its fixed opening the valve {feeds}."


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
            f"{words}, and stiffer than the {static} kN/mm with hoses, because a shut throttle "
            "shuts off the hoses."
        )
    return f"{words}, and not at every frequency stiffer than the {static} kN/mm with hoses."


def _constant(test: DynamicTest) -> str:
    over = [
        np.abs(response.over)
        for responses in (test.stated, test.read_back)
        for response in responses["constant_pressure"]
    ]
    highest = max(float(stiffness.max()) for stiffness in over) / test.static
    rises = all(bool(np.all(np.diff(stiffness) > 0)) for stiffness in over)
    if rises and highest < 1:
        return (
            "With constant line pressure there is no peak: the cylinder is soft at every "
            "frequency and the oil in the hoses moves as a single mass."
        )
    words = "there is no peak" if rises else "the stiffness does not only rise with frequency"
    if highest < 1:
        return f"With constant line pressure {words}, but the cylinder is soft at every frequency."
    return (
        f"With constant line pressure {words}, but the cylinder is not soft at every "
        f"frequency: it reaches {text.trimmed(highest, 3)} times the static stiffness."
    )


def dynamic_note(design: Design, test: DynamicTest) -> str:
    """Note below the dynamic tests."""
    low, high = (float(f(test.peak.ratio)) for f in (np.min, np.max))
    place = 1e3 * float(test.peak.position[int(np.argmax(test.peak.ratio))])
    valve = test.valve
    numbers = (
        f"{text.trimmed(valve.natural_frequency)} Hz, damping ratio "
        f"{text.trimmed(valve.damping_ratio)}, regulating "
        f"{text.trimmed(valve.conductance * 1e11, 2)} ml/s/bar, with a parallel fixed "
        f"opening of {text.trimmed(valve.passive_conductance * 1e11, 2)} ml/s/bar"
    )
    end = "So a valve with these parameters does not explain the measured stiffness."
    if does_it(test):
        end = (
            "This shows that such a valve can explain the measured stiffness, not that the "
            "valve of the test did so."
        )
    return (
        "Stiffness in kN/mm at mid-stroke; at the line end: constant pressure or a reducing valve. "
        f"{other_cylinder(design)}The thesis prints no values of these curves. "
        f"{_closed(test)} With full throttling, the stiffness measured at 10 and 20 Hz "
        "exceeds eq. 38. The thesis attributes this to oil that the check valves let in "
        f"(rod chamber at 70 bar), which no linear model includes. {_constant(test)} With "
        f"a reducing valve of our parameters, not those of the thesis ({numbers}), "
        f"{_valve(test)} {_throttle(test)} {_neighbours(test)} Along the stroke, the "
        f"stiffness at 20 Hz is {text.trimmed(low, 2)} to {text.trimmed(high, 2)} times "
        f"the static stiffness, highest at {text.trimmed(place, 3)} mm. {end} The check "
        "valves, which open in every half cycle, are not included in a linear model, so "
        "it overstates the effect of the throttle."
    )


def needles_caption(test: DynamicTest) -> str:
    """Caption of the curves over frequency: the needle of each row, and whether it throttles."""
    peaks = shares(test, test.stated["reducing_valve"])[:, 2]
    change = float(np.max(peaks) / np.min(peaks))
    whose = "as the thesis states it"
    if not close(test.area, PAPER.throttle):
        whose = f"of this design, {area_text(test.area)}"
    verdict = "which hardly throttles these flows"
    if change >= OPENINGS_SAY:
        verdict = f"which changes the stiffness at 20 Hz by up to {percent(change - 1)}"
    return (
        "Mid-stroke, with the oil of the design, without friction. Above: the needle area "
        f"{whose}, {verdict}. Below: the needle area that gives the measured pressure drop of "
        "0.4 bar."
    )


def _oil(design: Design) -> str:
    """Name of the design's oil; the thesis' oil is called "a VG 32", as it has this viscosity."""
    name, library = design.fluid.material, load_library()
    if name == "aalto_thesis_oil":
        return "a VG 32"
    return library.get(name).label.partition(",")[0] if name in library else name


def peak_note(design: Design, test: DynamicTest) -> str:
    """Note below the table on orifice and peak."""
    needle = test.needle
    low, high = PAPER.temperatures
    viscosity = f"ν = {text.trimmed(1e6 * needle.viscosity, 3)} mm²/s"
    warm = f"{text.trimmed(needle.temperature - 273.15, 3)} °C"
    if math.isnan(needle.temperature):
        source = f"which {_oil(design)} does not have at any temperature"
    elif low <= needle.temperature <= high:
        source = f"that of {_oil(design)} at {warm}: within the 25 to 30 °C of the tests"
    else:
        source = f"that of {_oil(design)} at {warm}: outside the 25 to 30 °C of the tests"
    loss = percent(1 - needle.flow_coefficient / PAPER.flow_coefficient, 1)
    there = f"At this Re, C_q is already {loss} below"
    if abs(needle.reynolds / PAPER.reynolds - 1) > 0.05:
        there = f"At our Re = {text.trimmed(needle.reynolds, 3)} C_q is {loss} below"
    return (
        f"Re = 100.8 is U d/ν with U = v A_A/A_o of eq. 46 at 20 mm/s and {viscosity}, {source}. "
        f"{there} 0.611 (laminar and turbulent losses in series), and with the flow it falls to "
        f"zero twice in every cycle. {_drop(design, test)}"
    )


def _drop(design: Design, test: DynamicTest) -> str:
    """Sentence on whether the printed flow, area and pressure drop are consistent."""
    less = PAPER.cracking_pressure / test.needle.drop
    theirs = close(test.area, PAPER.throttle) and close(design.cylinder.bore, PAPER.bore)
    if 0.8 < less < 1.25:
        return (
            "At 20 mm/s the pressure drop of the open needle is about the 0.4 bar that opened "
            "the check valve: flow, area and pressure are consistent."
        )
    times = f"{text.trimmed(less, 2)} times less than"
    if less < 1:
        times = f"{text.trimmed(1 / less, 2)} times"
    size = "smaller" if less > 1 else "larger"
    role = ", which explains the throttle's effect, is only assumed"
    if not throttle_explained(test):
        role = ", which does not explain the throttle's effect either, is only assumed"
    return (
        f"But at 20 mm/s the pressure drop of the open needle is {times} the 0.4 bar that opened "
        "the check valve: flow, area and pressure "
        f"{'of the thesis' if theirs else 'of this design'} are not consistent. We do not know "
        f"which of them is wrong; the {size} area in the table{role}."
    )
