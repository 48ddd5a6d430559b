"""A Simulation over time, as CSV: every signal on the grid of its samples."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path

import numpy as np

from ..base.files import write_text
from ..base.numeric import Array
from ..design.scenario.model import SAMPLES
from ..rendering.paper import ReportFile
from ..simulation.result import Simulation

NEAR = 1e-6
"""Share of a step within which a sample stands on the grid."""


def grid(simulation: Simulation) -> tuple[Array, Array]:
    """Times [s] at even steps and the sample of each: where it stands twice, the one after."""
    time, duration = simulation.time, simulation.scenario.duration
    step = simulation.scenario.sample_time or duration / SAMPLES
    count = max(round(duration / step), 1)
    even = np.linspace(0.0, duration, count + 1)
    near = NEAR * duration / count
    at = np.searchsorted(time, even + near, side="right") - 1
    on = np.abs(time[at] - even) <= near
    return even[on], at[on]


def heading(name: str, unit: str) -> str:
    """A column's name with its unit.

    >>> heading("position", "mm"), heading("phase", "")
    ('position [mm]', 'phase')
    """
    return f"{name} [{unit}]" if unit else name


def write_signals(simulation: Simulation, path: Path) -> ReportFile:
    """Write every signal over time, one line per sample; empty where there is no value.

    Parameters
    ----------
    simulation : of a scenario
    path : of the file
    """
    time, at = grid(simulation)
    heads, columns = ["t [s]"], [time]
    for name, values in simulation.signals.items():
        quantity = simulation.told[name].quantity
        heads.append(heading(name, quantity.unit))
        columns.append(values[at] * quantity.to_display(1.0))
    stream = io.StringIO()
    stream.write(",".join(heads) + "\n")
    formats = ["%.9g", *["%.7g"] * (len(columns) - 1)]
    np.savetxt(stream, np.stack(columns).T, fmt=",".join(formats))
    text = stream.getvalue().replace("nan", "")
    write_text(path, text)
    return ReportFile(path, hashlib.sha256(text.encode()).hexdigest(), 1)
