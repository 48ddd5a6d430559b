"""Design scripts of the project: as modules, as a person runs them, and what their pages carry."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from contextlib import redirect_stdout
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import pytest

import actuator_opt as ao

SCRIPTS = Path(__file__).parents[2] / "designs" / "scripts"


def script(name: str) -> Any:
    """The script of that name, loaded without running its `main`."""
    spec = importlib.util.spec_from_file_location(name, SCRIPTS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def ran(name: str, folder: Path) -> tuple[str, Path]:
    """What a script prints with few points, run as a person runs it, and the page it writes."""
    pytest.importorskip("typst")
    done = subprocess.run(
        [sys.executable, "-W", "error", str(SCRIPTS / f"{name}.py"), "--quick", "--out", folder],
        capture_output=True,
        text=True,
        encoding="utf-8",
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(SCRIPTS.parents[1]), "PYTHONUTF8": "1"},
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout, folder / f"{name}.pdf"


def ran_here(name: str, folder: Path, *options: str | Path) -> str:
    """What a script prints when its `main` runs in this process; each search has one start."""
    module, optimise, printed = script(name), ao.optimise, StringIO()

    def from_one_start(*arguments: Any, **more: Any) -> Any:
        return optimise(*arguments, **more | {"starts": 1})

    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed):
        patch.setattr(ao, "optimise", from_one_start)
        patch.setattr(sys, "argv", [f"{name}.py", *map(str, options)])
        patch.chdir(folder)
        module.main()
    return printed.getvalue()


def text_of(pdf: bytes) -> str:
    """Text of a PDF as one line."""
    pypdf = pytest.importorskip("pypdf")
    text = " ".join(page.extract_text() for page in pypdf.PdfReader(BytesIO(pdf)).pages)
    return " ".join(text.split())


def carried(pdf: Path) -> dict[str, Any]:
    """The numbers that the page of a study carries inside."""
    pypdf = pytest.importorskip("pypdf")
    found: dict[str, Any] = json.loads(pypdf.PdfReader(pdf).attachments[f"{pdf.stem}.json"][0])
    return found
