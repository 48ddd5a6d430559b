"""Faults of the seals: what a type needs, room for the grooves, squeeze, films.

Those of stated contact profiles are in `profile_faults`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ..errors import Fault, InputError
from ..models.elastomer import modulus_gent
from ..suggest import article
from . import profile_faults
from .profile_faults import elements
from .seals import BACK_UPS
from .structure import Loc, child_at
from .view import Materials, Properties, View, length_text

SQUEEZE_RANGE = {
    "energised": (0.02, 0.40),
    "plane_strain": (0.02, 0.40),
    "hertz_lindley": (0.02, 0.40),
    "chord": (0.0, 0.45),
    "stadium": (0.0, 0.45),
}
"""Squeeze a contact law can be used at: outside, its width leaves the free section or the load
law (compared with finite elements at 0.08 to 0.30) means nothing."""

NEEDED = {
    "o_ring": (),
    "step_ring": ("thickness", "width"),
    "u_cup": ("thickness", "width", "groove_width"),
    "compact": ("width",),
}
"""Fields an element of a type cannot do without."""

EXAMPLES = {"thickness": "1.5 mm", "width": "4 mm", "groove_width": "6.3 mm"}

STRANGE = {
    "o_ring": ("thickness", "width", "land", "relief", "taper", "root_clearance"),
    "step_ring": ("root_clearance",),
    "u_cup": ("relief", "taper"),
    "compact": ("thickness", "relief", "taper", "root_clearance"),
}
"""Fields an element of a type has not."""


def fields(view: View) -> Iterator[Fault]:
    """Every type states what it is made of, and nothing else; a piston has no wiper."""
    for loc in elements(view):
        kind = view.text(*loc, "type") or ""
        for field in NEEDED.get(kind, ()):
            if not view.has(*loc, field):
                yield Fault(
                    (*loc, field),
                    f"missing: {article(kind)} needs it",
                    f'add e.g. "{field}: {EXAMPLES[field]}"',
                )
        for field in STRANGE.get(kind, ()):
            if view.has(*loc, field):
                yield Fault(
                    (*loc, field),
                    f"{article(kind)} has none",
                    "remove the line, or write another type",
                    at_key=True,
                )
        yield from _back_ups(view, loc)
    if view.has("seals", "piston", "wiper"):
        yield Fault(
            ("seals", "piston", "wiper"),
            "a piston has no wiper: there is no dirt inside",
            "remove the block",
            at_key=True,
        )


def _back_ups(view: View, loc: Loc) -> Iterator[Fault]:
    """Back-up rings state material and thickness; without them nothing does."""
    stated = view.text(*loc, "back_up") != "none"
    for field, example in (("back_up_material", "back_up_ptfe"), ("back_up_thickness", "1.4 mm")):
        if stated and not view.has(*loc, field):
            yield Fault(
                (*loc, field), "missing: a back-up ring needs it", f'add e.g. "{field}: {example}"'
            )
        elif not stated and view.has(*loc, field):
            yield Fault(
                (*loc, field),
                "there is no back-up ring",
                'write "back_up: one", or remove the line',
                at_key=True,
            )


def widths(view: View) -> Iterator[Fault]:
    """What lies in a groove fits its width; a land is no wider than its ring."""
    for loc in elements(view):
        groove = view.number(*loc, "groove_width")
        field = "section" if view.text(*loc, "type") == "o_ring" else "width"
        ring, land = view.number(*loc, field), view.number(*loc, "land")
        if groove is not None and ring is not None and groove < ring:
            yield Fault(
                (*loc, field),
                f"{length_text(ring)}: larger than the groove ({length_text(groove)})",
                "widen groove_width, or use a smaller ring",
            )
        if field == "width" and land is not None and ring is not None and land > ring:
            yield Fault(
                (*loc, "land"),
                f"{length_text(land)}: wider than the ring ({length_text(ring)})",
                f"write at most {length_text(ring)}",
            )
    for name in ("piston", "rod"):
        loc = ("seals", name, "wiper")
        groove, lip = view.number(*loc, "groove_width"), view.number(*loc, "width")
        if groove is not None and lip is not None and lip > groove:
            yield Fault(
                (*loc, "width"),
                f"{length_text(lip)}: longer than its groove ({length_text(groove)})",
                "widen groove_width, or shorten the lip",
            )


def _grooves(view: View, seal: str) -> Iterator[tuple[Loc, float, float]]:
    """Place to blame, depth at nominal squeeze and least width of every groove of a seal."""
    for loc in elements(view):
        if loc[1] != seal:
            continue
        section, squeeze = view.number(*loc, "section"), view.number(*loc, "squeeze")
        count = view.number(*loc, "count")
        if section is None or squeeze is None or count is None or count == 0:
            continue
        depth, ring = section * (1 - squeeze), section
        if view.text(*loc, "type") != "o_ring":
            ring = view.number(*loc, "width") or 0.0
        if view.text(*loc, "type") == "step_ring":
            depth += view.number(*loc, "thickness") or 0.0
        stated = view.number(*loc, "groove_width")
        field = "section" if stated is None else "groove_width"
        backs = BACK_UPS.get(view.text(*loc, "back_up") or "", 0)
        ring += backs * (view.number(*loc, "back_up_thickness") or 0.0)
        yield (*loc, field), depth, count * (ring if stated is None else stated)
    at = ("seals", seal, "wiper")
    section, squeeze = view.number(*at, "section"), view.number(*at, "squeeze")
    width = view.number(*at, "groove_width")
    if section is not None and squeeze is not None and width is not None:
        yield (*at, "groove_width"), section * (1 - squeeze), width
    at = ("seals", seal, "guide")
    thickness, width = view.number(*at, "thickness"), view.number(*at, "width")
    count = view.number(*at, "count")
    if thickness is not None and width is not None and count is not None:
        yield (*at, "width"), thickness, count * width


def grooves(view: View) -> Iterator[Fault]:
    """The seal grooves lie inside piston and head and leave a core and a wall."""
    bore, rod_diameter = view.number("cylinder", "bore"), view.number("rod", "outer_diameter")
    for seal, part in (("piston", "piston"), ("rod", "head")):
        found = list(_grooves(view, seal))
        if not found:
            continue
        width = sum(one for _, _, one in found)
        place, depth, _ = max(found, key=lambda groove: groove[1])
        length = view.number(part, "length")
        if length is not None and width >= length:
            yield Fault(
                found[0][0],
                f"grooves outside the {part}: they take at least {length_text(width)} of "
                f"{part}.length {length_text(length)}",
                f"lengthen {part}.length or use smaller rings",
            )
        deep = (*place[:-1], "thickness" if place[-2] == "guide" else "section")
        if bore is None or rod_diameter is None:
            continue
        if part == "piston":
            core = view.number("rod", "thread", "diameter") or rod_diameter
            left = bore - 2 * depth
            if core < bore and left <= core:
                yield Fault(
                    deep,
                    f"groove too deep: {length_text(max(left, 0.0))} core left in the piston, "
                    f"the rod needs {length_text(core)}",
                    "use a smaller section, a larger bore or a rod thread that fits",
                )
        elif rod_diameter < bore <= rod_diameter + 2 * depth:
            yield Fault(
                deep,
                f"groove outside the head: it reaches {length_text(rod_diameter + 2 * depth)}, "
                f"the bore is {length_text(bore)}",
                "use a smaller section, a larger bore or a thinner rod",
            )


def clearances(view: View) -> Iterator[Fault]:
    """The gap behind a ring is less deep than its groove: else nothing holds the ring."""
    for seal, part in (("piston", "piston"), ("rod", "head")):
        gap = view.number(part, "clearance")
        found = [(depth, loc) for loc, depth, _ in _grooves(view, seal)]
        if gap is None or not found:
            continue
        depth, loc = min(found)
        if gap >= depth:
            ring = ".".join(str(key) for key in loc[:-1])
            yield Fault(
                (part, "clearance"),
                f"{length_text(gap)}: no groove is left, that of {ring} is {length_text(depth)} "
                "deep from the other part",
                f"write less than {length_text(depth)}, e.g. 0.03 mm",
            )


def squeeze(view: View) -> Iterator[Fault]:
    """The nominal squeeze of an O-ring lies where its law holds; that of the others is not none."""
    for loc in elements(view):
        value, law = view.number(*loc, "squeeze"), view.text(*loc, "law")
        if value is None:
            continue
        if view.text(*loc, "type") not in ("o_ring", "step_ring"):
            if value == 0:
                yield Fault((*loc, "squeeze"), "0: the seal does not touch", "write e.g. 8 %")
            continue
        low, high = SQUEEZE_RANGE.get(law or "", (0.0, 1.0))
        if not low <= value <= high:
            yield Fault(
                (*loc, "squeeze"),
                f"{value * 100:.4g} %: outside the range of the law {law}",
                f"write {low * 100:g} % to {high * 100:g} %",
            )


def shapes(view: View) -> Iterator[Fault]:
    """What a ring is made of fits inside it."""
    for loc in elements(view):
        kind = view.text(*loc, "type")
        width, section = view.number(*loc, "width"), view.number(*loc, "section")
        if width is None or section is None:
            continue
        if kind == "step_ring":
            if section > width * (1 + ROOM):
                yield Fault(
                    (*loc, "section"),
                    f"{length_text(section)}: the O-ring behind is wider than the ring "
                    f"({length_text(width)})",
                    "widen the ring, or use a smaller O-ring",
                )
            land, relief = view.number(*loc, "land"), view.number(*loc, "relief")
            if land is None or relief is None:
                continue
            if land <= width < (land + relief) * (1 - 1e-9):
                yield Fault(
                    (*loc, "relief"),
                    f"{length_text(relief)}: with the land it is wider than the ring "
                    f"({length_text(width)})",
                    f"write at most {length_text(width - land)}",
                )
        thickness = view.number(*loc, "thickness")
        if kind == "u_cup" and thickness is not None:
            yield from _lip(loc, thickness, width)
        if kind == "u_cup" and thickness is not None and 2 * thickness >= section:
            yield Fault(
                (*loc, "thickness"),
                f"{length_text(thickness)}: two lips fill the section ({length_text(section)})",
                f"write less than {length_text(section / 2)}",
            )

    for name in ("piston", "rod"):
        loc = ("seals", name, "wiper")
        thickness, width = view.number(*loc, "thickness"), view.number(*loc, "width")
        section = view.number(*loc, "section")
        if thickness is None or width is None:
            continue
        yield from _lip(loc, thickness, width)
        if section is not None and thickness >= section:
            yield Fault(
                (*loc, "thickness"),
                f"{length_text(thickness)}: the lip fills the section ({length_text(section)})",
                f"write less than {length_text(section)}",
            )


def _lip(loc: Loc, thickness: float, width: float) -> Iterator[Fault]:
    """A lip is longer than thick: else it is no beam, and no model of ours."""
    if width < thickness:
        yield Fault(
            (*loc, "width"),
            f"{length_text(width)}: the lip is shorter than thick ({length_text(thickness)})",
            f"write {length_text(thickness)} or more",
        )


ROOM = 0.1
"""Share by which a step ring's O-ring may be wider than the ring: its groove is that much wider."""


def films(view: View) -> Iterator[Fault]:
    """A film is asked of both elements of a pair or of none, and of single rings."""
    for name in ("piston", "rod"):
        both: list[Loc] = [("seals", name)]
        if view.has("seals", name, "secondary"):
            both.append(("seals", name, "secondary"))
        models = [view.text(*loc, "friction") for loc in both]
        if len(set(models)) > 1:
            yield Fault(
                (*both[1], "friction"),
                f"{models[1]}, while seals.{name}.friction is {models[0]}",
                "write the same for both: they share the oil",
            )
        for loc in both:
            count = view.number(*loc, "count")
            if view.text(*loc, "friction") == "film" and count is not None and count != 1:
                yield Fault(
                    (*loc, "count"),
                    f"{count:g} rings in a row: a film is known of one ring or of a pair",
                    "write count: 1, and a block secondary for the second ring",
                )


CHECKS = (fields, widths, grooves, clearances, squeeze, shapes, *profile_faults.CHECKS, films)


def _numbers(block: object) -> dict[str, float]:
    """Properties that the design states of a material, SI."""
    pairs = block.items() if isinstance(block, Mapping) else ()
    return {str(key): value for key, value in pairs if isinstance(value, float)}


SLIDING_RING = 3.0
"""Stated modulus over that of the hardness from which a compound has a sliding ring of plastic on
rubber; a hard polyurethane lies near 1."""


def sliding_rings(tree: Any, materials: Materials) -> Iterator[Fault]:
    """A step ring's compound has a sliding ring, those of the other types have none."""
    view = View(tree)
    if not isinstance(materials, Properties):
        return
    for loc in elements(view):
        name, kind = view.text(*loc, "compound"), view.text(*loc, "type")
        if name is None or kind is None or materials.kind(name) != "seal":
            continue
        try:
            own = child_at(tree, ("materials", name))
            known = {**materials.numbers(name), **_numbers(own)}
        except InputError:  # a faulty entry is told elsewhere
            continue
        modulus, hardness = known.get("youngs_modulus", 0.0), known.get("hardness", 0.0)
        sliding = modulus > SLIDING_RING * float(modulus_gent(hardness=hardness))
        if sliding != (kind == "step_ring"):
            has = "is a plastic ring on rubber" if sliding else "has no sliding ring"
            other = "write type: step_ring" if sliding else "use e.g. ptfe_bronze_nbr_70"
            yield Fault((*loc, "compound"), f"{name} {has}, not for {article(kind)}", other)
