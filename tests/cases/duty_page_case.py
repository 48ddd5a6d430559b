"""The knee with duty cycles: from shipped records, or from a few samples written in a test."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import actuator_opt as ao
from actuator_opt.evaluation.result import Evaluation

DESIGNS = Path(__file__).parents[2] / "designs"
GAIT, RUN, FLIGHT = (
    (DESIGNS / "cycles" / f"{name}.csv").read_text(encoding="utf-8")
    for name in ("gait_knee", "run_knee", "flight_control_synthetic")
)
LINKAGE = "linkage: {base_radius: 240 mm, crank_radius: 62 mm, angle_offset: 120 deg}\n"
VALVE = (
    "valve: {rated_flow: 10 l/min, leakage_flow: 0.2 l/min, leakage_drop: 50 bar, "
    "natural_frequency: 100 Hz}\n"
)


def cycle(name: str, record: str, **keys: object) -> str:
    """A cycle of the block `duty`, with the text of its record."""
    rows = "".join(f"        {line}\n" for line in record.strip().splitlines())
    more = "".join(f"      {key}: {value}\n" for key, value in keys.items())
    return f"    - name: {name}\n{more}      file: |\n{rows}"


def design(*cycles: str, linkage: bool = True, valve: bool = True, limit: str = "90 %") -> str:
    """The text of the knee with these cycles."""
    text = (DESIGNS / "knee.yaml").read_text(encoding="utf-8")
    text += (LINKAGE if linkage else "") + (VALVE if valve else "")
    return f"{text}duty:\n  opening_limit: {limit}\n  cycles:\n{''.join(cycles)}"


@cache
def evaluated(
    *cycles: str, linkage: bool = True, valve: bool = True, limit: str = "90 %"
) -> Evaluation:
    """The evaluation of `design`."""
    return ao.evaluate(ao.read(design(*cycles, linkage=linkage, valve=valve, limit=limit)))
