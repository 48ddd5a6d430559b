"""The documentation pages that the wheel carries: unpacked once, found by topic."""

from __future__ import annotations

import hashlib
import json
import shutil
import tarfile
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

from ..base import files as store
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError, shown
from ..base.words import fold, ranked
from ..version import VERSION
from .reference import LEAST, Entry, all_entries, checked_word, find, nearest_names

Topics: TypeAlias = Mapping[str, Sequence[Mapping[str, str]]]
"""Address and title of each place of a topic, the topic in the form of `fold`."""
ARCHIVE = "docs.tar.xz"
TOPICS = "topics.json"
"""File of the pages that lists the address and title of every topic."""
_PACKAGE = Path(__file__).resolve().parents[1]


@dataclass(frozen=True, slots=True)
class DocumentationPage:
    """A page of the documentation: its file, the place on it, its title, and further places."""

    topic: str
    title: str
    file: Path
    anchor: str = ""
    also: tuple[DocumentationPage, ...] = ()

    @property
    def address(self) -> str:
        """Address for a browser."""
        return self.file.as_uri() + (f"#{self.anchor}" if self.anchor else "")

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "topic": self.topic,
            "title": self.title,
            "file": str(self.file),
            "address": self.address,
            "also": [{"title": page.title, "address": page.address} for page in self.also],
        }

    def text(self) -> str:
        """Title and address of each place, a line each."""
        return "".join(f"{page.title}: {page.address}\n" for page in (self, *self.also))


def archive(*, package: Path = _PACKAGE) -> Path | None:
    """The packed pages of this installation, or of its checkout; None if there are none."""
    checkout = package.parent
    built = checkout / "docs" / "_build" / ARCHIVE
    places = [package / "_data" / ARCHIVE]
    places += [built] if (checkout / "pyproject.toml").is_file() else []
    return next((path for path in places if path.is_file()), None)


def unpacked(packed: Path, folder: Path | None = None) -> Path:
    """Folder with the pages of an archive; the first call unpacks them.

    Parameters
    ----------
    packed : archive
    folder : where to unpack; by default the user's cache. The name below it has the version and the
        hash of the archive, so that another version or another build has its own folder.

    Raises
    ------
    InputError : the folder cannot be written, or the archive is damaged
    """
    content = packed.read_bytes()
    code = hashlib.sha256(content).hexdigest()[:12]
    place = (folder or store.user_folder("cache") / "docs") / f"{VERSION}-{code}"
    if (place / TOPICS).is_file():
        return place
    aside = None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=".unpacking-", dir=place.parent))
        with tarfile.open(packed, "r:xz") as pages:
            pages.extractall(aside, filter="data")
        shutil.rmtree(place, ignore_errors=True)  # of a build that was deleted in part
        aside.rename(place)
    except (tarfile.TarError, EOFError) as error:
        message = f"the packed pages are damaged: {error}"
        raise InputError(Diagnostic(message, "install the package again", str(packed))) from None
    except OSError as error:
        if (place / TOPICS).is_file():  # another process was faster
            return place
        message = f"the pages cannot be unpacked: {error.strerror or error}"
        remedy = "free disk space, or set XDG_CACHE_HOME to a folder that can be written"
        raise InputError(Diagnostic(message, remedy, str(place))) from None
    finally:
        if aside is not None and aside.exists():
            shutil.rmtree(aside, ignore_errors=True)
    return place


def documentation(
    topic: str | None = None, *, folder: Path | None = None
) -> DocumentationPage | None:
    """The page of a topic; None if this installation carries no pages.

    Parameters
    ----------
    topic : metric or words of its label, PATH, command, material, source, term, or title of a page
        or of a section; None for the first page
    folder : where the pages are unpacked; by default the user's cache

    Raises
    ------
    UsageError : unknown topic, with the nearest ones
    InputError : the pages cannot be unpacked
    """
    word = None if topic is None else checked_word(topic)
    packed = archive()
    if packed is None:
        return None
    home = unpacked(packed, folder)
    if word is None:
        return DocumentationPage("", "Documentation", home / "index.html")
    topics: Topics = json.loads((home / TOPICS).read_text("utf-8"))
    name = _found(word, topics)
    if name is None:
        raise _unknown(word, topics)
    places = []
    for place in topics[name]:
        file, _, anchor = place["address"].partition("#")
        places.append(DocumentationPage(name, place["title"], home / file, anchor))
    return replace(places[0], also=tuple(places[1:]))


def _found(word: str, topics: Topics) -> str | None:
    """The topic of a word: by its name, as `explain` finds it, or by words of a metric's label."""
    if fold(word) in topics:
        return fold(word)
    entry = find(word) or _labelled(word)
    if entry is None:
        return None
    generic = "".join("[*]" if k % 2 else part for k, part in enumerate(_bracketed(entry.name)))
    return next((name for name in map(fold, (entry.name, generic)) if name in topics), None)


def _labelled(text: str) -> Entry | None:
    """The metric whose label holds these words, at least two; of several, that of fewest words."""
    words = set(fold(text).split("_"))
    labels = {e: fold(e.phrase).split("_") for e in all_entries() if e.kind == "metric"}
    found = [entry for entry, label in labels.items() if words <= set(label)]
    return min(found, key=lambda e: len(labels[e]), default=None) if len(words) > 1 else None


def _bracketed(name: str) -> list[str]:
    """A PATH, parted at its brackets: parts with an odd place were inside them."""
    return name.replace("]", "[").split("[")


def _unknown(word: str, topics: Topics) -> UsageError:
    """The error for an unknown topic, with the nearest names and titles."""
    known = {entry.name: f"{entry.phrase} {' '.join(entry.aliases)}" for entry in all_entries()}
    for place in (place for places in topics.values() for place in places):
        if not place["address"].startswith("reference/"):
            known.setdefault(place["title"], "")
    near = nearest_names(ranked(word, known, LEAST))
    advice = f"nearest: {', '.join(near)}" if near else "see: actuator-opt docs"
    return UsageError(Diagnostic(f'no page about "{shown(word)}"', advice))


def lead(page: DocumentationPage) -> str:
    """Address of a file that leads a browser to a place on a page.

    Some desktops drop the anchor of a file's address, so a small file beside the pages passes it
    on.
    """
    if not page.anchor:
        return page.address
    home = next(folder for folder in page.file.parents if (folder / TOPICS).is_file())
    target = f"{page.file.relative_to(home).as_posix()}#{page.anchor}"
    text = (
        '<!DOCTYPE html><meta charset="utf-8"><title>Documentation</title>'
        f'<meta http-equiv="refresh" content="0; url={target}"><a href="{target}">Open</a>\n'
    )
    path = home / f"open-{hashlib.sha256(target.encode()).hexdigest()[:12]}.html"
    store.write_text(path, text)
    return path.as_uri()
