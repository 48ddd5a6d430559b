"""The page of an explored sweep: markup, style, script and data in a single, self-contained file.

Data are in a JSON block that no text can close; the script inserts texts as text nodes, and the
security policy of the page allows no other script.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..base.files import write_text
from ..base.tables import encoded
from ..sweeps.explored import Explored
from .payload import payload

FOLDER = Path(__file__).parent
SCRIPTS = ("data", "front", "scatter", "axes", "section", "main")
_ESCAPES = {c: f"\\u{ord(c):04x}" for c in "<>&\u2028\u2029"}


@dataclass(frozen=True, slots=True)
class ExplorerFile:
    """A file of the explorer, with its hash."""

    path: Path
    sha256: str
    remarks: tuple[str, ...] = ()
    """Remarks on the rows of the sweep."""

    def to_dict(self) -> dict[str, object]:
        """The JSON form."""
        told: dict[str, object] = {"path": str(self.path), "sha256": self.sha256}
        return told | ({"remarks": list(self.remarks)} if self.remarks else {})


def page(explored: Explored, *, design: str, plugins: Sequence[str] = ()) -> str:
    """The page as HTML.

    Parameters
    ----------
    explored : the sweep
    design : file name of the base design, beside the page
    plugins : files with user metrics, for the command
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
    return re.sub("@([A-Z_]+)@", lambda found: parts[found[1]], _text("page.html"))


def design_beside(target: Path) -> Path:
    """File of the base design, beside the page."""
    return target.with_name(f"{target.stem}_base.yaml")


def write_explorer(
    explored: Explored,
    target: Path,
    *,
    plugins: Sequence[str] = (),
    remarks: Sequence[str] = (),
) -> list[ExplorerFile]:
    """Write the page, and beside it the base design that its command uses.

    Parameters
    ----------
    explored : the sweep
    target : file of the page
    plugins : files with user metrics, for the command
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
    """JSON in which nothing parses as markup."""
    text = encoded(data, ensure_ascii=False, separators=(",", ":"))
    return re.sub("[<>&\u2028\u2029]", lambda found: _ESCAPES[found[0]], text)
