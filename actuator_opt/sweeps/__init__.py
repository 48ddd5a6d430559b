"""Sweeps: evaluate many designs in chunks; store them in a database or keep only the best."""

from __future__ import annotations

from .plan import Plan, SweepAxis, plan, read_axis
from .result import Best, Swept
from .run import sweep, swept_again

__all__ = ["Best", "Plan", "SweepAxis", "Swept", "plan", "read_axis", "sweep", "swept_again"]
