"""The notebooks run from top to bottom, and what their cells show renders."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

NOTEBOOKS = Path(__file__).parents[2] / "designs" / "notebooks"


@pytest.mark.parametrize("path", sorted(NOTEBOOKS.glob("*.ipynb")), ids=lambda path: path.stem)
@pytest.mark.long
def test_notebook(path, monkeypatch, capsys):
    """Each cell runs after the ones before it, as in Jupyter; the last value of a cell is shown."""
    monkeypatch.chdir(NOTEBOOKS)
    names = {"__name__": "__main__"}
    for cell in json.loads(path.read_text("utf-8"))["cells"]:
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, path.name, "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), path.name, "eval"), names)
            page = getattr(value, "_repr_html_", lambda: None)()
            assert len(repr(value)) <= 120
            if page is not None:
                assert "<script" not in page
                assert len(page) < 60_000
    assert "False" not in capsys.readouterr().out or path.stem == "prices"
