"""`rerun` repeats a report from what it carries, or says in one line why it cannot."""

from __future__ import annotations

import io
import json
import shlex
from functools import cache

import pytest
from cases.digests import digest
from cli_runner import BENCH, run
from hypothesis import given, strategies as st

import actuator_opt as ao
from actuator_opt import cli
from actuator_opt.api import repeating
from actuator_opt.base.errors import InputError
from actuator_opt.cli import options
from actuator_opt.rendering import attachments as embed

KINDS = ("application/yaml", "application/json")
SMALL = BENCH.replace("  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n", "")


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    """The report of an evaluation ("e") or of an optimisation ("o"), with its design gone."""
    words = {"e": ["evaluate"], "o": ["optimise", "--seed", 2]}

    @cache
    def report(kind):
        place = tmp_path_factory.mktemp("reports")
        design = place / "small one.yaml"
        design.write_text(SMALL)
        more = ["--set", "load.mass=21 kg", "--date", "2025-01-02", "--json", "--report"]
        assert run(*words[kind], design, *more, "--out", place / kind).code == 0
        design.unlink()
        return place / kind / "small one.pdf"

    return report


def changed(tmp_path, source, change, name="x.pdf"):
    """A copy of a PDF with other bytes."""
    path = tmp_path / name
    path.write_bytes(change(source.read_bytes()))
    return path


@pytest.mark.parametrize("kind", ["e", pytest.param("o", marks=pytest.mark.long)])
def test_a_report_repeats_to_the_byte(reports, tmp_path, kind):
    """The same numbers, the same PDF, and JSON as the command's own with `rerun`."""
    result = run("rerun", reports(kind), "--json", "--out", tmp_path)
    assert (result.code, result.err) == (0, "")
    data = result.json
    assert data["rerun"]["repeats"] is True
    assert data["rerun"]["differences"] == {}
    assert "the result is reproduced" in data["rerun"]["outcome"]
    assert "--set 'load.mass=21 kg'" in data["rerun"]["command"]
    assert ("kkt" in data) == (kind == "o")
    assert digest(tmp_path / "small one.pdf") == digest(reports(kind))
    told = run("rerun", reports(kind))
    assert told.err.endswith("the version of this installation\n")
    assert run("rerun", reports(kind), "--quiet").out == ""


def test_it_never_writes_over_what_it_reads(reports):
    """The report itself is no place for the new one; without --out nothing is written."""
    before = digest(reports("e"))
    refused = run("rerun", reports("e"), "--out", reports("e").parent, "--json")
    assert refused.code == 3
    assert "is an input and would be overwritten" in refused.errors[0]["message"]
    assert digest(reports("e")) == before


def test_what_differs_is_named(reports, tmp_path):
    """A result that is not the same: which numbers, by how much, which version; exit 1."""
    with_other = _tampered(tmp_path, reports("e"), lambda run: run["result"]["metrics"].update(
        mass=run["result"]["metrics"]["mass"] * 1.01, push_force=None))  # fmt: skip
    result = run("rerun", with_other, "--json")
    assert result.code == 1
    inside = result.json["rerun"]
    assert inside["repeats"] is False
    assert set(inside["differences"]) == {"mass", "push_force"}
    assert "mass -0.99 %" in inside["outcome"]
    older = _tampered(tmp_path, reports("e"), lambda run: run.update(actuator_opt="0.1.0"))
    assert "made by actuator-opt 0.1.0" in run("rerun", older).err
    bare = _tampered(tmp_path, reports("e"), lambda run: run.pop("result"))
    assert run("rerun", bare, "--json").json["rerun"]["repeats"] is True  # by its hash
    lost = _tampered(tmp_path, bare, lambda run: run.update(spec_hash="0"))
    assert run("rerun", lost, "--json").json["rerun"]["repeats"] is None


def _tampered(tmp_path, source, change):
    """A PDF that carries another run record, made by the plain attacher."""
    inside = ao.rendering.attachments.read_attachment(source)
    facts = json.loads(json.dumps(inside.run))
    change(facts)
    return _pdf(tmp_path, inside.source, facts)


def _pdf(tmp_path, source, facts, name="made.pdf"):
    from matplotlib.figure import Figure

    stream = io.BytesIO()
    Figure(figsize=(1, 1)).savefig(stream, format="pdf")
    files = [
        ("a.yaml", "application/yaml", source.encode()),
        ("b.json", "application/json", json.dumps(facts).encode()),
    ]
    path = tmp_path / name
    path.write_bytes(embed.embed(stream.getvalue(), files))
    return path


FACTS = {"actuator_opt": "0.6.0", "command": "actuator-opt evaluate a.yaml", "source_name": "a"}


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"actuator_opt": "99.0.0"}, "was made by actuator-opt 99.0.0"),
        ({"command": ""}, "made by a script"),
        ({"command": "actuator-opt 'evaluate"}, "made by actuator-opt ?"),
        ({"command": "actuator-opt simulate s.yaml"}, "requires more input than a design"),
        ({"command": "rm -rf x"}, "requires more input than a design"),
        ({"command": "actuator-opt evaluate a --frob 3"}, "cannot be repeated"),
        ({"command": "actuator-opt optimise a --seed x"}, "cannot be repeated"),
        ({"command": "actuator-opt optimise"}, "cannot be repeated"),
        ({"command": "actuator-opt evaluate a --plugin own.py"}, "a plug-in is a program"),
        ({"command": "actuator-opt evaluate a --set bore"}, "PATH=VALUE"),
        ({"command": "actuator-opt optimise a --verify-dynamics no.yaml"}, "no such file"),
        ({"command": 3}, "does not state its command"),
        ({"source_name": None}, "does not state its source_name"),
    ],
)
def test_commands_that_cannot_be_run_again(tmp_path, facts, words):
    """One line each; a plugin is a program and is never run because a PDF says so."""
    result = run("rerun", _pdf(tmp_path, SMALL, FACTS | facts), "--json")
    assert result.code in (2, 3)
    assert len(result.errors) == 1
    assert words in result.errors[0]["message"] + result.errors[0]["remedy"]


def test_a_plugin_is_named_by_the_person(tmp_path):
    """With --plugin it runs, with its metric."""
    plugin = tmp_path / "own.py"
    plugin.write_text(
        "import actuator_opt as ao\n@ao.metric('slenderness')\n"
        "def own(v):\n    return v['cylinder.stroke'] / v['cylinder.bore']\n"
    )
    command = shlex.join(["actuator-opt", "evaluate", "a.yaml", "--plugin", str(plugin)])
    path = _pdf(tmp_path, SMALL, FACTS | {"command": command})
    data = run("rerun", path, "--plugin", plugin, "--json").json
    assert data["metrics"]["slenderness"]["value"] == pytest.approx(110 / 22)


def test_faults_of_the_input_keep_their_place(tmp_path):
    """A design that no longer reads is told at its line, under its own name."""
    result = run("rerun", _pdf(tmp_path, SMALL.replace("22 mm", "-2 mm"), FACTS), "--json")
    assert (result.code, result.errors[0]["file"]) == (3, "a")
    assert result.errors[0]["line"] == SMALL.splitlines().index("  bore: 22 mm") + 1


def test_files_that_are_no_report(reports, tmp_path):
    """Foreign, cut off, damaged, not there, a folder, two in one."""
    data = reports("e").read_bytes()
    at = data.index(b"application#2Fyaml")
    begin = data.index(b"stream", at) + 8
    cases = {
        "is not a PDF": SMALL.encode(),
        "has no input": b"%PDF-1.7\n1 0 obj\nendobj\n%%EOF\n",
        "is truncated": data[: at // 2],
        "is damaged": data[:begin] + b"\0\0\0\0" + data[begin + 4 :],
        "several attachments": data + data.replace(b"load_cases", b"x", 0)
        + _pdf(tmp_path, "a: 1\n", FACTS).read_bytes(),
    }  # fmt: skip
    for words, content in cases.items():
        path = tmp_path / "case.pdf"
        path.write_bytes(content)
        result = run("rerun", path, "--json")
        assert (result.code, len(result.errors)) == (3, 1), words
        assert words in result.errors[0]["message"]
        assert result.errors[0]["file"] == str(path)
    for path in (tmp_path, tmp_path / "none.pdf", "/dev/null"):
        assert run("rerun", path, "--json").code == 3


def test_a_bomb_is_refused(tmp_path, monkeypatch):
    """An attachment that unpacks without end stops at a limit."""
    monkeypatch.setattr(embed, "MOST_BYTES", 1_000)
    result = run("rerun", _pdf(tmp_path, "a: 1\n" * 1000, FACTS), "--json")
    assert result.code == 3
    assert "is larger than" in result.errors[0]["message"]


@pytest.mark.long
def test_other_programs_may_have_saved_it(reports, tmp_path):
    """Saved again by another library it still runs; with a password it is said to be encrypted."""
    pypdf = pytest.importorskip("pypdf")
    for password, words in ((None, None), ("secret", "is encrypted")):
        writer = pypdf.PdfWriter(clone_from=reports("e"))
        if password:
            writer.encrypt(password, algorithm="RC4-128")
        path = tmp_path / "saved.pdf"
        writer.write(path)
        result = run("rerun", path, "--json")
        if words is None:
            assert result.json["rerun"]["repeats"] is True
        else:
            assert words in result.errors[0]["message"]


@given(st.data())
def test_no_damage_leads_to_a_traceback(reports, data):
    """Any bytes changed or lost: read to the letter, or refused with a sentence."""
    whole = reports("e").read_bytes()
    sound = embed.extract(whole, KINDS)
    around = [begin - 200 for _, begin in embed.streams(whole)]
    near = data.draw(st.sampled_from(around)) + data.draw(st.integers(-50, 2500))
    junk = data.draw(st.binary(max_size=20))
    end = near + data.draw(st.integers(0, 40))
    try:
        found = embed.extract(whole[:near] + junk + whole[end:], KINDS)
    except InputError:
        return
    for kind, content in found.items():
        if kind in sound and kind.endswith("yaml"):
            assert len(content) == len(sound[kind])  # Flate's own checksum guards the rest
            assert content == sound[kind]


def test_the_parser_knows_every_option_of_the_commands():
    """Whatever changes a result in the terminal can be repeated; a new option is seen here."""
    known = {word for action in repeating.parser()._actions for word in action.option_strings}
    idle = {
        "--out", "--json", "--quiet", "-q", "--report", "--write", "--no-record", "--help", "-h",
        "--csv", "--debug", "--format", "--all-pages", "--attach-studio", "--scheduler",
        "--verbose", "-v", "--relax-safety",
    }  # fmt: skip
    commands = cli.command_line().commands
    for verb in repeating.OPTIMISED + repeating.EVALUATED + repeating.FRONTS:
        words = {word for one in commands[verb].params for word in one.opts if word[0] == "-"}
        assert words - idle <= known, verb
    assert options.NoRecord is not None
