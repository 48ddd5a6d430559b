"""Compare what every command prints and writes with the frozen outputs in ``tests/frozen/``.

    just frozen                     compare all cases; exit 1 where one has changed
    just frozen evaluate pareto     only cases whose names contain one of these words
    just frozen --update            freeze what the program gives now
    just frozen --keep FOLDER       also write every text in full and every file, for ``diff -r``
    just frozen --exact             changes in the last digits fail too

A case runs in this process through the command line's ``main``. Verbs are called once a step: the
looks (widths, signs, colour) print the same results again (`Replay`). Page data are what the
reports hand to Typst.

Left out, as they change from run to run or between machines: the version (set to `VERSION`),
seconds, times and ids of runs, versions of libraries, the case's folder, all but the names of
``doctor``, contents of databases. Drawings are a hash with their texts; the input of a page is
left out; long CSV and curves are thinned; objects of the same keys stand as tables. The line
``sha`` is a hash of all the JSON. Numbers are compared exactly first, then within the tolerance
of their case: those have "moved in the last digits" and pass. Bytes of files are compared where
the tools that wrote them are those of `TOOLS`.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import hashlib
import io
import itertools
import json
import multiprocessing
import os
import platform
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from importlib import metadata
from itertools import zip_longest
from pathlib import Path
from typing import Any
from unittest import mock

HERE = Path(__file__).resolve().parent
sys.path[0:0] = [str(HERE.parent), str(HERE), str(HERE / "cases")]

from frozen_cases import ROOT, SHIPPED, Case, Step, cases  # noqa: E402

FROZEN = ROOT / "tests" / "frozen"
TOOLS = FROZEN / "tools.json"
VERSION = "0.0.0"
"""Of the program, in frozen outputs."""
_FEW = (
    (100, "unicode", "plain"),
    (40, "ascii", "colour"),
    (80, "unicode", "colour"),
    (160, "ascii", "plain"),
)
_ALL = [(x, y, z) for x in (40, 80, 100, 160) for y in ("unicode", "ascii") for z in
        ("plain", "colour")]  # fmt: skip
LOOKS = [*_FEW, *(look for look in _ALL if look not in _FEW)]
"""How text may look; the first is frozen in full, the others by hash."""
BRIEF = ("compare", "evaluate/options", "optimise", "pareto", "rerun", "runs", "schema",
         "sensitivity", "uncertainty", "materials/list")  # fmt: skip
"""Cases in which long texts are cut: other cases have them in full."""
SOME = 10
"""Parts that stay of a list of more than twice as many: of curves, and of all in brief cases."""
LONGEST = 300
"""Letters of a line of data."""
LONG_TEXT = 40
"""Letters of a text beyond which it is cut to half of that, and a hash."""
WRITERS = {
    ".pdf": ("typst", "matplotlib", "numpy"),
    ".png": ("typst", "matplotlib", "numpy", "pillow"),
    ".svg": ("matplotlib", "numpy"),
    ".dxf": ("ezdxf",),
    ".xlsx": ("openpyxl", "python", "matplotlib", "numpy", "pillow"),
    ".parquet": ("pyarrow",),
}
"""Tools whose versions decide the bytes of a file, beside the machine."""
SHOWN = 8
"""Differences of a case that are printed."""
LONG_CSV, CSV_ROWS = 6_000, 16
"""Bytes beyond which a CSV is thinned, and the rows that stay."""


# --- running -----------------------------------------------------------------------------------


@dataclass
class Replay:
    """Verbs as the commands see them, which give their first results again."""

    results: dict[tuple[str, int], tuple[bool, Any]] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)

    def again(self) -> None:
        """Begin another look."""
        self.counts.clear()

    def wrapped(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, whose n-th call gives what the n-th call gave before."""

        def call(*arguments: Any, **options: Any) -> Any:
            number = self.counts[name] = self.counts.get(name, 0) + 1
            if (name, number) not in self.results:
                try:
                    found = (True, function(*arguments, **options))
                except Exception as error:
                    found = (False, error)
                if hasattr(found[1], "__enter__") or hasattr(found[1], "__next__"):
                    return found[1]  # a context is used once
                self.results[name, number] = found
            good, value = self.results[name, number]
            if not good:
                raise value
            return value

        return call

    @contextlib.contextmanager
    def patched(self) -> Iterator[None]:
        """Commands call ours: the verbs that ``actuator_opt.api`` exports."""
        from actuator_opt import api as verbs

        with contextlib.ExitStack() as patches:
            for name in verbs.__all__:
                function = getattr(verbs, name)
                if callable(function) and not isinstance(function, type):
                    ours = self.wrapped(name, function)
                    patches.enter_context(mock.patch.object(verbs, name, ours))
            yield


class Screen(io.TextIOWrapper):
    """Standard output of a chosen encoding, a terminal or not."""

    def __init__(self, *, encoding: str, terminal: bool) -> None:
        super().__init__(io.BytesIO(), encoding=encoding, write_through=True)
        self.terminal = terminal

    def isatty(self) -> bool:
        """Whether it can show colours."""
        return self.terminal

    @property
    def written(self) -> str:
        """All that was written."""
        self.flush()
        return self.buffer.getvalue().decode(self.encoding)  # type: ignore[attr-defined]


def called(words: Iterable[str], stdin: str, look: tuple[int, str, str]) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command line."""
    from actuator_opt import cli

    width, signs, colour = look
    encoding = "utf-8" if signs == "unicode" else "ascii"
    out = Screen(encoding=encoding, terminal=colour == "colour")
    err = Screen(encoding="utf-8", terminal=False)
    given = io.TextIOWrapper(io.BytesIO(stdin.encode()), encoding="utf-8")
    code: Any = 0
    with (
        mock.patch.object(sys, "argv", ["actuator-opt", *words]),
        mock.patch.object(sys, "stdin", given),
        mock.patch.object(sys, "stdout", out),
        mock.patch.object(sys, "stderr", err),
        mock.patch.dict(os.environ, {"COLUMNS": str(width), "TERM": "xterm"}),
    ):
        try:
            cli.main()
        except SystemExit as leaving:
            code = leaving.code or 0
    return int(code), out.written, err.written


PAGES: list[Any] = []
"""Data of the pages that a command has handed to Typst."""


def _prepare() -> None:
    """Make a process ready for cases: environment, clock, version, and Typst as we watch it.

    The clock goes on by a microsecond a look: no search ends by time, no text tells seconds.
    """
    for name in ("NO_COLOR", "SOURCE_DATE_EPOCH", "ACTUATOR_OPT_NO_RECORD", "ACTUATOR_OPT_DEBUG"):
        os.environ.pop(name, None)
    os.environ["ACTUATOR_OPT_RUNS"] = "runs"
    os.environ["ACTUATOR_OPT_PROGRAMS"] = "0"
    ticks = itertools.count()
    time.perf_counter = lambda: 1e-6 * next(ticks)
    import actuator_opt.version

    actuator_opt.version.VERSION = VERSION
    import typst

    compiler = typst.Compiler

    def watched(*arguments: Any, **options: Any) -> Any:
        PAGES.append(json.loads(options.get("sys_inputs", {}).get("data", "null")))
        return compiler(*arguments, **options)

    typst.Compiler = watched  # type: ignore[assignment, misc]


def run_case(case: Case, keep: str | None) -> tuple[str, str, float]:
    """Name, frozen text and seconds of a case."""
    begun = time.monotonic()
    home = Path.cwd()
    with tempfile.TemporaryDirectory(prefix="frozen-") as folder:
        place = Path(folder).resolve()
        shutil.copytree(SHIPPED, place / "designs", ignore=shutil.ignore_patterns("__pycache__"))
        (place / "out").mkdir()
        os.chdir(place)
        try:
            parts = [f"# {case.name}\n"]
            before, seen = _files(place), dict[str, str]()
            for number, step in enumerate(case.steps, 1):
                full = None if keep is None else Path(keep) / case.name / str(number)
                book = _Book(seen, number, case.name.startswith(BRIEF))
                parts.append(_stepped(step, place, before, book, full))
        finally:
            os.chdir(home)
    return case.name, "\n".join(parts), time.monotonic() - begun


def _stepped(
    step: Step, place: Path, before: dict[str, float], book: _Book, full: Path | None
) -> str:
    """Everything a step gives, as frozen; `before` becomes its files afterwards."""
    PAGES.clear()
    replay = Replay()
    neat = _normaliser(place)
    shown = " ".join(f"'{word}'" if " " in word else word for word in step.words)
    parts = [f"$ actuator-opt {shown}"]
    with replay.patched():
        if step.json:
            code, out, err = called([*step.words, "--json"], step.stdin, LOOKS[0])
            parts.append(f"--- with --json: exit {code}")
            parts += [neat(err)] if err else []
            parts.append(_json_text(out, neat, step, book))
            if full is not None:
                _written(full / "output.json", neat(out))
        hashes = []
        for look in LOOKS[: step.looks]:
            replay.again()
            code, out, err = called(step.words, step.stdin, look)
            text = neat(out)
            if look == LOOKS[0]:
                parts.append(f"--- exit {code}")
                parts += [neat(err)] if err else []
                parts += ["--- text", text] if text else []
            elif text:
                name = "{} {} {}".format(*look)
                hashes.append(f"{name}: {_hash(text.encode())[:16]}")
                if full is not None:
                    _written(full / f"{name.replace(' ', '_')}.txt", text)
        parts += ["--- other looks", *hashes] if hashes else []
    for file, changed in _files(place).items():
        if before.get(file) != changed:
            parts.append(_file_text(place / file, file, neat, book))
            if full is not None:
                (full / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(place / file, full / file)
    before.clear()
    before.update(_files(place))
    for number, page in enumerate(PAGES, 1):
        parts += ["--- page", book.told(_page(page, neat), f"page {number}")]
    return "\n".join(part.rstrip("\n") for part in parts) + "\n"


def _written(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _files(place: Path) -> dict[str, float]:
    """Files below a folder with their times, but the shipped ones."""
    return {
        path.relative_to(place).as_posix(): path.stat().st_mtime_ns
        for path in sorted(place.rglob("*"))
        if path.is_file() and path.relative_to(place).parts[0] != "designs"
    }


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


# --- what is left out --------------------------------------------------------------------------

RUN_ID = "20000101-000000-000000"
"""Instead of the id of a run; its SVG seeds the names of its parts with the id."""
_RULES = (
    (re.compile(r"(?<!\d)20\d{6}-\d{6}-[0-9a-f]{6}(?![0-9a-f])"), RUN_ID),
    (re.compile(r"(?<!\d)20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ"), "2000-01-01T00:00:00Z"),
    (re.compile(r"^versions   .*(?:\n {11}.*)*", re.MULTILINE), "versions   ..."),
    (re.compile(r"\(\d[\d.]* (?:s|min|h)(?:, [^)]*?/s)?\)"), "(... s)"),
    (re.compile(r"(?m)^(.*\bseconds?[:\s]+)\d+\.\d+$"), r"\1..."),
)


def _normaliser(place: Path) -> Callable[[str], str]:
    """Removes from text what changes from run to run."""

    def neat(text: str) -> str:
        text = text.replace(str(place), "FOLDER").replace(str(ROOT), "ROOT")
        for pattern, word in _RULES:
            text = pattern.sub(word, text)
        return text

    return neat


def _plain(data: Any, neat: Callable[[str], str]) -> Any:
    """Data without times, and texts without what changes."""
    if isinstance(data, str):
        return neat(data)
    if isinstance(data, list):
        return [_plain(one, neat) for one in data]
    if isinstance(data, dict):
        found = {key: _plain(value, neat) for key, value in data.items()}
        if isinstance(found.get("seconds"), float | int):
            found["seconds"] = 0
        if isinstance(found.get("versions"), dict):
            found["versions"] = sorted(found["versions"])
        return found
    return data


def _json_text(out: str, neat: Callable[[str], str], step: Step, book: _Book) -> str:
    """The JSON that a command printed, with a hash of all of it."""
    try:
        data = _plain(json.loads(out), neat)
    except ValueError:
        return neat(out)
    if step.words[0] == "doctor":
        found = data.get("findings", [])
        data = {
            "findings": [f"{one.get('group')}: {one.get('name')}" for one in found],
            "keys": sorted(data),
        }
    for file in data.get("files", []) if isinstance(data, dict) else []:
        file.pop("sha256", None)  # frozen with the file
    whole = _hash(json.dumps(data).encode())[:16]
    return f"sha {whole}\n{book.told(data, 'json')}"


def _page(data: Any, neat: Callable[[str], str]) -> Any:
    """Data of a page: drawings by hash and texts, without the input that is listed."""
    if isinstance(data, dict):
        if data.keys() == {"width", "height", "marks"}:
            return _drawing(data)
        if data.get("kind") == "listing" and "lines" in data:
            data = data | {"lines": len(data["lines"])}
        if isinstance(data.get("source"), str):
            data = data | {"source": len(data["source"])}
        if isinstance(data.get("run"), str) and data["run"].startswith("{"):
            data = data | {"run": _plain(json.loads(data["run"]), neat)}
        return {key: _page(value, neat) for key, value in data.items()}
    if isinstance(data, list):
        return [_page(one, neat) for one in data]
    return neat(data) if isinstance(data, str) else data


def _drawing(data: dict[str, Any]) -> dict[str, Any]:
    """A drawing by its hash, the count of its marks, and its texts."""
    marks = data["marks"]
    return {
        "width": data["width"],
        "height": data["height"],
        "marks": len(marks),
        "sha": _hash(json.dumps(marks, sort_keys=True).encode())[:16],
        "texts": " | ".join(str(mark["text"]) for mark in marks if "text" in mark),
    }


@dataclass(frozen=True)
class _Book:
    """The data of a step as text, in which each long part stands once."""

    seen: dict[str, str]
    """Where parts stood first in this case."""
    step: int
    brief: bool
    """Whether long texts are cut."""

    def told(self, data: Any, name: str) -> str:
        """Data as text."""
        return dumped(self._tabled(self._folded(data, f"{self.step}: {name}")))

    def _folded(self, data: Any, path: str) -> Any:
        """Data in which a long part that stood before names its place only."""
        if isinstance(data, str) and self.brief and len(data) > LONG_TEXT:
            return f"{data[: LONG_TEXT // 2]}... {_hash(data.encode())[:12]}"
        if not isinstance(data, dict | list):
            return data
        text = json.dumps(data)
        if len(text) > 120:
            first = self.seen.setdefault(text, path)
            if first != path:
                return f"as {first}"
        if isinstance(data, dict):
            return {key: self._folded(value, f"{path}/{key}") for key, value in data.items()}
        return [self._folded(value, f"{path}/{index}") for index, value in enumerate(data)]

    def _tabled(self, data: Any) -> Any:
        """Data in which objects of the same keys stand as rows below these keys."""
        if isinstance(data, dict):
            if _alike(list(data.values())):
                keys = _keys(list(data.values()))
                rows = {name: self._row(one, keys) for name, one in data.items()}
                return {"(columns)": keys} | rows
            return {key: self._tabled(value) for key, value in data.items()}
        if isinstance(data, list):
            if _alike(data):
                keys = _keys(data)
                rows = [self._row(one, keys) for one in data]
                return [{"(columns)": keys}, *(_some(rows) if self.brief else rows)]
            curve = all(isinstance(one, int | float) for one in data)
            return [self._tabled(one) for one in (_some(data) if self.brief or curve else data)]
        return data

    def _row(self, data: Any, keys: list[str]) -> Any:
        if not isinstance(data, dict):
            return data
        more = {key: self._tabled(value) for key, value in data.items() if key not in keys}
        return [*(self._tabled(data[key]) for key in keys), *([more] if more else [])]


def _some(data: list[Any]) -> list[Any]:
    """A long list thinned to some of its parts, after their count."""
    if len(data) <= 2 * SOME:
        return data
    pace = -(-len(data) // SOME)
    return [f"({len(data)}, every {pace}.)", *data[::pace]]


def _keys(data: list[Any]) -> list[str]:
    """Keys that all objects have."""
    objects = [one for one in data if isinstance(one, dict)]
    return [key for key in objects[0] if all(key in one for one in objects)]


def _alike(data: list[Any]) -> bool:
    """Whether three parts or more are objects of some keys in common, but for folded ones."""
    objects = [one for one in data if isinstance(one, dict)]
    folded = [one for one in data if isinstance(one, str) and one.startswith("as ")]
    return len(objects) >= 3 and len(objects) + len(folded) == len(data) and len(_keys(data)) >= 2


def dumped(data: Any, indent: str = "") -> str:
    """JSON in which whatever fits into a line stands in one.

    >>> dumped({"a": [1, 2]})
    '{"a": [1, 2]}'
    """
    line = json.dumps(data, ensure_ascii=False)
    if len(indent) + len(line) <= LONGEST or not isinstance(data, dict | list):
        return line
    deeper = indent + " "
    if isinstance(data, dict):
        parts = [
            f"{deeper}{json.dumps(key, ensure_ascii=False)}: {dumped(value, deeper)}"
            for key, value in data.items()
        ]
        return "{\n" + ",\n".join(parts) + f"\n{indent}}}"
    return "[\n" + ",\n".join(deeper + dumped(one, deeper) for one in data) + f"\n{indent}]"


_DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


def _file_text(path: Path, name: str, neat: Callable[[str], str], book: _Book) -> str:
    """A written file: its hash, and what can be read in it."""
    name, content = neat(name), path.read_bytes()
    if path.suffix in (".run", ".db") or (path.suffix == ".svg" and RUN_ID in name):
        return f"--- file {name}"
    text = ""
    if path.suffix in (".csv", ".yaml", ".html", ".svg"):
        text = neat(content.decode("utf-8"))
        content = text.encode()
    head = f"--- file {name}: {_hash(content)}"
    if path.suffix == ".csv":
        return f"{head}\n{_thinned(text) if len(text) > LONG_CSV else text}"
    if path.suffix == ".html":
        data = _DATA.search(text)
        assert data is not None, name
        return f"{head}\n{book.told(_plain(json.loads(data[1]), neat), name)}"
    return f"{head}\n{text}" if path.suffix == ".yaml" else head


def _thinned(text: str) -> str:
    """Comments, header and some rows of a long CSV."""
    lines = text.splitlines()
    first = next(i for i, line in enumerate(lines) if not line.startswith("#")) + 1
    rows = lines[first:]
    pace = max(1, (len(rows) - 1) // (CSV_ROWS - 1))
    kept = rows[::pace] + ([] if (len(rows) - 1) % pace == 0 else rows[-1:])
    return "\n".join([*lines[:first], f"({len(rows)} rows, every {pace}.)", *kept])


# --- comparing ---------------------------------------------------------------------------------

_HEX = re.compile(r"\b(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])[0-9a-f]{12,64}\b|\b[0-9a-f]{64}\b")
_NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_FILE = re.compile(r"--- file (\S+?(\.\w+)): [0-9a-f]{64}$")


@dataclass(frozen=True)
class Difference:
    """A line that is not as frozen. `kind`: changed, digits, bytes, or skipped."""

    kind: str
    line: int
    old: str
    new: str


def _close(old: str, new: str, tolerance: float) -> bool:
    """Whether two numbers differ in the last digits only."""
    a, b = (float(text.replace("−", "-")) for text in (old, new))
    least = 1e-9 if tolerance > 1e-8 else 1e-15
    return abs(a - b) <= max(tolerance * max(abs(a), abs(b)), least)


def _line(number: int, old: str, new: str, tolerance: float, other: set[str]) -> Difference:
    """How two lines differ; `other` are suffixes of files written by tools of other versions."""
    if _HEX.sub("#", old) == _HEX.sub("#", new):
        file = _FILE.match(old)
        skipped = file is not None and file[2] in other
        return Difference("skipped" if skipped else "bytes", number, old, new)
    a, b = (_NUMBER.findall(_HEX.sub("#", text)) for text in (old, new))
    same = _NUMBER.sub("0", _HEX.sub("#", old)) == _NUMBER.sub("0", _HEX.sub("#", new))
    if same and all(_close(x, y, tolerance) for x, y in zip(a, b, strict=True)):
        return Difference("digits", number, old, new)
    return Difference("changed", number, old, new)


def compared(old: str, new: str, tolerance: float, other: set[str]) -> list[Difference]:
    r"""Differences of a case, by line of its frozen file.

    Hashes that differ are of no weight where numbers moved in the last digits, and nothing else.

    >>> compared("a 1.0", "a 1.0000000000001", 1e-9, set())[0].kind
    'digits'
    >>> [x.kind for x in compared("a 1.0\nb", "a 2.0\nb", 1e-9, set())]
    ['changed']
    """
    if old == new:
        return []
    a, b = old.splitlines(), new.splitlines()
    found: list[Difference] = []
    if len(a) == len(b):
        blocks = [("replace", 0, len(a), 0, len(b))]
    else:
        blocks = difflib.SequenceMatcher(None, a, b, autojunk=False).get_opcodes()  # type: ignore[assignment]
    for kind, i, j, k, m in blocks:
        if kind == "equal":
            continue
        for number, (x, y) in enumerate(zip_longest(a[i:j], b[k:m]), i + 1):
            if x is None or y is None:
                x, y = x or "(no line)", y or "(no line)"
                found.append(Difference("changed", min(number, j + 1), x, y))
            elif x != y:
                found.append(_line(number, x, y, tolerance, other))
    kinds = {one.kind for one in found}
    if "digits" in kinds and "changed" not in kinds:
        found = [
            Difference("digits", x.line, x.old, x.new) if x.kind == "bytes" else x for x in found
        ]
    return found


def tools() -> dict[str, str]:
    """What decides the bytes of files: versions of the tools, and the machine."""
    found = {
        "machine": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }
    for name in sorted({tool for names in WRITERS.values() for tool in names} - {"python"}):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "none"
    return found


def unlike(stored: dict[str, str]) -> tuple[set[str], list[str]]:
    """Suffixes whose bytes are not to be compared here, and why."""
    here = tools()
    moved = {name for name in here if stored.get(name) != here[name]}
    other = {suffix for suffix, names in WRITERS.items() if moved.intersection({*names, "machine"})}
    return other, [f"{x} {here[x]}, frozen with {stored.get(x, 'none')}" for x in sorted(moved)]


def _short(text: str, beside: str) -> str:
    """A line to print, around the place where it leaves the other."""
    at = next((i for i, (x, y) in enumerate(zip(text, beside, strict=False)) if x != y), 0)
    start = max(0, at - 60)
    head, tail = "..." if start else "", "..." if len(text) > start + 140 else ""
    return f"{head}{text[start : start + 140].strip()}{tail}"


def _told(path: Path, found: list[Difference]) -> str:
    """Some of the differences of a case, to be read."""
    weights = ("changed", "bytes", "skipped", "digits")
    lines = []
    for one in sorted(found, key=lambda x: (weights.index(x.kind), x.line))[:SHOWN]:
        lines.append(f"{path.relative_to(ROOT)}:{one.line}: {one.kind}")
        lines.append(f"  frozen: {_short(one.old, one.new)}")
        lines.append(f"  now:    {_short(one.new, one.old)}")
    if len(found) > SHOWN:
        lines.append(f"  and {len(found) - SHOWN} more lines")
    return "\n".join(lines)


# --- command line ------------------------------------------------------------------------------


def _results(asked: list[Case], keep: str | None, processes: int) -> Iterator[tuple[str, str]]:
    """Name and text of every case, as they end."""
    os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
    context = multiprocessing.get_context("spawn")
    longest = sorted(asked, key=lambda case: -case.seconds)
    with ProcessPoolExecutor(processes, context, initializer=_prepare) as pool:
        waiting = {pool.submit(run_case, case, keep): case for case in longest}
        for done in as_completed(waiting):
            name, text, seconds = done.result()
            if os.environ.get("FROZEN_TIMES"):
                print(f"{seconds:6.1f} s  {name}", file=sys.stderr)
            yield name, text


def _updated(asked: list[Case], whole: bool, options: argparse.Namespace) -> int:
    """Freeze; cases that no longer are lose their file."""
    changed = 0
    paths = {FROZEN / f"{case.name}.txt" for case in cases()}
    for name, text in _results(asked, options.keep, options.processes):
        path = FROZEN / f"{name}.txt"
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            changed += 1
            _written(path, text)
            print(f"frozen: {path.relative_to(ROOT)}")
    if whole:
        for path in set(FROZEN.rglob("*.txt")) - paths:
            path.unlink()
            print(f"removed: {path.relative_to(ROOT)}")
        _written(TOOLS, json.dumps(tools(), indent=1) + "\n")
    print(f"{len(asked)} cases, {changed} written")
    return 0


def _checked(asked: list[Case], options: argparse.Namespace) -> int:
    """Compare; the exit code."""
    other, why = unlike(json.loads(TOOLS.read_text(encoding="utf-8")))
    if why:
        print(f"not compared: bytes of {', '.join(sorted(other)) or 'no file'} ({'; '.join(why)})")
    tolerances = {case.name: case.tolerance for case in asked}
    bad, moved, bytes_only = [], [], {}
    for name, text in _results(asked, options.keep, options.processes):
        path = FROZEN / f"{name}.txt"
        if not path.is_file():
            print(f"{path.relative_to(ROOT)}: not there; run `just frozen --update {name}`")
            bad.append(name)
            continue
        old = path.read_text(encoding="utf-8")
        found = compared(old, text, tolerances[name], other)
        kinds = {one.kind for one in found} - {"skipped"}
        if kinds == {"bytes"}:
            bytes_only[name] = _told(path, found)
        elif "changed" in kinds:
            print(_told(path, found), flush=True)
            bad.append(name)
        elif "digits" in kinds:
            moved.append(name)
            if options.exact:
                print(_told(path, found), flush=True)
    designs = {name.partition("/")[2] for name in moved}
    for name, told in bytes_only.items():  # files of a design whose numbers moved
        follows = name.partition("/")[2] in designs
        (moved if follows else bad).append(name)
        if options.exact or not follows:
            print(told)
    if moved:
        print(f"moved in the last digits: {', '.join(sorted(moved))}")
    print(f"{len(asked)} cases: {len(asked) - len(bad) - len(moved)} equal, {len(moved)} moved in "
          f"the last digits, {len(bad)} changed")  # fmt: skip
    if bad:
        print(f"changed: {' '.join(sorted(bad))}")
    return 1 if bad or (moved and options.exact) else 0


def main() -> int:
    """Read the arguments, run, compare or freeze."""
    parser = argparse.ArgumentParser(
        description="Compare the outputs of every command with tests/frozen."
    )
    parser.add_argument("words", nargs="*", help="only cases whose names contain one of these")
    parser.add_argument("--update", action="store_true", help="freeze what the program gives now")
    parser.add_argument("--exact", action="store_true", help="changes in the last digits fail too")
    parser.add_argument("--keep", metavar="FOLDER", help="write every text and file here too")
    parser.add_argument("--processes", type=int, default=2, help="at a time (default: 2)")
    options = parser.parse_args()
    if options.keep is not None:
        options.keep = str(Path(options.keep).resolve())
    every = cases()
    asked = [x for x in every if not options.words or any(w in x.name for w in options.words)]
    if not asked:
        parser.error(f"no case has a name with {' or '.join(options.words)}")
    if options.update:
        return _updated(asked, len(asked) == len(every), options)
    return _checked(asked, options)


if __name__ == "__main__":
    sys.exit(main())
