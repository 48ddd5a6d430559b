"""Build the documentation: ``python docs/build.py`` (or ``just docs``).

1. Generate the reference from the declarations that `explain` and `list` read.
2. Run the blocks marked `run` whose page, or the program, changed.
3. Build HTML with Sphinx; warnings are errors.
4. Check links, anchors, outside hosts, spelling of terms, and that the index leads to every page.
5. Pack the pages as ``docs.tar.xz`` for the wheel.

All results are in ``docs/_build``, which git ignores: ``html/index.html`` is the first page.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import shutil
import sys
import tarfile
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from extensions.book import Book

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
BUILD = HERE / "_build"
SOURCE, HTML, CACHE = BUILD / "source", BUILD / "html", BUILD / "runs"
PACKED = BUILD / "docs.tar.xz"
sys.path[0:0] = [str(ROOT), str(HERE)]
os.environ["PYTHONPATH"] = str(ROOT)
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")


def prepared() -> Book:
    """Write the sources of Sphinx; returns the book of generated pages."""
    from extensions import checks, runs
    from extensions.reference import reference_book

    book = reference_book()
    files = checks.written()
    texts = {name: checks.content(path) for name, path in files.items()}
    texts |= {f"{name}.md": text.encode() for name, text in book.pages.items()}
    twice = [name for name in files if name.removesuffix(".md") in book.pages]
    if twice:
        raise SystemExit(f"written by hand and generated: {', '.join(twice)}")
    if faults := checks.words():
        raise SystemExit("\n".join(faults))
    for name, data in texts.items():
        target = SOURCE / name
        if not target.is_file() or target.read_bytes() != data:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data)
    for path in sorted(SOURCE.rglob("*")):
        name = path.relative_to(SOURCE).as_posix()
        if path.is_file() and name not in texts and not name.startswith("_figures/"):
            path.unlink()
    for path in sorted(HTML.rglob("*.html")):
        name = path.relative_to(HTML).with_suffix(".md").as_posix()
        if name not in texts and path.name not in ("search.html", "genindex.html"):
            path.unlink()
    pages = {
        name.removesuffix(".md"): text.decode()
        for name, text in texts.items()
        if name.endswith(".md")
    }
    begin = perf_counter()
    try:
        folders = runs.execute(pages, CACHE)
    except runs.RunFault as fault:
        raise SystemExit(str(fault)) from None
    print(f"run blocks of {len(folders)} pages: {perf_counter() - begin:.0f} s")
    kept = {path.name for path in folders.values()}
    for path in (SOURCE / "_figures").glob("*"):
        if path.name not in kept:
            shutil.rmtree(path)
    data = {"labels": book.labels, "runs": {name: str(path) for name, path in folders.items()}}
    (BUILD / "prepared.json").write_text(json.dumps(data), encoding="utf-8")
    return book


def packed() -> None:
    """Pack the pages, the same bytes for the same pages."""
    with tarfile.open(PACKED, "w:xz", preset=9) as archive:
        for path in sorted(HTML.rglob("*")):
            if not path.is_file() or path.name in (".buildinfo", "objects.inv"):
                continue
            entry = tarfile.TarInfo(path.relative_to(HTML).as_posix())
            data = path.read_bytes()
            entry.size, entry.mode = len(data), 0o644
            archive.addfile(entry, io.BytesIO(data))


def main() -> int:
    """Build all; returns the exit code."""
    from extensions import checks
    from extensions.book import Incomplete
    from sphinx.cmd.build import build_main

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--clean", action="store_true", help="forget all earlier results")
    options = parser.parse_args()
    if options.clean and BUILD.is_dir():
        shutil.rmtree(BUILD)
    begin = perf_counter()
    BUILD.mkdir(exist_ok=True)
    try:
        book = prepared()
    except Incomplete as fault:
        print(fault, file=sys.stderr)
        return 1
    print(f"prepared: {perf_counter() - begin:.0f} s")
    arguments = ["-b", "html", "-W", "--keep-going", "-q", "-j", "2", "-c", str(HERE),
                 "-d", str(BUILD / "doctrees"), str(SOURCE), str(HTML)]  # fmt: skip
    if code := build_main(arguments):
        return code
    for path in checks.unused_images(HTML):
        path.unlink()
    faults = checks.html(HTML)
    if faults:
        print("\n".join(faults), file=sys.stderr)
        return 1
    topics = checks.topics(HTML, book)
    (HTML / "topics.json").write_text(json.dumps(topics, ensure_ascii=False), encoding="utf-8")
    packed()
    pages = list(HTML.rglob("*.html"))
    size = sum(path.stat().st_size for path in HTML.rglob("*") if path.is_file())
    print(
        f"{len(pages)} pages, {size / 1e6:.1f} MB, packed {PACKED.stat().st_size / 1e6:.2f} MB, "
        f"{perf_counter() - begin:.0f} s: {HTML / 'index.html'}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
