"""What a release promises: one version, its files, the README's commands, the size of modules."""

from __future__ import annotations

import ast
import contextlib
import re
import shutil
import subprocess
import tarfile
import tomllib
import zipfile
from importlib.resources import files
from pathlib import Path

import pytest
import yaml

from actuator_opt.version import VERSION

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text("utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
MODULES = sorted((ROOT / "actuator_opt").rglob("*.py"))
PRIVATE_PLACES = ("/" + "work/", "/" + "tmp/", "/" + "root/", "PHYSICS" + "_DETAIL")
"""Words of a developer's machine or notes, which mean nothing to a reader."""
LONGEST_MODULE, LONGEST_FUNCTION = 1100, 60


def listed():
    """Files git tracks, or would."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
    paths = [ROOT / name for name in found.decode().split("\0") if name]
    return [path for path in paths if path.is_file()]


def commands():
    """Lines of the README's shell blocks that set up an environment."""
    blocks = re.findall(r"^```sh\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if "-m venv" in line]


def test_one_version():
    """The version of the code is the citation's, and the newest change's, with its date."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    newest, date = re.search(r"^## (\S+) \((\S+)\)", changes, flags=re.MULTILINE).groups()
    assert [citation["version"], newest] == [VERSION, VERSION]
    assert str(citation["date-released"]) == date
    project = PROJECT["project"]
    assert citation["authors"] == project["authors"]
    assert citation["license"] == project["license"]
    assert citation["keywords"] == project["keywords"]
    assert citation["abstract"].strip(".") == project["description"]
    assert "version" in PROJECT["project"]["dynamic"]
    assert PROJECT["tool"]["hatch"]["version"]["path"] == "actuator_opt/version.py"


def test_data_ships_inside_the_package():
    """References lie beside the code; materials are copied into the wheel."""
    assert (files("actuator_opt") / "references.yaml").is_file()
    assert (files("actuator_opt") / "py.typed").read_bytes() == b""  # PEP 561
    wheel = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["packages"] == ["actuator_opt"]
    assert (ROOT / "materials").is_dir()
    assert "materials" in wheel["force-include"]


def test_replicas_stay_in_the_sources():
    """The source distribution has the re-created papers, the wheel has not."""
    targets = PROJECT["tool"]["hatch"]["build"]["targets"]
    assert targets["wheel"]["exclude"] == ["/actuator_opt/replicas"]
    assert "actuator_opt" in targets["sdist"]["include"]
    assert "exclude" not in targets["sdist"]
    assert (ROOT / "actuator_opt" / "replicas" / "__init__.py").is_file()


def test_built_distributions(tmp_path):
    """The files of both, as the build backend writes them; where it is installed."""
    hatchling = pytest.importorskip("hatchling.build")
    with contextlib.chdir(ROOT):
        wheel = zipfile.ZipFile(tmp_path / hatchling.build_wheel(str(tmp_path)))
        archive = tmp_path / hatchling.build_sdist(str(tmp_path))
    with wheel, tarfile.open(archive) as sources:
        assert not [name for name in wheel.namelist() if "replicas" in name]
        assert "actuator_opt/_data/materials/fluids.yaml" in wheel.namelist()
        assert "actuator_opt/py.typed" in wheel.namelist()
        packed = {name.partition("/")[2] for name in sources.getnames()}
    assert "docs/build.py" in packed
    assert not [name for name in packed if name.startswith("docs/_build")]
    replicas = (ROOT / "actuator_opt" / "replicas").rglob("*.*")
    names = {str(path.relative_to(ROOT)) for path in replicas if path.suffix in (".py", ".yaml")}
    assert names <= packed


def test_no_file_names_a_private_place():
    """Nothing points to a developer's own folders or notes."""
    found = [
        f"{path.relative_to(ROOT)}: {word}"
        for path in listed()
        for word in PRIVATE_PLACES
        if word.encode() in path.read_bytes()
    ]
    assert found == []


def test_modules_and_functions_stay_short():
    """A module fits a few screens, a function one: without its signature and docstring."""
    for path in MODULES:
        text = path.read_text("utf-8")
        assert len(text.splitlines()) <= LONGEST_MODULE, path
        long = []
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                body = node.body[1:] if ast.get_docstring(node) else node.body
                length = node.end_lineno - body[0].lineno + 1 if body else 0
                if length > LONGEST_FUNCTION:
                    long.append(f"{node.name}: {length}")
        assert long == [], path


def test_readme_has_two_complete_commands():
    """Two one-line commands, joined by &&, each written once and named nowhere before."""
    assert len(README.encode()) <= 8000
    design, test = commands()
    for command, end in (
        (design, ".venv/bin/actuator-opt optimise designs/knee.yaml"),
        (test, ".venv/bin/python -m pytest"),
    ):
        steps = command.split(" && ")
        assert [step.split()[0] for step in steps[:2]] == ["python3", ".venv/bin/pip"]
        assert steps[-1].startswith(end)
        assert README.count(command) == 1
        before = README[: README.index(command)]
        assert end.rsplit("/", 1)[1] not in before.replace(design, "")


def test_ci_runs_the_readme_command():
    """`.ci/run` takes its test command from the README, so a missing step shows."""
    script = (ROOT / ".ci" / "run").read_text("utf-8")
    pattern = re.search(r"grep -m1 -E '([^']+)' README\.md", script)[1]
    _, test = commands()
    assert [line for line in README.splitlines() if re.search(pattern, line)] == [test]
