"""Standard sizes as data, and the series of sizes that a variable can take.

Tables: ISO 3320 bores and rods, ISO 6020-2/6022 pairs, O-rings and glands. Lengths are in m,
pressures in Pa; every row states source and confidence.

A variable can take its `sizes` from a series: a standard, whole plies, or allowed angles. A series
states to which PATHs and designs it applies, on which other variable its sizes depend, and the
sizes themselves.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, TypeAlias

from ..base import files as store
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.quantities import INPUTS
from ..seals.kinds import TYPES
from . import yaml_source
from .seals import BACK_UPS
from .structure import FileView, child_at

Use: TypeAlias = Literal["reciprocating", "static"]
Direction: TypeAlias = Literal["nearest", "up", "down"]

SAME = 0.005
"""Largest relative difference between a ring section and a tabulated one for which the tabulated
gland applies. For other sections the gland is interpolated."""


@dataclass(frozen=True, slots=True)
class StandardSize:
    """One size of a series."""

    value: float
    confidence: str
    source: str


@dataclass(frozen=True, slots=True)
class CylinderPair:
    """Bore and rod of a standard cylinder."""

    series: str
    bore: float
    rod_diameter: float
    pressure: float
    confidence: str
    source: str


@dataclass(frozen=True, slots=True)
class ORing:
    """An O-ring of a size list."""

    inside_diameter: float
    section: float
    tolerance: float
    confidence: str
    source: str


@dataclass(frozen=True, slots=True)
class Gland:
    """Groove of an O-ring; its depth is the whole radial space of the ring, up to rod or bore.

    If a table has no tolerances, smallest and largest values are equal; missing radii are 0.
    `back_up_widths` are the (smallest, largest) widths with one and with two back-up rings; empty
    if not tabulated.
    """

    use: str
    table: str
    section: float
    section_tolerance: float
    depth_min: float
    depth_max: float
    width_min: float
    width_max: float
    radius_min: float
    radius_max: float
    interpolated: bool
    confidence: str
    source: str
    back_up_widths: tuple[tuple[float, float], ...] = ()

    @property
    def depth(self) -> float:
        """Mid-tolerance depth."""
        return (self.depth_min + self.depth_max) / 2

    @property
    def width(self) -> float:
        """Mid-tolerance width."""
        return (self.width_min + self.width_max) / 2

    def widths(self, back_up_rings: int = 0) -> tuple[float, float]:
        """Smallest and largest width with this number of back-up rings.

        Raises
        ------
        InputError : if the table has no width for this number
        """
        widths = ((self.width_min, self.width_max), *self.back_up_widths)
        if not 0 <= back_up_rings < len(widths):
            message = f"no width with {back_up_rings} back-up rings in the {self.table} table"
            raise InputError(
                Diagnostic(message, f"the table has widths for 0 to {len(widths) - 1} rings")
            )
        return widths[back_up_rings]

    @property
    def squeeze(self) -> float:
        """Nominal squeeze, as a share of the section."""
        return 1 - self.depth / self.section

    @property
    def squeeze_min(self) -> float:
        """Smallest squeeze: thinnest ring in the deepest gland."""
        section = self.section - self.section_tolerance
        return 1 - self.depth_max / section

    @property
    def squeeze_max(self) -> float:
        """Largest squeeze: thickest ring in the shallowest gland."""
        section = self.section + self.section_tolerance
        return 1 - self.depth_min / section


@dataclass(frozen=True, slots=True)
class PortSize:
    """A threaded port for a fitting.

    `seat` is the largest diameter of the seat of its seal, `boss` the smallest diameter of a boss
    with the port, `depth` that of the full thread, and `drilled` that of its drill.
    """

    name: str
    thread: str
    diameter: float
    pitch: float
    seat: float
    boss: float
    depth: float
    drilled: float
    bore: float
    standard: str
    confidence: str
    source: str


@dataclass(frozen=True, slots=True)
class SphericalBearing:
    """A spherical plain bearing; static load rating in N, mass in kg."""

    name: str
    bore: float
    outer_diameter: float
    width: float
    ring_width: float
    static_rating: float
    mass: float
    confidence: str
    source: str


class _Tables(Mapping[str, Any]):
    """Tables of a file by name, each parsed when first used."""

    def __init__(self, path: Path) -> None:
        self.path = str(path)
        self.text = yaml_source.decode(path.read_bytes(), self.path)
        starts = [head.start() for head in re.finditer(r"(?m)^\w+:", self.text)]
        self._places = {
            self.text[start:end].partition(":")[0]: (start, end)
            for start, end in pairwise([*starts, len(self.text)])
        }
        self._parsed: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._parsed:
            start, end = self._places[name]
            before = "\n" * self.text.count("\n", 0, start)  # keeps the line numbers of the file
            document = yaml_source.parse(before + self.text[start:end], self.path)
            if document.faults:
                raise InputError(document.faults)
            self._parsed[name] = document.data[name]
        return self._parsed[name]

    def names(self, name: str) -> tuple[str, ...]:
        """The first entries of all rows of a table, without parsing it."""
        start, end = self._places[name]
        return tuple(re.findall(r"(?m)^ +- \[(\w+),", self.text[start:end]))

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


@functools.lru_cache(maxsize=1)
def tables() -> _Tables:
    """Contents of ``standards.yaml``; numbers are texts, so that they stay exact."""
    return _Tables(store.data_folder("materials") / "standards.yaml")


def metres(text: str) -> float:
    """Length in m from a decimal number in mm, exactly rounded."""
    return float(f"{text}e-3")


def citation(key: str) -> str:
    """Full text of a source that the tables name by its key."""
    return str(tables()["sources"][key])


@functools.cache
def _series(kind: str) -> tuple[StandardSize, ...]:
    table = tables()[kind]
    source = citation(table["source"])
    return tuple(
        sorted(
            (
                StandardSize(metres(text), confidence, source)
                for confidence in ("verified", "secondary", "unverified")
                for text in table.get(confidence, ())
            ),
            key=lambda size: size.value,
        )
    )


def bores() -> tuple[StandardSize, ...]:
    """ISO 3320 bores, ascending, m."""
    return _series("bores")


def rods() -> tuple[StandardSize, ...]:
    """ISO 3320 rod diameters, ascending, m."""
    return _series("rods")


def tube_walls() -> tuple[StandardSize, ...]:
    """Wall thicknesses of EN 10305-1 steel tube, ascending, m; not all exist at every diameter."""
    return _series("tube_walls")


@functools.cache
def cylinder_pairs(series: str | None = None) -> tuple[CylinderPair, ...]:
    """Pairs of bore and rod of ISO 6020-2 (160 bar) and ISO 6022 (250 bar), or of one series."""
    return tuple(
        CylinderPair(
            group["series"], metres(bore), metres(rod),
            float(group["pressure_bar"]) * 1e5, group["confidence"], citation(group["source"]),
        )
        for group in tables()["cylinder_pairs"]
        if series in (None, group["series"])
        for bore, rod in group["rows"]
    )  # fmt: skip


PORT_LENGTHS = ("diameter", "pitch", "seat", "boss", "depth", "drilled", "bore")
BEARING_LENGTHS = ("bore", "outer_diameter", "width", "ring_width")


@functools.cache
def port(name: str) -> PortSize:
    """A port by its name, such as `m10x1`."""
    return next(
        PortSize(
            name=name,
            thread=thread,
            **dict(zip(PORT_LENGTHS, map(metres, numbers), strict=True)),
            standard=group["standard"],
            confidence=group["confidence"],
            source=citation(group["source"]),
        )
        for group in tables()["ports"]
        for row, thread, *numbers in group["rows"]
        if row == name
    )


@functools.cache
def spherical_bearing(name: str) -> SphericalBearing:
    """A spherical plain bearing by its name, such as `ge8e`."""
    table = tables()["spherical_bearings"]
    return next(
        SphericalBearing(
            name=name,
            **dict(zip(BEARING_LENGTHS, map(metres, sizes), strict=True)),
            static_rating=float(f"{rating}e3"),
            mass=float(f"{grams}e-3"),
            confidence=table["confidence"],
            source=citation(table["source"]),
        )
        for row, *sizes, rating, grams in table["rows"]
        if row == name
    )


def meaning(table: str, name: str) -> str:
    """Words for a row of the tables `ports` and `spherical_bearings`."""
    if table == "ports":
        return f"{port(name).thread}, {port(name).standard}"
    size = spherical_bearing(name)
    return f"bore {1e3 * size.bore:g} mm, static load rating {1e-3 * size.static_rating:g} kN"


@functools.cache
def o_rings() -> tuple[ORing, ...]:
    """O-rings of GB/T 3452.1 series G, sorted by section, then by inside diameter; m."""
    table = tables()["o_rings"]
    source = citation(table["source"])
    return tuple(
        ORing(metres(inside), metres(group["section"]), metres(group["tolerance"]),
              table["confidence"], source)
        for group in table["series"]
        for inside in group["inside_diameters"]
    )  # fmt: skip


def ring_sections() -> tuple[float, ...]:
    """Nominal sections of ISO 3601-1 O-rings, ascending, m."""
    return tuple(sorted(metres(size) for size, _ in tables()["section_tolerances"]["rows"]))


def section_tolerance(section: float) -> StandardSize:
    """Tolerance (plus or minus, m) of a ring's free section.

    For a nominal section, it is stated by ISO 3601-1; any other section has the tolerance of its
    size band.

    Raises
    ------
    InputError : if the section is thicker than all size bands
    """
    sizes, bands = tables()["section_tolerances"], tables()["section_tolerance_bands"]
    for size, tolerance in sizes["rows"]:
        if abs(metres(size) - section) <= SAME * section:
            return StandardSize(metres(tolerance), sizes["confidence"], citation(sizes["source"]))
    for size, tolerance in bands["rows"]:
        if section <= metres(size) * (1 + 1e-9):
            return StandardSize(metres(tolerance), bands["confidence"], citation(bands["source"]))
    message = f"no tolerance for a section of {section * 1e3:.4g} mm"
    raise InputError(Diagnostic(message, "the table of size bands ends at 8.4 mm"))


@functools.cache
def glands(use: Use, table: str | None = None) -> tuple[Gland, ...]:
    """Tabulated glands of an application (reciprocating, static), ascending by section.

    `table` is ``as568``, ``metric`` or ``series_g`` (moving hydraulic seals only); by default the
    first two are used.
    """
    tabulated: list[Gland] = []
    for name in ("as568", "metric") if table is None else (table,):
        data = tables()[f"glands_{name}"]
        back_up_table = tables().get(f"back_up_{name}")
        back_up = back_up_table["rows"] if back_up_table else ()
        confidence, source = data["confidence"], citation(data["source"])
        if back_up_table and back_up_table["source"] != data["source"]:
            source += f"; with back-up rings: {citation(back_up_table['source'])}"
        for row in data.get(use, ()):
            numbers = [metres(text) for text in row]
            if name == "metric":
                section, depth, width = numbers
                numbers = [section, 0.0, depth, depth, width, width, 0.0, 0.0]
            w, tolerance, d0, d1, g0, g1, r0, r1 = numbers
            back_up_rows = [list(map(metres, other[1:])) for other in back_up if other[0] == row[0]]
            pairs = tuple((other[i], other[i + 1]) for other in back_up_rows for i in (0, 2))
            tabulated.append(
                Gland(use, name, w, tolerance, d0, d1, g0, g1, r0, r1,
                      False, confidence, source, pairs)
            )  # fmt: skip
    return tuple(sorted(tabulated, key=lambda gland: (gland.section, gland.table)))


def o_ring_sections(table: str | None = None) -> tuple[float, ...]:
    """Free sections with a tabulated reciprocating gland, ascending, m."""
    return tuple(sorted({gland.section for gland in glands("reciprocating", table)}))


def gland(section: float, use: Use = "reciprocating", *, table: str | None = None) -> Gland:
    """Gland of a section: tabulated, else interpolated between neighbours.

    Parameters
    ----------
    section : free section, m
    use : ``reciprocating`` or ``static``
    table : ``as568``, ``metric`` or ``series_g``; default: ``as568`` for its sections, else metric

    Raises
    ------
    InputError : if the section is outside the tables, or they have no glands for this use
    """
    if table is not None and not glands(use, table):
        message = f"the {table} table has no {use} glands"
        raise InputError(Diagnostic(message, "use the default table"))
    for rows in (glands(use, table or "as568"), glands(use, table or "metric")):
        nearest = min(rows, key=lambda row: abs(row.section - section))
        if abs(nearest.section - section) <= SAME * nearest.section:
            return nearest
    if not rows[0].section < section < rows[-1].section:
        low, high = rows[0].section * 1e3, rows[-1].section * 1e3
        message = f"no {use} gland for a section of {section * 1e3:.4g} mm"
        raise InputError(Diagnostic(message, f"the tables cover {low:.4g} to {high:.4g} mm"))
    return _between(rows, section)


def _between(rows: Sequence[Gland], section: float) -> Gland:
    above = next(i for i, row in enumerate(rows) if row.section >= section)
    first, second = rows[above - 1], rows[above]
    share = (section - first.section) / (second.section - first.section)

    def mix(name: str) -> float:
        lower, upper = getattr(first, name), getattr(second, name)
        return float(lower + share * (upper - lower))

    return Gland(
        first.use, first.table, section, mix("section_tolerance"),
        mix("depth_min"), mix("depth_max"), mix("width_min"), mix("width_max"),
        mix("radius_min"), mix("radius_max"), True, first.confidence, first.source,
        tuple(
            (low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1]))
            for low, high in zip(first.back_up_widths, second.back_up_widths, strict=True)
        ),
    )  # fmt: skip


def nearest_standard(
    kind: Literal["bore", "rod", "section"], value: float, direction: Direction = "nearest"
) -> float:
    """The standard size nearest to a value, or next above or below it, m.

    Parameters
    ----------
    kind : ``bore`` or ``rod`` (ISO 3320), ``section`` (AS568 sections of moving O-rings)
    value : m
    direction : ``nearest`` (by ratio), ``up`` (not smaller) or ``down`` (not larger)

    Raises
    ------
    InputError : no standard size lies in that direction
    """
    if kind == "section":
        sizes: tuple[float, ...] = o_ring_sections("as568")
    else:
        sizes = tuple(size.value for size in (bores() if kind == "bore" else rods()))
    slack = 1e-9
    if direction == "up":
        sizes = tuple(size for size in sizes if size >= value * (1 - slack))[:1]
    elif direction == "down":
        sizes = tuple(size for size in sizes if size <= value * (1 + slack))[-1:]
    if not sizes or value <= 0:
        message = f'no standard {kind} in direction "{direction}" from {value * 1e3:.4g} mm'
        raise InputError(Diagnostic(message, "choose another size or direction"))
    return min(sizes, key=lambda size: max(size / value, value / size))


WHOLE = 1e-6
"""Tolerance below which a difference counts as zero: in plies, or for angles in rad."""
Bounds = tuple[float, float]


@dataclass(frozen=True)
class SizeSeries:
    """A series of sizes.

    Parameters
    ----------
    name, label : name in the file and in reports
    suits, paths : variables to which it applies, in words and as a pattern of PATHs
    option : command-line option that selects the series ("file": only the file can select it)
    needs_parent : whether its sizes exist only for a known size of the variable on which they
        depend (the parent)
    """

    name: str
    label: str
    suits: str
    paths: re.Pattern[str]
    option: Literal["file", "plies", "standard"] = "file"
    needs_parent: bool = False

    def fault(self, view: FileView, path: str) -> tuple[str, str] | None:
        """Reason and remedy if the series does not apply to a variable; None if it applies."""
        return None

    def parent(self, path: str) -> str | None:
        """PATH of the parent, on which the sizes of a variable depend; None if there is none."""
        return None

    def each(self, view: FileView, path: str) -> str:
        """Noun for a single size of the series, for messages."""
        return f"{self.label} size"

    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        """The sizes of a variable, which may depend on the value of a parent variable.

        `parent` is that value; None if there is no parent variable, or if it varies continuously.
        """
        raise NotImplementedError


def along(angle: float) -> bool:
    """Whether an angle is 0 or 90 degrees, so that both plies of a balanced pair are alike."""
    return abs(math.sin(2 * angle)) <= WHOLE


def _layer(view: FileView, path: str, key: str) -> float | None:
    """Read a number of the layer to which a PATH belongs."""
    match = re.match(r"(barrel|rod)\.layup\[(\d+)\]", path)
    assert match is not None
    return view.number(match[1], "layup", int(match[2]), key)


class _Iso3320(SizeSeries):
    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        sizes = bores() if path == "cylinder.bore" else rods()
        return [size.value for size in sizes]


class _Pairs(SizeSeries):
    """Bores or rod diameters of catalogue cylinders, which exist only in certain pairs.

    Of bore and rod, one or both vary; if both vary, both must use this series.
    """

    def _other(self, path: str) -> str:
        return "cylinder.bore" if path != "cylinder.bore" else "rod.outer_diameter"

    def fault(self, view: FileView, path: str) -> tuple[str, str] | None:
        other = self._other(path)
        variable = child_at(view.tree, ("variables", other))
        if variable is None or child_at(variable, ("sizes",)) == self.name:
            return None
        message = f"{self.name} has pairs of bore and rod, but {other} does not use this series"
        return message, f'add "sizes: {self.name}" to {other} too'

    def parent(self, path: str) -> str | None:
        return "cylinder.bore" if path != "cylinder.bore" else None

    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        pairs = cylinder_pairs(self.label)
        if path != "cylinder.bore":
            return sorted(pair.rod_diameter for pair in pairs if _same(pair.bore, parent))
        if child_at(view.tree, ("variables", "rod.outer_diameter")) is None:
            rod = view.number("rod", "outer_diameter")
            pairs = tuple(pair for pair in pairs if _same(pair.rod_diameter, rod))
        return sorted({pair.bore for pair in pairs})


def _same(size: float, other: float | None) -> bool:
    return other is not None and math.isclose(size, other, rel_tol=1e-9)


class _Walls(SizeSeries):
    """Wall thicknesses of drawn steel tube, for a metal layer or a hollow rod."""

    def fault(self, view: FileView, path: str) -> tuple[str, str] | None:
        if path == "rod.inner_diameter" or _layer(view, path, "ply_thickness") is None:
            return None
        return (
            f"{self.name} lists tube walls, but this layer consists of plies",
            "write whole_plies",
        )

    def parent(self, path: str) -> str | None:
        return "rod.outer_diameter" if path == "rod.inner_diameter" else None

    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        walls = [size.value for size in tube_walls()]
        if path != "rod.inner_diameter":
            return walls
        outside = Decimal(repr(parent or 0.0))
        holes = (float(outside - 2 * Decimal(repr(wall))) for wall in reversed(walls))
        return [hole for hole in holes if hole > 0]


class _Glands(SizeSeries):
    """O-ring sections, and for each the squeeze and groove width of its gland (mid-tolerance)."""

    def _seal(self, path: str) -> tuple[str, ...]:
        return tuple(path.split(".")[:-1])

    def fault(self, view: FileView, path: str) -> tuple[str, str] | None:
        kind = TYPES.get(view.text(*self._seal(path), "type") or "")
        if kind is None or kind.o_ring_gland:
            return None
        message = f"{self.name} lists O-rings and their glands, but this seal is a {kind.name}"
        return message, "list the sizes of this seal"

    def parent(self, path: str) -> str | None:
        head, _, last = path.rpartition(".")
        return None if last == "section" else f"{head}.section"

    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        if path.endswith(".section"):
            return ring_sections()
        if parent is None:
            return []
        try:
            groove = gland(parent)
            if path.endswith(".squeeze"):
                return [1 - groove.depth / parent]
            rings = BACK_UPS.get(view.text(*self._seal(path), "back_up") or "none", 0)
            return [sum(groove.widths(rings)) / 2]
        except InputError:
            return []


class _WholePlies(SizeSeries):
    def fault(self, view: FileView, path: str) -> tuple[str, str] | None:
        if _layer(view, path, "ply_thickness") is not None:
            return None
        remedy = 'add e.g. "ply_thickness: 0.2 mm" to the layer; for a metal layer write a step'
        return "the layer has no ply_thickness", remedy

    def parent(self, path: str) -> str | None:
        return path.removesuffix("thickness") + "angle"

    def _singly(self, view: FileView, path: str, angle: float | None) -> bool:
        """Whether a layer may have an odd number of plies.

        It may if it is not balanced, or if its plies are at 0 or 90 degrees.
        """
        balanced = view.flag(*self._loc(path), "balanced")
        return balanced is False or (angle is not None and along(angle))

    def _loc(self, path: str) -> tuple[str | int, ...]:
        match = re.match(r"(barrel|rod)\.layup\[(\d+)\]", path)
        assert match is not None
        return match[1], "layup", int(match[2])

    def each(self, view: FileView, path: str) -> str:
        angle = _layer(view, path, "angle")
        pairs = "" if self._singly(view, path, angle) else "pairs of "
        ply_text = INPUTS["ply_thickness"].text(_layer(view, path, "ply_thickness") or 0.0)
        return f"whole number of {pairs}plies of {ply_text}"

    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        ply_thickness = _layer(view, path, "ply_thickness") or 0.0
        step = 1 if self._singly(view, path, parent) else 2
        counts = range(step, math.ceil(bounds[1] / ply_thickness) + 3, step)
        # in decimals: 26 plies of 0.125 mm are exactly 3.25 mm
        return [float(count * Decimal(repr(ply_thickness))) for count in counts]


class _Angles(SizeSeries):
    def fault(self, view: FileView, path: str) -> tuple[str, str] | None:
        if view.items("barrel", "allowed_angles"):
            return None
        return "the barrel has no allowed_angles", 'add e.g. "allowed_angles: [20 deg, 45 deg]"'

    def each(self, view: FileView, path: str) -> str:
        return "allowed angle"

    def values(
        self, view: FileView, path: str, parent: float | None, bounds: Bounds
    ) -> Sequence[float]:
        angles = view.items("barrel", "allowed_angles")
        return sorted({sign * angle + 0.0 for angle in angles for sign in (1, -1)})


_BORE_AND_ROD = re.compile(r"cylinder\.bore|rod\.outer_diameter")
_THICKNESS = r"(barrel|rod)\.layup\[\d+\]\.thickness"
_O_RING = re.compile(r"seals\.(piston|rod)\.(secondary\.)?(section|squeeze|groove_width)")
_BOTH = "cylinder.bore and rod.outer_diameter"
SERIES: Mapping[str, SizeSeries] = {
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
