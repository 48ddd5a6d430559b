"""Check the block `valve`: size of its edges, leakage, laps and frequency response."""

from __future__ import annotations

from collections.abc import Iterator

from ..base.errors import Fault, InputError
from ..base.quantities import INPUTS, length_text
from ..models.valve import WIDEST
from .data_file import DataFile
from .flow_curve import EDGES, check_ends, flow_table
from .structure import FileView, Loc, how_to_add, section_at, without_effect

LAPS = (
    "stroke", "overlap", "clearance", "rounding", "area_gradient", "flow_coefficient", "curve",
    *EDGES,
)  # fmt: skip
"""Keys of a lapped spool."""
COURSE = ("leakage_flow", "leakage_drop", "tank_leakage_drop")
"""Keys of the leakage that the course's law keeps at any opening."""
SIZES = ("rated_flow", "edge_coefficients", "flow_curve")
"""A valve states the size of its edges by a single one of these keys; a lapped spool may state its
width instead."""


def valve(view: FileView, loc: Loc = ("valve",)) -> Iterator[Fault]:
    """Check a valve: one statement of its size and of its response, possible leakage and laps."""
    if not view.has(*loc):
        return
    yield from _response(view, loc)
    yield from _hysteresis(view, loc)
    if view.text(*loc, "spool", "type") == "lapped":
        yield from _size(view, loc)
        yield from _lapped(view, loc)
        yield from _curve(view, loc)
    else:
        remedy = 'write "type: lapped", or remove it'
        yield from without_effect(view, (*loc, "spool"), LAPS, "with type: course", remedy)
        yield from _one_size(view, loc)
        yield from _flow_curve(view, loc)
        yield from _leakage(view, loc)


def _missing(view: FileView, loc: Loc, why: str = "missing") -> Fault:
    """A key that is required here, with the line that adds it."""
    return Fault(loc, why, how_to_add(str(loc[-1]), section_at(view.root, loc)[1]))


def _one_size(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that one key states the size of the edges."""
    stated = [name for name in SIZES if view.has(*loc, name)]
    if not stated:
        yield _missing(view, (*loc, "rated_flow"))
    for name in stated[1:]:
        yield Fault(
            (*loc, name),
            f"states the size of the edges a second time, beside {stated[0]}",
            "keep one of them",
            at_key=True,
        )
    if stated == ["edge_coefficients"]:
        yield from without_effect(view, loc, ("rated_drop",), "with edge_coefficients")


def _flow_curve(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check a flow curve: its ends, and no second statement of the leakage."""
    if not view.has(*loc, "flow_curve"):
        return
    where = "with flow_curve, whose flow at the centre is the leakage"
    yield from without_effect(view, loc, COURSE, where)
    file, full = view.value(*loc, "flow_curve"), view.number(*loc, "signal")
    if not isinstance(file, DataFile) or full is None:
        return
    try:
        table = file.parsed(flow_table)
    except InputError:  # a fault of its own
        return
    for message, remedy in check_ends(table, full):
        yield Fault((*loc, "flow_curve"), message, remedy)


def _hysteresis(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that the threshold, which is part of the hysteresis, does not exceed it."""
    hysteresis, threshold = (view.number(*loc, name) for name in ("hysteresis", "threshold"))
    if hysteresis is None or threshold is None or threshold <= hysteresis:
        return
    text = INPUTS["threshold"].text
    yield Fault(
        (*loc, "threshold"),
        f"{text(threshold)}: more than the hysteresis ({text(hysteresis)}), which includes it",
        f"write at most {text(hysteresis)}",
    )


def _full_coefficient(view: FileView, loc: Loc) -> float | None:
    """Least flow coefficient of a fully open edge [m^3/s/sqrt(Pa)]; None if it is not stated."""
    if view.has(*loc, "edge_coefficients"):
        numbers = [view.number(*loc, "edge_coefficients", edge) for edge in EDGES]
        return min((number for number in numbers if number is not None), default=None)
    rated, drop = view.number(*loc, "rated_flow"), view.number(*loc, "rated_drop")
    return None if rated is None or drop is None else rated / drop**0.5


def _leakage(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that the centred valve leaks less than it passes when open, at equal pressure drop."""
    open_edge, leakage, drop, tank_drop = (
        _full_coefficient(view, loc),
        *(view.number(*loc, name) for name in COURSE),
    )
    if open_edge is None or leakage is None or drop is None:
        return
    most = open_edge * min(drop, tank_drop or drop) ** 0.5
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
    yield from without_effect(
        view,
        loc,
        SIZES[1:],
        "with a lapped spool, whose edges differ by overlap and flow_share",
        'remove it, or write "type: course"',
    )
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
    if view.has(*loc, "leakage_flow"):
        yield from _lapped_leakage(view, loc)
    else:
        yield from without_effect(view, loc, ("leakage_drop",), "without leakage_flow")
    yield from without_effect(
        view, loc, COURSE[2:], "with a lapped spool, whose edges have one clearance"
    )


MOST_LEAKAGE = 0.5
"""Largest leakage of an edge from which its clearance follows, as a share of the flow of the open
edge at the same pressure drop (our choice): the clearance then stays well below the stroke."""


def _lapped_leakage(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check the leakage of a lapped spool, from which the clearance of its equal edges follows."""
    leakage, drop, rated, rated_drop = (
        view.number(*loc, name)
        for name in ("leakage_flow", "leakage_drop", "rated_flow", "rated_drop")
    )
    clearance = 'state the clearance instead: "spool: {clearance: 3 um}"'
    if not view.has(*loc, "rated_flow"):
        yield Fault((*loc, "leakage_flow"), "needs valve.rated_flow with a lapped spool", clearance)
        return
    if not view.has(*loc, "rated_viscosity"):
        why = "missing: oil of the data sheet, required with leakage_flow and a lapped spool"
        yield _missing(view, (*loc, "rated_viscosity"), why)
    if view.has(*loc, "spool", "clearance"):
        yield Fault(
            (*loc, "spool", "clearance"),
            "states the leakage a second time, beside valve.leakage_flow",
            "keep one of them",
            at_key=True,
        )
    for edge in EDGES:
        for key in ("overlap", "clearance", "rounding"):
            if view.has(*loc, "spool", edge, key):
                yield Fault(
                    (*loc, "spool", edge, key),
                    "edges that differ do not leak alike, as valve.leakage_flow says",
                    clearance,
                    at_key=True,
                )
    overlap = view.number(*loc, "spool", "overlap")
    if overlap is not None and overlap < 0:
        yield Fault(
            (*loc, "leakage_flow"),
            "without effect on edges that are open at the centre (negative overlap)",
            clearance,
        )
    if leakage is None or drop is None or rated is None or rated_drop is None:
        return
    most = MOST_LEAKAGE * rated * (drop / rated_drop) ** 0.5
    if not 0 < leakage < most:
        text = INPUTS["leakage_flow"].text
        yield Fault(
            (*loc, "leakage_flow"),
            f"{text(leakage)}: no clearance follows from it",
            f"write more than zero and less than {text(most)}",
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
        leaks = view.number(*spool, "clearance") or view.number(*loc, "leakage_flow")
        if rounding and not (clearance or leaks):
            yield Fault(
                (*at, "rounding"),
                "without effect on edges without clearance",
                'remove it, or add e.g. "clearance: 3 um"',
                at_key=True,
            )
        stated = stated or bool(overlap or clearance or view.number(*loc, "leakage_flow"))
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
            view,
            (*spool, "stroke"),
            "missing: required with overlap, clearance, leakage_flow or area_gradient",
        )
