"""Sweeps: evaluate many designs chunk by chunk; store all in a database, or keep the best."""

from __future__ import annotations

from .plan import Plan, SweepAxis, given_axis, paired, plan, read_axis
from .result import Best, Swept
from .run import sweep, swept_again

__all__ = [
    "Best", "Plan", "SweepAxis", "Swept", "given_axis", "paired", "plan", "read_axis", "sweep",
    "swept_again",
]  # fmt: skip
