"""Write the committed reports into reports/samples: designs, scenarios, studies, the test record.

Run from the root of the checkout: all, or those named (``designs scenarios studies record``);
the same input gives the same bytes.
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import actuator_opt as ao
from actuator_opt.rendering.script_pages import write_study

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "reports" / "samples"
STUDIES = (
    "aalto_rig",
    "knee_materials",
    "knee_dynamics",
    "knee_seals",
    "knee_joints",
    "aerospace_ends",
    "knee_pressure",
    "knee_custom_constraint",
    "course_servo",
)


def designs() -> None:
    """Optimise the designs that have variables, evaluate the others, write each report.

    Designs with duty cycles are evaluated: their searches take minutes.
    """
    for path in sorted((ROOT / "designs").glob("*.yaml")):
        actuator = ao.read(path)
        searched = actuator.design.variables and actuator.design.duty is None
        command = f"actuator-opt {'optimise' if searched else 'report'} designs/{path.name}"
        if searched:
            plies = any(ply.ply_thickness is not None for ply in actuator.design.barrel.layup)
            subject = ao.optimise(actuator, whole_plies=plies)
            command += " --whole-plies" if plies else ""
        else:
            subject = ao.evaluate(actuator)
        files = ao.report(subject, folder=SAMPLES, actuator=actuator, command=command)
        print(files[0].path.relative_to(ROOT), files[0].pages, "sheets")


def scenarios() -> None:
    """Simulate every scenario by two integrators."""
    for path in sorted((ROOT / "designs" / "scenarios").glob("*.yaml")):
        trial = ao.read_scenario(path)
        found = ao.simulate(trial, verify=True)
        command = f"actuator-opt simulate designs/scenarios/{path.name} --verify"
        files = ao.write_simulation(found, trial, folder=SAMPLES, command=command)
        print(files[0].path.relative_to(ROOT), files[0].pages, "sheets")


def studies() -> None:
    """Run the design scripts that write pages."""
    for name in STUDIES:
        study = runpy.run_path(str(ROOT / "designs" / "scripts" / f"{name}.py"))
        sheets = write_study(study["page"](study["compute"]()), SAMPLES, name)
        print(f"reports/samples/{name}.pdf", sheets, "sheets")


def record() -> None:
    """Identify and calibrate with the test record."""
    example = runpy.run_path(str(ROOT / "designs" / "scripts" / "knee_calibration.py"))
    for path in example["pages"](SAMPLES):
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    for part in sys.argv[1:] or ("designs", "scenarios", "studies", "record"):
        {"designs": designs, "scenarios": scenarios, "studies": studies, "record": record}[part]()
