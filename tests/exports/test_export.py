"""`export` from the terminal and from scripts: files, JSON, and every way to get it wrong."""

from __future__ import annotations

import hashlib
import os
import sys
from pathlib import Path

import pytest
from cli_runner import KNEE, bench, run
from full_disk import fill
from step_reader import StepFile

import actuator_opt as ao
from actuator_opt import exports
from actuator_opt.base import files as store


@pytest.fixture
def design(tmp_path):
    """A design file of its own."""
    path = tmp_path / "joint.yaml"
    path.write_text(bench(), "utf-8")
    return path


def test_files_and_json(design, tmp_path):
    """Every format in the order asked for, each with the hash of what lies there."""
    out = tmp_path / "new" / "folder"
    result = run("export", design, "--format", "xlsx", "--format", "step", "--format", "dxf",
                 "--format", "step", "--out", out, "--json")  # fmt: skip
    assert (result.code, result.err) == (0, "")
    assert list(result.json) == ["files"]
    names = [Path(file["path"]).name for file in result.json["files"]]
    assert names == ["joint.xlsx", "joint.step", "joint.dxf"]
    for file in result.json["files"]:
        assert set(file) == {"path", "sha256"}
        assert hashlib.sha256(Path(file["path"]).read_bytes()).hexdigest() == file["sha256"]
    assert sorted(one.name for one in out.iterdir()) == sorted(names)


def test_plain_output_names_the_files(design, tmp_path):
    """Nothing on stdout; --quiet says nothing at all."""
    arguments = ("export", design, "--format", "step", "--out", tmp_path)
    result = run(*arguments)
    assert (result.code, result.out) == (0, "")
    assert result.err == f"wrote {tmp_path / 'joint.step'}\n"
    result = run(*arguments, "--quiet")
    assert (result.code, result.out, result.err) == (0, "", "")


def test_a_missed_requirement_leaves_by_1(design, tmp_path):
    """As `report` does: the files are written all the same."""
    result = run("export", design, "--format", "step", "--out", tmp_path, "--json",
                 "--set", "requirements.burst_factor.min=50")  # fmt: skip
    assert result.code == 1
    assert Path(result.json["files"][0]["path"]).is_file()


def test_set_and_date(design, tmp_path):
    """--set changes the solid, --date is written down; without it no date is."""
    arguments = ("export", design, "--format", "step", "--out", tmp_path, "-q")
    run(*arguments)
    before = (tmp_path / "joint.step").read_text("ascii")
    assert "FILE_NAME('test bench','',(" in before
    run(*arguments, "--set", "cylinder.stroke=50 mm", "--date", "2026-03-04")
    after = (tmp_path / "joint.step").read_text("ascii")
    assert "FILE_NAME('test bench','2026-03-04T00:00:00',(" in after
    lengths = []
    for text in (before, after):
        rod = StepFile(text).solids()["rod"]
        lengths.append(max(face.end[0] for face in rod))
    assert lengths[0] - lengths[1] == pytest.approx(60.0, abs=1e-9)


@pytest.mark.parametrize(
    ("formats", "message", "remedy"),
    [
        ((), "no format given", "--format step|dxf|xlsx|c"),
        (("stp",), '"stp"', "use step, dxf, xlsx, c"),
        (("step", "pdf"), '"pdf"', "use step, dxf, xlsx, c"),
        (("step,dxf",), '"step,dxf"', "its own --format"),
        (("",), '""', "use step, dxf, xlsx, c"),
        (("STEP",), '"STEP"', "use step, dxf, xlsx, c"),
        (("x" * 5000,), "xxx", "use step, dxf, xlsx, c"),
    ],
)
def test_unknown_formats(design, tmp_path, formats, message, remedy):
    """A usage error in one line before anything is read or written."""
    out = tmp_path / "out"
    asked = [word for one in formats for word in ("--format", one)]
    result = run("export", design, *asked, "--out", out, "--json")
    (fault,) = result.errors
    assert result.code == 2
    assert message in fault["message"]
    assert len(fault["message"]) < 120
    assert remedy in fault["remedy"]
    assert not out.exists()


@pytest.mark.parametrize(
    ("name", "extra", "kind"), [("ezdxf", "cad", "dxf"), ("openpyxl", "excel", "xlsx")]
)
def test_a_missing_extra_says_how_to_get_it(design, tmp_path, monkeypatch, name, extra, kind):
    """One line, and no file: not those of the other formats either."""
    monkeypatch.setitem(sys.modules, name, None)
    out = tmp_path / "out"
    result = run("export", design, "--format", "step", "--format", kind, "--out", out)
    assert result.code == 3
    assert result.err.count("\n") == 1
    assert f"{kind.upper()} files need {name}" in result.err
    assert f"pip install 'actuator-opt[{extra}]'" in result.err
    assert not out.exists()


def test_step_needs_no_extra(design, tmp_path, monkeypatch):
    """The STEP writer is our own."""
    for name in ("ezdxf", "openpyxl"):
        monkeypatch.setitem(sys.modules, name, None)
    assert run("export", design, "--format", "step", "--out", tmp_path).code == 0


def test_places_that_cannot_be_written(design, tmp_path):
    """A file in the folder's place, a folder in a file's place: one line, nothing half-written."""
    blocked = tmp_path / "file"
    blocked.write_text("", "utf-8")
    result = run("export", design, "--format", "step", "--out", blocked / "below")
    assert (result.code, result.out) == (3, "")
    assert result.err.count("\n") == 1
    out = tmp_path / "out"
    (out / "joint.xlsx").mkdir(parents=True)
    result = run("export", design, "--format", "step", "--format", "xlsx", "--out", out)
    assert result.code == 3
    assert "cannot write the export" in result.err
    assert [one.name for one in out.iterdir()] == ["joint.xlsx"]


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root writes anywhere")
def test_a_folder_without_permission(design, tmp_path):
    """Told before the work."""
    out = tmp_path / "locked"
    out.mkdir(mode=0o500)
    result = run("export", design, "--format", "step", "--out", out)
    assert result.code == 3
    assert "no permission to write" in result.err


def test_a_full_disk_leaves_no_part(design, tmp_path, monkeypatch):
    """The files of before stay as they were."""
    old = tmp_path / "joint.step"
    old.write_text("old", "utf-8")

    opened = fill(monkeypatch)
    result = run("export", design, "--format", "step", "--out", tmp_path)
    assert result.code == 3
    assert "No space left on device" in result.err
    assert len(opened) == 1
    assert old.read_text("utf-8") == "old"
    assert {one.name for one in tmp_path.iterdir()} == {"joint.step", "joint.yaml"}


def test_bad_designs_are_told_with_their_line(tmp_path):
    """As every command does."""
    text = bench(("bore: 22 mm", "bore: 22 bar")).encode()
    result = run("export", "-", "--format", "step", "--out", tmp_path, "--json", stdin=text)
    assert result.code == 3
    assert result.errors[0]["path"] == "cylinder.bore"
    assert list(tmp_path.iterdir()) == []


def test_the_verb_takes_any_form_of_a_design(design, tmp_path):
    """A path, an actuator, a design, an evaluation."""
    assert callable(ao.export)
    assert exports.FORMATS == ("step", "dxf", "xlsx", "c", "fmu")
    actuator = ao.read(design)
    evaluation = ao.evaluate(actuator)
    contents = []
    for index, subject in enumerate((design, str(design), actuator, actuator.design, evaluation)):
        (file,) = ao.export(subject, folder=tmp_path / str(index))
        contents.append(file.path.read_bytes())
        assert file.path.name == ("joint.step" if index < 3 else "test_bench.step")
    assert len(set(contents)) == 1
    (file,) = ao.export(evaluation, formats="step", actuator=actuator, folder=tmp_path, stem="own")
    assert file.path == tmp_path / "own.step"
    assert file.to_dict() == {"path": str(file.path), "sha256": file.sha256}
    with pytest.raises(ao.ActuatorError, match="is not a date"):
        ao.export(evaluation, formats=["xlsx"], folder=tmp_path, date="yesterday")
    with pytest.raises(ao.ActuatorError, match="no format given"):
        ao.export(evaluation, formats=[], folder=tmp_path)


def test_an_optimum_is_exported_as_found(tmp_path):
    """The solids of an optimum are those of its best design, not of the file."""
    optimum = ao.optimise(bench(), starts=1, prices=False)
    (file,) = ao.export(optimum, folder=tmp_path)
    solids = StepFile(file.path.read_text("ascii")).solids()
    radius = max(face.start[1] for face in solids["head"])
    assert radius == pytest.approx(1000 * optimum.best.cylinder.bore / 2, abs=1e-8)


def test_without_formats_nothing_heavy_is_loaded():
    """STEP loads neither library; the command line of other verbs loads no exporter."""
    from cli_runner import command, surroundings

    code = (
        "import sys, actuator_opt as ao, tempfile\n"
        f"ao.export({str(KNEE)!r}, folder=tempfile.mkdtemp())\n"
        "print([n for n in ('ezdxf', 'openpyxl', 'matplotlib', 'scipy') if n in sys.modules])"
    )
    import subprocess

    done = subprocess.run([command()[0], "-c", code], capture_output=True, text=True, check=True,
                          env=surroundings(), timeout=60)  # fmt: skip
    assert done.stdout.strip() == "[]"


def test_write_all_is_whole_or_nothing(tmp_path):
    """Both files, or neither."""
    store.write_all(tmp_path, {"a": b"1", "b": b"2"})
    (tmp_path / "c").mkdir()
    with pytest.raises(ao.InputError, match="cannot write the pages"):
        store.write_all(tmp_path, {"a": b"3", "c": b"4"}, what="the pages")
    assert (tmp_path / "a").read_bytes() == b"1"
