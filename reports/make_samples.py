"""Write the committed reports into reports/samples: of shipped designs, studies, the test record.

Run from the root of the checkout; the same input gives the same bytes.
"""

from __future__ import annotations

import runpy
from pathlib import Path

import actuator_opt as ao

ROOT = Path(__file__).resolve().parent.parent
STUDIES = ("aalto_rig", "knee_materials", "knee_dynamics", "knee_seals", "course_servo")


def main() -> None:
    """Optimise the designs that have variables, evaluate the others, write each report."""
    for path in sorted((ROOT / "designs").glob("*.yaml")):
        actuator = ao.read(path)
        verb = "optimise" if actuator.design.variables else "report"
        command = f"actuator-opt {verb} designs/{path.name}"
        if actuator.design.variables:
            plies = any(ply.ply_thickness is not None for ply in actuator.design.barrel.layup)
            subject = ao.optimise(actuator, whole_plies=plies)
            command += " --whole-plies" if plies else ""
        else:
            subject = ao.evaluate(actuator)
        files = ao.report(
            subject, folder=ROOT / "reports" / "samples", actuator=actuator, command=command
        )
        for file in files[1:]:
            if file.path.stem != path.stem:  # the PDF holds every sheet; one PNG is enough here
                file.path.unlink()
        print(files[0].path.relative_to(ROOT), files[0].pages, "sheets")
    for name in STUDIES:
        study = runpy.run_path(str(ROOT / "designs" / "scripts" / f"{name}.py"))
        sheets = study["write"](study["compute"](), ROOT / "reports" / "samples")
        print(f"reports/samples/{name}.pdf", sheets, "sheets")
    example = runpy.run_path(str(ROOT / "designs" / "scripts" / "knee_calibration.py"))
    for path in example["pages"](ROOT / "reports" / "samples"):
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
