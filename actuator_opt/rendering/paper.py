"""Write a report: PDF and PNG pages, whole or not at all.

Everything is made in memory, written beside its place, then renamed. The PDF carries the input
file and the command inside itself (PDF/A-3), so that a report can be run again.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ..base.errors import Diagnostic, InputError
from ..base.files import read_bytes, read_json, write_all as write_all
from ..base.plain_json import encoded
from .blocks import printable
from .embed import extract
from .origin import Origin

PIXELS_PER_INCH = 150.0
_MOST_BYTES = 200_000_000
_OURS = "give a PDF that actuator-opt wrote"
TEMPLATE = Path(__file__).with_name("template.typ")


@dataclass(frozen=True, slots=True)
class ReportFile:
    """A file of a report, with its hash and how many sheets it holds."""

    path: Path
    sha256: str
    pages: int

    def to_dict(self) -> dict[str, object]:
        """The JSON form."""
        return {"path": str(self.path), "sha256": self.sha256, "pages": self.pages}


@dataclass(frozen=True, slots=True)
class Attachment:
    """What a report carries inside: the design's text and how the report was made."""

    source: str
    run: Mapping[str, Any]


def write_page(
    data: Mapping[str, Any], origin: Origin, *, title: str, folder: Path, stem: str, **run: Any
) -> list[ReportFile]:
    """Write a page of data to PDF and PNG.

    Parameters
    ----------
    data : of the page
    origin : its source, as it is, and how it was made: both are attached to the PDF
    title : of the PDF, as it is
    folder, stem : where to
    run : more of how it was made
    """
    data = printable(dict(data)) | {
        "title": _encodable(title),
        "source": _encodable(origin.source_text),
        "source_file": _attachment_name(_encodable(origin.source_name)),
        "run": _encodable(encoded(origin.run() | run, ensure_ascii=False, sort_keys=True)),
    }
    pdf, images = _render(data, _timestamp(origin.date))
    contents = {f"{stem}.pdf": pdf, f"{stem}.png": images[0]}
    for index, image in enumerate(images[1:], 2):
        contents[f"{stem}-page-{index}.png"] = image
    write_all(folder, contents)
    _remove_later_pages(folder, stem, len(images))
    return [
        ReportFile(
            folder / name,
            hashlib.sha256(content).hexdigest(),
            len(images) if name.endswith(".pdf") else 1,
        )
        for name, content in contents.items()
    ]


def read_attachment(path: Path) -> Attachment:
    """The input and the command that a report of ours carries.

    Raises
    ------
    InputError : no such file, no PDF, encrypted, damaged, or not written by this program
    """
    content = read_bytes(path, most=_MOST_BYTES, kinds=(".pdf",), what="PDF")
    try:
        if b"%PDF-" not in content[:1024]:
            raise InputError(Diagnostic("is no PDF", _OURS))
        if re.search(rb"/Encrypt\s+\d+\s+\d+\s+R", content):
            raise InputError(Diagnostic("is encrypted", "save it without a password"))
        found = extract(content, ("application/yaml", "application/json"))
        source, run = found["application/yaml"].decode(), read_json(found["application/json"])
        if not isinstance(run, dict) or "actuator_opt" not in run:
            raise KeyError("actuator_opt")
    except KeyError:
        raise InputError(Diagnostic(_carries(content), _OURS, str(path))) from None
    except ValueError:
        fault = Diagnostic("its attachment is damaged", "take the original file", str(path))
        raise InputError(fault) from None
    except InputError as error:
        raise InputError([replace(x, file=str(path)) for x in error.diagnostics]) from None
    return Attachment(source, run)


def _carries(content: bytes) -> str:
    """Why there is no input in a PDF: it never was, or the end of the file is lost."""
    ended = b"%%EOF" in content[-2048:]
    return "carries no input to run again" if ended else "is cut off and carries no input"


def _encodable(text: str) -> str:
    """Text that UTF-8 can hold: bytes of a file name in another encoding are spelt out."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _attachment_name(source_name: str) -> str:
    name = re.split(r"[/\\]", source_name)[-1]
    return re.sub(r"[\x00-\x1f\x7f]", "_", name) or "input.yaml"


def _timestamp(date: str | None) -> int:
    """Seconds since 1970 of an ISO date, for the PDF's own metadata; 0 without one."""
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
    """A Typst source with its data as PDF/A and as an image of every sheet; no font but ours."""
    import typst

    compiler = typst.Compiler(
        source,
        root=TEMPLATE.parent,  # not the working directory, which may be gone
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
    return bytes(pdf), [images] if isinstance(images, bytes) else list(images)


def font_folders() -> list[str]:
    """Matplotlib's fonts, found without importing it."""
    found = importlib.util.find_spec("matplotlib")
    if found is None or found.origin is None:
        return []
    return [str(Path(found.origin).parent / "mpl-data" / "fonts" / "ttf")]


def _remove_later_pages(folder: Path, stem: str, count: int) -> None:
    """Remove sheets of an earlier, longer report under the same name."""
    index = max(count + 1, 2)
    while (path := folder / f"{stem}-page-{index}.png").is_file():
        path.unlink()
        index += 1
