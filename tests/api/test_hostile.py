"""Files from elsewhere, and folders that others share: nothing runs, nothing is diverted."""

from __future__ import annotations

import contextlib
import json
import os
import random
import sqlite3
import stat
import time
import zlib
from pathlib import Path

import pytest
from cli_runner import BENCH, DESIGNS, run
from test_rerun import FACTS, _pdf

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.base import files as store, runs as run_store
from actuator_opt.base.errors import Diagnostic, InputError, escaped
from actuator_opt.cli import streams
from actuator_opt.rendering.console import Console

SMALL = BENCH.replace("  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n", "")
STEEL = DESIGNS / "steel_baseline.yaml"
BOMB = b"here 400 MB of zeros, compressed"
ESC = "\x1b[2J\x1b]0;owned\x07\x9b1m\u202eevil\x1b[32mMET\x1b[0m"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Records of an optimisation and of a sweep in a folder, with the design they are of."""
    place = tmp_path_factory.mktemp("hostile")
    (place / "small.yaml").write_text(SMALL)
    where = {"ACTUATOR_OPT_RUNS": str(place / "runs")}
    design = place / "small.yaml"
    assert run("optimise", design, "--quiet", environment=where).code == 0
    more = ["--vary", "cylinder.bore=21..27 mm:4", "--store", place / "rows.db", "--quiet"]
    assert run("sweep", design, *more, environment=where).code == 1  # none meets everything
    return place


def records(place):
    """The records by their command."""
    return {ao.read_run(path).head["kind"]: path for path in (place / "runs").iterdir()}


def forged(path, change, source):
    """A record that a stranger changed, checksums and all."""
    head, body = run_store.read(source)
    change(head, body)
    head.pop("record")
    return run_store.write(path, "20260101-000000", head, body)


# Programs


def test_no_record_runs_a_program(place, tmp_path, monkeypatch):
    """A record that names a plugin and its true hash: whoever reads it, the plugin stays a file."""
    ran = tmp_path / "ran"
    plugin = tmp_path / "evil.py"
    plugin.write_text(
        f"import pathlib; pathlib.Path({str(ran)!r}).touch()\nimport actuator_opt as ao\n"
        "@ao.metric('slenderness')\ndef own(v):\n    return v['cylinder.bore']\n"
    )
    from actuator_opt.api.recorded_runs import sha256

    files = [{"file": str(plugin), "sha256": sha256(str(plugin))}]

    def named(head, body):
        body["input"]["plugins"] = files

    for kind, source in records(place).items():
        runs = tmp_path / kind
        made = forged(runs, named, source)
        monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(runs))
        for words in (
            ["report", made], ["compare", STEEL, made], ["explore", made], ["runs", "show", made],
            ["report", made.stem], ["compare", STEEL, "last"], ["explore", made.stem],
            ["runs", "show", "last"],
        ):  # fmt: skip
            out = [] if words[0] == "runs" else ["--out", tmp_path / "out"]
            assert run(*words, *out).code in (0, 3), words
        for act in (ao.restore, ao.report_run, ao.explore, lambda p: ao.compare(STEEL, p)):
            with pytest.raises(InputError):
                act(made)
        assert not ran.exists()
        told = run("report", made, "--out", tmp_path / "out", "--json").errors[0]
        assert str(plugin) in told["message"]
        assert told["remedy"] == "name it with --plugin to run it"
    assert run("report", made, "--plugin", plugin, "--out", tmp_path / "out").code in (0, 3)
    assert ran.exists()  # named in this very call


# Writing


def permissions(path):
    """Who may do what with a file."""
    return stat.S_IMODE(path.stat().st_mode)


def test_nothing_is_written_through_a_link_that_lies_in_wait(tmp_path, monkeypatch):
    """Whatever name a writer takes aside, a link of that name is neither followed nor taken."""
    victim = tmp_path / "victim"
    victim.write_text("precious")
    folder = tmp_path / "shared"
    folder.mkdir()
    for name in ("a.txt", "b.pdf"):
        (folder / f".{name}.{os.getpid()}.part").symlink_to(victim)
    store.write_text(folder / "a.txt", "new")
    store.write_all(folder, {"b.pdf": b"new"})
    run_store.write(folder, "20260101-000000", {"k": 1}, {})
    assert victim.read_text() == "precious"
    assert (folder / "a.txt").read_text() == (folder / "b.pdf").read_text() == "new"

    guessed = b"\1" * 16
    monkeypatch.setattr(os, "urandom", lambda size: guessed[:size])
    link = folder / f".{guessed.hex()}.part"
    link.symlink_to(victim)
    for write in (
        lambda: store.write_text(folder / "a.txt", "newer"),
        lambda: store.write_all(folder, {"b.pdf": b"newer"}),
        lambda: run_store.write(folder, "20260101-000000", {"k": 1}, {}),
    ):
        with pytest.raises(InputError, match="cannot write"):
            write()
    assert victim.read_text() == "precious"
    assert link.is_symlink()
    assert (folder / "a.txt").read_text() == (folder / "b.pdf").read_text() == "new"


@pytest.mark.skipif(os.name != "posix", reason="permissions are of POSIX")
def test_who_may_read_what_is_written(tmp_path):
    """Aside it is the user's alone, then as the umask has it; records and stores stay private."""
    before = os.umask(0o027)
    try:
        with store.aside(tmp_path / "a.csv") as stream:
            stream.write("half")
            (part,) = tmp_path.iterdir()
            assert permissions(part) == 0o600
        store.write_all(tmp_path, {"b.pdf": b"whole"})
        assert permissions(tmp_path / "a.csv") == permissions(tmp_path / "b.pdf") == 0o640
        record = run_store.write(tmp_path / "runs", "20260101-000000", {"k": 1}, {})
        assert permissions(record) == 0o600
        assert permissions(tmp_path / "runs") == 0o700
        from actuator_opt.base.database import NumberColumn, opened

        rows = tmp_path / "rows.db"
        about = {"study": "s", "name": "", "design": "", "version": "1"}
        with opened(rows, columns=[NumberColumn("x", "m")], **about):
            files = sorted(path.name for path in tmp_path.glob("rows.db*"))
            assert files == ["rows.db", "rows.db-shm", "rows.db-wal"]
            assert {permissions(tmp_path / name) for name in files} == {0o600}
        assert os.umask(0o027) == 0o027  # as it was
    finally:
        os.umask(before)


def test_nothing_is_left_aside(tmp_path, monkeypatch):
    """Neither a full disk nor Ctrl-C between two files leaves a part of one."""

    def fail(*_):
        raise KeyboardInterrupt

    with pytest.raises(ZeroDivisionError), store.aside(tmp_path / "a.csv") as stream:
        stream.write(str(1 / 0))
    monkeypatch.setattr(Path, "replace", fail)
    for write in (
        lambda: store.write_all(tmp_path, {"a.pdf": b"1", "b.png": b"2"}),
        lambda: store.write_text(tmp_path / "a.csv", "1"),
    ):
        with pytest.raises(KeyboardInterrupt):
            write()
    assert list(tmp_path.iterdir()) == []


# Damage


def test_a_bit_anywhere_in_a_record_is_noticed(place, tmp_path):
    """Any flipped bit: refused in one line by all who read it, never another number."""
    chance = random.Random(20)
    runs = tmp_path / "runs"
    runs.mkdir()
    path = runs / "20260101-000000-abcdef.run"
    for source in records(place).values():
        whole = source.read_bytes()
        for place_of in [0, whole.index(b"\n"), *chance.sample(range(len(whole) - 1), 100)]:
            data = bytearray(whole)
            data[place_of] ^= 1 << chance.randrange(8)
            path.write_bytes(data)
            with pytest.raises(InputError) as caught:
                ao.read_run(path)
            assert len(caught.value.diagnostics) == 1
            found, faults = run_store.entries(runs)
            assert len(found) + len(faults) == 1
            assert all(dict(one.head) == run_store.read(source)[0] for one in found)
        path.write_bytes(whole)
        assert ao.read_run(path).head["kind"] in ("optimise", "sweep")


def test_a_bit_anywhere_in_a_store_is_noticed(tmp_path):
    """Any flipped bit: the rows of the sweep are the same, or one line refuses the file."""
    vary, rows, table = ["cylinder.bore=18..26 mm:6"], tmp_path / "rows.db", tmp_path / "rows.csv"
    ao.sweep(STEEL, vary, store=rows, csv=table)
    whole, expected = rows.read_bytes(), table.read_bytes()
    with sqlite3.connect(rows) as connection:
        numbers = connection.execute("SELECT numbers FROM rows").fetchone()[0]
    connection.close()
    chance, damaged = random.Random(20), 0
    for place_of in [whole.index(numbers[:80]) + 75, *chance.sample(range(len(whole)), 8)]:
        data = bytearray(whole)
        data[place_of] ^= 1 << chance.randrange(8)
        rows.write_bytes(data)
        with contextlib.suppress(InputError):
            damaged += ao.sweep(STEEL, vary, store=rows, csv=table).damaged
            assert table.read_bytes() == expected
        for more in tmp_path.glob("rows.db-*"):
            more.unlink()
    assert damaged > 0  # the first is in a row


FIELDS = [
    ("kind", 3), ("seed", "1"), ("seed", 2.5), ("met", "yes"), ("version", 5), ("name", None),
    ("started", []), ("seconds", "long"), ("objective", [1]), ("requested", 4.5),
    ("body.date", ["2026-01-01"]), ("body.input", 5), ("body.input.set", [["a"]]),
    ("body.input.plugins", "x"), ("body.versions", []), ("body.trace", 5),
    ("body.trace", [["a", "b", "c"]]), ("body.result", None), ("body.result.metrics", [1]),
    ("body.result.evaluations", 1.5), ("body.tables", [5]), ("body.state.designs", [[]]),
    ("body.state.result.variables", 3), ("body.state.result.seconds", "x"),
    ("body.state.result.trace", [["x"]]), ("body.state.result.status", None),
    ("body.plan.count", 4.0), ("body.plan.count", 5), ("body.plan.axes", [{}]),
    ("body.plan.method", "guess"), ("body.asked", None), ("body.asked.keep", 1.5),
    ("body.asked.store", {"path": 5}), ("body.asked.figures", 3), ("body.result.best", [3]),
]  # fmt: skip


@pytest.mark.parametrize("kind", ["optimise", "sweep"])
def test_fields_of_a_record_that_are_none(place, tmp_path, kind):
    """Missing or of another type, with fitting checksums: one line, exit 3, whoever reads it."""
    source = records(place)[kind]
    body_of = run_store.read(source)[1]
    cases = [(path, value) for path, value in FIELDS if _has(kind, body_of, source, path)]
    assert len(cases) > 20
    for path, value in [*cases, *((path, ...) for path, _ in cases[:6])]:
        runs = tmp_path / "runs"

        def change(head, body, path=path, value=value):
            *way, last = path.removeprefix("body.").split(".")
            found = body if path.startswith("body.") else head
            for step in way:
                found = found[step]
            if value is ...:
                del found[last]
            else:
                found[last] = value

        made = forged(runs, change, source)
        with pytest.raises(InputError) as caught:
            ao.report_run(made, folder=tmp_path / "out")
        (fault,) = caught.value.diagnostics
        assert fault.file == str(made), (path, value)
        listed, faults = verbs.runs(folder=runs)
        assert len(listed) + len(faults) == 1
        made.unlink()
    assert not (tmp_path / "out").exists()


def _has(kind, body, source, path):
    """Whether a record of this kind has such a field."""
    found = {"body": body, **run_store.read(source)[0]}
    for step in path.split("."):
        if not isinstance(found, dict) or step not in found:
            return False
        found = found[step]
    return True


def test_numbers_that_json_lacks_stay_out_of_records(place, tmp_path):
    """NaN, infinity and endless digits in a record are damage, not numbers."""
    source = records(place)["optimise"]
    line = source.read_bytes().splitlines()[0]
    for number in (b"NaN", b"Infinity", b"1e999", b"9" * 5000):
        path = tmp_path / "20260101-000000-abcdef.run"
        bare = run_store._bare(line).replace(b'"seed":0', b'"seed":' + number)
        path.write_bytes(run_store._sealed(bare) + b"\n{}")
        where = {"ACTUATOR_OPT_RUNS": str(tmp_path)}
        told = run("runs", "list", "--json", environment=where)
        assert (told.code, told.json["runs"], len(told.json["errors"])) == (0, [], 1)
        assert run("runs", "show", path).code == 3


@pytest.mark.skipif(os.name != "posix", reason="file names are bytes on POSIX")
def test_a_store_whose_name_is_not_utf_8(tmp_path):
    """It is written, read, explored and reported as any other."""
    name = os.fsdecode(os.fsencode(tmp_path) + b"/r\xff\xfe.db")
    vary = ["--vary", "cylinder.bore=18..26 mm:3", "--store", name]
    for _ in range(2):
        assert run("sweep", STEEL, *vary).code in (0, 1)
    assert run("explore", name, "--out", tmp_path / "page.html").code == 0
    assert run("report", "last", "--out", tmp_path / "out").code in (0, 1)


@pytest.mark.parametrize("text", ["CREATE TABLE rows", "study 1"])
def test_a_store_with_letters_that_are_none(tmp_path, text):
    """Bytes that are no UTF-8 in the schema or in a text: one line."""
    rows, vary = tmp_path / "rows.db", ["cylinder.bore=18..26 mm:3"]
    ao.sweep(STEEL, vary, store=rows)
    if text == "study 1":
        with sqlite3.connect(rows) as connection:
            connection.execute("UPDATE studies SET name = CAST(x'ff41' AS TEXT)")
        connection.close()
    else:
        rows.write_bytes(rows.read_bytes().replace(text.encode(), b"CREATE TABL\xff rows"))
    with pytest.raises(InputError) as caught:
        ao.explore(rows, out=tmp_path)
    assert "damaged" in str(caught.value)
    with pytest.raises(InputError, match="damaged"):
        ao.sweep(STEEL, vary, store=rows)


# Reports


@pytest.mark.parametrize(
    "content",
    [
        b"<<" * 1_150_000 + b"/EmbeddedFile" * 20_000,
        b"1 0 obj <</Type/EmbeddedFile>>stream\n" * 60_000,
        (b"1 0 obj <</EmbeddedFile" + b" " * 4000) * 600,
        b"1 0 obj <</EmbeddedFile/Subtype/application#2Fyaml/Filter/FlateDecode>>\nstream\n" + BOMB,
        b"1 0 obj <</EmbeddedFile/Subtype/application#2Fyaml/Length 9"
        + b"9" * 3000
        + b">>stream\n",
        b"/Encrypt 1 " * 200_000,
    ],
    ids=["brackets", "streams", "spaces", "bomb", "digits", "encrypt"],
)
def test_no_pdf_keeps_the_reader_busy(tmp_path, content):
    """Megabytes made to be slow are refused in a second."""
    path = tmp_path / "slow.pdf"
    if BOMB in content:
        packer = zlib.compressobj(1)
        packed = [packer.compress(bytes(1_000_000)) for _ in range(400)]
        content = content.replace(BOMB, b"".join(packed) + packer.flush())
    path.write_bytes(b"%PDF-1.7\n" + content + b"\n%%EOF\n")
    begin = time.process_time()
    result = run("rerun", path, "--json")
    assert time.process_time() - begin < 2.0
    assert (result.code, len(result.errors)) == (3, 1)


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"command": "actuator-opt optimise a --starts 100000000"}, "give 1 to 1000"),
        ({"command": "actuator-opt optimise a --starts 0"}, "give 1 to 1000"),
        ({"command": "actuator-opt optimise a --seed -1"}, "give 0 to"),
        ({"command": "actuator-opt optimise a --seed=-1"}, "give 0 to"),
        ({"command": "actuator-opt optimise a --seed " + "9" * 5000}, "is not a whole number"),
        ({"command": "actuator-opt pareto a --checks 1000"}, "give 0 to 100"),
        ({"command": "actuator-opt pareto a -n 1000000000"}, "give 3 to 2000"),
        ({"command": "actuator-opt optimise a --verify-dynamics /dev/zero"}, "not a regular file"),
        ({"command": "actuator-opt optimise a --verify-dynamics -"}, "not a regular file"),
        ({"command": "actuator-opt evaluate " + "a" * 200_000}, "more than 100000 characters"),
        ({"actuator_opt": "9" * 5000}, "was made by actuator-opt 999"),
        ({"date": ["2026-01-01"]}, "date must be text"),
        ({"date": "yesterday"}, "date is invalid"),
        ({"result": [1]}, "result must be an object"),
        ({"result": {"metrics": [1, 2]}}, "result.metrics must be an object"),
        ({"result": {"metrics": {"mass": "heavy"}}}, "result.metrics.mass must be a number"),
        ({"result": {"variables": 5}}, "result.variables must be an object"),
        ({"spec_hash": 5}, "spec_hash must be text"),
    ],
)
def test_facts_of_a_pdf_that_are_none(tmp_path, facts, words):
    """Fields of another type, and options beyond what the terminal takes: one line, exit 3."""
    result = run("rerun", _pdf(tmp_path, SMALL, FACTS | facts), "--json")
    assert (result.code, len(result.errors)) == (3, 1)
    assert words in result.errors[0]["message"]
    assert len(result.errors[0]["message"]) < 400


@pytest.mark.parametrize("json_text", ['{"actuator_opt": NaN}', "[" * 100_000, "9" * 5000])
def test_an_attachment_that_is_no_json(tmp_path, monkeypatch, json_text):
    """NaN, endless nesting and endless digits are damage."""
    monkeypatch.setattr(json, "dumps", lambda *_, **__: json_text)
    path = _pdf(tmp_path, SMALL, FACTS)
    monkeypatch.undo()
    result = run("rerun", path, "--json")
    assert (result.code, result.errors[0]["message"]) == (3, "its attachment is damaged")


def test_a_seed_that_no_generator_takes():
    """Beyond 32 bits it is refused where it is read."""
    for seed in (2**32, 10**30, -1):
        assert run("optimise", STEEL, "--seed", seed, "--json").code == 2


# The terminal


def test_no_control_character_reaches_the_terminal(place, tmp_path):
    """From a record, a PDF, arguments and file names, to both streams, in tables and lines."""

    def change(head, body):
        head |= dict.fromkeys(("name", "kind", "version", "command", "outcome", "file"), ESC)
        body["input"] |= {"name": ESC, "set": [[ESC, ESC]]}

    made = forged(tmp_path / "runs", change, records(place)["optimise"])
    where = {"ACTUATOR_OPT_RUNS": str(made.parent)}
    pdf = _pdf(tmp_path, SMALL, FACTS | {"command": f"actuator-opt {ESC}"})
    later = _pdf(tmp_path, SMALL, FACTS | {"actuator_opt": f"99{ESC}"}, "later.pdf")
    for words in (
        ["runs", "list"], ["runs", "show", made], ["report", made], ["runs", "show", ESC],
        ["rerun", pdf], ["rerun", later], ["materials", "show", ESC], ["evaluate", ESC],
        ["seal", STEEL, "--seal", ESC], ["evaluate", STEEL, "--set", f"{ESC}={ESC}"],
        ["sweep", STEEL, "--vary", ESC], ["explore", ESC], [ESC], ["optimise", STEEL, f"--{ESC}"],
    ):  # fmt: skip
        result = run(*words, environment=where)
        told = result.out + result.err
        assert told, words
        found = [c for c in told if c not in "\n\t" and (ord(c) < 32 or 127 <= ord(c) < 160)]
        assert found == [], words
        assert "\u202e" not in told, words


def test_our_own_colours_stay(monkeypatch, capsys):
    """What `Console.paint` writes passes where colours are shown; nothing else does."""
    console = Console(colour=True)
    painted = console.paint("met", "bold", "green")
    shown = {"colour": True, "unicode": True, "width": 80}
    monkeypatch.setattr(streams, "style", lambda: shown)
    streams.out(painted + "\x1b[8mhidden\x1b[31;8m")
    assert capsys.readouterr().out == painted + "\\x1b[8mhidden\\x1b[31;8m\n"
    streams.err(painted)
    assert "\x1b" not in capsys.readouterr().err
    shown["colour"] = False
    streams.out(painted)
    assert "\x1b" not in capsys.readouterr().out
    assert escaped("a\tb\r\nc\n") == "a\tb\r\nc\n"
    assert escaped("a\rb\u2028") == "a\\rb\\u2028"


def test_a_fault_is_one_line():
    """A text with new lines in it makes no second line that looks like ours."""
    fault = Diagnostic("no run \nREQUIREMENTS MET", "see\r\nthere", "file\nname")
    assert len(str(fault).splitlines()) == 1
