"""The studio as one file without a server: the recorded design, and a page that solves it.

The page contains two programs (`base.symbolic.program`): objective and margins, which the search
evaluates, and what the page shows. Their inputs are the free dimensions and all numbers that the
models read. So a design has an offline page only if its models can be recorded, and a number has a
slider only if changing it in the program equals changing it in the file.
"""

from __future__ import annotations

import hashlib
import re
import struct
import zlib
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..api.sessions import Session
from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import ActuatorError, Diagnostic, InputError, UsageError
from ..base.files import write_text
from ..base.numeric import Array, namespace
from ..base.symbolic.program import OPERATIONS
from ..base.symbolic.program_store import Recording
from ..base.symbolic.recorded import RecordedFunction
from ..base.tables import encoded
from ..design import quantity_of
from ..design.paths import words_of
from ..evaluation import PreparedDesign, compute
from ..evaluation.limits import ALL_CASES, LimitRow, MetricLimit
from ..evaluation.outline_templates import Template, sizes_of, template_of
from ..evaluation.recorded_models import recorded_models
from ..metrics import term_of
from ..optimisation.actuator import ActuatorProblem, build, margins
from ..optimisation.resolve.steps import Valley
from ..optimisation.warm_start import AGREES
from ..rendering import text
from ..version import VERSION
from . import section
from .model import Studio, plain_words, scale_of
from .page import GENERATOR, offline_page

LARGEST = 400_000
"""Largest offline page in bytes: a mail attachment that every mailbox takes (our choice)."""
REACHES = (0.5, 0.25)
"""Shares of a number by which its slider may reach up and down; the first that the program covers
is taken. A slider of the page spans a quarter; typing goes further."""


@dataclass(frozen=True, slots=True)
class OfflineFile:
    """An offline page that was written: path, hash and size in bytes."""

    path: Path
    sha256: str
    size: int

    def to_dict(self) -> dict[str, Any]:
        """The JSON form."""
        return {"path": str(self.path), "sha256": self.sha256, "bytes": self.size}


def write_offline(studio: Studio, target: Path) -> OfflineFile:
    """Write the offline page of a studio's design; an earlier offline page is replaced.

    Raises
    ------
    UsageError : the design cannot have an offline page
    InputError : the file exists and is no offline page, or cannot be written
    """
    require_own(target)
    content = page_of(studio)
    path = write_text(target, content)
    data = content.encode()
    return OfflineFile(path, hashlib.sha256(data).hexdigest(), len(data))


def require_own(target: Path) -> None:
    """Refuse to replace a file that is no offline page; raises `InputError`."""
    if not target.is_file():
        return
    with target.open("rb") as stream:
        own = GENERATOR.encode() in stream.read(1000)
    if not own:
        message = "exists, and is no offline page of the studio"
        raise InputError(Diagnostic(message, "choose another name", str(target)))


def page_of(studio: Studio) -> str:
    """The offline page of a studio's design as HTML.

    Raises
    ------
    UsageError : the design cannot have an offline page
    """
    recorded = _RecordedDesign(studio, _session_of(studio))
    described = studio.describe()
    optimum = recorded.session.optimum
    data = recorded.data() | {"design": described | recorded.sliders(described["numbers"])}
    data["design"]["command"] = ["actuator-opt", "optimise", *studio.words]
    html = offline_page(
        name=described["name"],
        made=f"actuator-opt {VERSION}, design {optimum.evaluation.spec_hash[:16]}",
        data=_packed(data, [recorded.rows, recorded.drawn]),
    )
    if len(html.encode()) > LARGEST:
        size = f"{len(html.encode()) // 1000} kB, more than {LARGEST // 1000} kB"
        raise _refused(f"its page would have {size}", "use the studio itself")
    return html


def _refused(reason: str, remedy: str) -> UsageError:
    return UsageError(Diagnostic(f"this design has no offline page: {reason}", remedy))


def _session_of(studio: Studio) -> Session:
    """The session of a design that can be offline."""
    design, subject = studio.actuator.design, studio.actuator.subject()
    live = "use the studio itself, which runs all models"
    if studio.session is None:
        raise _refused("no design meets its requirements", "run optimise, which says what to relax")
    if design.duty is not None:
        raise _refused("the models of its duty cycles are not recorded", live)
    if subject.films:
        raise _refused("its oil films are tables for the given numbers", live)
    if subject.plugins:
        names = ", ".join(plugin.name for plugin in subject.plugins)
        raise _refused(f"custom metrics ({names}) are Python code", live)
    if studio.session.problem.goal.single is None:
        raise _refused("its objective is a weighted sum, whose weights depend on the design", live)
    rough = studio.session.rough_gradients
    if rough:
        raise _refused(f"gradients of {', '.join(rough[:3])} need finite differences", live)
    return studio.session


class _RecordedDesign:
    """The two programs of a design at its optimum, and the data that their page needs."""

    def __init__(self, studio: Studio, session: Session) -> None:
        self.studio, self.session, self.problem = studio, session, session.problem
        paths, x = self.problem.paths, session.valleys[0].point.x
        assert self.problem.recorded is not None
        known = self.problem.recorded
        self.present = np.concatenate([x, known.present[len(paths) :]])
        self.names = known.names
        subject = self.problem.subject
        numbers = subject.values({p: np.array([v, v]) for p, v in zip(paths, x, strict=True)})
        run = compute(subject, numbers)
        self.masses = tuple(run.mass_parts)
        self.limits = tuple(
            dict.fromkeys(row.limit_of for row in (*self.problem.rows, *self.problem.fixed))
        )
        template = template_of(subject, dict(zip(paths, map(float, x), strict=True)))
        self.template, self.used = template, np.flatnonzero(template.slopes.any(axis=0))
        self.rows = self._recorded(known)
        shown = recorded_models(
            self._shown, subject=subject, paths=paths, read=numbers.read.union(self.names),
            limits=(*self.problem.rows, *self.problem.fixed), goals=["offline"],
        )  # fmt: skip
        if shown.names != self.names:
            raise _refused("its recorded models read other numbers", "use the studio itself")
        self.drawn = self._recorded(shown)

    def _recorded(self, function: RecordedFunction) -> Recording:
        """The recording of a function that covers the optimum."""
        fresh = RecordedFunction(
            function.function, function.names, self.present, function.structure
        )
        with np.errstate(all="ignore"):
            fresh(self.present[:, None])
        if fresh.recording is None:
            raise _refused(fresh.reason, "use the studio itself, which runs all models")
        return fresh.recording

    def _shown(
        self, subject: PreparedDesign, points: Array, varied: Mapping[str, Array]
    ) -> tuple[tuple[()], Array]:
        """What the page shows: masses, sizes of the drawing, limits, fixed margins, lengths."""
        count = points.shape[1]
        numbers = subject.values(dict(varied) | dict(zip(self.problem.paths, points, strict=True)))
        run = compute(subject, numbers)
        sizes, g = sizes_of(run.geometry), run.geometry
        values = [*(run.mass_parts[part] for part in self.masses), *(sizes[k] for k in self.used)]
        values += [limit.value(numbers) for limit in self.limits]
        fixed = margins(self.problem.fixed, run.computed, numbers, count, subject.reserves)
        values += [*fixed, g.bore, g.rod_diameter, g.closed_length]
        xp = namespace(*values)
        rows = [xp.broadcast_to(xp.asarray(value).reshape(-1), (count,)) for value in values]
        return (), xp.stack(rows)

    def data(self) -> dict[str, Any]:
        """Data of the page for its worker, without the description of the design."""
        problem, count = self.problem, len(self.problem.paths)
        paths = problem.paths
        labels = [plain_words(f"{row.label}") for row in problem.rows]
        labels += [plain_words(f"{path} {side}") for side in ("lower", "upper") for path in paths
                   if problem.problem.upper[paths.index(path)] > problem.problem.lower[paths.index(path)]]
        return {
            "problem": {
                "lower": problem.problem.lower.tolist(),
                "upper": problem.problem.upper.tolist(),
                "rows": self.rows.rows,
                "answers": self.rows.answers.astype(int).tolist(),
            },
            "present": self.present[count:].tolist(),
            "paths": list(self.names[count:]),
            "valleys": [_valley(valley) for valley in self.session.valleys],
            "labels": labels,
            "masses": [part.replace("_", " ") for part in self.masses],
            "limits": list(self._limits()),
            "fixed": [row.limit_of.origin != "check" for row in problem.fixed],
            "lengths": list(section.LENGTHS.values()),
            "section": self._section(),
        }

    def _section(self) -> dict[str, Any]:
        template, used = self.template, self.used
        slopes = template.slopes[: -4, used] * section.MM
        rows, places = np.nonzero(slopes)
        return {
            "parts": section.parts(template.outlines),
            "zero": np.round(section.MM * template.numbers[:-4], 5).tolist(),
            "origin": template.origin[used].tolist(),
            "slopes": [
                [int(row), int(k), float(f"{slopes[row, k]:.8g}")]
                for row, k in zip(rows, places, strict=True)
            ],
        }

    def _limits(self) -> Iterator[dict[str, Any]]:
        """Every limit with its rows, as the list of what holds the design shows it."""
        evaluation, problem = self.session.optimum.evaluation, self.problem
        listed = {(row.metric, row.sense) for row in evaluation.requirements}
        listed |= {(row.metric, row.sense) for row in evaluation.checks if not row.advice}
        sizes = problem.scales or (1.0,) * len(problem.rows)
        for limit in self.limits:
            own = (limit.metric, limit.sense) in listed
            rows = [k for k, row in enumerate(problem.rows) if own and row.limit_of is limit]
            fixed = [k for k, row in enumerate(problem.fixed) if own and row.limit_of is limit]
            found = [*(problem.rows[k] for k in rows), *(problem.fixed[k] for k in fixed)]
            yield {
                "name": term_of(limit.metric),
                "sense": limit.sense,
                "rows": [k + 1 for k in rows],
                "fixed": fixed,
                "where": [_where(row) for row in found],
                "size": max((sizes[k] for k in rows), default=1.0),
                **scale_of(text.metric(limit.metric)),
            }

    def sliders(self, numbers: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """The numbers that the page can change, their units, and a line on the others."""
        rows, others, dimensions = [], [], set()
        for row in numbers:
            reach = self._reach(row)
            if reach is None:
                others.append(row["label"])
                continue
            dimension = quantity_of(row["path"], self.problem.subject.design).dimension
            dimensions.add(dimension)
            rows.append({**row, "dimension": dimension, "lower": reach[0], "upper": reach[1]})
        left_out = ""
        if others:
            left_out = "No slider here, as a change also affects other inputs: " + ", ".join(others)
        tables = {
            name: {
                one: [unit.to_si(1.0) - unit.offset, unit.offset]
                for one in units.units_of(name)
                for unit in [units.unit(one, name)]
            }
            for name in sorted(dimensions)
        }
        return {"numbers": rows, "units": tables, "left_out": left_out}

    def _reach(self, row: Mapping[str, Any]) -> tuple[float, float] | None:
        """Values between which the program follows a number; None if it does not."""
        path, value = row["path"], row["value"]
        if path not in self.names or not self.session.only_read(path, value):
            return None
        quantity = quantity_of(path, self.problem.subject.design)
        for share in REACHES:
            room = abs(share * (row["factor"] * value + row["offset"]) / row["factor"])
            ends = max(value - room, quantity.lower), min(value + room, quantity.upper)
            if all(self._follows(path, end) for end in ends):
                return ends
        return None

    def _follows(self, path: str, value: float) -> bool:
        """Whether the program with a changed number equals the problem built with it."""
        problem, x = self.problem, self.session.valleys[0].point.x[:, None]
        try:
            changed = build(self.studio.actuator.changed({path: value}).subject())
        except ActuatorError:
            return False
        labels = [sorted(row.label for row in (*p.rows, *p.fixed)) for p in (problem, changed)]
        same_box = np.array_equal(problem.problem.lower, changed.problem.lower)
        same_box &= np.array_equal(problem.problem.upper, changed.problem.upper)
        if labels[0] != labels[1] or not same_box:
            return False
        rebuilt = replace(changed, rows=problem.rows, scales=problem.scales)
        inputs = np.concatenate([x[:, 0], self.present[len(x) :]])
        inputs[self.names.index(path)] = value
        ours = self.rows.program.values(inputs[None])
        theirs = rebuilt.by_models(x, {})
        expected = np.concatenate([np.atleast_1d(theirs.objective), theirs.constraints[:, 0]])
        same = np.allclose(
            ours[0, : self.rows.rows], expected, rtol=AGREES, atol=AGREES, equal_nan=True
        )
        return same and bool(self.rows.holds(ours)[0])


def _where(row: LimitRow) -> str:
    return text.brief(None if row.case == ALL_CASES else row.case, row.place)


def _valley(valley: Valley) -> dict[str, Any]:
    """A local optimum as the page stores it; prices by place, without zeros."""
    prices = np.zeros(0) if valley.prices is None else valley.prices
    return {
        "z": valley.point.z.tolist(),
        "hessian": [row.tolist() for row in valley.hessian],
        "scale": valley.scale,
        "price": valley.price,
        "prices": [[int(k), float(prices[k])] for k in np.flatnonzero(prices)],
    }


_ARRAYS = {"code": "<u2", "extra": "<i4", "outputs": "<i4", "frozen": "u1", "constants": "<f8"}
"""Arrays of a program in their order, with the type of their elements."""


def _packed(data: Mapping[str, Any], recordings: Sequence[Recording]) -> str:
    """Data and programs, compressed, as letters of base64.

    The code is stored by columns, which compress to half the size of rows.
    """
    programs = [recording.program for recording in recordings]
    heads = [
        {
            "operations": list(OPERATIONS),
            "slots": program.slots,
            "inputs": program.inputs,
            "sizes": {name: int(getattr(program, name).size) for name in _ARRAYS},
        }
        for program in programs
    ]
    json = encoded(
        {**data, "programs": heads}, ensure_ascii=False, separators=(",", ":")
    ).encode()
    arrays = [
        np.ascontiguousarray(getattr(program, name).T, dtype=kind).tobytes()
        for program in programs
        for name, kind in _ARRAYS.items()
    ]
    whole = struct.pack("<I", len(json)) + json + b"".join(arrays)
    return b64encode(zlib.compress(whole, 9)).decode("ascii")
