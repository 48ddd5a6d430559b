"""An oil of the library over temperature and pressure: a table for the terminal, a figure as file.

The laws are the ones an evaluation uses where a design names none. Curves differ in dash as well
as in colour and carry their own label.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from ..design.material import Material
from ..design.material_laws import bulk_modulus_law, viscosity_law
from ..evaluation import oil
from ..models.fluid import LEAST_VISCOSITY
from ..models.oil_laws import VISCOSITY_LAWS
from ..rendering.axes import Axes, ticks
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..rendering.heights import wrap
from ..rendering.image import write_ink
from ..rendering.ink import BLUE, GREY, PALE, RED, WHITE, Ink, spread_within, text_width
from ..rendering.text import MINUS, number, trimmed

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
Ticks: TypeAlias = Sequence[tuple[float, str]]
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


def table_lines(material: Material, *, colour: bool, unicode: bool, width: int) -> list[str]:
    """Viscosity, density, bulk modulus and vapour pressure over the service range."""
    console = Console(colour, unicode, width)
    over = _range(material)
    inner = (
        np.arange(math.ceil((over.low - _ZERO) / 20), (over.high - _ZERO) // 20 + 1) * 20 + _ZERO
    )
    steps = [float(t) for t in inner if over.low + 3 < t < over.high - 3]
    columns = [
        Column(head, "right")
        for head in (
            "degC", "mm²/s", "mPa·s", "at 200 bar", "350 bar", "kg/m³", "at 350 bar",
            "K 1 bar", "K 200 bar", "air 1 %, 20 bar", "vapour",
        )
    ]  # fmt: skip
    rows = [_row(material, t) for t in (over.low, *steps, over.high)]
    lines = [
        console.heading("Over the service range"),
        *console.table(columns, rows),
        console.wrap(
            "mm²/s and mPa·s: viscosity without pressure, then at 200 and 350 bar; K: bulk modulus "
            f"in MPa, without air but where stated; vapour pressure in Pa, absolute. Laws: "
            f"{laws_text(material)}."
        ),
    ]
    return [line for part in lines for line in part.split("\n")]


def _row(material: Material, temperature: float) -> list[str]:
    given = oil.alone(material)
    airy = oil.alone(material, air_content=0.01)
    nu = oil.kinematic_viscosity(*given, temperature)
    eta = [1e3 * float(oil.dynamic_viscosity(*given, temperature, p)) for p in PRESSURES]
    rho = [float(oil.density(*given, temperature, p)) for p in (0.0, _HIGH)]
    modulus = [float(oil.pure_bulk_modulus(*given, temperature, p)) for p in (_LOW, 200e5)]
    modulus.append(float(oil.bulk_modulus(*airy, temperature, 20e5)))
    vapour = oil.vapour_pressure(given[2], material.name, temperature)
    return [
        _degrees(temperature),
        number(1e6 * float(nu)),
        *(number(x) for x in eta),
        *(f"{x:.1f}" for x in rho),
        *(f"{x / 1e6:.0f}" for x in modulus),
        "–" if vapour is None else number(float(vapour), 3),
    ]


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
    given, temperature = oil.alone(material), _temperatures(over)

    def bent(viscosity: Any) -> Any:
        return np.log(np.log(1e6 * np.asarray(viscosity) + 0.7))

    curves = {}
    for pressure in PRESSURES:
        eta = oil.dynamic_viscosity(*given, temperature, pressure)
        nu = eta / oil.density(*given, temperature, pressure)
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
        given = oil.alone(material, air_content=air)
        modulus = oil.bulk_modulus(*given, temperature, pressure) / 1e6
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
    given, temperature = oil.alone(material), _temperatures(over)
    curves = {
        _pressure(p): (temperature - _ZERO, oil.density(*given, temperature, p) + 0 * temperature)
        for p in PRESSURES
    }
    _over_temperature(ink, box, "Density, kg/m³", over, curves)


def _modulus_panel(
    ink: Ink, box: tuple[float, float, float, float], material: Material, over: _Range
) -> None:
    given, temperature = oil.alone(material), _temperatures(over)
    curves = {}
    for p in PRESSURES:
        modulus = oil.pure_bulk_modulus(*given, temperature, p) + 0 * temperature
        curves[_pressure(p)] = (temperature - _ZERO, modulus / 1e6)
    _over_temperature(ink, box, "Bulk modulus without air, MPa", over, curves)


def write_figure(material: Material, folder: Path) -> list[Path]:
    """Write NAME.png and NAME.svg into a folder, whole or not at all."""
    return write_ink(fluid_figure(material), folder, material.name)
