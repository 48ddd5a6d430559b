"""`compare`: shows designs and recorded runs side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base import runs as run_store
from ..base.arguments import SetValues, guarded
from ..base.errors import Diagnostic, InputError, UsageError
from ..design import Design
from ..evaluation import Evaluation, comparison
from ..evaluation.comparison import Comparison, DesignState
from .actuator import Actuator, Plugins, is_optimum, read
from .optimum import evaluate
from .recorded_runs import Run
from .reports import ReportArguments, file_name, report_files
from .restoring import Restored, restore

if TYPE_CHECKING:
    from ..optimisation.result import Optimisation
    from ..pages import ReportFile

MOST = 12
"""Maximum number of designs to compare: our choice."""


@guarded
def compare(
    *designs: Actuator | Design | Evaluation | Optimisation | Run | str | Path,
    set: SetValues = (),
    plugins: Plugins = (),
    optimise: bool = False,
    seed: int = 0,
) -> Comparison:
    """Compare designs: how their inputs differ, and which parts make a design better.

    Parameters
    ----------
    designs : two or more: files, recorded runs (id, ``last``), or results of other functions; the
        first is the reference
    set : values to replace in every file
    plugins : the user's own metrics
    optimise : whether to optimise every design first if it has variables and is not yet an optimum
    seed : seed of these optimisations

    Raises
    ------
    UsageError : fewer than two designs, or more than `MOST`
    InputError : a design cannot be read, or two are the same; lists every fault of every file
    """
    if len(designs) < 2:
        message = "one design cannot be compared" if designs else "no design is named"
        raise UsageError(Diagnostic(message, "name two or more"))
    if len(designs) > MOST:
        raise UsageError(Diagnostic(f"{len(designs)} designs are too many", f"name up to {MOST}"))
    if sum(design == "-" for design in designs if isinstance(design, str)) > 1:
        raise UsageError(Diagnostic("standard input can only give one design", "name - once"))
    resolved: list[tuple[Evaluation, str, DesignState]] = []
    faults: list[Diagnostic] = []
    for design in designs:
        try:
            resolved.append(_resolved(design, set, plugins, optimise, seed))
        except InputError as error:
            faults += error.diagnostics
    if faults:
        raise InputError(faults)
    try:
        evaluations, origins, states = zip(*resolved, strict=True)
        return comparison.compare(evaluations, _numbered(origins), states)
    except InputError as error:
        remedy = "name designs that differ"
        raise InputError(Diagnostic(error.diagnostics[0].message, remedy)) from None


def _numbered(origins: Sequence[str]) -> list[str]:
    """The origins of the designs; if several designs have the same origin, a number is added."""
    return [
        f"{origin} ({origins[: k + 1].count(origin)})" if origins.count(origin) > 1 else origin
        for k, origin in enumerate(origins)
    ]


def _resolved(
    design: Any, set: Any, plugins: Plugins, optimise: bool, seed: int
) -> tuple[Evaluation, str, DesignState]:
    """The evaluation of a design, where the design came from, and whether it is an optimum."""
    from ..optimisation.result import Optimisation
    from . import optimum

    if isinstance(design, (str, Path)) and not run_store.is_name(str(design)):
        design, name = _file(design, set, plugins)
    elif isinstance(design, (str, Path, Run)):
        if set:
            message = "--set: a recorded run cannot be changed"
            raise UsageError(Diagnostic(message, "name designs instead"))
        restored: Restored = restore(design, plugins=plugins)
        design, name = restored.optimisation, f"run {restored.run.id}"
    elif isinstance(design, Optimisation):
        name = design.best_evaluation.name
    elif isinstance(design, Actuator):
        name = file_name(design.design, design.source)
    else:
        name = design.name
    if not isinstance(design, Optimisation):
        evaluation = design if isinstance(design, Evaluation) else evaluate(design, plugins=plugins)
        has_file = isinstance(design, Actuator) and design.source is not None
        if has_file and is_optimum(design.source.text, evaluation.spec_hash):
            return evaluation, name, DesignState("optimal", optimum=True)
        if not (optimise and evaluation.design.variables):
            return evaluation, name, DesignState()
        start = design if isinstance(design, Actuator) else evaluation.design
        design = optimum.optimise(start, plugins=plugins, prices=False, seed=seed)
    return design.best_evaluation, name, DesignState(design.status, optimum=design.optimum)


def _file(source: str | Path, set: Any, plugins: Plugins) -> tuple[Actuator, str]:
    """A design read from a file or a text, and where it came from."""
    actuator = read(source, set=set, plugins=plugins)
    name = str(source) if "\n" not in str(source) else file_name(actuator.design, actuator.source)
    return actuator, "<stdin>" if name == "-" else name


@guarded
def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """The `compare --json` object (SI)."""
    from ..pages import comparison as page

    sentences = page.sentences(comparison)
    answers = {
        question.name: {
            "metric": question.metric,
            "best": None if question.best is None else comparison.labels[question.best],
            "than": None if question.other is None else comparison.labels[question.other],
            "values": list(question.values),
            "parts": [{"part": part, "change": step} for part, step in question.steps],
            "sentence": sentence,
        }
        for question, sentence in zip(comparison.questions, sentences, strict=False)
    }
    return comparison.to_dict() | {"answers": answers, "notes": sentences[len(answers) :]}


def report_comparison(comparison: Comparison, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the report of a comparison: figures without a title block, or HTML, or both."""
    folder, form = Path(paper.get("folder", "reports")), paper.get("format", "pdf")
    files = [] if form == "html" else report_files(draw_comparison(comparison, folder))
    if form == "pdf":
        return files
    from ..pages.comparison import page
    from ..rendering import html

    return files + html.write(page(comparison), None, folder=folder, stem="comparison")


@guarded
def draw_comparison(comparison: Comparison, folder: str | Path = "reports") -> list[Path]:
    """Write the figures of a comparison as PNG and SVG.

    The figure ``comparison`` shows mass, compliance and friction part by part. The figure
    ``comparison-stiffness`` shows the stiffness along the stroke for the first six designs, if at
    least one design has a stiffness.
    """
    from ..pages.comparison import comparison_figure, comparison_ucurves
    from ..rendering.paper import write_ink

    paths = write_ink(comparison_figure(comparison), Path(folder), "comparison")
    curves = comparison_ucurves(comparison)
    if curves is not None:
        paths += write_ink(curves, Path(folder), "comparison-stiffness")
    return paths
