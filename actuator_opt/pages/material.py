"""Materials: the library as a list, an entry with its sources, entries side by side, an oil.

An oil is also shown over temperature and pressure, by the laws that an evaluation uses where a
design names none. Curves differ in dash as well as in colour and carry their own label.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ..base.quantities import MATERIAL_PROPERTIES
from ..design.material import Material, Property, bulk_modulus_law, viscosity_law
from ..design.materials import Library
from ..evaluation import state
from ..models.fluid import LEAST_VISCOSITY
from ..models.oil_laws import VISCOSITY_LAWS
from ..rendering.axes import Axes, Ticks, ticks
from ..rendering.blocks import Block, Column, Notes, Table
from ..rendering.heights import wrap
from ..rendering.ink import BLUE, GREY, PALE, RED, WHITE, Ink, spread_within, text_width
from ..rendering.text import DASH, MINUS, number, pretty, trimmed

SHOWN = {
    "metal": ("density", "youngs_modulus", "yield_strength"),
    "polymer": ("density", "youngs_modulus", "ultimate_strength"),
    "ply": ("density", "youngs_modulus_1", "strength_1_tension"),
    "fluid": ("density", "kinematic_viscosity", "bulk_modulus"),
    "seal": ("density", "hardness", "friction_coefficient"),
    "adhesive": ("density", "bond_strength", "shear_modulus"),
}
"""Properties that the list shows, by kind."""
_STIFFNESS = ("youngs_modulus", "youngs_modulus_1")
_STRENGTH = ("strength_1_tension", "yield_strength", "ultimate_strength")


def listing(library: Library, *, kind: str | None = None) -> list[Block]:
    """A material per line, by kind: main properties, share of unverified values, label."""
    shown: list[Block] = []
    for group in SHOWN if kind is None else (kind,):
        materials = [library.get(name) for name in library.names(kind=group)]
        if not materials:
            continue
        columns = [
            Column(group),
            *(Column(key.replace("_", " "), drop=k) for k, key in enumerate(SHOWN[group], 1)),
            Column("unverified", drop=4),
            Column("description", width=1.0, wraps=True, least=18),
        ]
        rows = []
        for material in materials:
            values = [_text(material, key) for key in SHOWN[group]]
            share = f"{len(material.unverified)} of {len(material.properties)}"
            rows.append((material.name, *values, share, pretty(material.label)))
        shown.append(Table("", columns, rows))
    end = "Every value has source, scatter and confidence: actuator-opt materials show NAME"
    return [*shown, Notes("", [end], headless=True)]


def _text(material: Material, name: str) -> str:
    entry = material.properties.get(name)
    return pretty(entry.text) if entry else DASH


def blocks(material: Material) -> list[Block]:
    """A material with all its properties, the sources numbered below; an oil over its range."""
    remarks = [material.label, *([material.notes] if material.notes else [])]
    if material.warning:
        remarks.append(f"WARNING: {material.warning}")
    if material.family:
        remarks.append(f"fluid family: {material.family}")
    if material.suits:
        remarks.append(f"withstands fluids: {', '.join(material.suits)}")
    columns = [
        Column("property"),
        Column("", drop=3),
        Column("value"),
        Column("scatter", drop=1),
        Column("basis", drop=2),
        Column("confidence"),
        Column("source"),
        Column("note", width=1.0, wraps=True, least=18),
    ]
    sources: dict[str, int] = {}
    rows = []
    for name, entry in material.completed().items():
        source = f"[{sources.setdefault(entry.source, len(sources) + 1)}]"
        first, *more = _values(entry)
        scatter = pretty(entry.scatter.split(";")[0].replace("+-", "±"))
        origin = (entry.basis, entry.confidence, source, pretty(entry.note))
        rows.append((name, entry.quantity.symbol, first, scatter, *origin))
        rows += [("", "", point, "", "", "", "", "") for point in more]
    numbered = [(f"[{place}]", source) for source, place in sources.items()]
    return [
        Notes(f"{material.name}  ({material.kind})", remarks),
        Table("", columns, rows),
        Table("", [Column(""), Column("", width=1.0, wraps=True, least=24)], numbered),
        *([_over_range(material)] if material.kind == "fluid" else []),
    ]


def _values(entry: Property) -> list[str]:
    """The value, or each point of a table with its argument."""
    if not entry.points:
        return [pretty(entry.text)]
    return [pretty(f"{entry.quantity.text(y)} at {_argument(entry, x)}") for x, y in entry.points]


def _argument(entry: Property, x: float) -> str:
    return f"{x - _ZERO:.4g} degC" if entry.argument == "temperature" else f"{x / 1e5:.4g} bar"


def comparison(materials: Sequence[Material]) -> list[Block]:
    """Properties side by side; from the second material on with the ratio to the first."""
    completed = [material.completed() for material in materials]
    known = {name for properties in completed for name in properties}
    rows: list[Sequence[str]] = []
    for name in (name for name in MATERIAL_PROPERTIES if name in known):
        first = completed[0].get(name)
        cells = [
            _compared(properties.get(name), first if index else None)
            for index, properties in enumerate(completed)
        ]
        rows.append((name, *cells))
    for label, keys in (("stiffness per mass", _STIFFNESS), ("strength per mass", _STRENGTH)):
        values = [_per_mass(properties, keys) for properties in completed]
        base = values[0]
        if base and all(values):
            rows.append((label, *(f"×{(value or 0.0) / base:.3g}" for value in values)))
    columns = [Column("property"), *(Column(material.name) for material in materials)]
    note = "×: ratio to the first material; *: unverified; ~: derived"
    warnings = [f"WARNING {x.name}: {x.warning}" for x in materials if x.warning]
    shown: list[Block] = [Table("", columns, rows, note=note)]
    return [*shown, Notes("", warnings, headless=True)] if warnings else shown


def _per_mass(properties: Mapping[str, Property], names: Sequence[str]) -> float | None:
    """The first of the named properties that is known, over the density."""
    for name in names:
        if name in properties and "density" in properties:
            return properties[name].value / properties["density"].value
    return None


def _compared(entry: Property | None, first: Property | None) -> str:
    if entry is None:
        return DASH
    value = pretty(entry.text) + {"unverified": "*", "derived": "~"}.get(entry.confidence, "")
    temperature = entry.quantity.dimension == "temperature"
    if first is None or first.value <= 0 or entry.value <= 0 or temperature:
        return value
    return f"{value} (×{entry.value / first.value:.3g})"


# ---- an oil over temperature and pressure ----

PRESSURES = (0.0, 200e5, 350e5)
"""Gauge pressures of the curves, Pa."""
AIR = (0.0, 0.005, 0.01, 0.03)
"""Entrained air of the curves, by volume at atmospheric pressure."""
_LOW, _HIGH = 1e5, 350e5
_STYLES: tuple[dict[str, Any], ...] = (
    {"stroke": BLUE, "pen": 0.4},
    {"stroke": "#9a6a12", "pen": 0.4, "dash": (2.2, 0.8)},
    {"stroke": "#00654a", "pen": 0.4, "dash": (2.4, 0.7, 0.4, 0.7)},
    {"stroke": GREY, "pen": 0.4, "dash": (0.5, 0.6)},
)
_SERVICE = "#e9eef2"
_WIDTH, _PANEL, _TALL, _LABELS = 180.0, 58.0, 50.0, 18.0
_ZERO = 273.15
Curves: TypeAlias = Mapping[str, tuple[Any, Any]]
"""Label of each curve, with its x and y."""


@dataclass(frozen=True, slots=True)
class _Range:
    """Temperatures (K) of an oil: its service range, and that with the points of its table."""

    low: float
    high: float
    coldest: float
    hottest: float


def _range(material: Material) -> _Range:
    stated = [t for t, _ in material.viscosity_points] or [313.15]
    low = material.numbers.get("temperature_min", stated[0])
    high = material.numbers.get("temperature_max", stated[-1])
    return _Range(low, high, min(low, stated[0]), max(high, stated[-1]))


def _degrees(temperature: float) -> str:
    return f"{temperature - _ZERO:.0f}".replace("-", MINUS)


def laws_text(material: Material) -> str:
    """The laws of an oil over pressure, in words."""
    modulus = bulk_modulus_law(None, material.numbers)
    viscosity = VISCOSITY_LAWS[viscosity_law(None, material.numbers)]
    return f"bulk modulus {modulus} in pressure; viscosity {viscosity.words}"


def _over_range(material: Material) -> Table:
    """Viscosity, density, bulk modulus and vapour pressure over the service range."""
    over = _range(material)
    inner = (
        np.arange(math.ceil((over.low - _ZERO) / 20), (over.high - _ZERO) // 20 + 1) * 20 + _ZERO
    )
    steps = [float(t) for t in inner if over.low + 3 < t < over.high - 3]
    columns = [
        Column("°C", "right"),
        Column("mm²/s", "right"),
        Column("mPa·s", "right"),
        Column("at 200 bar", "right"),
        Column("350 bar", "right", drop=6),
        Column("kg/m³", "right"),
        Column("at 350 bar", "right", drop=5),
        Column("K 1 bar", "right", drop=1),
        Column("K 200 bar", "right", drop=2),
        Column("K 1 % air", "right", drop=3),
        Column("vapour", "right", drop=4),
    ]
    rows = [_oil_row(material, t) for t in (over.low, *steps, over.high)]
    note = (
        "mm²/s and mPa·s: viscosity without pressure, then at 200 and 350 bar; K: bulk modulus "
        f"in MPa, without air, and at 20 bar with 1 % air; vapour pressure in Pa, absolute. Laws: "
        f"{laws_text(material)}."
    )
    return Table("Over the service range", columns, rows, note=note)


def _oil_row(material: Material, temperature: float) -> tuple[str, ...]:
    given = state.alone(material)
    airy = state.alone(material, air_content=0.01)
    nu = state.kinematic_viscosity(*given, temperature)
    eta = [1e3 * float(state.dynamic_viscosity(*given, temperature, p)) for p in PRESSURES]
    rho = [float(state.oil_density(*given, temperature, p)) for p in (0.0, _HIGH)]
    modulus = [float(state.pure_bulk_modulus(*given, temperature, p)) for p in (_LOW, 200e5)]
    modulus.append(float(state.bulk_modulus(*airy, temperature, 20e5)))
    vapour = state.vapour_pressure(given[2], material.name, temperature)
    return (
        _degrees(temperature),
        number(1e6 * float(nu)),
        *(number(x) for x in eta),
        *(f"{x:.1f}" for x in rho),
        *(f"{x / 1e6:.0f}" for x in modulus),
        DASH if vapour is None else number(float(vapour), 3),
    )


def fluid_figure(material: Material) -> Ink:
    """Viscosity, bulk modulus and density of an oil over temperature and pressure."""
    over = _range(material)
    notes = [line for text in _sources(material) for line in wrap(text, _WIDTH - 4, 6.0)]
    rows = 16.0, 16.0 + _TALL + 19.0
    ink = Ink(_WIDTH, rows[1] + _TALL + 17.0 + 2.8 * len(notes))
    ink.text(
        2.0, 3.0, _cut(f"{material.name}  {material.label}", 9.0, bold=True), size=9.0, bold=True
    )
    words = f"{laws_text(material)}; shaded: service range {_degrees(over.low)} to "
    words = _sentence(f"{words}{_degrees(over.high)} °C; circles: library values")
    ink.text(2.0, 7.6, words, size=6.5, color=GREY)
    columns = 12.0, 12.0 + _PANEL + _LABELS + 13.0
    _viscosity_panel(ink, (columns[0], rows[0], _PANEL, _TALL), material, over)
    _air_panel(ink, (columns[1], rows[0], _PANEL, _TALL), material, over)
    _density_panel(ink, (columns[0], rows[1], _PANEL, _TALL), material, over)
    _modulus_panel(ink, (columns[1], rows[1], _PANEL, _TALL), material, over)
    for index, line in enumerate(notes):
        y = rows[1] + _TALL + 14.0 + 2.8 * index
        ink.text(2.0, y, line, size=6.0, color=GREY)
    return ink


def _cut(text: str, size: float, *, bold: bool) -> str:
    while text_width(text, size, bold=bold) > _WIDTH - 4:
        text = text.rstrip("…")[:-1] + "…"
    return text


def _sources(material: Material) -> Iterator[str]:
    """Where the values of the figure come from, with their confidence."""
    said: dict[str, list[str]] = {}
    for key in ("kinematic_viscosity", "pressure_viscosity", "density", "bulk_modulus"):
        entry = material.properties.get(key)
        if entry is not None:
            words = f"{entry.source} ({entry.confidence})"
            said.setdefault(words, []).append(key.replace("_", " "))
    for words, keys in said.items():
        yield _sentence(f"{', '.join(keys)}: {words}")


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _frame(axes: Axes, title: str, x_label: str, x_ticks: Ticks, y_ticks: Ticks) -> None:
    """Grid and labels at stated places, for axes that are not linear."""
    ink, bottom, right = axes.ink, axes.top + axes.height, axes.left + axes.width
    for value, words in y_ticks:
        ink.line((axes.left, axes.y(value)), (right, axes.y(value)), stroke=PALE, pen=0.1)
        ink.text(axes.left - 1.4, axes.y(value), words, size=6.5, anchor="right")
    for value, words in x_ticks:
        x = axes.x(value)
        ink.line((x, axes.top), (x, bottom), stroke=PALE, pen=0.1)
        ink.line((x, bottom), (x, bottom + 1.0), pen=0.13)
        ink.text(x, bottom + 3.0, words, size=6.5, anchor="center")
    ink.line((axes.left, axes.top), (axes.left, bottom), (right, bottom), pen=0.18)
    middle = axes.left + axes.width / 2
    ink.text(middle, bottom + 7.0, x_label, size=6.5, anchor="center", color=GREY)
    ink.text(axes.left - 1.4, axes.top - 3.6, title, size=7.0, bold=True)


def _curves(axes: Axes, curves: Curves) -> None:
    """Curves with their label at the right end, spread where they come close."""
    right = axes.left + axes.width
    ends = []
    for style, (words, (xs, ys)) in zip(_STYLES, curves.items(), strict=False):
        points = [(axes.x(x), axes.y(y)) for x, y in zip(xs, ys, strict=True)]
        axes.ink.line(*points, **style)
        ends.append((points[-1], words, style))
    ends.sort(key=lambda end: end[0][1])
    places = spread_within(
        [end[0][1] for end in ends], [3.4] * len(ends), axes.top + 1.0, axes.top + axes.height - 1.0
    )
    for (end, words, style), y in zip(ends, places, strict=True):
        axes.ink.line(end, (right + 1.0, end[1]), (right + 3.0, y), pen=0.13, stroke=GREY)
        axes.ink.text(right + 3.6, y, words, size=6.5, color=style["stroke"])


def _spaced(values: Ticks, place: Any, gap: float) -> Ticks:
    """Ticks at least `gap` mm apart on paper."""
    kept: list[tuple[float, str]] = []
    for tick in values:
        if not kept or abs(place(tick[0]) - place(kept[-1][0])) >= gap:
            kept.append(tick)
    return kept


def _decades(low: float, high: float) -> list[float]:
    """1, 2, 5, 10, ... within limits."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = (step * 10.0**power for power in powers for step in (1, 2, 5))
    return [step for step in steps if low <= step * (1 + 1e-9) and step <= high * (1 + 1e-9)]


def _celsius(over: _Range) -> list[float]:
    """Round temperatures (degC) along an axis."""
    return ticks(over.coldest - 10 - _ZERO, over.hottest + 10 - _ZERO, 6)


def _shade(axes: Axes, low: float, high: float) -> None:
    left, right = axes.x(low), axes.x(high)
    axes.ink.box(left, axes.top, right - left, axes.height, fill=_SERVICE, stroke=None)


def _pressure(pressure: float) -> str:
    return f"{pressure / 1e5:.0f} bar"


def _temperatures(over: _Range) -> Any:
    return np.linspace(over.coldest, over.hottest, 121)


def _viscosity_panel(
    ink: Ink, box: tuple[float, float, float, float], material: Material, over: _Range
) -> None:
    """Kinematic viscosity on the axes of ASTM D341, where a mineral oil is a straight line."""
    given, temperature = state.alone(material), _temperatures(over)

    def bent(viscosity: Any) -> Any:
        return np.log(np.log(1e6 * np.asarray(viscosity) + 0.7))

    curves = {}
    for pressure in PRESSURES:
        eta = state.dynamic_viscosity(*given, temperature, pressure)
        nu = eta / state.oil_density(*given, temperature, pressure)
        curves[_pressure(pressure)] = (np.log(temperature), bent(nu), nu)
    found = np.concatenate([nu for _, _, nu in curves.values()])
    low, high = float(found.min()) / 1.15, float(found.max()) * 1.3
    low, high = min(low, found[0] / 2.6), max(high, found[0] * 2.6)
    ends = over.coldest - 10, over.hottest + 10
    axes = Axes(
        ink, box, (math.log(ends[0]), math.log(ends[1])), (float(bent(low)), float(bent(high)))
    )
    _shade(axes, math.log(over.low), math.log(over.high))
    levels = [(float(bent(1e-6 * x)), trimmed(x)) for x in _decades(1e6 * low, 1e6 * high)]
    degrees = [(math.log(t + _ZERO), _degrees(t + _ZERO)) for t in _celsius(over)]
    _frame(
        axes,
        "Kinematic viscosity, mm²/s",
        "temperature, °C",
        _spaced(degrees, axes.x, 6.0),
        _spaced(levels, axes.y, 3.2),
    )
    if low < LEAST_VISCOSITY:
        y = axes.y(float(bent(LEAST_VISCOSITY)))
        ink.line((box[0], y), (box[0] + box[2], y), stroke=RED, pen=0.25, dash=(1.8, 1.0))
        ink.text(box[0] + 1.5, y + 2.2, "ASTM D341 ends at 2 mm²/s", size=6.0, color=RED)
    _curves(axes, {words: (xs, ys) for words, (xs, ys, _) in curves.items()})
    for at, value in material.viscosity_points:
        x, y = axes.x(math.log(at)), axes.y(float(bent(value)))
        ink.circle(x, y, 0.8, fill=WHITE, stroke=BLUE, pen=0.25)


def _air_panel(
    ink: Ink, box: tuple[float, float, float, float], material: Material, over: _Range
) -> None:
    """Bulk modulus over pressure with entrained air."""
    temperature = min(max(313.15, over.low), over.high)
    pressure = np.geomspace(_LOW, _HIGH, 121)
    curves = {}
    for air in AIR:
        given = state.alone(material, air_content=air)
        modulus = state.bulk_modulus(*given, temperature, pressure) / 1e6
        curves[f"{100 * air:g} % air"] = (np.log(pressure), modulus)
    top = 1.06 * max(float(np.max(ys)) for _, ys in curves.values())
    axes = Axes(ink, box, (math.log(_LOW), math.log(_HIGH)), (0.0, top))
    stops = (*_decades(1.0, 200.0), 350.0)
    _frame(
        axes,
        f"Bulk modulus with air at {_degrees(temperature)} °C, MPa",
        "gauge pressure, bar",
        _spaced([(math.log(1e5 * p), trimmed(p)) for p in stops], axes.x, 4.5),
        [(x, trimmed(x)) for x in ticks(0.0, top, 6)],
    )
    _curves(axes, curves)


def _over_temperature(
    ink: Ink,
    box: tuple[float, float, float, float],
    title: str,
    over: _Range,
    curves: Curves,
) -> None:
    """Curves over temperature (degC) on linear axes."""
    found = np.concatenate([np.asarray(ys) for _, ys in curves.values()])
    low, high = float(found.min()), float(found.max())
    room = 0.06 * ((high - low) or high)
    ends = over.coldest - 10 - _ZERO, over.hottest + 10 - _ZERO
    axes = Axes(ink, box, ends, (low - room, high + room))
    _shade(axes, over.low - _ZERO, over.high - _ZERO)
    _frame(
        axes,
        title,
        "temperature, °C",
        [(t, _degrees(t + _ZERO)) for t in _celsius(over)],
        [(x, trimmed(x)) for x in ticks(low - room, high + room, 6)],
    )
    _curves(axes, curves)


def _density_panel(
    ink: Ink, box: tuple[float, float, float, float], material: Material, over: _Range
) -> None:
    given, temperature = state.alone(material), _temperatures(over)
    curves = {
        _pressure(p): (
            temperature - _ZERO,
            state.oil_density(*given, temperature, p) + 0 * temperature,
        )
        for p in PRESSURES
    }
    _over_temperature(ink, box, "Density, kg/m³", over, curves)


def _modulus_panel(
    ink: Ink, box: tuple[float, float, float, float], material: Material, over: _Range
) -> None:
    given, temperature = state.alone(material), _temperatures(over)
    curves = {}
    for p in PRESSURES:
        modulus = state.pure_bulk_modulus(*given, temperature, p) + 0 * temperature
        curves[_pressure(p)] = (temperature - _ZERO, modulus / 1e6)
    _over_temperature(ink, box, "Bulk modulus without air, MPa", over, curves)
