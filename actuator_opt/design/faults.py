"""Contradictions between values of a design, each reported at one of the values.

Every check is a small function of a `View`. It yields nothing if a required value is missing or
already faulty, so the checks also run on a file with other faults. More checks are in
`wall_faults` (barrel and rod), `retention_faults` (joints of caps and head), `seal_faults` and
`linkage_faults` (robot joints).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ..base import errors, quantities
from ..base.errors import Fault
from . import circuit_faults, linkage_faults, material, seal_faults, wall_faults
from .kinds import MaterialName
from .material import ROLES
from .view import Materials, View, length_text
from .walls import Loc, child, leaves


def _smaller(
    view: View, inner: Loc, outer: Loc, *, factor: float = 1.0, why: str = ""
) -> Iterator[Fault]:
    """`inner` must be smaller than `factor` times `outer`."""
    small, large = view.number(*inner), view.number(*outer)
    if small is None or large is None or small < large * factor:
        return
    name = ".".join(str(key) for key in outer)
    yield Fault(
        inner,
        f"{length_text(small)}: must be smaller than {name} ({length_text(large)}){why}",
        f"write less than {length_text(large * factor)}",
    )


def rod(view: View) -> Iterator[Fault]:
    """The rod fits the bore, its bore and its thread fit the rod."""
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
    for owner in ("rod", "retention"):
        yield from _smaller(
            view,
            (owner, "thread", "pitch"),
            (owner, "thread", "diameter"),
            factor=0.5,
            why=": no core remains",
        )


def barrel_length(view: View) -> Iterator[Fault]:
    """The barrel has room for stroke, piston and head."""
    length = view.number("barrel", "length")
    parts = [
        view.number("cylinder", "stroke"),
        view.number("piston", "length"),
        view.number("head", "length"),
    ]
    needed = sum(part for part in parts if part is not None)
    if length is not None and length < needed * (1 - 1e-9):
        yield Fault(
            ("barrel", "length"),
            f"{length_text(length)}: shorter than stroke + piston + head ({length_text(needed)})",
            f"write at least {length_text(needed)}, or remove it",
        )


def supply(view: View) -> Iterator[Fault]:
    """The supply exceeds the return; proof is not below supply pressure."""
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


def environment(view: View) -> Iterator[Fault]:
    """The coldest temperature is below the hottest."""
    low = view.number("environment", "temperature_min")
    high = view.number("environment", "temperature_max")
    text = quantities.INPUTS["temperature"].text
    if low is not None and high is not None and low >= high:
        yield Fault(
            ("environment", "temperature_max"),
            f"range reversed: {text(high)} is not above temperature_min ({text(low)})",
            "swap them",
        )


def _case_pressure(view: View, index: int) -> Iterator[Fault]:
    """The driven port of a case has at least return and at most supply pressure."""
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


def load_cases(view: View) -> Iterator[Fault]:
    """Names are unique; force or torque with its lever; pressures and positions are in range."""
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
            "force and joint torque in one load case",
            "keep one of them",
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


CHECKS: tuple[Callable[[View], Iterator[Fault]], ...] = (
    rod,
    barrel_length,
    wall_faults.skirts,
    supply,
    environment,
    wall_faults.keys,
    load_cases,
    *seal_faults.CHECKS,
    *circuit_faults.CHECKS,
    *linkage_faults.CHECKS,
    *wall_faults.CHECKS,
    wall_faults.values,
)


def cross_field(tree: Any) -> Iterator[Fault]:
    """All contradictions between values of a tree in SI."""
    view = View(tree)
    for check in CHECKS:
        yield from check(view)


def _a(word: str | None) -> str:
    return f"{'an' if word and word[0] in 'aeiou' else 'a'} {word}"


def material_faults(tree: Any, materials: Materials) -> Iterator[Fault]:
    """All faults that depend on the material library."""
    yield from _material_names(tree, materials)
    yield from wall_faults.of_materials(tree, materials)
    yield from wall_faults.of_end_materials(tree, materials)
    yield from seal_faults.sliding_rings(tree, materials)
    yield from material.of_fluid(tree, materials)


def _material_names(tree: Any, materials: Materials) -> Iterator[Fault]:
    """Unknown materials, and materials that do not suit their place."""
    joint = wall_faults.joint_of(View(tree))
    for loc, entry, name in leaves(tree):
        if not isinstance(entry.kind, MaterialName) or not isinstance(name, str):
            continue
        fits = ROLES[entry.kind.role]
        if loc == ("retention", "material") and joint is not None:
            fits = joint.kinds or fits
        elif loc == ("rod", "fitting", "adhesive"):
            fits = ("adhesive",)
        if name in materials and materials.kind(name) in fits:
            continue
        fitting = [other for other in materials.names() if materials.kind(other) in fits]
        if name not in materials:
            message = f'"{errors.shown(name)}": unknown material'
            yield Fault(loc, message, errors.remedy(name, fitting))
        else:
            message = f"{name} is {_a(materials.kind(name))}, need {_a(' or '.join(fits))}"
            yield Fault(loc, message, f"use e.g. {', '.join(fitting[:6])}" if fitting else "")
    changed = child(tree, "materials")
    for name in changed if isinstance(changed, Mapping) else ():
        if name not in materials:
            message = f'"{errors.shown(name)}": unknown material'
            remedy = errors.remedy(name, materials.names())
            yield Fault(("materials", name), message, remedy, at_key=True)
