"""Design optimisation of lightweight hydraulic actuators.

>>> import actuator_opt as ao
>>> ao.__version__
'0.6.0'

The verbs (`read`, `check`, `evaluate`, `optimise`, `sensitivity`, `pareto`, `sweep`,
`uncertainty`, `seal`, `identify`, `calibrate`, `simulate`, `report`, `export`, `save`) are the
same as in the terminal; `bending` is `identify --span` there, `compare_measured`,
`servo_sensitivities` and `verify_dynamics` are options. Heavy modules load when a verb needs
them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import version

if TYPE_CHECKING:
    from .design.materials import load_library
    from .errors import ActuatorError, Diagnostic, InputError
    from .evaluation.plugin import constraint, metric
    from .identification import BendingResult, Identification, Record, Specimen
    from .simulation import Simulation
    from .verbs import (
        Actuator,
        Calibrated,
        Compared,
        Trial,
        bending,
        calibrate,
        check,
        compare_measured,
        evaluate,
        export,
        identify,
        optimise,
        pareto,
        read,
        read_record,
        read_scenario,
        report,
        save,
        seal,
        sensitivity,
        servo_sensitivities,
        simulate,
        sweep,
        uncertainty,
        verify_dynamics,
        write_calibration,
        write_comparison,
        write_draws,
        write_front,
        write_front_csv,
        write_identification,
        write_seal,
        write_series,
        write_signals,
        write_simulation,
        write_uncertainty,
    )

__version__ = version.VERSION

_HOMES = {
    "Actuator": "verbs",
    "ActuatorError": "errors",
    "BendingResult": "identification",
    "Calibrated": "verbs",
    "Compared": "verbs",
    "Diagnostic": "errors",
    "Identification": "identification",
    "InputError": "errors",
    "Record": "identification",
    "Simulation": "simulation",
    "Specimen": "identification",
    "Trial": "verbs",
    "bending": "verbs",
    "calibrate": "verbs",
    "check": "verbs",
    "compare_measured": "verbs",
    "constraint": "evaluation.plugin",
    "evaluate": "verbs",
    "export": "verbs",
    "identify": "verbs",
    "load_library": "design.materials",
    "metric": "evaluation.plugin",
    "optimise": "verbs",
    "pareto": "verbs",
    "read": "verbs",
    "read_record": "verbs",
    "read_scenario": "verbs",
    "report": "verbs",
    "save": "verbs",
    "seal": "verbs",
    "sensitivity": "verbs",
    "servo_sensitivities": "verbs",
    "simulate": "verbs",
    "sweep": "verbs",
    "uncertainty": "verbs",
    "verify_dynamics": "verbs",
    "write_calibration": "verbs",
    "write_comparison": "verbs",
    "write_draws": "verbs",
    "write_front": "verbs",
    "write_front_csv": "verbs",
    "write_identification": "verbs",
    "write_seal": "verbs",
    "write_series": "verbs",
    "write_signals": "verbs",
    "write_simulation": "verbs",
    "write_uncertainty": "verbs",
}

__all__ = [
    "Actuator",
    "ActuatorError",
    "BendingResult",
    "Calibrated",
    "Compared",
    "Diagnostic",
    "Identification",
    "InputError",
    "Record",
    "Simulation",
    "Specimen",
    "Trial",
    "__version__",
    "bending",
    "calibrate",
    "check",
    "compare_measured",
    "constraint",
    "evaluate",
    "export",
    "identify",
    "load_library",
    "metric",
    "optimise",
    "pareto",
    "read",
    "read_record",
    "read_scenario",
    "report",
    "save",
    "seal",
    "sensitivity",
    "servo_sensitivities",
    "simulate",
    "sweep",
    "uncertainty",
    "verify_dynamics",
    "write_calibration",
    "write_comparison",
    "write_draws",
    "write_front",
    "write_front_csv",
    "write_identification",
    "write_seal",
    "write_series",
    "write_signals",
    "write_simulation",
    "write_uncertainty",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f".{_HOMES[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
