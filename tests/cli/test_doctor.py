"""`doctor` names what is missing, and only that; it leaves nothing behind."""

from __future__ import annotations

import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from cli_runner import ROOT, run

import actuator_opt as ao
from actuator_opt.api import installation

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def found(**options):
    """Findings by group and name."""
    result = ao.doctor(**options)
    return {(one.group, one.name): one for one in result.findings}, result.ok


def test_this_installation_is_complete(tmp_path):
    """Every dependency of the project, its fonts, data and folders; JSON and text agree."""
    out = tmp_path / "new" / "reports"
    result = run("doctor", "--json", "--out", out, environment={"ACTUATOR_OPT_RUNS": str(tmp_path)})
    data = result.json
    assert (result.code, result.err, data["ok"]) == (0, "", True)
    rows = data["findings"]
    needed = {row["name"] for row in rows if row["group"] == "dependency"}
    assert needed == {installation._REQUIREMENT.match(x)[1] for x in PROJECT["dependencies"]}
    extras = {row["name"] for row in rows if row["group"] == "extra"}
    assert extras == set(PROJECT["optional-dependencies"]) - {"test", "dev"}
    for row in rows:
        assert (row["status"] == "ok") == (row["remedy"] == ""), row
    assert list(tmp_path.iterdir()) == []
    text = run("doctor", "--out", out, encoding="ascii", environment={"COLUMNS": "60"})
    assert text.code == 0
    for row in rows:
        assert f" {row['name']} " in text.out, row
    assert run("doctor", "--quiet").out == ""


def test_folders_that_cannot_be_written_are_faults(tmp_path):
    """A file in the way, below a file, a device; exit 1 and what to do."""
    file = tmp_path / "file"
    file.write_text("")
    for place in (file, file / "below", Path("/proc/nothing")):
        rows, ok = found(out=place, runs=tmp_path)
        assert not ok
        row = rows["folder", "reports"]
        assert (row.status, row.remedy) == ("fault", "name another folder with --out")
        assert rows["folder", "runs"].status == "ok"
    told = run("doctor", environment={"ACTUATOR_OPT_RUNS": str(file)})
    assert told.code == 1
    assert "FAULT" in told.out
    assert "ACTUATOR_OPT_RUNS" in " ".join(told.out.split())
    off = run("doctor", environment={"ACTUATOR_OPT_RUNS": str(file), "ACTUATOR_OPT_NO_RECORD": "1"})
    assert off.code == 0


def test_missing_old_and_broken_packages(monkeypatch):
    """Not there, too old or too new, not to be imported: each said with the pip command."""
    monkeypatch.setattr(
        installation, "_requirements",
        lambda: (["no-such-thing>=1", "numpy>=99", "scipy<1"], {"maths": ["no-such-thing>=1"]}),
    )  # fmt: skip
    rows, ok = found()
    assert not ok
    said = {name: row for (group, name), row in rows.items() if group == "dependency"}
    assert said["no-such-thing"].value == "is not installed"
    assert said["no-such-thing"].remedy == "pip install 'no-such-thing>=1'"
    version = metadata.version("numpy")
    assert said["numpy"].value == f"{version} is installed, >=99 is needed"
    assert said["scipy"].status == "fault"
    extra = rows["extra", "maths"]
    assert (extra.status, extra.remedy) == (
        "missing",
        "to add it: pip install 'actuator-opt[maths]'",
    )

    def broken(name):
        raise ImportError(f"{name}: wrong ELF class\nmore")

    monkeypatch.setattr(installation, "_requirements", lambda: (["numpy>=2"], {}))
    monkeypatch.setattr(installation, "import_module", broken)
    rows, ok = found()
    assert not ok
    assert rows["dependency", "numpy"].value.endswith("cannot be imported: numpy: wrong ELF class")


def test_missing_fonts_and_data(monkeypatch, tmp_path):
    """Without its fonts or its materials nothing can be reported or read."""
    monkeypatch.setattr("actuator_opt.rendering.paper.font_folders", lambda: [str(tmp_path)])
    monkeypatch.setattr("actuator_opt.base.files._PACKAGE", tmp_path / "elsewhere")
    monkeypatch.setattr(
        "actuator_opt.base.files.data_folder", lambda name: _lost(name, tmp_path / "elsewhere")
    )
    rows, ok = found()
    assert not ok
    assert "DejaVuSans.ttf" in rows["data", "fonts"].value
    assert "missing from this installation" in rows["data", "materials"].value


def _lost(name, package):
    raise ao.InputError(f'the data folder "{name}" is missing from this installation: {package}')


def test_python_must_be_new_enough(monkeypatch):
    """An older Python is a fault."""
    monkeypatch.setattr(sys, "version_info", (3, 10, 0))
    rows, ok = found()
    assert not ok
    assert rows["program", "Python"].remedy == "install Python 3.11 or later"


@pytest.mark.parametrize(
    ("version", "bounds", "fits"),
    [
        ("2.1", ">=2.1", True), ("2.0.9", ">=2.1", False), ("2.10.0", ">=2.9", True),
        ("0.16.0", ">=0.15,<0.16", False), ("0.15.9", ">=0.15,<0.16", True),
        ("1.4.5", "~=1.4.2", True), ("1.5.0", "~=1.4.2", False), ("3.0rc1", ">=2", True),
        ("2.0", "==2.0.0", True), ("2.0", "!=2", False), ("2.0", "", True),
    ],
)  # fmt: skip
def test_versions(version, bounds, fits):
    """Bounds as pip reads them, for the plain versions that dependencies have."""
    assert installation._fits(version, bounds) is fits


def test_models_without_a_compiler(monkeypatch):
    """An installation without a C compiler works; `doctor` says what is slower, and what to do."""
    from actuator_opt.base.symbolic import program

    monkeypatch.setattr(program, "AVAILABLE", False)
    rows, ok = found()
    row = rows["machine", "recorded models"]
    assert ok
    assert (row.status, "C compiler" in row.remedy) == ("missing", True)
