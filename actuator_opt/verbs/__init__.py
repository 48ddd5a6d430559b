"""The verbs of the library: one name each in the terminal and in scripts."""

from .actuator import Actuator, read
from .checking import check
from .exports import export
from .fronts import pareto, write_front, write_front_csv
from .optimum import evaluate, optimise, sensitivity
from .records import (
    Calibrated,
    bending,
    calibrate,
    identify,
    read_record,
    write_calibration,
    write_identification,
    write_series,
)
from .reports import date_from_environment, report, save
from .seals import seal, with_contact, write_seal
from .simulations import (
    Compared,
    Trial,
    compare_measured,
    fitting,
    read_scenario,
    servo_sensitivities,
    simulate,
    verify_dynamics,
    write_comparison,
    write_signals,
    write_simulation,
)
from .sweeping import sweep
from .uncertain import uncertainty, write_draws, write_uncertainty

__all__ = [
    "Actuator",
    "Calibrated",
    "Compared",
    "Trial",
    "bending",
    "calibrate",
    "check",
    "compare_measured",
    "date_from_environment",
    "evaluate",
    "export",
    "fitting",
    "identify",
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
    "with_contact",
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
