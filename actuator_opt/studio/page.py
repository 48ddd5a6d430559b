"""The page of the studio: markup, style and script in one text that loads nothing else."""

from __future__ import annotations

import base64
import hashlib
import re
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent
SCRIPTS = (
    "../explorer/section",
    "words",
    "link",
    "chart",
    "slider",
    "state",
    "menus",
    "cycle",
    "main",
)
"""Parts of the script, in order; each uses only those before it. The section is the explorer's."""


def _text(name: str) -> str:
    return (FOLDER / name).read_text("utf-8")


@cache
def _parts() -> tuple[str, str]:
    """Style and script."""
    script = "".join(f"{_text(f'{name}.js')}\n" for name in SCRIPTS)
    return _text("page.css"), f'"use strict";\n{script}'


def _hash(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _policy() -> str:
    style, script = map(_hash, _parts())
    return (
        f"default-src 'none'; script-src '{script}'; style-src '{style}'; connect-src 'self'; "
        "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


POLICY = _policy()
"""Content security policy of the page: its own script and style, requests to its own server."""


@cache
def page() -> str:
    """The page as HTML. It is the same for all designs."""
    style, script = _parts()
    parts = {"STYLE": style, "SCRIPT": script}
    return re.sub("@([A-Z]+)@", lambda match: parts[match[1]], _text("page.html"))
