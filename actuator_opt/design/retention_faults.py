"""Faults of `retention`: missing or unused keys, and faults that the joint reports.

Each joint declares its keys and checks in its module in `joints`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ..base.errors import Fault
from ..joints.joint import Joint
from ..joints.kinds import JOINTS
from .model import Retention
from .structure import entries
from .view import Materials, Properties, View, length_text
from .wall_faults import known_numbers

_TYPE = ("retention", "type")


def joint_of(view: View) -> Joint | None:
    """The joint of a file; None if unknown."""
    return JOINTS.get(view.text(*_TYPE) or "")


def keys(view: View) -> Iterator[Fault]:
    """All keys that the joint needs are stated, and no others."""
    joint = joint_of(view)
    if joint is None:
        return
    yield from _unused(view, joint)
    for field in joint.fields:
        loc = ("retention", *field.key.split("."))
        needed = field.missing and all(view.has(*loc[:end]) for end in range(1, len(loc)))
        if needed and not view.has(*loc):
            yield Fault(loc, field.missing, field.remedy)


def _unused(view: View, joint: Joint) -> Iterator[Fault]:
    """Keys that neither the joint nor an alternative among the choices uses, except defaults."""
    offered = [JOINTS.get(name) for name in view.items("choices", ".".join(_TYPE))]
    used = _keys(one for one in (joint, *offered) if one is not None)
    for name, entry in entries(Retention).items():
        value = view.value("retention", name)
        if entry.required or name in used or value is None or value == entry.default:
            continue
        users = [one for one in JOINTS.values() if name in _keys([one])]
        message, remedy = joint.without.get(name) or (
            f"{joint.noun} {_have([joint])} no {name}, "
            f"only {' and '.join(one.noun for one in users)} {_have(users)}",
            f"remove the line, or write type: {' or '.join(one.name for one in users)}",
        )
        yield Fault(("retention", name), message, remedy, at_key=True)


def _keys(joints: Iterable[Joint]) -> set[str]:
    """Keys of `retention` that only some joints use."""
    return {field.key.partition(".")[0] for joint in joints for field in joint.fields}


def _have(joints: list[Joint]) -> str:
    return "have" if len(joints) > 1 or joints[0].plural else "has"


def skirts(view: View) -> Iterator[Fault]:
    """The skirts of both ends do not meet on the barrel."""
    joint = joint_of(view)
    if joint is None or not joint.skirts:
        return
    overlap, length = view.number("retention", "length"), view.number("barrel", "length")
    parts = [("cylinder", "stroke"), ("piston", "length"), ("head", "length")]
    known = [one for one in (view.number(*part) for part in parts) if one is not None]
    if length is None and len(known) == len(parts):
        length = sum(known)
    if overlap is not None and length is not None and 2 * overlap > length * (1 + 1e-9):
        yield Fault(
            ("retention", "length"),
            f"{length_text(overlap)}: the skirts of both ends meet on the barrel, which is "
            f"{length_text(length)} long",
            f"write at most {length_text(length / 2)}",
        )


def values(view: View) -> Iterator[Fault]:
    """Faults that the joint reports for the values of the file."""
    joint = joint_of(view)
    if joint is not None:
        yield from joint.faults(view)


class _Known:
    """The library, overridden by the properties that the design states."""

    def __init__(self, view: View, materials: Materials) -> None:
        self._view, self._materials = view, materials

    def kind(self, name: str) -> str | None:
        """Kind of a material; None if the name is unknown."""
        return self._materials.kind(name) if name in self._materials else None

    def properties(self, name: str) -> Iterable[str]:
        """Names of the stated properties; empty if unreadable."""
        if isinstance(self._materials, Properties):
            return known_numbers(self._view, self._materials, name)
        return ()


def of_materials(tree: Any, materials: Materials) -> Iterator[Fault]:
    """Faults of the joint that depend on the material library."""
    view = View(tree)
    joint = joint_of(view)
    if joint is not None:
        yield from joint.material_faults(view, _Known(view, materials))
