"""Words that shells complete, asked for in the way of each shell."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from cli_runner import DESIGNS

from actuator_opt.cli import app, completion

KNEE = str(DESIGNS / "knee.yaml")


@pytest.fixture
def asked(monkeypatch, capsys):
    """The lines that a shell gets for a line whose last word is incomplete."""

    def ask(shell, line):
        words = line.split(" ")
        monkeypatch.setenv("_ACTUATOR_OPT_COMPLETE", f"complete_{shell}")
        if shell == "bash":
            monkeypatch.setenv("COMP_WORDS", line)
            monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
        else:
            monkeypatch.setenv("_TYPER_COMPLETE_ARGS", line)
            monkeypatch.setenv("_TYPER_COMPLETE_WORD_TO_COMPLETE", words[-1])
            monkeypatch.setenv("_TYPER_COMPLETE_FISH_ACTION", "get-args")
        completion.typed.cache_clear()
        with pytest.raises(SystemExit):
            app.command_line()(prog_name="actuator-opt", standalone_mode=False)
        return capsys.readouterr().out.splitlines()

    yield ask
    completion.typed.cache_clear()


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_values_of_the_file_on_the_line(asked, shell):
    """Each shell gets the PATH with the value that the file states, in its own notation."""
    (line,) = asked(shell, f"actuator-opt evaluate {KNEE} --set cylinder.bo")
    bore = re.search(r"  bore: (\S+) mm", Path(KNEE).read_text("utf-8"))[1]
    assert f"cylinder.bore={bore}mm" in line


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"evaluate {KNEE} --set load_cases[stance].f", ["load_cases[stance].force=6kN"]),
        (f"sweep {KNEE} --vary requirements.buck", ["requirements.buckling_factor.min=3.5"]),
        (
            f"pareto {KNEE} --objective push",
            ["push_force:min", "push_force:max"],
        ),
        ("materials show ti_", ["ti_6al4v"]),
        ("evaluate missing.yaml --set cylinder.", []),
        ("evaluate --set cylinder.", []),
        ("optimi", ["optimise"]),
    ],
)
def test_words(asked, line, words):
    """Values, limits, metrics, materials and commands; none without a readable design."""
    assert list(filter(None, asked("bash", f"actuator-opt {line}"))) == words
