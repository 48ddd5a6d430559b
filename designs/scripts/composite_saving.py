"""What the composite saves over steel at equal requirements, part by part, and why.

Both designs are optimised; their masses stand side by side and beside what makers of composite
cylinders publish. The rest is computed too: which parts the saving comes from, which do not change,
what aluminium end parts alone would save, and what the saving would be over the thick walls of
the steel cylinders that the makers compare with.

    python designs/scripts/composite_saving.py
    actuator-opt evaluate designs/knee.yaml --plugin designs/scripts/composite_saving.py
"""

from __future__ import annotations

from functools import partial
from math import pi
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import actuator_opt as ao

DESIGNS = Path(__file__).parents[1]
PUBLISHED = (
    ("Mark Hydraulik carbon series, cylinder, walls 5 to 15 mm", 0.30, 0.70),
    ("Lingk & Sturzebecher, boom cylinder barrel", 0.0, 0.75),
    ("Haenchen H-CFK, rod or barrel", 0.0, 0.80),
)
"""What makers say they save over steel: who and what, least, most."""
ALUMINIUM_ENDS = {
    "caps.material": "al_7075_t6",
    "head.material": "al_7075_t6",
    "piston.material": "al_7075_t6",
}
THICK_WALL = 5e-3
"""Thinnest wall of the steel cylinders that the published range compares with, m."""
GRAVITY = 9.80665


@ao.metric("force_to_weight", label="stall push force over weight")
def force_to_weight(design: Any) -> Any:
    """Stall push force over the actuator's own weight: how actuators are compared."""
    area = pi / 4 * design["cylinder.bore"] ** 2
    return design["supply.pressure"] * area / (GRAVITY * design.metric("mass"))


class Saving(NamedTuple):
    """Both optima and what is computed from them; masses in kg."""

    steel: Any
    composite: Any
    mixed: Any
    """The steel design with aluminium caps, head and piston, optimised again."""
    thick: Any
    """The optimal steel design with the barrel wall that the makers compare with."""

    @property
    def share(self) -> float:
        """Saving over the steel design."""
        return 1 - self.composite.objective_value / self.steel.objective_value

    def part_share(self, part: str) -> float:
        """Saving of one part."""
        before, after = self.mass(self.steel, part), self.mass(self.composite, part)
        return 1 - after / before

    @staticmethod
    def mass(optimum: Any, part: str) -> float:
        """Mass of one part at an optimum."""
        return optimum.evaluation.mass_parts[part]


def compute(starts: int = 4) -> Saving:
    """Optimise both designs and the two variants of the steel one."""
    best = partial(ao.optimise, starts=starts, prices=False)
    steel = best(ao.read(DESIGNS / "steel_baseline.yaml", plugins=[force_to_weight]))
    composite = best(ao.read(DESIGNS / "knee.yaml", plugins=[force_to_weight]))
    mixed = best(ao.read(DESIGNS / "steel_baseline.yaml", set=ALUMINIUM_ENDS))
    thick = ao.evaluate(
        ao.Actuator(steel.design).changed({"barrel.layup[0].thickness": THICK_WALL})
    )
    return Saving(steel, composite, mixed, thick)


def print_masses(saving: Saving) -> None:
    """Both mass tables side by side; the last column adds up to the saving."""
    rows = [
        (part, before, saving.mass(saving.composite, part))
        for part, before in saving.steel.evaluation.mass_parts.items()
    ]
    total = saving.steel.objective_value
    rows.append(("dry mass", total, saving.composite.objective_value))
    print(
        f"{'part':12}{'steel, g':>12}{'composite, g':>14}{'saved, g':>10}{'of the steel mass':>19}"
    )
    for part, before, after in rows:
        grams = f"{1e3 * before:12.2f}{1e3 * after:14.2f}{1e3 * (before - after):10.2f}"
        print(f"{part:12}{grams}{(before - after) / total:18.1%}")
    weights = [
        optimum.evaluation.metrics["force_to_weight"].value
        for optimum in (saving.steel, saving.composite)
    ]
    print(f"{'force/weight':12}{weights[0]:12.0f}{weights[1]:14.0f}")


def print_published(saving: Saving) -> None:
    """The saving beside the published ones."""
    print(f"\nsaving at equal requirements: {saving.share:.1%}")
    for who, least, most in PUBLISHED:
        said = f"up to {most:.0%}" if least == 0 else f"{least:.0%} to {most:.0%}"
        print(f"  published {said:12} {who}")


def print_reasons(saving: Saving) -> None:
    """What explains the difference, each reason with its number."""
    steel, composite = saving.steel, saving.composite
    kept = ("rod", "fastening", "clevises")
    same = sum(saving.mass(composite, part) for part in kept) / composite.objective_value
    ends = 1 - saving.mixed.objective_value / steel.objective_value
    rest = saving.share - ends
    carbon = (
        f"saves another {rest:.1%}"
        if rest > 0
        else f"saves nothing more: that actuator is {-rest:.1%} of the steel mass heavier"
    )
    metal = f"save {ends:.1%} already" if ends > 0 else "save nothing"
    thick = saving.thick.metrics["mass"].value
    wall = steel.design.barrel.layup[0].thickness
    bores = [1e3 * optimum.design.cylinder.bore for optimum in (steel, composite)]
    reasons = [
        f"the barrel alone saves {saving.part_share('barrel'):.0%}: the makers' largest figures are"
        " for a barrel or a rod, not for a whole cylinder",
        f"{same:.0%} of the composite actuator is steel in both designs: {', '.join(kept)}",
        f"aluminium caps, head and piston on a steel barrel {metal}:"
        f" {1e3 * saving.mixed.objective_value:.1f} g; the carbon barrel with the ends it needs"
        f" {carbon}",
        f"the makers compare with walls of {1e3 * THICK_WALL:.0f} mm and more, the steel optimum"
        f" has {1e3 * wall:.2f} mm; with {1e3 * THICK_WALL:.0f} mm it weighs {1e3 * thick:.0f} g"
        f" and the composite saves {1 - composite.objective_value / thick:.0%}",
        "oil stiffness and friction set the bore, not the strength of the wall:"
        f" {bores[0]:.1f} mm in steel, {bores[1]:.1f} mm in composite, so nothing else shrinks",
    ]
    for name, optimum in (("steel", steel), ("composite", composite)):
        rows = dict.fromkeys(row.split(" (")[0] for row in optimum.kkt.active)
        reasons.append(f"active in {name}: {', '.join(rows)}")
    print("\nwhy:")
    for reason in reasons:
        print(fill(reason + ".", 92, initial_indent="- ", subsequent_indent="  "))


def main() -> None:
    """Print the comparison."""
    saving = compute()
    print_masses(saving)
    print_published(saving)
    print_reasons(saving)


if __name__ == "__main__":
    main()
