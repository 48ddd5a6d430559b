"""Tables that compare [Huang2017] with this project's films, judge its claims, and their notes.

The text of the paper prints few numbers: table 2, a claimed fall of the damping B, and the shear
drag in the chamber. We judge its claims by our film models with the design's seals, without fitting
them to the paper. Verdicts follow from the values of the given design.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..base.numeric import Array
from ..design.material import LawFit
from ..design.model import Design
from ..evaluation import Evaluation
from ..models.friction import HUANG_TABLE_2
from ..rendering import text
from ..rendering.blocks import Block, Drawing, text_table
from ..studies.film_walk import FilmMap, Missing
from . import huang_published
from .huang_figures import (
    SHOWN,
    back_up_figure,
    cylinder_figure,
    plunger_figure,
    relief_figure,
    ring_figure,
    simulated_figure,
    speed_figure,
)
from .huang_models import (
    BACK_UP,
    BOTH,
    CHAMBER,
    FILM_SPEED,
    TYPICAL,
    HuangStudy,
    Readings,
    dry_ring,
    kind_name,
    study_of,
)
from .huang_published import PAPER, SEAL_VISCOSITY, CurveFits
from .papers import (
    SLASH,
    TRACE_COLUMNS,
    claim,
    equations,
    listed,
    newtons,
    of_another_cylinder,
    percent,
    pressure_text,
    rounded,
    speed_text,
    times,
    trace_rows,
)

AGREES, DISAGREES, IN_PART = "agrees", "disagrees", "agrees in part"

OPEN = "no film"
"""Verdict where no film exists to judge a claim."""


def mega(value: float, digits: int = 3) -> str:
    """A damping in MN s/m."""
    return text.number(float(value) / 1e6, digits)


def megas(values: Sequence[float] | Array, digits: int = 3) -> str:
    """Damping values of a row as text for a single cell."""
    return SLASH.join(mega(float(value), digits) for value in values)


def verdict(share: float) -> str:
    """Verdict by the share of a claim that holds; pass NaN if no film exists to judge it."""
    if not math.isfinite(share):
        return OPEN
    return AGREES if share >= 1 else DISAGREES if share <= 0 else IN_PART


def holds(fact: bool, *values: float) -> str:
    """Verdict on a claim; open unless all of its numbers are finite."""
    return verdict(float(fact) if all(map(math.isfinite, values)) else math.nan)


def other_cylinder(design: Design) -> str:
    """Note that the paper measured another cylinder; empty if it is the same."""
    return of_another_cylinder(design, "paper", (PAPER.bore, PAPER.rod, PAPER.stroke))


CLAIMS = ("claim of the paper", "paper", "ours", "verdict")

NEAR = 1.3
"""Factor within which a simulated damping agrees with the measured damping."""

STILL = 1.2
"""A damping that falls by less than this factor at twice the speed counts as constant."""


def cylinder_table(design: Design, study: HuangStudy) -> list[Block]:
    """Figure 3: the piston cylinder of test A."""
    mapped, damping = study.cylinder, study.cylinder.damping
    speed, pressure = PAPER.shown_speed, PAPER.shown_pressure
    i = int(np.argmin(np.abs(mapped.pressures - pressure)))
    j = mapped.piston.at(0.0, TYPICAL)[1]
    shown = np.interp(speed, mapped.piston.speeds, damping[i] * mapped.piston.speeds) / speed
    six = damping[int(np.argmin(np.abs(mapped.pressures - PAPER.compared))), j]
    table = float(huang_published.secant_of(HUANG_TABLE_2[-1], TYPICAL))
    ours = study.plunger.damping[study.plunger.at(PAPER.compared, TYPICAL)]
    over = float(six / table), float(six / ours)
    rows = [
        (
            *claim("huang", "cylinder_speed"),
            f"{mega(damping[i, 0])} to {mega(damping[i, -1])} MN·s/m at {pressure_text(pressure)}",
            holds(bool(np.all(np.diff(damping, axis=1) < 0)), *np.ravel(damping)),
        ),
        (
            *claim("huang", "cylinder_pressure"),
            f"{mega(damping[0, j])} to {mega(damping[-1, j])} MN·s/m from "
            f"{pressure_text(mapped.pressures[0])} to {pressure_text(mapped.pressures[-1])} "
            f"at {speed_text(TYPICAL)}",
            holds(bool(np.all(np.diff(damping[:, j]) > 0)), *damping[:, j]),
        ),
        (
            *claim("huang", "cylinder_larger"),
            f"{times(over[0])} table 2, {times(over[1])} our plunger at 6 MPa and "
            f"{speed_text(TYPICAL)}",
            verdict(float(np.mean([x > 1 if math.isfinite(x) else math.nan for x in over]))),
        ),
        (
            *claim("huang", "cylinder_point"),
            f"{mega(float(shown))} MN·s/m, {newtons(float(shown) * speed)}",
            "no number to compare",
        ),
    ]
    drawn = Drawing(
        "Huang 2017: piston cylinder, as in figure 3",
        cylinder_figure(study),
        "Piston and rod seals on their oil films, driven outstroke; the rod chamber is at "
        "return pressure. Contours are drawn over speed on a logarithmic axis.",
    )
    note = cylinder_note(design, study)
    return [text_table("Huang 2017: piston cylinder, test A", CLAIMS, rows, note), drawn]


def _ends(mapped: FilmMap, low: float, high: float, speed: float) -> tuple[float, float]:
    return float(mapped.damping[mapped.at(low, speed)]), float(
        mapped.damping[mapped.at(high, speed)]
    )


def simulated_table(_: Design, study: HuangStudy) -> list[Block]:
    """Figures 15 and 16: claims on the paper's simulation, judged by ours."""
    rows = [*_trends(study), _asymptote(study), *_between_rows(study)]
    drawn = Drawing(
        "Huang 2017: plunger at 6, 8 and 10 MPa, as in figures 15 and 16",
        simulated_figure(study),
    )
    note = simulated_note(study)
    return [text_table("Huang 2017: its simulation and ours", CLAIMS, rows, note), drawn]


def _trends(study: HuangStudy) -> list[tuple[str, ...]]:
    """Claims on the curves over speed and pressure."""
    mapped = study.plunger
    table = np.asarray(huang_published.secant_of(HUANG_TABLE_2[-1], mapped.speeds))
    ratio = mapped.damping[mapped.at(PAPER.compared, 0.0)[0]] / table
    low, high = _ends(mapped, *PAPER.simulated, TYPICAL)
    first, last = _ends(mapped, *PAPER.pressures, TYPICAL)
    fall = huang_published.claim_at(TYPICAL)
    slowest, fastest = (text.trimmed(1e3 * v, 3) for v in huang_published.claim_speeds())
    falls = np.diff(mapped.damping, axis=1) < 0
    least, most = (text.trimmed(float(pick(ratio)), 2) for pick in (np.min, np.max))
    return [
        (
            *claim("huang", "plunger_speed"),
            f"B falls in {percent(float(np.mean(falls)), 3)} of our speed steps; in table 2 always",
            holds(bool(np.all(falls)), *np.ravel(mapped.damping)),
        ),
        (
            *claim("huang", "plunger_pressure", slowest=slowest, fastest=fastest),
            f"{mega(first)} to {mega(last)} MN·s/m at {speed_text(TYPICAL)} "
            f"(table 2: {mega(fall.low)} to {mega(fall.high)})",
            holds(last < first, first, last),
        ),
        (
            *claim("huang", "simulated_measured"),
            f"{least} to {most} times table 2",
            holds(bool(np.all(np.abs(np.log(ratio)) < math.log(NEAR))), *ratio),
        ),
        (
            *claim("huang", "simulated_pressure"),
            f"{mega(low)} to {mega(high)} MN·s/m at {speed_text(TYPICAL)}",
            holds(high < low, low, high),
        ),
    ]


def _asymptote(study: HuangStudy) -> tuple[str, ...]:
    """Whether B becomes constant beyond the tested speeds."""
    fast, viscous = study.fast.damping[0], study.fast.viscous[0]
    known = np.flatnonzero(np.isfinite(fast))
    reached = min(map(huang_published.asymptote_speed, HUANG_TABLE_2))
    stated = claim("huang", "asymptote", speed=speed_text(reached))
    if known.size < 2:
        return *stated, "no film", OPEN
    last, before = int(known[-1]), int(known[-2])
    ours = (
        f"{mega(float(fast[last]))} MN·s/m at {speed_text(float(study.fast.speeds[last]))}, "
        f"{percent(float(viscous[last]))} of it from oil shear"
    )
    fell = float(fast[last] / fast[before])
    still = (
        f", {percent(1 - fell)} less than at half the speed" if fell < 1 else ", no longer falling"
    )
    return *stated, ours + still, holds(fell > 1 / STILL, fell)


def _between_rows(study: HuangStudy) -> list[tuple[str, ...]]:
    """Row on the claim about the pressure between two seals; empty for a single seal."""
    mapped = study.plunger
    share = mapped.between / mapped.pressures[:, None]
    beyond = study.fast.between[0] / PAPER.compared
    if not np.any(np.isfinite(share)):
        return []
    above = np.flatnonzero(beyond > 1)
    words = "at 6 MPa never higher than this pressure up to " + speed_text(
        float(study.fast.speeds[-1])
    )
    if above.size:
        words = (
            "at 6 MPa higher than this pressure at "
            f"{speed_text(float(study.fast.speeds[above[0]]))} or more"
        )
    return [
        (
            *claim("huang", "pressure_between"),
            f"{text.trimmed(float(np.nanmin(share)), 2)} to "
            f"{text.trimmed(float(np.nanmax(share)), 2)} times the sealed pressure at up to "
            f"10 mm/s; {words}",
            holds(bool(above.size or np.nanmax(share) > 1)),
        )
    ]


def ring_table(_: Design, study: HuangStudy) -> list[Block]:
    """Figures 17 and 18: the step ring's contact and film over pressure."""
    stress, mapped = study.stress, study.plunger
    low, high = (float(np.interp(p, stress.pressures, stress.peak)) for p in (2e6, PAPER.tightest))
    last = float(stress.peak[-1])
    films = mapped.thickness[:, mapped.at(0.0, FILM_SPEED)[1], 0]
    most = float(stress.pressures[int(np.argmax(stress.excess))])
    rows = [
        (
            *claim("huang", "stress_rises"),
            f"{pressure_text(low)} to {pressure_text(high)}",
            holds(high > low),
        ),
        (
            *claim("huang", "stress_falls"),
            f"{pressure_text(last)} at 10 MPa; its excess over the oil pressure is largest, "
            f"{pressure_text(float(stress.excess.max()))}, at {pressure_text(most)}",
            verdict(float(np.mean([last < high, most < stress.pressures[-1]]))),
        ),
        (
            *claim("huang", "contact_grows"),
            f"{text.number(1e3 * float(stress.width[0]), 3)} to "
            f"{text.number(1e3 * float(stress.width[-1]), 3)} mm",
            holds(bool(np.all(np.diff(stress.width) > 0))),
        ),
        (
            *claim("huang", "film_grows"),
            f"{text.number(1e6 * float(films[0]), 4)} to {text.number(1e6 * float(films[-1]), 4)} "
            f"µm from {pressure_text(mapped.pressures[0])} to "
            f"{pressure_text(mapped.pressures[-1])}",
            holds(bool(films[-1] > films[0]), float(films[0]), float(films[-1])),
        ),
    ]
    drawn = Drawing(
        "Huang 2017: step ring versus sealed pressure, as in figures 17 and 18",
        ring_figure(study),
        (
            "Contact of a run-in face by its radial force balance; films of the step ring "
            "in series with the second seal."
        ),
    )
    note = ring_note(study)
    return [text_table("Huang 2017: step ring at rest and running", CLAIMS, rows, note), drawn]


def plunger_table(design: Design, study: HuangStudy) -> list[Block]:
    """Figure 6: damping by table 2 and by our films, over speed and pressure."""
    mapped = study.plunger
    columns = [mapped.at(0.0, v)[1] for v in SHOWN]
    rows = []
    for row in HUANG_TABLE_2:
        theirs = np.array([float(huang_published.secant_of(row, v)) for v in SHOWN])
        ours = mapped.damping[mapped.at(row.pressure, 0.0)[0], columns]
        ratio = " / ".join(text.number(float(x), 2) for x in ours / theirs)
        rows.append((pressure_text(row.pressure), megas(theirs), megas(ours), ratio))
    for pressure in PAPER.simulated:
        ours = mapped.damping[mapped.at(pressure, 0.0)[0], columns]
        rows.append((pressure_text(pressure), text.DASH, megas(ours), text.DASH))
    at = ", ".join(text.trimmed(1e3 * v) for v in SHOWN)
    drawn = Drawing(
        "Huang 2017: plunger versus speed and pressure, as in figure 6",
        plunger_figure(study),
        "Above: eq. 31 with the paper's table 2. Below: step ring and Yx seal on their oil "
        "films, with the same flow past both, outstroke.",
    )
    names = ("pressure", f"table 2, MN·s/m at {at} mm/s", "our films", "ours / table 2")
    note = plunger_note(design, study)
    return [text_table("Huang 2017: plunger, test B", names, rows, note), drawn]


def _power(fit: LawFit) -> str:
    a, b = fit.parameters["coefficient"], fit.parameters["exponent"]
    return (
        f"{text.number(a.value, 3)} v^{text.number(b.value, 4)} "
        f"({text.number(b.lower, 4)} to {text.number(b.upper, 4)})"
    )


def _double(fit: LawFit) -> str:
    parts = []
    for k in ("1", "2"):
        a, b = fit.parameters[f"coefficient_{k}"], fit.parameters[f"rate_{k}"]
        half = b.upper - b.value
        parts.append(f"{mega(a.value)} e^({text.number(b.value, 3)} ± {text.number(half, 2)})v")
    return "; ".join(parts)


def _quality(fit: LawFit) -> str:
    square = text.DASH if fit.r_squared is None else f"{fit.r_squared:.4f}"
    return f"{square}, {percent(fit.largest_error)}"


def fits_table(_: Design, study: HuangStudy) -> list[Block]:
    """Figures 7 and 8: both damping laws, fitted to table 2 and to our films."""
    curves: list[tuple[str, CurveFits]] = [
        (f"table 2, {pressure_text(fits.row.pressure)}", fits) for fits in study.published
    ]
    curves += [(f"our films, {pressure_text(p)}", fits) for p, fits in study.films]
    rows = [
        (
            name,
            _power(fits.power),
            _quality(fits.power),
            _double(fits.double),
            _quality(fits.double),
        )
        for name, fits in curves
    ]
    drawn = Drawing(
        "Huang 2017: damping versus speed and versus pressure, as in figures 7 and 8",
        speed_figure(study),
        "Left: the paper's table 2; right: our oil films.",
    )
    names = (
        "curve",
        "a v^b, SI; bounds of b",
        "R², largest error",
        "a1 e^(b1 v) + a2 e^(b2 v), a in MN·s/m, b in s/m",
        "R², largest error",
    )
    return [text_table("Huang 2017: fits over speed", names, rows, fits_note(study)), drawn]


def parts_table(_: Design, study: HuangStudy) -> list[Block]:
    """Equation 26 with each of its parts; figures 19 and 20."""
    rows = []
    for total in study.totals:
        parts = total.parts
        seals = [name for name in parts if name not in (BACK_UP, CHAMBER)]
        rows.append(
            (
                f"{pressure_text(total.pressure)}, {speed_text(total.speed)}",
                " / ".join(rounded(parts[name]) for name in seals),
                f"{rounded(parts[BACK_UP])} ({rounded(total.ring_range[0])} to "
                f"{rounded(total.ring_range[1])})",
                f"{parts[CHAMBER]:.2f}",
                rounded(total.damping),
                percent(total.beside_share),
            )
        )
    drawn = Drawing(
        "Huang 2017: back-up ring, as in figures 19 and 20",
        back_up_figure(study),
        "PTFE of the step ring, 15 mm wide, edges rounded by 5 µm, 0.1 MPa of mean contact "
        "pressure: all assumed, because the paper states none of them.",
    )
    labels = " / ".join(map(kind_name, study.sealings.plunger.rings))
    names = (
        "N·s/m at",
        labels,
        "back-up ring (at 0.02 to 0.2 MPa)",
        "chamber",
        "total, eq. 26",
        "ring and chamber / seals",
    )
    note = parts_note(study, dry_ring(study.sealings))
    return [text_table("Huang 2017: plunger part by part", names, rows, note), drawn]


def kinds_table(_: Design, study: HuangStudy) -> list[Block]:
    """Seal types, whose damping shows why pressure may act oppositely in the two cylinders."""
    rows = [
        (
            kind.name,
            text.trimmed(kind.balance, 3),
            mega(kind.damping[0]),
            mega(kind.damping[1]),
            text.number(kind.rise, 3),
        )
        for kind in study.kinds
    ]
    names = (
        f"seal, {speed_text(TYPICAL)}",
        "balance k",
        "B at 0.6 MPa, MN·s/m",
        "B at 6 MPa",
        "B at 6 / at 0.6 MPa",
    )
    note = kinds_note(study)
    return [text_table("Huang 2017: why damping rises or falls with pressure", names, rows, note)]


def relief_table(_: Design, study: HuangStudy) -> list[Block]:
    """Trend of damping over pressure for several reliefs of the step ring."""
    both = list(zip(study.whole, study.drained, strict=True)) or [(math.nan, math.nan)] * len(
        study.reliefs
    )
    rows = [
        (
            f"{1e3 * relief.relief:.2f} mm",
            f"{1e3 * relief.land:.2f} mm",
            text.number(relief.balance, 3),
            *(text.number(x, 3) for x in (relief.rise, drained, whole)),
        )
        for relief, (whole, drained) in zip(study.reliefs, both, strict=True)
    ]
    ink, drawn = relief_figure(study), []
    if ink is not None:
        drawn = [
            Drawing(
                "Huang 2017: relief of the step ring, and trend with pressure",
                ink,
                "The land is that of the design as long as it fits on the ring, then the "
                "width that the relief leaves. k: pressure balance at 3.3 MPa.",
            )
        ]
    names = (
        "relief",
        "land",
        "balance k",
        "B at 6 / at 0.6 MPa: ring alone",
        "both seals, no pressure between",
        "both seals, same flow",
    )
    note = relief_note(study)
    none = [("no step ring", *(text.DASH,) * 5)]
    title = "Huang 2017: relief of the step ring"
    return [text_table(title, names, rows or none, note), *drawn]


def equations_table(_: Design, study: HuangStudy) -> list[Block]:
    """Every equation of the paper with its function."""
    return table(study.readings)


TABLES: tuple[Callable[[Design, HuangStudy], list[Block]], ...] = (
    cylinder_table,
    plunger_table,
    fits_table,
    simulated_table,
    ring_table,
    parts_table,
    kinds_table,
    relief_table,
    equations_table,
)
"""Every table: test A, test B in the order of its figures, the trends, and the equations."""


def blocks(evaluation: Evaluation) -> list[Block]:
    """Every table and drawing, all from a single study."""
    study = study_of(evaluation.design)
    return [block for table in TABLES for block in table(evaluation.design, study)]


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


TRACES = equations("huang")
"""All equations from 1 to 31, in order."""


def table(readings: Readings) -> list[Block]:
    """Every equation of the paper with its function."""
    note = (
        "The functions are in actuator_opt. In addition to its numbered equations, the paper fits "
        "B = a v^b and B = a1 e^(b1 v) + a2 e^(b2 v), here fits.fit_power_law and "
        "fits.fit_double_exponential. "
    )
    if readings.shift == readings.shift:
        thinner = "thinner" if readings.shift > 0 else "thicker"
        note += (
            "The equations as printed were tried on the first seal alone at 6 MPa and 5 "
            "mm/s. Without the rigid shift of the seal, its film of "
            f"{text.trimmed(1e6 * readings.mean, 3)} µm would be "
            f"{text.trimmed(1e6 * abs(readings.shift), 2)} µm {thinner} and carry "
            f"{percent(abs(readings.excess))} {'more' if readings.excess > 0 else 'less'} "
            "than the load on the seal, so no film meets eq. 12. With the roughness on the rod "
            f"side the flow is {percent(readings.swapped / readings.flow - 1)} larger."
        )
    return [
        text_table(
            "Huang 2017: functions for its equations", TRACE_COLUMNS, trace_rows(TRACES), note
        )
    ]
