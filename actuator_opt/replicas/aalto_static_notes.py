"""The notes below the [AaltoThesis] stiffness curves and its static test.

Every verdict is printed only where the numbers of the design at hand bear it, else its opposite.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..design.materials import load_library
from ..design.model import Design
from ..rendering import text
from . import aalto
from .aalto import PAPER, Theory
from .aalto_static import CONTENTS, ENTRAINED, Answer, StaticTest
from .aalto_text import air_text, other_cylinder
from .paper_text import SLASH, percent, scaled

SAME = 0.1
"""Relative difference up to which two air contents, or two displacements, count as the same."""


def _moduli(design: Design) -> str:
    """Young's moduli of rod and barrel; nothing for a laminate."""
    library, found = load_library(), []
    names = [design.rod.material, *(layer.material for layer in design.barrel.layup)]
    for name in names:
        known = library.get(name).numbers if name in library else {}
        modulus = {**known, **design.materials.get(name, {})}.get("youngs_modulus")
        if modulus is not None:
            found.append(text.trimmed(float(modulus) * 1e-9))
    return f" and E {SLASH.join(dict.fromkeys(found))} GPa" if found else ""


def stiffness_note(design: Design, figures: Sequence[Theory]) -> str:
    """Below figures 5, 29 and 32; `figures` are the last two."""
    geometry = aalto.evaluated(design).geometry
    bore = design.cylinder.bore
    outer = bore + 2 * sum(layer.thickness for layer in design.barrel.layup)
    excess = [float(np.max(one.published / one.per_chamber)) - 1 for one in figures]
    ratio = float(np.squeeze(geometry.area_a / geometry.area_b))
    parts = [
        f"Rod {text.trimmed(1e3 * float(np.squeeze(geometry.rod_length)))} mm",
        f"barrel {text.trimmed(1e3 * bore)}/{text.trimmed(1e3 * outer)} mm",
    ]
    return (
        f"kN/mm at {scaled(aalto.places(design), 1e3)} mm. {other_cylinder(design)}"
        f"{', '.join(parts)}{_moduli(design)} are assumed, so the "
        "thesis' curves are met in form, not read off: its text prints no number of them. "
        "Why ours is softer: eq. 3 puts the totals of oil, barrel and hoses in series, as if the "
        "stiff chamber's hose could help the other chamber's oil; and eq. 23 lets the wall swell "
        f"over the rod's annulus only (too stiff by A_A/A_B = {text.trimmed(ratio, 3)}). Together "
        f"the printed form is up to {percent(excess[0])} (eq. 37) and {percent(excess[1])} "
        "(eq. 38) stiffer. The "
        "last column adds the barrel's axial stretch, which the thesis leaves out. "
        f"K 1300 MPa is eq. 5 with {percent(aalto.air_behind(PAPER.pressure_a))} of air at 20.5 "
        f"bar or {percent(aalto.air_behind(PAPER.pressure_b))} at 42 bar: one content does not "
        "give one modulus in both chambers."
    )


def static_note(design: Design, test: StaticTest) -> str:
    """Below the static test."""
    return other_cylinder(design) + " ".join((*_air(test), _pressures(test), _by_pass(test)))


def _air(test: StaticTest) -> tuple[str, ...]:
    """Air behind the largest displacements, the thesis' bubbles, and whether all of it fits."""
    up, down = test.air_up[1], test.air_down[1]
    alike = math.isfinite(up * down) and up > 0 and abs(down / up - 1) < SAME
    if alike and test.assumptions[3].down.range[0] > (1 - SAME) * PAPER.moved_down[0]:
        return _air_up(test), _air_down(test), _bubbles(test), "One oil does for both directions."
    suspect = "The thesis suspects air that leaves the oil at 17 to 19 bar. We do not know."
    return _air_up(test), _air_down(test), _bubbles(test), suspect


def _air_up(test: StaticTest) -> str:
    content = test.air_up[1]
    if math.isinf(content):
        return (
            f"Load up: not even {percent(CONTENTS[1])} of entrained air gives the largest "
            "displacement measured."
        )
    words = f"Load up: {air_text(content)} of entrained air"
    if content > 0:
        words += f", {text.trimmed(content / ENTRAINED, 2)} times the usual {percent(ENTRAINED)},"
    if test.up.share > 0:
        return f"{words} and the by-pass of the seals give the largest displacement measured."
    return f"{words} under the force that the pressures show gives the largest displacement."


def _air_down(test: StaticTest) -> str:
    """How much more the other direction takes, and whether its least displacement is met."""
    up, down = test.air_up[1], test.air_down[1]
    if math.isinf(down):
        words = f"Load down not even {percent(CONTENTS[1])} does"
    else:
        words = f"Load down takes {air_text(down)}"
    if math.isfinite(up * down) and up * down > 0:
        alike = abs(down / up - 1) < SAME
        words += f", {'about' if alike else text.trimmed(down / up, 2) + ' times'} as much in the "
        words += "same oil"
    largest = test.assumptions[3].down
    share = largest.range[0] / PAPER.moved_down[0]
    if math.isnan(share):
        return f"{words}, and ours cavitates everywhere."
    if share > 1 - SAME:
        return f"{words}, and nowhere moves less than was measured."
    place = test.position[int(np.nanargmin(largest.displacement))] / test.position[-1]
    where = "near the cap end" if place < 1 / 3 else "in the middle"
    where = "near the rod end" if place > 2 / 3 else where
    return f"{words}, and {where} ours still moves {_fraction(share)} of the least measured."


def _fraction(share: float) -> str:
    for value, words in ((1 / 3, "a third"), (1 / 2, "half"), (2 / 3, "two thirds")):
        if abs(share - value) < 0.03:
            return words
    return percent(share)


def _judged(one: Answer, measured: tuple[float, float]) -> str:
    """The largest displacement against the largest of each piston direction."""
    if one.cavitating:
        return "into cavitation"
    if one.range[1] < min(measured):
        return "too little"
    return "too much" if one.range[1] > max(measured) else "as much as measured"


def _bubbles(test: StaticTest) -> str:
    """The thesis' bubbles in both readings, against the largest displacements."""
    fits, words = [], []
    for one in test.assumptions[4:6]:
        up, down = _judged(one.up, PAPER.most_up), _judged(one.down, PAPER.most_down)
        fits.append((up == "as much as measured", down == "as much as measured"))
        words.append(up if up == down else f"{up} up, {down} down")
    if (True, True) in fits:
        fit = "fit both directions"
    elif any(up for up, _ in fits) and any(down for _, down in fits):
        fit = "fit each direction, but not in one reading"
    elif any(up or down for up, down in fits):
        fit = f"fit load {'up' if any(up for up, _ in fits) else 'down'} only"
    else:
        fit = "fit neither direction"
    return (
        f"The bubbles of the thesis' own simulation {fit}: read at atmospheric pressure 0.4 and "
        f"0.08 ml move {words[0]}, read at 20.5 and 42 bar {words[1]}."
    )


def softer(loaded: tuple[float, float]) -> float:
    """Pressure change of the rod chamber over the head chamber's."""
    return abs((loaded[1] - PAPER.pressure_b) / (loaded[0] - PAPER.pressure_a))


def _pressures(test: StaticTest) -> str:
    """Which chamber the measured pressures call the softer."""
    ours = test.assumptions[1]
    even = [softer((one.pressure_a, one.pressure_b)) for one in (ours.up, ours.down)]
    measured = [softer(PAPER.loaded_up), softer(PAPER.loaded_down)]
    words = (
        f"The pressures say where to look: at {text.trimmed(1e3 * test.place)} mm the rod chamber "
        f"changes {text.trimmed(measured[0], 2)} (up) and {text.trimmed(measured[1], 2)} (down) "
        "times as much as the head chamber, where evenly spread air gives "
    )
    if not all(map(math.isfinite, even)):
        return words + "cavitation."
    words += f"{text.trimmed(even[0], 2)} and {text.trimmed(even[1], 2)}. "
    if all(m < e for m, e in zip(measured, even, strict=True)):
        return words + (
            "The rod chamber, at the top of the upright cylinder, is softer than that, as with "
            "most of the air there and not in the head chamber."
        )
    if all(m > e for m, e in zip(measured, even, strict=True)):
        return words + (
            "The head chamber is softer than that, as with "
            "most of the air there and not in the rod chamber."
        )
    return words + "The two directions do not call the same chamber the softer."


def _by_pass(test: StaticTest) -> str:
    up, down = test.up.share, test.down.share
    if min(up, down) >= 0:
        return (
            "The by-pass is the share of the load that the pressures do not show: "
            f"{percent(up)} up, {percent(down)} down."
        )
    return (
        "On the areas of this design the pressures of the thesis show "
        f"{percent(1 - up)} (up) and {percent(1 - down)} (down) of its load: no by-pass explains "
        "more than all of it."
    )
