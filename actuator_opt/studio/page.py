"""The page of the studio: markup, style and script in one text that loads nothing else.

The page exists twice: live, with a server that solves, and offline, with a worker that solves.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from ..base.symbolic.program import SCRIPT

FOLDER = Path(__file__).parent
SCRIPTS = (
    "../explorer/section",
    "words",
    "link",
    "chart",
    "slider",
    "state",
    "files",
    "menus",
    "cycle",
    "main",
)
"""The script's parts, in order; each uses only the parts before it, or functions of later ones.
The section is the explorer's."""
OFFLINE = {"link": "offline_link", "files": "offline_files", "menus": None, "cycle": None}
"""Parts that the offline page has instead, or does not have."""
WORKER = ("words", "algebra", "optimiser", "pricing", "offline_worker")
"""Parts of the offline page's worker, after the machine that runs programs."""
GENERATOR = '<meta name="generator" content="actuator-opt studio">'
"""Marks the offline pages, so that a later page may replace an earlier page."""


def _text(name: str) -> str:
    return (FOLDER / name).read_text("utf-8")


@cache
def _parts(*, offline: bool) -> tuple[str, str]:
    """Style and script."""
    names = [OFFLINE.get(name, name) if offline else name for name in SCRIPTS]
    script = "".join(f"{_text(f'{name}.js')}\n" for name in names if name)
    return _text("page.css"), f'"use strict";\n{script}'


@cache
def _worker() -> str:
    return SCRIPT.read_text("utf-8") + "".join(f"{_text(f'{name}.js')}\n" for name in WORKER)


def _hash(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _policy(own: str, *, offline: bool) -> str:
    style, script = map(_hash, _parts(offline=offline))
    return (
        f"default-src 'none'; script-src '{script}'; style-src '{style}'; {own}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


POLICY = _policy("connect-src 'self'", offline=False) + "; frame-ancestors 'none'"
"""Content security policy of the live page: its own script and style, requests to its server."""


@cache
def page() -> str:
    """The live page as HTML. It is the same for all designs."""
    return _filled({"META": "", "TITLE": "Studio"}, offline=False)


def offline_page(*, name: str, made: str, data: str) -> str:
    """The offline page as HTML.

    Parameters
    ----------
    name : name of the design
    made : version and hash of the design, printed in the help
    data : packed data of the design, see `offline`; letters of base64
    """
    policy = _policy("worker-src blob:", offline=True)
    meta = f'\n{GENERATOR}\n<meta http-equiv="Content-Security-Policy" content="{policy}">'
    parts = {
        "META": meta,
        "TITLE": html.escape(f"{name}: studio"),
        "MADE": html.escape(made),
        "WORKER": _worker(),
        "DATA": data,
    }
    return _filled(parts, offline=True)


def _filled(parts: Mapping[str, str], *, offline: bool) -> str:
    other = "live" if offline else "offline"
    text = re.sub(f"<!--{other}-->.*?<!--/{other}-->", "", _text("page.html"), flags=re.DOTALL)
    text = re.sub("<!--/?(live|offline)-->", "", text)
    style, script = _parts(offline=offline)
    filled = {**parts, "STYLE": style, "SCRIPT": script}
    return re.sub("@([A-Z]+)@", lambda match: filled[match[1]], text)
