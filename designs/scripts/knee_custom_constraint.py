"""A joint has only so much room: a width limit of one's own, and what each millimetre costs.

Between the side plates of the knee stand the skirt of the actuator's caps and, beside it, the pipe
that takes its oil back. How wide that is follows from bore, wall and skirt, and the pipe from the
bore again. The tool knows no such width: it is declared here, required, and optimised, from what
the knee takes with no limit to the least that any knee takes.

    python designs/scripts/knee_custom_constraint.py                  # prints the tables
    python designs/scripts/knee_custom_constraint.py --out reports    # and writes the report there
    python designs/scripts/knee_custom_constraint.py --quick          # few widths
    actuator-opt optimise KNEE.yaml --plugin designs/scripts/knee_custom_constraint.py
"""

from __future__ import annotations

from math import ceil, floor, pi
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.base.numeric import sqrt
from actuator_opt.base.tables import aligned
from actuator_opt.rendering.axes import Axes
from actuator_opt.rendering.blocks import Drawing
from actuator_opt.rendering.ink import BLUE, RED, WHITE, Ink
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
RUNNING = 1.5e-3
"""Room on either side of skirt and pipe, m: own choice, for what the side plates give."""
RETURN_SPEED = 3.05
"""Oil in the return pipe, m/s: Parker, Sizing tube to maximize hydraulic system efficiency."""
PIPE_WALL = 1e-3
"""Of the return pipe, m: own choice."""
LAYERS = 3
LONGEST = 6.0
"""Most length of a skirt over its wall: own rule, a thinner one chatters in the lathe."""
SHARES = (0.15, 0.3, 0.5, 0.7, 0.85)
QUICK = (0.5,)
"""Where limits lie between what costs nothing and the least within reach."""
STEP = 0.1e-3
"""Change of the limit for the check of a price by solving again, m."""
SIZES = {
    "cylinder.bore": "bore",
    "retention.wall": "skirt's wall",
    "retention.length": "skirt's length",
    "rod.outer_diameter": "rod",
}


def skirt_diameter(design: Any) -> Any:
    """Outer diameter of the caps' skirts over the barrel."""
    wall = sum(design[f"barrel.layup[{k}].thickness"] for k in range(LAYERS))
    return design["cylinder.bore"] + 2 * (wall + design["retention.wall"])


def return_pipe(design: Any) -> Any:
    """Outer diameter of the pipe that takes the head side's oil back as the rod swings in."""
    area = pi / 4 * design["cylinder.bore"] ** 2
    flow = area * design["load_cases[swing].speed"]
    return sqrt(4 / pi * flow / RETURN_SPEED) + 2 * PIPE_WALL


@ao.metric(
    "joint_width", dimension="length", unit_name="mm", label="width taken between the plates"
)
def joint_width(design: Any) -> Any:
    """Skirt and return pipe side by side, with room on either side of each."""
    return skirt_diameter(design) + return_pipe(design) + 3 * RUNNING


@ao.constraint("turned_skirt", label="room to the longest skirt that can be turned")
def turned_skirt(design: Any) -> Any:
    """Relative margin, at least 0: the skirt is at most LONGEST walls long."""
    return LONGEST * design["retention.wall"] / design["retention.length"] - 1


def wishes(
    *, width: float | None = None, goal: str = "", own: bool = True, still: bool = False
) -> ao.Actuator:
    """The knee: a width to stay within, another goal; no `own` rules, or nothing that moves."""
    data = yaml.load(DESIGN.read_text("utf-8"), Loader=yaml.BaseLoader)
    if width is not None:
        data["requirements"]["joint_width"] = {"max": f"{width!r} m"}
    if goal:
        data["objective"] = {"minimise": goal}
    if still:
        del data["variables"]
    plugins = (joint_width, turned_skirt) if own else ()
    return ao.read(yaml.safe_dump(data, sort_keys=False), plugins=plugins)


def solved(
    width: float | None = None, start: Data | None = None, *, goal: str = "", priced: bool = False
) -> Data:
    """The lightest knee within a width, searched from a neighbour's dimensions."""
    knee = wishes(width=width, goal=goal).changed(start or {})
    return measured(ao.optimise(knee, starts=1 if start else 4, prices=priced), width)


def measured(found: Any, width: float | None = None) -> Data:
    """The numbers of an optimum, SI."""
    metrics, values = found.evaluation.metrics, {v.path: v.value for v in found.variables}
    return {
        "asked": width,
        "status": found.status,
        "mass": metrics["mass"].value,
        "width": metrics["joint_width"].value if "joint_width" in metrics else None,
        "skirt": float(skirt_diameter(values)),
        "wall": sum(values[f"barrel.layup[{k}].thickness"] for k in range(LAYERS)),
        "values": values,
        "parts": dict(found.evaluation.mass_parts),
        "binds": [] if found.kkt is None else sorted(set(found.kkt.active)),
        "price": next(
            (
                row.price
                for row in found.sensitivities
                if row.parameter == "requirements.joint_width.max"
            ),
            None,
        ),
    }


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    before = measured(ao.optimise(wishes(own=False), starts=4, prices=False))
    free = solved()
    least = solved(start=free["values"], goal="joint_width")
    shares, start, rows = QUICK if quick else SHARES, free["values"], []
    for share in shares:
        width = free["width"] + share * (least["width"] - free["width"])
        rows.append(solved(width, start))
        start = rows[-1]["values"]
    middle = rows[len(rows) // 2]
    after = solved(middle["asked"], middle["values"], priced=True)
    near = [solved(middle["asked"] + step, middle["values"]) for step in (-STEP, STEP)]
    study = {
        "version": ao.__version__,
        "before": before,
        "free": free,
        "rows": rows,
        "least": least,
        "after": after,
        "slopes": [(row["mass"] - after["mass"]) / (row["asked"] - after["asked"]) for row in near],
    }
    return rounded(study)


# ---- what it says: prices in kg/m are g/mm ----


def taken(row: Data) -> float:
    """The width of a row, mm."""
    return 1e3 * float(row["width"])


def points(study: Data) -> list[Data]:
    """From what costs nothing to the least width."""
    return [study["free"], *study["rows"], study["least"]]


def lead(study: Data) -> list[str]:
    """What the study says, in sentences."""
    free, after, least, before = (study[key] for key in ("free", "after", "least", "before"))
    rule = 1e3 * (free["mass"] - before["mass"])
    more = {name: 1e3 * (after["parts"][name] - free["parts"][name]) for name in free["parts"]}
    order = sorted(more, key=lambda name: -abs(more[name]))[:3]
    parts = ", ".join(f"{name} {number(more[name], 2, signed=True)} g" for name in order)
    below, above = (number(one, 3) for one in study["slopes"])
    return [
        f"With no limit the knee is {fixed(taken(free), 1)} mm wide with its return pipe and"
        f" weighs {fixed(1e3 * free['mass'], 1)} g; the rule for turned skirts"
        + (
            " binds nowhere and costs nothing."
            if rule < 5e-4
            else f" costs {number(rule, 2)} g of it."
        ),
        f"Within {fixed(taken(after), 1)} mm it weighs {fixed(1e3 * after['mass'], 1)} g ({parts}):"
        f" there a millimetre less costs {number(-after['price'], 3)} g by the multiplier."
        f" Solved again {number(1e3 * STEP, 2)} mm narrower and wider the mean slopes are {below}"
        f" and {above} g/mm.",
        f"No knee within the bounds of the file is narrower than {fixed(taken(least), 1)} mm; that"
        f" one weighs {fixed(1e3 * least['mass'], 1)} g.",
    ]


def width_rows(study: Data) -> list[list[str]]:
    """Heads and rows: mass and dimensions over the width."""
    heads = ["width, mm", "mass, g", "g per mm", "skirt over, mm", "wall, mm"]
    rows, last = [[*heads, *(f"{name}, mm" for name in SIZES.values())]], None
    for row in points(study):
        slope = (
            "" if last is None else (row["mass"] - last["mass"]) / (row["width"] - last["width"])
        )
        rows.append(
            [
                fixed(taken(row), 2),
                fixed(1e3 * row["mass"], 1),
                slope if slope == "" else number(slope, 3),
                fixed(1e3 * row["skirt"], 2),
                fixed(1e3 * row["wall"], 2),
                *(fixed(1e3 * row["values"][path], 2) for path in SIZES),
            ]
        )
        last = row
    return rows


def change_rows(study: Data) -> list[list[str]]:
    """Heads and rows: the optimum with neither rule, with that of the skirt, with both."""
    heads = [
        "",
        "as shipped",
        "with the skirt's rule",
        f"within {fixed(taken(study['after']), 1)} mm",
    ]
    found = [study[key] for key in ("before", "free", "after")]
    rows = [heads, ["mass, g", *(fixed(1e3 * row["mass"], 2) for row in found)]]
    rows += [
        [f"{name}, g", *(fixed(1e3 * row["parts"][name], 2) for row in found)]
        for name in study["before"]["parts"]
    ]
    rows += [
        [f"{path}, mm", *(fixed(1e3 * row["values"][path], 2) for row in found)]
        for path in study["before"]["values"]
        if not path.endswith(("squeeze", "angle"))
    ]
    return rows


def binds(study: Data) -> str:
    """What binds besides, before and after."""
    first, last = ({one.split(" (")[0] for one in study[key]["binds"]} for key in ("free", "after"))
    said = [f"new: {', '.join(sorted(last - first))}"] if last - first else []
    said += [f"no more: {', '.join(sorted(first - last))}"] if first - last else []
    return f"What binds changes: {'; '.join(said) or 'nothing'}."


def drawing(study: Data) -> Ink:
    """Mass over the width, with the price as a tangent."""
    rows = points(study)
    xs, ys = [taken(row) for row in rows], [1e3 * row["mass"] for row in rows]
    ink = Ink(186.0, 62.0)
    room = 0.15 * (xs[0] - xs[-1])
    span = (10 * floor(0.1 * min(ys) - 0.5), 10 * ceil(0.1 * max(ys) + 0.5))
    axes = Axes(ink, (12.0, 8.0, 150.0, 42.0), (xs[-1] - room, xs[0] + 3 * room), span)
    axes.frame("Mass, g", "width allowed between the side plates, mm")
    ink.path(axes.clipped([xs[0] + 3 * room, *xs], [ys[0], *ys]), stroke=BLUE, pen=0.5)
    for x, y in zip(xs, ys, strict=True):
        ink.circle(axes.x(x), axes.y(y), 0.7, stroke=BLUE, fill=WHITE if x == xs[-1] else BLUE)
    after = study["after"]
    x, y, paid = taken(after), 1e3 * after["mass"], after["price"]
    ends = [x - room, x + room]
    line = axes.clipped(ends, [y + paid * (end - x) for end in ends])
    ink.path(line, stroke=RED, pen=0.3, dash=(1.6, 0.8))
    words = f"{number(paid, 3)} g per mm, by the multiplier"
    ink.text(axes.x(x) + 4.0, axes.y(y) - 4.0, words, color=RED, halo=True)
    ink.text(axes.x(xs[-1]) + 3.0, axes.y(ys[-1]) - 1.5, "the narrowest", halo=True)
    ink.text(axes.x(xs[0]) + 2.0, axes.y(ys[0]) - 3.0, "no limit")
    return ink


SLOPE = "g per mm: mean slope from the row above."


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets: the same numbers give the same bytes."""
    return study_report(
        __file__,
        study,
        title="What the room in the joint costs",
        heading="A rule of one's own: the room in the joint, and what a millimetre costs",
        lead=lead(study),
        blocks=[
            Drawing("What the width costs", drawing(study)),
            grid_table("Over the width", width_rows(study), SLOPE),
            grid_table(
                "Before and after", change_rows(study), binds(study), words=[0], widths={0: 1}
            ),
        ],
    )


def printed(study: Data) -> str:
    """The tables, and what they say."""
    tables = [
        aligned(rows, right=range(1, len(rows[0])))
        for rows in (width_rows(study), change_rows(study))
    ]
    return "\n".join([tables[0], "", SLOPE, "", tables[1], "", *lead(study), binds(study)])


def main() -> None:
    """Print the tables; write the report where a folder is named."""
    description = "what the room in the joint costs in grams"
    print(run_script(__file__, description, compute, printed, page, quick="few widths"))


if __name__ == "__main__":
    main()
