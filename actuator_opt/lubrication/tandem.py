"""Two seals in series: find the pressure between them at which both pass the same flow."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..base.dataclass import dataclass
from .film import Film, solve_film
from .reynolds import Contact, Elastic, Lubricant, Surface, Vector

HIGHEST = 1.5
"""Default for the largest pressure between the seals that is tried, as a multiple of the higher of
the two pressures outside."""
MATCH = 1e-8
"""Two flows count as equal up to this difference, as a share of the largest of three flows: these
two, and the flow that the rod drags along."""
_MOST_TRIALS = 60
_EMPTY = 0.9
"""The search for starved films starts with this share of the space between the seals empty."""
_NO_LIMIT = (
    "with {:.4g} Pa between the seals, the inner seal still passes more oil than the outer seal: "
    "the pressure between them exceeds this value"
)
_JUMP = (
    "with {:.3f} of the space between the seals empty, the film jumps from starved to flooded, and "
    "the two flows differ by {:.1e} of the larger flow"
)
_NO_SUPPLY = (
    "with {:.4g} Pa between the seals, oil leaves the space between them on both sides: it runs dry"
)


@dataclass(frozen=True, slots=True)
class TandemSeal:
    """One of two seals in series.

    Parameters
    ----------
    static : function of sealed and outer pressure that returns the contact width [m] and the static
        contact pressure at uniform nodes [Pa]; all pressures are absolute
    elastic, surface : elasticity and roughness of the seal
    """

    static: Callable[[float, float], tuple[float, Vector]]
    elastic: Elastic
    surface: Surface


@dataclass(frozen=True, slots=True)
class Tandem:
    """Two films with the same flow, or the reason for a failure."""

    converged: bool
    reason: str
    pressure: float  # between the seals, absolute [Pa]
    cavitation: float  # share of the space between the seals without oil, if starved [-]
    inner: Film | None
    outer: Film | None
    match_residual: float  # relative difference of both flows, as in `MATCH`


@dataclass(slots=True)
class _Row:
    """Both seals in series, with their last films, from which the next solution starts."""

    inner: TandemSeal
    outer: TandemSeal
    lubricant: Lubricant
    speed: float
    sealed_pressure: float
    outer_pressure: float
    cavitation_pressure: float
    films: tuple[Film | None, Film | None] = (None, None)

    def solve(self, pressure: float, cavitation: float = 0.0) -> tuple[Film, Film]:
        """Solve both films; the seal that draws oil from the space between the seals may starve.

        `cavitation` is the share of that space without oil. In an outstroke the outer seal draws
        oil from it, in an instroke the inner seal.
        """
        draws_out = self.speed > 0
        first = self._film(
            self.inner, self.sealed_pressure, pressure, self.films[0],
            outer_cavitation=0.0 if draws_out else cavitation,
        )  # fmt: skip
        second = self._film(
            self.outer, pressure, self.outer_pressure, self.films[1],
            sealed_cavitation=cavitation if draws_out else 0.0,
        )  # fmt: skip
        if first.converged and second.converged:
            self.films = (first, second)
        return first, second

    def _film(
        self, seal: TandemSeal, sealed: float, outer: float, start: Film | None, **ends: float
    ) -> Film:
        width, static = seal.static(sealed, outer)
        contact = Contact(
            width=width,
            static_pressure=static,
            elastic=seal.elastic,
            surface=seal.surface,
            lubricant=self.lubricant,
            speed=self.speed,
            sealed_pressure=sealed,
            outer_pressure=outer,
            cavitation_pressure=self.cavitation_pressure,
            **ends,
        )
        return solve_film(contact, start)


def solve_tandem(
    *,
    inner: TandemSeal,
    outer: TandemSeal,
    lubricant: Lubricant,
    speed: float,
    sealed_pressure: float,
    outer_pressure: float,
    cavitation_pressure: float = 0.0,
    highest: float = HIGHEST,
    start: Tandem | None = None,
) -> Tandem:
    """Find the pressure between two seals at which both pass the same flow.

    Secant steps search between the cavitation pressure and `highest` times the higher of the two
    pressures outside. As the pressure between the seals rises, the inner seal passes less, compared
    with the outer seal. If one seal draws more than the other supplies even at the cavitation
    pressure, the space between them is starved: it stays at the cavitation pressure, partly filled.

    Parameters
    ----------
    inner, outer : seal on the pressure side, and seal on the outer side
    lubricant : oil of both seals
    speed : rod speed [m/s], positive in the outstroke
    sealed_pressure, outer_pressure, cavitation_pressure : absolute pressures [Pa]
    highest : largest pressure between the seals that is tried, as a multiple of the higher of the
        sealed and the outer pressure [-]
    start : solution of a nearby operating point, from which to start

    Returns
    -------
    both films; with `converged` False and a reason if the flows cannot be made equal
    """
    row = _Row(inner, outer, lubricant, speed, sealed_pressure, outer_pressure, cavitation_pressure)
    guess = (sealed_pressure + outer_pressure) / 2
    if start is not None and start.converged:
        row.films, guess = (start.inner, start.outer), start.pressure
    top = highest * max(sealed_pressure, outer_pressure)
    return _search(row, min(max(guess, cavitation_pressure), top), cavitation_pressure, top)


def _search(row: _Row, guess: float, low: float, high: float) -> Tandem:
    trials: list[tuple[float, float]] = []
    bottom, top, pressure = low, high, guess
    while True:
        first, second = row.solve(pressure)
        if not (first.converged and second.converged):
            side, film = ("outer", second) if first.converged else ("inner", first)
            return _failure(f"{side} seal, with {pressure:.4g} Pa between the seals: {film.reason}")
        surplus = first.flow - second.flow
        carried = abs(row.speed) / 2 * min(first.mean_film, second.mean_film)
        mismatch = abs(surplus) / max(abs(first.flow), abs(second.flow), carried)
        trials.append((pressure, surplus))
        if mismatch <= MATCH:
            return _solution(first, second, pressure, mismatch)
        if pressure == low and surplus < 0:
            return _starved(row, first, second, pressure)
        if pressure == high and surplus > 0:
            return _failure(_NO_LIMIT.format(pressure))
        if len(trials) >= _MOST_TRIALS:
            return _failure(
                f"the flows of both seals still differ by {mismatch:.1e} of the larger "
                "flow after many iterations"
            )
        bottom, top = (pressure, top) if surplus > 0 else (bottom, pressure)
        pressure = _next(trials, bottom, top)


def _next(trials: list[tuple[float, float]], bottom: float, top: float) -> float:
    """The next pressure to try, by a secant through the last two trials or by halving the range.

    `bottom` and `top` enclose the solution. If all trials lie on one side of the solution, the
    opposite end of the range is tried early. Every fifth step halves the range.
    """
    middle = (bottom + top) / 2
    if len(trials) < 2:
        return middle
    (before, surplus_before), (last, surplus) = trials[-2:]
    end = top if surplus > 0 else bottom
    unseen = end not in {pressure for pressure, _ in trials}
    if unseen and len(trials) >= 4:
        return end
    if surplus == surplus_before or len(trials) % 5 == 0:
        return middle
    secant = last - surplus * (last - before) / (surplus - surplus_before)
    if bottom < secant < top:
        return secant
    return end if unseen and (secant >= end) == (surplus > 0) else middle


def _starved(row: _Row, first: Film, second: Film, pressure: float) -> Tandem:
    """Find the share of the space between the seals that has no oil, by regula falsi.

    Sometimes a flooded and a starved film are both possible for the same supply of oil. The search
    starts from an almost empty space, so that it follows the starved film.
    """
    outward = row.speed > 0
    given, drawn = (first, second) if outward else (second, first)
    if given.flow * row.speed <= 0:
        return _failure(_NO_SUPPLY.format(pressure))
    sign = 1.0 if outward else -1.0
    bottom, top = (0.0, sign * (drawn.flow - given.flow)), (1.0, -sign * given.flow)
    mismatch, side, cavitation, top_films = 1.0, 0, _EMPTY, row.films
    for _ in range(_MOST_TRIALS):
        first, second = row.solve(pressure, cavitation)
        if not (first.converged and second.converged):
            reason = first.reason or second.reason
            return _failure(f"with {cavitation:.3f} of the space between the seals empty: {reason}")
        given, drawn = (first, second) if outward else (second, first)
        excess = sign * (drawn.flow - given.flow)
        mismatch = abs(excess / given.flow)
        if mismatch <= 10 * MATCH:
            return _solution(first, second, pressure, mismatch, cavitation)
        if excess > 0:
            row.films = top_films if side else row.films
            top = (top[0], top[1] / 2) if side > 0 else top
            bottom, side = (cavitation, excess), 1
        else:
            top_films = row.films
            bottom = (bottom[0], bottom[1] / 2) if side < 0 else bottom
            top, side = (cavitation, excess), -1
        if top[0] - bottom[0] < 1e-8:
            break
        cavitation = bottom[0] - bottom[1] * (top[0] - bottom[0]) / (top[1] - bottom[1])
    return _failure(_JUMP.format(cavitation, mismatch))


def _solution(
    first: Film, second: Film, pressure: float, residual: float, cavitation: float = 0.0
) -> Tandem:
    return Tandem(
        converged=True,
        reason="",
        pressure=pressure,
        cavitation=cavitation,
        inner=first,
        outer=second,
        match_residual=residual,
    )


def _failure(reason: str) -> Tandem:
    return Tandem(
        converged=False,
        reason=reason,
        pressure=math.nan,
        cavitation=math.nan,
        inner=None,
        outer=None,
        match_residual=math.nan,
    )
