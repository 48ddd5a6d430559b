"""Sweeps: many designs, evaluated in chunks, stored in a database or reduced to the best."""

from __future__ import annotations

from .plan import Axis, Plan, plan, read_axis
from .run import sweep, swept_again
from .swept import Best, Swept

__all__ = ["Axis", "Best", "Plan", "Swept", "plan", "read_axis", "sweep", "swept_again"]
