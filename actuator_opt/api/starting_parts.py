"""Standard threads and rings for the first sizes of a start design."""

from __future__ import annotations

from collections.abc import Sequence

from ..design import standard_sizes
from ..design.housings import extrusion_tables
from ..evaluation.rings import EXTRUSION_TABLE
from ..models.gland import extrusion_gap_limit, extrusion_pressure_end

ROD_THREADS = (
    (4, 0.5), (5, 0.5), (6, 0.75), (8, 1), (10, 1.25), (12, 1.25), (14, 1.5), (16, 1.5), (18, 1.5),
    (20, 1.5), (22, 1.5), (24, 2), (27, 2), (30, 2), (33, 2), (36, 2), (42, 2), (48, 2), (56, 2),
    (64, 3), (72, 3), (80, 3), (90, 3), (100, 3), (110, 3), (125, 4), (140, 4), (160, 4), (180, 4),
    (200, 4), (220, 4), (250, 6), (280, 6),
)  # fmt: skip
"""Threads of rod ends, diameter and pitch [mm]: ISO 4395, quoted from memory, unverified."""
BOLTS = (
    (3, 0.5), (4, 0.7), (5, 0.8), (6, 1), (8, 1.25), (10, 1.5), (12, 1.75), (16, 2), (20, 2.5),
    (24, 3), (30, 3.5), (36, 4), (42, 4.5), (48, 5), (56, 5.5), (64, 6), (72, 6), (80, 6), (90, 6),
    (100, 6),
)  # fmt: skip
"""Coarse threads of tie rods, diameter and pitch [mm]: ISO 261, quoted from memory, unverified."""

SECTION = 1 / 15
"""Largest section of a ring, divided by bore or rod diameter. Our choice: 1.78 mm up to 39 mm."""


def thread_of(sizes: Sequence[tuple[float, float]], square: float) -> tuple[float, float]:
    """The first thread (diameter, pitch in m) whose root diameter squared reaches `square` [m^2].

    The root diameter is d - 1.2268 P [ISO68-1].
    """
    for diameter, pitch in sizes:
        if (1e-3 * (diameter - 1.2268 * pitch)) ** 2 >= square:
            break
    return 1e-3 * diameter, 1e-3 * pitch


def section_of(diameter: float) -> float:
    """Section of the ring for a bore or rod: the largest tabulated one of at most `SECTION`."""
    sections = standard_sizes.o_ring_sections("as568")
    return max((x for x in sections if x <= SECTION * diameter), default=sections[0])


def compound_of(pressure: float, needed: float) -> tuple[str, bool]:
    """The softest O-ring that bears a gap at a pressure, and whether it needs back-up rings."""
    table = extrusion_tables()[EXTRUSION_TABLE].rows
    for compound, hardness in (("nbr_70", 70.0), ("nbr_90", 90.0)):
        gap = extrusion_gap_limit(hardness=hardness, pressure=pressure, table=table)
        if gap >= needed and pressure <= extrusion_pressure_end(hardness=hardness, table=table):
            return compound, False
    return compound, True
