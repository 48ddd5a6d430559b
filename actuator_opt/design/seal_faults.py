"""Check the seals: sizes of each type, space for grooves, squeeze, oil films, stated profiles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any

from ..base.errors import Fault, InputError, article
from ..base.quantities import INPUTS, length_text
from ..friction.kinds import LAWS as FRICTION_LAWS
from ..joints.joint import StaticPlace
from ..joints.kinds import JOINTS
from ..models import gland
from ..models.elastomer import modulus_gent
from ..models.seals import LAWS
from ..seals.contact import GROOVE_WIDTH
from ..seals.kinds import SIZES, TYPES
from ..seals.seal_type import SealType, SizeFault
from ..seals.u_cup import lip_faults
from .double_rod import thickest_rod
from .model import PLAIN_CAP
from .seals import BACK_UPS
from .structure import FileView, Loc, MaterialLookup, Properties, child_at


def elements(view: FileView) -> Iterator[Loc]:
    """Yield the location of every sealing element that the file states."""
    for name in ("piston", "rod"):
        yield ("seals", name)
        if view.has("seals", name, "secondary"):
            yield ("seals", name, "secondary")


def fields(view: FileView) -> Iterator[Fault]:
    """Check that a seal states all sizes of its type and no others, and a piston has no wiper."""
    for loc in elements(view):
        kind = _kind(view, loc)
        if kind is not None:
            yield from _sizes(view, loc, kind)
        yield from _back_ups(view, loc)
    if view.has("seals", "piston", "wiper"):
        yield Fault(
            ("seals", "piston", "wiper"),
            "a piston needs no wiper, because it is not exposed to dirt",
            "remove the block",
            at_key=True,
        )


def _kind(view: FileView, loc: Loc) -> SealType | None:
    """Seal type of an element; None if unknown."""
    return TYPES.get(view.text(*loc, "type") or "")


def _sizes(view: FileView, loc: Loc, kind: SealType) -> Iterator[Fault]:
    """Yield missing and superfluous sizes of a seal type; every type accepts a groove width."""
    for size in SIZES:
        if size.key in kind.needed and not view.has(*loc, size.key):
            yield Fault(
                (*loc, size.key),
                f"missing: required by {article(kind.name)}",
                f'add e.g. "{size.key}: {size.example}"',
            )
    for size in SIZES:
        if size.key not in (*kind.keys, GROOVE_WIDTH.key) and view.has(*loc, size.key):
            yield Fault(
                (*loc, size.key),
                f"not a size of {article(kind.name)}",
                "remove the line, or write another type",
                at_key=True,
            )


def _back_ups(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that material and thickness are stated for back-up rings, and only if there are any."""
    stated = view.text(*loc, "back_up") != "none"
    for field, example in (("back_up_material", "back_up_ptfe"), ("back_up_thickness", "1.4 mm")):
        if stated and not view.has(*loc, field):
            yield Fault(
                (*loc, field),
                "missing: required by a back-up ring",
                f'add e.g. "{field}: {example}"',
            )
        elif not stated and view.has(*loc, field):
            yield Fault(
                (*loc, field),
                "there is no back-up ring",
                'write "back_up: one", or remove the line',
                at_key=True,
            )


def widths(view: FileView) -> Iterator[Fault]:
    """Check that rings fit into the width of their groove, and no land is wider than its ring."""
    for loc in elements(view):
        kind = _kind(view, loc)
        if kind is None:
            continue
        groove, field = view.number(*loc, "groove_width"), kind.width_key
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


def _grooves(view: FileView, seal: str) -> Iterator[tuple[Loc, float, float]]:
    """Yield location, depth at nominal squeeze and least width of every groove of a seal."""
    for loc in elements(view):
        if loc[1] != seal:
            continue
        section, squeeze = view.number(*loc, "section"), view.number(*loc, "squeeze")
        count, kind = view.number(*loc, "count"), _kind(view, loc)
        if section is None or squeeze is None or count is None or count == 0 or kind is None:
            continue
        sizes = {key: view.number(*loc, key) or 0.0 for key in kind.needed}
        groove = kind.groove({"section": section, "squeeze": squeeze} | sizes)
        ring = groove.ring_width
        stated = view.number(*loc, "groove_width")
        field = "section" if stated is None else "groove_width"
        back_up_count = BACK_UPS.get(view.text(*loc, "back_up") or "", 0)
        ring += back_up_count * (view.number(*loc, "back_up_thickness") or 0.0)
        yield (*loc, field), groove.depth, count * (ring if stated is None else stated)
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


def grooves(view: FileView) -> Iterator[Fault]:
    """Check that seal grooves fit inside piston and head, and leave a core or wall of metal."""
    bore, rod_diameter = view.number("cylinder", "bore"), thickest_rod(view)
    for seal, part in (("piston", "piston"), ("rod", "head")):
        seal_grooves = list(_grooves(view, seal))
        if not seal_grooves:
            continue
        width = sum(groove_width for _, _, groove_width in seal_grooves)
        place, depth, _ = max(seal_grooves, key=lambda groove: groove[1])
        length = view.number(part, "length")
        if length is not None and width >= length:
            yield Fault(
                seal_grooves[0][0],
                f"the grooves do not fit into the {part}: they need at least {length_text(width)}, "
                f"but {part}.length is {length_text(length)}",
                f"increase {part}.length or use smaller rings",
            )
        deep = (*place[:-1], "thickness" if place[-2] == "guide" else "section")
        if bore is None or rod_diameter is None:
            continue
        if part == "piston":
            core = view.number("rod", "thread", "diameter") or rod_diameter
            rest = bore - 2 * depth
            if core < bore and rest <= core:
                yield Fault(
                    deep,
                    "groove too deep: it leaves a core with a diameter of "
                    f"{length_text(max(rest, 0.0))} in the piston, but the hole for the rod has "
                    f"{length_text(core)}",
                    "use a smaller section, a larger bore or a rod thread that fits",
                )
        elif rod_diameter < bore <= rod_diameter + 2 * depth:
            yield Fault(
                deep,
                "the groove does not fit into the head: its diameter is "
                f"{length_text(rod_diameter + 2 * depth)}, but the bore is {length_text(bore)}",
                "use a smaller section, a larger bore or a thinner rod",
            )


def clearances(view: FileView) -> Iterator[Fault]:
    """Check that no ring can slip out through its gap: the gap is less than the groove's depth."""
    for seal, part in (("piston", "piston"), ("rod", "head")):
        gap = view.number(part, "clearance")
        seal_grooves = [(depth, loc) for loc, depth, _ in _grooves(view, seal)]
        if gap is None or not seal_grooves:
            continue
        depth, loc = min(seal_grooves)
        if gap >= depth:
            ring = ".".join(str(key) for key in loc[:-1])
            yield Fault(
                (part, "clearance"),
                f"{length_text(gap)}: not smaller than the depth of the groove of {ring}, measured "
                f"from the mating surface ({length_text(depth)})",
                f"write less than {length_text(depth)}, e.g. 0.03 mm",
            )


def static_places(view: FileView) -> tuple[StaticPlace, StaticPlace]:
    """Places of the static seals of cap and head, from their joints."""
    places: list[StaticPlace] = []
    for end in ("cap", "head"):
        name = view.text("retention", end, "type") or view.text("retention", "type")
        places.append(JOINTS[name].static_seal if name is not None and name in JOINTS else "bore")
    return places[0], places[1]


def static_seal(view: FileView) -> Iterator[Fault]:
    """Check that the groove of the static seal fits into the head, and holds its ring."""
    loc = ("seals", "static")
    section, share = view.number(*loc, "section"), view.number(*loc, "squeeze")
    if not view.has(*loc) or section is None or share is None:
        return
    depth, width = section * (1 - share), float(gland.groove_width(section=section))
    gap = view.number(*loc, "clearance")
    if gap is not None and gap >= depth:
        yield Fault(
            (*loc, "clearance"),
            f"{length_text(gap)}: not smaller than the depth of the groove ({length_text(depth)})",
            f"write less than {length_text(depth)}, e.g. 0.02 mm",
        )
    places = static_places(view)
    types = ("retention.type", "retention.cap.type", "retention.head.type")
    if not any(places) and not any(view.has("choices", path) for path in types):
        yield Fault(
            loc,
            "without effect: cap and head are bonded, and the adhesive seals them",
            "remove the block, or use another joint (retention.type)",
            at_key=True,
        )
    yield from _in_plug(view, places, depth, width)
    if places[1] != "bore":
        return
    length = view.number("head" if view.has("head") else "piston", "length")
    if length is not None and width >= length and not view.has("variables", "head.length"):
        yield Fault(
            (*loc, "section"),
            f"its groove of {length_text(width)} does not fit into the head, which is "
            f"{length_text(length)} long",
            "increase head.length or use a smaller section",
        )
    bore, rod_diameter = view.number("cylinder", "bore"), thickest_rod(view)
    inner = max((groove[1] for groove in _grooves(view, "rod")), default=None)
    if bore is None or rod_diameter is None or inner is None:
        return
    rest = (bore - rod_diameter) / 2 - inner - depth
    free = ("cylinder.bore", "rod.outer_diameter", "second_rod.outer_diameter")
    if rest <= 0 and not any(view.has("variables", path) for path in free):
        yield Fault(
            (*loc, "section"),
            "its groove and that of the rod seal meet in the head",
            "use a smaller section, a larger bore or a thinner rod",
        )


def _in_plug(
    view: FileView, places: tuple[StaticPlace, StaticPlace], depth: float, width: float
) -> Iterator[Fault]:
    """Check that the groove of the static seal fits into the rim of the plugs.

    For variables, the bounds with the most metal count; the optimiser keeps a wall beside the
    groove (`geometry_plug`).
    """
    loc, bore = ("seals", "static", "section"), view.bound("upper", "cylinder", "bore")
    if "rim" not in places or bore is None:
        return
    plate = view.bound("upper", "caps", "thickness") if view.has("caps") else PLAIN_CAP * bore
    at_most = "at most " if view.has("variables", "caps.thickness") else ""
    if plate is not None and width >= plate:
        yield Fault(
            loc,
            f"its groove of {length_text(width)} does not fit into the plug, which is "
            f"{at_most}{length_text(plate)} thick",
            "increase caps.thickness or use a smaller section",
        )
        return
    rod_diameter, gap = (
        view.bound("lower", "rod", "outer_diameter"),
        view.number("head", "clearance"),
    )
    if rod_diameter is None or gap is None:
        return
    hole = rod_diameter / 2 + gap if places[1] == "rim" else 0.0
    if depth >= bore / 2 - hole > 0:
        yield Fault(
            loc,
            f"its groove of {length_text(depth)} is deeper than the plug, which has "
            f"{length_text(bore / 2 - hole)} of metal between bore and rod",
            "use a smaller section, a larger bore or a thinner rod",
        )


def squeeze(view: FileView) -> Iterator[Fault]:
    """Check the nominal squeeze.

    For O-rings, it must be within the valid range of their contact law; for other seals, above 0.
    """
    for loc in elements(view):
        value, kind = view.number(*loc, "squeeze"), _kind(view, loc)
        if value is None or kind is None:
            continue
        if not kind.round_ring:
            if value == 0:
                yield Fault(
                    (*loc, "squeeze"),
                    "0: the seal does not touch its counterface",
                    "write e.g. 8 %",
                )
            continue
        law = LAWS.get(view.text(*loc, "law") or "")
        if law is None:
            continue
        low, high = law.squeeze_limits
        if not low <= value <= high:
            yield Fault(
                (*loc, "squeeze"),
                f"{value * 100:.4g} %: outside the range of the contact law {law.name}",
                f"write {low * 100:g} % to {high * 100:g} %",
            )


def shapes(view: FileView) -> Iterator[Fault]:
    """Check that the dimensions of a ring's profile fit into its free cross-section."""
    for loc in elements(view):
        kind = _kind(view, loc)
        if kind is not None:
            keys = ("section", *kind.keys)
            sizes = {key: value for key in keys if (value := view.number(*loc, key)) is not None}
            yield from _at_loc(loc, kind.faults(sizes))

    for name in ("piston", "rod"):
        loc = ("seals", name, "wiper")
        thickness, width = view.number(*loc, "thickness"), view.number(*loc, "width")
        section = view.number(*loc, "section")
        if thickness is None or width is None:
            continue
        yield from _at_loc(loc, lip_faults(width, thickness))
        if section is not None and thickness >= section:
            yield Fault(
                (*loc, "thickness"),
                f"{length_text(thickness)}: not smaller than the section ({length_text(section)})",
                f"write less than {length_text(section)}",
            )


def _at_loc(loc: Loc, size_faults: Iterable[SizeFault]) -> Iterator[Fault]:
    """Give each fault of a size its location in the file."""
    for size_fault in size_faults:
        yield Fault((*loc, size_fault.key), size_fault.message, size_fault.remedy)


def profiles(view: FileView) -> Iterator[Fault]:
    """Check contact profiles: rising pressures; positions from 0 up, with a stress for each."""
    for loc in elements(view):
        last = -1.0
        for index, _ in enumerate(view.items(*loc, "contact")):
            at = (*loc, "contact", index)
            positions = view.items(*at, "positions")
            stresses = view.items(*at, "stresses")
            pressure = view.number(*at, "pressure")
            if pressure is not None and pressure <= last:
                yield Fault(
                    (*at, "pressure"),
                    f"{INPUTS['pressure'].text(pressure)}: not above that of the previous profile",
                    "sort the profiles by pressure, and state each pressure once",
                )
            last = last if pressure is None else pressure
            pressures = [x for x in stresses if isinstance(x, float)]
            complete = pressures and len(pressures) == len(stresses)
            if complete and pressure is not None and max(pressures) <= pressure:
                yield Fault(
                    (*at, "stresses"),
                    "the contact pressure nowhere exceeds the sealed pressure "
                    f"({INPUTS['pressure'].text(pressure)}), so this contact does not seal",
                    "state total contact pressures, including the effect of the sealed pressure",
                )
            if len(positions) != len(stresses):
                yield Fault(
                    (*at, "stresses"),
                    f"{len(stresses)} stresses at {len(positions)} positions",
                    "give as many stresses as positions",
                )
            numbers = [x for x in positions if isinstance(x, float)]
            pairs = pairwise(numbers)
            if numbers and (numbers[0] != 0 or any(b <= a for a, b in pairs)):
                yield Fault(
                    (*at, "positions"),
                    "must increase from 0",
                    "begin with 0 mm at the sealed side, then increase",
                )


def reach(view: FileView) -> Iterator[Fault]:
    """Check that stated contact profiles range from zero pressure to the supply pressure."""
    supply, text = view.number("supply", "pressure"), INPUTS["pressure"].text
    for loc in elements(view):
        count = len(view.items(*loc, "contact"))
        first = view.number(*loc, "contact", 0, "pressure")
        last = view.number(*loc, "contact", count - 1, "pressure")
        if first is not None and first > 0:
            yield Fault(
                (*loc, "contact", 0, "pressure"),
                f"{text(first)}: the profile at zero pressure is missing",
                "add a profile at 0 bar before it",
            )
        if last is not None and supply is not None and last < supply * (1 - 1e-9):
            yield Fault(
                (*loc, "contact", count - 1, "pressure"),
                f"{text(last)}: the profiles end below supply.pressure ({text(supply)})",
                "add a profile at the supply pressure",
            )


def films(view: FileView) -> Iterator[Fault]:
    """Check that tandem seals have the same friction law, and at most two rings share a film."""
    for name in ("piston", "rod"):
        both: list[Loc] = [("seals", name)]
        if view.has("seals", name, "secondary"):
            both.append(("seals", name, "secondary"))
        models = [view.text(*loc, "friction") for loc in both]
        if len(set(models)) > 1:
            yield Fault(
                (*both[1], "friction"),
                f"friction is {models[1]} here, while seals.{name}.friction is {models[0]}",
                "write the same law for both, because the same oil passes both seals",
            )
        for loc in both:
            count = view.number(*loc, "count")
            law = FRICTION_LAWS.get(view.text(*loc, "friction") or "")
            if law is not None and law.film and count is not None and count != 1:
                yield Fault(
                    (*loc, "count"),
                    f"{count:g} rings in a row, but the film model covers one ring or a pair",
                    'write "count: 1", and add a block "secondary:" for the second ring',
                )


CHECKS = (
    fields,
    widths,
    grooves,
    clearances,
    static_seal,
    squeeze,
    shapes,
    profiles,
    reach,
    films,
)


def _numbers(block: object) -> dict[str, float]:
    """Properties that the design states for a material, SI."""
    pairs = block.items() if isinstance(block, Mapping) else ()
    return {str(key): value for key, value in pairs if isinstance(value, float)}


SLIDING_RING = 3.0
"""Ratio of a compound's stated modulus to the modulus that follows from its hardness. Above this
ratio, the compound is taken for a plastic sliding ring on rubber. For a hard polyurethane the ratio
is about 1."""


def sliding_rings(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Check that step rings, and only they, use a compound with a sliding ring."""
    view = FileView(tree)
    if not isinstance(materials, Properties):
        return
    for loc in elements(view):
        name, kind = view.text(*loc, "compound"), _kind(view, loc)
        if name is None or kind is None or materials.kind(name) != "seal":
            continue
        try:
            changes = child_at(tree, ("materials", name))
            properties = {**materials.numbers(name), **_numbers(changes)}
        except InputError:  # a faulty entry is reported elsewhere
            continue
        modulus, hardness = properties.get("youngs_modulus", 0.0), properties.get("hardness", 0.0)
        sliding = modulus > SLIDING_RING * float(modulus_gent(hardness=hardness))
        if sliding != (kind.modulus_by == "hardness"):
            statement = (
                "is a plastic sliding ring on rubber" if sliding else "has no plastic sliding ring"
            )
            fits = " or ".join(x.name for x in TYPES.values() if x.modulus_by == "hardness")
            other = f"write type: {fits}" if sliding else "use e.g. ptfe_bronze_nbr_70"
            yield Fault(
                (*loc, "compound"),
                f"{name} {statement}: it does not suit {article(kind.name)}",
                other,
            )
