"""Sentences that compare the paper with this project's models."""

from __future__ import annotations

import math

import numpy as np

from ..design.model import Design
from ..models.friction import HUANG_TABLE_2
from ..rendering import text
from ..studies.film_walk import Missing
from . import huang_published
from .huang_models import (
    BOTH,
    CHAMBER,
    TYPICAL,
    HuangStudy,
)
from .huang_published import PAPER, SEAL_VISCOSITY
from .papers import (
    listed,
    newtons,
    of_another_cylinder,
    percent,
    pressure_text,
    speed_text,
    times,
)

AGREES, DISAGREES, IN_PART = "agrees", "disagrees", "agrees in part"


OPEN = "no film"
"""Verdict where no film exists to judge a claim."""


def mega(value: float, digits: int = 3) -> str:
    """A damping in MN s/m."""
    return text.number(float(value) / 1e6, digits)


def verdict(share: float) -> str:
    """Verdict by the share of a claim that holds; pass NaN if no film exists to judge it."""
    if not math.isfinite(share):
        return OPEN
    return AGREES if share >= 1 else DISAGREES if share <= 0 else IN_PART


def other_cylinder(design: Design) -> str:
    """Note that the paper measured another cylinder; empty if it is the same."""
    return of_another_cylinder(design, "paper", (PAPER.bore, PAPER.rod, PAPER.stroke))


NEGLIGIBLE = 0.05
"""Share of the seals' damping up to which a part can be neglected."""


EVEN = 0.02
"""Relative change below which a damping counts as independent of pressure."""


def _dry(viscous: np.ndarray) -> str:
    """Sentence on the share of oil shear in the friction at the tested speeds."""
    most = float(np.nanmax(np.abs(viscous))) if np.any(np.isfinite(viscous)) else math.nan
    if math.isnan(most):
        return "No point has a film."
    if most < 0.05:
        return (
            f"Oil shear is at most {percent(most)} of the friction. At these speeds "
            "asperities cause nearly all of it, so friction hardly changes with speed and "
            "B falls as 1/v."
        )
    return f"Oil shear is up to {percent(most)} of the friction."


def _reasons(why: tuple[Missing, ...]) -> str:
    """Words on points without a film and the reasons."""
    if not why:
        return ""
    more = f", and {len(why) - 1} more points" if len(why) > 1 else ""
    first = why[0]
    at = f"{pressure_text(first.pressure)}, {speed_text(first.speed)}"
    return f" No film at {at}: {first.reason}{more}."


def cylinder_note(design: Design, study: HuangStudy) -> str:
    """Note below figure 3."""
    mapped = study.cylinder
    i, j = int(np.argmin(np.abs(mapped.pressures - PAPER.shown_pressure))), -1
    piston, rod = float(mapped.piston.friction[i, j]), float(mapped.rod.friction[0, j])
    return (
        f"B: damping (friction / speed). {other_cylinder(design)}Seals and oil are those of this "
        "design, as the paper names only the types of its seals. Nothing is fitted to its "
        f"curves. At 7.15 MPa and 10 mm/s the friction of the piston seal is {newtons(piston)}, "
        f"that of the rod seal at return pressure {newtons(rod)}; wiper and guides are neglected. "
        f"{_dry(mapped.piston.viscous)} The paper's R² of 1 (sums of squares "
        f"{listed([text.number(x, 2) for x in PAPER.interpolation])}) results from "
        "surfaces through every point, so it does not show the "
        f"errors.{_reasons(mapped.piston.why + mapped.rod.why)}"
    )


def plunger_note(design: Design, study: HuangStudy) -> str:
    """Note below figure 6."""
    mapped = study.plunger
    j = mapped.at(0.0, TYPICAL)[1]
    curve = mapped.damping[:, j]
    ours = float(curve[mapped.at(PAPER.pressures[1], 0.0)[0]] / curve[0])
    table = [float(huang_published.secant_of(row, TYPICAL)) for row in HUANG_TABLE_2]
    theirs = table[-1] / table[0]
    if math.isnan(ours):
        words = "Our model has no film at one of the two pressures. "
    elif ours > 1 + EVEN:
        words = (
            f"From 0.6 to 6 MPa at {speed_text(TYPICAL)}, the damping of table 2 falls to "
            f"{text.trimmed(theirs, 2)} of its value and ours rises to {times(ours)} its value, "
            "so our model does not reproduce the measured trend. "
        )
    elif ours < 1 - EVEN:
        words = (
            f"From 0.6 to 6 MPa both dampings fall: to {theirs:.2f} (table 2) and {ours:.2f} "
            "(ours) of their value. "
        )
    else:
        words = (
            f"From 0.6 to 6 MPa, the damping of table 2 falls to {theirs:.2f} of its value; ours "
            "does not change. "
        )
    share = [huang_published.balance_error(float(v)) for v in huang_published.SPEEDS]
    return (
        f"{words}{_dry(mapped.viscous)} {_between(study)}The measured fall is doubtful: "
        "friction is the difference of two large forces (eq. 1), and an error of "
        f"{percent(min(share))} to {percent(max(share))} in the change of the pressure "
        "force, from sensor or area, is as large as the whole fall at the tested speeds. "
        "The paper states no accuracy. We do not know whether the measured or the "
        f"computed trend is right.{_reasons(mapped.why)}"
    )


def _between(study: HuangStudy) -> str:
    """Sentence on the share of the pressure that each seal of the tandem carries."""
    mapped = study.plunger
    share = mapped.between / mapped.pressures[:, None]
    if not np.any(np.isfinite(share)):
        return ""
    i, j = mapped.at(PAPER.compared, TYPICAL)
    step, second = (float(x) for x in mapped.parts[i, j])
    return (
        "At 6 MPa and with the same flow past both seals, the outer seal carries "
        f"{percent(float(share[i, j]))} of the pressure and causes {newtons(second)} of "
        f"the {newtons(step + second)} of friction. "
    )


def fits_note(study: HuangStudy) -> str:
    """Note below the fits."""
    exponents = [fits.power.values["exponent"] for fits in study.published]
    exponents += [fits.power.values["exponent"] for _, fits in study.films]
    rates = [
        value
        for fits in (*study.published, *(fit for _, fit in study.films))
        for name, value in fits.double.values.items()
        if name.startswith("rate")
    ]
    errors = [max(fits.power.largest_error, fits.double.largest_error) for fits in study.published]
    if max(*exponents, *rates) < 0:
        words = (
            "Every exponent is below 0, so the printed conditions b > 0 do not apply to "
            "these curves (our copy of the text may lack a minus sign, as in eq. 2 and "
            "31). "
        )
    else:
        words = "Not every exponent is below 0. "
    loose = [
        text.trimmed(fits.row.pressure / 1e6)
        for fits in study.published
        if not (fits.power.determined and fits.double.determined)
    ]
    doubt = ""
    if loose:
        doubt = (
            f" In the fits of table 2 at {listed(loose)} MPa, at least one parameter has an "
            "error above 30 %."
        )
    return (
        "Intervals are for 95 % (Student's t, linearised law); the fits are least squares "
        f"in B. {words}R² depends mainly on the slow points; at the fast points the fits "
        f"of table 2 still deviate by up to {percent(max(errors))} of B. Our curves are "
        f"power laws near v^−1, which means friction that does not depend on speed.{doubt}"
    )


def simulated_note(study: HuangStudy) -> str:
    """Note below figures 15 and 16."""
    mapped = study.plunger
    i = mapped.at(PAPER.compared, 0.0)[0]
    ours = mapped.friction[i]
    theirs = [huang_published.friction_of(HUANG_TABLE_2[-1], v) for v in PAPER.speeds]
    return (
        "The paper gives neither the inputs of its simulation nor its static pressures, "
        "so its curves cannot be recomputed; the curves here are those of this design. "
        f"Friction at 6 MPa from 0.5 to 10 mm/s: table 2 {newtons(float(theirs[0]))} to "
        f"{newtons(float(theirs[1]))}, ours {newtons(ours[0])} to {newtons(ours[-1])}. "
        f"{_stribeck(ours, study)}The viscous part sigma2 v is "
        f"{percent(huang_published.viscous_share(HUANG_TABLE_2[0], 10e-3))} to "
        f"{percent(huang_published.viscous_share(HUANG_TABLE_2[-1], 10e-3))} of the "
        "friction of table 2 at 10 mm/s, so the asymptote of B lies outside the tested "
        f"speeds.{_reasons(study.fast.why)}"
    )


def _stribeck(ours: np.ndarray, study: HuangStudy) -> str:
    """Sentence on whether our friction falls over the tested speeds, as in table 2."""
    if not np.all(np.isfinite(ours)) or ours[-1] < 0.9 * ours[0]:
        return ""
    i = study.plunger.at(PAPER.compared, 0.0)[0]
    share = float(np.max(np.abs(study.plunger.viscous[i])))
    return (
        "Our films do not show the Stribeck fall of table 2: up to 10 mm/s, speed does "
        f"not lift the seals off their asperities (oil shear is at most {percent(share)} "
        "of the friction). "
    )


def ring_note(study: HuangStudy) -> str:
    """Note below figures 17 and 18."""
    ring = study.sealings.plunger.rings[0]
    kind = study.kinds[1]
    words = (
        f"First rod seal on a {text.trimmed(1e3 * PAPER.plunger)} mm plunger, section "
        f"{text.trimmed(1e3 * ring['section'])} mm, squeeze {percent(ring['squeeze'])}"
    )
    if "relief" in ring.numbers:
        words += (
            f", relief {text.trimmed(1e3 * ring['relief'])} mm of the ring's "
            f"{text.trimmed(1e3 * ring['width'])} mm width, assumed"
        )
    words += (
        f"; pressure balance {text.trimmed(kind.balance, 3)}. The largest stress includes "
        "the sealed pressure itself, so it can fall with pressure only if the balance is "
        "below 0. The excess over the oil pressure, which asperities carry, falls if the "
        "balance is below 1/2. The peak in the paper may be at the edge of a tilting, "
        "unworn ring, which a run-in face does not have. "
    )
    thickness = study.plunger.thickness[:, :, 0]
    known = thickness[np.isfinite(thickness)]
    if not known.size:
        return words
    spread = float(known.max() / known.min() - 1)
    return (
        f"{words}The mean film thickness of this ring varies by {percent(spread)} over all points "
        "of the map."
    )


def parts_note(study: HuangStudy, dry: float) -> str:
    """Note below the parts of eq. 26."""
    most = max(total.beside_share for total in study.totals)
    chamber = max(total.share(CHAMBER) for total in study.totals)
    member = huang_published.plausible_chamber()
    ring = min(float(np.min(ring.film.film)) for ring in study.rings)
    seals = min(total.seals * total.speed for total in study.totals)
    verdict = "can be neglected, as the paper says" if most < NEGLIGIBLE else "cannot be neglected"
    if math.isnan(most):
        verdict = "cannot be judged, as a point has no film"
    return (
        f"Back-up ring and chamber {verdict}: together their damping is at most {percent(most)} of "
        f"that of the seals, that of the chamber alone {percent(chamber, 1)}. This applies to a "
        f"ring on a smooth oil film; its least film thickness, {text.trimmed(1e6 * ring, 2)} µm, "
        f"is thinner than the seals' roughness, and its dry friction would be {newtons(dry)}, "
        f"{percent(dry / seals)} of the least friction of the seals. The paper prints "
        f"{PAPER.chamber_shear} N·s/m for the chamber without inputs. The formula eta pi d L/h_v "
        f"gives this value for L = {text.trimmed(1e3 * member.length)} mm, "
        f"eta = {SEAL_VISCOSITY} Pa·s (both assumed) and "
        f'h_v = {text.trimmed(1e3 * member.gap, 2)} mm, which is not a "fairly large gap"; '
        f"a gap of 1 mm would need {text.trimmed(huang_published.chamber_length(gap=1e-3), 3)} m "
        "of plunger in the oil."
    )


def kinds_note(study: HuangStudy) -> str:
    """Note on why pressure may raise or lower the damping."""
    words = (
        "The balance k is the increase of the load on a sealing face with pressure, "
        "divided by the width of the face. If the oil pressure falls evenly across the "
        "face, the oil carries half of the sealed pressure. Where asperities cause the "
        "friction, B therefore rises with pressure for k above 1/2 and falls for k below "
        "1/2. "
    )
    compact = study.kinds[0]
    if compact.rise > 1 + EVEN:
        share = text.trimmed(compact.balance, 2)
        words += (
            f"The piston seal has k = {share}, and from 0.6 to 6 MPa its B rises to "
            f"{times(compact.rise)} its value. "
        )
    whole = [kind for kind in study.kinds if kind.name == BOTH]
    for kind in whole:
        words += (
            f"B of the two rod seals in series rises to {times(kind.rise)} its value, because the "
            "outer seal carries most of the pressure when the same flow passes both. "
            if kind.rise > 1 + EVEN
            else "B of the two rod seals in series does not rise. "
        )
    return words + (_proven(study) if whole else "")


def relief_note(study: HuangStudy) -> str:
    """Note on the relief at which the trend over pressure reverses."""
    turn = study.turn
    if turn is None:
        return (
            "The first rod seal of this design is not a step ring, so no relief can "
            "reverse its trend."
        )
    if math.isnan(turn.relief):
        return "No relief reverses the trend of its step ring. " + _tandem(study)
    return (
        "For the step ring alone, the trend of B turns from rising to falling at a relief "
        f"of {1e3 * turn.relief:.2f} mm, {percent(turn.share)} of the ring's width, where k = "
        f"{turn.balance:.2f}; the design has "
        f"{text.trimmed(1e3 * study.sealings.plunger.rings[0]['relief'])} mm. " + _tandem(study)
    )


def _tandem(study: HuangStudy) -> str:
    """Sentences on the effect of the second seal."""
    if not study.whole:
        return ""
    least = float(np.nanmin(study.whole))
    falls = [
        (shape.relief, rise)
        for shape, rise in zip(study.reliefs, study.drained, strict=True)
        if rise < 1 - EVEN
    ]
    words = (
        "With the same flow past both seals, no relief shown reverses the trend (B rises "
        f"to at least {times(least)} its value without relief), because the Yx seal behind the "
        "step ring carries the pressure. "
        if least > 1
        else "With the same flow past both seals some reliefs reverse the trend too. "
    )
    if falls:
        relief, rise = falls[-1]
        words += (
            "Without pressure between the seals, as if the space there were drained, B "
            f"falls to {text.number(rise, 2)} of its value without relief at a relief of "
            f"{1e3 * relief:.2f} mm. "
        )
    return words


def _proven(study: HuangStudy) -> str:
    """Sentences on what is shown and what is only plausible."""
    measured = study.kinds[-1]
    drained = study.kinds[-2]
    return (
        "This shows that seal types alone can make B rise on one cylinder and fall on the "
        "other. It does not show that they did so in the tests: a fall requires a long "
        "relief and no pressure between the seals, and the paper states neither. In "
        f"table 2, B is {mega(measured.damping[0])} MN·s/m at 0.6 MPa, "
        f"{times(measured.damping[0] / drained.damping[0])} our value without pressure between "
        f"the seals, and falls to {text.number(measured.rise, 2)} of this. We chose relief, "
        "land, squeeze, lip, oil and roughness; the paper gives only the dry friction coefficients "
        f"{listed([text.trimmed(x) for x in PAPER.dry_friction])}."
    )
