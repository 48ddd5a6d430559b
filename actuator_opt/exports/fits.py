"""Notes of a drawing on fits, surfaces, threads and ports, by ISO 286 and ISO 261.

Piston and head are fitted to the bore as H8/f7, and so is the rod to the head. The tolerances are
those of the size; whether they contain the clearance that the design states is said beside them.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..design.model import Design
from ..design.standard_sizes import port, spherical_bearing
from ..evaluation import Evaluation
from ..evaluation.geometry import joints_of
from ..joints.joint import ENCLOSED

RANGES = (
    # up to, IT7, IT8, upper deviation of f: mm and um
    (3, 10, 14, -6),
    (6, 12, 18, -10),
    (10, 15, 22, -13),
    (18, 18, 27, -16),
    (30, 21, 33, -20),
    (50, 25, 39, -25),
    (80, 30, 46, -30),
    (120, 35, 54, -36),
    (180, 40, 63, -43),
    (250, 46, 72, -50),
    (315, 52, 81, -56),
    (400, 57, 89, -62),
    (500, 63, 97, -68),
)
"""Nominal sizes with the standard tolerances IT7 and IT8, and the upper deviation of shafts f
[ISO286]. Recalled; a test compares them with the formulas of the standard."""


def deviations(size: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Lower and upper deviation of a hole H8 and of a shaft f7 [m].

    Parameters
    ----------
    size : nominal diameter [m]

    Raises
    ------
    ValueError
        the diameter exceeds 500 mm

    Examples
    --------
    >>> hole, shaft = deviations(21.5e-3)
    >>> [round(1e6 * value) for value in (*hole, *shaft)]
    [0, 33, -41, -20]
    """
    for largest, seventh, eighth, upper in RANGES:
        if 1e3 * size <= largest:
            return (0.0, 1e-6 * eighth), (1e-6 * (upper - seventh), 1e-6 * upper)
    raise ValueError(f"no tolerances are known above 500 mm, but the diameter is {1e3 * size:g} mm")


def notes(evaluation: Evaluation) -> Iterator[str]:
    """Yield the notes on fits, surfaces and threads of a design."""
    design, lengths = evaluation.design, evaluation.lengths
    yield "Dimensions without tolerance: ISO 2768-m. Fits: ISO 286-2."
    yield from _fit("Bore", "piston and head", lengths["bore"], _clearances(design, "piston"))
    for key, gland in (("rod", "head"), ("second_rod", "second gland")):
        if key in lengths:
            rod, clearance = key.replace("_", " "), _clearances(design, "head")
            yield from _fit(f"Hole of the {gland}", rod, lengths[key], clearance)
    for name, part in (("bore", "piston"), ("rod", "rod")):
        roughness = getattr(design.seals, part).counterface_roughness
        yield f"Surface of the {name}: RMS roughness at most {1e6 * roughness:.3g} um."
    thread = design.rod.thread
    if thread is not None:
        size = f"M{1e3 * thread.diameter:.5g} x {1e3 * thread.pitch:g} - 6g"
        yield f"Thread of the rod end: {size}, {1e3 * thread.diameter:.4g} long."
    nut = design.piston.nut
    if nut is not None:
        size = f"M{1e3 * nut.diameter:.5g} x {1e3 * nut.pitch:g} - 6g"
        yield f"Thread of the piston's stud: {size}; tighten to {1e-3 * nut.preload:.4g} kN."
    if design.cylinder.port_thread is not None:
        hole = port(design.cylinder.port_thread)
        yield (
            f"Ports: {hole.thread} by {hole.standard}, full thread {1e3 * hole.depth:g} deep, "
            f"drill {1e3 * hole.drilled:g} deep."
        )
        if design.cushion is None and any(e.joint.form in ENCLOSED for e in joints_of(design)):
            yield "Chamfer the edges of the piston, which pass the ports."
    if design.clevis is not None and design.clevis.bearing is not None:
        bearing = spherical_bearing(design.clevis.bearing)
        yield f"Holes of the eyes: {1e3 * bearing.outer_diameter:g} mm for {bearing.name.upper()}."


def _clearances(design: Design, part: str) -> float:
    clearance: float = getattr(design, part).clearance
    return clearance


def _fit(hole: str, shaft: str, size: float, clearance: float) -> Iterator[str]:
    """Yield the note on one fit; `clearance` is the radial clearance of the design [m]."""
    try:
        (_, high), (low, top) = deviations(size)
    except ValueError as error:
        yield f"{hole}: {error}."
        return
    least, most = -top / 2, (high - low) / 2
    within = least <= clearance <= most
    text = f"{hole} {1e3 * size:.5g} H8 (0 / +{1e3 * high:.3f}), {shaft} f7 ({1e3 * low:.3f} / "
    text += f"{1e3 * top:.3f}): radial clearance {1e3 * least:.3f} to {1e3 * most:.3f} mm; "
    text += f"the design has {1e3 * clearance:.3g} mm"
    yield text + ("." if within else ", which needs another fit.")
