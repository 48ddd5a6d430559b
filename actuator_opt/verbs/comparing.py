"""`compare`: designs and recorded runs side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import run_store
from ..design import Design
from ..errors import Diagnostic, InputError, UsageError
from ..evaluation import Evaluation, comparison
from ..evaluation.comparison import Comparison
from .actuator import Actuator, Plugins, read
from .optimum import evaluate
from .recorded_runs import Run
from .reports import file_name
from .restoring import Restored, restore

if TYPE_CHECKING:
    from ..optimisation.result import Optimisation

MOST = 12
"""Designs beside each other, at most: a choice."""


def compare(
    *designs: Actuator | Design | Evaluation | Optimisation | Run | str | Path,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
    plugins: Plugins = (),
) -> Comparison:
    """Designs side by side: what differs in the inputs, and which parts make one better.

    Parameters
    ----------
    designs : two or more: files, recorded runs (id, ``last``), or what other verbs give; the first
        is what the others are held against
    set : values to replace in every file
    plugins : the user's own metrics

    Raises
    ------
    UsageError : fewer than two, or too many
    InputError : one cannot be read, or two are the same; every fault of every file
    """
    if len(designs) < 2:
        message = "one design cannot be compared" if designs else "no design is named"
        raise UsageError(Diagnostic(message, "name two or more"))
    if len(designs) > MOST:
        raise UsageError(Diagnostic(f"{len(designs)} designs are too many", f"name up to {MOST}"))
    if sum(one == "-" for one in designs if isinstance(one, str)) > 1:
        raise UsageError(Diagnostic("standard input holds one design", "name - once"))
    found: list[tuple[Evaluation, str]] = []
    faults: list[Diagnostic] = []
    for one in designs:
        try:
            found.append(_evaluated(one, set, plugins))
        except InputError as error:
            faults += error.diagnostics
    if faults:
        raise InputError(faults)
    try:
        return comparison.compare([e for e, _ in found], _told([origin for _, origin in found]))
    except InputError as error:
        remedy = "name designs that differ"
        raise InputError(Diagnostic(error.diagnostics[0].message, remedy)) from None


def _told(origins: Sequence[str]) -> list[str]:
    """Origins, numbered where one stands twice."""
    return [
        f"{one} ({origins[: k + 1].count(one)})" if origins.count(one) > 1 else one
        for k, one in enumerate(origins)
    ]


def _evaluated(one: Any, set: Any, plugins: Plugins) -> tuple[Evaluation, str]:
    """The evaluation of whatever names a design, and where it comes from."""
    from ..optimisation.result import Optimisation

    if isinstance(one, (str, Path)) and not run_store.is_name(str(one)):
        actuator = read(one, set=set, plugins=plugins)
        name = str(one) if "\n" not in str(one) else file_name(actuator.design, actuator.source)
        return evaluate(actuator), "<stdin>" if name == "-" else name
    if isinstance(one, (str, Path, Run)):
        if set:
            message = "--set: a run is compared as it was"
            raise UsageError(Diagnostic(message, "name designs instead"))
        back: Restored = restore(one, plugins=plugins)
        return back.optimisation.best_evaluation, f"run {back.run.id}"
    if isinstance(one, Optimisation):
        return one.best_evaluation, f"{one.best_evaluation.name}, optimised"
    if isinstance(one, Evaluation):
        return one, one.name
    name = file_name(one.design, one.source) if isinstance(one, Actuator) else one.name
    return evaluate(one, plugins=plugins), name


def comparison_json(found: Comparison) -> dict[str, Any]:
    """The `compare --json` object (SI)."""
    from ..reporting.compare_text import sentences

    said = sentences(found)
    answers = {
        question.name: {
            "metric": question.metric,
            "best": None if question.best is None else found.labels[question.best],
            "than": None if question.other is None else found.labels[question.other],
            "values": list(question.values),
            "parts": [{"part": part, "change": step} for part, step in question.steps],
            "sentence": sentence,
        }
        for question, sentence in zip(found.questions, said, strict=False)
    }
    return found.to_dict() | {"answers": answers, "notes": said[len(answers) :]}


def draw_comparison(found: Comparison, folder: str | Path = "reports") -> list[Path]:
    """Write PNG and SVG of a comparison.

    ``comparison``: mass, compliance and friction part by part; ``comparison-stiffness``: the
    stiffness over the stroke of the first six designs, where any has it.
    """
    from ..reporting.compare_figure import comparison_figure, comparison_ucurves
    from ..reporting.image import write_ink

    paths = write_ink(comparison_figure(found), Path(folder), "comparison")
    curves = comparison_ucurves(found)
    if curves is not None:
        paths += write_ink(curves, Path(folder), "comparison-stiffness")
    return paths
