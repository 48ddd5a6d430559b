"""Optima, prices, curves and files for the page. Every answer is plain data in SI."""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from pathlib import Path
from typing import Any

from ..api import Actuator, Price, Session, optimise, read, report, results, session
from ..api.reports import saved_text
from ..api.variants import variant
from ..base.arguments import Change
from ..base.errors import Diagnostic, InputError, UsageError
from ..base.progress import watched
from ..base.quantities import Quantity
from ..design import Design, get, quantity_of
from ..design.paths import numbers
from ..design.writer import exact_text
from ..evaluation import Evaluation
from ..evaluation.result import Check, Requirement
from ..metrics import term_of
from ..optimisation.result import Optimisation
from ..rendering import text
from . import cycle, quick, section
from .saving import Saved, digest, save_text
from .trade import TradeOff, tradable
from .worker import Dropped, Stop

Numbers = Mapping[str, float | str]
"""Changed numbers by PATH, in SI or as text with a unit, relative to the design as read."""
CARD_WIDTH = 76
"""Characters of a line of the card that says what helps if nothing fits."""
SAME = 1e-6
"""Relative difference of two objectives up to which they count as equal (that of the solver)."""
STATED = ("requirements.", "load_cases[")
"""Beginnings of the PATHs of what is asked; all other numbers are fixed."""


class Studio:
    """A design file, its optimum, and what the page may do with them.

    Not safe for threads: the server calls it from one thread only (see `worker`).

    Parameters
    ----------
    path : the design file
    set, plugins : changed values and user metrics, as for `read`
    out : folder of reports
    seed : seed of the searches

    Raises
    ------
    InputError : the file has faults, or nothing is free to change
    UsageError : the design is not a file, or has choices or listed sizes
    """

    def __init__(
        self,
        path: str,
        *,
        set: Sequence[Change] = (),
        plugins: Sequence[Path] = (),
        out: Path = Path("reports"),
        seed: int = 0,
    ) -> None:
        if path == "-":
            message = "the studio saves beside the design, so it needs a file"
            raise UsageError(Diagnostic(message, "name a design file"))
        self.actuator: Actuator = read(path, set=set, plugins=plugins)
        self._file = Path(path).resolve()
        self._digest = digest(self._file)
        self._out, self._seed = out, seed
        self._words = [path, *_changing(set), *_options("--plugin", map(str, plugins))]
        self.present: dict[str, float] = {}
        """Changed numbers of the design that the page showed last."""
        self._last: tuple[dict[str, float], Optimisation] | None = None
        self._moved: tuple[dict[str, float], Session] | None = None
        self._trade: tuple[dict[str, float], str, TradeOff] | None = None
        self._base: dict[str, float] = {}
        self._session: Session | None = None
        self.searched = True
        """Whether the optimum was searched in the whole range, not only near another design."""
        self._opening = self._opened()

    def _opened(self) -> Optimisation:
        """Find the optimum of the design as read, or else its nearest miss."""
        try:
            self._session = session(self.actuator, seed=self._seed)
        except InputError:
            nearest = optimise(self.actuator, seed=self._seed, prices=False)  # or its fault
            if nearest.optimum or nearest.infeasibility is None:
                raise
            return nearest
        return self._session.optimum

    def variant(self, entries: Mapping[str, str | None], stop: Stop) -> Studio:
        """A studio of the same file with other words, such as a material or a joint.

        Parameters
        ----------
        entries : words by PATH, and None for keys to remove
        stop : true once nobody wants the answer

        Raises
        ------
        InputError : the words do not suit the design
        Dropped : `stop` became true
        """
        other = copy(self)
        other.actuator = self.actuator.changed(entries)
        other._words = [*self._words, *_changing(entries.items())]
        other.present, other._base, other._last = {}, {}, None
        other._moved = other._trade = None
        same = other.actuator.design.variables.keys() == self.actuator.design.variables.keys()
        other.searched = self._session is None or not same
        if self._session is None:
            other._opening = other._search({}, stop)
            if other._opening.optimum:
                other._session = session(other.actuator, seed=self._seed)
        else:
            kept = {path: value for path, value in self._relative({}).items() if path in entries}
            found = variant(self._session, {**kept, **entries}, stop=_dropping(stop))
            other._opening, other._session = found
        if stop():
            raise Dropped
        return other

    def search(self, stop: Stop) -> None:
        """Search the whole range for a better optimum than that found near another design."""
        if self.searched or self._session is None:
            self.searched = True
            return
        found = variant(self._session, {}, thorough=True, stop=_dropping(stop))
        if stop():
            raise Dropped
        sign = -1.0 if _maximises(self._opening) else 1.0
        gain = sign * (self._opening.objective_value - found.optimum.objective_value)
        if found.session is not None and gain > SAME * abs(self._opening.objective_value):
            self._opening, self._session = found
            self._last = self._moved = self._trade = None
        self.searched = True

    def same_file(self, other: Studio) -> None:
        """Take over what another studio of the same file knows of its content."""
        self._digest = other._digest

    # ---- what the page shows ----

    def describe(self) -> dict[str, Any]:
        """Names and numbers of the design that no wish changes."""
        design = self.actuator.design
        optimum = self._opening
        rows = [
            self._number(path, value)
            for path, value in numbers(design).items()
            if path not in design.variables and not path.startswith("materials.")
        ]
        stem = self._file.stem
        return {
            "name": design.name,
            "file": self._file.name,
            "suggested": f"{stem}_studio.yaml",
            "goal": _goal(optimum),
            "cycles": [x.name for x in design.duty.cycles] if design.duty is not None else [],
            "numbers": [row for row in rows if row is not None],
            "dimensions": [
                {
                    "path": row.path,
                    "label": quick.label_of(row.path),
                    "low": row.lower,
                    "high": row.upper,
                    **scale_of(quantity_of(row.path, design)),
                }
                for row in optimum.variables
            ],
            "best": [
                {"path": path, "label": f"best {term_of(metric.name)}"} | scale_of(metric.quantity)
                for path in self._tradable
                for metric in [optimum.evaluation.metrics[path.split(".")[1]]]
            ],
        }

    @property
    def _tradable(self) -> list[str]:
        """PATHs of the limits whose best value can be traced."""
        return tradable(self._opening.start, self._opening.evaluation)

    def _number(self, path: str, value: float) -> dict[str, Any] | None:
        """A number that the page can change; None for one that is not finite."""
        quantity = quantity_of(path, self.actuator.design)
        if not math.isfinite(value):
            return None
        label, sense = quick.label_of(path), ""
        if path.startswith("requirements."):
            sense = "≥" if path.endswith(".min") else "≤"
        elif path.startswith("load_cases["):
            case = path[len("load_cases[") :].partition("]")[0].replace("_", " ")
            label = f"{label.removesuffix(f' {case}')}, {case}"
        return {
            "path": path,
            "label": label,
            "sense": sense,
            "asked": path.startswith(STATED),
            "whole": quantity.dimension == "count",
            "value": value,
            "size": self._size(quantity, value),
            "lower": quantity.lower if math.isfinite(quantity.lower) else None,
            "upper": quantity.upper if math.isfinite(quantity.upper) else None,
            **scale_of(quantity),
        }

    def first(self, changes: Numbers, stop: Stop) -> dict[str, Any]:
        """The optimum with some numbers changed, at once; `solve` then evaluates its design.

        If the steps near the session's optimum reach none, the answer only says that a search is
        needed, which `solve` makes.

        Raises
        ------
        InputError, UsageError, Dropped : as for `solve`
        """
        changed = self._si(changes)
        if not changed or (self._last is not None and self._last[0] == changed):
            return self.solve(changed, stop)
        self.present = changed
        bare = None
        if self._session is not None:
            bare = self._session.bare_optimum(self._relative(changed), stop=_dropping(stop))
        if bare is None:
            return {"searching": True, "changes": changed}
        return {
            **quick.shown(bare),
            "feasible": True,
            "whole": False,
            "changed_on_disk": self.changed_on_disk(),
            "changes": changed,
        }

    def _size(self, quantity: Quantity, value: float) -> float:
        """Size of a number in its display unit, from which the page takes its range and its price.

        A zero has no size of its own. It gets that of the largest number of the same quantity in
        the design, or else of the same dimension, or else one display unit (our choice).
        """
        own = abs(quantity.to_display(value))
        if own:
            return own
        others = [
            (other.name == quantity.name, abs(quantity.to_display(number)))
            for path, number in numbers(self.actuator.design).items()
            for other in [quantity_of(path, self.actuator.design)]
            if other.dimension == quantity.dimension and math.isfinite(number)
        ]
        same = [size for alike, size in others if alike and size]
        return max(same or [size for _, size in others if size], default=1.0)

    def solve(self, changes: Numbers, stop: Stop, *, explain: bool = False) -> dict[str, Any]:
        """The optimum with some numbers changed; with `explain` also why nothing fits, if so.

        Raises
        ------
        InputError, UsageError : a PATH or a value does not suit the design
        Dropped : `stop` became true
        """
        changed = self._si(changes)
        result = self._optimum(changed, stop)
        card = {}
        if explain and not result.optimum:
            if result.infeasibility is None:
                result = self._search(changed, stop)
            if result.optimum:  # the long search found a design that the quick one missed
                self._last = changed, result
            else:
                card = {"card": self._card(result, changed)}
        self.present = changed
        return self._shown(result) | {"changes": changed} | card

    def _si(self, changes: Numbers) -> dict[str, float]:
        """The changes in SI, checked; without those that change nothing."""
        if not changes:
            return {}
        design = self.actuator.changed(changes).design
        found = {}
        for path in changes:
            if path in design.variables or path.startswith("variables."):
                message = "is a dimension that the search sets"
                raise UsageError(Diagnostic(message, "change a requirement instead", path=path))
            value = get(design, path)
            if isinstance(value, str) or value is None:
                raise UsageError(
                    Diagnostic("is a word", "edit the file, and open it again", path=path)
                )
            if value != get(self.actuator.design, path):
                found[path] = float(value)
        return found

    def _optimum(self, changed: dict[str, float], stop: Stop) -> Optimisation:
        if not changed:
            return self._opening
        if self._last is not None and self._last[0] == changed:
            return self._last[1]
        if self._session is None:
            return self._first(changed, stop)
        result = self._session.solve(self._relative(changed), stop=_dropping(stop))
        self._last = changed, result
        return result

    def _relative(self, changed: Mapping[str, float]) -> dict[str, float]:
        """The changes as seen from the session, which may stand at other numbers than the file."""
        as_read = {path: self._as_read(path) for path in self._base}
        return {**as_read, **changed}

    def _as_read(self, path: str) -> float:
        value = get(self.actuator.design, path)
        assert isinstance(value, float | int)
        return float(value)

    def _first(self, changed: dict[str, float], stop: Stop) -> Optimisation:
        """The optimum of a design whose file has none, found by a whole search."""
        result = self._search(changed, stop)
        if result.optimum:
            self._session = session(self.actuator.changed(changed), seed=self._seed)
            self._base = dict(changed)
            result = self._session.optimum
        self._last = changed, result
        return result

    def _search(self, changed: Mapping[str, float], stop: Stop) -> Optimisation:
        def watch(what: str, share: float | None) -> None:
            if stop():
                raise Dropped

        with watched(watch):
            return optimise(self.actuator.changed(changed), seed=self._seed, prices=False)

    def _card(self, result: Optimisation, changed: Mapping[str, float]) -> str:
        """The text of the terminal if nothing fits: the nearest miss, and changes that help."""
        again = shlex.join([*self._words, *self._settings(changed)])
        card = results.card(
            result, {"again": again, "written": False},
            colour=False, unicode=True, width=CARD_WIDTH,
        )  # fmt: skip
        return _for_a_page(card, self.actuator.design)

    def _shown(self, result: Optimisation) -> dict[str, Any]:
        """Data of an optimum, or of a nearest miss, that the page shows."""
        evaluation = result.best_evaluation
        return {
            "feasible": result.optimum,
            "whole": True,
            "sentence": text.sentence(text.pretty(result.sentence)),
            "objective": result.objective_value if math.isfinite(result.objective_value) else None,
            "section": section.drawing(evaluation.outlines, evaluation.lines, evaluation.lengths),
            "masses": [
                {"part": part.replace("_", " "), "mass": mass}
                for part, mass in evaluation.mass_parts.items()
            ],
            "mass": evaluation.metrics["mass"].value,
            "holds": _held(evaluation, result),
            "advice": _not_followed(evaluation),
            "reached": {
                f"requirements.{row.metric}.{row.sense}": row.value
                for row in evaluation.requirements
            },
            "dimensions": {row.path: row.value for row in result.variables},
            "changed_on_disk": self.changed_on_disk(),
        }

    # ---- prices and curves ----

    def _at(self, changed: dict[str, float]) -> Session:
        """The session at the optimum with these numbers changed; raises `Unsolvable`."""
        if self._session is None:
            raise Dropped
        if self._moved is None or self._moved[0] != changed:
            relative = self._relative(changed)
            standing = relative == self._base
            moved = self._session if standing else self._session.at(relative)
            self._moved = changed, moved
        return self._moved[1]

    def prices(
        self, changes: Numbers, paths: Sequence[str], stop: Stop, *, draw: bool = False
    ) -> dict[str, Any]:
        """Prices at the optimum; numbers without a price are left out.

        Parameters
        ----------
        changes : changed numbers
        paths : PATHs of the numbers to price
        stop : true once nobody wants the answer
        draw : whether to add how the section moves with each number

        Raises
        ------
        Unsolvable : there is no design with these numbers
        """
        moved = self._at(self._si(changes))
        found = []
        for path in paths:
            if stop():
                raise Dropped
            try:
                found.append(self._price(moved, path, stop))
            except UsageError:
                continue
        rows: list[dict[str, Any]] = [
            {
                "path": price.path,
                "value": price.value,
                "down": price.slope_down,
                "up": price.slope_up,
                "low": price.holds[0],
                "high": price.holds[1],
                "below": plain_words(price.changes[0]),
                "above": plain_words(price.changes[1]),
                "movement": price.movement,
            }
            for price in found
        ]
        if draw:
            smooth = [(row, x) for row, x in zip(rows, found, strict=True) if x.movement]
            drawn = section.slopes(
                moved.optimum.evaluation, [(x.path, x.value, x.movement) for _, x in smooth]
            )
            for (row, _), slopes in zip(smooth, drawn, strict=True):
                row["section"] = slopes
        return {"prices": rows}

    def _price(self, moved: Session, path: str, stop: Stop) -> Price:
        """The price of a number; that of a whole number is the difference to its neighbours."""
        quantity = quantity_of(path, self.actuator.design)
        if quantity.dimension != "count":
            return moved.price(path)
        value = get(moved.optimum.design, path)
        assert isinstance(value, float | int)
        slopes, refused = list[float | None](), 0
        for step in (-1, 1):
            found = None
            try:
                if quantity.lower <= value + step <= quantity.upper:
                    found = moved.bare_optimum({path: value + step}, stop=_dropping(stop))
            except InputError:  # contradicts other numbers
                refused += 1
            change = None if found is None else found.objective - moved.optimum.objective_value
            slopes.append(None if change is None else step * change)
        if refused == len(slopes):
            raise UsageError(Diagnostic("cannot change alone", "edit the file", path=path))
        down, up = slopes
        return Price(path, float(value), down, up, (value - 1.0, value + 1.0), (None, None))

    def curve(
        self,
        changes: Numbers,
        path: str,
        values: Sequence[float],
        stop: Stop,
        *,
        search: bool = False,
        best: str = "",
    ) -> dict[str, Any]:
        """Optima for some values of one number; objective None for a value without a design.

        Parameters
        ----------
        changes : changed numbers
        path, values : the number and its values
        stop : true once nobody wants the answer
        search : whether only a search may say that a value has no design
        best : PATH of a limit whose metric becomes the objective, while the design's own objective
            keeps its present value (see `TradeOff`); empty: the design's own objective

        Raises
        ------
        Unsolvable : there is no design with these changes
        InputError, UsageError : as for `solve`
        """
        changed = self._si(changes)
        if best:
            trade = self._traded(changed, best, stop)
            return dict(trade.curve(path, list(values), _dropping(stop), search=search))
        moved = self._at(changed)
        curve = moved.curve(path, list(values), stop=_dropping(stop), search=search)
        return {
            "values": curve.values,
            "objectives": curve.objectives,
            "dimensions": [dict(row) for row in curve.variables],
        }

    def _traded(self, changed: dict[str, float], best: str, stop: Stop) -> TradeOff:
        if best not in self._tradable:
            message = "is no limit whose metric can be an objective"
            raise UsageError(Diagnostic(message, "choose one of the list", path=best))
        if self._trade is None or self._trade[:2] != (changed, best):
            present = self._at(changed).optimum
            metric = present.evaluation.metrics[present.objective_metric]
            actuator = self.actuator.changed(changed)
            self._trade = changed, best, TradeOff(actuator, best, metric, stop, self._seed)
        return self._trade[2]

    def cycle(self, changes: Numbers, name: str, stop: Stop) -> dict[str, Any]:
        """A duty cycle at the optimum, as `cycle.drawn`.

        Raises
        ------
        UsageError : the design states no such cycle
        """
        return cycle.drawn(self._optimum(self._si(changes), stop).best_evaluation, name)

    # ---- files ----

    def changed_on_disk(self) -> bool:
        """Whether the design file is no longer what was read, or is gone."""
        try:
            return digest(self._file) != self._digest
        except InputError:
            return True

    def save(self, changes: Numbers, name: str, replacing: str | None) -> Saved:
        """Save the optimum beside the design; comments of the design file are kept.

        Parameters
        ----------
        changes : changed numbers
        name : plain name of the file
        replacing : SHA-256 of the existing file that may be replaced

        Raises
        ------
        InputError : the design file has changed on disk and would be replaced, or nothing fits
        UsageError : the name is not a plain one
        """
        changed = self._si(changes)
        result = self._optimum(changed, _never)
        if not result.optimum:
            message = "nothing fits, so there is no optimum to save"
            raise InputError(Diagnostic(message, "ask for less first"))
        folder = self._file.parent
        own = (folder / name).exists() and (folder / name).samefile(self._file)
        if own and self.changed_on_disk():
            message = "has changed on disk since the studio opened it, and is not overwritten"
            raise InputError(Diagnostic(message, "save under another name", name))
        content = saved_text(result, folder, self.actuator.source)
        saved = save_text(folder, name, content, replacing)
        if own and saved.written:
            self._digest = saved.sha256
        return saved

    def report(self, changes: Numbers) -> list[str]:
        """Write the report of the optimum; return the paths of its files."""
        changed = self._si(changes)
        if self._session is None or not self._optimum(changed, _never).optimum:
            message = "nothing fits, so there is no optimum to report"
            raise InputError(Diagnostic(message, "ask for less first"))
        result = self._session.solve(self._relative(changed), prices=True)
        actuator = self.actuator.changed(changed)
        files = report(result, folder=self._out, actuator=actuator, command=self.command(changed))
        return [str(file.path) for file in files]

    @property
    def session(self) -> Session | None:
        """The session at the optimum of the design as read; None if it has none."""
        return self._session

    @property
    def words(self) -> list[str]:
        """Words of the command line that name the design, its changes and plugins."""
        return [*self._words]

    def command(self, changed: Mapping[str, float] | None = None) -> str:
        """The command line that finds the same design; by default that shown last."""
        settings = self._settings(self.present if changed is None else changed)
        return shlex.join(["actuator-opt", "optimise", *self._words, *settings])

    def _settings(self, changed: Mapping[str, float]) -> list[str]:
        design = self.actuator.design
        return _options(
            "--set",
            (
                f"{path}={exact_text(value, quantity_of(path, design))}"
                for path, value in changed.items()
            ),
        )


def _never() -> bool:
    return False


def _changing(changes: Iterable[Change]) -> list[str]:
    """Options of the command line that change a design; the value None removes a key."""
    return [
        word
        for path, value in changes
        for word in (("--unset", path) if value is None else ("--set", f"{path}={value}"))
    ]


def _dropping(stop: Stop) -> Stop:
    """Raise `Dropped` once `stop` is true, so that no result of a stopped search is assembled."""

    def check() -> bool:
        if stop():
            raise Dropped
        return False

    return check


def _options(name: str, values: Any) -> list[str]:
    return [word for value in values for word in (name, value)]


def scale_of(quantity: Quantity) -> dict[str, Any]:
    """Unit of a quantity: displayed value = offset + factor * SI value."""
    offset = quantity.to_display(0.0)
    return {
        "unit": text.unit_text(quantity.unit),
        "typed": quantity.unit,
        "offset": offset,
        "factor": quantity.to_display(1.0) - offset,
    }


def _goal(optimum: Optimisation) -> dict[str, Any]:
    """Name, unit and direction of the objective."""
    name = optimum.objective_metric
    metric = optimum.best_evaluation.metrics.get(name)
    plain = {"unit": "", "typed": "", "offset": 0.0, "factor": 1.0}
    scale = plain if metric is None else scale_of(metric.quantity)
    label = "objective" if metric is None else term_of(name)
    maximise = _maximises(optimum)
    return {"label": label, "mass": name == "mass", "maximise": maximise, **scale}


def _maximises(optimum: Optimisation) -> bool:
    objective = optimum.design.objective
    return objective is not None and objective.aim == "max"


def plain_words(change: str | None) -> str | None:
    """Which limit becomes active or inactive, in words for a reader."""
    return None if change is None else text.pretty(change.replace("_", " "))


def _for_a_page(card: str, design: Design) -> str:
    """A card of the terminal without what only a terminal has; numbers by their labels."""
    card = re.split(r"\n(?:care|next): ", card)[0].rstrip()
    card = re.sub(r";\s+-v\s+shows\s+the\s+search|,\s+see\s+--relax-safety", "", card)
    known = {*numbers(design), *design.variables}

    def named(match: re.Match[str]) -> str:
        path = match[0]
        try:
            if path not in known and get(design, path) is None:
                return path
        except InputError:
            return path
        label = quick.label_of(path)
        in_table = re.match(r" *\d+ ", card[card.rfind("\n", 0, match.start()) + 1 :])
        return label.ljust(len(path)) if in_table else label

    return re.sub(r"[a-z]\w*(?:\[\w+\])?(?:\.[a-z]\w*(?:\[\w+\])?)+", named, card)


def _not_followed(evaluation: Evaluation) -> list[str]:
    """Advice that the design does not follow: name, value and limit."""
    return [
        f"{term_of(row.metric)} {text.value_text(quantity, row.value)} "
        f"({text.limit_text(quantity, row.sense, row.limit)})"
        for row in evaluation.checks
        if row.advice and row.status == "missed" and row.metric and row.value is not None
        for quantity in [text.metric(row.metric)]
    ]


def _held(evaluation: Evaluation, result: Optimisation) -> list[dict[str, Any]]:
    """Missed limits, then limits and bounds that are active at the optimum."""
    active = () if result.kkt is None else result.kkt.active
    required = {(row.metric, row.sense) for row in evaluation.requirements}
    limits: list[Requirement | Check] = [*evaluation.requirements]
    limits += [x for x in evaluation.checks if not x.advice and (x.metric, x.sense) not in required]
    limits.sort(key=lambda row: row.state != "missed")

    def holds(row: Requirement | Check) -> bool:
        names = (row.name, row.metric or row.name)
        return row.state == "no_reserve" and any(x.startswith(names) for x in active)

    rows = [
        {
            "name": term_of(row.metric) if row.metric else row.name,
            "limit": text.limit_text(text.metric(row.metric or ""), row.sense, row.limit),
            "value": "" if row.value is None else text.value_text(
                text.metric(row.metric or ""), row.value
            ),
            "where": text.brief(row.case, row.place),
            "missed": row.state == "missed",
        }
        for row in limits
        if row.limit is not None and row.metric and (row.state == "missed" or holds(row))
    ]  # fmt: skip
    design = evaluation.design
    return rows + [
        {
            "name": quick.label_of(row.path),
            "limit": f"{row.at_bound} bound",
            "value": quantity_of(row.path, design).text(row.value),
            "where": "",
            "missed": False,
        }
        for row in result.variables
        if row.at_bound
    ]
