"""The studio as one file without a server: the recorded design, and a page that solves it.

The page contains two programs (`base.symbolic.program`): objective and margins, which the search
evaluates, and what the page shows. Their inputs are the free dimensions and all numbers that the
models read. So a design has an offline page only if its models can be recorded, and a number has a
slider only if changing it in the program equals changing it in the file.
"""

from __future__ import annotations

import hashlib
import struct
import zlib
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..api import Actuator, Session, read
from ..base import units
from ..base.arguments import Change
from ..base.dataclass import dataclass
from ..base.errors import ActuatorError, Diagnostic, InputError, UsageError
from ..base.files import write_text
from ..base.numeric import Array, namespace
from ..base.symbolic.program import OPERATIONS, Program
from ..base.symbolic.program_store import Recording
from ..base.symbolic.recorded import RecordedFunction
from ..base.tables import encoded
from ..design import quantity_of
from ..evaluation import PreparedDesign, compute, prepare
from ..evaluation.limits import ALL_CASES, LimitRow, all_limits, rows_of
from ..evaluation.outline_templates import sizes_of, template_of
from ..evaluation.recorded_models import recorded_models
from ..explorer import part_of_section
from ..metrics import term_of
from ..optimisation.actuator import bounded_margin, margins
from ..optimisation.resolve.steps import Valley
from ..optimisation.warm_start import AGREES
from ..rendering import text
from ..version import VERSION
from . import section
from .model import Studio, plain_words, scale_of
from .page import GENERATOR, offline_page

LARGEST = 400_000
"""Largest offline page in bytes: a mail attachment that every mailbox takes (our choice)."""
ABOUT = "drag a limit of this design, and the best design follows; works without network"
"""Use of the page, in words for a report."""
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


def write_offline(
    target: Path,
    path: str,
    *,
    set: Sequence[Change] = (),
    plugins: Sequence[Path] = (),
    seed: int = 0,
) -> OfflineFile:
    """Write the offline page of a design; an earlier offline page is replaced.

    Parameters
    ----------
    target : file of the page
    path, set, plugins, seed : as for `Studio`

    Raises
    ------
    UsageError : the design cannot have an offline page
    InputError : the file exists and is no offline page, or cannot be written; the design has faults
    """
    require_own(target)
    content = page_of(path, set=set, plugins=plugins, seed=seed)
    data = content.encode()
    return OfflineFile(write_text(target, content), hashlib.sha256(data).hexdigest(), len(data))


def require_own(target: Path) -> None:
    """Refuse to replace a file that is no offline page; raises `InputError`."""
    if not target.is_file():
        return
    with target.open("rb") as stream:
        own = GENERATOR.encode() in stream.read(1000)
    if not own:
        message = "exists, and is no offline page of the studio"
        raise InputError(Diagnostic(message, "choose another name", str(target)))


def page_of(
    path: str,
    *,
    set: Sequence[Change] = (),
    plugins: Sequence[Path] = (),
    seed: int = 0,
) -> str:
    """The offline page of a design as HTML; parameters as for `Studio`.

    Raises
    ------
    UsageError : the design cannot have an offline page
    InputError : the design has faults
    """
    if path == "-":
        message = "the offline page names the file of its design, so it needs a file"
        raise UsageError(Diagnostic(message, "name a design file"))
    _require_recordable(read(path, set=set, plugins=plugins))
    studio = Studio(path, set=set, plugins=plugins, seed=seed)
    recorded = _RecordedDesign(studio, _session_of(studio))
    described = studio.describe() | {"best": []}  # the best of another limit needs a second program
    optimum = recorded.session.optimum
    data = recorded.data() | {"design": described | recorded.sliders(described["numbers"])}
    words = [described["file"], *studio.words[1:]]  # the folder is nobody else's business
    data["design"]["command"] = ["actuator-opt", "optimise", *words]
    html = offline_page(
        name=described["name"],
        made=f"actuator-opt {VERSION}, design {optimum.evaluation.spec_hash[:16]}",
        data=_packed(data, [recorded.rows, recorded.drawn]),
    )
    if len(html.encode()) > LARGEST:
        size = f"{len(html.encode()) // 1000} kB, more than {LARGEST // 1000} kB"
        raise _refused(f"its page would have {size}", LIVE)
    return html


def _refused(reason: str, remedy: str) -> UsageError:
    return UsageError(Diagnostic(f"this design has no offline page: {reason}", remedy))


LIVE = "use the studio itself, which runs all models"
"""Remedy for a design without an offline page."""


def _require_recordable(actuator: Actuator) -> None:
    """Refuse a design with parts that no program of the page can contain."""
    if actuator.design.duty is not None:
        raise _refused("the models of its duty cycles are not recorded", LIVE)
    if actuator.plugins:
        names = ", ".join(plugin.name for plugin in actuator.plugins)
        raise _refused(f"its custom metrics ({names}) are Python code", LIVE)
    if actuator.subject().films:
        raise _refused("its oil films are tables for the given numbers", LIVE)


def _session_of(studio: Studio) -> Session:
    """The session of a design that can be offline."""
    session = studio.session
    if session is None:
        raise _refused("no design meets its requirements", "run optimise, which says what to relax")
    if session.problem.goal.single is None:
        raise _refused("its objective is a weighted sum, whose weights depend on the design", LIVE)
    if session.rough_gradients:
        names = ", ".join(session.rough_gradients[:3])
        raise _refused(f"gradients of {names} need finite differences", LIVE)
    return session


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
        self.labels = {row.label for row in (*self.problem.rows, *self.problem.fixed)}
        self.asked = [x for x in all_limits(subject.design) if x.origin != "advice"]
        self.template = template_of(prepare(session.optimum.design))
        self.used = np.flatnonzero(self.template.slopes.any(axis=0))
        self.rows = self._recorded(known)
        shown = recorded_models(
            self._shown, subject=subject, paths=paths, read=numbers.read.union(self.names),
            limits=(*self.problem.rows, *self.problem.fixed), goals=["offline"],
        )  # fmt: skip
        if shown.names != self.names:
            raise _refused("its recorded models read other numbers", LIVE)
        self.drawn = self._recorded(shown)

    def _recorded(self, function: RecordedFunction) -> Recording:
        """The recording of a function that covers the optimum."""
        fresh = RecordedFunction(
            function.function, function.names, self.present, function.structure
        )
        with np.errstate(all="ignore"):
            fresh(self.present[:, None])
        if fresh.recording is None:
            raise _refused(fresh.reason, LIVE)
        return fresh.recording

    def _shown(
        self, subject: PreparedDesign, points: Array, varied: Mapping[str, Array]
    ) -> tuple[tuple[()], Array]:
        """Numbers shown: masses, sizes of the drawing, limits, fixed margins, lengths."""
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
        problem, box = self.problem, self.problem.problem
        free = [name for k, name in enumerate(problem.paths) if box.upper[k] > box.lower[k]]
        labels = [row.label for row in problem.rows]
        labels += [f"{name} {side}" for side in ("lower", "upper") for name in free]
        return {
            "problem": {
                "lower": box.lower.tolist(),
                "upper": box.upper.tolist(),
                "rows": self.rows.rows,
                "answers": self.rows.answers.astype(int).tolist(),
            },
            "present": self.present[len(box.names) :].tolist(),
            "paths": list(self.names[len(box.names) :]),
            "valleys": [_valley(valley) for valley in self.session.valleys],
            "labels": [plain_words(label) for label in labels],
            "masses": [part.replace("_", " ") for part in self.masses],
            "limits": list(self._limits()),
            "fixed": [row.limit_of.origin != "check" for row in problem.fixed],
            "lengths": list(section.LENGTHS.values()),
            "section": self._section(),
        }

    def _section(self) -> dict[str, Any]:
        template, used = self.template, self.used
        slopes = template.slopes[:-4, used] * section.MM
        rows, places = np.nonzero(slopes)
        return {
            "parts": [part_of_section(outline) for outline in template.outlines],
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
        listed: set[tuple[str | None, str | None]]
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
        if row["whole"] or path not in self.names or not self.session.only_read(path, value):
            return None
        quantity = quantity_of(path, self.problem.subject.design)
        for share in REACHES:
            room = abs(share * row["size"] / row["factor"])
            ends = max(value - room, quantity.lower), min(value + room, quantity.upper)
            if all(self._follows(path, end) for end in ends):
                return ends
        return None

    def _follows(self, path: str, value: float) -> bool:
        """Whether the program with a changed number equals the problem built with it."""
        problem, x = self.problem, self.session.valleys[0].point.x[:, None]
        try:
            changed = self.studio.actuator.changed({path: value}).subject()
        except ActuatorError:
            return False
        subject = replace(changed, windows=True, lenient=True)
        numbers = subject.values(dict(zip(problem.paths, x, strict=True)))
        run = compute(subject, numbers)
        found = [row for limit in self.asked for row in rows_of(limit, run.computed, numbers)]
        rows = {row.label: row for row in found}
        if rows.keys() != self.labels:
            return False
        inputs = np.concatenate([x[:, 0], self.present[len(x) :]])
        inputs[self.names.index(path)] = value
        ours = self.rows.program.values(inputs[None])
        sizes = problem.scales or (1.0,) * len(problem.rows)
        sized = zip((rows[row.label] for row in problem.rows), sizes, strict=True)
        margin = [np.squeeze(row.margin) / (1.0 if row.limit else size) for row, size in sized]
        objective = np.squeeze(problem.goal.value(run.computed, subject.cases))
        expected = np.append(objective, bounded_margin(np.array(margin, dtype=float)))
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


_ARRAYS = {"extra": "<i4", "outputs": "<i4", "frozen": "u1", "constants": "<f8"}
"""Arrays of a program after its code, in their order, with the type of their elements."""
_PLANES = (2, 2, 3, 3, 3)
"""Bytes of each number in the columns of the code: operation, result, three operands."""


def _packed(data: Mapping[str, Any], recordings: Sequence[Recording]) -> str:
    """Data and programs, compressed, as letters of base64; `opened` of the worker reads them."""
    programs = [recording.program for recording in recordings]
    heads = [
        {
            "operations": list(OPERATIONS),
            "slots": program.slots,
            "inputs": program.inputs,
            "instructions": len(program.code),
            "sizes": {name: int(getattr(program, name).size) for name in _ARRAYS},
        }
        for program in programs
    ]
    whole = {**data, "programs": heads}
    json = encoded(whole, ensure_ascii=False, separators=(",", ":")).encode()
    arrays = [part for program in programs for part in _arrays(program)]
    packed = zlib.compress(struct.pack("<I", len(json)) + json + b"".join(arrays), 9)
    return b64encode(packed).decode("ascii")


def _arrays(program: Program) -> Iterator[bytes]:
    """The arrays of a program; the code as columns of bytes, which compress to a third."""
    columns = [*program.code[:, :2].T, *_operands(program.code).T]
    for column, count in zip(columns, _PLANES, strict=True):
        for place in range(count):
            yield (column >> 8 * place).astype("u1").tobytes()
    for name, kind in _ARRAYS.items():
        yield np.ascontiguousarray(getattr(program, name), dtype=kind).tobytes()


def _operands(code: Array) -> Array:
    """Operands (instructions, 3) as distances, in which equal formulas look equal.

    Twice the number of instructions since the operand was computed; or twice its slot, plus 1, if
    it is an input, a constant, a root, or the operand of a root.
    """
    roots, result = OPERATIONS.index("roots"), 2 * code[:, 2:].astype(np.int32) + 1
    written: dict[int, int] = {}
    for k, (operation, slot, *operands) in enumerate(code.tolist()):
        if operation & 255 == roots:
            for root in range(slot, slot + 2 * operands[1]):
                written.pop(root, None)
            continue
        for j, operand in enumerate(operands):
            if operand in written:
                result[k, j] = 2 * (k - written[operand])
        written[slot] = k
    return result
