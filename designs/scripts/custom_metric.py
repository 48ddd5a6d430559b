"""A metric and a constraint of one's own, used like the project's.

The pump of a walking robot fills both chambers at every step, and a short piston tilts and jams.
Neither rule is among the project's: here they are declared, required and optimised.

    python designs/scripts/custom_metric.py
    actuator-opt optimise designs/knee.yaml --plugin designs/scripts/custom_metric.py

The functions read numbers by PATH and metrics by name, in SI. Written with operators and NumPy they
are differentiated exactly, as the project's own models are.
"""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import actuator_opt as ao

KNEE = Path(__file__).parents[1] / "knee.yaml"
GUIDE = 0.7
"""Least length of the piston over the bore: own rule against tilting."""
OIL = "71 ml"
"""Most oil per cycle: what an assumed on-board pump leaves this joint."""


@ao.metric("oil_per_cycle", dimension="volume", unit_name="ml", label="oil taken per full cycle")
def oil_per_cycle(design: Any) -> Any:
    """Oil that one extension and one retraction take from the supply."""
    bore, rod = design["cylinder.bore"], design["rod.outer_diameter"]
    areas = pi / 4 * (2 * bore**2 - rod**2)
    return areas * design["cylinder.stroke"]


@ao.constraint("guided_piston", label="room to the least length of the piston")
def guided_piston(design: Any) -> Any:
    """Relative margin, at least 0: the piston is at least GUIDE bores long."""
    return design["piston.length"] / (GUIDE * design["cylinder.bore"]) - 1


def main() -> None:
    """Optimise the knee as it is, then with both additions, and print what they change."""
    plain = ao.optimise(ao.read(KNEE), starts=4, prices=False)
    extended = ao.optimise(
        ao.read(
            KNEE,
            set={"requirements.oil_per_cycle.max": OIL},
            plugins=(oil_per_cycle, guided_piston),
        ),
        starts=4,
        prices=False,
    )
    print(f"{'':28}{'knee':>10}{'with both':>12}")
    print(
        f"{'mass, g':28}{1e3 * plain.objective_value:10.1f}{1e3 * extended.objective_value:12.1f}"
    )
    for before, after in zip(plain.variables, extended.variables, strict=True):
        if before.path.startswith(("cylinder", "rod", "piston")):
            print(f"{before.path + ', mm':28}{1e3 * before.value:10.2f}{1e3 * after.value:12.2f}")
    oil = extended.evaluation.metrics["oil_per_cycle"]
    print(f"\n{oil.quantity.label}: {oil.quantity.text(oil.value)}, at most {OIL}")
    added = [row for row in extended.kkt.active if row in ("oil_per_cycle", "guided_piston")]
    print(f"{extended.sentence}\nactive of the two: {', '.join(added)}")


if __name__ == "__main__":
    main()
