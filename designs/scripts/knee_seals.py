"""What the seals of the knee cost: grams over friction, leakage and squeeze, each re-optimised.

The bonded knee is re-optimised for least mass over the running friction allowed: with its
rings as they stand, with ring sections and clearances free too, and with these on an oil film.
Compounds, sections and back-up rings are enumerated as choices. Prices come from the multipliers
and are checked by solving again; closed forms stand beside the models.

    python designs/scripts/knee_seals.py                  # prints the tables
    python designs/scripts/knee_seals.py --out reports    # and writes the report there
    python designs/scripts/knee_seals.py --quick          # few points
"""

from __future__ import annotations

from functools import cache
from math import ceil, floor, inf, pi
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.models.contact_profile import o_ring_mean
from actuator_opt.models.elastomer import modulus_gent
from actuator_opt.models.seals import LAWS
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

DESIGN = Path(__file__).resolve().parents[1] / "knee_bonded.yaml"
PLACES = ("piston", "rod")
VARIANTS = {
    "shipped": "rings of 1.78 mm, by coefficient",
    "free": "free rings, by coefficient",
    "film": "free rings, on their oil film",
}
SHORT = {"shipped": "1.78 mm", "free": "free", "film": "free, film"}
SHIPPED = 1.78e-3
"""Section of the knee's rings as they stand, m."""
FREED = {
    "seals.piston.section": ("1 mm", "2.62 mm"),
    "seals.rod.section": ("1 mm", "2.62 mm"),
    "piston.clearance": ("15 um", "60 um"),
    "head.clearance": ("15 um", "60 um"),
}
"""What is free besides the variables of the knee: from the smallest ring that gland tables know to
the second AS568 one; clearances about half to twice those of the knee."""
COMPOUNDS = ("nbr_70", "nbr_90")
SECTIONS = ("1.78 mm", "2.62 mm")
BACK_UP = ("back_up", "back_up_material", "back_up_thickness")
SHARES = (0.1, 0.25, 0.5)
FILM_SHARES = (0.5,)
"""Where limits lie between the least friction within reach and what costs nothing."""
PRICED = ("friction_running", "rod_leakage", "seal_squeeze")
UNITS = {"friction_running": "N", "rod_leakage": "mm³", "seal_squeeze": "%"}
SCALES = {"friction_running": 1.0, "rod_leakage": 1e-9, "seal_squeeze": 0.01}
LIMITS = {
    "friction_running": "running friction",
    "rod_leakage": "oil left outside, a double stroke",
    "seal_squeeze": "smallest squeeze",
}
SENSE = {"friction_running": "max", "rod_leakage": "max", "seal_squeeze": "min"}
LEAK_SHARE = 0.9
"""The leakage allowed where it is priced, over what the rod loses with no limit."""
STEP = 1e-3
"""Relative change of a limit for the check of a price by solving again, without films."""
TIGHT = 0.19
"""Squeeze that every search on a film begins from: the films are tabulated over what moves them
there, and below 15 % the contact hardly depends on squeeze, so that it would be left out."""
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
    fixed_rings: bool = False,
    bare: bool = False,
    still: bool = False,
) -> ao.Actuator:
    """The knee of a variant: limits set (None: left out), another goal, choices.

    `fixed_rings`: sections stay; `bare`: no back-up rings; `still`: nothing moves.
    """
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
            if not (fixed_rings and path.endswith("section")):
                data["variables"][path] = {"lower": lower, "upper": upper}
    for name, limit in (limits or {}).items():
        data["requirements"].pop(name, None)
        if limit is not None:
            data["requirements"][name] = {SENSE[name]: _text(name, limit)}
    if goal:
        data["objective"] = {"minimise": goal}
    if still:
        del data["variables"]
    if choices:
        data["choices"] = choices
    return ao.read(yaml.safe_dump(data, sort_keys=False))


def _text(name: str, value: float) -> str:
    return f"{value / SCALES[name]!r} {UNITS[name].replace('³', '^3')}"


def solved(knee: ao.Actuator, start: Data | None = None) -> Data:
    """The optimum, searched from a neighbour's dimensions, with the closed forms beside it."""
    return measured(ao.optimise(_tabled(knee.changed(start or {})), starts=1, prices=False))


def _tabled(knee: ao.Actuator) -> ao.Actuator:
    """The design from which a search on films begins; others as they are."""
    if knee.design.seals.rod.friction != "film":
        return knee
    return knee.changed({f"seals.{name}.squeeze": TIGHT for name in PLACES})


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

    F = mu pi (D f_p + d f_r) with f = (10/11) b p, b the contact width: the pressure's part of the
    line load, in the case that drives the rod chamber.
    """
    supply, back = design.supply.pressure, design.supply.return_pressure
    sealed = (
        (design.seals.piston, design.cylinder.bore, supply - back),
        (design.seals.rod, design.rod.outer_diameter, supply),
    )
    loads = [
        diameter
        * o_ring_mean(sealed_pressure=pressure, outer_pressure=0.0, excess=0.0)
        * LAWS[seal.law].contact_width(
            squeeze=seal.squeeze,
            section=seal.section,
            youngs_modulus=moduli()[1],
            pressure=pressure,
        )
        for seal, diameter, pressure in sealed
    ]
    return {"around": pi * float(sum(loads))}


def coulomb(row: Data, variant: str) -> float:
    """Friction of the same rings and dimensions by the coefficient, N."""
    same = wishes("shipped" if variant == "shipped" else "free", still=True).changed(row["values"])
    found = ao.evaluate(same).metrics["friction_running"].value
    assert found is not None
    return float(found)


def series(variant: str, shares: tuple[float, ...]) -> list[Data]:
    """Optima from where friction is free over what is required to the least within reach."""
    name = "friction_running"
    free = solved(wishes(variant, limits={name: None}))
    least = solved(wishes(variant, limits={name: None}, goal=name), free["values"])
    low, high = least["metrics"][name], free["metrics"][name]
    limits = {low + share * (high - low) for share in shares} | {_required(name)}
    rows, start = [free | {"asked": None}], free["values"]
    for asked in sorted(limits, reverse=True):
        rows.append(solved(wishes(variant, limits={name: asked}), start) | {"asked": asked})
        start = rows[-1]["values"]
    rows.append(least | {"asked": low})
    return [row | {"coulomb": coulomb(row, variant)} for row in rows]


def on_film(row: Data) -> Data:
    """The same design with its seals on their film, evaluated alone."""
    found = ao.evaluate(wishes("film", still=True).changed(row["values"])).metrics
    kept = {name: one.value for name, one in found.items() if name in METRICS}
    return row | {"status": "evaluated", "metrics": kept}


def priced(variant: str, limits: dict[str, float | None], start: Data | None = None) -> Data:
    """An optimum with its prices, and the mean slopes to a limit below and one above each."""
    knee = wishes(variant, limits=limits).changed(start or {})
    found = ao.optimise(_tabled(knee), starts=1, prices=True)
    base = measured(found)
    at = {name: limits.get(name) or _required(name) for name in base["prices"]}
    slopes = {}
    for name, limit in at.items():
        if variant == "film":  # the re-solves of the price table: the films are tabulated once
            row = next(s for s in found.sensitivities if s.parameter.split(".")[1] == name)
            ends, step = [row.resolved_minus10, row.resolved_10], 0.1 * limit
        else:
            near = [limits | {name: limit * (1 + side * STEP)} for side in (-1, 1)]
            ends = [solved(wishes(variant, limits=one), start)["mass"] for one in near]
            step = STEP * limit
        below, above = ends
        slopes[name] = [
            None if below is None else (base["mass"] - below) / step,
            None if above is None else (above - base["mass"]) / step,
        ]
    return base | {"slopes": slopes, "at": at}


def _required(name: str) -> float:
    limit = ao.read(DESIGN).design.requirements[name]
    value = limit.max if SENSE[name] == "max" else limit.min
    assert value is not None
    return value


def enumerated(bare: bool, quick: bool) -> list[Data]:
    """The best sections of every pair of compounds, with or without back-up rings."""
    sections = SECTIONS[:1] if quick else SECTIONS
    lists = {f"seals.{name}.compound": list(COMPOUNDS) for name in PLACES}
    if quick:
        lists["seals.piston.compound"] = [COMPOUNDS[1]]
    lists |= {f"seals.{name}.section": list(sections) for name in PLACES}
    knee = wishes("free", choices=lists, fixed_rings=True, bare=bare)
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
            again = wishes("free", fixed_rings=True, bare=bare)
            row |= solved(again, start) | {"looked": one.objective}
        rows[pair] = row
    return list(rows.values())


def coefficients() -> Data:
    """Coefficient of friction as stated for the knee, and that between the rough faces."""
    seal = ao.read(DESIGN).design.seals.rod
    numbers = ao.load_library().get(seal.compound).numbers
    return {"stated": seal.friction_coefficient, "asperities": numbers["asperity_friction"]}


@cache
def moduli() -> tuple[float, ...]:
    """Young's modulus of the knee's compound at 5 Shore A less, as stated, 5 more, Pa."""
    hardness = ao.load_library().get(ao.read(DESIGN).design.seals.rod.compound).numbers["hardness"]
    return tuple(float(modulus_gent(hardness=hardness + scatter)) for scatter in (-5, 0, 5))


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    shares = () if quick else SHARES
    rows = {name: series(name, shares) for name in ("shipped", "free")}
    on_films = [on_film(row) for row in rows["free"][:-1]] if quick else series("film", FILM_SHARES)
    rows["film"] = on_films
    prices = {"free": priced("free", {})}
    if not quick:
        prices["shipped"] = priced("shipped", {})
        near = next(row for row in on_films if row["asked"] == _required("friction_running"))
        limits = {"rod_leakage": LEAK_SHARE * near["metrics"]["rod_leakage"]}
        prices["film"] = priced("film", limits, near["values"])
    study = {
        "version": ao.__version__,
        "required": _required("friction_running"),
        "coefficients": coefficients(),
        "moduli": list(moduli()),
        "series": rows,
        "prices": prices,
        "choices": [
            row for bare in ((True,) if quick else (False, True)) for row in enumerated(bare, quick)
        ],
    }
    return rounded(study)


def grams(found: float, name: str) -> float:
    """A price in g per unit of the page."""
    return 1e3 * found * SCALES[name]


def _asked(variant: str, row: Data) -> tuple[str, str]:
    """Which rings, and the friction allowed."""
    if row["status"] == "evaluated":
        return "same, film", ""
    return SHORT[variant], "any" if row["asked"] is None else fixed(row["asked"], 0)


def series_rows(study: Data) -> list[list[str]]:
    """Heads and rows: friction allowed, mass, rings, what the rings do."""
    heads = [
        "rings",
        "friction allowed, N",
        "solved, N",
        "Coulomb, N",
        "pressure alone, N",
        "mass, g",
    ]
    sizes = ["bore, mm", "section, mm", "squeeze, %"]
    does = [
        "breakaway, N",
        "wear, kN/mm",
        "extrusion factor",
        "damping, kN·s/m",
        "left outside, mm³",
    ]
    rows = [[*heads, *sizes, *does]]
    for variant, found in study["series"].items():
        for row in found:
            v, m = row["values"], row["metrics"]
            sections = [v.get(f"seals.{name}.section", SHIPPED) for name in PLACES]
            rows.append(
                [
                    *_asked(variant, row),
                    fixed(m["friction_running"], 0),
                    fixed(row["coulomb"], 0),
                    fixed(study["coefficients"]["stated"] * row["around"], 0),
                    fixed(1e3 * row["mass"], 1),
                    fixed(1e3 * v["cylinder.bore"], 2),
                    " / ".join(fixed(1e3 * size, 2) for size in sections),
                    " / ".join(fixed(100 * v[f"seals.{name}.squeeze"], 1) for name in PLACES),
                    fixed(m["friction_breakaway"], 0),
                    fixed(1e-6 * m["seal_wear"], 2),
                    fixed(m["extrusion_factor"], 2),
                    fixed(1e-3 * m["damping_seal"], 2),
                    fixed(1e9 * m["rod_leakage"], 1) if variant == "film" else "",
                ]
            )
    return rows


def choice_rows(study: Data) -> list[list[str]]:
    """Heads and rows: the best rings of every pair of compounds, with and without back-up rings."""
    rows = [
        [
            "piston / rod",
            "back-ups",
            "rings, mm",
            "mass, g",
            "friction, N",
            "breakaway, N",
            "wear, kN/mm",
            "extrusion",
            "meet all",
            "what misses",
        ]
    ]
    for row in sorted(study["choices"], key=lambda one: one.get("mass", 9.0)):
        names = " / ".join(name.replace("_", " ").upper() for name in row["compounds"])
        sizes = [1e3 * row["chosen"][f"seals.{name}.section"] for name in PLACES]
        m = row.get("metrics", {})
        shown = (
            [
                fixed(1e3 * row["mass"], 1),
                fixed(m["friction_running"], 0),
                fixed(m["friction_breakaway"], 0),
                fixed(1e-6 * m["seal_wear"], 2),
                number(m["extrusion_factor"], 3),
            ]
            if m
            else [""] * 5
        )
        rows.append(
            [
                names,
                "none" if row["bare"] else "both / one",
                " / ".join(fixed(size, 2) for size in sizes),
                *shown,
                f"{row['feasible']} of {row['tried']}",
                "" if m else row["status"].partition(": ")[2],
            ]
        )
    return rows


def price_rows(study: Data) -> list[list[str]]:
    """Heads and rows: prices by the multiplier and by solving again."""
    rows = [["design", "limit", "at", "unit", "below, g", "price, g", "above, g"]]
    for variant, base in study["prices"].items():
        for name, ends in base["slopes"].items():
            below, above = ("" if one is None else number(grams(one, name), 3) for one in ends)
            rows.append(
                [
                    VARIANTS[variant],
                    LIMITS[name],
                    number(base["at"][name] / SCALES[name], 4),
                    UNITS[name],
                    below,
                    number(grams(base["prices"][name], name), 3),
                    above,
                ]
            )
    return rows


def lead(study: Data) -> list[str]:
    """What the study says, in sentences."""
    rows = study["series"]
    shipped, free, film = (rows[name] for name in VARIANTS)
    base = {name: study["prices"][name] for name in study["prices"]}
    tight, wide = base.get("shipped"), base["free"]
    least = [fixed(found[-1]["asked"] or 0.0, 0) for found in (shipped, free, film)]
    said = [
        f"At the required {fixed(study['required'], 0)} N the knee weighs"
        f" {fixed(1e3 * wide['mass'], 1)} g with free sections and clearances, where"
        f" {_paid(wide)}.",
        f"The least friction within reach is {least[0]} N with rings of 1.78 mm and {least[1]} N"
        " with free ones, by coefficient"
        + (f"; {least[2]} N with free ones on the film." if optima(film) else "."),
    ]
    if tight:
        more = 1e3 * (tight["mass"] - wide["mass"])
        said[0] += (
            f" With its rings of 1.78 mm and clearances of 30 µm it weighs {fixed(more, 1)} g more"
            f" and {_paid(tight)}."
        )
    return said


def _paid(row: Data) -> str:
    """What a newton less costs at an optimum; nothing where friction stays below its limit."""
    paid = row["prices"].get("friction_running")
    if paid is None:
        running = fixed(row["metrics"]["friction_running"], 0)
        return f"friction runs at {running} N and its limit costs nothing"
    return f"a newton less costs {number(abs(grams(paid, 'friction_running')), 2)} g"


def optima(rows: list[Data]) -> list[Data]:
    """The rows that are optima, not only evaluated on their films."""
    return [row for row in rows if row["status"] != "evaluated"]


def drawing(study: Data) -> Ink:
    """Mass over the friction allowed, one curve a variant."""
    ink = Ink(186.0, 46.0)
    points = {
        name: [
            (
                min(row["metrics"]["friction_running"], row["asked"] or inf),
                1e3 * row["mass"],
            )
            for row in optima(found)
        ]
        for name, found in study["series"].items()
        if optima(found)
    }
    every = [point for found in points.values() for point in found]
    low, high = min(x for x, _ in every), max(x for x, _ in every)
    least = min(y for _, y in every)
    top = 10 * floor(0.1 * least) + 50
    axes = Axes(
        ink,
        (12.0, 8.0, 160.0, 27.0),
        (10 * floor(0.1 * low - 1), 10 * ceil(0.1 * high + 3)),
        (10 * floor(0.1 * least) - 10, top),
    )
    axes.frame("Mass, g", "running friction allowed, N")
    styles = {
        "shipped": (GREY, (), -2.6),
        "free": (BLUE, (), -3.2),
        "film": (RED, (1.6, 0.8), 2.2),
    }
    right = axes.x_range[1]
    for name, found in points.items():
        color, dash, aside = styles[name]
        *path, (least, _) = found
        xs, ys = [right, *(x for x, _ in path)], [path[0][1], *(y for _, y in path)]
        ink.path(axes.clipped(xs, ys), stroke=color, pen=0.5, dash=dash)
        wall = axes.clipped([least, least], [axes.y_range[0], top])
        ink.path(wall, stroke=color, pen=0.2, dash=(0.6, 0.6))
        ink.text(axes.x(least) + 1, axes.top + 2, "least", color=color, halo=True)
        for x, y in path:
            if y <= top:
                ink.circle(axes.x(x), axes.y(y), 0.7, stroke=color, fill=WHITE)
        left = name == "free"
        x, y = (xs[-1], ys[-1]) if left else (right, ys[0])
        anchor = "left" if left else "right"
        ink.text(axes.x(x), axes.y(y) + aside, VARIANTS[name], color=color, anchor=anchor)
    return ink


def remarks(study: Data) -> Data:
    """What stands under the tables."""
    rows, given = study["series"], study["coefficients"]
    soft, stated, hard = study["moduli"]
    base = study["prices"]["free"]
    preload = base["metrics"]["friction_running"] - given["stated"] * base["around"]
    scatter = [preload * (one / stated - 1) for one in (soft, hard)]
    ratio = given["asperities"] / given["stated"]
    film = rows["film"][0]
    boundary = film["metrics"]["friction_breakaway"] / film["coulomb"]
    running = film["metrics"]["friction_running"] / film["coulomb"]
    off = max(
        (
            abs(row["metrics"]["friction_running"] / row["asked"] - 1)
            for row in rows["film"][1:]
            if row["status"] != "evaluated"
        ),
        default=0.0,
    )
    falling = min(row["metrics"]["damping_ratio"] for row in rows["film"])
    return {
        "series": (
            "Any: no limit on friction; last of each kind: the least friction within reach,"
            " whatever it weighs."
            " Coulomb: the same rings and dimensions with the stated coefficient"
            f" {given['stated']:.2f}, μπDf of both; pressure alone: its part (10/11) μπDbp"
            " with b the contact width, by hand."
            " Rod leakage is told too high: an averaged film passes oil at any gap."
            f" The film takes {given['asperities']:.2f} between rough faces: where no oil carries,"
            f" that alone is {number(ratio, 3)} times the coefficient, and the breakaway on the"
            f" film is {number(boundary, 3)} times; running, the oil carries part of it and"
            f" {number(running, 3)} times are left. Both numbers are known within a factor of two,"
            " so the two models say how friction moves, not which of them is right. The optimiser"
            f" reads the film from a surrogate; tabled anew at the optimum (solved) it is up"
            f" to {number(100 * off, 1)} % off the limit. The damping ratio of the films is"
            f" {number(1e6 * falling, 2)}·10⁻⁶ at least"
            + (
                ": the check (not below 0) is met without a waiver."
                if falling >= 0
                else ": below 0, friction falls with speed and the check is missed."
            )
            + f" Modulus: 5 Shore A less or more change it from {number(1e-6 * stated, 3)} to"
            f" {number(1e-6 * soft, 3)} or {number(1e-6 * hard, 3)} MPa, and the friction as"
            f" required by {fixed(scatter[0], 0)} or {fixed(scatter[1], 0)} N, the preload's share."
        ),
        "choices": (
            "Piston and rod each of the listed compounds and of sections"
            f" {', '.join(SECTIONS)}; the best sections of every pair, solved again from the best"
            " design. Meet all: of the sections tried. A quick look at each combination"
            " is no proof. 210 bar is beyond what NBR 90 bears without back-up rings (207 bar):"
            " the report warns of it, the optimiser does not count it."
        ),
        "prices": (
            "Price: g per unit by the multiplier. Below, above: mean g per unit to an optimum with"
            f" a limit {100 * STEP:g} % lower or higher, on the film 10 %; where mass is convex"
            " the price lies between them. Negative: allowing more saves mass."
        ),
    }


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets: the same numbers give the same bytes."""
    said = remarks(study)
    wide = dict.fromkeys(range(16), "12.2mm") | {
        0: 1, 1: "13mm", 7: "16mm", 8: "16mm", 9: "15.5mm", 11: "14mm",
    }  # fmt: skip
    return study_report(
        __file__,
        study,
        title="What the seals cost",
        heading="The knee's seals: what friction, leakage and squeeze cost in grams",
        lead=lead(study),
        blocks=[
            Drawing("What it weighs", drawing(study)),
            grid_table(
                TITLES["series"], series_rows(study), said["series"], words=[0], widths=wide
            ),
            grid_table(
                TITLES["choices"],
                choice_rows(study),
                said["choices"],
                words=[0, 1, -1],
                widths={-1: 1},
            ),
            grid_table(TITLES["prices"], price_rows(study), said["prices"], words=[0, 1]),
        ],
    )


def printed(study: Data) -> str:
    """The tables, and what they say."""
    lines = []
    for rows in (series_rows(study), choice_rows(study), price_rows(study)):
        lines += [aligned(rows, right=range(1, len(rows[0]) - 1)), ""]
    return "\n".join([*lines, *lead(study)])


def main() -> None:
    """Print the tables; write the report where a folder is named."""
    description = "what the seals of the knee cost in grams"
    print(
        run_script(
            __file__, description, compute, printed, page, quick="few points, one priced design"
        )
    )


if __name__ == "__main__":
    main()
