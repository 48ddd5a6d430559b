"""One robot knee, five barrels: steel, aluminium, carbon cloth, wound carbon with and without liner.

Each is brought to its own optimum of mass for the requirements and load cases of knee.yaml. What
each limit costs there, what a thin laminate would have promised, and how the masses move with the
gap and the stiffness asked for, are computed too; a report of a table, a figure and a discussion
(knee_materials.typ) says what decides.

    python designs/scripts/knee_materials.py            # prints the table
    python designs/scripts/knee_materials.py reports    # and writes the report there
"""

from __future__ import annotations

import json
import sys
from functools import cache
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao

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

Data = dict[str, Any]


def layer(material: str, thickness: str, least: str, angle: str = "", free: bool = False) -> Data:
    """A layer of the wall and the bounds of what is free in it."""
    ply = {"material": material, "thickness": thickness} | ({"angle": angle} if angle else {})
    bounds = {"thickness": {"lower": least, "upper": THICKEST}}
    return {"ply": ply, "bounds": bounds | ({"angle": ANGLES} if free else {})}


ANGLES = {"lower": "20 deg", "upper": "60 deg"}
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
    "bore_growth growth_at_seal seal_gap stiffness_min friction_running proof_factor "
    "first_ply_factor liner_yield_factor yield_factor burst_factor buckling_factor "
    "retention_factor bond_thermal_factor bearing_overlap"
).split()
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
    goal: dict[str, str] | None = None,
    model: str = "auto",
) -> ao.Actuator:
    """The knee with another wall and nothing else changed but what is named here.

    `joint` "thread" screws the caps on as in steel_baseline.yaml; `without` are requirements and
    checks to leave out; `goal` replaces the objective; `model` is that of the barrel.
    """
    data, layers = _data("knee.yaml"), wall or WALLS[key]
    data["name"] = f"knee, {key} barrel"
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
    data |= {"variables": free, "objective": goal or data["objective"]}
    return ao.read(yaml.safe_dump(data, sort_keys=False))


def best(actuator: ao.Actuator, *, prices: bool = False) -> Any:
    """The optimum; more starts for those whose prices stand in the table."""
    return ao.optimise(actuator, starts=6 if prices else 2, prices=prices)


def conflicts(optimum: Any) -> list[Data]:
    """What an infeasible design would have to give up, the least in all; empty for a good one."""
    if optimum.infeasibility is None:
        return []
    keys = ("requirement", "metric", "sense", "limit", "needed")
    return [{key: row[key] for key in keys} for row in optimum.infeasibility.joint]


def solved(key: str, *, prices: bool = False, **changes: Any) -> tuple[Any, list[Data]]:
    """The optimum of a variant; without the requirements it cannot meet, where there are such."""
    asked = best(variant(key, **changes), prices=prices)
    lacks = conflicts(asked)
    if not lacks:
        return asked, lacks
    left_out = tuple(row["metric"] for row in lacks)
    return best(variant(key, **changes | {"without": left_out}), prices=prices), lacks


def measured(evaluation: Any) -> Data:
    """The numbers of one evaluation, SI."""
    metrics = {name: evaluation.metrics[name] for name in METRICS if name in evaluation.metrics}
    curve = evaluation.curve
    weakest = int(curve.stiffness.argmin())
    return {
        "parts": dict(evaluation.mass_parts),
        "bore": evaluation.design.cylinder.bore,
        "layers": [[p.material, p.thickness, p.angle] for p in evaluation.design.barrel.layup],
        "metrics": {name: m.value for name, m in metrics.items()},
        "places": {name: m.place for name, m in metrics.items()},
        "shares": {
            part: float(c[weakest] * curve.stiffness[weakest])
            for part, c in curve.contributions.items()
        },
        "unverified": len(evaluation.unverified),
    }


def relaxed(optimum: Any) -> Data:
    """Mass with each limit that binds relaxed by 10 %, and its price in % of mass per %."""
    rows = {}
    for row in optimum.sensitivities:
        _, metric, sense = (row.parameter.split(".") + ["", ""])[:3]
        if row.active and row.parameter.startswith("requirements."):
            mass = row.resolved_minus10 if sense == "min" else row.resolved_10
            rows[metric] = {"mass": mass, "price": row.percent_per_percent}
    return rows


def first_ply(optimum: Any, changes: Data) -> float | None:
    """First-ply factor of an optimum with other settings of its evaluation."""
    evaluation = ao.evaluate(ao.Actuator(optimum.design).changed(changes))
    value: float | None = evaluation.metrics["first_ply_factor"].value
    return value


def gap_curve(key: str, joint: str, lacks: list[Data], limit: float) -> list[list[float]]:
    """(gap allowed, mass), from the least gap this wall allows to where the gap is free."""
    least = max([limit, *(1.0005 * row["needed"] for row in lacks if row["metric"] == "seal_gap")])
    rest = tuple(row["metric"] for row in lacks if row["metric"] != "seal_gap")
    free = best(variant(key, joint=joint, without=(*rest, "seal_gap")))
    end = free.evaluation.metrics["seal_gap"].value
    if end <= least:
        return [[least, free.objective_value]]
    base = variant(key, joint=joint, without=rest)
    gaps = [least + (end - least) * share for share in (0, 0.12, 0.3, 0.6)]
    masses = [
        best(base.changed({"requirements.seal_gap.max": gap})).objective_value for gap in gaps
    ]
    return [*map(list, zip(gaps, masses, strict=True)), [end, free.objective_value]]


def stiffness_curve(key: str, joint: str, lacks: list[Data], limit: float) -> list[list[float]]:
    """(stiffness asked for, mass), up to the most this wall reaches within its bounds."""
    rest = tuple(row["metric"] for row in lacks)
    goal = {"maximise": "stiffness_min"}
    most = best(
        variant(key, joint=joint, without=(*rest, "stiffness_min"), goal=goal)
    ).objective_value
    base = variant(key, joint=joint, without=rest)
    asked = [0.65 * limit, 0.8 * limit, 0.9 * limit, limit]
    asked += [limit + (most - limit) * share for share in (0.35, 0.6, 0.8, 0.93, 0.998)]
    return [
        [k, best(base.changed({"requirements.stiffness_min.min": k})).objective_value]
        for k in asked
    ]


def one(key: str, given: Data) -> Data:
    """Everything about one barrel."""
    found = {"bond": solved(key, prices=key not in METALS)}
    if key in METALS:
        found["thread"] = solved(key, joint="thread", prices=True)
    joint = min(found, key=lambda name: (len(found[name][1]), found[name][0].objective_value))
    optimum, lacks = found[joint]
    if key in METALS and joint == "bond":
        optimum, lacks = solved(key, prices=True)
    limits = [given["limits"][name] for name in ("seal_gap", "stiffness_min")]
    numbers = measured(optimum.evaluation) | {
        "joint": joint,
        "conflicts": lacks,
        "mass": optimum.objective_value,
        "status": optimum.status,
        "relaxed": relaxed(optimum),
        "gap_curve": gap_curve(key, joint, lacks, limits[0]),
        "stiffness_curve": stiffness_curve(key, joint, lacks, limits[1]),
        "joints": {
            name: {"mass": other.objective_value, "conflicts": missed}
            for name, (other, missed) in found.items()
        },
        "design": variant(key, joint=joint).source.text,  # type: ignore[union-attr]
    }
    if lacks:
        return numbers | composite(key, optimum)
    caps = best(variant(key, joint=joint).changed({"caps.material": CAPS}))
    numbers["caps"] = None if caps.infeasibility else caps.objective_value
    return numbers if key in METALS else numbers | composite(key, optimum)


def composite(key: str, optimum: Any) -> Data:
    """What only a composite wall has: criteria, cure stress, and a thin form of its theory."""
    thin, lacks = solved(key, model="thin_laminate")
    exact = ao.evaluate(ao.Actuator(thin.design).changed({"barrel.model": "auto"}))
    room = "20 degC"  # the temperature at which the parts are joined
    return {
        "criteria": {name: first_ply(optimum, {"barrel.criterion": name}) for name in CRITERIA},
        "uncured": first_ply(optimum, {"environment.cure_temperature": room}),
        "differences": {row.name: [row.exact, row.thin] for row in _differences(optimum)},
        "thin": {"mass": thin.objective_value, "conflicts": lacks, "exact": measured(exact)},
    }


def _differences(optimum: Any) -> Any:
    return optimum.evaluation.wall.differences


def given() -> Data:
    """The numbers of the task itself, from knee.yaml."""
    design = ao.read(DESIGNS / "knee.yaml").design
    rows = ao.evaluate(design).requirements
    return {
        "limits": {row.metric: row.limit for row in rows},
        "supply": design.supply.pressure,
        "proof_ratio": design.supply.proof_ratio,
        "stroke": design.cylinder.stroke,
        "clearance": design.piston.clearance,
        "cases": [[c.name, c.direction, c.force, c.speed] for c in design.load_cases],
        "friction_coefficient": design.seals.piston.friction_coefficient,
        "cure": design.environment.cure_temperature,
        "thickest": 8e-3,
    }


def compute() -> Data:
    """The whole study as plain numbers, SI."""
    task = given()
    study = {"given": task, "version": ao.__version__}
    study["variants"] = {key: one(key, task) for key in WALLS}
    other = {
        key: best(ao.read(text.replace(FIBRE, OTHER_FIBRE))).objective_value
        for key in ("lined", "linerless")
        if (text := study["variants"][key]["design"])
    }
    wrapped = best(variant("lined", wall=WALLS["lined"][:2]))
    bare = ao.load_library().get(BARE).numbers["friction_coefficient"]
    linerless = ao.Actuator(best(variant("linerless")).design)
    rubbing = ao.evaluate(linerless.changed({"seals.piston.friction_coefficient": bare}))
    huge = variant("cloth", wall=[layer(CLOTH, HUGE_WALL, "") | {"bounds": {}}])
    huge = huge.changed({"cylinder.bore": study["variants"]["cloth"]["bore"]})
    return study | {
        "other_fibre": other,
        "hoop_only": {"mass": wrapped.objective_value} | measured(wrapped.evaluation),
        "bare": {
            "coefficient": bare,
            "friction": rubbing.metrics["friction_running"].value,
        },
        "huge_wall": {
            "wall": huge.design.barrel.layup[0].thickness,
            "growth": ao.evaluate(huge).metrics["bore_growth"].value,
        },
        "baseline": best(ao.read(DESIGNS / "steel_baseline.yaml")).objective_value,
    }
