"""What holds the ends of the flight control actuator best.

`aerospace.yaml` is optimised for least mass with each way to hold its ends: tie rods, bonded caps,
split rings, screwed plugs, and plugs screwed into sleeves. Load cases, requirements and materials
stay; ends that an adhesive does not seal get static seals. A further joint is an entry of `ENDS`.

    python designs/scripts/aerospace_ends.py                  # prints the tables
    python designs/scripts/aerospace_ends.py --out reports    # and writes the report there
    python designs/scripts/aerospace_ends.py --quick          # two ways, from few starts
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.rendering.blocks import Drawing
from actuator_opt.rendering.ink import BLACK, BLUE, GREY, RED, WHITE, Ink, text_width
from actuator_opt.rendering.script_pages import (
    Sheets,
    grid_table,
    rounded,
    run_script,
    study_report,
)
from actuator_opt.rendering.text import fixed

Data = dict[str, Any]

DESIGN = Path(__file__).resolve().parents[1] / "aerospace.yaml"
STATED = "tie_rods"
"""The joint of the design file, whose block and variables are used as they are."""
ENDS: dict[str, tuple[str, Data, dict[str, tuple[str, str]]]] = {
    STATED: ("tie rods", {}, {}),
    "bond": (
        "bonded caps",
        {"material": "epoxy_structural", "length": "40 mm", "wall": "3 mm"},
        {"length": ("5 mm", "80 mm"), "wall": ("1 mm", "10 mm")},
    ),
    "retaining_ring": (
        "split rings",
        {
            "material": "steel_bolt_12_9",
            "length": "6 mm",
            "groove_depth": "1 mm",
            "ring_thickness": "3 mm",
            "ring_width": "5 mm",
        },
        {
            "length": ("1 mm", "20 mm"),
            "groove_depth": ("0.3 mm", "3 mm"),
            "ring_thickness": ("1 mm", "8 mm"),
            "ring_width": ("1 mm", "10 mm"),
        },
    ),
    "plug_thread": (
        "screwed plugs",
        {"length": "10 mm", "wall": "2 mm", "thread": {"pitch": "1 mm"}},
        {"length": ("3 mm", "30 mm"), "wall": ("1 mm", "8 mm")},
    ),
    "sleeve": (
        "plugs in sleeves",
        {
            "type": "plug_thread",
            "length": "10 mm",
            "wall": "2 mm",
            "thread": {"pitch": "1 mm"},
            "sleeve": {"material": "ti_6al4v", "wall": "2.5 mm", "inner_length": "20 mm"},
        },
        {
            "length": ("3 mm", "30 mm"),
            "wall": ("1 mm", "8 mm"),
            "sleeve.wall": ("1.8 mm", "8 mm"),
            "sleeve.inner_length": ("3 mm", "80 mm"),
        },
    ),
}
"""Each joint with its name, the keys of its block, and the bounds of its variables.

`type` is stated where it differs from the name here. Sleeves are in one piece with the liner.
"""
CUT = ("retaining_ring", "plug_thread")
"""Joints whose groove or thread is cut into the liner, which starts thicker."""
THICK = {"start": "3 mm", "upper": "8 mm"}
"""Start and upper bound of such a liner."""
SEAL = {"compound": "nbr_90", "section": "2.62 mm", "squeeze": "20 %", "tolerance": "0.05 mm"}
"""Static seals, with the section of the moving ones."""
QUICK = ("tie_rods", "plug_thread")
PARTS = {
    "barrel": ("barrel", GREY),
    "rod": ("rod", BLUE),
    "ends": ("ends: caps, head, fastening", RED),
    "rest": ("piston, seals, eyes", WHITE),
}
"""Groups of parts in the figure, with their names and colours."""
_ENDS = ("caps", "glands", "fastening")


def stated(joint: str) -> Data:
    """The design with this joint, as the data of its file."""
    data: Data = yaml.load(DESIGN.read_text("utf-8"), Loader=yaml.BaseLoader)
    _, block, bounds = ENDS[joint]
    if joint != STATED:
        data["retention"] = {"type": joint, **block}
        variables = data["variables"]
        for path in [path for path in variables if path.startswith("retention.")]:
            del variables[path]
        for key, (lower, upper) in bounds.items():
            variables[f"retention.{key}"] = {"lower": lower, "upper": upper}
    if joint in CUT:
        data["barrel"]["layup"][0]["thickness"] = THICK["start"]
        data["variables"]["barrel.layup[0].thickness"]["upper"] = THICK["upper"]
    if joint != "bond":
        data["seals"]["static"] = dict(SEAL)
    return data


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    joints = QUICK if quick else tuple(ENDS)
    starts = 2 if quick else 6
    return rounded(
        {"version": ao.__version__, "rows": {joint: best(joint, starts) for joint in joints}}
    )


def best(joint: str, starts: int) -> Data:
    """Mass and parts of an optimum, and the limits at the joint that it just meets."""
    text = yaml.safe_dump(stated(joint), sort_keys=False)
    found = ao.optimise(ao.read(text), starts=starts, prices=False)
    if found.status != "optimal":
        card = found.infeasibility
        return {"mass": None, "why": found.status if card is None else card.sentence}
    active = [] if found.kkt is None else sorted(set(found.kkt.active))
    return {
        "mass": found.objective_value,
        "parts": dict(found.evaluation.mass_parts),
        "binds": active,
        "values": {variable.path: variable.value for variable in found.variables},
    }


def grouped(parts: dict[str, float]) -> dict[str, float]:
    """Masses of the groups of the figure."""
    groups = {"barrel": parts["barrel"], "rod": parts["rod"]}
    groups["ends"] = sum(parts[part] for part in _ENDS)
    return groups | {"rest": sum(parts.values()) - sum(groups.values())}


def mass_rows(study: Data) -> list[list[str]]:
    """Heads and rows: masses, and limits at barrel and ends that are just met."""
    rows = [["ends", "mass, g", "barrel, g", "rod, g", "ends, g", "just met, or why none"]]
    for joint, row in study["rows"].items():
        words = ENDS[joint][0]
        if row["mass"] is None:
            rows.append([words, "none", "–", "–", "–", row["why"]])
            continue
        groups = grouped(row["parts"])
        numbers = [fixed(1e3 * groups[name], 0) for name in ("barrel", "rod", "ends")]
        rows.append([words, fixed(1e3 * row["mass"], 0), *numbers, "; ".join(of_ends(row))])
    return rows


def of_ends(row: Data) -> list[str]:
    """Active limits at the joint and in the wall."""
    words = ("retention", "groove", "thread", "tie-rod", "first_ply", "lip", "retained")
    return [name for name in row["binds"] if any(word in name for word in words)]


def lead(study: Data) -> list[str]:
    """Sentences on the lightest, and on the ways that have no design."""
    found = {joint: row["mass"] for joint, row in study["rows"].items() if row["mass"] is not None}
    first = min(found, key=found.__getitem__)
    sentences = [f"Lightest: {ENDS[first][0]}, {fixed(1e3 * found[first], 0)} g."]
    if STATED in found and first != STATED:
        saved = fixed(100 * (1 - found[first] / found[STATED]), 0)
        sentences.append(f"They save {saved} % of the actuator between tie rods.")
    none = [ENDS[joint][0] for joint in study["rows"] if joint not in found]
    if none:
        sentences.append(f"No design meets all requirements with: {', '.join(none)}.")
    return sentences


def drawing(study: Data) -> Ink:
    """A bar for each way, divided into groups of parts."""
    rows = {joint: row for joint, row in study["rows"].items() if row["mass"] is not None}
    ink = Ink(186.0, 7.0 + 9.0 * len(rows))
    scale = 120.0 / max(row["mass"] for row in rows.values())
    for k, (joint, row) in enumerate(rows.items()):
        y = 9.0 + 9.0 * k
        ink.text(0.0, y + 2.75, ENDS[joint][0], size=7.0)
        x = 26.0
        for name, mass in grouped(row["parts"]).items():
            end = x + scale * mass
            corners = [(x, y), (end, y), (end, y + 5.5), (x, y + 5.5)]
            ink.path([corners], fill=PARTS[name][1], stroke=BLACK, pen=0.2, closed=True)
            x = end
        ink.text(x + 2.0, y + 2.75, f"{fixed(1e3 * row['mass'], 0)} g", size=7.0)
    x = 26.0
    for words, colour in PARTS.values():
        corners = [(x, 1.5), (x + 3.0, 1.5), (x + 3.0, 4.5), (x, 4.5)]
        ink.path([corners], fill=colour, stroke=BLACK, pen=0.2, closed=True)
        ink.text(x + 4.5, 3.0, words, size=6.5)
        x += 10.0 + text_width(words, 6.5)
    return ink


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets."""
    return study_report(
        __file__,
        study,
        title="Ends of the flight control actuator",
        heading="How to hold the ends of the flight control actuator",
        lead=lead(study),
        blocks=[
            Drawing("Mass by parts", drawing(study), "Each bar is an optimum of its own."),
            grid_table(
                "Masses",
                mass_rows(study),
                "Just met: active limits at joint and wall.",
                words=[0, -1],
                widths={-1: 1.0},
            ),
        ],
    )


def printed(study: Data) -> str:
    """The table, and the sentences on the result."""
    rows = mass_rows(study)
    return "\n".join([aligned(rows, right=range(1, 5)), "", *lead(study)])


def main() -> None:
    """Print the table; write the report if a folder is named."""
    description = "how to hold the ends of the flight control actuator"
    print(run_script(__file__, description, compute, printed, page, quick="two ways, few starts"))


if __name__ == "__main__":
    main()
