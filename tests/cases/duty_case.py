"""The servo knee with a linkage and duty cycles, for tests of what follows from them."""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np

import actuator_opt as ao

DESIGNS = Path(__file__).parents[2] / "designs"
GAIT = DESIGNS / "cycles" / "gait_knee.csv"
LINKAGE = """\
linkage:
  base_radius: 250 mm
  crank_radius: 62 mm
  angle_offset: 120 deg
"""


def wave(amplitude: float = 20.0, frequency: float = 2.0, force: float = 500.0) -> str:
    """A sine of the piston about mid-stroke [mm, Hz] under a constant force [N], as a file."""
    time = np.linspace(0.0, 1 / frequency, 81)
    x = 55 + amplitude * np.sin(2 * np.pi * frequency * time)
    x[-1] = x[0]
    rows = [f"{t:.9f},{p:.9f},{force}" for t, p in zip(time, x, strict=True)]
    return "\n".join(["time [s],position [mm],force [N]", *rows]) + "\n"


def text(cycle: str | None = None, *, stated: str = "") -> str:
    """The design's file: walking with a linkage, or a cycle of position and force from a text.

    `stated` are further lines of the cycle.
    """
    base = (DESIGNS / "servo_knee.yaml").read_text("utf-8")
    file = f"file: {GAIT}" if cycle is None else f"file: |\n{textwrap.indent(cycle, ' ' * 8)}"
    duty = f"duty:\n  cycles:\n    - name: walk\n      {file}\n" + textwrap.indent(stated, " " * 6)
    return base.replace("load_cases:", f"{LINKAGE if cycle is None else ''}{duty}\nload_cases:", 1)


def knee(cycle: str | None = None, *, stated: str = "", **changed: str | None) -> ao.Actuator:
    """The design, with values changed by PATH."""
    values = {path.replace("__", "."): value for path, value in changed.items()}
    return ao.read(text(cycle, stated=stated), set=values)
