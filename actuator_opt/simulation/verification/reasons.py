"""Reasons why two tiers differ, in words, from the records of experiments alone."""

from __future__ import annotations

from math import isfinite

from .stand import Facts

MANY = 9.0
"""Change above which a factor is clearer than per cent (a choice)."""
STILL = 0.01
"""Spool motion, as a share of its opening, that counts as held (a choice)."""


def apart(value: float | None, other: float | None) -> float | None:
    """Relative difference, or None.

    >>> apart(1.5, 2.0), apart(None, 2.0), apart(1.0, 0.0)
    (-0.25, None, None)
    """
    if value is None or other is None or not isfinite(value) or not isfinite(other) or not other:
        return None
    return value / other - 1


def percent(share: float) -> str:
    """A relative change in per cent.

    >>> percent(0.031), percent(-0.5), percent(19.0), percent(-1.2)
    ('+3.1 %', '-50 %', 'x 20', 'changes its sign')
    """
    if share < -1:
        return "changes its sign"
    if share >= MANY:
        return f"x {1 + share:.3g}"
    return f"{100 * share:+.{0 if abs(share) >= 0.095 else 1}f} %"


def seen(facts: Facts | None, cause: str) -> str:
    """Evidence in a record for a cause: friction, or the size of the oscillation."""
    if facts is None:
        return "no record"
    if cause == "friction":
        return _seals(facts)
    words = []
    if facts.saturated > 0:
        words.append(f"the signal is at its limit {100 * facts.saturated:.0f} % of the time")
    if facts.lowest < 0:
        words.append(f"a chamber falls to {1e-5 * facts.lowest:.2g} bar")
    low, high = (0.0, 0.0) if facts.spool is None else facts.spool
    if high - low > STILL * max(abs(low), abs(high)):
        words.append(f"the spool oscillates between {low:.2g} and {high:.2g} V")
    return "; ".join(words) or f"the pressure in A oscillates by {1e-05 * facts.pulse:.2g} bar"


def _seals(facts: Facts) -> str:
    swing, travel = 1e3 * facts.swing, 1e3 * facts.travel
    if not travel:
        return f"the seals slide over {swing:.2g} mm"
    word = "stick" if swing < travel else "slip"
    return f"the seals {word}: amplitude {swing:.2g} mm, bristle travel {travel:.2g} mm"


def point(facts: Facts | None, held: tuple[float, float]) -> str:
    """Operating point of the loop, beside the pressures assumed by the linear tier."""
    if facts is None:
        return "no record"
    (a, b), (taken_a, taken_b) = ([1e-5 * one for one in pair] for pair in (facts.pressures, held))
    words = f"chambers at {a:.0f} and {b:.0f} bar, linear tier {taken_a:.0f} and {taken_b:.0f}"
    if facts.spool is not None:
        words += f"; spool about {0.5 * sum(facts.spool):.2g} V"
    return words
