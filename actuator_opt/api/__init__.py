"""The library's public functions, named like the commands of the terminal."""

from ..evaluation.comparison import Comparison
from .actuator import Actuator, read
from .checking import check, examine
from .comparing import compare, comparison_json, draw_comparison
from .exports import explore, export
from .installation import Installation, doctor
from .optimum import (
    Prices,
    evaluate,
    optimise,
    pareto,
    sensitivity,
    with_yield,
    write_front,
    write_front_csv,
)
from .recorded_runs import (
    Run,
    delete_run,
    prune_runs,
    read_run,
    record,
    record_front,
    record_run,
    record_sweep,
    runs,
)
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
from .repeating import Rerun, rerun
from .reports import save
from .restoring import Restored, draw_run, report_run, restore
from .results import exit_code, report
from .sessions import OptimumCurve, Prediction, Price, Session, session
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
from .studies import seal, uncertainty, with_contact, write_draws, write_seal, write_uncertainty
from .sweeping import draw_sweep, sweep

__all__ = [
    "Actuator",
    "Calibrated",
    "Compared",
    "Comparison",
    "Installation",
    "OptimumCurve",
    "Prediction",
    "Price",
    "Prices",
    "Rerun",
    "Restored",
    "Run",
    "Session",
    "Trial",
    "bending",
    "calibrate",
    "check",
    "compare",
    "compare_measured",
    "comparison_json",
    "delete_run",
    "doctor",
    "draw_comparison",
    "draw_run",
    "draw_sweep",
    "evaluate",
    "examine",
    "exit_code",
    "explore",
    "export",
    "fitting",
    "identify",
    "optimise",
    "pareto",
    "prune_runs",
    "read",
    "read_record",
    "read_run",
    "read_scenario",
    "record",
    "record_front",
    "record_run",
    "record_sweep",
    "report",
    "report_run",
    "rerun",
    "restore",
    "runs",
    "save",
    "seal",
    "sensitivity",
    "servo_sensitivities",
    "session",
    "simulate",
    "sweep",
    "uncertainty",
    "verify_dynamics",
    "with_contact",
    "with_yield",
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
