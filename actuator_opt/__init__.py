"""Design optimisation of lightweight hydraulic actuators.

>>> import actuator_opt as ao
>>> ao.__version__
'0.4.0'

The verbs (`read`, `check`, `evaluate`, `optimise`, `sensitivity`, `report`, `save`) are the same
as in the terminal. Heavy modules load when a verb needs them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import version

if TYPE_CHECKING:
    from .design.materials import load_library
    from .errors import ActuatorError, Diagnostic, InputError
    from .evaluation.plugin import constraint, metric
    from .verbs import (
        Actuator,
        check,
        evaluate,
        optimise,
        read,
        report,
        save,
        sensitivity,
    )

__version__ = version.VERSION

_HOMES = {
    "Actuator": "verbs",
    "ActuatorError": "errors",
    "Diagnostic": "errors",
    "InputError": "errors",
    "check": "verbs",
    "constraint": "evaluation.plugin",
    "evaluate": "verbs",
    "load_library": "design.materials",
    "metric": "evaluation.plugin",
    "optimise": "verbs",
    "read": "verbs",
    "report": "verbs",
    "save": "verbs",
    "sensitivity": "verbs",
}

__all__ = [
    "Actuator",
    "ActuatorError",
    "Diagnostic",
    "InputError",
    "__version__",
    "check",
    "constraint",
    "evaluate",
    "load_library",
    "metric",
    "optimise",
    "read",
    "report",
    "save",
    "sensitivity",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f".{_HOMES[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
