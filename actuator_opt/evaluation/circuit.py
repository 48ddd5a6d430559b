"""The lines of both chambers in an evaluation: volume, wall, resistance, inertance, far end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..design.circuit import Line
from ..design.model import Design
from ..models import elements, lines
from ..numeric import Array
from .state import State
from .values import Values

Chamber = Literal["a", "b"]
CHAMBERS: tuple[Chamber, Chamber] = ("a", "b")


@dataclass(frozen=True, slots=True)
class Branch:
    """The lines of one chamber, lumped; compliances of oil and wall in m^3/Pa."""

    volume: Array = 0.0
    pipes: Array = 0.0
    """Compliance of pipe walls."""
    hoses: Array = 0.0
    """Compliance of hose walls."""
    resistance: Array = 0.0
    inertance: Array = 0.0
    far: Array = 0.0
    """What hangs on the far node of the dynamic model: half of every line (pi element), or, with a
    throttle, the whole of the lines beyond it."""


def wall_compliance(v: Values, line: Line, at: str) -> Array:
    """Volume a line's wall gives per pressure."""
    if line.rigid:
        return 0.0
    material = f"materials.{line.material}."
    return lines.line_compliance(
        inner_diameter=v[at + "inner_diameter"],
        length=v[at + "length"],
        outer_diameter=v[at + "outer_diameter"],
        youngs_modulus=v[material + "youngs_modulus"],
        poissons_ratio=v[material + "poissons_ratio"],
    )


def branches(v: Values, design: Design, state: State) -> dict[Chamber, Branch]:
    """The lines of chambers a and b."""
    throttled = design.ports.throttle is not None
    modulus = {"a": state.bulk_modulus_a, "b": state.bulk_modulus_b}
    viscosity = {"a": state.dynamic_viscosity_a, "b": state.dynamic_viscosity_b}
    total: dict[Chamber, dict[str, Array]] = {name: {} for name in CHAMBERS}

    def count(chamber: Chamber, what: str, value: Array) -> None:
        known = total[chamber].get(what)
        total[chamber][what] = value if known is None else known + value

    for i, line in enumerate(design.lines):
        at, chamber = f"lines[{i}].", line.chamber
        size = {"inner_diameter": v[at + "inner_diameter"], "length": v[at + "length"]}
        volume, wall = lines.line_volume(**size), wall_compliance(v, line, at)
        count(chamber, "volume", volume)
        if not line.rigid:
            count(chamber, "hoses" if line.type == "hose" else "pipes", wall)
        count(
            chamber,
            "resistance",
            elements.resistance(**size, dynamic_viscosity=viscosity[chamber]),
        )
        count(chamber, "inertance", elements.inertance(**size, density=state.density))
        if line.beyond_throttle or not throttled:
            share = 1.0 if throttled else 0.5
            count(chamber, "far", share * (volume / modulus[chamber] + wall))
    return {name: Branch(**total[name]) for name in CHAMBERS}
