"""Faults of caps screwed onto the barrel: a thread is cut into metal, and leaves metal under it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..metrics import LEAST_METAL
from ..models import thread
from .paths import spell
from .structure import Loc, child_at
from .view import Fault, Materials, Properties, View, length_text
from .wall_faults import known_numbers

NEEDED = ("yield_strength", "ultimate_strength")
"""What a metal states, so that a thread in it can be judged."""

OTHERWISE = "bond the caps (type: bond), or clamp them (type: tie_rods)"

ROUNDING = 1e-5
"""Relative room for an optimum that stands on the limit."""


@dataclass(frozen=True, slots=True)
class _Sizes:
    """Barrel's outside, thickness of its outermost layer, thread and skirt [m]."""

    outside: float
    layer: float
    diameter: float
    pitch: float
    wall: float


def _screwed(view: View) -> bool:
    return view.text("retention", "type") == "thread"


def _layer(view: View) -> Loc:
    """Place of the outermost layer of the barrel."""
    return ("barrel", "layup", len(view.items("barrel", "layup")) - 1)


def _sizes(view: View) -> _Sizes | None:
    """The sizes of the joint; None where one is missing or faulty."""
    count = len(view.items("barrel", "layup"))
    layers = [view.number("barrel", "layup", index, "thickness") for index in range(count)]
    known = [layer for layer in layers if layer is not None]
    bore, pitch = view.number("cylinder", "bore"), view.number("retention", "thread", "pitch")
    wall = view.number("retention", "wall")
    if bore is None or pitch is None or wall is None or not known or len(known) < count:
        return None
    outside = bore + 2 * sum(known)
    stated = view.number("retention", "thread", "diameter")
    return _Sizes(outside, known[-1], outside if stated is None else stated, pitch, wall)


def fits(view: View) -> Iterator[Fault]:
    """The thread is cut into barrel and caps, on the barrel's outside, and its turns engage."""
    if not _screwed(view):
        return
    if view.has("retention", "material") and not _chosen(view, ("retention", "type")):
        yield Fault(
            ("retention", "material"),
            "without effect on a thread, which is cut into barrel and caps",
            "remove the line; change barrel.layup or caps.material",
            at_key=True,
        )
    pitch, length = view.number("retention", "thread", "pitch"), view.number("retention", "length")
    if pitch is not None and length is not None and length < (1 + thread.RUN_OUT) * pitch:
        yield Fault(
            ("retention", "length"),
            f"{length_text(length)}: no whole turn of the thread engages, whose pitch is "
            f"{length_text(pitch)}",
            f"write at least {length_text((1 + thread.RUN_OUT) * pitch)}",
        )
    sizes = _sizes(view)
    if sizes is None:
        return
    overlap = thread.crest_overlap(
        diameter=sizes.diameter,
        pitch=sizes.pitch,
        crest_diameter=min(sizes.diameter, sizes.outside),
    )
    if overlap < thread.LEAST_OVERLAP * (1 - ROUNDING) and not _judged_later(view, _moved(view)):
        text = length_text(sizes.outside)
        yield Fault(
            ("retention", "thread", "diameter"),
            f"{length_text(sizes.diameter)}: larger than the barrel's outside ({text}), which it "
            "is cut into",
            f"write at most {text}, or leave it out: then it is the outside",
        )


def of_materials(tree: Any, materials: Materials) -> Iterator[Fault]:
    """Both threads are cut into a metal that states its strengths, and leave enough of it."""
    view = View(tree)
    if not _screwed(view):
        return
    sizes = _sizes(view)
    caps = "caps" if view.has("caps") else "piston"  # whose material caps have by default
    if _metal(view, materials, (*_layer(view), "material")) and sizes is not None:
        yield from _under(view, sizes)
    if _metal(view, materials, (caps, "material")) and sizes is not None:
        yield from _over(view, sizes)
    for part, loc in (
        ("the barrel's outermost layer, which is", (*_layer(view), "material")),
        ("the caps' skirts, which are", (caps, "material")),
    ):
        yield from _into(view, materials, part, loc)


def _metal(view: View, materials: Materials, loc: Loc) -> bool:
    name = view.text(*loc)
    return name is not None and name in materials and materials.kind(name) == "metal"


def _into(view: View, materials: Materials, part: str, loc: Loc) -> Iterator[Fault]:
    """A thread cut into what is no metal, or a metal without strengths."""
    name = view.text(*loc)
    kind = materials.kind(name) if name is not None and name in materials else None
    if name is None or kind is None:
        return
    if kind != "metal":
        what = "of plies, whose fibres it severs" if kind == "ply" else f"of a {kind}"
        yield Fault(
            loc,
            f"{name}: retention.type thread cuts into {part} {what}; a thread is cut into metal "
            "only",
            f"make {spell(loc[:-1])} of metal, {OTHERWISE}",
        )
    elif isinstance(materials, Properties):
        numbers = known_numbers(view, materials, name)
        missing = [key for key in NEEDED if numbers and key not in numbers]
        if missing:
            yield Fault(
                loc,
                f"{name} states no {' nor '.join(missing)}: a thread in it cannot be judged",
                f'add e.g. "{missing[0]}: 355 MPa" under materials.{name}, {OTHERWISE}',
            )


def _under(view: View, sizes: _Sizes) -> Iterator[Fault]:
    """Too little metal under the thread, in the layer it is cut into."""
    root = thread.root_diameter(diameter=min(sizes.diameter, sizes.outside), pitch=sizes.pitch)
    left = sizes.layer - (sizes.outside - root) / 2
    layer = _layer(view)
    if left < LEAST_METAL * (1 - ROUNDING) and not _judged_later(view, _moved(view)):
        name = view.text(*layer, "material")
        rest = length_text(left) if left > 0 else "nothing"
        yield Fault(
            (*layer, "thickness"),
            f"{length_text(sizes.layer)} of {name}: the thread leaves {rest} of it, "
            f"{length_text(LEAST_METAL)} is the least",
            f"write a thickness of at least {length_text(sizes.layer + LEAST_METAL - left)}, "
            f"a finer pitch, {OTHERWISE}",
        )


def _over(view: View, sizes: _Sizes) -> Iterator[Fault]:
    """Too little metal over the thread of the skirts."""
    loc = ("retention", "wall")
    if sizes.wall < LEAST_METAL * (1 - ROUNDING) and not _judged_later(view, [loc]):
        yield Fault(
            loc,
            f"{length_text(sizes.wall)}: the least metal over a thread is "
            f"{length_text(LEAST_METAL)}",
            f"write at least {length_text(LEAST_METAL)}",
        )


def _moved(view: View) -> list[Loc]:
    """Places of the sizes on which the wall under the thread and its crests depend."""
    layer = _layer(view)
    moved: list[Loc] = [("retention", "thread", "pitch"), (*layer, "thickness")]
    if view.has("retention", "thread", "diameter"):
        moved += [("retention", "thread", "diameter"), ("cylinder", "bore")]
        moved += [("barrel", "layup", i, "thickness") for i in range(int(layer[-1]))]
    return moved


def _chosen(view: View, loc: Loc) -> bool:
    return child_at(view.tree, ("choices", spell(loc))) is not None


def _judged_later(view: View, moved: list[Loc]) -> bool:
    """Whether these sizes move in every combination of choices: the search then keeps the limit."""
    free = any(child_at(view.tree, ("variables", spell(loc))) is not None for loc in moved)
    return free and any(_chosen(view, loc) for loc in (*moved, ("retention", "type")))
