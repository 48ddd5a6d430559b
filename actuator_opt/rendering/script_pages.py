"""Report sheets of a worked study, and the main program of its script.

Most studies use a common sheet (``script_sheet.typ``) with heading, lead and blocks. Other studies
have their own .typ file beside the script.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, get_args

from ..base.files import write_all
from .blocks import Block, Column, Table
from .paper import TEMPLATE, plain_blocks, sheets

Numbers: TypeAlias = Mapping[str, Any]
"""Results of a study in SI units, by name: numbers, lists and nested mappings."""
Sheets: TypeAlias = tuple[bytes, list[bytes]]
"""A report as PDF, and an image of every sheet."""
Study = TypeVar("Study")

SHEET = Path(__file__).with_name("script_sheet.typ")
_MARK = "// ---- sheet ----"
"""Line of the report template that ends its definitions; the sheet for a design follows."""


def rounded(study: Numbers, digits: int = 7) -> dict[str, Any]:
    """Plain numbers rounded to some digits, so that all machines give the same text.

    >>> rounded({"mass": 0.123456789, "rows": (1, None)})
    {'mass': 0.1234568, 'rows': [1, None]}

    Raises
    ------
    ValueError
        a number that JSON cannot represent (NaN or infinity)
    """
    text = json.dumps(study, allow_nan=False)
    plain: dict[str, Any] = json.loads(text, parse_float=lambda x: float(f"{float(x):.{digits}g}"))
    return plain


def grid_table(
    title: str,
    grid: Sequence[Sequence[str]],
    note: str = "",
    *,
    words: Sequence[int] = (),
    widths: Mapping[int, float | str] | float | str = "auto",
) -> Table:
    """A table from a grid whose first row has the heads; numbers are aligned to the right.

    Parameters
    ----------
    title, note : texts above and below the table
    grid : row of heads, then the other rows
    words : numbers of the columns that contain words, which are aligned to the left; negative
        numbers count from the last column
    widths : width of every column, or widths by column number; columns not listed are "auto"
    """
    heads, *rows = grid
    text_columns = {k if k >= 0 else k + len(heads) for k in words}
    by_column = widths if isinstance(widths, Mapping) else dict.fromkeys(range(len(heads)), widths)
    column_widths = {k if k >= 0 else k + len(heads): width for k, width in by_column.items()}
    columns = [
        Column(head, "left" if k in text_columns else "right", column_widths.get(k, "auto"))
        for k, head in enumerate(heads)
    ]
    return Table(title, columns, rows, note=note)


def study_report(
    script: str | Path,
    study: Numbers,
    *,
    title: str,
    heading: str,
    lead: Sequence[str],
    blocks: Sequence[Block | Numbers],
    whole: bool = False,
) -> Sheets:
    """The report of a study on the common sheet.

    Parameters
    ----------
    script : file of the study
    study : numbers of the study, attached to the PDF as JSON
    title, heading : title of the PDF, and printed heading
    lead : paragraphs below the heading
    blocks : blocks of the sheet from top to bottom, or their plain data for the template
    whole : whether every table must stay on one sheet
    """
    data = {
        "script": Path(script).stem,
        "version": study["version"],
        "title": title,
        "heading": heading,
        "lead": list(lead),
        "blocks": _plain(list(blocks)),
        "whole": whole,
    }
    return _compiled(SHEET, study, data)


def study_sheets(script: str | Path, study: Numbers, data: Numbers) -> Sheets:
    """The report of a study on the sheets of the .typ file beside its script.

    `data` fills the sheets.
    """
    return _compiled(Path(script).with_suffix(".typ"), study, _plain(data))


def _compiled(sheet: Path, study: Numbers, data: Numbers) -> Sheets:
    """Compile a sheet to PDF and images; the same numbers give the same bytes."""
    definitions, mark, _ = TEMPLATE.read_text("utf-8").partition(_MARK)
    assert mark, "the report template lacks the line that ends its definitions"
    numbers = json.dumps(study, indent=1, allow_nan=False)
    source = definitions + sheet.read_text("utf-8")
    return sheets(source.encode(), {**data, "numbers": numbers}, timestamp=0)


def _plain(value: Any) -> Any:
    """Convert blocks, also inside lists and records, to plain data for a template."""
    if isinstance(value, get_args(Block)):
        return plain_blocks([value])[0]
    if isinstance(value, Mapping):
        return {name: _plain(entry) for name, entry in value.items()}
    return [_plain(entry) for entry in value] if isinstance(value, list | tuple) else value


def write_study(pages: Sheets, folder: Path, name: str) -> int:
    """Write NAME.pdf and the PNG of its first sheet; returns the number of sheets."""
    pdf, images = pages
    write_all(folder, {f"{name}.pdf": pdf, f"{name}.png": images[0]})
    return len(images)


def run_script(
    script: str | Path,
    description: str,
    compute: Callable[..., Study],
    printed: Callable[[Study], str],
    page: Callable[[Study], Sheets],
    *,
    quick: str = "",
) -> str:
    """Compute a study and return its text; write its report if a folder is named.

    Parameters
    ----------
    script : file of the study
    description : description of the command, for its help
    compute : function that computes the study; it takes `quick=` if the script has this option
    printed : function that returns the text for the terminal
    page : function that returns the report
    quick : help text of the option ``--quick``; if empty, the script has no such option
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=Path, help="folder for the report")
    if quick:
        parser.add_argument("--quick", action="store_true", help=quick)
    options = parser.parse_args()
    study = compute(quick=options.quick) if quick else compute()
    if options.out is None:
        return printed(study)
    count = write_study(page(study), options.out, Path(script).stem)
    return f"{printed(study)}\n{count} sheets"
