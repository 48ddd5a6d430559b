"""A fuzz of the command line: seeded changes of all it reads, and what holds whatever it reads.

Of every input it must hold: no traceback, an exit code that README names and never 70, no more than
`BOUND` seconds of processor time, and under ``--json`` one JSON object without NaN. Warnings count
as faults of the program. `tests/cli/test_fuzz.py` runs a few hundred inputs; more:

    python tests/fuzz.py --count 5000 --seed 1
    python tests/fuzz.py --seed 1 --only 1234 --debug    # one of them again, with its traceback
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from unittest import mock

HERE = Path(__file__).resolve().parent
sys.path[0:0] = [str(HERE), str(HERE / "cases")]

from cli_runner import BENCH, DESIGNS, Result, one_object, run  # noqa: E402

import actuator_opt as ao  # noqa: E402
from actuator_opt.api.reports import origin  # noqa: E402
from actuator_opt.cli import streams  # noqa: E402
from actuator_opt.design.writer import init_text  # noqa: E402
from actuator_opt.pages.report import outcome  # noqa: E402
from actuator_opt.rendering.attachments import embed  # noqa: E402

BOUND = 30.0
"""Seconds of processor time for any of these inputs: a choice, ten times what the slowest takes."""
CODES = (0, 1, 2, 3, 4)
"""Exit codes of README, but for an interrupt's."""

WORDS = [
    "", "~", "no", "{}", "[]", "[1, 2]", "{a: b}", "&x 1", "*x", "!!int 3", "!x y", "-1 mm", "0",
    "0 mm", "1e300 mm", "-1e300", "1e-300 mm", ".nan", ".inf", ".inf mm", "nan mm", "1e999 mm",
    "12:30", "017 mm", "25 mm # c", '"unclosed', "'", "|", ">-", "? a", "- a", ": b", "a: b",
    "25 mm mm", "25 µm", "²5 mm", "٢٥ mm", "1" * 200, "1" * 90 + " mm", "9" * 5000, "%", "@", "`",
    "\t25 mm", "worst", "50 %", "99 %", "t700_epoxy", "iso_vg_32", '"\\x1b[2J"', '"\\ud800"',
    '"\\U0001F600"', "x" * 300, "1 degF", "-400 degC", "100 degC", "-100 degC", "90 deg", "1 m",
    "20 m", "1500 bar", "20 m/s", "20 MN", "8", "steel_42crmo4", "nbr_70", "epoxy_structural",
    "guide_acetal", "thread", "tie_rods", "head_flange", "bond", "as_published", "isotropic", "b",
    "external", "pull", "chord", "ruess", "mass", "leakage", "line_velocity", "stiffness_min",
    "[90_2/+-45]s", "90/0", "+-25_0", "false", "film", "u_cup", "1e-12 mm", "1e12 mm", "-0.0 mm",
    "0.1 + 0.2 mm", "1,5 mm", "1_0 mm", "1e5", "--help", "\u202e25 mm", "25\u00a0mm", "10^400 mm",
]  # fmt: skip
"""Odd values in YAML, in ``--set`` and in ``--vary``."""
CELLS = ["", "nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "x", '"', ";", "1;2", "0", "-1",
         "1e999", "0x10", "1_000", "٣", "9" * 5000, "\x00", "--", "1,5", "5 mm"]  # fmt: skip
"""Odd cells of a record."""
PLAIN = [None, True, -1, 0, 1, 1.5, 1e308, -1e308, float("nan"), float("inf"), "", "x", "last",
         "\x1b[2J", "9" * 5000, [], {}, [[]], [None], {"a": 1}, {"$design": 7}, {"$number": "x"},
         {"$fraction": "x"}, {"$evaluation": -1}, 10**40, "../../x", "\ud800"]  # fmt: skip
"""Odd values in JSON."""
FACTORS = [0.0, 1e-9, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.01, 1.1, 1.5, 2.0, 4.0, 10.0, 1e3, 1e9]
VALUE = re.compile(r"^(\s*(?:- )?[\w.\[\]]+: )(\S.*?)(\s*(?:#.*)?\n)$")
NUMBER = re.compile(r"-?\d+(\.\d+)?")


@dataclass(frozen=True)
class Input:
    """What a command gets: its words, where ``@NAME`` is one of the files, and standard input."""

    kind: str
    words: tuple[str, ...]
    stdin: bytes = b""
    files: dict[str, bytes] = field(default_factory=dict)


class Overrun(BaseException):
    """The bound of processor time is reached."""


@contextmanager
def bounded(seconds: float) -> Iterator[None]:
    """Raise `Overrun` after some processor time, where the system can."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(*_: object) -> None:
        raise Overrun

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def answer(given: Input, folder: Path, *, extra: tuple[str, ...] = ()) -> Result:
    """What the command of an input says, its files in a folder."""
    for name, data in given.files.items():
        (folder / name).write_bytes(data)
    words = [str(folder / w[1:]) if w[:1] == "@" else w for w in given.words]
    environment = {"ACTUATOR_OPT_RUNS": str(folder / "runs")}
    before = Path.cwd()
    os.chdir(folder)
    try:
        with bounded(BOUND):
            return run(*words, *extra, stdin=given.stdin, environment=environment)
    finally:
        os.chdir(before)


def fault(given: Input, folder: Path) -> str:
    """What does not hold of an input; "" where all does."""
    try:
        result = answer(given, folder)
        if result.code not in CODES:
            return f"exit code {result.code}: {(result.out + result.err)[:500]}"
        if "Warning" in result.err:
            return f"a warning: {result.err[:500]}"
        if "--json" not in given.words:
            return "" if result.code < 2 or result.err.strip() else "refused without a word"
        found = one_object(result.out)
        if result.code > 1 and "errors" not in found:
            return "refused without errors"
        return _laws(given, result, found, folder) if given.kind == "design" else ""
    except Overrun:
        return f"more than {BOUND:g} s of processor time"
    except (AssertionError, ValueError) as error:
        return f"{type(error).__name__}: {str(error)[:500] or 'a traceback'}"


def _laws(given: Input, result: Result, found: dict, folder: Path) -> str:
    """What `check` and `evaluate` say of one design agrees."""
    checked = answer(Input("check", ("check", *given.words[1:]), given.stdin, given.files), folder)
    if checked.code not in (0, 3) or (checked.code == 3) != bool(checked.json["errors"]):
        return f"check: exit code {checked.code}"
    if result.code == 3:
        return "" if checked.code == 3 else f"check passes what is refused: {found['errors']}"
    if result.code == 4:
        return ""
    if (result.code == 0) != all(row["met"] for row in found["requirements"]):
        return "the exit code is not that of the requirements"
    wrong = [n for n, m in found["metrics"].items() if (m["value"] is None) != bool(m.get("why"))]
    return f"null without a reason: {wrong}" if wrong else ""


def changed_text(chance: random.Random, text: str) -> str:
    """A YAML text with some of its lines changed."""
    lines = text.splitlines(keepends=True)
    for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
        values = [k for k, line in enumerate(lines) if VALUE.match(line) and ">-" not in line]
        if not values:
            break
        k, other = chance.choice(values), chance.choice(values)
        before, value, after = VALUE.match(lines[k]).groups()
        way = chance.randrange(13)
        if way < 4:
            lines[k] = before + chance.choice(WORDS) + after
        elif way < 7:
            number = NUMBER.search(value)
            if number is not None:
                scaled = repr(float(number[0]) * chance.choice(FACTORS))
                lines[k] = before + value.replace(number[0], scaled, 1) + after
        elif way == 7:
            lines[k] = before + VALUE.match(lines[other])[2] + after
        elif way == 8:
            lines[k] = chance.choice(("", lines[k] * 2, "  " + lines[k], lines[k].lstrip()))
        elif way == 9:
            lines[k], lines[other] = lines[other], lines[k]
        elif way == 10:  # without one of its blocks
            first = chance.choice([i for i, line in enumerate(lines) if line[:1].isalpha()] or [k])
            rest = [i for i in range(first + 1, len(lines)) if lines[i][:1].isalpha()]
            del lines[first : rest[0] if rest else len(lines)]
        elif way == 11:
            lines[k] = lines[k][: len(lines[k]) // 2] + "\n"
        else:
            letters = "".join(lines)
            at = chance.randrange(len(letters))
            typed = "".join(chance.choice(" :-[]{}#'\"\\|>&*!%@`\t\n\x00é☃0a") for _ in range(3))
            letters = letters[:at] + typed + letters[at + chance.randrange(20) :]
            lines = letters.splitlines(keepends=True)
    return "".join(lines)


def changed_bytes(chance: random.Random, data: bytes) -> bytes:
    """Bytes flipped, cut, doubled and put in."""
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 5, 20))):
        at = chance.randrange(len(found) + 1)
        way = chance.randrange(5)
        if way < 2 and at < len(found):
            found[at] ^= 1 << chance.randrange(8)
        elif way == 2:
            found[at:at] = chance.randbytes(chance.choice((1, 4, 100)))
        elif way == 3:
            del found[at : at + chance.choice((1, 4, 100, 10**9))]
        else:
            found[at:at] = found[max(at - 50, 0) : at]
    return bytes(found)


def changed_json(chance: random.Random, data: object) -> object:
    """Plain data with one value somewhere in it replaced, dropped or put in twice."""
    data = json.loads(json.dumps(data))
    place, depth = data, chance.choice((0, 1, 1, 2, 2, 3, 4, 6))
    while isinstance(place, (dict, list)) and place:
        keys = list(place) if isinstance(place, dict) else range(len(place))
        key = chance.choice(keys)
        if depth == 0 or not isinstance(place[key], (dict, list)) or not place[key]:
            way = chance.randrange(5)
            if way == 0:
                del place[key]
            elif way == 1 and isinstance(place, list):
                place.append(place[key])
            else:
                place[key] = chance.choice(PLAIN)
            break
        place, depth = place[key], depth - 1
    return data


@cache
def texts() -> list[str]:
    """Designs whose seals ask for no oil film: a film takes seconds."""
    shipped = [path.read_text("utf-8") for path in sorted(DESIGNS.glob("*.yaml"))]
    return [t for t in (*shipped, init_text("start"), BENCH) if "friction: film" not in t]


@cache
def scenarios() -> list[str]:
    """Scenarios of a few milliseconds around a design beside them."""
    found = []
    for path in sorted((DESIGNS / "scenarios").glob("*.yaml")):
        text = path.read_text("utf-8").replace("../", f"{DESIGNS}/")
        found.append(re.sub(r"^duration: .*$", "duration: 20 ms", text, flags=re.MULTILINE))
    return found


@cache
def paths() -> list[str]:
    """PATHs of a design."""
    return [*ao.read(BENCH).subject().numbers, "barrel.layup", "name", "x", "cylinder..bore",
            "load_cases[9].force", "objective.minimise", "requirements.mass.max", "waivers.x",
            "variables.cylinder.bore.lower", "retention.type", "seals.rod.compound"]  # fmt: skip


@cache
def record() -> str:
    """The shipped record, thinned."""
    lines = (DESIGNS / "records" / "knee_bench.csv").read_text("utf-8").splitlines(keepends=True)
    return "".join([*lines[:2], *lines[2::8]])


@cache
def recorded() -> dict[str, bytes]:
    """The record of an optimisation and of a sweep, a store of a sweep, and the report's PDF."""
    bench = ao.read(BENCH)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        found = ao.optimise(bench, starts=1, prices=False)
        optimised = ao.record(found, actuator=bench, folder=folder)
        swept = ao.sweep(bench, ["cylinder.bore=21..23 mm:6"], store=folder / "s.db", workers=1)
        kept = ao.record_sweep(swept, actuator=bench, folder=folder, store=folder / "s.db")
        return {
            "optimise.run": optimised.path.read_bytes(),
            "sweep.run": kept.path.read_bytes(),
            "s.db": (folder / "s.db").read_bytes(),
        }


@cache
def carried() -> dict[str, object]:
    """What the PDF of a report says of how it was made."""
    bench = ao.read(BENCH)
    made = origin(bench.design, bench.source, command="actuator-opt evaluate bench.yaml").run()
    return {**made, "result": outcome(ao.evaluate(bench))}


BARE = (
    b"%PDF-1.4\n1 0 obj\n<</Type/Catalog>>\nendobj\n"
    b"trailer\n<</Size 2/Root 1 0 R>>\nstartxref\n0\n%%EOF\n"
)
"""The least PDF that files can be attached to."""


def pdf(run_: object, source: str) -> bytes:
    """A PDF that carries a design and how its report was made."""
    told = json.dumps(run_).encode()
    return embed(BARE, [("b.yaml", "application/yaml", source.encode("utf-8", "replace")),
                        ("run.json", "application/json", told)])  # fmt: skip


def _design(chance: random.Random) -> Input:
    text = changed_text(chance, chance.choice(texts()))
    data = text.encode("utf-8", "surrogatepass")
    return Input("design", ("evaluate", "-", "--json"), data)


def _shown(chance: random.Random) -> Input:
    text = changed_text(chance, chance.choice(texts()))
    return Input("shown", ("evaluate", "-"), text.encode("utf-8", "surrogatepass"))


def _scenario(chance: random.Random) -> Input:
    text = changed_text(chance, chance.choice(scenarios()))
    text = re.sub(r"^duration: .*$", "duration: 20 ms", text, flags=re.MULTILINE)
    words = chance.choice((("check", "@s.yaml"), ("check", "@s.yaml"), ("simulate", "@s.yaml")))
    data = text.encode("utf-8", "surrogatepass")
    return Input("scenario", (*words, "--json"), files={"s.yaml": data})


def _record(chance: random.Random) -> Input:
    rows = [line.split(",") for line in record().splitlines()]
    for _ in range(chance.choice((1, 1, 2, 5, 50))):
        way, row = chance.randrange(8), chance.choice(rows)
        if way < 3:
            row[chance.randrange(len(row))] = chance.choice(CELLS)
        elif way == 3:
            rows.insert(chance.randrange(len(rows)), list(row))
        elif way == 4:
            k, cell = chance.randrange(5), chance.choice(CELLS)
            rows = [[*r[:k], cell, *r[k + 1 :]] for r in rows]
        elif way == 5:
            del rows[chance.randrange(1, len(rows)) :]
        elif way == 6:
            rows[1][chance.randrange(len(rows[1]))] = chance.choice(
                ("t", "x [mm]", "p1", "", "[", "t [h]")
            )
        else:
            row.append(chance.choice(CELLS))
        if len(rows) < 2:
            break
    text = "\n".join(",".join(row) for row in rows).encode("utf-8", "replace")
    if chance.random() < 0.2:
        text = changed_bytes(chance, text)
    words = ("identify", "@r.csv", "--design", str(DESIGNS / "knee_bonded.yaml"), "--json")
    return Input("record", words, files={"r.csv": text})


def _run(chance: random.Random) -> Input:
    kind = chance.choice(("optimise", "sweep"))
    data = recorded()[f"{kind}.run"]
    if chance.random() < 0.8:
        head, body = map(json.loads, data.splitlines())
        if chance.random() < 0.4:
            head = changed_json(chance, head)
        else:
            body = changed_json(chance, body)
        data = "\n".join(json.dumps(part) for part in (head, body)).encode()
    else:
        data = changed_bytes(chance, data)
    verbs = [("runs", "show", "@a.run"), ("runs", "show", "@a.run", "--json"),
             ("compare", "@a.run", str(DESIGNS / "knee_bonded.yaml"), "--json")]  # fmt: skip
    if kind == "sweep":
        verbs.append(("explore", "@a.run", "--out", "@x.html", "--json"))
    return Input("run", chance.choice(verbs), files={"a.run": data})


def _store(chance: random.Random) -> Input:
    data = changed_bytes(chance, recorded()["s.db"])
    verbs = [
        ("explore", "@s.db", "--out", "@x.html", "--json"),
        ("sweep", "@b.yaml", "--vary", "cylinder.bore=21..23 mm:6", "--store", "@s.db", "--json",
         "--workers", "1"),
    ]  # fmt: skip
    return Input("store", chance.choice(verbs), files={"s.db": data, "b.yaml": BENCH.encode()})


def _pdf(chance: random.Random) -> Input:
    way = chance.randrange(4)
    told, source = carried(), BENCH
    if way < 2:
        told = changed_json(chance, told)
    elif way == 2:
        source = changed_text(chance, source)
    data = pdf(told, source)
    if way == 3:
        data = changed_bytes(chance, data)
    return Input("pdf", ("rerun", "@a.pdf", "--json"), files={"a.pdf": data})


def _set(chance: random.Random) -> Input:
    words = WORDS
    sets = []
    for _ in range(chance.choice((1, 1, 2, 3))):
        sets += ["--set", f"{chance.choice(paths())}={chance.choice(words)}"]
    return Input("set", ("evaluate", "-", "--json", *sets), BENCH.encode())


def _vary(chance: random.Random) -> Input:
    words = WORDS
    axes = []
    for _ in range(chance.choice((1, 1, 2))):
        path, ends = chance.choice(paths()), chance.sample(words, 2)
        count = chance.choice(("2", "3", "0", "-1", "x", "", "9" * 5000, "9" * 14, "1e3", " 3 "))
        form = chance.choice((f"{ends[0]}..{ends[1]}:{count}", f"{ends[0]}..{ends[1]}",
                              ",".join(ends), f"20..{chance.choice((21, 20, 0))} mm:{count}",
                              f"0.5..{chance.choice((0.7, 0, 1e9))}:{count}"))  # fmt: skip
        axes += ["--vary", f"{path}={form}"]
    how = chance.choice(((), ("--method", "sobol", "-n", "4"), ("--method", "lhs", "-n", "3"),
                         ("--reduce", "best:2"), ("--method", "lhs", "-n", "0")))  # fmt: skip
    words = ("sweep", "-", "--json", "--workers", "1", "--no-record", *axes, *how)
    return Input("vary", words, BENCH.encode())


def _line(chance: random.Random) -> Input:
    odd = [w for w in WORDS if w != "--help"]
    value, other = chance.choice(odd), chance.choice(odd)
    lines = [
        ("init", value, "--json"), ("init", "--from", value), ("init", "--out", "@" + "a" * 300),
        ("materials", "show", value, "--json"), ("materials", "compare", value, other, "--json"),
        ("materials", "list", "--kind", value), ("runs", "show", value, "--json"),
        ("runs", "list", "--design", value, "--command", other, "--json"),
        ("runs", "delete", value, "--json"), ("runs", "prune", "--keep", value),
        ("evaluate", value, "--json"), ("evaluate", "-", "--date", value, "--report", "--json"),
        ("evaluate", "-", "--seed", value), ("evaluate", "-", "--plugin", value, "--json"),
        ("uncertainty", "-", "-n", chance.choice(("20", value)), "--index-rows", "0", "--json",
         "--metric", other),
        ("uncertainty", "-", "-n", "20", "--index-rows", value, "--csv", f"@{other[:3]}/x.csv"),
        ("seal", "-", "--seal", chance.choice(("rod", value)), "--speed", other, "--json"),
        ("seal", "-", "--seal", "rod", "--pressure", value, "--speed", "0.1", "--json"),
        ("optimise", "-", "--algorithm", value, "--starts", "x"),
        ("optimise", "-", "--yield", value, "--starts", other, "--algorithm", "x", "--json"),
        ("pareto", "-", "--objective", value, "--objective", other, "-n", "2", "--json"),
        ("explore", value, "--study", other, "--json"), ("rerun", value, "--json"),
        ("compare", value, other, "--json"), ("export", "-", "--format", value, "--json"),
        ("simulate", value, "--json"), ("identify", value, "--design", other, "--json"),
        ("identify", "-", "--design", "@b.yaml", "--column", value, "--cutoff", other, "--json"),
        ("calibrate", "-", "--design", "@b.yaml", "--bootstrap", value, "--mass", other, "--json"),
        (value, other), ("--" + value, other), ("doctor", "--out", value or "x", "--json"),
        ("schema", value), ("check", value, other, "--json"), ("report", value, "--json"),
    ]  # fmt: skip
    return Input("line", chance.choice(lines), BENCH.encode(), {"b.yaml": BENCH.encode()})


KINDS: dict[str, tuple[Callable[[random.Random], Input], int]] = {
    "design": (_design, 30),
    "shown": (_shown, 8),
    "set": (_set, 14),
    "vary": (_vary, 10),
    "line": (_line, 14),
    "scenario": (_scenario, 8),
    "run": (_run, 6),
    "store": (_store, 4),
    "pdf": (_pdf, 5),
    "record": (_record, 1),
}
"""What makes an input of a kind, and its share."""


def made(seed: int, number: int, kinds: tuple[str, ...] = tuple(KINDS)) -> Input:
    """The input of a number: the same for the same seed, whatever came before."""
    chance = random.Random(f"{seed} {number}")
    kind = chance.choices(kinds, [KINDS[kind][1] for kind in kinds])[0]
    return KINDS[kind][0](chance)


REGRESSIONS = {
    "letters of a name": Input("line", ("init", "--out", "@" + "a" * 300)),
    "digits of a count": Input(
        "vary", ("sweep", "-", "--vary", f"cylinder.bore=20..21 mm:{'9' * 5000}"), BENCH.encode()
    ),
    "digits of a version": Input(
        "pdf",
        ("rerun", "@a.pdf", "--json"),
        files={
            "a.pdf": pdf(
                {
                    "actuator_opt": "9" * 5000,
                    "command": "actuator-opt evaluate b.yaml",
                    "source_name": "b.yaml",
                },
                BENCH,
            )
        },
    ),
}
"""Inputs that failed once, by what was wrong."""


def main() -> int:
    """Run inputs of a seed; how many failed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append", choices=KINDS, help="of this kind alone")
    parser.add_argument("--only", type=int, help="number of one input to run and show")
    parser.add_argument("--debug", action="store_true", help="show the traceback of a fault")
    asked = parser.parse_args()
    warnings.simplefilter("error")
    kinds = tuple(asked.kind or KINDS)
    numbers = (
        [asked.only] if asked.only is not None else range(asked.first, asked.first + asked.count)
    )
    failed: Counter[str] = Counter()
    began = time.process_time()
    slowest = (0.0, -1)
    unexpected = streams.unexpected

    def told(error: Exception) -> object:
        if asked.debug:
            traceback.print_exception(error, file=sys.__stderr__)
        return unexpected(error)

    with tempfile.TemporaryDirectory() as place, mock.patch.object(streams, "unexpected", told):
        for number in numbers:
            given = made(asked.seed, number, kinds)
            folder = Path(place) / str(number)
            folder.mkdir()
            start = time.process_time()
            reason = fault(given, folder)
            slowest = max(slowest, (time.process_time() - start, number))
            if reason or asked.only is not None:
                words = " ".join(word[:80] for word in given.words)
                print(f"{number} {given.kind}: {words[:200]}\n    {reason or 'holds'}", flush=True)
            if asked.only is not None:
                print(given.stdin.decode("utf-8", "replace")[:20_000])
            failed[given.kind] += bool(reason)
    took = time.process_time() - began
    print(
        f"{len(numbers)} inputs of seed {asked.seed}: {sum(failed.values())} failed; {took:.0f} s "
        f"of processor time, {slowest[0]:.1f} s the slowest (number {slowest[1]})"
    )
    return min(sum(failed.values()), 1)


if __name__ == "__main__":
    sys.exit(main())
