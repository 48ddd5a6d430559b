"""Check the block `valve`: size of its edges, leakage, laps and frequency response."""

from __future__ import annotations

from collections.abc import Iterator

from ..base.errors import Fault
from ..base.quantities import INPUTS, length_text
from ..models.valve import WIDEST
from .structure import FileView, Loc, how_to_add, section_at, without_effect
from .valve import Valve

EDGES = ("pa", "pb", "at", "bt")
"""Metering edges of a spool: from supply p to the ports a and b, and from these to the tank t."""
LAPS = (
    "stroke", "overlap", "clearance", "rounding", "area_gradient", "flow_coefficient", "curve",
    *EDGES,
)  # fmt: skip
"""Keys of a lapped spool."""
COURSE = ("leakage_flow", "leakage_drop", "tank_leakage_drop")
"""Keys of the leakage that the course's law keeps at any opening."""


def valve(view: FileView, loc: Loc = ("valve",)) -> Iterator[Fault]:
    """Check a valve: one statement of its size and of its response, possible leakage and laps."""
    if not view.has(*loc):
        return
    yield from _response(view, loc)
    if view.text(*loc, "spool", "type") == "lapped":
        yield from _size(view, loc)
        yield from _lapped(view, loc)
        yield from _curve(view, loc)
    else:
        remedy = 'write "type: lapped", or remove it'
        yield from without_effect(view, (*loc, "spool"), LAPS, "with type: course", remedy)
        if not view.has(*loc, "rated_flow"):
            yield _missing(view, (*loc, "rated_flow"))
        yield from _leakage(view, loc)


def _missing(view: FileView, loc: Loc, why: str = "missing") -> Fault:
    """A key that is required here, with the line that adds it."""
    return Fault(loc, why, how_to_add(str(loc[-1]), section_at(view.root, loc)[1]))


def _leakage(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that the centred valve leaks less than it passes when open, at equal pressure drop."""
    numbers = [
        view.number(*loc, name)
        for name in ("rated_flow", "rated_drop", "leakage_flow", "leakage_drop")
    ]
    if any(number is None for number in numbers):
        return
    rated, rated_drop, leakage, leakage_drop = (number or 0.0 for number in numbers)
    most = rated * (leakage_drop / rated_drop) ** 0.5
    if leakage >= most:
        text = INPUTS["leakage_flow"].text
        yield Fault(
            (*loc, "leakage_flow"),
            f"{text(leakage)}: not less than the flow of the open valve at the same pressure drop",
            f"write less than {text(most)}",
        )


def _response(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that the spool's frequency response is stated once, and is that of second order."""
    natural, lag, fall = (
        view.number(*loc, name)
        for name in ("natural_frequency", "frequency_90deg", "frequency_3db")
    )
    stated = [view.has(*loc, name) for name in ("natural_frequency", "frequency_90deg")]
    if all(stated):
        yield Fault(
            (*loc, "frequency_90deg"),
            "states the same as natural_frequency: the spool lags by 90 degrees there",
            "keep one of them",
            at_key=True,
        )
    if not any(stated) and not view.has(*loc, "frequency_3db"):
        yield _missing(view, (*loc, "natural_frequency"))
    if not any(stated) or not view.has(*loc, "frequency_3db"):
        return
    if view.has(*loc, "damping_ratio"):
        yield Fault(
            (*loc, "damping_ratio"),
            "follows from frequency_3db and the other frequency, which are both stated",
            "remove damping_ratio or frequency_3db",
            at_key=True,
        )
    base = natural if stated[0] else lag
    if base is not None and fall is not None and fall >= WIDEST * base:
        text = INPUTS["frequency"].text
        yield Fault(
            (*loc, "frequency_3db"),
            f"{text(fall)}: no spool of second order lags by 90 degrees at {text(base)} and "
            f"falls to -3 dB only there",
            f"write less than {text(WIDEST * base)}",
        )


def _size(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that a lapped spool states the size of its edges once, and no leakage flow."""
    sized = view.has(*loc, "spool", "area_gradient")
    if sized and view.has(*loc, "rated_flow"):
        yield Fault(
            (*loc, "spool", "area_gradient"),
            "states the size of the edges a second time, beside valve.rated_flow",
            "keep one of them",
            at_key=True,
        )
    if sized:
        yield from without_effect(
            view, loc, ("rated_drop", "rated_viscosity"), "with spool.area_gradient"
        )
    if not sized and not view.has(*loc, "rated_flow"):
        yield _missing(view, (*loc, "rated_flow"), "missing: required without spool.area_gradient")
    others = tuple(  # a design that a program changes states its defaults
        name for name in COURSE if view.number(*loc, name) != Valve.model_fields[name].default
    )
    yield from without_effect(
        view,
        loc,
        others,
        "with a lapped spool, which leaks through its clearance",
        "remove it, and state spool.clearance",
    )


def _curve(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that the curve of flow over signal rises, and that no edge states an overlap too."""
    spool = (*loc, "spool")
    points = [
        tuple(view.number(*spool, "curve", i, name) for name in ("signal", "flow"))
        for i in range(len(view.items(*spool, "curve")))
    ]
    text = INPUTS["opening"].text
    for i, (signal, flow) in enumerate(points):
        before, low = points[i - 1] if i else (0.0, 0.0)
        if None in (signal, flow, before, low):
            continue
        assert signal is not None
        assert flow is not None
        assert before is not None
        assert low is not None
        if not before < signal < 1.0:
            yield Fault(
                (*spool, "curve", i, "signal"),
                f"{text(signal)}: not between the signal before it ({text(before)}) and 100 %",
                "write rising signals; the curve begins at 0 % and ends at 100 %",
            )
        if flow < low:
            yield Fault(
                (*spool, "curve", i, "flow"),
                f"{text(flow)}: less than the flow at a smaller signal ({text(low)})",
                f"write at least {text(low)}",
            )
    for edge in ((), *((name,) for name in EDGES)):
        if points and view.number(*spool, *edge, "overlap"):
            yield Fault(
                (*spool, *edge, "overlap"),
                "states the dead band a second time, beside the curve",
                "remove it, or the curve",
                at_key=True,
            )


def _lapped(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check stroke, overlap, clearance and rounding of every edge of a lapped spool."""
    spool = (*loc, "spool")
    stroke = view.number(*spool, "stroke")
    stated = False
    for edge in ((), *((name,) for name in EDGES)):
        at = (*spool, *edge)
        overlap, clearance, rounding = (
            view.number(*at, name) for name in ("overlap", "clearance", "rounding")
        )
        if rounding and not (clearance or view.number(*spool, "clearance")):
            yield Fault(
                (*at, "rounding"),
                "without effect on edges without clearance",
                'remove it, or add e.g. "clearance: 3 um"',
                at_key=True,
            )
        stated = stated or bool(overlap or clearance)
        if stroke is None:
            continue
        if overlap is not None and abs(overlap) >= stroke:
            never = "opens" if overlap > 0 else "closes"
            yield Fault(
                (*at, "overlap"),
                f"{length_text(overlap)}: not less than the stroke of the spool "
                f"({length_text(stroke)}), so that the edge never {never}",
                f"write less than {length_text(stroke)}, or a longer stroke",
            )
        if clearance is not None and clearance >= stroke:
            yield Fault(
                (*at, "clearance"),
                f"{length_text(clearance)}: not less than the stroke of the spool "
                f"({length_text(stroke)})",
                f"write less than {length_text(stroke)}",
            )
    if (stated or view.has(*spool, "area_gradient")) and not view.has(*spool, "stroke"):
        yield _missing(
            view, (*spool, "stroke"), "missing: required with overlap, clearance or area_gradient"
        )
