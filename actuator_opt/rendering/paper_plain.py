"""A simpler report, drawn by matplotlib where Typst is not installed, with a note that says so."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

from .attachments import embed
from .heights import wrap
from .ink import BLACK, GREEN, GREY, PALE, RED, WHITE, Ink, text_width

SHEET = (210.0, 297.0)
LEFT, RIGHT, TOP, BOTTOM = 15.0, 195.0, 15.0, 280.0
NOTE = "Plain layout: the typst package is not installed; install it for the full report sheet."
AMBER = "#8a5a00"
_SIZE = 6.2
_LINE = 3.0


def render(data: Mapping[str, Any], timestamp: int) -> tuple[bytes, list[bytes]]:
    """PDF (with the input attached) and PNG sheets of a report."""
    flow = _Flow()
    _title(flow, data)
    for block in data["blocks"]:
        _block(flow, block)
    _footers(flow.sheets, data)
    pdf, images = _draw(flow.sheets, data["title"])
    files = [
        (data["source_file"], "application/yaml", data["source"].encode()),
        ("actuator-opt-run.json", "application/json", data["run"].encode()),
        *((x["name"], x["media"], x["content"].encode()) for x in data.get("attached", ())),
    ]
    return embed(pdf, files, timestamp), images


class _Flow:
    """Sheets of paper that are filled from top to bottom."""

    def __init__(self) -> None:
        self.sheets: list[Ink] = []
        self.y = 0.0
        self.turn()

    @property
    def ink(self) -> Ink:
        return self.sheets[-1]

    def turn(self) -> None:
        """Start a new sheet."""
        self.sheets.append(Ink(*SHEET))
        self.y = TOP

    def need(self, height: float) -> bool:
        """Start a new sheet unless `height` mm remain; return whether a sheet was started."""
        if self.y + height <= BOTTOM or self.y == TOP:
            return False
        self.turn()
        return True

    def words(self, text: str, size: float = 7.0, **style: Any) -> None:
        """A wrapped paragraph."""
        step = 0.48 * size
        for line in wrap(text, RIGHT - LEFT, size):
            self.need(step)
            self.ink.text(LEFT, self.y + step / 2, line, size=size, **style)
            self.y += step

    def paste(self, drawing: Mapping[str, Any]) -> None:
        """Draw a drawing on the page, flush with the left margin."""
        self.need(drawing["height"])
        for mark in drawing["marks"]:
            copy: Any = dict(mark)
            if "path" in mark:
                copy["path"] = [[[x + LEFT, y + self.y] for x, y in line] for line in mark["path"]]
            else:
                copy["at"] = [mark["at"][0] + LEFT, mark["at"][1] + self.y]
            self.ink.marks.append(copy)
        self.y += drawing["height"]


def _joined(cell: Any) -> str:
    """All text of a table cell as one string."""
    if isinstance(cell, dict):
        return str(cell.get("text", ""))
    return cell if isinstance(cell, str) else "".join(cell)


def _title(flow: _Flow, data: Mapping[str, Any]) -> None:
    flow.words(NOTE, 6.0, color=RED)
    flow.y += 2.0
    name = _joined(data["name"])
    flow.words(name, 13.0 if len(name) < 60 else 8.0, bold=True)
    dated = f", {data['date']}" if data["date"] else ""
    flow.words(f"{data['kind']}, actuator-opt {data['version']}, spec {data['hash']}{dated}", 6.5)
    flow.y += 1.5
    verdict = data["verdict"]
    color = {"met": GREEN, "checks": AMBER}.get(verdict["state"], RED)
    flow.words(verdict["text"], 11.0, bold=True, color=color)
    flow.words("; ".join(verdict["lines"]), 6.5)
    if verdict.get("cautions"):
        flow.words("; ".join(verdict["cautions"]), 6.5, bold=True, color=AMBER)
    flow.words(_joined(data["sentence"]), 7.0)
    flow.y += 2.0
    for tile in data["tiles"]:
        note = f"  ({tile['note']})" if tile["note"] else ""
        flow.words(f"{tile['label']}: {tile['value']} {tile['unit']}{note}", 7.0)
    flow.y += 3.0
    flow.paste(data["section"])
    items = (f"{i['number']} {i['part']}, {i['material']}" for i in data["items"])
    flow.words("   ".join(items), 5.8, color=GREY)
    flow.y += 2.0
    signs = ("designed", "checked", "approved")
    for index, role in enumerate(signs):
        x = LEFT + index * 60.0
        flow.ink.box(x, flow.y, 60.0, 11.0, pen=0.15)
        flow.ink.text(
            x + 1.5, flow.y + 2.0, f"{role} (name, date, signature)", size=5.4, color=GREY
        )
    flow.y += 13.0
    flow.words(f"Command: {_joined(data['command'])}", 5.6, color=GREY)


def _block(flow: _Flow, block: Mapping[str, Any]) -> None:
    if block["kind"] == "pair":
        for part in (part for side in block["sides"] for part in side):
            _block(flow, part)
        return
    height = block["ink"]["height"] if block["kind"] == "figure" else 8.0
    flow.need(9.0 + height)
    flow.y += 4.0
    flow.words(block["title"], 8.5, bold=True)
    flow.y += 1.0
    if block["kind"] == "figure":
        flow.paste(block["ink"])
    elif block["kind"] == "table":
        _table(flow, block)
    elif block["kind"] == "notes":
        for item in block["items"]:
            flow.words("• " + _joined(item), 6.8)
    else:
        for number, line in enumerate(block["lines"], 1):
            text = _joined(line)
            indent = len(text) - len(text.lstrip(" "))
            x = LEFT + 7.0 + indent * 1.1
            for part in wrap(text.strip(" "), RIGHT - x, 5.6) or [""]:
                flow.need(2.5)
                flow.ink.text(x, flow.y + 1.2, part, size=5.6)
                flow.y += 2.5
            flow.ink.text(
                LEFT + 5.0, flow.y - 1.3, str(number), size=5.6, anchor="right", color=GREY
            )
    if block.get("note"):
        flow.y += 0.8
        flow.words(block["note"], 5.8, color=GREY)


def _widths(block: Mapping[str, Any]) -> list[float]:
    """Column widths (mm); columns of relative width share the space beside the other columns."""
    columns, rows = block["columns"], block["rows"]
    widths = [0.0] * len(columns)
    room = RIGHT - LEFT
    for k, column in enumerate(columns):
        if isinstance(column["width"], str) and column["width"].endswith("mm"):
            widths[k] = min(float(column["width"][:-2]), 40.0)
        elif column["width"] == "auto":
            texts = [*_joined(column["head"]).split("\n"), *(_joined(row[k]) for row in rows)]
            widths[k] = min(max(text_width(t, _SIZE, bold=True) for t in texts) + 2.6, 32.0)
        room -= widths[k]
    shares = sum(c["width"] for c in columns if not isinstance(c["width"], str))
    for k, column in enumerate(columns):
        if not isinstance(column["width"], str):
            widths[k] = max(room, 40.0) * column["width"] / shares
    return widths


def _table(flow: _Flow, block: Mapping[str, Any]) -> None:
    widths = _widths(block)
    heads = [_joined(column["head"]).replace("\n", " ") for column in block["columns"]]
    body = [[_joined(cell) for cell in row] for row in block["rows"]]
    _row(flow, block, heads, heads, widths, head=True)
    first_total = len(body) - block["total"]
    for index, (cells, texts) in enumerate(zip(block["rows"], body, strict=True)):
        lines = [wrap(t, w - 1.6, _SIZE) for t, w in zip(texts, widths, strict=True)]
        if flow.need(_LINE * max(map(len, lines)) + 0.6):
            _row(flow, block, heads, heads, widths, head=True)
        if block["total"] and index == first_total:
            flow.ink.line((LEFT, flow.y), (RIGHT, flow.y), pen=0.2)
        _row(flow, block, cells, texts, widths, head=False)


def _row(
    flow: _Flow,
    block: Mapping[str, Any],
    cells: Sequence[Any],
    texts: Sequence[str],
    widths: Sequence[float],
    *,
    head: bool,
) -> None:
    lines = [wrap(t, w - 1.6, _SIZE) for t, w in zip(texts, widths, strict=True)]
    height = _LINE * max(map(len, lines)) + 0.6
    x = LEFT
    for cell, part, column, width in zip(cells, lines, block["columns"], widths, strict=True):
        anchor = column["align"]
        place = {"left": x + 0.8, "center": x + width / 2, "right": x + width - 0.8}[anchor]
        state = cell.get("status") if isinstance(cell, dict) else None
        color = RED if state == "missed" else GREY if head else BLACK
        if isinstance(cell, dict) and not cell.keys().isdisjoint(("bar", "share", "slot")):
            _bar(flow.ink, cell, x + 1.0, flow.y + 0.3 + _LINE / 2, width - 2.0)
        for index, text in enumerate(part):
            y = flow.y + 0.3 + _LINE * (index + 0.5)
            flow.ink.text(place, y, text, size=_SIZE, anchor=anchor, bold=head, color=color)
        x += width
    flow.y += height
    flow.ink.line(
        (LEFT, flow.y), (RIGHT, flow.y), pen=0.25 if head else 0.1, stroke=BLACK if head else PALE
    )


def _bar(ink: Ink, cell: Mapping[str, Any], x: float, y: float, width: float) -> None:
    if "share" in cell:
        ink.box(x, y - 0.7, width * cell["share"], 1.4, fill="#4f86a8", stroke=None)
        return
    if "slot" in cell:
        ink.line((x, y), (x + width, y), pen=0.15, stroke=GREY)
        ink.circle(x + width * cell["slot"], y, 0.7, fill=BLACK if cell["at"] else WHITE)
        return
    middle, size = x + width / 2, width / 2 * cell["bar"]
    fill = GREEN if cell["met"] else RED
    ink.box(min(middle, middle + size), y - 0.7, abs(size), 1.4, fill=fill, stroke=None)
    ink.line((middle, y - 1.0), (middle, y + 1.0), pen=0.25)


def _footers(sheets: Sequence[Ink], data: Mapping[str, Any]) -> None:
    for index, sheet in enumerate(sheets, 1):
        words = f"sheet {index}/{len(sheets)}"
        sheet.text(RIGHT, 288.0, words, size=6.2, anchor="right", color=GREY)
        sheet.text(LEFT, 288.0, f"{data['short']}, spec {data['hash']}", size=6.2, color=GREY)


def _draw(sheets: Sequence[Ink], title: str) -> tuple[bytes, list[bytes]]:
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_pdf import PdfPages

    whole, images = io.BytesIO(), []
    keys = ("Creator", "Producer", "CreationDate")
    information: dict[str, Any] = {"Title": title, **dict.fromkeys(keys)}
    style: Any = {
        "pdf.fonttype": 42,
        "font.family": "DejaVu Sans",
        "text.parse_math": False,
        "text.usetex": False,
        "font.size": 7.0,
    }
    with mpl.rc_context(style), PdfPages(whole, metadata=information) as pages:
        for sheet in sheets:
            figure = drawn(sheet)
            image = io.BytesIO()
            FigureCanvasAgg(figure)
            figure.savefig(image, format="png", dpi=150, metadata={"Software": None})
            images.append(image.getvalue())
            pages.savefig(figure)
    return whole.getvalue(), images


def drawn(sheet: Ink) -> Any:
    """A sheet as a matplotlib figure of the same size."""
    from matplotlib.figure import Figure
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    figure = Figure(figsize=(sheet.width / 25.4, sheet.height / 25.4), facecolor=WHITE)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, sheet.width)
    axes.set_ylim(sheet.height, 0.0)
    for order, mark in enumerate(sheet.marks):
        if "path" in mark:
            points: list[tuple[float, float]] = []
            codes: list[int] = []
            for line in mark["path"]:
                points += [(x, y) for x, y in line]
                codes += [int(Path.MOVETO)] + [int(Path.LINETO)] * (len(line) - 1)
                if mark["closed"]:
                    points.append((line[0][0], line[0][1]))
                    codes.append(int(Path.CLOSEPOLY))
            pen = mark["pen"] * 72 / 25.4
            dash = (0.0, tuple(d / mark["pen"] for d in mark["dash"])) if mark["dash"] else "-"
            axes.add_patch(
                PathPatch(
                    Path(points, codes),
                    facecolor=mark["fill"] or "none",
                    linestyle=dash,
                    edgecolor=mark["stroke"] or "none",
                    linewidth=pen,
                    joinstyle="round",
                    zorder=order,
                )
            )
            continue
        x, y = mark["at"]
        axes.text(
            x,
            y,
            mark["text"],
            fontsize=mark["size"],
            color=mark["color"],
            ha=mark["anchor"],
            va="center",
            rotation=-mark["angle"],
            zorder=order,
            fontweight="bold" if mark["bold"] else "normal",
            bbox={"facecolor": WHITE, "edgecolor": "none", "pad": 0.6} if mark["halo"] else None,
        )
    return figure
