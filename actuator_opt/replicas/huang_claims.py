"""What [Huang2017] claims of its cylinders, judged by our films: one verdict a claim.

The text of the paper prints few numbers: table 2, a claimed fall of B and the chamber's shear.
"""

from __future__ import annotations

import math

import numpy as np

from ..design.model import Design
from ..models.friction import HUANG_TABLE_2
from ..rendering import text
from ..rendering.blocks import Drawing, ExtraTable
from ..studies.film_walk import FilmMap
from . import huang_figures, huang_notes, huang_published, huang_trend
from .huang import TYPICAL
from .huang_published import PAPER
from .huang_study import HuangStudy
from .huang_text import OPEN, holds, mega, newtons, pressure_text, speed_text, times, verdict
from .paper_text import percent

CLAIMS = ("claim of the paper", "paper", "ours", "verdict")
NEAR = 1.3
"""Factor within which a simulated damping agrees with the measured."""
STILL = 1.2
"""Factor within which a damping no longer falls at twice the speed."""


def cylinder_table(design: Design, found: HuangStudy) -> ExtraTable:
    """Figure 3: the piston cylinder of test A."""
    mapped, damping = found.cylinder, found.cylinder.damping
    speed, pressure = PAPER.shown_a
    i = int(np.argmin(np.abs(mapped.pressures - pressure)))
    j = mapped.piston.at(0.0, TYPICAL)[1]
    shown = np.interp(speed, mapped.piston.speeds, damping[i] * mapped.piston.speeds) / speed
    six = damping[int(np.argmin(np.abs(mapped.pressures - PAPER.compared))), j]
    table = float(huang_published.secant_of(HUANG_TABLE_2[-1], TYPICAL))
    ours = found.plunger.damping[found.plunger.at(PAPER.compared, TYPICAL)]
    over = float(six / table), float(six / ours)
    rows = [
        (
            "B falls from 0.5 to 10 mm/s",
            "figure 3",
            f"{mega(damping[i, 0])} to {mega(damping[i, -1])} MN·s/m at {pressure_text(pressure)}",
            holds(bool(np.all(np.diff(damping, axis=1) < 0)), *np.ravel(damping)),
        ),
        (
            "B rises with the chamber's pressure",
            "conclusion 2",
            f"{mega(damping[0, j])} to {mega(damping[-1, j])} MN·s/m from "
            f"{pressure_text(mapped.pressures[0])} to {pressure_text(mapped.pressures[-1])} "
            f"at {speed_text(TYPICAL)}",
            holds(bool(np.all(np.diff(damping[:, j]) > 0)), *damping[:, j]),
        ),
        (
            "B is larger than the plunger's",
            "section 2",
            f"{times(over[0])} table 2, {times(over[1])} our plunger at 6 MPa and "
            f"{speed_text(TYPICAL)}",
            verdict(float(np.mean([x > 1 if math.isfinite(x) else math.nan for x in over]))),
        ),
        (
            "the point 9.17 mm/s, 7.15 MPa",
            "figure 3(b), drawn only",
            f"{mega(float(shown))} MN·s/m, {newtons(float(shown) * speed)}",
            "no number to compare",
        ),
    ]
    drawn = Drawing(
        "Huang 2017: piston cylinder, as its figure 3",
        huang_figures.cylinder_figure(found),
        "Piston and rod seals on their films, driven out; the rod chamber at return pressure. "
        "Contours over a logarithmic speed.",
    )
    note = huang_notes.cylinder_note(design, found)
    return ExtraTable("Huang 2017: piston cylinder, test A", CLAIMS, rows, note, drawn)


def _ends(mapped: FilmMap, low: float, high: float, speed: float) -> tuple[float, float]:
    return float(mapped.damping[mapped.at(low, speed)]), float(
        mapped.damping[mapped.at(high, speed)]
    )


def simulated_table(_: Design, found: HuangStudy) -> ExtraTable:
    """Figures 15 and 16: what the paper says of its simulation, by ours."""
    rows = [*_trends(found), _asymptote(found), *_between(found)]
    drawn = Drawing(
        "Huang 2017: plunger at 6, 8 and 10 MPa, as its figures 15 and 16",
        huang_figures.simulated_figure(found),
    )
    note = huang_notes.simulated_note(found)
    return ExtraTable("Huang 2017: its simulation by ours", CLAIMS, rows, note, drawn)


def _trends(found: HuangStudy) -> list[tuple[str, ...]]:
    """Claims on the curves over speed and pressure."""
    mapped = found.plunger
    table = np.asarray(huang_published.secant_of(HUANG_TABLE_2[-1], mapped.speeds))
    ratio = mapped.damping[mapped.at(PAPER.compared, 0.0)[0]] / table
    low, high = _ends(mapped, *PAPER.simulated, TYPICAL)
    first, last = _ends(mapped, *PAPER.pressures, TYPICAL)
    claim = huang_published.claim_at(TYPICAL)
    slowest, fastest = huang_published.claim_speeds()
    falls = np.diff(mapped.damping, axis=1) < 0
    least, most = (text.trimmed(float(pick(ratio)), 2) for pick in (np.min, np.max))
    return [
        (
            "B falls with speed at every pressure",
            "figures 7, 15, 16",
            f"{percent(float(np.mean(falls)), 3)} of the steps fall; all of table 2",
            holds(bool(np.all(falls)), *np.ravel(mapped.damping)),
        ),
        (
            "B falls from 0.65 to 0.2 MN·s/m from 0.6 to 6 MPa",
            "section 2; table 2 within 15 % from "
            f"{text.trimmed(1e3 * slowest, 3)} to {text.trimmed(1e3 * fastest, 3)} mm/s only",
            f"{mega(first)} to {mega(last)} MN·s/m at {speed_text(TYPICAL)} "
            f"(table 2: {mega(claim.low)} to {mega(claim.high)})",
            holds(last < first, first, last),
        ),
        (
            "simulated B agrees with the measured at 6 MPa",
            "figure 15",
            f"{least} to {most} times table 2",
            holds(bool(np.all(np.abs(np.log(ratio)) < math.log(NEAR))), *ratio),
        ),
        (
            "B falls drastically from 8 to 10 MPa",
            "figure 16",
            f"{mega(low)} to {mega(high)} MN·s/m at {speed_text(TYPICAL)}",
            holds(high < low, low, high),
        ),
    ]


def _asymptote(found: HuangStudy) -> tuple[str, ...]:
    """Whether B comes to a constant beyond the tested speeds."""
    fast, viscous = found.fast.damping[0], found.fast.viscous[0]
    known = np.flatnonzero(np.isfinite(fast))
    reached = min(map(huang_published.asymptote_speed, HUANG_TABLE_2))
    paper = f"figure 15; table 2 comes within 10 % of it from {speed_text(reached)} on"
    claim = "B reaches an asymptote, sigma2"
    if known.size < 2:
        return claim, paper, "no film", OPEN
    last, before = int(known[-1]), int(known[-2])
    ours = (
        f"{mega(float(fast[last]))} MN·s/m at {speed_text(float(found.fast.speeds[last]))}, "
        f"{percent(float(viscous[last]))} of it oil"
    )
    fell = float(fast[last] / fast[before])
    still = (
        f", {percent(1 - fell)} below that at half the speed" if fell < 1 else ", no longer falling"
    )
    return claim, paper, ours + still, holds(fell > 1 / STILL, fell)


def _between(found: HuangStudy) -> list[tuple[str, ...]]:
    """The pressure between two seals; nothing for one."""
    mapped = found.plunger
    share = mapped.between / mapped.pressures[:, None]
    beyond = found.fast.between[0] / PAPER.compared
    if not np.any(np.isfinite(share)):
        return []
    above = np.flatnonzero(beyond > 1)
    words = "never above it at 6 MPa up to " + speed_text(float(found.fast.speeds[-1]))
    if above.size:
        words = f"above it at 6 MPa from {speed_text(float(found.fast.speeds[above[0]]))}"
    return [
        (
            "the pressure between the seals can exceed the sealed one",
            "section 3.2",
            f"{text.trimmed(float(np.nanmin(share)), 2)} to "
            f"{text.trimmed(float(np.nanmax(share)), 2)} times it up to 10 mm/s; {words}",
            holds(bool(above.size or np.nanmax(share) > 1)),
        )
    ]


def ring_table(_: Design, found: HuangStudy) -> ExtraTable:
    """Figures 17 and 18: the step ring's contact and film over pressure."""
    stress, mapped = found.stress, found.plunger
    low, high = (float(np.interp(p, stress.pressures, stress.peak)) for p in (2e6, PAPER.tightest))
    last = float(stress.peak[-1])
    films = mapped.thickness[:, mapped.at(0.0, huang_trend.FILM_SPEED)[1], 0]
    most = float(stress.pressures[int(np.argmax(stress.excess))])
    rows = [
        (
            "the largest contact stress rises from 2 to 5 MPa",
            "figure 17",
            f"{pressure_text(low)} to {pressure_text(high)}",
            holds(high > low),
        ),
        (
            "beyond 5 MPa it falls",
            "figure 17",
            f"{pressure_text(last)} at 10 MPa; its excess over the oil pressure is largest, "
            f"{pressure_text(float(stress.excess.max()))}, at {pressure_text(most)}",
            verdict(float(np.mean([last < high, most < stress.pressures[-1]]))),
        ),
        (
            "the contact grows longer",
            "figure 17",
            f"{text.number(1e3 * float(stress.width[0]), 3)} to "
            f"{text.number(1e3 * float(stress.width[-1]), 3)} mm",
            holds(bool(np.all(np.diff(stress.width) > 0))),
        ),
        (
            "the mean film grows with pressure",
            "figure 18",
            f"{text.number(1e6 * float(films[0]), 4)} to {text.number(1e6 * float(films[-1]), 4)} "
            f"µm from {pressure_text(mapped.pressures[0])} to "
            f"{pressure_text(mapped.pressures[-1])}",
            holds(bool(films[-1] > films[0]), float(films[0]), float(films[-1])),
        ),
    ]
    drawn = Drawing(
        "Huang 2017: step ring over the sealed pressure, as its figures 17 and 18",
        huang_figures.ring_figure(found),
        "Contact of a run-in face by its radial balance; films of the step ring in the tandem.",
    )
    note = huang_notes.ring_note(found)
    return ExtraTable("Huang 2017: step ring at rest and running", CLAIMS, rows, note, drawn)
