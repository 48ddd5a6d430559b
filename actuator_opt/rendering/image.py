"""A drawing as files of its own: PNG and SVG."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from ..base.files import write_all
from . import paper_plain as fallback
from .blocks import printable
from .ink import Ink
from .paper import PIXELS_PER_INCH


def images(ink: Ink, stem: str) -> dict[str, bytes]:
    """STEM.png and STEM.svg of a drawing; the same drawing gives the same bytes."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    style: Any = {
        "font.family": "DejaVu Sans",
        "text.parse_math": False,
        "text.usetex": False,
        "svg.hashsalt": stem,
    }
    for mark in ink.marks:
        if "text" in mark:
            mark["text"] = printable(mark["text"])
    contents = {}
    with mpl.rc_context(style):
        figure = fallback.drawn(ink)
        FigureCanvasAgg(figure)
        for kind, about in (("png", {"Software": None}), ("svg", {"Date": None, "Creator": None})):
            file = io.BytesIO()
            figure.savefig(file, format=kind, dpi=PIXELS_PER_INCH, metadata=about)
            contents[f"{stem}.{kind}"] = file.getvalue()
    return contents


def write_ink(ink: Ink, folder: Path, stem: str) -> list[Path]:
    """Write STEM.png and STEM.svg into a folder, whole or not at all."""
    contents = images(ink, stem)
    write_all(folder, contents, what="the figure")
    return [folder / name for name in contents]
