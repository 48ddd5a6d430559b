"""Pages of materials: a list of the library, one material with its sources, and a comparison.

The properties of an oil are also shown over temperature and pressure. They are computed by the laws
that an evaluation uses by default.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..base.quantities import MATERIAL_PROPERTIES
from ..design.material import Material, Property, bulk_modulus_law, viscosity_law
from ..design.materials import Library
from ..evaluation import state
from ..models.fluid import LEAST_VISCOSITY
from ..models.oil_laws import VISCOSITY_LAWS
from ..rendering.axes import Ticks, ticks
from ..rendering.blocks import Block, Chart, Column, Notes, Table
from ..rendering.chart import Axis, Curve, Level, Panel, Points, Stretch
from ..rendering.chart_ink import titled
from ..rendering.ink import Ink
from ..rendering.text import DASH, MINUS, number, pretty, trimmed

SHOWN = {
    "metal": ("density", "youngs_modulus", "yield_strength"),
    "polymer": ("density", "youngs_modulus", "ultimate_strength"),
    "ply": ("density", "youngs_modulus_1", "strength_1_tension"),
    "fluid": ("density", "kinematic_viscosity", "bulk_modulus"),
    "seal": ("density", "hardness", "friction_coefficient"),
    "adhesive": ("density", "bond_strength", "shear_modulus"),
}
"""Properties shown in the list, by kind of material."""
_STIFFNESS = ("youngs_modulus", "youngs_modulus_1")
_STRENGTH = ("strength_1_tension", "yield_strength", "ultimate_strength")


def listing(library: Library, *, kind: str | None = None) -> list[Block]:
    """List with a material per line: main properties, count of unverified values, and label."""
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
    end = "For source, scatter and confidence of every value: actuator-opt materials show NAME"
    return [*shown, Notes("", [end], headless=True)]


def _text(material: Material, name: str) -> str:
    entry = material.properties.get(name)
    return pretty(entry.text) if entry else DASH


def blocks(material: Material) -> list[Block]:
    """A material with all its properties and numbered sources; for an oil also its chart."""
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
    """The value of a property, or the points of its table with their temperatures or pressures."""
    if not entry.points:
        return [pretty(entry.text)]
    return [pretty(f"{entry.quantity.text(y)} at {_argument(entry, x)}") for x, y in entry.points]


def _argument(entry: Property, x: float) -> str:
    return f"{x - _ZERO:.4g} degC" if entry.argument == "temperature" else f"{x / 1e5:.4g} bar"


def comparison(materials: Sequence[Material]) -> list[Block]:
    """Properties side by side; the second and later materials show their ratio to the first."""
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
    """The first of the named properties that has a value, divided by the density."""
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
"""Gauge pressures at which curves are drawn, Pa."""
AIR = (0.0, 0.005, 0.01, 0.03)
"""Contents of entrained air for which curves are drawn, as a share of volume at atmospheric
pressure."""
_LOW, _HIGH = 1e5, 350e5
_ZERO = 273.15
ROOM = 10.0
"""Extension of the temperature axis beyond the coldest and the hottest point [K]."""


@dataclass(frozen=True, slots=True)
class _Range:
    """Temperature ranges of an oil [K].

    `low` and `high` limit its service range. `coldest` and `hottest` also include the points of its
    viscosity table.
    """

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
    """Clauses on the laws by which bulk modulus and viscosity depend on pressure."""
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
        "mm²/s: kinematic viscosity; mPa·s: dynamic viscosity at 0, 200 and 350 bar; kg/m³: "
        "density at 0 and 350 bar; K: bulk modulus in MPa without air, and at 20 bar with 1 % air; "
        f"vapour: absolute vapour pressure in Pa. Laws: {laws_text(material)}."
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


def fluid_chart(material: Material) -> Chart:
    """Viscosity, bulk modulus and density of an oil over temperature and pressure."""
    over = _range(material)
    panels = [
        [_viscosity_panel(material, over), _density_panel(material, over)],
        [_air_panel(material, over), _modulus_panel(material, over)],
    ]
    title = f"{material.name}  {material.label}"
    return Chart(title, panels, "\n".join(_sources(material)), height=142.0)


def fluid_figure(material: Material) -> Ink:
    """The chart of an oil as a separate picture."""
    over = _range(material)
    words = f"{laws_text(material)}; shaded: service range {_degrees(over.low)} to "
    return titled(fluid_chart(material), [_sentence(f"{words}{_degrees(over.high)} °C")])


def _sources(material: Material) -> Iterator[str]:
    """Sources of the values of the figure, with their confidence."""
    properties: dict[str, list[str]] = {}
    for key in ("kinematic_viscosity", "pressure_viscosity", "density", "bulk_modulus"):
        entry = material.properties.get(key)
        if entry is not None:
            words = f"{entry.source} ({entry.confidence})"
            properties.setdefault(words, []).append(key.replace("_", " "))
    for words, keys in properties.items():
        yield _sentence(f"{', '.join(keys)}: {words}")


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _decades(low: float, high: float) -> list[float]:
    """The values 1, 2 and 5, times powers of ten, between two limits."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = (step * 10.0**power for power in powers for step in (1, 2, 5))
    return [step for step in steps if low <= step * (1 + 1e-9) and step <= high * (1 + 1e-9)]


def _temperatures(over: _Range) -> Array:
    return np.linspace(over.coldest, over.hottest, 121)


def _pressure(pressure: float) -> str:
    return f"{pressure / 1e5:.0f} bar"


def _viscosity_panel(material: Material, over: _Range) -> Panel:
    """Kinematic viscosity on the axes of ASTM D341, where a mineral oil is a straight line."""
    given, temperature = state.alone(material), _temperatures(over)
    viscosities = []
    for pressure in PRESSURES:
        eta = state.dynamic_viscosity(*given, temperature, pressure)
        viscosities.append(eta / state.oil_density(*given, temperature, pressure))
    every = np.concatenate(viscosities)
    low, high = float(every.min()) / 1.15, float(every.max()) * 1.3
    low, high = min(low, every[0] / 2.6), max(high, every[0] * 2.6)
    curves = [
        Curve("", np.log(temperature), _bent(viscosity), end=_pressure(pressure))
        for pressure, viscosity in zip(PRESSURES, viscosities, strict=True)
    ]
    library = Points(
        "library",
        [math.log(at) for at, _ in material.viscosity_points],
        [float(_bent(value)) for _, value in material.viscosity_points],
    )
    levels = []
    if low < LEAST_VISCOSITY:
        end = float(_bent(LEAST_VISCOSITY))
        levels.append(Level(end, "ASTM D341 ends at 2 mm²/s", style=4))
    ends = over.coldest - ROOM, over.hottest + ROOM
    degrees = [(math.log(at), words) for at, words in _degree_ticks(over)]
    marks = [(float(_bent(1e-6 * x)), trimmed(x)) for x in _decades(1e6 * low, 1e6 * high)]
    return Panel(
        "Kinematic viscosity, mm²/s",
        Axis("temperature, °C", range=(math.log(ends[0]), math.log(ends[1])), ticks=degrees),
        Axis(range=(float(_bent(low)), float(_bent(high))), ticks=marks),
        curves,
        [library],
        levels,
        stretches=[Stretch(math.log(over.low), math.log(over.high))],
    )


def _bent(viscosity: float | Array) -> Array:
    """Position of a kinematic viscosity [m²/s] on the axis of ASTM D341."""
    return np.asarray(np.log(np.log(1e6 * np.asarray(viscosity) + 0.7)))


def _degree_ticks(over: _Range) -> Ticks:
    """Temperatures [K] at round degrees Celsius."""
    ends = over.coldest - ROOM - _ZERO, over.hottest + ROOM - _ZERO
    return [(value + _ZERO, _degrees(value + _ZERO)) for value in ticks(*ends, 6)]


def _air_panel(material: Material, over: _Range) -> Panel:
    """Bulk modulus over pressure with entrained air."""
    temperature = min(max(313.15, over.low), over.high)
    pressure = np.geomspace(_LOW, _HIGH, 121)
    curves = []
    for air in AIR:
        given = state.alone(material, air_content=air)
        modulus = state.bulk_modulus(*given, temperature, pressure) / 1e6
        curves.append(Curve("", pressure / 1e5, modulus, end=f"{100 * air:g} % air"))
    stops = [(stop, trimmed(stop)) for stop in (*_decades(1.0, 200.0), 350.0)]
    return Panel(
        f"Bulk modulus with entrained air, {_degrees(temperature)} °C, MPa",
        Axis("gauge pressure, bar", log=True, ticks=stops),
        Axis(zero=True),
        curves,
    )


def _density_panel(material: Material, over: _Range) -> Panel:
    given, temperature = state.alone(material), _temperatures(over)
    densities = [state.oil_density(*given, temperature, pressure) for pressure in PRESSURES]
    return _over_temperature("Density, kg/m³", over, densities)


def _modulus_panel(material: Material, over: _Range) -> Panel:
    given, temperature = state.alone(material), _temperatures(over)
    moduli = [
        state.pure_bulk_modulus(*given, temperature, pressure) / 1e6 for pressure in PRESSURES
    ]
    return _over_temperature("Bulk modulus without air, MPa", over, moduli)


def _over_temperature(title: str, over: _Range, values: Sequence[float | Array]) -> Panel:
    """Panel with a curve over temperature for each of `PRESSURES`."""
    temperature = _temperatures(over)
    curves = [
        Curve("", temperature, own + 0 * temperature, end=_pressure(pressure))
        for pressure, own in zip(PRESSURES, values, strict=True)
    ]
    ends = over.coldest - ROOM, over.hottest + ROOM
    x = Axis("temperature, °C", range=ends, ticks=_degree_ticks(over))
    return Panel(title, x, Axis(), curves, stretches=[Stretch(over.low, over.high)])
