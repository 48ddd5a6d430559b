"""What the seals of the knee cost: grams over friction, leakage and squeeze, each re-optimised.

The knee of knee.yaml is re-optimised for least mass over the running friction allowed: with its
rings as they stand, with ring sections and clearances free too, and with these on an oil film.
Compounds, sections and back-up rings are enumerated as choices. Prices come from the multipliers
and are checked by solving again; closed forms stand beside the models.

    python designs/scripts/knee_seals.py                  # prints the tables
    python designs/scripts/knee_seals.py --out reports    # and writes the report there
    python designs/scripts/knee_seals.py --quick          # few points
"""

from __future__ import annotations

import argparse
import json
from math import ceil, floor, pi
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.models.elastomer import modulus_gent
from actuator_opt.reporting.blocks import column, figure, table
from actuator_opt.reporting.figures import Axes
from actuator_opt.reporting.ink import BLUE, GREY, RED, WHITE, Ink
from actuator_opt.reporting.text import fixed, number
from actuator_opt.reporting.writer import TEMPLATE, sheets
from actuator_opt.tables import aligned

DESIGN = Path(__file__).resolve().parents[1] / "knee.yaml"
PLACES = ("piston", "rod")
VARIANTS = {
    "shipped": "rings of 1.78 mm, by coefficient",
    "free": "free rings, by coefficient",
    "film": "free rings, on their oil film",
}
FREED = {
    "seals.piston.section": ("1 mm", "2.62 mm"),
    "seals.rod.section": ("1 mm", "2.62 mm"),
    "piston.clearance": ("15 um", "60 um"),
    "head.clearance": ("15 um", "60 um"),
}
"""What is free besides the variables of the knee: from the smallest ring that gland tables know to
the second AS568 one; clearances about half to twice those of the knee."""
COMPOUNDS = ("nbr_70", "nbr_90")
SECTIONS = ("1.5 mm", "1.78 mm", "2.62 mm")
BACK_UP = ("back_up", "back_up_material", "back_up_thickness")
SHARES = (0.1, 0.25, 0.5)
"""Where limits lie between the least friction within reach and what costs nothing."""
PRICED = ("friction_running", "rod_leakage", "seal_squeeze")
UNITS = {"friction_running": "N", "rod_leakage": "mm³", "seal_squeeze": "%"}
SCALES = {"friction_running": 1.0, "rod_leakage": 1e-9, "seal_squeeze": 0.01}
SENSE = {"friction_running": "max", "rod_leakage": "max", "seal_squeeze": "min"}
LEAK_SHARE = 0.9
"""The leakage allowed where it is priced, over what the rod loses with no limit."""
STEP = 0.01
"""Relative change of a limit for the check of a price by solving again."""
TIGHT = 0.19
"""Squeeze that every search on a film begins from: the films are tabulated over what moves them
there, and below 15 % the contact hardly depends on squeeze, so that it would be left out."""
PRESSURE_SHARE = 0.72
"""Line load over pressure and section of the plane-strain law, to 15 % of squeeze."""
METRICS = (
    "friction_running",
    "friction_breakaway",
    "seal_wear",
    "extrusion_factor",
    "seal_squeeze",
    "damping_seal",
    "damping_ratio",
    "rod_leakage",
    "leakage",
    "film_thickness",
)
TITLES = {
    "series": "Over the running friction allowed",
    "choices": "Compound, section and back-up rings, every combination tried",
    "prices": "What a unit costs",
}

Data = dict[str, Any]


def wishes(
    variant: str,
    *,
    limits: dict[str, float | None] | None = None,
    goal: str = "",
    choices: dict[str, list[str]] | None = None,
    bare: bool = False,
) -> ao.Actuator:
    """The knee of a variant: limits set (None: left out), another goal, choices, no back-ups."""
    data = yaml.load(DESIGN.read_text("utf-8"), Loader=yaml.BaseLoader)
    for name in PLACES:
        seal = data["seals"][name]
        if variant == "film":
            seal["friction"] = "film"
            del seal["friction_coefficient"]
        if bare:
            for key in BACK_UP:
                del seal[key]
    if variant != "shipped":
        for path, (lower, upper) in FREED.items():
            if path not in (choices or {}):
                data["variables"][path] = {"lower": lower, "upper": upper}
    for name, limit in (limits or {}).items():
        data["requirements"].pop(name, None)
        if limit is not None:
            data["requirements"][name] = {SENSE[name]: _text(name, limit)}
    if goal:
        data["objective"] = {"minimise": goal}
    if choices:
        data["choices"] = choices
    return ao.read(yaml.safe_dump(data, sort_keys=False))


def _text(name: str, value: float) -> str:
    return f"{value / SCALES[name]!r} {UNITS[name].replace('³', '^3')}"


def solved(knee: ao.Actuator, start: Data | None = None, *, priced: bool = False) -> Data:
    """The optimum, searched from a neighbour's dimensions, with the closed forms beside it."""
    begun = knee.changed(start or {})
    if "film" in (seal.friction for seal in (begun.design.seals.piston, begun.design.seals.rod)):
        begun = begun.changed(dict.fromkeys((f"seals.{name}.squeeze" for name in PLACES), TIGHT))
    return measured(ao.optimise(begun, starts=1, prices=priced))


def measured(found: Any) -> Data:
    """The numbers of an optimum, SI; friction also by hand."""
    evaluation = found.evaluation
    known = evaluation.metrics
    values = {v.path: v.value for v in found.variables}
    row = {
        "status": found.status,
        "mass": known["mass"].value,
        "values": values,
        "binds": [] if found.kkt is None else list(found.kkt.active),
        "prices": {
            s.parameter.split(".")[1]: s.price
            for s in found.sensitivities
            if s.active and s.parameter.split(".")[1] in PRICED
        },
        "metrics": {
            name: known[name].value
            for name in METRICS
            if name in known and known[name].value is not None
        },
        "doubts": [str(w) for w in evaluation.warnings if "surrogate" in str(w)],
    }
    return row | by_hand(found.design)


def by_hand(design: Any) -> Data:
    """Friction of the pressure alone, and what a coefficient gives for the same rings.

    F = mu pi (D W_p (p_s - p_r) + d W_r p_s) 0.72: the pressure's part of mu pi d f with the
    plane-strain line load f, in the case that drives the rod chamber.
    """
    supply, back = design.supply.pressure, design.supply.return_pressure
    loads = (
        design.cylinder.bore * design.seals.piston.section * (supply - back),
        design.rod.outer_diameter * design.seals.rod.section * supply,
    )
    return {"around": pi * PRESSURE_SHARE * sum(loads)}


def coulomb(row: Data, variant: str) -> float:
    """Friction of the same rings and dimensions by the coefficient, N."""
    same = wishes("shipped" if variant == "shipped" else "free").changed(row["values"])
    found = ao.evaluate(same).metrics["friction_running"].value
    assert found is not None
    return float(found)


def series(variant: str, shares: tuple[float, ...]) -> list[Data]:
    """Optima from where friction is free to the least friction within reach."""
    name = "friction_running"
    free = solved(wishes(variant, limits={name: None}))
    least = solved(wishes(variant, limits={name: None}, goal=name), free["values"])
    low, high = least["metrics"][name], free["metrics"][name]
    rows, start = [free | {"asked": None}], free["values"]
    for asked in sorted({low + share * (high - low) for share in shares}, reverse=True):
        rows.append(solved(wishes(variant, limits={name: asked}), start) | {"asked": asked})
        start = rows[-1]["values"]
    rows.append(least | {"asked": low})
    for row in rows:
        row["coulomb"] = coulomb(row, variant)
    return rows


def priced(variant: str, limits: dict[str, float | None], start: Data | None = None) -> Data:
    """An optimum with its prices, and each of them again from two more optima."""
    base = solved(wishes(variant, limits=limits), start, priced=True)
    checks = {}
    for name in base["prices"]:
        at = limits.get(name) or _required(name)
        ends = [
            solved(wishes(variant, limits=limits | {name: at * (1 + side * STEP)}), start)["mass"]
            for side in (1, -1)
        ]
        checks[name] = (ends[0] - ends[1]) / (2 * STEP * at)
    return base | {"checks": checks, "limits": {k: v for k, v in limits.items() if v is not None}}


def _required(name: str) -> float:
    limit = ao.read(DESIGN).design.requirements[name]
    return float(limit.max if SENSE[name] == "max" else limit.min)


def enumerated(bare: bool, quick: bool) -> list[Data]:
    """The best sections of every pair of compounds, with or without back-up rings."""
    sections = list(SECTIONS[1:2] if quick else SECTIONS)
    lists = {f"seals.{name}.compound": list(COMPOUNDS) for name in PLACES}
    lists |= {f"seals.{name}.section": list(sections) for name in PLACES}
    knee = wishes("free", choices=lists, bare=bare)
    found = ao.optimise(knee, starts=1, prices=False)
    assert found.choices is not None
    rows: dict[tuple[Any, ...], Data] = {}
    for one in found.choices.combinations:
        pair = tuple(one.values[f"seals.{name}.compound"] for name in PLACES)
        if pair in rows:
            rows[pair]["tried"] += 1
            rows[pair]["feasible"] += one.feasible
            continue
        row: Data = {"compounds": pair, "bare": bare, "tried": 1, "feasible": int(one.feasible)}
        row |= {"status": one.status, "chosen": dict(one.values)}
        if one.feasible:
            start = {v.path: v.value for v in found.variables} | dict(one.values)
            fixed_rings = wishes("free", bare=bare, choices=dict.fromkeys(lists, ["unused"]))
            row |= solved(fixed_rings, start) | {"looked": one.objective}
        rows[pair] = row
    return list(rows.values())


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    rows = {"shipped": series("shipped", (0.5,) if quick else SHARES)}
    rows["free"] = series("free", (0.1,) if quick else SHARES)
    rows["film"] = series("film", (0.3,) if quick else SHARES[1:])
    prices = {"free": priced("free", {})}
    if not quick:
        prices["shipped"] = priced("shipped", {})
        loosest = rows["film"][0]
        asked = LEAK_SHARE * loosest["metrics"]["rod_leakage"]
        limits = {"friction_running": rows["film"][1]["asked"], "rod_leakage": asked}
        prices["film"] = priced("film", limits, rows["film"][1]["values"])
    study = {
        "version": ao.__version__,
        "required": _required("friction_running"),
        "coefficients": coefficients(),
        "moduli": moduli(),
        "series": rows,
        "prices": prices,
        "choices": [row for bare in (False, True) for row in enumerated(bare, quick)],
    }
    text = json.dumps(study, allow_nan=False)
    # seven digits: the last bits of a machine do not show
    found: Data = json.loads(text, parse_float=lambda digits: float(f"{float(digits):.7g}"))
    return found
