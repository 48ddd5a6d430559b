"""Series for the `sizes` of a variable: standards, whole plies, feasible angles.

A series states its PATHs, whether it applies to a design, the variable its sizes depend on, and the
sizes themselves. Tables and their sources are in `standards`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

from ..base.errors import InputError
from ..base.quantities import INPUTS
from ..seals.kinds import TYPES
from . import standards
from .seals import BACK_UPS
from .structure import child_at
from .view import View

WHOLE = 1e-6
"""Fraction of a ply, and angle (rad), that counts as zero."""

Bounds = tuple[float, float]


@dataclass(frozen=True)
class Series:
    """A series of sizes.

    Parameters
    ----------
    name, label : name in the file and in reports
    suits, paths : suitable variables, in words and as a pattern of PATHs
    asked : option that selects it if the file does not ("file": no option)
    needs_parent : whether its sizes require those of the parent variable
    """

    name: str
    label: str
    suits: str
    paths: re.Pattern[str]
    asked: Literal["file", "plies", "standard"] = "file"
    needs_parent: bool = False

    def fault(self, view: View, path: str) -> tuple[str, str] | None:
        """Why the series does not apply to a variable, and the remedy."""
        return None

    def parent(self, path: str) -> str | None:
        """The parent variable, on which the sizes of a variable depend."""
        return None

    def each(self, view: View, path: str) -> str:
        """Name of a single size."""
        return f"{self.label} size"

    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        """The sizes for a value of the parent (None: no parent, or a free parent)."""
        raise NotImplementedError


def along(angle: float) -> bool:
    """Whether an angle is 0 or 90 degrees, where a balanced pair is two equal plies."""
    return abs(math.sin(2 * angle)) <= WHOLE


def _layer(view: View, path: str, key: str) -> float | None:
    """A number of the layer of a PATH."""
    match = re.match(r"(barrel|rod)\.layup\[(\d+)\]", path)
    assert match is not None
    return view.number(match[1], "layup", int(match[2]), key)


class _Iso3320(Series):
    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        sizes = standards.bores() if path == "cylinder.bore" else standards.rods()
        return [size.value for size in sizes]


class _Pairs(Series):
    """Bore and rod of a catalogue cylinder: both, or either with the other fixed."""

    def _other(self, path: str) -> str:
        return "cylinder.bore" if path != "cylinder.bore" else "rod.outer_diameter"

    def fault(self, view: View, path: str) -> tuple[str, str] | None:
        other = self._other(path)
        variable = child_at(view.tree, ("variables", other))
        if variable is None or child_at(variable, ("sizes",)) == self.name:
            return None
        message = f"{self.name} has pairs of bore and rod, but {other} is not of this series"
        return message, f'add "sizes: {self.name}" to {other} too'

    def parent(self, path: str) -> str | None:
        return "cylinder.bore" if path != "cylinder.bore" else None

    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        pairs = standards.cylinder_pairs(self.label)
        if path != "cylinder.bore":
            return sorted(pair.rod_diameter for pair in pairs if _same(pair.bore, parent))
        if child_at(view.tree, ("variables", "rod.outer_diameter")) is None:
            rod = view.number("rod", "outer_diameter")
            pairs = tuple(pair for pair in pairs if _same(pair.rod_diameter, rod))
        return sorted({pair.bore for pair in pairs})


def _same(one: float, other: float | None) -> bool:
    return other is not None and math.isclose(one, other, rel_tol=1e-9)


class _Walls(Series):
    """Walls of drawn steel tube, of a metal layer or of a hollow rod."""

    def fault(self, view: View, path: str) -> tuple[str, str] | None:
        if path == "rod.inner_diameter" or _layer(view, path, "ply_thickness") is None:
            return None
        return f"{self.name} has tube walls, but this layer consists of plies", "write whole_plies"

    def parent(self, path: str) -> str | None:
        return "rod.outer_diameter" if path == "rod.inner_diameter" else None

    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        walls = [size.value for size in standards.tube_walls()]
        if path != "rod.inner_diameter":
            return walls
        outside = Decimal(repr(parent or 0.0))
        holes = (float(outside - 2 * Decimal(repr(wall))) for wall in reversed(walls))
        return [hole for hole in holes if hole > 0]


class _Glands(Series):
    """O-ring sections, with squeeze and groove of their gland at mid-tolerance."""

    def _seal(self, path: str) -> tuple[str, ...]:
        return tuple(path.split(".")[:-1])

    def fault(self, view: View, path: str) -> tuple[str, str] | None:
        kind = TYPES.get(view.text(*self._seal(path), "type") or "")
        if kind is None or kind.o_ring_gland:
            return None
        message = f"{self.name} has O-rings and their glands, but this is a {kind.name}"
        return message, "list its sizes"

    def parent(self, path: str) -> str | None:
        head, _, last = path.rpartition(".")
        return None if last == "section" else f"{head}.section"

    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        if path.endswith(".section"):
            return standards.ring_sections()
        if parent is None:
            return []
        try:
            gland = standards.gland(parent)
            if path.endswith(".squeeze"):
                return [1 - gland.depth / parent]
            rings = BACK_UPS.get(view.text(*self._seal(path), "back_up") or "none", 0)
            return [sum(gland.widths(rings)) / 2]
        except InputError:
            return []


class _WholePlies(Series):
    def fault(self, view: View, path: str) -> tuple[str, str] | None:
        if _layer(view, path, "ply_thickness") is not None:
            return None
        remedy = 'add e.g. "ply_thickness: 0.2 mm" to it; for a metal layer write a step'
        return "the layer has no ply_thickness", remedy

    def parent(self, path: str) -> str | None:
        return path.removesuffix("thickness") + "angle"

    def _singly(self, view: View, path: str, angle: float | None) -> bool:
        """Whether plies count singly: not balanced, or at 0 or 90 degrees."""
        balanced = view.flag(*self._loc(path), "balanced")
        return balanced is False or (angle is not None and along(angle))

    def _loc(self, path: str) -> tuple[str | int, ...]:
        match = re.match(r"(barrel|rod)\.layup\[(\d+)\]", path)
        assert match is not None
        return match[1], "layup", int(match[2])

    def each(self, view: View, path: str) -> str:
        angle = _layer(view, path, "angle")
        pairs = "" if self._singly(view, path, angle) else "pairs of "
        one = INPUTS["ply_thickness"].text(_layer(view, path, "ply_thickness") or 0.0)
        return f"whole number of {pairs}plies of {one}"

    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        one = _layer(view, path, "ply_thickness") or 0.0
        step = 1 if self._singly(view, path, parent) else 2
        counts = range(step, math.ceil(bounds[1] / one) + 3, step)
        # in decimals: 26 plies of 0.125 mm are exactly 3.25 mm
        return [float(count * Decimal(repr(one))) for count in counts]


class _Angles(Series):
    def fault(self, view: View, path: str) -> tuple[str, str] | None:
        if view.items("barrel", "allowed_angles"):
            return None
        return "the barrel has no allowed_angles", 'add e.g. "allowed_angles: [20 deg, 45 deg]"'

    def each(self, view: View, path: str) -> str:
        return "allowed angle"

    def values(
        self, view: View, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        angles = view.items("barrel", "allowed_angles")
        return sorted({sign * angle + 0.0 for angle in angles for sign in (1, -1)})


_BORE_AND_ROD = re.compile(r"cylinder\.bore|rod\.outer_diameter")
_THICKNESS = r"(barrel|rod)\.layup\[\d+\]\.thickness"
_O_RING = re.compile(r"seals\.(piston|rod)\.(secondary\.)?(section|squeeze|groove_width)")
_BOTH = "cylinder.bore and rod.outer_diameter"

SERIES: Mapping[str, Series] = {
    series.name: series
    for series in (
        _Iso3320("iso_3320", "ISO 3320", _BOTH, _BORE_AND_ROD, "standard"),
        _Pairs("iso_6020_2", "ISO 6020-2", _BOTH, _BORE_AND_ROD),
        _Pairs("iso_6022", "ISO 6022", _BOTH, _BORE_AND_ROD),
        _Walls(
            "en_10305_1",
            "EN 10305-1",
            "the thickness of a metal layer and rod.inner_diameter",
            re.compile(rf"{_THICKNESS}|rod\.inner_diameter"),
            needs_parent=True,
        ),
        _Glands(
            "iso_3601",
            "ISO 3601",
            "section, squeeze and groove_width of an O-ring",
            _O_RING,
            needs_parent=True,
        ),
        _Angles(
            "allowed_angles",
            "allowed angles",
            "the angle of a layer",
            re.compile(r"(barrel|rod)\.layup\[\d+\]\.angle"),
            "plies",
        ),
        _WholePlies(
            "whole_plies",
            "whole plies",
            "the thickness of a layer that states its ply_thickness",
            re.compile(_THICKNESS),
            "plies",
        ),
    )
}
"""Every series by its name."""
