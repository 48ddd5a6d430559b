"""At which supply pressure a robot's knee is lightest, with its line and the oil in both.

The bonded knee is re-optimised at every pressure for the least of what it makes the robot
carry: the actuator, a pressure and a return pipe, and the oil that fills all of it. Loads, speeds
and every requirement stay as they are; ring sections and clearances are free, so that the seals are
those that the pressure asks for. What binds where says why the minimum lies where it does.

    python designs/scripts/knee_pressure.py                  # prints the tables
    python designs/scripts/knee_pressure.py --out reports    # and writes the report there
    python designs/scripts/knee_pressure.py --quick          # few pressures
    actuator-opt evaluate designs/knee_bonded.yaml --plugin designs/scripts/knee_pressure.py
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from math import ceil, pi
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.base.numeric import maximum, sqrt
from actuator_opt.base.tables import aligned
from actuator_opt.models.accumulator import usable_volume
from actuator_opt.models.gland import gap_limit
from actuator_opt.models.lines import line_pressure_drop, line_volume
from actuator_opt.models.mass import oil_mass, tube_mass
from actuator_opt.rendering.axes import AREAS, Axes
from actuator_opt.rendering.blocks import Drawing
from actuator_opt.rendering.ink import BLACK, BLUE, GREY, RED, WHITE, Ink, spread_within
from actuator_opt.rendering.script_pages import (
    Sheets,
    grid_table,
    rounded,
    run_script,
    study_report,
)
from actuator_opt.rendering.text import fixed, number

Data = dict[str, Any]

DESIGN = Path(__file__).resolve().parents[1] / "knee_bonded.yaml"
BAR = 1e5
PRESSURES = (60, 75, 90, 105, 120, 140, 160, 185, 210, 240, 275, 310, 350)
QUICK = (90, 210)
"""Supply pressures [bar]."""
SHIPPED = 210
"""Where every walk along the pressures begins [bar]: that of the knee as shipped."""
PARKER = "Parker, Sizing tube to maximize hydraulic system efficiency (tables 1 to 4)"
ASSUMED: dict[str, tuple[float, str, str]] = {
    "length": (0.8, "m", "own choice: torso to knee of a humanoid, each of both pipes"),
    "pressure_velocity": (6.0, "m/s", "the project's check of lines; Parker allows 7.62 m/s"),
    "return_velocity": (3.05, "m/s", PARKER),
    "design_factor": (4.0, "", PARKER + ": Lamé, severity A, over the ultimate strength"),
    "least_wall": (0.51e-3, "m", "Parker catalogue 4300, table T6: 0.020 in, 1/4 in tube"),
    "return_rating": (50e5, "Pa", "own choice: ten times the return pressure, for surges"),
    "port": (6e-3, "m", "knee_bonded.yaml; it grows with the flow below its 210 bar"),
    "sag": (0.1, "", "own choice: what the pressure may fall by as the accumulator gives"),
    "precharge": (0.9, "", "common practice: gas over the lowest working pressure"),
}
"""What the study takes for granted: value [SI], unit, source."""
PIPE, SHELL = "steel_316l", "steel_42crmo4"
"""Library metals of both pipes and of the accumulator's shell."""
LENGTHS = (0.0, 0.4, 0.8, 1.6, 3.2)
"""Other lengths of the pipes whose best pressure is sought [m]."""
FREED = {
    "seals.piston.section": ("1 mm", "3.53 mm"),
    "seals.rod.section": ("1 mm", "3.53 mm"),
    "piston.clearance": ("15 um", "60 um"),
    "head.clearance": ("15 um", "30 um"),
}
"""Glands: from the smallest ring that gland tables know to the third AS568 one. Clearance of the
head: at most the knee's, twice which (rod pushed aside) its back-up ring bears at 350 bar."""
WIDER = {
    "cylinder.bore": ("16 mm", "60 mm"),
    "barrel.layup[0].thickness": ("0.4 mm", "6 mm"),
    "barrel.layup[1].thickness": ("0.2 mm", "8 mm"),
    "caps.thickness": ("2 mm", "25 mm"),
    "retention.wall": ("1 mm", "10 mm"),
    "retention.length": ("5 mm", "60 mm"),
}
"""Bounds that stand in nobody's way between 60 and 350 bar."""
PROOF = ("1.5", "5")
"""Proof over supply pressure: 1.5 as shipped, more where oil warming behind a shut valve asks."""
BACK_UP = ("back_up", "back_up_material", "back_up_thickness")
PLACES = ("piston", "rod")
METRICS = (
    "mass", "line_mass", "oil_carried", "carried_mass", "friction_running", "stiffness_min",
    "seal_gap", "extrusion_factor", "bore_growth", "port_velocity",
)  # fmt: skip
PARTS = {"mass": "actuator", "line_mass": "pipes", "oil_carried": "oil"}
LIMITS = {
    "force[stance]": "stance force",
    "force[swing]": "swing force",
    "stiffness_min": "stiffness",
    "friction_running": "running friction",
    "seal_gap": "seal gap",
    "seal_squeeze": "squeeze, least",
    "seal_squeeze_max": "squeeze, most",
    "buckling_factor": "buckling",
    "burst_factor": "burst",
    "proof_factor": "proof pressure",
    "extrusion of the seals": "seal extrusion",
    "bonds over the temperature range": "bond, warm",
    "trapped-fluid pressure": "trapped oil",
    "cap retention": "cap retention",
    "clearance over the temperature range": "clearance, hot",
    "end plate bending": "end plate",
    "bearing overlap": "bearing overlap",
}
"""Requirements and checks by the start of their label; walls and bounds are in the numbers. The
damping ratio (not below 0) is left out: by coefficient it is 0 but for the oil's share, 1e-6: it
counts as binding without moving anything."""


# ---- what a robot carries beside the actuator ----


def assumed(name: str) -> float:
    """A number that the study takes for granted, SI."""
    return ASSUMED[name][0]


@cache
def _metal(name: str) -> tuple[float, float]:
    """Density and ultimate strength of a library metal."""
    numbers = ao.load_library().get(name).numbers
    return numbers["density"], numbers["ultimate_strength"]


@cache
def _oil() -> tuple[float, float]:
    """Density and dynamic viscosity of the knee's oil, at its temperature and no pressure."""
    knee = ao.read(DESIGN).design
    numbers = ao.load_library().get(knee.fluid.material).numbers
    density = numbers["density"]
    return density, density * ao.evaluate(knee).metrics["oil_viscosity"].value


def areas(design: Any) -> tuple[Any, Any]:
    """Areas of head and rod side."""
    bore, rod = design["cylinder.bore"], design["rod.outer_diameter"]
    return pi / 4 * bore**2, pi / 4 * (bore**2 - rod**2)


def flows(design: Any) -> tuple[Any, Any]:
    """Largest flow from the supply and back to it, over both load cases."""
    head, ring = areas(design)
    push, pull = (design[f"load_cases[{case}].speed"] for case in ("stance", "swing"))
    return maximum(push * head, pull * ring), maximum(push * ring, pull * head)


def pipe(flow: Any, velocity: float, pressure: Any) -> tuple[Any, Any]:
    """Bore by velocity, outer diameter by Lamé against a share of the ultimate strength.

    p = S (D² − d²)/(D² + d²), so that D = d √((S + p)/(S − p)), and no thinner than can be bought.
    """
    inner = sqrt(4 / pi * flow / velocity)
    allowed = _metal(PIPE)[1] / assumed("design_factor")
    outer = inner * sqrt((allowed + pressure) / (allowed - pressure))
    return inner, maximum(outer, inner + 2 * assumed("least_wall"))


def pipes(design: Any) -> list[tuple[Any, Any]]:
    """Bore and outer diameter of the pressure and the return pipe."""
    supplied, returned = flows(design)
    return [
        pipe(supplied, assumed("pressure_velocity"), design["supply.pressure"]),
        pipe(returned, assumed("return_velocity"), assumed("return_rating")),
    ]


def held(design: Any) -> Any:
    """Oil in the actuator where it holds most: extended, and both dead volumes."""
    dead = sum(design[f"cylinder.dead_volume_{side}"] for side in "ab")
    return areas(design)[0] * design["cylinder.stroke"] + dead


def carried(length: float) -> list[Callable[[Any], Any]]:
    """The metrics of what is carried, for pipes of a length."""

    @ao.metric("line_mass", dimension="mass", unit_name="g", label="mass of both pipes")
    def line_mass(design: Any) -> Any:
        """Two steel tubes, straight, without fittings."""
        tubes = pipes(design)
        return sum(
            tube_mass(
                density=_metal(PIPE)[0], inner_diameter=inner, outer_diameter=outer, length=length
            )
            for inner, outer in tubes
        )

    @ao.metric("oil_carried", dimension="mass", unit_name="g", label="oil of actuator and pipes")
    def oil_carried(design: Any) -> Any:
        """Oil that fills the extended actuator and both pipes."""
        inside = sum(line_volume(inner_diameter=d, length=length) for d, _ in pipes(design))
        return oil_mass(density=_oil()[0], volume=held(design) + inside)

    @ao.metric("carried_mass", dimension="mass", unit_name="g", label="actuator, pipes and oil")
    def carried_mass(design: Any) -> Any:
        """What the robot carries for this joint; its share of pump and valve left out."""
        return design.metric("mass") + line_mass(design) + oil_carried(design)

    return [line_mass, oil_carried, carried_mass]


line_mass, oil_carried, carried_mass = carried(assumed("length"))


def accumulator_mass(pressure: float, volume: float) -> float:
    """Shell of an accumulator that gives a volume of oil while the pressure sags, as a sphere.

    m = 3/2 ρ p V₀ over the allowed stress, V₀ from the gas (isothermal filled, adiabatic emptied).
    """
    low = (1 - assumed("sag")) * pressure
    given = usable_volume(
        low_pressure=low,
        high_pressure=pressure,
        precharge_pressure=assumed("precharge") * low,
        gas_volume=1.0,
    )
    density, strength = _metal(SHELL)
    allowed = strength / assumed("design_factor")
    return 1.5 * density * pressure * volume / float(given) / allowed


# ---- optima ----


def wishes(
    *,
    free: bool = True,
    bare: bool = False,
    still: bool = False,
    length: float | None = None,
    open_to: str = "",
) -> ao.Actuator:
    """The knee that is to be light with all it needs.

    `free` glands or those of the knee; `bare`: no back-up rings; `still`: nothing moves;
    `open_to`: the supply pressure itself is free up to it.
    """
    data = yaml.load(DESIGN.read_text("utf-8"), Loader=yaml.BaseLoader)
    variables = WIDER | {"supply.proof_ratio": PROOF} | (FREED if free else {})
    if open_to:
        variables = variables | {"supply.pressure": (f"{min(PRESSURES)} bar", open_to)}
    for path, (lower, upper) in variables.items():
        data["variables"][path] = {"lower": lower, "upper": upper}
    data["supply"]["proof_ratio"] = PROOF[0]
    for name in PLACES if bare else ():
        for key in BACK_UP:
            del data["seals"][name][key]
    if still:
        del data["variables"]
    data["objective"] = {"minimise": "carried_mass"}
    plugins = carried(assumed("length") if length is None else length)
    return ao.read(yaml.safe_dump(data, sort_keys=False), plugins=plugins)


def at(pressure: float) -> Data:
    """What a pressure sets: the supply, and ports that grow as the flow of the same power."""
    shipped = SHIPPED * BAR
    port = assumed("port") * max(1.0, (shipped / pressure) ** 0.5)
    return {"supply.pressure": pressure, "cylinder.port_diameter": port}


def walk(knee: ao.Actuator, pressures: Sequence[float], start: Data | None = None) -> list[Data]:
    """Optima along pressures, each from its neighbour's dimensions, until one cannot be met."""
    rows: list[Data] = []
    for bar in pressures:
        found = ao.optimise(knee.changed((start or {}) | at(bar * BAR)), starts=1, prices=False)
        rows.append(measured(found))
        if found.infeasibility is not None:
            break
        start = rows[-1]["values"]
    return rows


def measured(found: Any) -> Data:
    """The numbers of an optimum, SI."""
    evaluation, design = found.evaluation, found.design
    values = {v.path: v.value for v in found.variables}
    row = {
        "pressure": design.supply.pressure,
        "status": found.status,
        "values": values,
        "binds": [] if found.kkt is None else sorted(set(found.kkt.active)),
        "metrics": {name: evaluation.metrics[name].value for name in METRICS},
        "parts": dict(evaluation.mass_parts),
        "wall": sum(layer.thickness for layer in design.barrel.layup),
        "doubts": [
            one for one in evaluation.warnings if one.startswith(("piston seal", "rod seal"))
        ],
    }
    if found.infeasibility is not None:
        row["lacks"] = [
            {key: one[key] for key in ("metric", "limit", "needed")}
            for one in found.infeasibility.joint
        ]
        return row
    numbers = _numbers(design)
    gap = max(
        evaluation.metrics["seal_gap"].value + design.piston.clearance, 2 * design.head.clearance
    )
    (inner, outer), (back, _) = pipes(numbers)
    head, ring = areas(numbers)
    return row | {
        "pipes": [inner, outer, back],
        "drop": _drop(numbers, inner, back) / design.supply.pressure,
        "backed": backed(design, gap),
        "accumulator": accumulator_mass(
            design.supply.pressure, max(head, ring) * design.cylinder.stroke
        ),
    }


def _numbers(design: Any) -> Data:
    """The numbers of a design that pipes and oil hang on, by PATH."""
    cylinder = design.cylinder
    return {
        "cylinder.bore": cylinder.bore,
        "cylinder.stroke": cylinder.stroke,
        "rod.outer_diameter": design.rod.outer_diameter,
        "supply.pressure": design.supply.pressure,
    } | {f"load_cases[{case.name}].speed": case.speed for case in design.load_cases}


def backed(design: Any, gap: float) -> float:
    """What gap the back-up rings alone bear, over the largest there is (pushed to one side)."""
    known = ao.load_library().get(design.seals.rod.back_up_material).properties["extrusion_gap_max"]
    points = tuple(zip(known.arguments, known.values, strict=True))
    return float(gap_limit(pressure=design.supply.pressure, points=points)) / gap


def _drop(numbers: Data, inner: float, back: float) -> float:
    """Pressure lost in both pipes at the largest flows."""
    density, viscosity = _oil()
    return sum(
        float(
            line_pressure_drop(
                flow=flow,
                inner_diameter=bore,
                length=assumed("length"),
                density=density,
                dynamic_viscosity=viscosity,
            )
        )
        for flow, bore in zip(flows(numbers), (inner, back), strict=True)
    )


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    pressures = QUICK if quick else PRESSURES
    rows, shipped = (both_ways(wishes(free=free), pressures) for free in (True, False))
    bare = wishes(bare=True, still=True)
    for row in rows:
        alone = ao.evaluate(bare.changed(row["values"] | at(row["pressure"])))
        row["unbacked"] = [one for one in alone.warnings if "back-up" in one]
    lightest = min((one for one in rows if met(one)), key=total)
    lengths = (assumed("length"),) if quick else LENGTHS
    best = {str(length): anywhere(length, lightest) for length in lengths}
    return rounded(
        {
            "version": ao.__version__,
            "rows": rows,
            "shipped": shipped,
            "best": best[str(assumed("length"))],
            "lengths": best,
        }
    )


def both_ways(knee: ao.Actuator, pressures: Sequence[float]) -> list[Data]:
    """Optima over all pressures, walked up and down from that of the knee as shipped."""
    up = walk(knee, [bar for bar in pressures if bar >= SHIPPED])
    down = walk(knee, [bar for bar in reversed(pressures) if bar < SHIPPED], up[0]["values"])
    return [*reversed(down), *up]


def anywhere(length: float, start: Data) -> Data:
    """The optimum with the supply pressure free as well, for pipes of a length."""
    knee = wishes(length=length, open_to=f"{max(PRESSURES)} bar")
    knee = knee.changed(start["values"] | at(start["pressure"]))
    return measured(ao.optimise(knee, starts=1, prices=False))


def met(row: Data) -> bool:
    """Whether a design meets everything at that pressure."""
    return "lacks" not in row


def total(row: Data) -> float:
    """What is carried, kg."""
    return float(row["metrics"]["carried_mass"])


def bar(row: Data) -> float:
    """The pressure of a row, bar."""
    return float(row["pressure"]) / BAR


# ---- what it says ----


def binding(row: Data) -> list[str]:
    """The requirements and checks that bind, by their names on the page."""
    found = (
        name
        for start, name in LIMITS.items()
        if any(label == start or label.startswith(f"{start} (") for label in row["binds"])
    )
    return list(dict.fromkeys(found))


def changing(rows: Sequence[Data]) -> dict[str, list[bool]]:
    """By limit, where it binds; those alike at every pressure left out."""
    every = [binding(row) for row in rows]
    names = [name for name in LIMITS.values() if 0 < sum(name in one for one in every) < len(rows)]
    return {name: [name in one for one in every] for name in names}


def always(rows: Sequence[Data]) -> list[str]:
    """What binds at every pressure."""
    first, *rest = (binding(row) for row in rows)
    return [name for name in first if all(name in one for one in rest)]


def span(rows: Sequence[Data], name: str) -> str:
    """Between which pressures a limit binds, in words; empty where it never does."""
    found = [bar(row) for row in rows if name in binding(row)]
    ends = [fixed(end, 0) for end in (min(found), max(found))] if found else []
    return "" if not found else ends[0] + " bar" if len(found) == 1 else " to ".join(ends) + " bar"


def parts_of(row: Data) -> list[float]:
    """Actuator, pipes and oil, g."""
    return [1e3 * row["metrics"][name] for name in PARTS]


def lead(study: Data) -> list[str]:
    """What the study says, in sentences."""
    rows, best = [row for row in study["rows"] if met(row)], study["best"]
    low, high = rows[0], rows[-1]
    shipped = next(row for row in rows if round(bar(row)) == SHIPPED)
    split = ", ".join(
        f"{name} {fixed(size, 0)} g"
        for name, size in zip(PARTS.values(), parts_of(best), strict=True)
    )
    said = [
        f"With two pipes of {number(assumed('length'), 2)} m the knee and all it carries are"
        f" lightest at {fixed(bar(best), 0)} bar: {fixed(1e3 * total(best), 0)} g ({split}). At"
        f" {SHIPPED} bar it carries {fixed(1e3 * (total(shipped) - total(best)), 0)} g more, at"
        f" {fixed(bar(low), 0)} bar {fixed(1e3 * (total(low) - total(best)), 0)} g, at"
        f" {fixed(bar(high), 0)} bar {fixed(1e3 * (total(high) - total(best)), 0)} g.",
        below(rows, low, best) + above(rows, low, best, high),
    ]
    if len(study["lengths"]) > 1:
        moved = ", ".join(
            f"{fixed(bar(row), 0)} bar with {number(float(length), 2)} m"
            for length, row in study["lengths"].items()
        )
        said.append(
            f"The longer the pipes the higher the best pressure: {moved} (with 0 m the actuator"
            " and its own oil alone)."
        )
    return [*said, seals(study)]


def bore(row: Data) -> float:
    """Bore of a row, mm."""
    return 1e3 * float(row["values"]["cylinder.bore"])


def below(rows: Sequence[Data], low: Data, best: Data) -> str:
    """Why more pressure pays below the best."""
    pay = [b - a for a, b in zip(parts_of(best), parts_of(low), strict=True)]
    where = f"binds at {span(rows, 'stance force') or 'no pressure'}"
    return (
        f"Below, the stance force sets the bore ({where}; {fixed(bore(low), 1)} mm"
        f" at {fixed(bar(low), 0)} bar,"
        f" {fixed(bore(best), 1)} mm at the best): oil and flow go with its area, so that down to"
        f" {fixed(bar(low), 0)} bar the oil adds {fixed(pay[2], 0)} g, the pipes"
        f" {fixed(pay[1], 0)} g and the actuator {fixed(pay[0], 0)} g. "
    )


def above(rows: Sequence[Data], low: Data, best: Data, high: Data) -> str:
    """Why more pressure costs above the best."""
    stiff, rubs = span(rows, "stiffness"), span(rows, "running friction")
    grown = {name: 1e3 * (high["parts"][name] - best["parts"][name]) for name in high["parts"]}
    most = sorted(grown, key=lambda name: -grown[name])[:3]
    parts = ", ".join(f"{name} {fixed(grown[name], 0)} g" for name in most)
    allowed = bore(low) * (low["pressure"] / high["pressure"]) ** 0.5
    return (
        f"Above, the oil's stiffness (binds at {stiff}) keeps the bore: it asks for area, whatever"
        f" the pressure. The force alone would let it go to some {fixed(allowed, 0)} mm at"
        f" {fixed(bar(high), 0)} bar, it stays at {fixed(bore(high), 1)} mm; oil and pipes then"
        f" weigh {fixed(sum(parts_of(high)[1:]), 0)} instead of"
        f" {fixed(sum(parts_of(best)[1:]), 0)} g,"
        " while walls and ends of that bore bear more pressure and the stalled rod must not buckle"
        f" under it (what grows most: {parts}), and friction (binds at"
        f" {rubs or 'no pressure'}) asks for thinner rings and a smaller growth of the bore."
    )


def seals(study: Data) -> str:
    """What the glands bear."""
    rows, shipped = study["rows"], study["shipped"]
    bare = [bar(row) for row in rows if row["unbacked"]]
    doubted = [bar(row) for row in rows if row["doubts"]]
    loose = [bar(row) for row in rows if met(row) and row["backed"] < 1]
    lacking = next((row for row in shipped if not met(row)), None)
    said = "Seals:"
    if lacking is not None:
        missed = ", ".join(row["metric"].replace("_", " ") for row in lacking["lacks"])
        said += (
            f" with the glands as shipped (1.78 mm, 30 µm) nothing meets {fixed(bar(lacking), 0)}"
            f" bar ({missed}); with free ones"
        )
    last = [row for row in rows if met(row)]
    said += f" every pressure up to {fixed(bar(last[-1]), 0)} bar is met."
    if bare:
        said += (
            f" From {fixed(min(bare), 0)} bar on the compound does not bear the pressure without"
            " the back-up rings that every design here has."
        )
    if loose:
        said += (
            f" At {fixed(min(loose), 0)} to {fixed(max(loose), 0)} bar the back-up rings do not"
            " bear the gap either."
        )
    elif bare:
        said += " Those bear the gap at every pressure, by their own table."
    if doubted:
        said += (
            f" From {fixed(min(doubted), 0)} bar on the law of the contact load is used beyond the"
            " pressures it was compared with: masses there are indications."
        )
    return said


def mass_rows(study: Data) -> list[list[str]]:
    """Heads and rows: what is carried at each pressure, and the best one."""
    heads = ["bar", "carried, g", "actuator, g", "pipes, g", "oil, g", "shipped glands, g"]
    sizes = ["bore, mm", "rod, mm", "wall, mm", "rings, mm", "pipes, mm", "lost in pipes, %"]
    rows = [[*heads, *sizes, "accumulator, g"]]
    shipped = {row["pressure"]: row for row in study["shipped"] if met(row)}
    found = sorted([*study["rows"], study["best"]], key=bar)
    for row in found:
        v, other = row["values"], shipped.get(row["pressure"])
        if not met(row):
            missed = ", ".join(one["metric"] for one in row["lacks"])
            rows.append([fixed(bar(row), 0), f"misses {missed}", *[""] * (len(rows[0]) - 2)])
            continue
        rows.append(
            [
                fixed(bar(row), 0) + (" best" if row is study["best"] else ""),
                fixed(1e3 * total(row), 1),
                *(fixed(size, 1) for size in parts_of(row)),
                "" if other is None else fixed(1e3 * total(other), 1),
                fixed(bore(row), 2),
                fixed(1e3 * v["rod.outer_diameter"], 2),
                fixed(1e3 * row["wall"], 2),
                " / ".join(fixed(1e3 * v[f"seals.{name}.section"], 2) for name in PLACES),
                " / ".join(fixed(1e3 * row["pipes"][k], 1) for k in (0, 2)),
                fixed(100 * row["drop"], 2),
                fixed(1e3 * row["accumulator"], 0),
            ]
        )
    return rows


def need_rows(study: Data) -> list[list[str]]:
    """Heads and rows: how the requirements stand at each pressure, and what binds."""
    heads = [
        "bar",
        "friction, N",
        "stiffness, kN/mm",
        "gap, µm",
        "extrusion",
        "back-ups",
        "what binds",
    ]
    rows, base = [heads], [row for row in study["rows"] if met(row)]
    usual = always(base)
    for row in base:
        m = row["metrics"]
        rows.append(
            [
                fixed(bar(row), 0),
                fixed(m["friction_running"], 0),
                fixed(1e-6 * m["stiffness_min"], 2),
                fixed(1e6 * m["seal_gap"], 1),
                fixed(m["extrusion_factor"], 2),
                fixed(row["backed"], 2),
                ", ".join(name for name in binding(row) if name not in usual),
            ]
        )
    return rows


def assumed_rows() -> list[list[str]]:
    """Heads and rows: what the study takes for granted."""
    scales = {"m": (1e3, "mm"), "Pa": (1e-5, "bar")}
    rows = [["assumed", "value", "unit", "source"]]
    for name, (value, unit, source) in ASSUMED.items():
        factor, shown = scales.get(unit, (1.0, unit))
        rows.append([name.replace("_", " "), number(factor * value, 4), shown, source])
    for name, metal in (("pipes", PIPE), ("accumulator's shell", SHELL)):
        density, strength = _metal(metal)
        words = f"library: {metal}, {fixed(density, 0)} kg/m³"
        rows.append([f"ultimate strength, {name}", fixed(1e-6 * strength, 0), "MPa", words])
    return rows


def remarks(study: Data) -> Data:
    """What stands under the tables."""
    rows = [row for row in study["rows"] if met(row)]
    with_store = min(rows, key=lambda row: total(row) + row["accumulator"])
    return {
        "mass": (
            "Each row its own optimum of carried mass, searched from its neighbour's dimensions."
            " Rings: sections of piston and rod; pipes: bores of pressure and return; lost: of the"
            " supply, at the largest flows. Not carried here: pump, valve, fittings, reservoir."
            " Accumulator: the bare spherical shell that gives one stroke of the head side while"
            f" the pressure sags by {fixed(100 * assumed('sag'), 0)} %, not in the sum, as joints"
            " share it; with it the lightest of these pressures would be"
            f" {fixed(bar(with_store), 0)} bar."
        ),
        "need": (
            f"At every pressure: {', '.join(always(rows))}. Extrusion: allowed gap over the gap,"
            " with piston or rod pushed to one side; beyond 207 bar the compound's limit is held at"
            " its last value, so that back-ups (theirs alone, known to 400 bar) is what counts."
            " The gap asked for is the same at every pressure,"
            " though low ones would bear more."
        ),
    }


def drawing(study: Data) -> Ink:
    """Carried mass over pressure, split, with the best marked; below, what binds where."""
    rows = [row for row in study["rows"] if met(row)]
    strips = changing(rows)
    ink = Ink(186.0, 82.0 + 4.2 * len(strips))
    pressures, split = [bar(row) for row in rows], [parts_of(row) for row in rows]
    top = 100 * ceil(0.01 * max(sum(one) for one in split) + 0.2)
    axes = Axes(ink, (26.0, 8.0, 122.0, 58.0), (pressures[0], pressures[-1]), (0.0, top))
    axes.frame("Mass, g", "supply pressure, bar")
    below_it, middles = [0.0] * len(rows), []
    for k in range(len(PARTS)):
        above_it = [low + one[k] for low, one in zip(below_it, split, strict=True)]
        edge = [(axes.x(x), axes.y(y)) for x, y in zip(pressures, above_it, strict=True)]
        back = [(axes.x(x), axes.y(y)) for x, y in zip(pressures, below_it, strict=True)]
        ink.path([[*edge, *back[::-1]]], fill=AREAS[(0, 3, 2)[k]], stroke=None, closed=True)
        middles.append((edge[-1][1] + back[-1][1]) / 2)
        below_it = above_it
    ink.path([edge], stroke=BLACK, pen=0.4)
    _others(axes, study)
    names = list(PARTS.values())
    places = spread_within(middles[::-1], [4.0] * 2, axes.top, axes.top + axes.height)[::-1]
    for name, middle, y in zip(names, middles, places, strict=True):
        ink.line((149.0, middle), (151.0, y), pen=0.13, stroke=GREY)
        ink.text(152.0, y, name, size=7.0)
    _marked(axes, study["best"])
    for k, (name, binds) in enumerate(strips.items()):
        _strip(axes, 82.0 + 4.2 * k, name, list(zip(pressures, binds, strict=True)))
    return ink


def _others(axes: Axes, study: Data) -> None:
    """The glands as shipped, as far as they go."""
    found = [row for row in study["shipped"] if met(row)]
    xs, ys = [bar(row) for row in found], [1e3 * total(row) for row in found]
    axes.ink.path(axes.clipped(xs, ys), stroke=RED, pen=0.35, dash=(1.6, 0.8))
    x, y = axes.x(xs[len(xs) // 8]), axes.y(ys[len(ys) // 8])
    axes.ink.text(x + 3.0, y - 1.5, "glands as shipped, as far as they go", color=RED, halo=True)


def _marked(axes: Axes, best: Data) -> None:
    """The optimum: a line, a dot, its words."""
    x, y, ink = axes.x(bar(best)), axes.y(1e3 * total(best)), axes.ink
    bottom = axes.top + axes.height
    ink.line((x, y), (x, bottom), stroke=WHITE, pen=0.25, dash=(1.0, 0.7))
    ink.circle(x, y, 1.0, fill=WHITE, stroke=BLACK, pen=0.3)
    words = f"lightest: {fixed(1e3 * total(best), 0)} g at {fixed(bar(best), 0)} bar"
    ink.text(x, y - 9.0, words, size=7.0, bold=True, anchor="center", halo=True)
    ink.line((x, y - 7.0), (x, y - 1.4), pen=0.15)


def _strip(axes: Axes, y: float, name: str, binds: list[tuple[float, bool]]) -> None:
    """Where one limit binds: a bar between neighbours that both bind, a dot at each that does."""
    ink = axes.ink
    ink.line((axes.left, y), (axes.left + axes.width, y), stroke="#d5dbe0", pen=0.1)
    ink.text(axes.left - 2.0, y, name, size=6.5, anchor="right")
    for (x, here), (to, there) in pairwise(binds):
        if here and there:
            ink.line((axes.x(x), y), (axes.x(to), y), stroke=BLUE, pen=0.7)
    for x, here in binds:
        paint = BLUE if here else WHITE
        ink.circle(axes.x(x), y, 0.75, fill=paint, stroke=BLUE if here else GREY, pen=0.15)


WIDTHS = {
    k: f"{width}mm"
    for k, width in enumerate((14.5, 13, 14, 12, 11, 14, 12.5, 12, 12, 17, 17, 15.5, 20))
}
"""Columns of the first table."""


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets: the same numbers give the same bytes."""
    said = remarks(study)
    strips = "Under the curves: where a limit binds (filled). Those alike at all: under the tables."
    return study_report(
        __file__,
        study,
        title="Where the knee is lightest",
        heading="The knee from 60 to 350 bar: where it is lightest with all it carries",
        lead=lead(study),
        blocks=[
            Drawing("What the robot carries for its knee", drawing(study), strips),
            grid_table("Pressure by pressure", mass_rows(study), said["mass"], widths=WIDTHS),
            grid_table(
                "How the requirements stand",
                need_rows(study),
                said["need"],
                words=[-1],
                widths={-1: 1},
            ),
            grid_table("Taken for granted", assumed_rows(), words=[0, -1], widths={-1: 1}),
        ],
    )


def printed(study: Data) -> str:
    """The tables, and what they say."""
    lines = []
    for rows in (mass_rows(study), need_rows(study), assumed_rows()):
        lines += [aligned(rows, right=range(len(rows[0]) - 1)), ""]
    return "\n".join([*lines, *lead(study)])


def main() -> None:
    """Print the tables; write the report where a folder is named."""
    description = "at which supply pressure the knee is lightest"
    print(
        run_script(__file__, description, compute, printed, page, quick="few pressures, one length")
    )


if __name__ == "__main__":
    main()
