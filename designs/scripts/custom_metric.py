"""A metric and a constraint of one's own, used like the project's.

The pump of a walking robot fills both chambers at every step, and a rod in dry bushes should not be
slender. Neither is among the project's metrics: here they are declared, required and optimised.

    python designs/scripts/custom_metric.py
    actuator-opt optimise designs/knee.yaml --plugin designs/scripts/custom_metric.py

The functions read numbers by PATH and metrics by name, in SI. Written with operators and NumPy they
are differentiated exactly, as the project's own models are.
"""

from __future__ import annotations

from math import pi
from pathlib import Path

import actuator_opt as ao
from actuator_opt import optimise, read

KNEE = Path(__file__).parents[1] / "knee.yaml"
SLENDERNESS = 11.0
"""Largest ratio of the exposed rod's length to its diameter: own rule for rods in dry bushes."""


@ao.metric("oil_per_cycle", dimension="volume", unit_name="ml", label="oil taken per full cycle")
def oil_per_cycle(design):
    """Oil that one extension and one retraction take from the supply."""
    bore, rod = design["cylinder.bore"], design["rod.outer_diameter"]
    areas = pi / 4 * (2 * bore**2 - rod**2)
    return areas * design["cylinder.stroke"]


@ao.constraint("stocky_rod", label="room to the largest slenderness of the exposed rod")
def stocky_rod(design):
    """Relative margin, at least 0: the exposed rod is at most SLENDERNESS diameters long."""
    exposed = design["cylinder.stroke"] + design["rod.extension"]
    return 1 - exposed / (SLENDERNESS * design["rod.outer_diameter"])


def main() -> None:
    """Optimise the knee as it is, then with both additions, and print what they change."""
    plain = optimise(read(KNEE), starts=4, prices=False)
    ours = (oil_per_cycle, stocky_rod)
    limit = {"requirements.oil_per_cycle.max": "66 ml"}
    extended = optimise(read(KNEE, set=limit, plugins=ours), starts=4, prices=False)

    print(f"{'':28}{'knee':>12}{'with both':>12}")
    print(f"{'mass, g':28}{1e3 * plain.objective_value:12.1f}{1e3 * extended.objective_value:12.1f}")
    for before, after in zip(plain.variables, extended.variables, strict=True):
        if before.quantity in ("bore", "rod_diameter", "rod_inner_diameter"):
            print(f"{before.path + ', mm':28}{1e3 * before.value:12.2f}{1e3 * after.value:12.2f}")
    for name in ("oil_per_cycle", "stocky_rod"):
        metric = extended.evaluation.metrics[name]
        shown = metric.quantity.to_display(metric.value)
        print(f"{metric.quantity.label}: {shown:.4g} {metric.quantity.unit}".rstrip())
    print("active:", ", ".join(extended.kkt.active))


if __name__ == "__main__":
    main()
