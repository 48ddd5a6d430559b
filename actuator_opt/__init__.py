"""Design optimisation of lightweight hydraulic actuators.

>>> import actuator_opt as ao
>>> ao.__version__
'0.6.0'

Most functions are named like the command that does the same in the terminal: `check`, `evaluate`,
`optimise`, `sensitivity`, `pareto`, `sweep`, `uncertainty`, `compare`, `explore`, `seal`,
`identify`, `calibrate`, `simulate`, `report`, `export` and `explain`. `catalogue` is the command
`list`, and `start` is `init` with a duty. `read` reads a design, `save` writes it, and `session`
re-solves it quickly after changes. In the terminal, some functions are options: `bending` is
`identify --span`, `compare_measured` is `simulate --measured`, `servo_sensitivities` is
`simulate --sensitivity`, and `verify_dynamics` is `optimise --verify-dynamics`. A module with slow
imports loads when a function first needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import version
from .base.lazy import homes, loader

if TYPE_CHECKING:
    from .api import (
        Actuator as Actuator,
        BareOptimum as BareOptimum,
        Calibrated as Calibrated,
        Catalogue as Catalogue,
        Compared as Compared,
        Comparison as Comparison,
        Entry as Entry,
        Explanation as Explanation,
        Installation as Installation,
        OptimumCurve as OptimumCurve,
        Prediction as Prediction,
        Price as Price,
        Rerun as Rerun,
        Restored as Restored,
        Run as Run,
        Session as Session,
        Trial as Trial,
        bending as bending,
        calibrate as calibrate,
        catalogue as catalogue,
        check as check,
        compare as compare,
        compare_measured as compare_measured,
        comparison_json as comparison_json,
        cycle_scenario as cycle_scenario,
        delete_run as delete_run,
        doctor as doctor,
        draw_comparison as draw_comparison,
        draw_run as draw_run,
        draw_sweep as draw_sweep,
        evaluate as evaluate,
        evaluate_many as evaluate_many,
        exit_code as exit_code,
        explain as explain,
        explore as explore,
        export as export,
        identify as identify,
        optimise as optimise,
        pareto as pareto,
        prune_runs as prune_runs,
        read as read,
        read_record as read_record,
        read_run as read_run,
        read_scenario as read_scenario,
        record as record,
        record_front as record_front,
        record_run as record_run,
        record_sweep as record_sweep,
        report as report,
        report_run as report_run,
        rerun as rerun,
        restore as restore,
        runs as runs,
        save as save,
        seal as seal,
        sensitivity as sensitivity,
        servo_sensitivities as servo_sensitivities,
        session as session,
        simulate as simulate,
        start as start,
        sweep as sweep,
        uncertainty as uncertainty,
        verify_dynamics as verify_dynamics,
        write_calibration as write_calibration,
        write_comparison as write_comparison,
        write_draws as write_draws,
        write_duty as write_duty,
        write_front as write_front,
        write_front_csv as write_front_csv,
        write_identification as write_identification,
        write_seal as write_seal,
        write_series as write_series,
        write_signals as write_signals,
        write_simulation as write_simulation,
        write_uncertainty as write_uncertainty,
    )
    from .base.errors import (
        ActuatorError as ActuatorError,
        Diagnostic as Diagnostic,
        InputError as InputError,
        UnknownName as UnknownName,
        Unsolvable as Unsolvable,
        UsageError as UsageError,
    )
    from .design.materials import load_library as load_library
    from .evaluation.plugin import constraint as constraint, metric as metric
    from .evaluation.result import (
        Evaluation as Evaluation,
        Metric as Metric,
        PathValue as PathValue,
    )
    from .identification import (
        BendingResult as BendingResult,
        Identification as Identification,
        Record as Record,
        Specimen as Specimen,
    )
    from .optimisation.pareto import ParetoFront as ParetoFront
    from .optimisation.result import Optimisation as Optimisation
    from .rendering.tables import DataTable as DataTable
    from .simulation import Simulation as Simulation
    from .simulation.sensitivity import Sensitivities as Sensitivities
    from .simulation.verification.verify import Verification as Verification
    from .studies.seal import SealStudy as SealStudy
    from .sweeps.result import Swept as Swept
    from .uncertainties.result import Uncertainty as Uncertainty

__version__ = version.VERSION

_PUBLIC = {
    "design.materials": "load_library",
    "base.errors": "ActuatorError Diagnostic InputError UnknownName Unsolvable UsageError",
    "evaluation.plugin": "constraint metric",
    "identification": "BendingResult Identification Record Specimen",
    "evaluation.result": "Evaluation Metric PathValue",
    "optimisation.pareto": "ParetoFront",
    "optimisation.result": "Optimisation",
    "rendering.tables": "DataTable",
    "simulation": "Simulation",
    "simulation.sensitivity": "Sensitivities",
    "simulation.verification.verify": "Verification",
    "studies.seal": "SealStudy",
    "sweeps.result": "Swept",
    "uncertainties.result": "Uncertainty",
    "api": """
        Actuator BareOptimum Calibrated Catalogue Compared Comparison Entry Explanation Installation
        OptimumCurve Prediction Price Rerun Restored Run Session Trial bending calibrate catalogue
        check compare compare_measured comparison_json cycle_scenario delete_run doctor
        draw_comparison draw_run draw_sweep evaluate evaluate_many exit_code explain explore export
        identify optimise pareto prune_runs read read_record read_run read_scenario record
        record_front record_run record_sweep report report_run rerun restore runs save seal
        sensitivity servo_sensitivities session simulate start sweep uncertainty verify_dynamics
        write_calibration write_comparison write_draws write_duty write_front
        write_front_csv write_identification write_seal write_series write_signals
        write_simulation write_uncertainty
    """,
}
"""The public names of each module; a module loads when one of its names is first used."""

_HOMES = homes(_PUBLIC)

__all__ = ["__version__", *sorted(_HOMES)]

if not TYPE_CHECKING:  # so that type checkers know the names above, and no others
    __getattr__ = loader(__name__, _HOMES)


def __dir__() -> list[str]:
    return [*__all__]
