"""The notes below the [Huang2017] tables.

Every verdict is printed only where the numbers of the design at hand bear it, else its opposite.
"""

from __future__ import annotations

import math

import numpy as np

from ..design.model import Design
from ..models.friction import HUANG_TABLE_2
from ..rendering import text
from ..studies.film_walk import Missing
from . import huang_published
from .huang import TYPICAL
from .huang_parts import CHAMBER
from .huang_published import PAPER, SEAL_VISCOSITY
from .huang_study import HuangStudy
from .huang_text import mega, newtons, other_cylinder, pressure_text, speed_text, times
from .huang_trend import BOTH
from .paper_text import listed, percent

NEGLIGIBLE = 0.05
"""Share of the seals up to which a part can be neglected."""
EVEN = 0.02
"""Change below which a damping does not change with pressure."""


def _dry(viscous: np.ndarray) -> str:
    """Who holds the friction at the tested speeds."""
    most = float(np.nanmax(np.abs(viscous))) if np.any(np.isfinite(viscous)) else math.nan
    if math.isnan(most):
        return "No point has a film."
    if most < 0.05:
        return (
            f"Oil shears with at most {percent(most)} of the friction: at these speeds asperities "
            "hold it, so it hardly changes with speed and B falls as 1/v."
        )
    return f"Oil shears with up to {percent(most)} of the friction."


def _reasons(why: tuple[Missing, ...]) -> str:
    """Points without a film."""
    if not why:
        return ""
    more = f", and {len(why) - 1} more" if len(why) > 1 else ""
    first = why[0]
    at = f"{pressure_text(first.pressure)}, {speed_text(first.speed)}"
    return f" No film at {at}: {first.reason}{more}."


def cylinder_note(design: Design, found: HuangStudy) -> str:
    """Below figure 3."""
    mapped = found.cylinder
    i, j = int(np.argmin(np.abs(mapped.pressures - PAPER.shown_a[1]))), -1
    piston, rod = float(mapped.piston.friction[i, j]), float(mapped.rod.friction[0, j])
    return (
        f"{other_cylinder(design)}Seals, oil and their numbers are those of this "
        "design; the paper gives kinds of seals only. Nothing is fitted to its curves. At "
        f"7.15 MPa and 10 mm/s the piston seal takes {newtons(piston)}, the rod's at return "
        f"pressure {newtons(rod)}; wiper and guides are left out. "
        f"{_dry(mapped.piston.viscous)} The paper's R² of 1 (sums of squares "
        f"{listed([text.number(x, 2) for x in PAPER.interpolation])}) is that of surfaces drawn "
        "through every point: it says nothing of the errors."
        f"{_reasons(mapped.piston.why + mapped.rod.why)}"
    )


def plunger_note(design: Design, found: HuangStudy) -> str:
    """Below figure 6."""
    mapped = found.plunger
    j = mapped.at(0.0, TYPICAL)[1]
    curve = mapped.damping[:, j]
    ours = float(curve[mapped.at(PAPER.pressures[1], 0.0)[0]] / curve[0])
    table = [float(huang_published.secant_of(row, TYPICAL)) for row in HUANG_TABLE_2]
    theirs = table[-1] / table[0]
    if math.isnan(ours):
        words = "Ours has no film at both pressures. "
    elif ours > 1 + EVEN:
        words = (
            f"Table 2 falls to {text.trimmed(theirs, 2)} of its value from 0.6 to 6 MPa at "
            f"{speed_text(TYPICAL)}, ours rises {times(ours)}: we do not meet the measured trend. "
        )
    elif ours < 1 - EVEN:
        words = f"Both fall with pressure: to {theirs:.2f} (table 2) and {ours:.2f} (ours). "
    else:
        words = f"Table 2 falls to {theirs:.2f}, ours does not change with pressure. "
    share = [huang_published.balance_error(float(v)) for v in huang_published.SPEEDS]
    return (
        f"{words}{_dry(mapped.viscous)} {_between(found)}The measured fall deserves a doubt: "
        "friction is the difference of two large forces (eq. 1), and an error of "
        f"{percent(min(share))} to {percent(max(share))} in the change of the pressure force, in "
        "sensor or area, is as large as the whole fall at the tested speeds. The paper states no "
        "accuracy. We cannot tell which of the two is right."
        f"{_reasons(mapped.why)}"
    )


def _between(found: HuangStudy) -> str:
    """Who carries the pressure in the tandem."""
    mapped = found.plunger
    share = mapped.between / mapped.pressures[:, None]
    if not np.any(np.isfinite(share)):
        return ""
    i, j = mapped.at(PAPER.compared, TYPICAL)
    step, second = (float(x) for x in mapped.parts[i, j])
    return (
        f"At 6 MPa the outer seal bears {percent(float(share[i, j]))} of the pressure when both "
        f"pass the same flow, and makes {newtons(second)} of {newtons(step + second)}. "
    )


def fits_note(found: HuangStudy) -> str:
    """Below the fits."""
    exponents = [one.power.values["exponent"] for one in found.published]
    exponents += [one.power.values["exponent"] for _, one in found.films]
    rates = [
        value
        for one in (*found.published, *(fit for _, fit in found.films))
        for name, value in one.double.values.items()
        if name.startswith("rate")
    ]
    errors = [max(one.power.largest_error, one.double.largest_error) for one in found.published]
    if max(*exponents, *rates) < 0:
        words = (
            "Every exponent is below 0, so the printed conditions b > 0 do not describe these "
            "curves (our copy of the text may have lost a minus, as it did in eq. 2 and 31). "
        )
    else:
        words = "Not every exponent is below 0. "
    loose = [
        text.trimmed(one.row.pressure / 1e6)
        for one in found.published
        if not (one.power.determined and one.double.determined)
    ]
    doubt = ""
    if loose:
        doubt = f" At {listed(loose)} MPa of table 2 not every parameter is known to 30 %."
    return (
        f"Bounds hold 95 % (Student's t of the linearised law), least squares of B. {words}A high "
        f"R² sees the slow points: errors of table 2's fits still reach {percent(max(errors))} of "
        f"B at the fast ones. Ours are power laws near v^−1: friction that does not depend on "
        f"speed.{doubt}"
    )


def simulated_note(found: HuangStudy) -> str:
    """Below figures 15 and 16."""
    mapped = found.plunger
    i = mapped.at(PAPER.compared, 0.0)[0]
    ours = mapped.friction[i]
    theirs = [huang_published.friction_of(HUANG_TABLE_2[-1], v) for v in PAPER.speeds]
    return (
        "The paper gives neither the inputs of its simulation nor its static pressures, so its "
        "curves cannot be re-computed; these are ours, from this design. Friction at 6 MPa from "
        f"0.5 to 10 mm/s: table 2 {newtons(float(theirs[0]))} to {newtons(float(theirs[1]))}, "
        f"ours {newtons(ours[0])} to {newtons(ours[-1])}. {_stribeck(ours, found)}"
        f"sigma2 v is {percent(huang_published.viscous_share(HUANG_TABLE_2[0], 10e-3))} to "
        f"{percent(huang_published.viscous_share(HUANG_TABLE_2[-1], 10e-3))} of table 2's "
        "friction at 10 mm/s: its asymptote lies outside the tests."
        f"{_reasons(found.fast.why)}"
    )


def _stribeck(ours: np.ndarray, found: HuangStudy) -> str:
    """Whether our friction falls over the tested speeds as table 2 does."""
    if not np.all(np.isfinite(ours)) or ours[-1] < 0.9 * ours[0]:
        return ""
    i = found.plunger.at(PAPER.compared, 0.0)[0]
    share = float(np.max(np.abs(found.plunger.viscous[i])))
    return (
        "The Stribeck fall of table 2 is not in our films: none is carried by speed below "
        f"10 mm/s (oil shears with {percent(share)} at most). "
    )


def ring_note(found: HuangStudy) -> str:
    """Below figures 17 and 18."""
    ring = found.sealings.plunger.rings[0]
    kind = found.kinds[1]
    words = (
        f"First rod seal on {text.trimmed(1e3 * PAPER.plunger)} mm, section "
        f"{text.trimmed(1e3 * ring['section'])} mm, squeeze {percent(ring['squeeze'])}"
    )
    if "relief" in ring.numbers:
        words += (
            f", relief {text.trimmed(1e3 * ring['relief'])} of {text.trimmed(1e3 * ring['width'])} "
            "mm, assumed"
        )
    words += (
        f"; pressure balance {text.trimmed(kind.balance, 3)}. The largest stress contains the "
        "sealed pressure itself, so it can fall only where the balance is below 0; the excess over "
        "the oil pressure, which asperities carry, falls below 1/2. The paper's peak may be one of "
        "a tilting, unworn edge, which a run-in face does not have. "
    )
    thickness = found.plunger.thickness[:, :, 0]
    known = thickness[np.isfinite(thickness)]
    if not known.size:
        return words
    spread = float(known.max() / known.min() - 1)
    return f"{words}Over all points of the map its mean film changes by {percent(spread)}."


def parts_note(found: HuangStudy, dry: float) -> str:
    """Below the parts of eq. 26."""
    most = max(one.beside_share for one in found.totals)
    chamber = max(one.share(CHAMBER) for one in found.totals)
    member = huang_published.plausible_chamber()
    ring = min(float(np.min(one.film.film)) for one in found.rings)
    seals = min(one.seals * one.speed for one in found.totals)
    verdict = "can be neglected, as the paper says" if most < NEGLIGIBLE else "cannot be neglected"
    if math.isnan(most):
        verdict = "have no film at a point"
    return (
        f"Ring and chamber {verdict}: at most {percent(most)} of the seals, the chamber "
        f"{percent(chamber, 1)}. This holds for a ring on a smooth film; its least film, "
        f"{text.trimmed(1e6 * ring, 2)} µm, is thinner than the seals' roughness, and dry the ring "
        f"would rub with {newtons(dry)}, {percent(dry / seals)} of the least friction of the "
        f"seals. The chamber's printed {PAPER.chamber_shear} N·s/m comes without inputs: "
        "eta pi d L/h_v gives it "
        f"for L = {text.trimmed(1e3 * member.length)} mm, eta = {SEAL_VISCOSITY} Pa·s (both "
        f'assumed) and h_v = {text.trimmed(1e3 * member.gap, 2)} mm, no "fairly large gap"; '
        f"1 mm would need {text.trimmed(huang_published.chamber_length(gap=1e-3), 3)} m of plunger "
        "in the oil."
    )


def kinds_note(found: HuangStudy) -> str:
    """Why pressure may act both ways."""
    words = (
        "The balance k is the rise of a face's load with pressure over its width. Oil that falls "
        "evenly across the face carries half of the pressure; where asperities hold the friction, "
        "B rises with pressure above k = 1/2 and falls below it. "
    )
    compact = found.kinds[0]
    if compact.rise > 1 + EVEN:
        share = text.trimmed(compact.balance, 2)
        words += f"The piston's seal has k = {share} and rises {times(compact.rise)}. "
    whole = [one for one in found.kinds if one.name == BOTH]
    for one in whole:
        words += (
            f"The tandem rises {times(one.rise)}, because its outer seal bears most of the "
            "pressure when both pass the same flow. "
            if one.rise > 1 + EVEN
            else "The tandem does not rise. "
        )
    return words + (_proven(found) if whole else "")


def relief_note(found: HuangStudy) -> str:
    """What relief turns the trend."""
    turn = found.turn
    if turn is None:
        return "This design's first rod seal is no step ring: nothing turns its trend."
    if math.isnan(turn.relief):
        return "No relief turns the trend of its step ring. " + _tandem(found)
    return (
        f"Alone, the step ring turns from rising to falling at a relief of "
        f"{1e3 * turn.relief:.2f} mm, {percent(turn.share)} of its width, where "
        f"k = {turn.balance:.2f}; the design has "
        f"{text.trimmed(1e3 * found.sealings.plunger.rings[0]['relief'])} mm. " + _tandem(found)
    )


def _tandem(found: HuangStudy) -> str:
    """What the second seal makes of it."""
    if not found.whole:
        return ""
    least = float(np.nanmin(found.whole))
    falls = [
        (one.relief, rise)
        for one, rise in zip(found.reliefs, found.drained, strict=True)
        if rise < 1 - EVEN
    ]
    words = (
        f"With both seals passing the same flow no relief shown turns it (B rises at least "
        f"{times(least)}): the Yx behind bears the pressure. "
        if least > 1
        else "With both seals passing the same flow some reliefs turn it too. "
    )
    if falls:
        relief, rise = falls[-1]
        words += (
            "Without pressure between the seals, as if the room there were drained, B "
            f"falls to {text.number(rise, 2)} at a relief of {1e3 * relief:.2f} mm. "
        )
    return words


def _proven(found: HuangStudy) -> str:
    """What is shown, and what is only plausible."""
    measured = found.kinds[-1]
    drained = found.kinds[-2]
    return (
        "Shown: seal types alone can make B rise on one cylinder and fall on the other. Not "
        "shown: that they did in this one. A fall needs a long relief and no pressure between the "
        "seals, neither of which the paper states, and table 2 falls to "
        f"{text.number(measured.rise, 2)} from {mega(measured.damping[0])} MN·s/m at 0.6 MPa, "
        f"{times(measured.damping[0] / drained.damping[0])} ours without pressure between. "
        "Chosen by us: relief, land, squeeze, lip, oil and roughness; given by the paper: dry "
        f"friction {listed([text.trimmed(x) for x in PAPER.dry_friction])}."
    )
