"""Sweeps: many designs, evaluated in chunks, stored in a database or reduced to the best."""

from __future__ import annotations

from .axes import Axis, read_axis
from .plan import Plan, plan
from .run import sweep, swept_again
from .swept import Best, Swept

__all__ = ["Axis", "Best", "Plan", "Swept", "plan", "read_axis", "sweep", "swept_again"]
