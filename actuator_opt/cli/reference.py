"""Commands that look names up: `explain` and `list`."""

from __future__ import annotations

from collections.abc import Sequence
from os.path import isfile
from typing import Annotated

import typer

from ..base.errors import Diagnostic, ExitCode, UsageError
from . import streams
from .job import Job
from .options import REPORTS, Json, PluginFile, Quiet, Set, Unset, UnusedOut, UnusedSeed

Words = Annotated[
    list[str],
    typer.Argument(
        metavar="X [DESIGN]",
        help="PATH, metric, check, material, joint, seal type, friction law or term; then the "
        "design file whose value and influences are shown, or - for stdin.",
    ),
]
Listed = Annotated[
    list[str],
    typer.Argument(
        metavar="KIND [DESIGN] [WORD]",
        help="paths, metrics, checks, materials, joints, seals, laws, properties or terms; then "
        "the design file whose values are shown, or - for stdin; then a word that keeps only "
        "entries near to it.",
    ),
]


def _is_design(word: str) -> bool:
    """Whether an argument names a design file."""
    return word == "-" or word.lower().endswith((".yaml", ".yml")) or isfile(word)


def _parted(words: Sequence[str], job: Job) -> tuple[str | None, list[str]]:
    """The design among the words after the first, and all other words.

    Two designs, or ``--set`` or ``--unset`` without a design, are refused.
    """
    files = [word for word in words[1:] if _is_design(word)]
    if len(files) > 1:
        raise UsageError(Diagnostic(f"{files[1]}: a second design", "name one design"))
    if job.changing and not files:
        raise UsageError(Diagnostic(f"{job.changing}: there is no design", "name a design file"))
    others = [word for k, word in enumerate(words) if k == 0 or word not in files]
    return (files[0] if files else None), others


def explain(
    words: Words,
    sets: Set = None,
    unset: Unset = None,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
    out: UnusedOut = REPORTS,
    seed: UnusedSeed = 0,
) -> ExitCode:
    """Explain a name: meaning, value, influences, source."""
    from .. import api as verbs

    job = Job(sets=sets, unset=unset, as_json=as_json, quiet=quiet)
    design, others = _parted(words, job)
    options = {"set": job.set, "plugins": plugin or []}
    explanation = job.run(verbs.explain, " ".join(others), design, **options)
    job.answer(explanation.to_dict, lambda: explanation.text(**streams.style()))
    return ExitCode.MET


def list_names(
    words: Listed,
    sets: Set = None,
    unset: Unset = None,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
    out: UnusedOut = REPORTS,
    seed: UnusedSeed = 0,
) -> ExitCode:
    """List names with value, unit and meaning.

    In a pipe, tabs part the columns.
    """
    from .. import api as verbs

    job = Job(sets=sets, unset=unset, as_json=as_json, quiet=quiet)
    design, others = _parted(words, job)
    options = {"set": job.set, "plugins": plugin or []}
    listed = job.run(verbs.catalogue, others[0], design, " ".join(others[1:]), **options)

    def text() -> str:
        return listed.text(**streams.style()) if streams.terminal() else listed.tsv()

    job.answer(listed.to_dict, text)
    return ExitCode.MET
