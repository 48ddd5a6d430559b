"""Why two tiers differ, in words: what the records of experiments show, and nothing else."""

from __future__ import annotations

from math import isfinite

from .stand import Facts

MANY = 9.0
"""Change from which a factor says more than per cent (a choice)."""
STILL = 0.01
"""Share of its opening by which a spool moves that counts as held (a choice)."""


def apart(value: float | None, other: float | None) -> float | None:
    """Relative difference; None where there is none.

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
    """What the record of an experiment shows of a cause: friction, or the size of the swing."""
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
        words.append(f"the spool swings from {low:.2g} to {high:.2g} V")
    return "; ".join(words) or f"the pressure in A swings by {1e-5 * facts.pulse:.2g} bar"


def _seals(facts: Facts) -> str:
    swing, travel = 1e3 * facts.swing, 1e3 * facts.travel
    if not travel:
        return f"the seals slide over {swing:.2g} mm"
    word = "stick" if swing < travel else "slip"
    return f"the seals {word}: swing of {swing:.2g} mm, their bristles give {travel:.2g} mm"


def point(facts: Facts | None, held: tuple[float, float]) -> str:
    """Where the loop works, beside the pressures that the linear tier takes."""
    if facts is None:
        return "no record"
    (a, b), (taken_a, taken_b) = ([1e-5 * one for one in pair] for pair in (facts.pressures, held))
    words = f"chambers at {a:.0f} and {b:.0f} bar, linear {taken_a:.0f} and {taken_b:.0f}"
    if facts.spool is not None:
        words += f"; spool about {0.5 * sum(facts.spool):.2g} V"
    return words
