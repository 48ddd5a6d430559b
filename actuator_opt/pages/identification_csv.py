"""What a record told over time, as CSV: the conditioned channels, friction, stiffness, growth."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path

import numpy as np

from ..base.files import write_text
from ..identification.result import Identification
from ..rendering.paper import ReportFile

COLUMNS = {
    "time": ("t [s]", 1.0, "%.6f"),
    "position": ("x [mm]", 1e3, "%.5f"),
    "velocity": ("v [mm/s]", 1e3, "%.5g"),
    "acceleration": ("acceleration [m/s^2]", 1.0, "%.5g"),
    "pressure_1": ("p1 [bar]", 1e-5, "%.5f"),
    "pressure_2": ("p2 [bar]", 1e-5, "%.5f"),
    "friction": ("friction [N]", 1.0, "%.5g"),
    "stiffness": ("k_eq [kN/mm]", 1e-6, "%.5g"),
    "growth": ("growth at seal [um]", 1e6, "%.5g"),
}
"""Heading with unit, display value over SI value, and digits."""


def write_series(identification: Identification, path: Path) -> ReportFile:
    """Write the quantities over time, one line per sample; empty where there is no value.

    Parameters
    ----------
    identification : of a record
    path : of the file
    """
    series = identification.series()
    shown = [COLUMNS[name] for name in series]
    table = np.stack(
        [series[name] * scale for name, (_, scale, _) in zip(series, shown, strict=True)]
    )
    stream = io.StringIO()
    stream.write(",".join(heading for heading, _, _ in shown) + "\n")
    np.savetxt(stream, table.T, fmt=",".join(form for _, _, form in shown))
    text = stream.getvalue().replace("nan", "")
    write_text(path, text)
    return ReportFile(path, hashlib.sha256(text.encode()).hexdigest(), 1)
