"""Checks of the pages: words, links, outside hosts, and ways from the index to every page."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from actuator_opt.base.words import fold

if TYPE_CHECKING:
    from .book import Book

ROOT = Path(__file__).resolve().parents[2]
BORROWED = {"contributing/extending.md": ROOT / "CONTRIBUTING.md"}
"""Pages whose text is a file outside docs/."""
OFFERED = ROOT / "designs"
"""Folder of files that pages offer for download, as `designs/NAME`."""

OWN = {"_build", "_static", "extensions", "__pycache__"}
"""Folders of docs/ without pages."""

SPELLING = {
    r"\b[Oo]ptimi[z](e|ed|es|er|ing|ation)\b": "optimise",
    r"\b[Mm]inimi[z](e|ed|es|ing|ation)\b": "minimise",
    r"\b[Mm]aximi[z](e|ed|es|ing|ation)\b": "maximise",
    r"\b[Aa]luminum\b": "aluminium",
    r"\b[Ff]iber(s|glass)?\b": "fibre",
    r"\b[Cc]enter(s|ed|ing)?\b": "centre",
    r"\b[Cc]olor(s|ed)?\b": "colour",
    r"\b[Bb]ehavior(s)?\b": "behaviour",
    r"\b[Mm]odeling\b": "modelling",
    r"\b[Ll]ayups?\b": "lay-up",
    r"\b[Ss]et-?point(s)?\b": "reference",
    r"\b[Cc]ylinder ?head\b": "head",
    r"\bstick[- ]?tion\b": "breakaway",
    r"\b[Ss]afety coefficient": "safety factor",
    r"\bshadow price": "price",
}
"""Terms of the project: a wrong spelling, and the right one."""

LOADING = {
    ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("video", "src"),
    ("audio", "src"), ("object", "data"), ("embed", "src"), ("link", "href"), ("image", "href"),
    ("use", "href"), ("input", "src"), ("img", "srcset"),
}  # fmt: skip
"""Elements and attributes by which a page loads something."""
STYLE = re.compile(r"(?:url\(\s*['\"]?|@import\s+['\"]?)(https?:)?//", re.IGNORECASE)


def written() -> dict[str, Path]:
    """Files of pages that are written by hand, by their path below docs/."""
    docs = ROOT / "docs"
    found = {
        path.relative_to(docs).as_posix(): path
        for path in sorted(docs.rglob("*"))
        if path.is_file()
        and path.relative_to(docs).parts[0] not in OWN
        and path.suffix not in (".py", ".pyc")
    }
    offered = {
        path.relative_to(ROOT).as_posix(): path
        for path in sorted(OFFERED.rglob("*.*"))
        if path.suffix in (".yaml", ".csv")
    }
    return found | BORROWED | offered


def content(path: Path) -> bytes:
    """Content of a file; links of a file outside docs/ are set right."""
    data = path.read_bytes()
    return data.replace(b"](docs/", b"](/") if path in BORROWED.values() else data


# --- words ---------------------------------------------------------------------------------------


CODE = re.compile(r"(\{\w+\}`[^`]*`)|``[^`]*``|`[^`]*`|\$[^$]*\$|\]\([^)]*\)")
"""Roles (first group), code, formulas and addresses in a line."""


def prose(text: str, *, roles: bool = False) -> Iterator[tuple[int, str]]:
    """Numbered lines of a page without code; `roles` keeps roles with their text."""
    fence = ""
    for number, line in enumerate(text.splitlines(), 1):
        marks = re.match(r"\s*(`{3,}|~{3,})(.*)", line)
        if marks and not fence:
            fence = marks[1] if not re.match(r"\{(?!run|model|toctree)", marks[2]) else ""
            continue
        if marks and fence and marks[1].startswith(fence) and not marks[2].strip():
            fence = ""
            continue
        if not fence:
            yield number, CODE.sub(r"\1" if roles else "", line)


@cache
def _banned() -> dict[str, str]:
    """Crutches that the tests of the package's English refuse, from the same list."""
    path = ROOT / "tests" / "project" / "test_english.py"
    tree = ast.parse(path.read_text("utf-8"))
    values = [
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "BANNED"
    ]
    found: dict[str, str] = ast.literal_eval(values[0])
    return found


def words() -> list[str]:
    """Faults of spelling and of plain English in pages written by hand, with the right word."""
    found = []
    for name, path in written().items():
        if path.suffix != ".md":
            continue
        for number, line in prose(path.read_text("utf-8")):
            for pattern, advice in (SPELLING | _banned()).items():
                if match := re.search(pattern, line):
                    found.append(f'docs/{name}:{number}: "{match.group()}": {advice}')
    return found


# --- pages ---------------------------------------------------------------------------------------


class Page(HTMLParser):
    """Anchors, links and loaded files of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.headings: list[tuple[str, str]] = []
        """Anchor and text of each heading."""
        self._section, self._heading, self._words = "", 0, ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element names or loads."""
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values["id"]} if "id" in values else set()
        if tag == "section":
            self._section = values.get("id", "")
        if tag in ("h1", "h2", "h3"):
            self._heading, self._words = 1, ""
        if tag == "a" and values.get("href") and "headerlink" not in values.get("class", ""):
            self.links.append(values["href"])
        if tag == "link" and values.get("rel") in ("canonical", "next", "prev", "author"):
            return
        for name, value in values.items():
            if ((tag, name) in LOADING and value) or (name == "style" and STYLE.search(value)):
                self.loaded.append(value)

    def handle_data(self, data: str) -> None:
        """Gather the words of a heading."""
        self._words += data if self._heading else ""

    def handle_endtag(self, tag: str) -> None:
        """End a heading."""
        if tag in ("h1", "h2", "h3") and self._heading:
            self.headings.append((self._section, self._words.strip().removesuffix("#").strip()))
            self._heading = 0


def _pages(folder: Path) -> dict[str, Page]:
    return {
        path.relative_to(folder).as_posix(): Page(path.read_text("utf-8"))
        for path in sorted(folder.rglob("*.html"))
    }


def html(folder: Path) -> list[str]:
    """Faults of all built pages: broken links, outside hosts, pages that no link leads to."""
    pages, faults = _pages(folder), []
    ways: dict[str, set[str]] = {}
    for name, page in pages.items():
        for address in page.loaded:
            if urlsplit(address).netloc or STYLE.search(address):
                faults.append(f"{name}: loads {address} from outside")
            elif (
                not address.startswith(("#", "data:"))
                and not ((folder / name).parent / _path(address)).is_file()
            ):
                faults.append(f"{name}: no file {address}")
        for address in page.links:
            fault, target = _resolved(name, address, pages, folder)
            faults += [f"{name}: {fault}"] if fault else []
            ways.setdefault(name, set()).add(target)
    for path in sorted(folder.rglob("*.css")):
        if STYLE.search(path.read_text("utf-8")):
            faults.append(f"{path.relative_to(folder)}: loads a style or font from outside")
    reached, waiting = {"index.html"}, ["index.html"]
    while waiting:
        for target in ways.get(waiting.pop(), set()) - reached:
            reached.add(target)
            waiting.append(target)
    lost = set(pages) - reached - {"search.html", "genindex.html", "404.html"}
    return [*faults, *(f"{name}: no link from the index leads here" for name in sorted(lost))]


def _path(address: str) -> str:
    return unquote(urlsplit(address).path)


def unused_images(folder: Path) -> list[Path]:
    """Images of earlier builds that no page shows."""
    shown = {
        ((folder / name).parent / _path(address)).resolve()
        for name, page in _pages(folder).items()
        for address in page.loaded
    }
    return [path for path in (folder / "_images").glob("*") if path.resolve() not in shown]


def _resolved(name: str, address: str, pages: Mapping[str, Page], folder: Path) -> tuple[str, str]:
    """Fault of a link, and the page to which it leads."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return ("" if parts.scheme in ("https", "mailto") else f"link to {address}"), ""
    path = (folder / name).parent / unquote(parts.path) if parts.path else folder / name
    target = path.resolve().relative_to(folder.resolve()).as_posix()
    if target not in pages:
        return ("" if path.exists() else f"no file for the link {address}"), ""
    if parts.fragment and unquote(parts.fragment) not in pages[target].anchors:
        return f"no place for the link {address}", target
    return "", target


def topics(folder: Path, book: Book) -> dict[str, list[dict[str, str]]]:
    """Addresses and titles of each topic: names of the reference, pages, and their headings.

    The first place of a word is the one that `docs` opens.
    """
    found: dict[str, list[dict[str, str]]] = {}
    pages = _pages(folder)

    def add(word: str, page: str, anchor: str, title: str) -> None:
        places = found.setdefault(fold(word), [])
        address = f"{page}#{anchor}" if anchor else page
        known = [place["address"] for place in places]
        if address not in known and (anchor or all(a.partition("#")[0] != page for a in known)):
            places.append({"address": address, "title": title})

    def add_entry(word: str, label: str, title: str) -> None:
        page = f"{book.places[label]}.html"
        add(word, page, label if label in pages[page].anchors else "", title)

    names = [(kind, name, label) for kind, of in book.labels.items() for name, label in of.items()]
    for kind, name, label in names:
        if kind != "scenario":
            add_entry(name, label, f"{kind} {name}")
    for name, page in sorted(pages.items(), key=lambda pair: pair[0].startswith("reference/")):
        if page.headings and name not in ("search.html", "genindex.html"):
            title = page.headings[0][1]
            if name.startswith("reference/"):
                title += f" ({name.rpartition('/')[0]})"
            for word in (page.headings[0][1], name.removesuffix(".html"), Path(name).stem):
                add(word, name, "", title)
            if not name.startswith("reference/"):
                for anchor, words in page.headings[1:]:
                    add(words, name, anchor, f"{title}: {words}")
    for alias, label in book.aliases.items():
        add_entry(alias, label, alias)
    for kind, name, label in names:
        if kind == "scenario":
            add_entry(name, label, f"scenario key {name}")
    return found
