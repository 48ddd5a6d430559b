"""Write the interactive page of a sweep: one self-contained HTML file with style, script and data.

Data (columns, limits, drawings, texts) are in a JSON block. They are escaped, so no text in them
can end the block. The script inserts texts as text nodes, and the security policy of the page
allows no other script.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.files import write_text
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..base.tables import encoded
from ..design.paths import quantity_of
from ..evaluation import prepare
from ..evaluation.limits import MetricLimit
from ..evaluation.outline_templates import LENGTHS, Template
from ..evaluation.plugin import Plugin, with_own
from ..evaluation.result import NO_RESERVE, NO_ROOM, Outline
from ..rendering.series import heading
from ..rendering.text import SENSES, limit_text, pretty, unit_text
from ..sweeps.explored import BEST, Explored
from ..sweeps.result import MORE_IS_BETTER, better
from ..version import VERSION

AXES = 8
"""Number of axes that the page's parallel-coordinates plot shows at first."""
REASONS = 3
"""Maximum number of failure reasons listed."""
MOST = 1e30
"""Margins are clipped to +-this value, so that single precision can store them."""
MM = 1000.0
_WORDS = {"bore": "bore ⌀", "rod": "rod ⌀", "closed_length": "closed length"}


def payload(explored: Explored, *, design: str, plugins: Sequence[str]) -> dict[str, Any]:
    """Return all data of the page, as JSON."""
    columns = _columns(explored)
    limits, further_checks = _limits(explored)
    command = ["actuator-opt", "report", design]
    for file in plugins:
        command += ["--plugin", file]
    best = np.where(explored.numbers[:, -1] == 1.0, explored.best, np.inf)
    return {
        "name": explored.study.design.name,
        "summary": _summary(explored),
        "rows": len(explored.numbers),
        "thinned": explored.thinned,
        "columns": columns,
        "exact": _exact(explored),
        "command": command,
        "where": f"Run this command in the folder of {design}, the base design beside this page.",
        "limits": limits,
        "held": further_checks,
        "shapes": _shapes(explored),
        "design": explored.kept.design,
        "start": _start(explored, columns)
        | {"row": int(np.argmin(best)) if np.isfinite(best).any() else -1},
    }


def _base64(values: Array, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


def _column(name: str, label: str, unit: str, values: Array) -> dict[str, Any]:
    """Return a numeric column as JSON; if all rows have the same value, it is stored only once."""
    column: dict[str, Any] = {"name": name, "label": label, "unit": unit_text(unit)}
    column["csv"] = heading(name, unit if column["unit"] else "")
    if np.isfinite(values[0]) and (values == values[0]).all():
        return column | {"value": float(np.float32(values[0]))}
    return column | {"data": _base64(values, "<f4")}


def _columns(explored: Explored) -> list[dict[str, Any]]:
    """Return the columns: varied inputs, least margin, each metric that at least one design has.

    `better` is 1 if larger values are better, -1 if smaller values are, 0 if neither.
    """
    study, numbers = explored.study, explored.numbers
    count = len(study.order)
    columns = [_texts(explored, path) for path in explored.kept.texts]
    for k, column in enumerate(study.columns[:count]):
        quantity = quantity_of(column.name, study.design)
        values = quantity.to_display(numbers[:, k])
        columns.append(_column(column.name, column.name, quantity.unit, np.asarray(values)))
    percent = np.round(100 * numbers[:, -3], 9) + 0.0  # drop rounding errors around zero
    margin = _column("least_margin", "least margin of all limits", "%", percent)
    columns.append(margin | {"better": MORE_IS_BETTER})
    for k, name in enumerate(study.metrics, count):
        quantity = study.quantity(name)
        values = quantity.to_display(numbers[:, k])
        if not np.isnan(values).all():
            metric_column = _column(name, quantity.label, quantity.unit, np.asarray(values))
            columns.append(metric_column | {"better": better(study, name)})
    return columns


def _texts(explored: Explored, path: str) -> dict[str, Any]:
    """Return a text column as JSON: its distinct texts, and an index into them for each row."""
    texts = explored.kept.texts[path]
    number = [texts.index(variant[path]) for variant in explored.variants]
    codes = _base64(np.array(number)[explored.variant], "<u2")
    return {"name": path, "label": path, "unit": "", "csv": path, "texts": texts, "codes": codes}


def _exact(explored: Explored) -> list[dict[str, Any]]:
    """Return the varied inputs in SI, unrounded, for the command that the page shows."""
    columns = []
    for path in explored.kept.texts:
        column = _texts(explored, path)
        columns.append({"path": path, "texts": column["texts"], "codes": column["codes"]})
    for k in range(len(explored.study.order)):
        name = explored.study.columns[k].name
        columns.append({"path": name, "data": _base64(explored.numbers[:, k], "<f8")})
    return columns


def _limits(explored: Explored) -> tuple[list[dict[str, Any]], str]:
    """Return the limits to show, and a sentence that counts the checks that are not shown.

    Shown are the limits that the user states, then the checks that at least one design fails.
    """
    study = explored.study
    base = prepare(study.design, plugins=study.plugins).values()
    quantities = with_own(study.plugins)
    varied = {axis.path for axis in study.plan.axes}
    limits, met_count = [], 0
    order = sorted(
        range(len(explored.limits)),
        key=lambda k: explored.limits[k].origin not in ("requirement", "case"),
    )
    for k in order:
        limit, margin = explored.limits[k], explored.margins[k]
        if (margin >= -1e-6).all() and limit.origin not in ("requirement", "case"):
            met_count += 1
            continue
        varies = limit.path in varied or limit.lever in varied
        bound = None if varies else float(limit.value(base))
        quantity = quantities[limit.metric]
        words = f"{SENSES[limit.sense]} a varying limit"
        if bound is not None:
            words = limit_text(quantity, limit.sense, bound)
        limits.append(
            {
                "name": limit.name,
                "text": f"{_label(limit, quantity, study.plugins)} {words}",
                "plain": bound == 0.0,
                "reserve": NO_ROOM if bound == 0.0 else NO_RESERVE,
                "margin": _base64(np.clip(margin, -MOST, MOST), "<f4"),
            }
        )
    return limits, f"Every design meets {met_count} further checks." if met_count else ""


def _label(limit: MetricLimit, quantity: Quantity, plugins: Sequence[Plugin]) -> str:
    """Return the displayed name of a limit: its quantity, and its load case if it has one."""
    own = any(plugin.name == limit.name for plugin in plugins)
    words = limit.name if own or limit.origin == "check" else quantity.label
    return f"{words} ({limit.case})" if limit.case else words


def _start(explored: Explored, columns: list[dict[str, Any]]) -> dict[str, Any]:
    """Choose what the page first shows in its scatter plot and its parallel-coordinates plot.

    The objective is plotted against a required metric or, without one, a varied input. Metrics that
    the user has selected take precedence.
    """
    place = {column["name"]: k for k, column in enumerate(columns)}
    study = explored.study
    margin = place["least_margin"]
    varied = [axis.path for axis in study.plan.axes if axis.path in place]
    numbers = [column.name for column in study.columns[: len(study.order)]]
    goal = next((name for name in study.goal.weights if name in place), "least_margin")
    requirements = [metric for metric in study.design.requirements if metric in place]
    shown_metrics = explored.shown
    first = (*varied[: AXES - max(3, len(shown_metrics))], *shown_metrics, goal, *requirements)
    shown = [k for k in first if "value" not in columns[place[k]]]
    last = [] if shown_metrics else [margin]  # this is zero for every design of a front
    axes = sorted({*(place[name] for name in dict.fromkeys(shown[: AXES - len(last)])), *last})
    varied_input = next((k for k in numbers if "value" not in columns[place[k]]), varied[0])
    metrics = (k for k in requirements if k != goal and "value" not in columns[place[k]])
    across = next(metrics, varied_input)
    if shown_metrics:
        across, goal, varied_input = (*shown_metrics, varied_input)[:3]
    return {
        "x": place[across],
        "y": place[goal],
        "c": margin if across == varied_input else place[varied_input],
        "axes": axes,
        "asked": bool((explored.numbers[:, -1] == 1.0).any()),
    }


def _summary(explored: Explored) -> str:
    """Summarise the sweep: how many designs were evaluated, are shown, failed, or are damaged."""
    kept = explored.kept
    evaluated, shown = kept.rows - explored.failed, len(explored.numbers)
    feasible = int((explored.numbers[:, -1] == 1.0).sum())
    words = f"{explored.origin}, {evaluated} design{'s' * (evaluated != 1)} evaluated"
    if explored.thinned:
        words += (
            f"; {shown} are shown: one in {-(-evaluated // explored.most)}, evenly spread, "
            f"plus the {BEST} best feasible designs"
        )
    words += f". {feasible} of these meet every requirement and check."
    if explored.failed:
        reasons = list(kept.failures.items())
        listing = "; ".join(f"{times} times {reason}" for reason, times in reasons[:REASONS])
        more = f"; and {len(reasons) - REASONS} more reasons" if len(reasons) > REASONS else ""
        words += f" {explored.failed} failed and have no results: {listing}{more}."
    if explored.damaged:
        words += f" {explored.damaged} damaged and left out."
    return f"{pretty(words)} Models of version {VERSION}."


def _shapes(explored: Explored) -> dict[str, Any]:
    """Return the section drawings of all rows: templates, and each row's template and dimensions.

    Dimensions that do not change any drawing are omitted.
    """
    count = len(explored.numbers)
    template_of = np.full(count, -1)
    slots: list[Array] = []
    numbers_by_text: dict[str, int] = {}
    for group in explored.groups:
        shapes = group.shapes
        moving = [k for k, row in enumerate(shapes.dimensions) if np.ptp(row) > 0]
        effective = [
            k for k in moving if any(template.slopes[:, k].any() for template in shapes.templates)
        ]
        while len(slots) < len(effective):
            slots.append(np.zeros(count))
        for slot, k in enumerate(effective):
            slots[slot][group.places] = MM * shapes.dimensions[k]
        for number, template in enumerate(shapes.templates):
            text = json.dumps(_template(template, effective), separators=(",", ":"))
            rows = group.places[shapes.which == number]
            template_of[rows] = numbers_by_text.setdefault(text, len(numbers_by_text))
    hidden = any(axis.path.startswith("rod.fitting.") for axis in explored.study.plan.axes)
    return {
        "dimensions": [_base64(slot, "<f4") for slot in slots],
        "templates": [json.loads(text) for text in numbers_by_text],
        "which": _base64(template_of, "<i2"),
        "lengths": [_WORDS.get(name, name) for name in LENGTHS],
        "hidden": "the rod's fittings, because their dimensions vary" if hidden else "",
    }


def _template(template: Template, dimensions: list[int]) -> dict[str, Any]:
    """Return a template of a section drawing, whose coordinates [mm] are linear in the dimensions.

    The JSON has each coordinate's value for zero dimensions, and its derivatives with respect to
    the dimensions.
    """
    zero = template.numbers - template.slopes[:, dimensions] @ template.origin[dimensions]
    rows, places = np.nonzero(template.slopes[:, dimensions])
    return {
        "parts": [part_of_section(outline) for outline in template.outlines],
        "numbers": [round(MM * float(value), 5) + 0.0 for value in zero],
        "slopes": [
            [int(row), int(k), round(float(template.slopes[row, dimensions[k]]), 7)]
            for row, k in zip(rows, places, strict=True)
        ],
    }


def part_of_section(outline: Outline) -> dict[str, Any]:
    """Name, kind, numbers of points and side of a part, as `section.js` draws it."""
    return {
        "part": outline.part,
        "kind": outline.kind,
        "polygons": [len(polygon) for polygon in outline.polygons],
    } | ({"sides": [-1]} if len(outline.sides) == 1 else {})


FOLDER = Path(__file__).parent
SCRIPTS = (
    "data",
    "front",
    "scatter",
    "zoom",
    "axes",
    "section",
    "shapes",
    "table",
    "compare",
    "main",
)
_ESCAPES = {c: f"\\u{ord(c):04x}" for c in "<>&\u2028\u2029"}


@dataclass(frozen=True, slots=True)
class ExplorerFile:
    """A file that the explorer has written, with its hash."""

    path: Path
    sha256: str
    remarks: tuple[str, ...] = ()
    """Remarks on the rows of the sweep, such as how many are damaged; only the page has any."""

    def to_dict(self) -> dict[str, object]:
        """The JSON form."""
        data: dict[str, object] = {"path": str(self.path), "sha256": self.sha256}
        return data | ({"remarks": list(self.remarks)} if self.remarks else {})


def page(explored: Explored, *, design: str, plugins: Sequence[str] = ()) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    explored : the sweep
    design : file name of the base design, in the folder of the page
    plugins : files with user metrics, which the command on the page loads
    """
    data = payload(explored, design=design, plugins=plugins)
    style = _text("page.css")
    script = "".join(_text(f"{name}.js") for name in SCRIPTS)
    parts = {
        "TITLE": html.escape(f"{explored.study.design.name}: {explored.kind}"),
        "STYLE": style,
        "STYLE_HASH": _hash(style),
        "SCRIPT": script,
        "SCRIPT_HASH": _hash(script),
        "DATA": _json(data),
    }
    return re.sub("@([A-Z_]+)@", lambda match: parts[match[1]], _text("page.html"))


def design_beside(target: Path) -> Path:
    """Return the path of the base design's file, which is in the same folder as the page."""
    return target.with_name(f"{target.stem}_base.yaml")


def write_explorer(
    explored: Explored,
    target: Path,
    *,
    plugins: Sequence[str] = (),
    remarks: Sequence[str] = (),
) -> list[ExplorerFile]:
    """Write the page, and beside it the base design, a file that the command on the page reads.

    Parameters
    ----------
    explored : the sweep
    target : file of the page
    plugins : files with user metrics, which the command on the page loads
    remarks : remarks on the rows, printed with the page

    Raises
    ------
    InputError
        a file cannot be written
    """
    design = design_beside(target)
    if explored.damaged:
        rows = "1 row is" if explored.damaged == 1 else f"{explored.damaged} rows are"
        remarks = [*remarks, f"{rows} damaged and left out; run the sweep again to restore them"]
    texts = {
        target: page(explored, design=design.name, plugins=plugins),
        design: explored.kept.design,
    }
    return [
        ExplorerFile(
            write_text(path, text),
            hashlib.sha256(text.encode()).hexdigest(),
            tuple(remarks) if path == target else (),
        )
        for path, text in texts.items()
    ]


def _text(name: str) -> str:
    return (FOLDER / name).read_text("utf-8")


def _hash(text: str) -> str:
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest())
    return f"sha256-{digest.decode()}"


def _json(data: dict[str, Any]) -> str:
    """Convert data to JSON in which the special characters of HTML are escaped."""
    text = encoded(data, ensure_ascii=False, separators=(",", ":"))
    return re.sub("[<>&\u2028\u2029]", lambda match: _ESCAPES[match[0]], text)
