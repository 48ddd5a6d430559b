"""One knee, five barrels: steel, aluminium, carbon cloth, wound carbon with and without a liner.

Each is brought to its own optimum of mass for the requirements of the bonded knee. What
each limit costs there, what a thin laminate would have promised, and how the masses move with the
gap and the stiffness asked for, are computed too. knee_materials.typ makes the report of them: a
table, a figure and a discussion of what decides.

    python designs/scripts/knee_materials.py                  # prints the masses
    python designs/scripts/knee_materials.py --out reports    # and writes the report there
"""

from __future__ import annotations

from functools import cache
from math import ceil, floor, inf
from pathlib import Path
from typing import Any

import numpy as np
import yaml

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.rendering.axes import Axes
from actuator_opt.rendering.ink import GREY, RED, Ink, spread_within
from actuator_opt.rendering.script_pages import Sheets, rounded, run_script, study_sheets
from actuator_opt.rendering.text import fixed, trimmed

DESIGNS = Path(__file__).resolve().parents[1]
LINER, FIBRE, CLOTH = "al_7075_t6", "t700_epoxy", "woven_cfrp_t700_2510"
OTHER_FIBRE = "t700_2510_secondary"
"""The same fibre in another published compilation: how far the data alone move the answer."""
BARE = "nbr_70_on_composite"
"""The seal whose friction on bare composite was measured [ElAsswad2018]."""
CAPS = "ti_6al4v"
"""Metal of the caps tried besides aluminium: its expansion is nearer to that of the plies."""
THICKEST = "8 mm"
"""Upper bound of every layer: three quarters of the bore's radius."""
HUGE_WALL = "30 mm"
"""A wall nobody would make, to show where bore growth settles."""
ANGLES = {"lower": "20 deg", "upper": "60 deg"}

Data = dict[str, Any]


def layer(material: str, thickness: str, least: str, angle: str = "", free: bool = False) -> Data:
    """A layer of the wall and the bounds of what is free in it."""
    ply = {"material": material, "thickness": thickness} | ({"angle": angle} if angle else {})
    bounds = {"thickness": {"lower": least, "upper": THICKEST}}
    return {"ply": ply, "bounds": bounds | ({"angle": ANGLES} if free else {})}


HOOP = layer(FIBRE, "1.2 mm", "0.2 mm", "88 deg")
AXIAL = layer(FIBRE, "0.8 mm", "0.2 mm", "25 deg", free=True)
WALLS = {
    "steel": [layer("steel_e355", "2 mm", "0.4 mm")],
    "aluminium": [layer(LINER, "4 mm", "0.4 mm")],
    "cloth": [layer(CLOTH, "4 mm", "0.2 mm", "0 deg")],
    "lined": [layer(LINER, "0.6 mm", "0.4 mm"), HOOP, AXIAL],
    "linerless": [HOOP, AXIAL],
}
"""The walls from the bore outwards; cloth has its two fibre directions along and around."""
METALS = ("steel", "aluminium")
METRICS = (
    "bore_growth",
    "growth_at_seal",
    "seal_gap",
    "stiffness_min",
    "friction_running",
    "first_ply_factor",
    "liner_yield_factor",
    "proof_factor",
    "burst_factor",
    "buckling_factor",
    "retention_factor",
    "bond_thermal_factor",
)
CRITERIA = ("max_stress", "max_strain", "tsai_wu", "hashin", "puck")


@cache
def _file(name: str) -> str:
    return (DESIGNS / name).read_text("utf-8")


def _data(name: str) -> Data:
    """A design file as texts: numbers keep the unit they are written with."""
    data: Data = yaml.load(_file(name), Loader=yaml.BaseLoader)
    return data


def variant(
    key: str,
    *,
    joint: str = "bond",
    wall: list[Data] | None = None,
    without: tuple[str, ...] = (),
    asks: dict[str, float] | None = None,
    goal: dict[str, str] | None = None,
    model: str = "auto",
) -> ao.Actuator:
    """The knee with another wall and nothing else changed but what is named here.

    `joint` "thread" screws the caps on as in steel_baseline.yaml; `without` are requirements and
    checks to leave out, `asks` least values to ask for besides; `goal` replaces the objective,
    `model` is that of the barrel.
    """
    data, layers = _data("knee_bonded.yaml"), wall or WALLS[key]
    data["name"] = f"robot knee, {key} barrel"
    data["notes"] = "A variant of knee_bonded.yaml made by designs/scripts/knee_materials.py."
    data["barrel"] |= {"layup": [dict(part["ply"]) for part in layers], "model": model}
    free = {path: b for path, b in data["variables"].items() if not path.startswith("barrel.")}
    for index, part in enumerate(layers):
        for name, bounds in part["bounds"].items():
            free[f"barrel.layup[{index}].{name}"] = dict(bounds)
    if joint == "thread":
        screwed = _data("steel_baseline.yaml")
        data["retention"] = screwed["retention"]
        for path in ("retention.wall", "retention.length", "barrel.layup[0].thickness"):
            free[path] = free[path] | {"lower": screwed["variables"][path]["lower"]}
    for metric in without:
        data["requirements"].pop(metric, None)
        data["waivers"][metric] = "left out: see the study"
    data["requirements"] |= {name: {"min": str(least)} for name, least in (asks or {}).items()}
    data |= {"variables": free, "objective": goal or data["objective"]}
    return ao.read(yaml.safe_dump(data, sort_keys=False))


def best(actuator: ao.Actuator, *, prices: bool = False) -> Any:
    """The optimum; more starts for those whose prices stand in the table."""
    return ao.optimise(actuator, starts=6 if prices else 2, prices=prices)


def least_mass(actuator: ao.Actuator) -> float | None:
    """Mass of the optimum; None where nothing meets every requirement."""
    optimum = best(actuator)
    return None if optimum.infeasibility else optimum.objective_value


def solved(key: str, *, without: tuple[str, ...] = (), **changes: Any) -> tuple[Any, list[Data]]:
    """The optimum of a variant; without the requirements it cannot meet, where there are such.

    Those are the least to give up in all, each with the limit that would do.
    """
    asked = best(variant(key, without=without, **changes))
    if asked.infeasibility is None:
        return asked, []
    keys = ("metric", "sense", "limit", "needed")
    lacks = [{name: row[name] for name in keys} for row in asked.infeasibility.joint]
    left_out = (*without, *(row["metric"] for row in lacks))
    return best(variant(key, without=left_out, **changes)), lacks


def measured(evaluation: Any) -> Data:
    """The numbers of one evaluation, SI."""
    metrics = {name: evaluation.metrics[name] for name in METRICS if name in evaluation.metrics}
    curve, design = evaluation.curve, evaluation.design
    weakest = int(curve.stiffness.argmin())
    return {
        "mass": evaluation.metrics["mass"].value,
        "parts": dict(evaluation.mass_parts),
        "bore": design.cylinder.bore,
        "skirt": [design.retention.length, design.retention.wall],
        "layers": [[p.material, p.thickness, p.angle] for p in design.barrel.layup],
        "metrics": {name: m.value for name, m in metrics.items()},
        "places": {name: m.place or "" for name, m in metrics.items()},
        "shares": {
            part: float(c[weakest] * curve.stiffness[weakest])
            for part, c in curve.contributions.items()
        },
        "missed": {c.metric: [c.value, c.limit] for c in evaluation.checks if c.status == "missed"},
        "unverified": len(evaluation.unverified),
    }


def relaxed(optimum: Any) -> Data:
    """Mass with each limit that binds relaxed by 10 %, and its price in % of mass per %."""
    rows = {}
    for row in optimum.sensitivities:
        if row.active and row.parameter.startswith("requirements."):
            _, metric, sense = row.parameter.split(".")
            mass = row.resolved_minus10 if sense == "min" else row.resolved_10
            rows[metric] = {"mass": mass, "price": row.percent_per_percent}
    return rows


def gap_curve(key: str, joint: str, found: Any, lacks: list[Data], limit: float) -> list[Any]:
    """(gap allowed, mass), from the least gap this wall allows to where the gap is free."""
    needed = [1.0005 * row["needed"] for row in lacks if row["metric"] == "seal_gap"]
    rest = tuple(row["metric"] for row in lacks if row["metric"] != "seal_gap")
    free = found if needed else best(variant(key, joint=joint, without=(*rest, "seal_gap")))
    least, end = max([limit, *needed]), free.evaluation.metrics["seal_gap"].value
    base = variant(key, joint=joint, without=rest)

    def point(gap: float) -> list[float]:
        return [gap, best(base.changed({"requirements.seal_gap.max": gap})).objective_value]

    first = point(least) if needed else [limit, found.objective_value]
    if end <= least:
        return [first]
    inside = [least + (end - least) * share for share in (0.12, 0.3, 0.6)]
    return [first, *map(point, inside), [end, free.objective_value]]


def stiffness_curve(key: str, joint: str, found: Any, lacks: list[Data], limit: float) -> Data:
    """(stiffness asked for, mass), up to near the most this wall reaches within its bounds."""
    rest = tuple(row["metric"] for row in lacks)
    goal = {"maximise": "stiffness_min"}
    stiffest = best(variant(key, joint=joint, without=(*rest, "stiffness_min"), goal=goal))
    most = stiffest.objective_value
    base = variant(key, joint=joint, without=rest)
    near = base.changed({v.path: v.value for v in stiffest.variables})

    def point(start: ao.Actuator, asked: float) -> list[Any]:
        return [asked, least_mass(start.changed({"requirements.stiffness_min.min": asked}))]

    soft = [point(base, limit * share) for share in (0.65, 0.8, 0.9)]
    hard = [point(near, limit + (most - limit) * share) for share in (0.4, 0.7, 0.92)]
    points = [*soft, [limit, found.objective_value], *hard]
    kept = [[asked, mass] for asked, mass in points if mass is not None]
    return {"stiffest": most, "stiffness_curve": kept}


def one(key: str, limits: Data) -> Data:
    """Everything about one barrel."""
    joints = ("thread", "bond") if key in METALS else ("bond",)
    tried = {joint: solved(key, joint=joint) for joint in joints}
    joint = min(joints, key=lambda name: (len(tried[name][1]), tried[name][0].objective_value))
    lacks = tried[joint][1]
    left_out = tuple(row["metric"] for row in lacks)
    optimum = best(variant(key, joint=joint, without=left_out), prices=True)
    numbers = measured(optimum.evaluation) | {
        "joint": joint,
        "other_joint": {n: r.objective_value for n, (r, _) in tried.items() if n != joint},
        "other_joint_lacks": [c["metric"] for n, (_, m) in tried.items() if n != joint for c in m],
        "conflicts": lacks,
        "status": optimum.status,
        "values": {v.path: v.value for v in optimum.variables},
        "at_bounds": [v.path for v in optimum.variables if v.at_bound],
        "relaxed": relaxed(optimum),
        "gap_curve": gap_curve(key, joint, optimum, lacks, limits["seal_gap"]),
        "design": getattr(variant(key, joint=joint).source, "text", ""),
    }
    numbers |= stiffness_curve(key, joint, optimum, lacks, limits["stiffness_min"])
    if joint == "bond" and not lacks:
        numbers["warm_bond"] = warm_bond(key, optimum)
    return numbers if key in METALS else numbers | composite(key, optimum, left_out)


def warm_bond(key: str, optimum: Any) -> Data:
    """Masses with and without the edge shear of temperature alone held within the strength."""
    metric, mass = "bond_thermal_factor", optimum.objective_value
    limit = next(c.limit for c in optimum.evaluation.checks if c.metric == metric)
    held = variant(key, asks={metric: limit})
    holds = optimum.evaluation.metrics[metric].value > limit * (1 - 1e-6)
    return {
        "required": holds,
        "held": mass if holds else least_mass(held),
        "free": least_mass(variant(key, without=(metric,))) if holds else mass,
        "other_caps": least_mass(held.changed({"caps.material": CAPS})),
    }


def composite(key: str, optimum: Any, left_out: tuple[str, ...]) -> Data:
    """What only a composite wall has: criteria, cure stress, and a thin form of its theory."""
    here = ao.Actuator(optimum.design)

    def first_ply(changes: dict[str, float | str]) -> Any:
        return ao.evaluate(here.changed(changes)).metrics["first_ply_factor"].value

    rest = tuple(metric for metric in left_out if metric != "seal_gap")
    thin, lacks = solved(key, without=rest, model="thin_laminate")
    exact = ao.evaluate(ao.Actuator(thin.design).changed({"barrel.model": "auto"}))
    same = ao.evaluate(here.changed({"barrel.model": "thin_laminate"}))
    return {
        "criteria": {name: first_ply({"barrel.criterion": name}) for name in CRITERIA},
        "uncured": first_ply({"environment.cure_temperature": "20 degC"}),  # as when joined
        "thin_growth": same.metrics["bore_growth"].value,
        "thin": {"conflicts": lacks, "mass": thin.objective_value, "exact": measured(exact)},
    }


def compute() -> Data:
    """The whole study as plain numbers, SI."""
    design = ao.read(_file("knee_bonded.yaml")).design
    limits = {r.metric: r.limit for r in ao.evaluate(design).requirements}
    variants = {key: one(key, limits) for key in WALLS}
    library = ao.load_library()
    rubber = library.get(design.seals.piston.compound)
    bare = library.get(BARE).numbers["friction_coefficient"]
    smooth = variants["linerless"]
    rubbing = ao.read(smooth["design"]).changed(
        smooth["values"] | {"seals.piston.friction_coefficient": bare}
    )
    huge = variant("cloth", wall=[layer(CLOTH, HUGE_WALL, "") | {"bounds": {}}])
    huge = huge.changed({"cylinder.bore": variants["cloth"]["bore"]})
    moduli = ("youngs_modulus", "youngs_modulus_1", "youngs_modulus_3")
    return {
        "version": ao.__version__,
        "fibre": FIBRE,
        "limits": limits,
        "task": {
            "supply": design.supply.pressure,
            "proof_ratio": design.supply.proof_ratio,
            "stroke": design.cylinder.stroke,
            "clearance": design.piston.clearance,
            "friction_coefficient": design.seals.piston.friction_coefficient,
            "cure_temperature": getattr(design.environment, "cure_temperature", None),
            "cases": [[c.name, c.direction, c.force, c.speed] for c in design.load_cases],
        },
        "moduli": {
            name: [library.get(name).numbers.get(key) for key in moduli]
            for name in ("steel_e355", LINER, CLOTH)
        },
        "variants": variants,
        "lightest_from": crossing(variants, "aluminium"),
        "other_fibre": {
            key: least_mass(ao.read(variants[key]["design"].replace(FIBRE, OTHER_FIBRE)))
            for key in ("lined", "linerless")
        },
        "hoop_only": measured(best(variant("lined", wall=WALLS["lined"][:2])).evaluation),
        "friction_scatter": rubber.properties["friction_coefficient"].scatter,
        "bare": {
            "coefficient": bare,
            "friction": ao.evaluate(rubbing).metrics["friction_running"].value,
        },
        "huge_wall": {
            "wall": huge.design.barrel.layup[0].thickness,
            "growth": ao.evaluate(huge).metrics["bore_growth"].value,
        },
        "thickest": float(THICKEST.removesuffix(" mm")) * 1e-3,
        "baseline": least_mass(ao.read(_file("steel_baseline.yaml"))),
    }


def crossing(variants: Data, key: str) -> float | None:
    """The gap from which on one barrel is the lightest of all; None where it never is."""
    gaps = np.linspace(*gap_range(variants), 2001)
    masses = {
        name: np.interp(gaps, *np.transpose(row["gap_curve"]), left=inf)
        for name, row in variants.items()
    }
    rest = np.min([mass for name, mass in masses.items() if name != key], axis=0)
    lighter = masses[key] < rest
    return float(gaps[np.argmax(lighter)]) if lighter.any() else None


def gap_range(variants: Data) -> tuple[float, float]:
    """Gaps the curves cover, and a little beyond where the last of them is free."""
    gaps = [gap for row in variants.values() for gap, _ in row["gap_curve"]]
    return min(gaps), max(gaps) + 0.2 * (max(gaps) - min(gaps))


LABELS = {
    "steel": "steel E355",
    "aluminium": "aluminium 7075",
    "cloth": "carbon cloth",
    "lined": "carbon, Al liner",
    "linerless": "carbon, no liner",
}
STROKES: Data = {
    "steel": {"stroke": "#16202a", "pen": 0.35},
    "aluminium": {"stroke": "#b98b3e", "pen": 0.5},
    "cloth": {"stroke": "#a8321a", "pen": 0.4, "dash": (0.6, 0.7)},
    "lined": {"stroke": "#0b4f83", "pen": 0.5},
    "linerless": {"stroke": "#4f86a8", "pen": 0.5, "dash": (2.2, 0.9)},
}


def figure(study: Data, *, width: float = 180.0, height: float = 62.0) -> Ink:
    """Optimal mass over the gap allowed (left) and over the stiffness asked for (right)."""
    rows, limits = study["variants"], study["limits"]
    low, high = gap_range(rows)
    gaps = {key: [*row["gap_curve"], [high, row["gap_curve"][-1][1]]] for key, row in rows.items()}
    stiffness = {key: row["stiffness_curve"] for key, row in rows.items()}
    masses = [mass for points in (*gaps.values(), *stiffness.values()) for _, mass in points]
    marked = [row["mass"] for row in rows.values()]
    span = (25 * floor(40 * min(masses)), 25 * ceil(40 * 1.12 * max(marked)))
    ink = Ink(width, height)
    panel, top, tall = 62.0, 8.0, height - 18.0
    left = Axes(ink, (9.0, top, panel, tall), (1e6 * low - 0.1, 1e6 * high), span)
    left.frame("Mass, g", "largest gap at the piston seal allowed, µm")
    _limit(ink, left, 1e6 * limits["seal_gap"])
    ends = _curves(left, gaps, 1e6)
    _names(ink, left, ends)
    reach = [k for points in stiffness.values() for k, _ in points]
    box = (9.0 + panel + 47.0, top, panel, tall)
    right = Axes(ink, box, (1e-6 * min(reach), 1e-6 * max(reach)), span)
    right.frame("Mass, g", "least stiffness asked for, kN/mm")
    _limit(ink, right, 1e-6 * limits["stiffness_min"])
    _curves(right, stiffness, 1e-6)
    return ink


def _limit(ink: Ink, axes: Axes, at: float) -> None:
    """The requirement of the study, as a vertical line."""
    x = axes.x(at)
    bottom = axes.top + axes.height
    ink.line((x, axes.top), (x, bottom), stroke=RED, pen=0.25, dash=(1.8, 1.0))
    beside: Any = ("left", 0.8) if x < axes.left + axes.width / 2 else ("right", -0.8)
    words = f"required: {trimmed(at)}"
    y = bottom - 1.8
    ink.text(x + beside[1], y, words, size=6.0, color=RED, anchor=beside[0], halo=True)


def _curves(axes: Axes, curves: Data, scale: float) -> dict[str, float]:
    """Draw the curves; where each ends, in mm of paper."""
    ends = {}
    for key, points in curves.items():
        xs = [scale * x for x, _ in points]
        ys = [1e3 * mass for _, mass in points]
        axes.ink.path(axes.clipped(xs, ys), **STROKES[key])
        ends[key] = axes.y(ys[-1])
    return ends


def _names(ink: Ink, axes: Axes, ends: dict[str, float]) -> None:
    """Names beside the curves, with a sample of each line."""
    order = sorted(ends, key=lambda key: ends[key])
    bottom = axes.top + axes.height
    places = spread_within([ends[k] for k in order], [4.0] * len(order), axes.top, bottom)
    right = axes.left + axes.width
    for key, y in zip(order, places, strict=True):
        ink.line((right, ends[key]), (right + 3.0, y), pen=0.13, stroke=GREY)
        ink.line((right + 3.4, y), (right + 9.4, y), **STROKES[key])
        ink.text(right + 10.4, y, LABELS[key], size=6.5)


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets: the same numbers give the same bytes."""
    found = rounded(study)
    shown = {**found, "labels": LABELS, "figure": figure(found).data()}
    return study_sheets(__file__, found, shown)


def table(study: Data) -> str:
    """The masses and what binds, for the terminal."""
    rows = [["barrel", "mass, g", "barrel, g", "wall, mm", "gap, µm", "limits that cost most"]]
    for key, row in study["variants"].items():
        costly = sorted(row["relaxed"], key=lambda name: row["relaxed"][name]["mass"])
        missed = "".join(f" without {lack['metric']}" for lack in row["conflicts"])
        rows.append(
            [
                LABELS[key] + missed,
                fixed(1e3 * row["mass"], 1),
                fixed(1e3 * row["parts"]["barrel"], 1),
                fixed(1e3 * sum(thickness for _, thickness, _ in row["layers"]), 2),
                fixed(1e6 * row["metrics"]["seal_gap"], 1),
                ", ".join(costly[:3]),
            ]
        )
    return aligned(rows, right=(1, 2, 3, 4))


def main() -> None:
    """Print the masses; with ``--out`` write the report."""
    print(run_script(__file__, "what a wall of each material costs in grams", compute, table, page))


if __name__ == "__main__":
    main()
