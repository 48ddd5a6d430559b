"""A page on paper: PDF and PNG by Typst; drawings as PNG and SVG.

Files are made in memory, written under a temporary name and renamed when complete. The PDF
contains the input file and the command (PDF/A-3), so that a report can be run again.
"""

from __future__ import annotations

import hashlib
import importlib.util
import io
import json
import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ..base.files import write_all
from ..base.tables import encoded
from ..version import VERSION
from . import html, paper_plain as fallback
from .blocks import (
    FARTHEST,
    AttachedFile,
    Bar,
    Block,
    Cell,
    Chart,
    Drawing,
    Flag,
    Listing,
    Notes,
    Origin,
    Page,
    Pair,
    Reach,
    ReportFile,
    Share,
    Slot,
    Status,
    Table,
    clean,
    printable,
    short,
    soft,
    with_input,
)
from .chart_ink import drawn
from .heights import FULL, HALF, cells_of, fitting, room
from .ink import Ink

PIXELS_PER_INCH = 150.0
_SUSPECTS = b"/Suspects false"
"""PDF entry that Typst writes and that makes Poppler warn. It is overwritten with blanks of the
same length, so that all byte offsets in the file stay valid."""
HEAD = 12
"""A name in a column head with more letters than this may be broken after ``_``."""
TEMPLATE = Path(__file__).with_name("template.typ")


def write(
    page: Page,
    origin: Origin,
    *,
    folder: Path,
    stem: str,
    all_pages: bool = False,
    format: str = "pdf",
    attached: Sequence[AttachedFile] = (),
    **run: Any,
) -> list[ReportFile]:
    """Write a page into a folder: ``STEM.pdf`` and ``STEM.png`` (first sheet), or ``STEM.html``.

    Parameters
    ----------
    page : to write
    origin : design file and command of the page, attached to the PDF
    folder, stem : target; the folder is made if missing
    all_pages : whether to write images of the other sheets, too, as ``STEM-page-N.png``
    format : "pdf" (with PNG), "html", or "both"
    attached : further files to attach to the PDF
    run : further facts about the run, attached to the PDF

    Returns
    -------
    the files, PDF first

    Raises
    ------
    InputError : the folder cannot be written; no partial file is left
    """
    web = html.write(page, origin, folder=folder, stem=stem) if format in ("html", "both") else []
    if format == "html":
        return web
    data = _printable(plain(page, origin)) | {
        "title": _encodable(page.name),
        "source": _encodable(origin.source_text),
        "source_file": _attachment_name(_encodable(origin.source_name)),
        "run": _encodable(encoded(origin.run() | run, ensure_ascii=False, sort_keys=True)),
    }
    if attached:
        data["attached"] = [
            {"name": x.name, "media": x.media, "content": x.content, "about": x.about}
            for x in attached
        ]
    pdf, images = _render(data, _timestamp(origin.date))
    contents = {f"{stem}.pdf": pdf, f"{stem}.png": images[0]}
    for index, image in enumerate(images[1:] if all_pages else (), 2):
        contents[f"{stem}-page-{index}.png"] = image
    write_all(folder, contents)
    _remove_later_pages(folder, stem, len(images) if all_pages else 1)
    return [
        ReportFile(
            folder / name,
            hashlib.sha256(content).hexdigest(),
            len(images) if name.endswith(".pdf") else 1,
        )
        for name, content in contents.items()
    ] + web


# ---- pages as plain data for the template ----


def plain(page: Page, origin: Origin) -> dict[str, object]:
    """A page as plain data for the Typst template."""
    hero = page.hero(max(room(page), page.least))
    return {
        "name": soft(page.name),
        "title": clean(page.name),
        "short": short(page.design or page.name, 32),
        "kind": page.kind,
        "version": VERSION,
        "hash": clean(origin.spec_hash[:16]),
        "date": "" if origin.date is None else clean(origin.date),
        "command": soft(short(origin.command, 260), 30),
        "verdict": {
            "state": page.verdict.state,
            "text": page.verdict.text,
            "lines": list(page.verdict.lines),
            "cautions": list(page.verdict.cautions),
        },
        "sentence": soft(page.sentence),
        "tiles": [
            {
                "label": short(tile.label, 30),
                "symbol": tile.symbol,
                "value": tile.value,
                "unit": tile.unit,
                "note": short(tile.note, 44),
                "state": tile.state,
            }
            for tile in page.tiles
        ],
        "section": hero.data(),
        "scale": page.scale,
        "items": [
            {"number": number, "part": clean(part), "material": clean(material)}
            for number, part, material in page.items
        ],
        "blocks": plain_blocks(with_input(page, origin)),
    }


def plain_blocks(blocks: Sequence[Block], width: float = FULL) -> list[dict[str, object]]:
    """Blocks, laid out for a width on paper [mm], as plain data for the Typst template."""
    parts = [
        part
        for block in blocks
        for part in (fitting(block, width) if isinstance(block, Table) else [block])
    ]
    return [data for part in parts if (data := _block(part)) is not None]


def _block(block: Block) -> dict[str, object] | None:
    if isinstance(block, Pair):
        return {"kind": "pair", "sides": [plain_blocks(side, HALF) for side in block.sides]}
    if isinstance(block, Table):
        return None if block.on == "terminal" else _table(block)
    if isinstance(block, Drawing):
        return _figure(block.title, block.ink, block.note)
    if isinstance(block, Chart):
        return _figure(block.title, drawn(block), block.note)
    if isinstance(block, Notes):
        items = [soft(item) for item in block.items]
        data: dict[str, object] = {
            "kind": "notes",
            "title": block.title,
            "items": items,
            "note": block.note,
        }
        return None if block.on == "terminal" else data
    if isinstance(block, Listing):
        lines = block.text.splitlines()
        wide = sum(len(line.rstrip()) > 62 for line in lines) > len(lines) // 10
        return {
            "kind": "listing",
            "title": clean(block.title),
            "lines": [soft(line.expandtabs(4), 40) for line in lines],
            "columns": 1 if wide else 2,
        }
    return None


def _figure(title: str, ink: Ink, note: str) -> dict[str, object]:
    return {"kind": "figure", "title": clean(title), "ink": ink.data(), "note": clean(note)}


def _table(table: Table) -> dict[str, object]:
    shown = [k for k, column in enumerate(table.columns) if column.on != "terminal"]
    columns = [table.columns[k] for k in shown]
    return {
        "kind": "table",
        "title": clean(table.title),
        "columns": [
            {
                "head": soft(column.head, column.breaks, name=HEAD)
                if column.breaks and "\n" not in column.head
                else column.head,
                "align": column.align,
                "width": column.width,
            }
            | {name: True for name in ("mono", "strong") if getattr(column, name)}
            for column in columns
        ],
        "rows": [
            [
                _cell(cells_of(row)[k], column.breaks)
                for k, column in zip(shown, columns, strict=True)
            ]
            for row in table.rows
        ],
        "note": clean(table.note),
        "total": table.total,
    }


def _cell(cell: Cell, breaks: int) -> object:
    if isinstance(cell, str):
        return soft(cell, breaks) if breaks else clean(cell)
    if isinstance(cell, Status):
        return {"status": cell.state, "text": cell.words}
    if isinstance(cell, Bar):
        return "" if cell.margin is None else _bar(cell.margin, cell.met)
    if isinstance(cell, Share):
        return {"share": round(max(0.0, min(1.0, cell.value)), 4)}
    if isinstance(cell, Reach):
        return "" if cell.change is None else _reach(cell.change, cell.met)
    if isinstance(cell, Slot):
        return {"slot": round(max(0.0, min(1.0, cell.place)), 4), "at": cell.at}
    if isinstance(cell, Flag):
        return {"flag": cell.raised, "text": cell.text}
    return cell


def _bar(margin: float, met: bool) -> dict[str, object]:
    return {"bar": round(max(-1.0, min(1.0, margin)), 4), "over": abs(margin) > 1.0, "met": met}


def _reach(change: float, met: bool) -> dict[str, object]:
    share = change / FARTHEST
    return {"reach": round(max(-1.0, min(1.0, share)), 4), "over": abs(share) > 1.0, "met": met}


def _printable(data: Any) -> Any:
    """The data, with characters that the typeface lacks replaced in every text."""
    if isinstance(data, str):
        return printable(data)
    if isinstance(data, dict):
        return {key: _printable(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_printable(value) for value in data]
    return data


# ---- files ----


def _encodable(text: str) -> str:
    """A text that UTF-8 can encode; stray bytes of a file name in another encoding are escaped."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _attachment_name(source_name: str) -> str:
    name = re.split(r"[/\\]", source_name)[-1]
    return re.sub(r"[\x00-\x1f\x7f]", "_", name) or "input.yaml"


def _timestamp(date: str | None) -> int:
    """Seconds since 1970 of an ISO date, for the metadata of the PDF; 0 without a date."""
    try:
        moment = datetime.fromisoformat(date or "1970-01-01")
    except ValueError:
        return 0
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=UTC)
    return max(int(moment.timestamp()), 0)


def _render(data: Mapping[str, Any], timestamp: int) -> tuple[bytes, list[bytes]]:
    if importlib.util.find_spec("typst") is None:
        from .paper_plain import render

        return render(data, timestamp)
    return sheets(TEMPLATE.read_bytes(), data, timestamp)


def sheets(source: bytes, data: Mapping[str, Any], timestamp: int) -> tuple[bytes, list[bytes]]:
    """Compile a Typst source with its data to PDF/A, and to an image of every sheet."""
    import typst

    compiler = typst.Compiler(
        source,
        root=TEMPLATE.parent,  # the working directory may be deleted
        font_paths=typst.Fonts(
            include_system_fonts=False, include_embedded_fonts=True, font_paths=font_folders()
        ),
        sys_inputs={"data": json.dumps(data, ensure_ascii=False, sort_keys=True)},
    )
    pdf: Any = compiler.compile(
        input=source, format="pdf", pdf_standards="a-3b", timestamp=timestamp
    )
    images: Any = compiler.compile(
        input=source, format="png", ppi=PIXELS_PER_INCH, timestamp=timestamp
    )
    plain = bytes(pdf).replace(_SUSPECTS, b" " * len(_SUSPECTS))
    return plain, [images] if isinstance(images, bytes) else list(images)


def font_folders() -> list[str]:
    """Folder of matplotlib's fonts, located without importing matplotlib."""
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        return []
    return [str(Path(spec.origin).parent / "mpl-data" / "fonts" / "ttf")]


def _remove_later_pages(folder: Path, stem: str, count: int) -> None:
    """Delete old images of sheets after the last, left over from a report of the same name."""
    index = max(count + 1, 2)
    while (path := folder / f"{stem}-page-{index}.png").is_file():
        path.unlink()
        index += 1


def images(ink: Ink, stem: str) -> dict[str, bytes]:
    """STEM.png and STEM.svg of a drawing; the same drawing gives the same bytes."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    style: Any = {
        "font.family": "DejaVu Sans",
        "text.parse_math": False,
        "text.usetex": False,
        "svg.hashsalt": stem,
    }
    for mark in ink.marks:
        if "text" in mark:
            mark["text"] = printable(mark["text"])
    contents = {}
    with mpl.rc_context(style):
        figure = fallback.drawn(ink)
        FigureCanvasAgg(figure)
        for kind, about in (("png", {"Software": None}), ("svg", {"Date": None, "Creator": None})):
            file = io.BytesIO()
            figure.savefig(file, format=kind, dpi=PIXELS_PER_INCH, metadata=about)
            contents[f"{stem}.{kind}"] = file.getvalue()
    return contents


def write_ink(ink: Ink, folder: Path, stem: str) -> list[Path]:
    """Write STEM.png and STEM.svg into a folder, completely or not at all."""
    contents = images(ink, stem)
    write_all(folder, contents, what="the figure")
    return [folder / name for name in contents]
