"""Tables that compare [Huang2017] with this project's films, judge its claims.

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
from ..studies.film_walk import FilmMap
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
    CHAMBER,
    FILM_SPEED,
    TYPICAL,
    HuangStudy,
    Readings,
    dry_ring,
    kind_name,
    study_of,
)
from .huang_notes import (
    OPEN,
    cylinder_note,
    fits_note,
    kinds_note,
    mega,
    parts_note,
    plunger_note,
    relief_note,
    ring_note,
    simulated_note,
    verdict,
)
from .huang_published import PAPER, CurveFits
from .papers import (
    SLASH,
    TRACE_COLUMNS,
    claim,
    equations,
    newtons,
    percent,
    pressure_text,
    rounded,
    speed_text,
    times,
    trace_rows,
)


def megas(values: Sequence[float] | Array, digits: int = 3) -> str:
    """Damping values of a row as text for a single cell."""
    return SLASH.join(mega(float(value), digits) for value in values)


def holds(fact: bool, *values: float) -> str:
    """Verdict on a claim; open unless all of its numbers are finite."""
    return verdict(float(fact) if all(map(math.isfinite, values)) else math.nan)


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
