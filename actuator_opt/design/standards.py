"""Standard sizes as data: ISO 3320 bores and rods, ISO 6020-2/6022 pairs, O-rings and glands.

Lengths are in m, pressures in Pa. Every row states source and confidence.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from ..base import files as store
from ..base.errors import Diagnostic, InputError
from . import yaml_source

Use: TypeAlias = Literal["reciprocating", "static"]
Direction: TypeAlias = Literal["nearest", "up", "down"]

_SAME = 0.005
"""A gland row applies to sections within 0.5 % of its own; others are interpolated."""


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
    """Groove of an O-ring; depth is the radial space of the ring, including rod or bore.

    A table without tolerances gives equal limits and no radii (0). `back_up_widths` are the
    smallest and largest width with one and with two back-up rings; empty if not tabulated.
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
        InputError : not tabulated for this number
        """
        known = ((self.width_min, self.width_max), *self.back_up_widths)
        if not 0 <= back_up_rings < len(known):
            message = f"no width with {back_up_rings} back-up rings in the {self.table} table"
            raise InputError(Diagnostic(message, f"it has widths for 0 to {len(known) - 1}"))
        return known[back_up_rings]

    @property
    def squeeze(self) -> float:
        """Nominal squeeze over section."""
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


@functools.lru_cache(maxsize=1)
def tables() -> Mapping[str, Any]:
    """Contents of ``standards.yaml``, numbers as text."""
    path = store.data_folder("materials") / "standards.yaml"
    text = yaml_source.decode(path.read_bytes(), str(path))
    document = yaml_source.parse(text, str(path))
    if document.faults:
        raise InputError(document.faults)
    return document.data


def metres(text: str) -> float:
    """Length in m from a decimal number in mm, exactly rounded."""
    return float(f"{text}e-3")


def citation(key: str) -> str:
    """Source of a key of the tables."""
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
    """Bore and rod pairs of ISO 6020-2 (160 bar) and ISO 6022 (250 bar), or of a named series."""
    return tuple(
        CylinderPair(
            group["series"], metres(bore), metres(rod),
            float(group["pressure_bar"]) * 1e5, group["confidence"], citation(group["source"]),
        )
        for group in tables()["cylinder_pairs"]
        if series in (None, group["series"])
        for bore, rod in group["rows"]
    )  # fmt: skip


@functools.cache
def o_rings() -> tuple[ORing, ...]:
    """GB/T 3452.1 series G rings, by section, then inside diameter, m."""
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
    """Tolerance (both ways, m) of a ring's free section, m: ISO 3601-1, else that of its band.

    Raises
    ------
    InputError : the section is thicker than the bands
    """
    own, bands = tables()["section_tolerances"], tables()["section_tolerance_bands"]
    for size, tolerance in own["rows"]:
        if abs(metres(size) - section) <= _SAME * section:
            return StandardSize(metres(tolerance), own["confidence"], citation(own["source"]))
    for size, tolerance in bands["rows"]:
        if section <= metres(size) * (1 + 1e-9):
            return StandardSize(metres(tolerance), bands["confidence"], citation(bands["source"]))
    message = f"no tolerance for a section of {section * 1e3:.4g} mm"
    raise InputError(Diagnostic(message, "the bands end at 8.4 mm"))


@functools.cache
def glands(use: Use, table: str | None = None) -> tuple[Gland, ...]:
    """Tabulated glands of an application, ascending by section.

    From the table ``as568``, ``metric`` or ``series_g`` (moving hydraulic seals only); by default
    from the first two.
    """
    found: list[Gland] = []
    for name in ("as568", "metric") if table is None else (table,):
        data = tables()[f"glands_{name}"]
        wide = tables().get(f"back_up_{name}")
        back_up = wide["rows"] if wide else ()
        confidence, source = data["confidence"], citation(data["source"])
        if wide and wide["source"] != data["source"]:
            source += f"; with back-up rings: {citation(wide['source'])}"
        for row in data.get(use, ()):
            numbers = [metres(text) for text in row]
            if name == "metric":
                section, depth, width = numbers
                numbers = [section, 0.0, depth, depth, width, width, 0.0, 0.0]
            w, tolerance, d0, d1, g0, g1, r0, r1 = numbers
            wider = [list(map(metres, other[1:])) for other in back_up if other[0] == row[0]]
            pairs = tuple((other[i], other[i + 1]) for other in wider for i in (0, 2))
            found.append(
                Gland(use, name, w, tolerance, d0, d1, g0, g1, r0, r1,
                      False, confidence, source, pairs)
            )  # fmt: skip
    return tuple(sorted(found, key=lambda gland: (gland.section, gland.table)))


def o_ring_sections(table: str | None = None) -> tuple[float, ...]:
    """Free sections with a tabulated reciprocating gland, ascending, m."""
    return tuple(sorted({gland.section for gland in glands("reciprocating", table)}))


def gland(section: float, use: Use = "reciprocating", *, table: str | None = None) -> Gland:
    """Gland of a section: tabulated, else interpolated between neighbours.

    Parameters
    ----------
    section : free section, m
    use : ``reciprocating`` or ``static``
    table : ``as568``, ``metric`` or ``series_g``; default: AS568 for AS568 sections, else metric

    Raises
    ------
    InputError : section outside the tables, or no glands for this use
    """
    if table is not None and not glands(use, table):
        message = f"the {table} table has no {use} glands"
        raise InputError(Diagnostic(message, "use the default table"))
    for rows in (glands(use, table or "as568"), glands(use, table or "metric")):
        nearest = min(rows, key=lambda row: abs(row.section - section))
        if abs(nearest.section - section) <= _SAME * nearest.section:
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
        one, two = getattr(first, name), getattr(second, name)
        return float(one + share * (two - one))

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
    """The standard size next to a value, m.

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
        message = f"no standard {kind} {direction} of {value * 1e3:.4g} mm"
        raise InputError(Diagnostic(message, "choose another size or direction"))
    return min(sizes, key=lambda size: max(size / value, value / size))
