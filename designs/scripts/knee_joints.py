"""Which joint of the barrel's ends gives the lightest actuator, over pressure and bore.

Five actuators are optimised for least mass at each pressure and bore: a composite barrel with
bonded caps, composite barrels whose plugs are held by a split ring or a thread in the liner, or by
a thread in a liner that is thicker at its ends, and a steel barrel with screwed caps. The knee is
scaled by the rules of `RULES`, so that all five do the same work.

    python designs/scripts/knee_joints.py                  # prints the tables
    python designs/scripts/knee_joints.py --out reports    # and writes the report there
    python designs/scripts/knee_joints.py --quick          # one pressure, two bores
"""

from __future__ import annotations

from copy import deepcopy
from math import pi
from pathlib import Path
from typing import Any

import yaml

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.rendering.axes import Axes
from actuator_opt.rendering.blocks import Drawing
from actuator_opt.rendering.ink import BLACK, BLUE, GREY, OCHRE, RED, WHITE, Ink, spread_within
from actuator_opt.rendering.script_pages import (
    Sheets,
    grid_table,
    rounded,
    run_script,
    study_report,
)
from actuator_opt.rendering.text import fixed

Data = dict[str, Any]

DESIGNS = Path(__file__).resolve().parents[1]
JOINTS = {
    "bond": ("knee_bonded.yaml", "bonded caps", GREY),
    "sleeve": ("knee.yaml", "thickened liner", OCHRE),
    "retaining_ring": ("knee.yaml", "split rings", BLUE),
    "plug_thread": ("knee.yaml", "screwed plugs", BLACK),
    "thread": ("steel_baseline.yaml", "steel, screwed caps", RED),
}
"""Joints with the design that each scales, its name, and its colour in the figure."""
BLOCKS: dict[str, tuple[Data, dict[str, tuple[str, str]]]] = {
    "retaining_ring": (
        {
            "type": "retaining_ring",
            "material": "steel_bolt_12_9",
            "length": "5.8 mm",
            "groove_depth": "0.4 mm",
            "ring_thickness": "1.3 mm",
            "ring_width": "4.2 mm",
        },
        {
            "length": ("1 mm", "10 mm"),
            "groove_depth": ("0.3 mm", "2 mm"),
            "ring_thickness": ("1 mm", "5 mm"),
            "ring_width": ("1 mm", "5 mm"),
        },
    ),
    "plug_thread": (
        {"type": "plug_thread", "length": "7 mm", "wall": "2.2 mm", "thread": {"pitch": "0.75 mm"}},
        {"length": ("3 mm", "20 mm"), "wall": ("1 mm", "5 mm")},
    ),
}
"""Joints that replace that of the design they scale: their block, and bounds of their variables."""
PRESSURES = (100, 210, 350)
BORES = (16, 20, 25, 32, 40, 50, 63, 80)
QUICK = ((210,), (25, 40))
"""Supply pressures [bar] and bores [mm]; ISO 3320 sizes."""
KNEE_BORE, KNEE_PRESSURE = 21.4, 210.0
"""Bore [mm] and pressure [bar] of the knee, from which the others are scaled."""
KNEE_FORCE = 1e5 * KNEE_PRESSURE * pi / 4 * (1e-3 * KNEE_BORE) ** 2
GROWTH, CLEARANCE = 4.0, 30.0
"""Growth of the bore at the piston seal that the knee may have, and its clearance [um]."""
RULES = (
    "The load grows with pressure times bore area, stroke and required stiffness with the bore.",
    "The bore may grow at the seal by 4 µm at 21.4 mm and 210 bar, in proportion to bore and "
    "pressure; the clearance is always 30 µm.",
    "Rings have sections of 1.78 mm below 28 mm bore, 2.62 mm below 50 mm, and 3.53 mm above.",
    "The nut of the piston is left out.",
    "Friction, seal extrusion, trapped oil and bearing pressure are not limited, as they depend on "
    "the seals and not on the joint. All other requirements are those of the knee.",
    "Cones and double bonds are left out: their searches often end without an optimum, and their "
    "optima in samples were heavier than a thickened liner.",
)
WHY = {
    "bond": "they need no thread, whose least size is too heavy for small and weak ends.",
    "sleeve": "only the ends are thick enough for the thread; between them, the liner is thinner.",
    "retaining_ring": "the tube is thick enough for the groove without more metal at its ends.",
    "plug_thread": "the tube is thick enough for the thread without more metal at its ends.",
    "thread": "stiffness and not pressure sets the wall; steel is as stiff for its mass as "
    "aluminium, and hoop plies add mass but little stiffness.",
}
"""Why a joint is the lightest."""
LEAST = {
    "retention.wall": 1.2, "caps.thickness": 4.6, "retention.length": 3.0, "sleeve.wall": 2.6,
    "sleeve.inner_length": 8.6,
}  # fmt: skip
"""Smallest start of some sizes [mm]."""
SMALLER = (
    "retention.ring_width", "retention.groove_depth", "retention.ring_thickness",
    "retention.length", "caps.thickness", "rod.outer_diameter", "piston.length", "head.length",
    "rod.inner_diameter", "retention.sleeve.inner_length",
)  # fmt: skip
"""Variables whose lower bound is scaled down in actuators that are smaller than the knee."""
FREED = ("extrusion_factor", "trapped_factor", "bearing_factor")


# ---- the scaled designs ----


def times(text: str, factor: float, least: float = 0.0) -> str:
    """A size of the file, scaled; at least `least` in its unit."""
    value, unit = text.split()
    return f"{max(factor * float(value), least)!r} {unit}"


def scaled(joint: str, pressure: float, bore: float) -> Data:
    """The design with this joint at a pressure [bar] and a bore [mm], as the data of its file."""
    data: Data = yaml.load((DESIGNS / JOINTS[joint][0]).read_text("utf-8"), Loader=yaml.BaseLoader)
    size = bore / KNEE_BORE
    load = pressure / KNEE_PRESSURE * size**2
    strong = load**0.5
    data["supply"]["pressure"] = f"{pressure} bar"
    cylinder = data["cylinder"]
    cylinder["bore"] = f"{bore} mm"
    for key, power in (("stroke", 1), ("port_diameter", 1), ("dead_volume_a", 3),
                       ("dead_volume_b", 3)):  # fmt: skip
        cylinder[key] = times(cylinder[key], size**power)
    rod = data["rod"]
    for key in ("outer_diameter", "inner_diameter"):
        rod[key] = times(rod[key], min(strong, 0.6 * bore / 13))
    rod["extension"] = times(rod["extension"], max(size, strong))
    outer = float(rod["outer_diameter"].split()[0])
    thread = float(rod["thread"]["diameter"].split()[0])
    rod["thread"]["diameter"] = f"{min(0.9 * strong * thread, 0.85 * outer)!r} mm"
    for part in ("piston", "head"):
        data[part]["length"] = times(data[part]["length"], max(size, 1))
    data["caps"]["thickness"] = times(data["caps"]["thickness"], strong, LEAST["caps.thickness"])
    data["clevis"]["pin_diameter"] = times(data["clevis"]["pin_diameter"], strong)
    liners = {"bond": 0.45, "sleeve": 0.9}  # the others have a groove or thread in their tube
    for index, layer in enumerate(data["barrel"]["layup"]):
        least = 0.3 if index and joint != "bond" else liners.get(joint, 2.6)
        layer["thickness"] = times(layer["thickness"], strong, least)
    if data["piston"].pop("nut", None):
        data["variables"].pop("piston.nut.preload", None)
    _seals(data["seals"], bore)
    for case in data["load_cases"]:
        for key in case.keys() & {"force", "side_load"}:
            case[key] = times(case[key], load)
    _joint(data, joint, bore, strong)
    _limits(data, size, strong, pressure)
    return data


def _seals(seals: Data, bore: float) -> None:
    section = 1.78 if bore < 28 else 2.62 if bore < 50 else 3.53
    for seal in seals.values():
        seal["section"] = f"{section} mm"
        if "back_up_thickness" in seal:
            seal["back_up_thickness"] = times(seal["back_up_thickness"], section / 1.78)


def _joint(data: Data, joint: str, bore: float, strong: float) -> None:
    """Replace the joint of the design where `BLOCKS` has another; scale its sizes."""
    variables = data["variables"]
    if joint in BLOCKS:
        block, bounds = BLOCKS[joint]
        data["retention"] = deepcopy(block)
        for path in [path for path in variables if path.startswith("retention.")]:
            del variables[path]
        for key, (lower, upper) in bounds.items():
            variables[f"retention.{key}"] = {"lower": lower, "upper": upper}
    _block(data["retention"], "retention", bore, strong)


def _block(block: Data, name: str, bore: float, strong: float) -> None:
    """Scale the sizes of a joint, and of the blocks in it."""
    for key, value in block.items():
        if key == "thread":
            block[key] = {"pitch": "0.75 mm" if bore < 28 else "1 mm" if bore < 50 else "1.5 mm"}
        elif isinstance(value, dict):
            _block(value, key, bore, strong)
        elif key not in ("type", "material"):
            block[key] = times(value, strong, LEAST.get(f"{name}.{key}", 0.0))


def _limits(data: Data, size: float, strong: float, pressure: float) -> None:
    """Scale requirements and bounds; the bore is fixed."""
    variables, limits = data["variables"], data["requirements"]
    variables.pop("cylinder.bore", None)
    variables["barrel.layup[0].thickness"]["upper"] = "5 mm"
    largest, smallest = max(1, strong, size), min(1, size, strong)
    for path, bounds in variables.items():
        if path.endswith(("squeeze", "angle")):
            continue
        bounds["upper"] = times(bounds["upper"], 1.5 * largest)
        if path in SMALLER:
            bounds["lower"] = times(bounds["lower"], smallest)
    limits["stiffness_min"]["min"] = times("10 kN/mm", size)
    growth = GROWTH * size * pressure / KNEE_PRESSURE
    limits["seal_gap"]["max"] = f"{CLEARANCE + growth!r} um"
    limits.pop("friction_running")
    limits |= {name: {"min": "0.1"} for name in FREED}
    data["waivers"] = {"seal_section": "scaled study: the section follows the bore"}


# ---- optima ----


def compute(*, quick: bool = False) -> Data:
    """The whole study as plain numbers, SI."""
    pressures, bores = QUICK if quick else (PRESSURES, BORES)
    starts = 1 if quick else 2
    rows = [
        {"pressure": pressure, "bore": bore} | {joint: best(joint, pressure, bore, starts)
                                                for joint in JOINTS}
        for pressure in pressures
        for bore in bores
    ]  # fmt: skip
    return rounded({"version": ao.__version__, "rows": rows})


def best(joint: str, pressure: float, bore: float, starts: int) -> Data:
    """Mass and parts of an optimum, and the limits at the joint that it just meets."""
    subject = read(joint, pressure, bore)
    found = ao.optimise(subject, starts=starts, prices=False)
    if found.status == "feasible":  # no optimum yet: search on from there
        reached = {variable.path: variable.value for variable in found.variables}
        further = ao.optimise(subject.changed(reached), starts=1, prices=False)
        found = further if further.status == "optimal" else found
    elif found.status != "optimal":
        found = ao.optimise(subject, starts=8, prices=False)
    if found.status not in ("optimal", "feasible"):
        card = found.infeasibility
        return {"mass": None, "why": found.status if card is None else card.sentence}
    active = [] if found.kkt is None else sorted(set(found.kkt.active))
    return {
        "mass": found.objective_value,
        "status": found.status,
        "parts": dict(found.evaluation.mass_parts),
        "binds": active,
        "values": {variable.path: variable.value for variable in found.variables},
    }


def read(joint: str, pressure: float, bore: float) -> ao.Actuator:
    """The scaled design, checked."""
    return ao.read(yaml.safe_dump(scaled(joint, pressure, bore), sort_keys=False))


def masses(row: Data) -> dict[str, float]:
    """Mass of each joint that has a design, by joint."""
    return {joint: row[joint]["mass"] for joint in JOINTS if row[joint]["mass"] is not None}


def lightest(row: Data) -> str:
    """The joint of the lightest actuator."""
    found = masses(row)
    return min(found, key=found.__getitem__)


def mass_rows(study: Data) -> list[list[str]]:
    """Heads and rows: mass of each joint, the lightest, and its lead over steel."""
    rows = [["bar", "bore, mm", *(f"{words}, g" for _, words, _ in JOINTS.values()), "lightest",
             "below steel, %"]]  # fmt: skip
    for row in study["rows"]:
        found, first = masses(row), lightest(row)
        cells = [fixed(1e3 * found[joint], 0) if joint in found else "none" for joint in JOINTS]
        saved = "–"
        if "thread" in found:
            saved = fixed(100 * (1 - found[first] / found["thread"]), 0)
        rows.append(
            [fixed(row["pressure"], 0), fixed(row["bore"], 0), *cells, JOINTS[first][1], saved]
        )
    return rows


def why_rows(study: Data) -> list[list[str]]:
    """Heads and rows: masses of barrel and ends, of the lightest actuator and of steel."""
    rows = [["bar", "bore, mm", "lightest", "barrel, g", "ends, g", "steel barrel, g",
             "steel ends, g"]]  # fmt: skip
    for row in study["rows"]:
        first = lightest(row)
        cells = []
        for joint in (first, "thread"):
            parts = row[joint].get("parts")
            ends = ("caps", "glands", "fastening")
            cells += (
                ["–", "–"]
                if parts is None
                else [
                    fixed(1e3 * parts["barrel"], 0),
                    fixed(1e3 * sum(parts[part] for part in ends), 0),
                ]
            )
        rows.append([fixed(row["pressure"], 0), fixed(row["bore"], 0), JOINTS[first][1], *cells])
    return rows


def lead(study: Data) -> list[str]:
    """Sentences on which joint is lightest where."""
    sentences = []
    for pressure in dict.fromkeys(row["pressure"] for row in study["rows"]):
        winners: dict[str, list[float]] = {}
        for row in study["rows"]:
            if row["pressure"] == pressure:
                winners.setdefault(lightest(row), []).append(row["bore"])
        said = [
            f"{JOINTS[joint][1]} at {', '.join(fixed(bore, 0) for bore in bores)} mm"
            for joint, bores in winners.items()
        ]
        sentences.append(f"Lightest at {fixed(pressure, 0)} bar: {'; '.join(said)}.")
    first = {lightest(row) for row in study["rows"]}
    sentences += [f"Why {JOINTS[joint][1]}: {WHY[joint]}" for joint in JOINTS if joint in first]
    level: dict[float, list[str]] = {}
    for row in study["rows"]:
        if lightest(row) == "sleeve" and _level(row):
            level.setdefault(row["pressure"], []).append(fixed(row["bore"], 0))
    if level:
        points = (f"{fixed(bar, 0)} bar and {', '.join(bores)} mm" for bar, bores in level.items())
        sentences.append(
            f"At {'; '.join(points)}, stiffness makes the liner as thick as its ends. It then "
            "differs from screwed plugs only in that the winding ends before the thread."
        )
    return [*sentences, *RULES]


def _level(row: Data) -> bool:
    """Whether the lightest sleeve is as thick as its liner."""
    values = row["sleeve"]["values"]
    liner: float = values["barrel.layup[0].thickness"]
    return bool(values["retention.sleeve.wall"] < 1.001 * liner)


# ---- the figure ----


def drawing(study: Data) -> Ink:
    """Mass over bore, divided by that of the lightest: a panel for each pressure."""
    pressures = list(dict.fromkeys(row["pressure"] for row in study["rows"]))
    ink = Ink(186.0, 66.0)
    width = 132.0 / len(pressures) - 6.0
    for k, pressure in enumerate(pressures):
        rows = [row for row in study["rows"] if row["pressure"] == pressure]
        left = 12.0 + k * (width + 6.0)
        _panel(ink, (left, 10.0, width, 44.0), rows, f"{fixed(pressure, 0)} bar")
    last = [row for row in study["rows"] if row["pressure"] == pressures[-1]][-1]
    _names(ink, last, 12.0 + len(pressures) * (width + 6.0) - 4.0)
    return ink


TOP = 1.8
"""Largest ratio in the figure."""


def _height(ratio: float) -> float:
    """Vertical position of a ratio on the sheet."""
    return 54.0 - 44.0 * (min(ratio, TOP) - 0.95) / (TOP - 0.95)


def _panel(ink: Ink, box: tuple[float, float, float, float], rows: list[Data], title: str) -> None:
    bores = [row["bore"] for row in rows]
    axes = Axes(ink, box, (bores[0], bores[-1]), (0.95, TOP))
    axes.frame(title, "bore, mm")
    for joint, (_, _, colour) in JOINTS.items():
        for points in _pieces(joint, rows):
            xs, ys = ([point[i] for point in points] for i in (0, 1))
            ink.path(axes.clipped(xs, ys), stroke=colour, pen=0.45)
            for x, y in points:
                if y <= TOP:
                    ink.circle(axes.x(x), axes.y(y), 0.7, fill=WHITE, stroke=colour, pen=0.3)


def _pieces(joint: str, rows: list[Data]) -> list[list[tuple[float, float]]]:
    """Points of a curve, bore and ratio, parted where the joint has no design."""
    pieces: list[list[tuple[float, float]]] = [[]]
    for row in rows:
        found = masses(row)
        if joint in found:
            pieces[-1].append((row["bore"], found[joint] / found[lightest(row)]))
        else:
            pieces.append([])
    return [piece for piece in pieces if piece]


def _names(ink: Ink, row: Data, left: float) -> None:
    """Names of the joints beside the last panel, in order of mass."""
    found = masses(row)
    shown = sorted(found, key=found.__getitem__)
    middles = [_height(found[joint] / found[shown[0]]) for joint in shown][::-1]
    places = spread_within(middles, [4.0] * len(shown), 10.0, 54.0)[::-1]
    for joint, y in zip(shown, places, strict=True):
        ink.text(left, y + 1.0, JOINTS[joint][1], size=7.0, color=JOINTS[joint][2])
    missing = [JOINTS[joint][1] for joint in JOINTS if joint not in found]
    for k, words in enumerate(missing):
        ink.text(left, 58.0 + 3.4 * k, f"none: {words}", size=6.0, color=GREY)


def page(study: Data) -> Sheets:
    """The report as PDF and as images of its sheets."""
    rough = sum(row[joint].get("status") == "feasible" for row in study["rows"] for joint in JOINTS)
    note = (
        "Each mass is an optimum of its own at a fixed bore"
        f"{f', apart from {rough} that only meet all limits' if rough else ''}. None: no design "
        "meets all requirements within the bounds."
    )
    return study_report(
        __file__,
        study,
        title="Which joint is lightest",
        heading="Joints of the barrel's ends over pressure and bore",
        lead=lead(study),
        blocks=[
            Drawing(
                "Mass divided by that of the lightest",
                drawing(study),
                "A curve has a gap where there is no design.",
            ),
            grid_table("Masses", mass_rows(study), note, words=[-2]),
            grid_table(
                "Why: barrel and ends of the lightest, and of steel",
                why_rows(study),
                "Ends: caps, head and fastening, with the rod's thread; of aluminium beside "
                "composite barrels, of steel beside steel ones.",
                words=[2],
            ),
        ],
    )


def printed(study: Data) -> str:
    """The tables, and the sentences on the result."""
    lines = []
    for rows in (mass_rows(study), why_rows(study)):
        lines += [aligned(rows, right=range(len(rows[0]))), ""]
    return "\n".join([*lines, *lead(study)])


def main() -> None:
    """Print the tables; write the report if a folder is named."""
    description = "which joint of the barrel's ends is lightest"
    print(
        run_script(__file__, description, compute, printed, page, quick="few pressures and bores")
    )


if __name__ == "__main__":
    main()
