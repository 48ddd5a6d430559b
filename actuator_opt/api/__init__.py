"""The library's public functions, named like the commands of the terminal.

A module loads when one of its names is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.lazy import homes, loader

if TYPE_CHECKING:
    from ..evaluation.comparison import Comparison as Comparison
    from .actuator import Actuator as Actuator, read as read
    from .checking import check as check, examine as examine
    from .comparing import (
        compare as compare,
        comparison_json as comparison_json,
        draw_comparison as draw_comparison,
    )
    from .explaining import Explanation as Explanation, explain as explain
    from .exports import explore as explore, export as export
    from .installation import Installation as Installation, doctor as doctor
    from .optimum import (
        Prices as Prices,
        evaluate as evaluate,
        optimise as optimise,
        pareto as pareto,
        sensitivity as sensitivity,
        with_yield as with_yield,
        write_duty as write_duty,
        write_front as write_front,
        write_front_csv as write_front_csv,
    )
    from .recorded_runs import (
        Run as Run,
        delete_run as delete_run,
        prune_runs as prune_runs,
        read_run as read_run,
        record as record,
        record_front as record_front,
        record_run as record_run,
        record_sweep as record_sweep,
        runs as runs,
    )
    from .records import (
        Calibrated as Calibrated,
        bending as bending,
        calibrate as calibrate,
        identify as identify,
        read_record as read_record,
        write_calibration as write_calibration,
        write_identification as write_identification,
        write_series as write_series,
    )
    from .reference import Catalogue as Catalogue, Entry as Entry, catalogue as catalogue
    from .repeating import Rerun as Rerun, rerun as rerun
    from .reports import save as save
    from .restoring import (
        Restored as Restored,
        draw_run as draw_run,
        report_run as report_run,
        restore as restore,
    )
    from .results import exit_code as exit_code, report as report
    from .session_results import (
        BareOptimum as BareOptimum,
        OptimumCurve as OptimumCurve,
        Prediction as Prediction,
        Price as Price,
    )
    from .sessions import Session as Session, session as session
    from .simulations import (
        Compared as Compared,
        Trial as Trial,
        compare_measured as compare_measured,
        cycle_scenario as cycle_scenario,
        fitting as fitting,
        read_scenario as read_scenario,
        servo_sensitivities as servo_sensitivities,
        simulate as simulate,
        verify_dynamics as verify_dynamics,
        write_comparison as write_comparison,
        write_signals as write_signals,
        write_simulation as write_simulation,
    )
    from .starting import start as start
    from .studies import (
        seal as seal,
        uncertainty as uncertainty,
        with_contact as with_contact,
        write_draws as write_draws,
        write_seal as write_seal,
        write_uncertainty as write_uncertainty,
    )
    from .sweeping import (
        draw_sweep as draw_sweep,
        evaluate_many as evaluate_many,
        sweep as sweep,
    )

_PUBLIC = {
    ".evaluation.comparison": "Comparison",
    "actuator": "Actuator read",
    "checking": "check examine",
    "comparing": "compare comparison_json draw_comparison",
    "explaining": "Explanation explain",
    "exports": "explore export",
    "installation": "Installation doctor",
    "optimum": """
        Prices evaluate optimise pareto sensitivity with_yield write_duty write_front
        write_front_csv
    """,
    "recorded_runs": """
        Run delete_run prune_runs read_run record record_front record_run
        record_sweep runs
    """,
    "records": """
        Calibrated bending calibrate identify read_record write_calibration
        write_identification write_series
    """,
    "reference": "Catalogue Entry catalogue",
    "repeating": "Rerun rerun",
    "reports": "save",
    "restoring": "Restored draw_run report_run restore",
    "results": "exit_code report",
    "session_results": "BareOptimum OptimumCurve Prediction Price",
    "sessions": "Session session",
    "simulations": """
        Compared Trial compare_measured cycle_scenario fitting read_scenario servo_sensitivities
        simulate verify_dynamics write_comparison write_signals write_simulation
    """,
    "starting": "start",
    "studies": "seal uncertainty with_contact write_draws write_seal write_uncertainty",
    "sweeping": "draw_sweep evaluate_many sweep",
}
"""The public names of each module."""

_HOMES = homes(_PUBLIC)

__all__ = [*sorted(_HOMES)]

if not TYPE_CHECKING:  # so that type checkers know the names above, and no others
    __getattr__ = loader(__name__, _HOMES)


def __dir__() -> list[str]:
    return [*__all__]
