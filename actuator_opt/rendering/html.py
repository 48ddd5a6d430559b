"""A page as a single HTML file, for dark and light screens and for print.

The large figure and all drawings are SVG, from the same ink as on paper. Colours are CSS variables
with a second set of values for dark screens. The file contains no scripts, no fonts and no links to
other files, so it can be mailed and opens without a network.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator
from html import escape
from pathlib import Path

from ..base.files import write_all
from ..version import VERSION
from .blocks import (
    FARTHEST,
    Bar,
    Block,
    Cell,
    Chart,
    Column,
    Drawing,
    Flag,
    Listing,
    Notes,
    Origin,
    Page,
    Pair,
    Reach,
    ReportFile,
    Row,
    Share,
    Slot,
    Status,
    Table,
    Tile,
    clean,
    with_input,
)
from .chart_ink import drawn
from .heights import cells_of, joined
from .ink import POINT, Ink, PathMark, TextMark

HERO = 110.0
"""Height of a large figure that can be scaled [mm] (our choice: a laptop shows it without
scrolling)."""
_MARKS = {
    "met": "✔",
    "no_reserve": "!",
    "checks": "!",
    "missed": "✘",
    "not_checked": "○",
    "infeasible": "✘",
}
_GAPS = re.compile(r"([._/=](?=[^\W\d]))")
"""Positions at which a browser may break a long name: after ``.``, ``_``, ``/`` or ``=`` if a
letter follows."""
_STYLE = """
.ao{--ink:#16202a;--grey:#5b6670;--pale:#c9d0d6;--wash:#f2f4f6;--paper:#fff;--good:#00654a;
--bad:#a8321a;--amber:#8a5a00;--blue:#0b4f83;color:var(--ink);background:var(--paper);
font:15px/1.45 "DejaVu Sans",system-ui,-apple-system,"Segoe UI",sans-serif;max-width:1060px;
margin:0 auto;padding:1.2rem;overflow-wrap:break-word}
@media (prefers-color-scheme:dark){.ao{--ink:#e4e8ec;--grey:#a4aeb6;--pale:#46515a;--wash:#1e262d;
--paper:#12181d;--good:#4cc79c;--bad:#ff8a70;--amber:#e0ae52;--blue:#7fb8e6}
.ao svg.drawing{filter:invert(1) hue-rotate(180deg)}}
.ao h1{font-size:1.7rem;line-height:1.2;margin:.1rem 0 .5rem}
.ao h2{font-size:1.05rem;margin:1.8rem 0 .5rem}
.ao .kind,.ao footer,.ao .note{color:var(--grey);font-size:.82rem}
.ao .kind{text-transform:uppercase;letter-spacing:.03em}
.ao .top{display:flex;flex-wrap:wrap;gap:1rem;justify-content:space-between}
.ao .top>div:first-child{flex:1 1 26rem}
.ao .badge{flex:0 1 19rem;align-self:flex-start;border:2px solid var(--c);color:var(--c);
text-align:center;padding:.5rem .8rem;font-size:.82rem}
.ao .badge strong{display:block;font-size:1rem}
.ao .badge .caution{color:var(--amber);font-weight:700}
.ao .tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(10.5rem,1fr));gap:.5rem;
margin:1rem 0}
.ao .tile{background:var(--wash);border-top:3px solid var(--ink);padding:.45rem .6rem}
.ao .tile.met{color:inherit}.ao .tile.missed{border-color:var(--bad)}
.ao .tile b{font-size:1.35rem}.ao .tile span{display:block;color:var(--grey);font-size:.78rem}
.ao .wide{overflow-x:auto}
.ao table{border-collapse:collapse;width:100%;font-size:.82rem}
.ao th{color:var(--grey);text-align:left;border-bottom:2px solid var(--ink);padding:.25rem .4rem}
.ao td,.ao th{overflow-wrap:normal}
.ao td{border-bottom:1px solid var(--pale);padding:.2rem .4rem;font-variant-numeric:tabular-nums}
.ao th.mono{min-width:9.5rem}
.ao .right{text-align:right;white-space:nowrap}.ao .center{text-align:center}
.ao td.mono,.ao span.mono,.ao pre{font-family:"DejaVu Sans Mono",ui-monospace,Menlo,monospace}
.ao th.flexible{min-width:8rem}
.ao tr.total td{font-weight:700}.ao tr.rule td{border-top:2px solid var(--ink)}
.ao .met{color:var(--good)}.ao .missed,.ao .infeasible{color:var(--bad)}
.ao .no_reserve,.ao .checks{color:var(--amber)}.ao .not_checked{color:var(--grey)}
.ao .status{white-space:nowrap}
.ao svg{max-width:100%;height:auto;display:block}.ao svg.cell{display:inline-block;height:.8rem}
.ao pre{background:var(--wash);padding:.8rem;overflow-x:auto;font-size:.75rem;line-height:1.35}
.ao pre span{color:var(--grey);user-select:none}
.ao .pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(22rem,1fr));gap:0 1.6rem}
.ao footer{border-top:1px solid var(--pale);margin-top:2rem;padding-top:.6rem}
@media print{.ao{--ink:#16202a;--grey:#5b6670;--pale:#c9d0d6;--wash:#f2f4f6;--paper:#fff;
--good:#00654a;--bad:#a8321a;--amber:#8a5a00;--blue:#0b4f83;font-size:9.5pt;max-width:none;
padding:0}.ao svg.drawing{filter:none}.ao tr,.ao svg,.ao .tile{break-inside:avoid}
.ao .wide{overflow:visible}.ao pre{white-space:pre-wrap;overflow:visible}
.ao h2{break-after:avoid}@page{margin:14mm}}
"""


def write(page: Page, origin: Origin | None, *, folder: Path, stem: str) -> list[ReportFile]:
    """Write ``STEM.html`` into a folder, completely or not at all.

    Raises
    ------
    InputError : the folder cannot be written
    """
    content = document(page, origin).encode("utf-8", "replace")
    name = f"{stem}.html"
    write_all(folder, {name: content})
    return [ReportFile(folder / name, hashlib.sha256(content).hexdigest(), 1)]


def document(page: Page, origin: Origin | None) -> str:
    """A page as a complete HTML document; equal input gives equal text."""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{_say(page.name)}: {_say(page.kind)}</title>"
        "<style>body{margin:0}@media (prefers-color-scheme:dark)"
        "{body{background:#12181d}}@media print{body{background:#fff}}</style>"
        f"</head><body>\n{fragment(page, origin)}\n</body></html>\n"
    )


def fragment(page: Page, origin: Origin | None = None) -> str:
    """A page as a piece of HTML for notebooks; its CSS rules apply to this piece only."""
    parts = [f"<style>{_STYLE}</style>", '<article class="ao">', *_top(page)]
    if page.tiles:
        parts += ['<div class="tiles">', *map(_tile, page.tiles), "</div>"]
    parts += [svg(page.hero(max(HERO, page.least)), page.kind), _legend(page)]
    for block in with_input(page, origin):
        parts += _block(block)
    parts += [*_footer(page, origin), "</article>"]
    return "\n".join(parts)


SUMMARY = 60_000
"""Largest size of a summary in bytes (our choice: a notebook with many results stays small)."""
SUMMARY_TABLES = 2
"""Number of tables in a summary, if the page does not name them."""


def summary(page: Page) -> str:
    """Headline, key figures, large figure and main tables of a page, as HTML for notebooks."""
    parts = [f"<style>{_STYLE}</style>", '<article class="ao">', *_top(page)]
    if page.tiles:
        parts += ['<div class="tiles">', *map(_tile, page.tiles), "</div>"]
    end = ['<p class="note">print(…) shows everything, ao.report(…) writes it.</p>', "</article>"]
    tables = [table for table in _tables(page.blocks) if table.on != "terminal"]
    named = [table for table in tables if table.title in page.summary]
    tables = named or tables[:SUMMARY_TABLES]
    written: list[str] = []
    for text in ("".join(_table(table)) for table in tables):
        written += [text] if len(text.encode()) < _room(*parts, *written, *end) else []
    hero, room = page.hero(max(HERO, page.least)), _room(*parts, *written, *end)
    pictures = (f"{svg(hero, page.kind, places)}\n{_legend(page)}" for places in (2, 1))
    picture = next((text for text in pictures if len(text.encode()) < room), "")
    return "\n".join([*parts, *written[:1], picture, *written[1:], *end])


def _legend(page: Page) -> str:
    """Part and material of every number in the large figure."""
    items = (f"<b>{n}</b> {_say(part)}, {_say(material)}" for n, part, material in page.items)
    text = " · ".join(items)
    return f'<p class="note">{text}</p>' if text else ""


def _room(*parts: str) -> int:
    """Bytes that a summary has left after some parts, which are joined by new lines."""
    return SUMMARY - sum(len(part.encode()) + 1 for part in parts)


def _tables(blocks: Iterable[Block]) -> Iterator[Table]:
    for block in blocks:
        if isinstance(block, Table):
            yield block
        elif isinstance(block, Pair):
            yield from (table for side in block.sides for table in _tables(side))


def _say(words: str) -> str:
    return escape(clean(words))


def _top(page: Page) -> Iterator[str]:
    verdict = page.verdict
    paint = {"met": "good", "checks": "amber"}.get(verdict.state, "bad")
    yield f'<div class="top"><div><div class="kind">{_say(page.kind)}</div>'
    yield f"<h1>{_say(page.name)}</h1><p>{_say(page.sentence)}</p></div>"
    yield f'<div class="badge" style="--c:var(--{paint})">'
    yield f"<strong>{_MARKS.get(verdict.state, '')} {_say(verdict.text)}</strong>"
    yield "".join(f"<div>{_say(line)}</div>" for line in verdict.lines)
    yield "".join(f'<div class="caution">{_say(line)}</div>' for line in verdict.cautions)
    yield "</div></div>"


def _tile(tile: Tile) -> str:
    return (
        f'<div class="tile {tile.state}"><span>{_say(tile.label)}</span>'
        f"<b>{_say(tile.value)}</b> {_say(tile.unit)}<span>{_say(tile.note)}</span></div>"
    )


def _footer(page: Page, origin: Origin | None) -> Iterator[str]:
    if origin is None:
        return
    dated = f", {_say(origin.date)}" if origin.date else ""
    yield f"<footer>actuator-opt {VERSION}, spec {_say(origin.spec_hash[:16])}{dated}<br>"
    yield f'<span class="mono">{_say(origin.command)}</span></footer>'


# ---- blocks ----


def pieces(blocks: Iterable[Block]) -> str:
    """Blocks (tables, charts, notes) as a piece of HTML, without verdict, figure and footer."""
    return "\n".join([f"<style>{_STYLE}</style>", '<div class="ao">', *_blocks(blocks), "</div>"])


def listing(words: str) -> str:
    """Preformatted text, such as that of the terminal, as a piece of HTML."""
    return f"<pre>{_say(words)}</pre>"


def _block(block: Block) -> list[str]:
    if isinstance(block, Pair):
        sides = ("".join(_blocks(side)) for side in block.sides)
        return ['<div class="pair">', *(f"<div>{side}</div>" for side in sides), "</div>"]
    if isinstance(block, Table):
        return [] if block.on == "terminal" else _table(block)
    if isinstance(block, Drawing):
        return [_head(block.title), svg(block.ink, block.title), _note(block.note)]
    if isinstance(block, Chart):
        return [_head(block.title), svg(drawn(block), block.title), _note(block.note)]
    if isinstance(block, Notes):
        if block.on == "terminal":
            return []
        items = "".join(f"<li>{_say(item)}</li>" for item in block.items)
        return [_head(block.title), f"<ul>{items}</ul>", _note(block.note)]
    if isinstance(block, Listing):
        lines = enumerate(block.text.splitlines(), 1)
        numbered = (f"<span>{k:4} </span>{_say(line.expandtabs(4))}" for k, line in lines)
        return [_head(block.title), "<pre>" + "\n".join(numbered) + "</pre>"]
    return []


def _blocks(blocks: Iterable[Block]) -> list[str]:
    return [part for block in blocks for part in _block(block)]


def _head(title: str) -> str:
    return f"<h2>{_say(title)}</h2>" if title else ""


def _note(words: str) -> str:
    return f'<p class="note">{_say(words)}</p>' if words else ""


def _table(table: Table) -> list[str]:
    shown = [k for k, column in enumerate(table.columns) if column.on != "terminal"]
    heads = "".join(
        f'<th class="{_names(table.columns[k])}">{_say(table.columns[k].head)}</th>' for k in shown
    )
    parts = [_head(table.title), '<div class="wide"><table><thead><tr>', heads]
    parts.append("</tr></thead><tbody>")
    last = len(table.rows) - table.total
    for index, row in enumerate(table.rows):
        cells = cells_of(row)
        state = row.state if isinstance(row, Row) else ""
        line = "".join(_td(cells[k], table.columns[k], state) for k in shown)
        kind = "total" if index >= last else ""
        rule = " rule" if table.total and index == last else ""
        parts.append(f'<tr class="{kind}{rule}">{line}</tr>' if kind else f"<tr>{line}</tr>")
    return [*parts, "</tbody></table></div>", _note(table.note)]


def _names(column: Column) -> str:
    names = ("mono" if column.mono else "", "flexible" if column.flexible else "")
    return " ".join([column.align, *filter(None, names)])


def _td(cell: Cell, column: Column, state: str) -> str:
    names: list[str] = [column.align] if column.align != "left" else []
    names += ["mono"] if column.mono else []
    names += [state] if column.style == "state" and state else []
    kind = f' class="{" ".join(names)}"' if names else ""
    body = _cell(cell)
    if isinstance(cell, (str, list)) and column.align == "left":
        body = _GAPS.sub(r"\1<wbr>", body)
    return f"<td{kind}>{f'<b>{body}</b>' if column.strong and body else body}</td>"


def _cell(cell: Cell) -> str:
    if isinstance(cell, Status):
        mark = _MARKS.get(cell.state, "")
        return f'<span class="status {cell.state}">{mark} {_say(cell.words)}</span>'
    if isinstance(cell, Flag):
        return f'<span class="{"missed" if cell.raised else ""}">{_say(cell.text)}</span>'
    if isinstance(cell, Bar):
        return "" if cell.margin is None else _bar(cell.margin, cell.met)
    if isinstance(cell, Share):
        return _strip(f'<rect y="3" width="{100 * _unit(cell.value):.1f}" height="6"/>')
    if isinstance(cell, Reach):
        return "" if cell.change is None else _reach(cell.change, cell.met)
    if isinstance(cell, Slot):
        at = 4 + 92 * _unit(cell.place)
        fill = "currentColor" if cell.at else "var(--paper)"
        return _strip(
            '<path d="M0 6H100" stroke="currentColor" stroke-width="1"/>'
            f'<circle cx="{at:.1f}" cy="6" r="4" fill="{fill}" stroke="currentColor"/>'
        )
    return _say(joined(cell))


def _unit(value: float) -> float:
    return max(0.0, min(1.0, value))


def _strip(marks: str) -> str:
    size = 'viewBox="0 0 100 12" width="100" height="12"'
    return f'<svg class="cell" {size} fill="var(--blue)">{marks}</svg>'


def _bar(margin: float, met: bool) -> str:
    size = 50 * _unit(abs(margin))
    start = 50.0 if margin >= 0 else 50 - size
    paint = "var(--good)" if met else "var(--bad)"
    return _strip(
        f'<rect x="{start:.1f}" y="2" width="{size:.1f}" height="8" fill="{paint}"/>'
        '<path d="M50 0V12" stroke="currentColor"/>'
    )


def _reach(change: float, met: bool) -> str:
    size = 50 * _unit(abs(change) / FARTHEST)
    start = 50.0 if change >= 0 else 50 - size
    paint = "var(--blue)" if met else "var(--amber)"
    return _strip(
        f'<rect x="{start:.1f}" y="3" width="{size:.1f}" height="6" fill="{paint}"/>'
        '<path d="M50 0V12M33.3 3V9M66.7 3V9" stroke="currentColor"/>'
    )


# ---- drawings ----


def svg(ink: Ink, title: str = "", places: int = 2) -> str:
    """A drawing as SVG text; its coordinates are millimetres on paper, rounded to some decimals."""
    size = f'viewBox="0 0 {ink.width:g} {ink.height:g}" width="{6 * ink.width:g}"'
    parts = [f'<svg class="drawing" {size} role="img" xmlns="http://www.w3.org/2000/svg"']
    parts.append(' fill-rule="evenodd" stroke-linejoin="round">')
    parts.append(f"<title>{_say(title)}</title>" if title else "")
    parts += [_text(mark) if "text" in mark else _path(mark, places) for mark in ink.marks]
    return "".join([*parts, "</svg>"])


def _path(mark: PathMark, places: int) -> str:
    lines = mark["path"]
    end = "Z" if mark["closed"] else ""
    data = "".join("M" + "L".join(_point(x, y, places) for x, y in line) + end for line in lines)
    dash = mark["dash"]
    dashed = f' stroke-dasharray="{" ".join(f"{d:g}" for d in dash)}"' if dash else ""
    return (
        f'<path d="{data}" fill="{mark["fill"] or "none"}"'
        f' stroke="{mark["stroke"] or "none"}" stroke-width="{mark["pen"]:g}"'
        f"{dashed}/>"
    )


def _point(x: float, y: float, places: int) -> str:
    return f"{round(x, places):g} {round(y, places):g}"


def _text(mark: TextMark) -> str:
    x, y = mark["at"]
    anchor = {"left": "start", "center": "middle", "right": "end"}[mark["anchor"]]
    size = mark["size"]
    turn = f' transform="rotate({mark["angle"]:g} {x:g} {y:g})"' if mark["angle"] else ""
    bold = ' font-weight="bold"' if mark["bold"] else ""
    halo = ' stroke="#fff" stroke-width="0.8" paint-order="stroke"' if mark["halo"] else ""
    return (
        f'<text x="{x:g}" y="{y + 0.36 * size * POINT:.3f}" font-size="{size * POINT:.3f}"'
        f' text-anchor="{anchor}" fill="{mark["color"]}"{bold}{halo}{turn}>'
        f"{_say(mark['text'])}</text>"
    )
