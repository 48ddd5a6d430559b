"""What each hertz of the knee's position loop costs in grams, and each kN/mm under shaking.

The knee of servo_knee.yaml is re-optimised for least mass over the bandwidth required of its
position loop, and over the dynamic stiffness required at the impact's frequency, from where each
is free to the most that any design within the bounds reaches. Closed forms stand beside it, and
what other single changes give in bandwidth at the same mass.

    python designs/scripts/knee_dynamics.py                  # prints the table
    python designs/scripts/knee_dynamics.py --out reports    # and writes the report there
    python designs/scripts/knee_dynamics.py --quick          # few points
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import ceil, floor, pi, sqrt
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.metrics import METRICS
from actuator_opt.rendering.axes import Axes
from actuator_opt.rendering.blocks import Drawing
from actuator_opt.rendering.ink import BLUE, GREY, RED, WHITE, Ink
from actuator_opt.rendering.script_pages import (
    Sheets,
    grid_table,
    rounded,
    run_script,
    study_report,
)
from actuator_opt.rendering.text import fixed, number

DESIGN = Path(__file__).resolve().parents[1] / "servo_knee.yaml"
ASKED = ("bandwidth", "dynamic_stiffness")
UNITS = {name: METRICS[name].unit for name in ASKED}
TITLES = {
    "bandwidth": "Over the bandwidth of the position loop",
    "dynamic_stiffness": "Over the dynamic stiffness at the impact's frequency",
    "changes": "What else buys bandwidth, at the same mass",
}
SHARES = (0.0, 0.15, 0.35, 0.55, 0.7, 0.85)
"""Where points lie between what is free and the most that is within reach."""
STEEP = 0.7
"""The share that is priced beside the design as required."""
FREE = 1e-6
"""Mass (relative) that still counts as none."""
CHANGES: dict[str, dict[str, str]] = {
    "as it is": {},
    "spool of 60 Hz": {"valve.natural_frequency": "60 Hz"},
    "spool of 240 Hz": {"valve.natural_frequency": "240 Hz"},
    "spool of 1 kHz": {"valve.natural_frequency": "1000 Hz"},
    "half the dead volume": {
        "cylinder.dead_volume_a": "1.5 ml",
        "cylinder.dead_volume_b": "1.5 ml",
    },
    "a fifth of the air": {"fluid.air_content": "0.1 %"},
    "half the leakage in the valve": {"valve.leakage_flow": "0.1 l/min"},
}
"""Single changes, each re-optimised for bandwidth at the mass of the design as required."""
LIMITS = {
    "bandwidth": "bandwidth",
    "gain_margin": "gain margin",
    "phase_margin": "phase margin",
    "dynamic_stiffness": "dynamic stiffness",
    "stiffness_min": "static stiffness",
    "leakage": "leakage",
    "friction_running": "friction",
    "seal_gap": "seal gap",
    "barrel.layup[0].thickness upper": "thickest liner",
    "barrel.layup[1].thickness upper": "most hoop plies",
    "rod.inner_diameter lower": "least rod bore",
    "piston.leakage_conductance lower": "least bleed",
}
"""Limits that the tables name; those of strength, seals and fit are in the attached numbers."""

Data = dict[str, Any]


def ultimate_speed_gain(
    *, frequency: float, damping: float, spool: float = 0.0, spool_damping: float = 0.7
) -> float:
    """Velocity gain over 2 pi [Hz] at which an integrator, a resonance and a spool swing.

    The phase of the three is -180 degrees where (1 - x)(1 - y) = 4 zeta zeta_v sqrt(x y) with
    x = (f/f_0)^2 and y = (f/f_v)^2. Without the spool's lag (`spool` 0) that is at f_0 and the
    gain 2 zeta f_0 [Merritt1967].
    """
    if not spool:
        return 2 * damping * frequency
    product, crossed = frequency * spool, 4 * damping * spool_damping
    half = (frequency**2 + spool**2 + crossed * product) / 2
    low = half - sqrt(half**2 - product**2)
    x, y = low / frequency**2, low / spool**2
    return sqrt(low) * (2 * damping * sqrt(x) * (1 - y) + 2 * spool_damping * sqrt(y) * (1 - x))


def shaken_stiffness(*, stiffness: float, mass: float, frequency: float, corner: float) -> float:
    """Dynamic stiffness of a mass on a spring that leaks (Maxwell), |k i f/(i f + f_c) - m w^2|."""
    spring = stiffness * 1j * frequency / (1j * frequency + corner)
    return abs(spring - mass * (2 * pi * frequency) ** 2)


def passing_share(design: Any, case: str) -> float:
    """Conductance of valve and bleed where the spool passes its centre, over that where it holds.

    Centred, both edges of a chamber leak; held, the one that leaks less opens to feed the other and
    the bleed. The bleed counts twice on each chamber: the chambers swing against one another.
    """
    load_case = next(one for one in design.load_cases if one.name == case)
    area = pi / 4 * design.cylinder.bore**2
    ring = area - pi / 4 * design.rod.outer_diameter**2
    high, low = design.supply.pressure, design.supply.return_pressure
    force = load_case.force if load_case.direction == "push" else -load_case.force
    pressure_a = (force + (high + low) * ring) / (area + ring)
    bleed = design.piston.leakage_conductance
    edge = design.valve.leakage_flow / sqrt(design.valve.leakage_drop)
    held = passing = 4 * bleed
    for pressure, other in (
        (pressure_a, high + low - pressure_a),
        (high + low - pressure_a, pressure_a),
    ):
        into, out, past = high - pressure, pressure - low, bleed * (pressure - other)
        fed = max(edge * sqrt(into), edge * sqrt(out) + past)
        held += fed / (2 * into) + (fed - past) / (2 * out)
        passing += edge / (2 * sqrt(into)) + edge / (2 * sqrt(out))
    return float(passing / held)


def wishes(*, without: str = "", goal: str = "", mass: float | None = None) -> ao.Actuator:
    """The knee; one requirement left out, another goal, and a mass to stay within."""
    data = yaml.load(DESIGN.read_text("utf-8"), Loader=yaml.BaseLoader)
    data["requirements"].pop(without, None)
    if mass is not None:
        data["requirements"]["mass"] = {"max": f"{mass!r} kg"}
    if goal:
        data["objective"] = {"maximise": goal}
    return ao.read(yaml.safe_dump(data, sort_keys=False))


def point(metric: str, asked: float, start: Data, *, priced: bool = False) -> Data:
    """The lightest design for one requirement, searched from a neighbour's dimensions."""
    knee = ao.read(DESIGN).changed(start | {f"requirements.{metric}.min": asked})
    return measured(ao.optimise(knee, starts=1, prices=priced), metric, asked)


def measured(found: Any, metric: str, asked: float | None = None) -> Data:
    """The numbers of an optimum, SI, with the closed forms beside them."""
    evaluation, design, dynamics = found.evaluation, found.design, found.evaluation.dynamics
    loops = (dynamics.position_loop, *dynamics.other_loops)
    fast, slow = loops[0], min(loops, key=lambda one: one.bandwidth)
    speeds = [float(one.open_magnitude[0] * dynamics.frequencies[0]) for one in (fast, slow)]
    weakest = int(dynamics.closed_frequency.argmin())
    frequency, damping = (float(a[weakest]) for a in (dynamics.frequency, dynamics.damping_ratio))
    valve, supply = design.valve, design.supply
    drop = supply.pressure - supply.return_pressure
    share = speeds[1] / speeds[0] / fast.gain_margin
    lag = {"spool": valve.natural_frequency, "spool_damping": valve.damping_ratio}
    left = dynamics.conductance_share * passing_share(design, fast.case)
    mode = {"frequency": frequency, "damping": dynamics.friction_share + left}
    area, force = pi / 4 * design.cylinder.bore**2, design.load_cases[0].force
    layers = [layer.thickness for layer in design.barrel.layup]
    return {
        "asked": asked,
        "status": found.status,
        "mass": evaluation.metrics["mass"].value,
        "values": {v.path: v.value for v in found.variables},
        "binds": [] if found.kkt is None else list(found.kkt.active),
        "prices": {
            row.parameter.split(".")[1]: row.price
            for row in found.sensitivities
            if row.active and row.parameter.startswith("requirements.")
        },
        "metrics": {
            name: evaluation.metrics[name].value
            for name in (*ASKED, "stiffness_min", "leakage", "gain_margin", "phase_margin")
        },
        "wall": sum(layers),
        "frequency": frequency,
        "damping": damping,
        "passing_damping": mode["damping"],
        "cases": [fast.case, slow.case],
        "speed_gains": speeds,
        "fast_bandwidth": fast.bandwidth,
        "swings_at": fast.ultimate_frequency,
        "merritt": share * ultimate_speed_gain(**mode),
        "with_spool": share * ultimate_speed_gain(**mode, **lag),
        "maxwell": 1e-6
        * shaken_stiffness(
            stiffness=evaluation.metrics["stiffness_min"].value,
            mass=dynamics.mass,
            frequency=dynamics.shaken[0].frequency,
            corner=2 * dynamics.conductance_share * frequency,
        ),
        "valve_power": 2 * valve.leakage_flow * sqrt(drop / 2 / valve.leakage_drop) * drop,
        "bleed_power": design.piston.leakage_conductance * drop**2,
        "sag": design.piston.leakage_conductance * force / area**2 / (2 * pi * speeds[1]),
    }


def series(metric: str, required: Data, shares: tuple[float, ...], priced: bool) -> Data:
    """Optima from where the requirement is free to the most within reach."""
    without = ao.optimise(wishes(without=metric), starts=1, prices=False)
    light = (1 + FREE) * without.objective_value
    free = ao.optimise(wishes(without=metric, goal=metric, mass=light), starts=1, prices=False)
    starts = 3 if priced else 1
    most = ao.optimise(wishes(without=metric, goal=metric), starts=starts, prices=False)
    low, high = free.objective_value, most.objective_value
    points, start = [], {v.path: v.value for v in free.variables}
    for share in shares:
        asked = low + share * (high - low)
        points.append(point(metric, asked, start, priced=priced and share == STEEP))
        start = points[-1]["values"]
    points = sorted([*points, required | {"asked": required["metrics"][metric]}], key=_asked)
    return {"free": low, "most": measured(most, metric, high), "points": points}


def _asked(row: Data) -> float:
    return float(row["asked"])


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    knee = ao.read(DESIGN)
    required = measured(ao.optimise(knee, starts=1 if quick else 2, prices=not quick), "bandwidth")
    shares = (0.0, 0.9) if quick else SHARES
    changes = list(CHANGES)[:2] if quick else list(CHANGES)
    kept = knee.changed(required["values"])
    at_mass = wishes(without="bandwidth", goal="bandwidth", mass=(1 + FREE) * required["mass"])
    study = {
        "version": ao.__version__,
        "required": required,
        "kept": {
            kg: ao.evaluate(kept.changed({"load.mass": f"{kg} kg"})).metrics["gain_margin"].value
            for kg in ("16", "20", "24")
        },
        "spool": knee.design.valve.natural_frequency,
        "series": {name: series(name, required, shares, not quick) for name in ASKED},
        "changes": {
            name: measured(
                ao.optimise(
                    at_mass.changed(required["values"] | CHANGES[name]), starts=1, prices=False
                ),
                "bandwidth",
            )
            for name in changes
        },
    }
    return rounded(study)


def shown(metric: str, row: Data) -> float:
    """What is asked, in the unit of the page."""
    return METRICS[metric].to_display(row["asked"])


def slope(metric: str, before: Data, row: Data) -> float:
    """Mean price between two optima, in g per unit of the page."""
    return 1e3 * (row["mass"] - before["mass"]) / (shown(metric, row) - shown(metric, before))


def price(metric: str, row: Data) -> float | None:
    """Price by the multiplier, in g per unit of the page."""
    found = row["prices"].get(metric)
    return None if found is None else 1e3 * found / METRICS[metric].to_display(1.0)


def limits(row: Data, besides: list[str] | None = None) -> list[str]:
    """What of motion, leakage and walls binds, besides what is named elsewhere."""
    names = (LIMITS.get(label.split(" (")[0]) for label in row["binds"])
    return [name for name in dict.fromkeys(names) if name and name not in (besides or [])]


def always(rows: Iterable[Data]) -> list[str]:
    """What binds at every one of some optima."""
    first, *rest = (limits(row) for row in rows)
    return [name for name in first if all(name in names for names in rest)]


def sentence(metric: str, found: Data) -> str:
    """From where to where each unit costs how much, and what stands in the way beyond."""
    unit, most = UNITS[metric], found["most"]
    middle = (found["free"] + most["asked"]) / 2
    steps = [found["points"][0], next(r for r in found["points"] if r["asked"] >= middle), most]
    ends = [number(shown(metric, row), 3) for row in steps]
    means = [number(slope(metric, *pair), 2) for pair in pairwise(steps)]
    return (
        f"{metric.replace('_', ' ').capitalize()}: up to {ends[0]} {unit} it costs nothing; from"
        f" there to {ends[1]} {unit} each {unit} costs {means[0]} g on average, from {ends[1]} to"
        f" {ends[2]} {unit} {means[1]} g. Beyond, within the bounds of the dimensions, these"
        f" stand in the way: {', '.join(limits(most))}."
    )


def series_rows(metric: str, found: Data) -> list[list[str]]:
    """Heads and rows: what is asked, what it weighs, which dimensions move, what binds."""
    closed = ["Merritt, Hz", "with spool, Hz"] if metric == "bandwidth" else ["closed form, kN/mm"]
    sizes = ["bore, mm", "rod, mm", "wall, mm", "gain, V/m", "bleed, ml/min per bar", "f₀, Hz"]
    first = f"{metric.replace('_', ' ')}, {UNITS[metric]}"
    rows = [[first, "mass, g", f"g per {UNITS[metric]}", *sizes, *closed, "what binds besides"]]
    points = [*found["points"], found["most"]]
    for before, row in zip([None, *points], points, strict=False):
        v = row["values"]
        checks = [row["merritt"], row["with_spool"]]
        rows.append(
            [
                number(shown(metric, row), 4),
                fixed(1e3 * row["mass"], 1),
                "" if before is None else number(slope(metric, before, row), 3),
                fixed(1e3 * v["cylinder.bore"], 2),
                fixed(1e3 * v["rod.outer_diameter"], 2),
                fixed(1e3 * row["wall"], 2),
                fixed(v["control.gain"], 0),
                fixed(6e12 * v["piston.leakage_conductance"], 2),
                fixed(row["frequency"], 1),
                *(number(x, 3) for x in (checks if metric == "bandwidth" else [row["maxwell"]])),
                ", ".join(limits(row, always(found["points"]))),
            ]
        )
    return rows


def change_rows(study: Data) -> list[list[str]]:
    """Heads and rows: bandwidth at the same mass after one change, and what it takes elsewhere."""
    heads = ["one change", "bandwidth, Hz", "closed form, Hz", "f₀, Hz", "valve loses, W"]
    rows, changes = [[*heads, "bleed loses, W", "sag, mm", "what binds besides"]], study["changes"]
    for name, row in changes.items():
        rows.append(
            [
                name,
                number(row["metrics"]["bandwidth"], 3),
                number(row["with_spool"], 3),
                fixed(row["frequency"], 0),
                fixed(row["valve_power"], 0),
                fixed(row["bleed_power"], 0),
                fixed(1e3 * row["sag"], 2),
                ", ".join(limits(row, always(changes.values()))),
            ]
        )
    return rows


def drawing(study: Data) -> Ink:
    """Mass over what is asked, with the prices as tangents."""
    ink = Ink(186.0, 58.0)
    for k, (metric, found) in enumerate(study["series"].items()):
        rows = [*found["points"], found["most"]]
        xs, ys = [shown(metric, row) for row in rows], [1e3 * row["mass"] for row in rows]
        room, wide = 0.06 * (xs[-1] - xs[0]), 0.16 * (xs[-1] - xs[0])
        span = (10 * floor(0.1 * min(ys) - 1.5), 10 * ceil(0.1 * max(ys) + 0.5))
        axes = Axes(ink, (10.0 + 96.0 * k, 8.0, 78.0, 40.0), (xs[0] - wide, xs[-1] + room), span)
        axes.frame("Mass, g", f"{metric.replace('_', ' ')} required, {UNITS[metric]}")
        ink.path(axes.clipped([xs[0] - wide, *xs], [ys[0], *ys]), stroke=BLUE, pen=0.5)
        for x, y, row in zip(xs, ys, rows, strict=True):
            at_end = row is found["most"]
            ink.circle(axes.x(x), axes.y(y), 0.7, stroke=BLUE, fill=WHITE if at_end else BLUE)
            paid = price(metric, row)
            if paid is not None:
                ends = [x - wide, x + wide]
                line = axes.clipped(ends, [y + paid * (end - x) for end in ends])
                ink.path(line, stroke=RED, pen=0.3, dash=(1.6, 0.8))
                words = f"{number(paid, 3)} g per {UNITS[metric]}"
                ink.text(axes.x(x) + 3, axes.y(y) + 3, words, color=RED, halo=True)
        ink.text(axes.x(xs[-1]) - 2, axes.y(ys[-1]), "the most", anchor="right", halo=True)
        ink.text(axes.x(xs[0]) - 1, axes.y(ys[0]) - 3, "free", anchor="right", color=GREY)
    return ink


def remarks(study: Data) -> Data:
    """What stands under the tables."""
    base, found = study["required"], study["series"]
    rows = {name: found[name]["points"] for name in ASKED} | {"changes": study["changes"].values()}
    every = {name: f"Every row: {', '.join(always(rows[name]))}." for name in rows}
    first, last = rows["bandwidth"][0], found["bandwidth"]["most"]
    ratios = [number(row["speed_gains"][0] / row["speed_gains"][1], 3) for row in (first, last)]
    lifted = [number(row["frequency"], 3) for row in (first, last)]
    merritt = number(2 * base["passing_damping"] * base["frequency"], 3)
    left, held = (number(base[name], 2) for name in ("passing_damping", "damping"))
    kept = ", ".join(f"{number(m, 3)} with {kg} kg" for kg, m in study["kept"].items())
    high = [1e6 * r["maxwell"] / r["metrics"]["dynamic_stiffness"] for r in rows[ASKED[1]]]
    model, (fast, slow) = number(base["metrics"]["bandwidth"], 3), base["cases"]
    return {
        "bandwidth": (
            "g per Hz: from the row above, by finite differences; red in the figure: by the"
            f" multipliers. {every['bandwidth']} By hand, as required: Merritt's limit of a"
            f" proportional loop, 2ζf₀ = {merritt} Hz of velocity gain by the damping that is left"
            f" where the spool passes its centre (ζ {left}; held {held}), over the gain margin and"
            f" over the ratio of the valve's gain where the margin is least ({fast}) to that where"
            f" the bandwidth is ({slow}), is {number(base['merritt'], 3)} Hz. That is for a spool"
            f" without lag. This one has {number(study['spool'], 3)} Hz, so that the loop would"
            f" swing below f₀, at {number(base['swings_at'], 3)} Hz, where the resonance magnifies"
            f" less: with its two poles the closed form gives {number(base['with_spool'], 3)} Hz,"
            f" the whole model {model} Hz. What is paid for is f₀, from {lifted[0]} to {lifted[1]}"
            f" Hz, and a bore that brings the ratio of gains from {ratios[0]} to {ratios[1]}. Each"
            " optimum is the best of a few starts, not a proof."
        ),
        "dynamic_stiffness": (
            f"{every['dynamic_stiffness']} Closed form: the weakest static stiffness as a spring"
            " that leaks (Maxwell) at the rate of the modes' damping, less the inertia of the mass;"
            f" {number(100 * (1 - min(high)), 2)} % low to"
            f" {number(100 * (max(high) - 1), 2)} % high,"
            " since the chambers leak at different rates."
        ),
        "changes": (
            f"Each re-optimised for bandwidth at {fixed(1e3 * base['mass'], 1)} g."
            f" {every['changes']} Valve: holding, at supply pressure; bleed: at full pressure"
            f" difference; sag: the loop's standing error under the force of the {slow} by the"
            " bleed alone. A quicker spool makes it worse: its lag no longer keeps the loop off"
            " the resonance. All of it rests on the mass of the load: the optimum as required, its"
            f" gain kept, has gain margins of {kept}. If the gain followed the load's pressure,"
            f" {slow} could follow about as {fast} does, {number(base['fast_bandwidth'], 2)} Hz"
            f" against {model} Hz, without a gram."
        ),
    }


WIDTHS: dict[int, float | str] = dict.fromkeys(range(1, 20), "12.6mm")
"""Columns of the tables."""


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets: the same numbers give the same bytes."""
    said, found = remarks(study), study["series"]
    return study_report(
        __file__,
        study,
        title="What each hertz costs",
        heading="The knee, quicker and stiffer: what each hertz costs in grams",
        lead=[sentence(name, found[name]) for name in ASKED],
        blocks=[
            Drawing("What it weighs", drawing(study)),
            *(
                grid_table(
                    TITLES[name],
                    series_rows(name, found[name]),
                    said[name],
                    words=[-1],
                    widths=WIDTHS | {0: "16mm", 6: "14.4mm", -1: 1},
                )
                for name in ASKED
            ),
            grid_table(
                TITLES["changes"],
                change_rows(study),
                said["changes"],
                words=[0, -1],
                widths=WIDTHS | {0: "auto", -1: 1},
            ),
        ],
    )


def printed(study: Data) -> str:
    """The tables, and what they say."""
    lines = []
    for metric, found in study["series"].items():
        rows = series_rows(metric, found)
        lines += [aligned(rows, right=range(len(rows[0]) - 1)), "", sentence(metric, found), ""]
    return "\n".join([*lines, aligned(change_rows(study), right=range(1, 7))])


def main() -> None:
    """Print the tables; write the report where a folder is named."""
    description = "what each hertz of the knee costs in grams"
    print(
        run_script(
            __file__, description, compute, printed, page, quick="few points, no multipliers"
        )
    )


if __name__ == "__main__":
    main()
