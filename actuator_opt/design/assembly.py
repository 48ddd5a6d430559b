"""Order of assembly: how piston, rod and seals enter the barrel, and what prevents it.

Piston and rod go in together, through the head's end with the head, or through the cap's end if the
head is made with the barrel. The joint of each end states how it opens (`BarrelOpening`).
"""

from __future__ import annotations

from collections.abc import Iterator

from ..base.errors import Fault
from ..base.quantities import length_text
from ..joints.joint import ROUNDING, BarrelOpening, ring_height, stated_rings
from .double_rod import has_second_rod
from .model import Design
from .structure import FileView, Loc
from .wall_faults import ends

_EYE = 2.0
"""Outer diameter of an eye, in pin diameters; see `models.mass.eye_volume`."""


def _openings(view: FileView) -> dict[str, tuple[Loc, BarrelOpening]]:
    """Location of the joint's block and opening, by cap and head; empty if a joint is unknown."""
    views = ends(view)
    stated = [(end.at, end.joint.opening(end)) for end in views if end.joint is not None]
    if not stated or len(stated) < len(views):
        return {}
    return {"cap": stated[0], "head": stated[-1]}


def _wound(view: FileView) -> bool:
    """Whether the barrel is wound over the plugs of both ends."""
    joints = [end.joint for end in ends(view)]
    return bool(joints) and all(joint is not None and joint.form == "wound" for joint in joints)


def faults(view: FileView) -> Iterator[Fault]:
    """Check that an end can be opened, and that the piston passes every end that can.

    Ends that are both wound in are left to `warnings`: piston and rod can be inside beforehand.
    """
    openings = _openings(view)
    shut = openings and all(opening.opens == "never" for _, opening in openings.values())
    if shut and not _wound(view):
        yield Fault(
            (*openings["head"][0], "type"),
            "neither end of the barrel can be opened, so the piston cannot be inserted",
            "hold cap or head by another joint, such as thread or retaining_ring",
        )
    bore = view.number("cylinder", "bore")
    if bore is None or view.has("variables", "cylinder.bore"):
        return
    for end in ends(view):
        if end.joint is None or list(end.joint.faults(end)):  # a more exact fault
            continue
        opening = end.joint.opening(end)
        if opening.diameter is None or opening.opens == "never":
            continue
        if opening.diameter < bore * (1 - ROUNDING):
            yield Fault(
                (*end.at, "type"),
                f"the opening of {length_text(opening.diameter)} is narrower than the piston "
                f"({length_text(bore)}), which is inserted through it",
                "widen it, or use another joint",
            )


def warnings(design: Design) -> Iterator[str]:
    """Sentences on parts that may not pass at assembly."""
    view = FileView(design.model_dump())
    yield from _eye(view)
    if _wound(view):
        yield (
            "assembly: both ends are wound into the barrel, so piston, rod and seals must be "
            "inside during winding and cure: hold one end by another joint"
        )
    bore, rings = view.number("cylinder", "bore"), stated_rings(ends(view)[0])
    done = set[BarrelOpening]()
    if bore is None or not rings:
        return
    height, section = ring_height(rings), min(ring.section for ring in rings)
    for name, (_, opening) in _openings(view).items():
        if opening.crossed is None or opening in done or opening.opens == "never":
            continue
        done.add(opening)
        what, width = opening.crossed
        free = bore + 2 * height
        if opening.diameter is not None and opening.diameter < free * (1 - ROUNDING):
            yield (
                f"assembly: rings of {length_text(free)} diameter scrape through the {what} at the "
                f"{name}, {length_text(opening.diameter)}: widen it, or cover it at assembly"
            )
        elif opening.diameter is None and width >= section:
            yield (
                f"assembly: rings of {length_text(section)} section fall into the {what} at the "
                f"{name}, {length_text(width)} wide: fill it at assembly"
            )


def _rod_end(view: FileView) -> tuple[float, float] | None:
    """Diameters of an eye made with the rod, and of the rod, if the eye is the larger one."""
    pin, rod = view.number("clevis", "pin_diameter"), view.number("rod", "outer_diameter")
    if not view.has("clevis") or view.has("rod", "thread") or pin is None or rod is None:
        return None
    return (_EYE * pin, rod) if _EYE * pin > rod else None


def _eye(view: FileView) -> Iterator[str]:
    """Warn of a rod on which neither the head nor the piston can be set from the other end."""
    if (sizes := _rod_end(view)) is not None and not view.has("piston", "nut"):
        eye, rod = (length_text(size) for size in sizes)
        yield (
            f"assembly: the rod's eye, {eye}, does not pass the head, whose hole is for a rod of "
            f"{rod}: state rod.thread (an eye screwed on) or piston.nut (a piston set on last)"
        )


def order(design: Design) -> list[str]:
    """Sentences on the order of assembly; none if no joint is stated."""
    view = FileView(design.model_dump())
    openings = _openings(view)
    if not openings or all(opening.opens == "never" for _, opening in openings.values()):
        return []
    head_fixed = openings["head"][1].opens == "never"
    last, first = ("cap", "head") if head_fixed else ("head", "cap")
    through, other = openings[last][1], openings[first][1]
    lines = [*_rod_and_piston(view, head_fixed=head_fixed)]
    double = has_second_rod(view)
    clamped = any(end.joint is not None and end.joint.clamping is not None for end in ends(view))
    if clamped:
        lines += ["Insert them into the barrel.", through.closing.format(end="cap and the head")]
    else:
        if other.opens == "never":
            lines.append(f"The {first} is made with the barrel.")
        else:
            lines.append(other.closing.format(end=first))
        rods = "rods" if double else "rod"
        what = f"piston and {rods}" if head_fixed else f"piston, {rods} and head"
        bore = view.number("cylinder", "bore") or 0.0
        width = length_text(bore if through.diameter is None else through.diameter)
        lines.append(f"Insert {what} through the opening of {width} at the {last}.")
        if through.crossed is not None:
            lines.append(f"Its {through.crossed[0]}, which the seals pass, needs a chamfer.")
        if double:
            rod = "rod" if head_fixed else "second rod"
            lines.append(f"The {rod} passes the gland of the {first}: guard its seals.")
        lines.append(through.closing.format(end=last))
    if view.has("clevis") and view.has("rod", "thread"):
        lines.append("Screw the eye onto the rod.")
    if through.opens == "once" and other.opens != "again":
        lines.append("After this, the seals inside cannot be replaced.")
    return lines


def _rod_and_piston(view: FileView, *, head_fixed: bool) -> Iterator[str]:
    """Head, rod and piston before they enter the barrel."""
    large = _rod_end(view) is not None
    nut = " and tighten its nut" if view.has("piston", "nut") else ""
    if head_fixed and large:
        yield f"Push the rod through the head from outside; set the piston on it{nut}."
    elif head_fixed:
        yield f"Set the piston on the rod{nut}."
    elif large:
        yield f"Set the head on the rod, from its inner end, then the piston{nut}."
    else:
        yield f"Set the piston on the rod{nut}, then the head over the rod's outer end."
