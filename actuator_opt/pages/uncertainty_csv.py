"""Draws as CSV: the inputs in their display units, margins of every limit, whether all hold."""

from __future__ import annotations

import csv
import hashlib
import io
from pathlib import Path

import numpy as np

from ..base.files import write_text
from ..rendering.paper import ReportFile
from ..uncertainties.model import TOLERANCE
from ..uncertainties.result import Uncertainty


def write_draws(found: Uncertainty, path: Path) -> ReportFile:
    """Write one line per draw that was kept; a margin without a number stays empty.

    Parameters
    ----------
    found : what was drawn
    path : of the file
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    heads = [f"{x.path} [{x.quantity.unit}]" if x.quantity.unit else x.path for x in found.inputs]
    margins = [f"margin of {limit.name}" for limit in found.limits]
    writer.writerow([*heads, *margins, "requirements met"])
    shown = np.array(
        [
            one.quantity.to_display(row)
            for one, row in zip(found.inputs, found.kept.values, strict=True)
        ]
    ).reshape(len(found.inputs), -1)
    own = np.array([limit.required for limit in found.limits], dtype=bool)
    met = (found.kept.margins[own] >= -TOLERANCE).all(axis=0)
    for k, holds in enumerate(met):
        cells = [f"{value:.7g}" for value in shown[:, k]] if len(shown) else []
        for margin in found.kept.margins[:, k]:
            cells.append(f"{margin:.5g}" if np.isfinite(margin) else "")
        writer.writerow([*cells, int(holds)])
    text = stream.getvalue()
    write_text(path, text)
    return ReportFile(path, hashlib.sha256(text.encode()).hexdigest(), 1)
