"""Small pictures for the pages: a part of a picture, narrowed, as WebP.

A report page is a PNG of some 400 kB; half a page as WebP, as wide as the text, has 30 to 60 kB.
"""

from __future__ import annotations

from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
SAMPLES = ROOT / "reports" / "samples"
WIDTH = 900
"""Pixels: the text of a page is some 740 pixels wide."""
QUALITY = 60
MARGIN = 16
"""Pixels of white paper that stay around what is drawn."""


def part(source: str | Path, target: str | Path, top: float = 0.0, bottom: float = 1.0) -> Path:
    """Write the part of a picture between two heights, without the white paper around it.

    Parameters
    ----------
    source : picture on white paper
    target : WebP file
    top, bottom : where the part begins and ends, as shares of the height
    """
    with Image.open(source) as picture:
        paper = picture.convert("RGB")
    paper = paper.crop((0, round(top * paper.height), paper.width, round(bottom * paper.height)))
    left, high, right, low = paper.convert("L").point(lambda grey: 255 * (grey < 250)).getbbox()
    box = (left - MARGIN, high - MARGIN, right + MARGIN, low + MARGIN)
    inside = (max(box[0], 0), max(box[1], 0), min(box[2], paper.width), min(box[3], paper.height))
    paper = paper.crop(inside)
    if paper.width > WIDTH:
        paper = paper.resize((WIDTH, round(paper.height * WIDTH / paper.width)), Image.LANCZOS)
    paper.save(target, quality=QUALITY, method=6)
    return Path(target)


def card(name: str, top: float = 0.0, bottom: float = 1.0) -> Path:
    """Write a part of a sample report's first page as ``NAME.webp`` into this folder."""
    return part(SAMPLES / f"{name}.png", f"{name}.webp", top, bottom)
