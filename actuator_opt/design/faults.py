"""Check a design for values that contradict each other; report each fault at one of these values.

Every check is a small function of a `FileView`. It yields nothing if a value that it requires is
missing or faulty, so the checks also work on a file with other faults. Checks of barrel and rod are
in `wall_faults`, those of seals in `seal_faults`, and those of each joint between caps and barrel
in the joint's module.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple, TypeVar, get_args

from ..base import errors, quantities
from ..base.errors import Fault, article
from ..base.quantities import length_text
from ..base.words import by_nearness
from ..joints.joint import LEAST_METAL, ROUNDING, Joint
from ..models import linkage as crank, mass
from ..models.piston_nut import HEIGHT
from ..models.spherical_bearing import lug_radius
from . import (
    assembly,
    choices,
    double_rod,
    duty_faults,
    material,
    seal_faults,
    valve_faults,
    wall_faults,
)
from .kinds import MaterialName
from .lengths import closed_length, spigot_length
from .material import ROLES
from .model import PLAIN_CAP
from .standard_sizes import port, spherical_bearing
from .structure import FileView, Loc, MaterialLookup, child, leaves

Row = TypeVar("Row")

_ROUND = math.radians(0.01)
"""Suggested joint angles are rounded to this step (rad), into the allowed range."""


class _Reach(NamedTuple):
    """Pin-to-pin length of the retracted actuator, stroke, and dimensions of the linkage."""

    closed: float
    stroke: float
    base: float
    crank: float
    offset: float


def _eye_length(view: FileView) -> float | None:
    """Length of an eye from its pin to its end, 0 without eyes; None if unknown."""
    if not view.has("clevis"):
        return 0.0
    bearing = _row(view, ("clevis", "bearing"), spherical_bearing)
    if bearing is not None:
        sizes = {"outer_diameter": bearing.outer_diameter, "width": bearing.width}
        return float(lug_radius(pin_diameter=bearing.bore, **sizes)) + bearing.bore
    pin = view.number("clevis", "pin_diameter")
    return None if pin is None else float(mass.eye_length(pin_diameter=pin))


def _row(view: FileView, loc: Loc, row: Callable[[str], Row]) -> Row | None:
    """The row of a table of sizes that the file names; None if it names none."""
    name = view.text(*loc)
    if name is None:
        return None
    try:
        return row(name)
    except StopIteration:  # an unknown name is a separate fault
        return None


def _closed(view: FileView) -> float | None:
    """Pin-to-pin length of the retracted actuator; None if a length that it needs is unknown."""
    if view.has("ideal"):
        return view.number("ideal", "closed_length")
    stroke, piston = view.number("cylinder", "stroke"), view.number("piston", "length")
    head = view.number("head", "length") if view.has("head") else piston
    barrel = view.number("barrel", "length")
    if not view.has("barrel", "length"):
        complete = stroke is not None and piston is not None and head is not None
        barrel = (stroke or 0.0) + (piston or 0.0) + (head or 0.0) if complete else None
    bore = view.number("cylinder", "bore")
    plain = None if bore is None else PLAIN_CAP * bore
    plate = view.number("caps", "thickness") if view.has("caps") else plain
    extension = view.number("rod", "extension")
    eye = _eye_length(view)
    further = view.number("cushion", "length") if view.has("cushion") else 0.0
    if barrel is None or plate is None or extension is None or eye is None or further is None:
        return None
    if view.text("cushion", "ends") == "both":
        further = 2 * further
    further += view.number("clevis", "neck") or 0.0
    for index in range(len(view.items("extra_masses"))):
        count = view.number("extra_masses", index, "count")
        length = view.number("extra_masses", index, "length")
        further += (count or 0.0) * (length or 0.0)
    spigot = _spigot(view)
    return float(
        closed_length(
            barrel_length=barrel,
            plate=plate,
            spigot=spigot,
            further=further,
            extension=extension,
            eyes=2 * eye,
        )
    )


def _spigot(view: FileView) -> float:
    """Length of the cap's spigot and inner skirt, which lengthen the barrel; 0 without them."""
    if double_rod.has_second_rod(view):  # its gland; a stated length of the barrel includes it
        return 0.0 if view.has("barrel", "length") else view.number("head", "length") or 0.0
    section, spigot = view.number("seals", "static", "section"), 0.0
    if section is not None:
        place, _ = seal_faults.static_places(view)
        spigot = float(spigot_length(place=place, section=section))
    cap = wall_faults.ends(view)[0]
    if cap.joint is not None and cap.joint.inner_skirt:
        spigot += cap.number("retention", "length") or 0.0
    return spigot


def _reach(view: FileView) -> _Reach | None:
    if not view.has("linkage"):
        return None
    values = (
        _closed(view),
        view.number("cylinder", "stroke"),
        view.number("linkage", "base_radius"),
        view.number("linkage", "crank_radius"),
        view.number("linkage", "angle_offset"),
    )
    numbers = [value for value in values if value is not None]
    return _Reach(*numbers) if len(numbers) == len(values) else None


def linkage(view: FileView) -> Iterator[Fault]:
    """Check that the linkage reaches no dead point between the stops.

    At both stops, |a - r| < l < a + r must hold, where l is the pin-to-pin length and a and r are
    the distances of the two pivots from the joint axis.
    """
    reach = _reach(view)
    if reach is None:
        return
    closed, stroke, base, radius, _ = reach
    if stroke >= 2 * radius:
        yield Fault(
            ("linkage", "crank_radius"),
            f"{length_text(radius)}: a stroke of {length_text(stroke)} moves the joint past a dead "
            "point",
            f"write more than {length_text(stroke / 2)}, or a shorter cylinder.stroke",
        )
        return
    least, most = max(closed + stroke - radius, radius - closed), closed + radius
    if not least < base < most:
        yield Fault(
            ("linkage", "base_radius"),
            f"{length_text(base)}: the actuator, {length_text(closed)} to "
            f"{length_text(closed + stroke)} from pin to pin, moves the joint past a dead point",
            f"write more than {length_text(least)} and less than {length_text(most)}",
        )


def inertia(view: FileView) -> Iterator[Fault]:
    """Require a linkage if the load states a moment of inertia."""
    if view.number("load", "inertia") and not view.has("linkage"):
        yield _no_linkage(("load", "inertia"), "load.mass")


def _no_linkage(loc: Loc, instead: str) -> Fault:
    remedy = f'add a block "linkage:" with base_radius, crank_radius, or write {instead} instead'
    return Fault(loc, "no linkage stated", remedy, at_key=True)


def linkage_load_cases(view: FileView) -> Iterator[Fault]:
    """Check the joint angle and joint speed of every load case.

    Both require a linkage. The angle must lie within the joint's range, and a load case that states
    it must not state a piston position. A load case with a joint speed must not state a piston
    speed.
    """
    for index, case in enumerate(view.items("load_cases")):
        if not isinstance(case, dict):
            continue
        loc = ("load_cases", index)
        for key, instead, unset in (("angle", "position", "worst"), ("joint_speed", "speed", 0.0)):
            if key in case and not view.has("linkage"):
                yield _no_linkage((*loc, key), instead)
            elif key in case and case.get(instead, unset) != unset:
                message = f"both {instead} and {key} in one load case"
                yield Fault((*loc, key), message, "keep one of them", at_key=True)
        yield from _angle(view, loc)


def _angle(view: FileView, loc: Loc) -> Iterator[Fault]:
    """Check that the joint angle of a load case lies between the angles at both stops."""
    angle, reach = view.number(*loc, "angle"), _reach(view)
    if angle is None or reach is None:
        return
    low, high = (
        float(
            crank.linkage_angle(
                length=reach.closed + travel,
                base_radius=reach.base,
                crank_radius=reach.crank,
                angle_offset=reach.offset,
            )
        )
        for travel in (0.0, reach.stroke)
    )
    if low - 1e-9 <= angle <= high + 1e-9 or math.isnan(high - low):
        return
    text = quantities.INPUTS["joint_angle"].text
    inner = [_ROUND * math.ceil(low / _ROUND), _ROUND * math.floor(high / _ROUND)]
    yield Fault(
        (*loc, "angle"),
        f"{text(angle)}: the range of the joint is {text(low)} to {text(high)}",
        f"write {text(inner[0], 7)} to {text(inner[1], 7)}, or change linkage.angle_offset",
    )


LINKAGE_CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    linkage,
    inertia,
    linkage_load_cases,
)


def lines(view: FileView) -> Iterator[Fault]:
    """Check every hydraulic line.

    Its outer diameter must exceed its inner diameter. If the line is beyond a throttle, the design
    must state this throttle.
    """
    for index in range(len(view.items("lines"))):
        inner = view.number("lines", index, "inner_diameter")
        outer = view.number("lines", index, "outer_diameter")
        if inner is not None and outer is not None and outer <= inner:
            yield Fault(
                ("lines", index, "outer_diameter"),
                f"{length_text(outer)}: not larger than inner_diameter ({length_text(inner)})",
                f"write more than {length_text(inner)}",
            )
        if view.flag("lines", index, "beyond_throttle") and not view.has("ports", "throttle"):
            yield Fault(
                ("lines", index, "beyond_throttle"),
                "no throttle stated",
                "add ports.throttle, or remove beyond_throttle",
            )


ENDS = get_args(get_args(choices.End)[0])


def ports(view: FileView) -> Iterator[Fault]:
    """Check that the component named in ports.end is described, and no other end component is."""
    end = view.text("ports", "end")
    if end not in ENDS:  # reported as a separate fault
        return
    block = {"valve": ("valve",), "reducing_valve": ("ports", "reducing_valve")}.get(end or "")
    if block is not None and not view.has(*block):
        yield Fault(
            ("ports", "end"),
            f"{end}: its block is missing",
            f'add {".".join(block)}, or write "end: closed" or "end: constant_pressure"',
        )
    if end != "reducing_valve" and view.has("ports", "reducing_valve"):
        yield Fault(
            ("ports", "reducing_valve"),
            "has no effect, because ports.end is not reducing_valve",
            'write "end: reducing_valve", or remove it',
            at_key=True,
        )
    if end == "constant_pressure" and view.items("ports", "accumulators"):
        yield Fault(
            ("ports", "accumulators"),
            "has no effect at constant line pressure",
            "remove it, or write another end",
            at_key=True,
        )


def stiffness(view: FileView) -> Iterator[Fault]:
    """Refuse sticking seals together with a published stiffness formula, which omits seals."""
    published = view.text("stiffness", "topology") != "per_chamber"
    if published and view.text("stiffness", "seals") == "sticking":
        yield Fault(
            ("stiffness", "seals"),
            "sticking seals have no effect in the published formulas, which omit seals",
            'write "topology: per_chamber", or "seals: sliding"',
        )


def control(view: FileView) -> Iterator[Fault]:
    """Require a valve if a position loop is stated."""
    if view.has("control") and not view.has("valve"):
        yield Fault(
            ("control",),
            "no valve to control",
            'add a block "valve:", or remove the block "control:"',
            at_key=True,
        )


def held_pressures(view: FileView) -> Iterator[Fault]:
    """Check held pressures: stated for both chambers or none, each at most proof pressure."""
    for index in range(len(view.items("load_cases"))):
        loc = ("load_cases", index)
        a, b = view.has(*loc, "pressure_a"), view.has(*loc, "pressure_b")
        if a != b:
            missing, other = ("pressure_b", "pressure_a") if a else ("pressure_a", "pressure_b")
            yield Fault(
                (*loc, missing), f"missing: required with {other}", f'add e.g. "{missing}: 20 bar"'
            )
        for name in ("pressure_a", "pressure_b"):
            pressure, supply = view.number(*loc, name), view.number("supply", "pressure")
            ratio = view.number("supply", "proof_ratio")
            if pressure is None or supply is None or ratio is None:
                continue
            if pressure > supply * ratio * (1 + 1e-9):
                text = quantities.INPUTS["pressure"].text
                yield Fault(
                    (*loc, name),
                    f"{text(pressure)}: above proof pressure ({text(supply * ratio)})",
                    f"write at most {text(supply * ratio)}, or raise supply.pressure",
                )


CIRCUIT_CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    lines,
    ports,
    valve_faults.valve,
    stiffness,
    control,
    held_pressures,
)


def _smaller(
    view: FileView, inner: Loc, outer: Loc, *, factor: float = 1.0, why: str = ""
) -> Iterator[Fault]:
    """Check that `inner` is smaller than `factor` times `outer`."""
    small, large = view.number(*inner), view.number(*outer)
    if small is None or large is None or small < large * factor:
        return
    name = ".".join(str(key) for key in outer)
    yield Fault(
        inner,
        f"{length_text(small)}: must be smaller than {name} ({length_text(large)}){why}",
        f"write less than {length_text(large * factor)}",
    )


def piston_nut(view: FileView) -> Iterator[Fault]:
    """Check that the rod has a shoulder for the piston, and the piston a web under its nut."""
    loc = ("piston", "nut")
    if not view.has(*loc):
        return
    if view.items("rod", "layup"):
        yield Fault(
            loc,
            "a laminated rod has no shoulder against which a nut could clamp the piston",
            "remove the block, or use a rod of one metal",
            at_key=True,
        )
        return
    diameter, length = view.number(*loc, "diameter"), view.bound("upper", "piston", "length")
    varied = view.has("variables", "piston.length")
    at_most, path = (
        ("at most ", "the upper bound of piston.length") if varied else ("", "piston.length")
    )
    rod_diameter = view.number("rod", "outer_diameter")
    if diameter is None:
        return
    if rod_diameter is not None and diameter >= rod_diameter:
        yield Fault(
            (*loc, "diameter"),
            f"{length_text(diameter)}: leaves no shoulder on the rod, which has "
            f"{length_text(rod_diameter)}",
            f"write less than {length_text(rod_diameter)}",
        )
    if view.number(*loc, "preload") == 0 and not view.has("variables", "piston.nut.preload"):
        yield Fault(
            (*loc, "preload"),
            "0: nothing clamps the piston on the rod",
            'write the tension after tightening, e.g. "preload: 8 kN"',
        )
    height = HEIGHT * diameter
    if length is not None and height >= length:
        yield Fault(
            (*loc, "diameter"),
            f"the nut, {length_text(height)} high, does not fit into the piston, which is "
            f"{at_most}{length_text(length)} long",
            f"use a smaller thread, or increase {path}",
        )


def parts(view: FileView) -> Iterator[Fault]:
    """Check the parts of standard series: ports, bearings of the eyes, position sensor."""
    size, bore = (
        _row(view, ("cylinder", "port_thread"), port),
        view.number("cylinder", "port_diameter"),
    )
    if size is not None and bore is not None and bore > size.bore * (1 + 1e-9):
        yield Fault(
            ("cylinder", "port_diameter"),
            f"{length_text(bore)}: larger than the bore of a port {size.thread} "
            f"({length_text(size.bore)})",
            f"write at most {length_text(size.bore)}, or a larger port_thread",
        )
    pin, bearing = (
        view.number("clevis", "pin_diameter"),
        _row(view, ("clevis", "bearing"), spherical_bearing),
    )
    if view.has("clevis", "material") and not view.has("clevis", "bearing"):
        if not view.has("clevis", "pin_diameter"):
            yield Fault(
                ("clevis", "pin_diameter"),
                "missing: required without bearing",
                'add e.g. "pin_diameter: 10 mm", or "bearing: ge10e"',
            )
    elif pin is not None and bearing is not None and abs(pin - bearing.bore) > 1e-9:
        yield Fault(
            ("clevis", "pin_diameter"),
            f"{length_text(pin)}: the bore of bearing {bearing.name} is "
            f"{length_text(bearing.bore)}",
            "remove the line, or choose another bearing",
        )
    yield from _sensor(view)
    yield from _cushion(view)
    for index in range(len(view.items("extra_masses"))):
        loc = ("extra_masses", index)
        if view.number(*loc, "length") and view.text(*loc, "place") not in ("cap", "rod"):
            yield Fault(
                (*loc, "length"),
                "only a component between cap or rod and its eye makes the actuator longer",
                "remove the line, or write place: cap or rod",
                at_key=True,
            )


def _cushion(view: FileView) -> Iterator[Fault]:
    """Check that a cushion is shorter than the stroke, and its spear between rod and bore."""
    loc = ("cushion",)
    if not view.has(*loc):
        return
    yield from _smaller(view, (*loc, "length"), ("cylinder", "stroke"))
    varied = view.has("variables", "cylinder.bore")
    if not varied:
        yield from _smaller(view, (*loc, "diameter"), ("cylinder", "bore"))
    rod_end, varied = view.text(*loc, "ends") != "cap", view.has("variables", "rod.outer_diameter")
    if rod_end and not varied:
        yield from _smaller(view, ("rod", "outer_diameter"), (*loc, "diameter"))
    opened, closed = view.number(*loc, "open_area"), view.number(*loc, "end_area")
    if opened is not None and closed is not None and not 0 < closed < opened:
        text = quantities.INPUTS["orifice_area"].text
        yield Fault(
            (*loc, "end_area"),
            f"{text(closed)}: must be above 0 and below open_area ({text(opened)})",
            "write the area of the gap that remains at the stop",
        )


def _sensor(view: FileView) -> Iterator[Fault]:
    """Check that a position sensor has a hollow rod, and a way into it."""
    if not view.has("sensor"):
        return
    layers, hole = view.items("rod", "layup"), view.number("rod", "inner_diameter")
    diameter = view.number("sensor", "diameter")
    if view.has("piston", "nut"):
        yield Fault(
            ("sensor",),
            "the sensor would pass through the stud of the piston's nut, which is solid",
            "remove piston.nut and state the fastening under extra_masses, or remove the sensor",
            at_key=True,
        )
    if layers and view.has("rod", "fitting") and not view.has("rod", "fitting", "wall"):
        yield Fault(
            ("sensor",),
            "the fittings of the rod are solid, so that the sensor cannot pass",
            "add rod.fitting.wall, or remove the sensor",
            at_key=True,
        )
    variable = view.has("variables", "rod.inner_diameter")
    if not layers and not variable and hole is not None and diameter is not None:
        least = diameter + 2 * LEAST_METAL
        if hole < least * (1 - ROUNDING):
            bore = f"its bore is {length_text(hole)}" if hole else "it is solid"
            yield Fault(
                ("sensor", "diameter"),
                f"{length_text(diameter)}: needs a rod with a bore of {length_text(least)}, "
                f"but {bore}",
                f"write rod.inner_diameter of at least {length_text(least)}",
            )


def rod(view: FileView) -> Iterator[Fault]:
    """Check that the rod fits into the bore, and the rod's own bore and thread into the rod."""
    yield from _smaller(view, ("rod", "outer_diameter"), ("cylinder", "bore"))
    yield from _smaller(view, ("rod", "inner_diameter"), ("rod", "outer_diameter"))
    yield from _smaller(view, ("cylinder", "port_diameter"), ("cylinder", "bore"))
    thread, diameter = (
        view.number("rod", "thread", "diameter"),
        view.number("rod", "outer_diameter"),
    )
    if thread is not None and diameter is not None and thread > diameter:
        yield Fault(
            ("rod", "thread", "diameter"),
            f"{length_text(thread)}: larger than the rod ({length_text(diameter)})",
            f"write at most {length_text(diameter)}",
        )
    joints = ((*end.at, "thread") for end in wall_faults.ends(view))
    for threaded in (("rod", "thread"), ("piston", "nut"), *joints):
        yield from _smaller(
            view,
            (*threaded, "pitch"),
            (*threaded, "diameter"),
            factor=0.5,
            why=", or no core of the thread remains",
        )


def barrel_length(view: FileView) -> Iterator[Fault]:
    """Check that the barrel is long enough for stroke, piston and head, or both glands."""
    length, head = view.number("barrel", "length"), view.number("head", "length")
    parts = [view.number("cylinder", "stroke"), view.number("piston", "length"), head]
    words = "stroke + piston + head"
    if double_rod.has_second_rod(view):
        parts, words = [*parts, head], "stroke + piston + two glands of head.length"
    needed = sum(part for part in parts if part is not None)
    if length is not None and length < needed * (1 - 1e-9):
        yield Fault(
            ("barrel", "length"),
            f"{length_text(length)}: shorter than {words} ({length_text(needed)})",
            f"write at least {length_text(needed)}, or remove it",
        )


def supply(view: FileView) -> Iterator[Fault]:
    """Check that supply pressure exceeds return pressure, but not proof pressure."""
    pressure, back = view.number("supply", "pressure"), view.number("supply", "return_pressure")
    ratio = view.number("supply", "proof_ratio")
    text = quantities.INPUTS["pressure"].text
    if pressure is not None and back is not None and back >= pressure:
        yield Fault(
            ("supply", "return_pressure"),
            f"{text(back)}: not below supply.pressure ({text(pressure)})",
            f"write less than {text(pressure)}",
        )
    if ratio is not None and ratio < 1:
        yield Fault(
            ("supply", "proof_ratio"),
            f"{ratio:g}: proof pressure below supply pressure",
            "write 1 or more",
        )


def environment(view: FileView) -> Iterator[Fault]:
    """Check that the lowest temperature is below the highest."""
    low = view.number("environment", "temperature_min")
    high = view.number("environment", "temperature_max")
    text = quantities.INPUTS["temperature"].text
    if low is not None and high is not None and low >= high:
        yield Fault(
            ("environment", "temperature_max"),
            f"range reversed: {text(high)} is not above temperature_min ({text(low)})",
            "swap them",
        )


def _case_pressure(view: FileView, index: int) -> Iterator[Fault]:
    """Check that the pressure of a load case is between return and supply pressure."""
    loc = ("load_cases", index, "pressure")
    pressure, supply = view.number(*loc), view.number("supply", "pressure")
    back = view.number("supply", "return_pressure")
    text = quantities.INPUTS["pressure"].text
    if pressure is None or supply is None or back is None or back >= supply:
        return
    if pressure > supply * (1 + 1e-9):
        message = f"{text(pressure)}: above supply.pressure ({text(supply)})"
        yield Fault(loc, message, f"write at most {text(supply)}, or raise supply.pressure")
    elif pressure < back:
        message = f"{text(pressure)}: below supply.return_pressure ({text(back)})"
        yield Fault(loc, message, f"write {text(back)} to {text(supply)}")


def load_cases(view: FileView) -> Iterator[Fault]:
    """Check each load case: unique name, force or torque with lever arm, pressure, position."""
    seen: dict[str, int] = {}
    stroke = view.number("cylinder", "stroke")
    for index, case in enumerate(view.items("load_cases")):
        loc = ("load_cases", index)
        name = child(case, "name")
        if isinstance(name, str):
            if name in seen:
                message = f'"{errors.shown(name)}": also the name of entry {seen[name]}'
                yield Fault((*loc, "name"), message, "give each load case its own name")
            seen.setdefault(name, index)
        if isinstance(case, dict):
            yield from _case_force(loc, case, linked=view.has("linkage"))
            yield from _case_pressure(view, index)
        position = child(case, "position")
        if isinstance(position, float) and stroke is not None and position > stroke:
            yield Fault(
                (*loc, "position"),
                f"{length_text(position)}: beyond cylinder.stroke ({length_text(stroke)})",
                f'write at most {length_text(stroke)}, or a share such as "50 %"',
            )


def _case_force(loc: Loc, case: dict[str, Any], *, linked: bool) -> Iterator[Fault]:
    force, torque, arm = (key in case for key in ("force", "joint_torque", "lever_arm"))
    if force and (torque or arm):
        other = "joint_torque" if torque else "lever_arm"
        yield Fault(
            (*loc, other),
            "a load case has either force, or joint_torque with lever_arm",
            'keep one of them, e.g. "joint_torque: 120 N*m" with "lever_arm: 40 mm"',
            at_key=True,
        )
    elif torque and not arm and not linked:
        remedy = 'add e.g. "lever_arm: 40 mm", or a block "linkage:"'
        yield Fault((*loc, "lever_arm"), "missing: joint_torque needs it, or a linkage", remedy)
    elif arm and not torque:
        remedy = 'add e.g. "joint_torque: 120 N*m"'
        yield Fault((*loc, "joint_torque"), "missing: required with lever_arm", remedy)
    elif not force and not torque:
        remedy = 'add e.g. "force: 3 kN", or joint_torque with lever_arm or linkage'
        yield Fault((*loc, "force"), "missing", remedy)


CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    double_rod.cylinder_type,
    rod,
    piston_nut,
    parts,
    barrel_length,
    lambda view: wall_faults.skirts(view, _spigot(view)),
    supply,
    environment,
    wall_faults.keys,
    load_cases,
    *duty_faults.CHECKS,
    *seal_faults.CHECKS,
    *CIRCUIT_CHECKS,
    *LINKAGE_CHECKS,
    *wall_faults.CHECKS,
    wall_faults.values,
    assembly.faults,
)


def cross_field(tree: Any) -> Iterator[Fault]:
    """Yield all contradictions between the values of a tree in SI."""
    view = FileView(tree)
    for check in CHECKS:
        yield from check(view)


def material_faults(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Yield all faults that depend on the material library."""
    yield from _material_names(tree, materials)
    yield from wall_faults.of_materials(tree, materials)
    yield from wall_faults.of_end_materials(tree, materials)
    yield from seal_faults.sliding_rings(tree, materials)
    yield from material.of_fluid(tree, materials)


def _material_names(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Yield faults for unknown materials, and for materials of a kind that their key refuses."""
    ends = wall_faults.ends(FileView(tree))
    joints: dict[Loc, Joint | None] = {(*end.at, "material"): end.joint for end in ends}
    for loc, entry, name in leaves(tree):
        if not isinstance(entry.kind, MaterialName) or not isinstance(name, str):
            continue
        suitable, usual = ROLES[entry.kind.role], entry.kind.usual
        if (joint := joints.get(loc)) is not None:
            suitable = joint.kinds or suitable
        if name in materials and materials.kind(name) in suitable:
            continue
        candidates = materials.meanings(usual or suitable)
        place = ".".join(str(key) for key in loc)
        if name not in materials:
            message = f'"{errors.shown(name)}": unknown material'
            yield Fault(loc, message, errors.remedy(name, candidates, about=place))
        else:
            kind, kinds = str(materials.kind(name)), " or ".join(suitable)
            message = f"{name} is {article(kind)}, need {article(kinds)}"
            offered = by_nearness(place, candidates)[:6]
            yield Fault(loc, message, f"use e.g. {', '.join(offered)}" if offered else "")
    changed = child(tree, "materials")
    for name in changed if isinstance(changed, Mapping) else ():
        if name not in materials:
            message = f'"{errors.shown(name)}": unknown material'
            remedy = errors.remedy(name, materials.meanings())
            yield Fault(("materials", name), message, remedy, at_key=True)
