"""Many designs at once: what to vary, chunk by chunk, kept in a database or reduced on the way."""

from __future__ import annotations

from .axes import Axis, read_axis
from .plan import Plan, plan
from .run import Best, Swept, sweep, swept_again

__all__ = ["Axis", "Best", "Plan", "Swept", "plan", "read_axis", "sweep", "swept_again"]
