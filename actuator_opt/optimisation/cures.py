"""Finds remedies for an infeasible actuator: one changed dimension or choice that is enough.

A fixed dimension is made a variable that may move in the helpful direction. The search for its
value starts from the design at which the limits must be relaxed least in total. For a choice, each
alternative word replaces the word in the file. Each remedy is confirmed by a design that meets all
limits and checks. The effort is limited by counts, not by time, so the same input gives the same
remedies. Candidates that were not tried are listed.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.numeric import STEP, Array
from ..base.progress import tell
from ..base.quantities import INPUTS, Quantity
from ..base.units import unit
from ..design import quantity_of, standard_sizes as standards
from ..design.materials import Library, load_library
from ..design.model import Design, Variable
from ..design.seals import BACK_UPS, SealElement
from ..evaluation import PreparedDesign
from ..joints.kinds import JOINTS
from . import repairs
from .actuator import ActuatorProblem, build, variant
from .evaluator import Evaluator
from .problem import BoxProblem, PointValues, Vector
from .repairs import Conflict

DIMENSIONS = (
    "bore", "wall_thickness", "winding_angle", "rod_diameter", "rod_inner_diameter", "part_length",
    "radial_clearance", "thread_diameter", "squeeze", "diameter", "friction_coefficient",
)  # fmt: skip
"""Kinds of number that a remedy may change: no stroke and no operating data. Our choice."""

PARTS = re.compile(r"(cylinder|barrel|rod|piston|head|caps|retention|clevis|seals|lines)\b")
"""Parts whose dimensions a remedy may change."""

MOST_DIMENSIONS = 8
"""Maximum number of dimensions tried, the most helpful first: our choice, to limit the time."""

MOST_CHOICES = 4
"""Maximum number of choices solved, the least infeasible first: our choice, to limit the time."""

MOST_PAIRED = 4
"""Number of choices, the least infeasible, that are paired with each other: our choice."""

MOST_PAIRS = 4
"""Maximum number of pairs of choices solved if no single change suffices: our choice."""

ENOUGH = 3
"""The search for a kind of remedy stops after this number of remedies: our choice."""

WORTH = 0.1
"""A number is only tried if its derivative predicts that doubling or halving it makes up at least
this share of the missed margins. Our choice."""

DIGITS = 4
"""Significant digits of a dimension; a design with the rounded dimension confirms the remedy."""

SUBSTITUTES = {
    "metal": ("al_7075_t6", "ti_6al4v", "steel_42crmo4", "steel_17_4ph_h1025"),
    "ply": ("t700_epoxy", "im7_8552", "s2glass_epoxy"),
    "seal": ("nbr_70", "nbr_90", "hnbr_75", "fkm_90"),
    "adhesive": ("epoxy_structural",),
}
"""Common library materials that are tried in place of another material of the same kind. Our
choice."""

BACK_UP = "back_up_ptfe"
"""Material assumed for a back-up ring if the design states none: a common material. Our choice."""


@dataclass(frozen=True, slots=True)
class Cure:
    """A single change that makes the design feasible: a dimension's value (SI), or a choice.

    `beside` gives, by PATH, other entries that must change together with a choice. `objective` is
    the best objective found with the change, as the solver minimises it.
    """

    path: str
    now: float | str
    needed: float | str
    beside: Mapping[str, str] = field(default_factory=dict)
    objective: float | None = None


@dataclass(frozen=True, slots=True)
class Cures:
    """Single changes that each make the design feasible, and the PATHs that were not tried.

    `together` has dimensions, and bounds of variables, that make the design feasible only if all of
    them change; `tried_together` is whether bounds were among those tried. `failed` has the changes
    that were tried but are not enough alone: PATHs of dimensions, and choices with their word.
    """

    dimensions: tuple[Cure, ...] = ()
    together: tuple[Cure, ...] = ()
    choices: tuple[Cure, ...] = ()
    untried: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()
    tried_together: bool = False


def cures(actuator: ActuatorProblem, conflict: Conflict) -> Cures:
    """Find single changes of fixed dimensions or choices that make the design feasible.

    Parameters
    ----------
    actuator : the infeasible problem
    conflict : why it is infeasible: the limits that conflict, and by how much
    """
    if conflict.laws or not conflict.joint:
        return Cures()
    threshold = WORTH * conflict.total / math.log(repairs.WIDEST)
    gains = {
        path: gain for path, gain in _gains(actuator, conflict).items() if abs(gain) >= threshold
    }
    dimensions, together, untried, failed = _dimensions(actuator, conflict.x, gains)
    choices, untried_choices, failed_choices = _choices(
        actuator,
        conflict.x,
        gains,
        paired=not together and all(is_property(actuator, cure) for cure in dimensions),
    )
    return Cures(
        dimensions,
        together,
        choices,
        (*untried, *untried_choices),
        (*failed, *failed_choices),
    )


def is_property(actuator: ActuatorProblem, cure: Cure) -> bool:
    """Whether a cure changes a property of a material or surface, not a dimension."""
    return quantity_of(cure.path, actuator.subject.design).name == "friction_coefficient"


def _gains(actuator: ActuatorProblem, conflict: Conflict) -> dict[str, float]:
    """By PATH, the reduction of the missed margins per relative increase of each number."""
    paths = [
        path
        for path in actuator.fixed_numbers(conflict.x)
        if PARTS.match(path) or path.startswith("materials.")
    ]
    if not paths:
        return {}
    margins = actuator.number_steps(conflict.x, paths).constraints
    slopes = np.nan_to_num(np.imag(margins) / STEP, posinf=0.0, neginf=0.0)
    return dict(zip(paths, (conflict.multipliers @ slopes).tolist(), strict=True))


def _dimensions(
    actuator: ActuatorProblem, x: Vector, gains: Mapping[str, float]
) -> tuple[tuple[Cure, ...], tuple[Cure, ...], list[str], list[str]]:
    """Find dimensions whose change suffices.

    Returns dimensions that each suffice alone, least change first; if there are none, dimensions
    that only suffice together; the PATHs that were not tried; and those that do not suffice.
    """
    design = actuator.subject.design
    candidates = sorted(
        (
            path
            for path in gains
            if PARTS.match(path) and quantity_of(path, design).name in DIMENSIONS
        ),
        key=lambda path: -abs(gains[path]),
    )
    tried = candidates[:MOST_DIMENSIONS]
    if not tried:
        return (), (), [], []
    problem = with_variables(actuator, tried)
    start = np.concatenate([x, problem.lower[len(x) :]])
    limits = {
        len(x) + k: _limit(quantity_of(path, design), start[len(x) + k], gains[path])
        for k, path in enumerate(tried)
    }
    sufficient: list[Cure] = []
    failed: list[str] = []
    for number, (path, place) in enumerate(zip(tried, limits, strict=True)):
        if len(sufficient) == ENOUGH:
            return _least_first(sufficient), (), candidates[number:], failed
        tell(
            "infeasible: searching for a fixed dimension whose change makes the design feasible",
            number / len(tried),
        )
        enough = least_changes(problem, start, {place: limits[place]}, {place: path}, design)
        sufficient += enough
        failed += [] if enough else [path]
    together: list[Cure] = []
    if not sufficient and len(tried) > 1:
        together = least_changes(
            problem, start, limits, dict(zip(limits, tried, strict=True)), design
        )
    return _least_first(sufficient), tuple(together), candidates[len(tried) :], failed


def _limit(quantity: Quantity, now: float, gain: float) -> float:
    """Limit to which a dimension may change in the helpful direction within its valid range."""
    limit = now * repairs.WIDEST if gain > 0 else now / repairs.WIDEST
    limit = limit if quantity.lower is None else max(limit, quantity.lower)
    return float(limit if quantity.upper is None else min(limit, quantity.upper))


def least_changes(
    problem: BoxProblem,
    start: Vector,
    limits: Mapping[int, float],
    paths: Mapping[int, str],
    design: Design,
) -> list[Cure]:
    """The least changes of fixed variables with which all limits are met; empty if impossible.

    New values are rounded away from the present values. A change is kept only if a search with it
    found a feasible design.

    Parameters
    ----------
    problem, start : the problem in which these variables are fixed, and one of its points
    limits, paths : by index of the variable, the limit of its change and its PATH
    design : the design, from which the quantity of each PATH is known
    """
    places = [place for place, limit in limits.items() if limit != start[place]]
    if not places:
        return []
    now = start[places]
    ends = np.array([limits[place] for place in places])
    lower, upper = problem.lower.copy(), problem.upper.copy()
    lower[places], upper[places] = np.minimum(now, ends), np.maximum(now, ends)
    sign = np.sign(ends - now)[:, None]

    def evaluate(points: Array) -> PointValues:
        change = (sign * np.log(points[places] / now[:, None])).sum(axis=0)
        return PointValues(change, problem.evaluate(points).constraints)

    free = replace(problem, lower=lower, upper=upper, evaluate=evaluate)
    feasible = repairs.near(free, start)
    if feasible is None:
        return []
    evaluator = Evaluator(free)
    end = repairs.go(evaluator, evaluator.point(evaluator.space.to_z(feasible)))
    if end.violation > repairs.NOTHING:
        return []
    result = []
    for place, limit in zip(places, ends, strict=True):
        old, value = float(start[place]), float(end.x[place])
        if abs(math.log(value / old)) > repairs.NOTHING:
            value = rounded_outward(quantity_of(paths[place], design), value, upwards=limit > old)
            value = min(max(value, lower[place]), upper[place])
            result.append(Cure(paths[place], old, value))
        lower[place] = upper[place] = value
    best = best_near(replace(problem, lower=lower, upper=upper), start)
    return [] if best is None else [replace(cure, objective=best) for cure in result]


def best_near(problem: BoxProblem, x: Vector) -> float | None:
    """The objective at the optimum near a point; None if no feasible point is near."""
    feasible = repairs.near(problem, x)
    if feasible is None:
        return None
    evaluator = Evaluator(problem)
    start = evaluator.point(evaluator.space.to_z(feasible))
    end = repairs.go(evaluator, start)
    better = end.valid and end.violation <= repairs.NOTHING and end.objective < start.objective
    return float(end.objective if better else start.objective)


def rounded_outward(quantity: Quantity, value: float, *, upwards: bool) -> float:
    """A value (SI) rounded in its display unit, upwards or downwards."""
    shown = outward(quantity.to_display(value), DIGITS, upwards)
    return unit(quantity.unit, quantity.dimension).to_si(shown) if quantity.unit else shown


def _least_first(enough: Sequence[Cure]) -> tuple[Cure, ...]:
    return tuple(
        sorted(enough, key=lambda cure: abs(math.log(float(cure.needed) / float(cure.now))))
    )


def with_variables(actuator: ActuatorProblem, paths: Sequence[str]) -> BoxProblem:
    """The problem with the numbers at `paths` as further variables, fixed at their present values.

    Limits that only these variables affect are included. Missed checks that no variable can correct
    are left out.
    """
    subject, numbers = actuator.subject, actuator.subject.numbers
    values = {path: numbers[path] for path in paths}
    added = {path: Variable(lower=x, upper=x, start=x) for path, x in values.items()}
    variables = dict(subject.design.variables) | added
    extended = build(
        replace(subject, design=subject.design.model_copy(update={"variables": variables}))
    )
    return _without_rows(extended, _unfixable_checks(actuator))


def _without_rows(actuator: ActuatorProblem, lost: frozenset[str]) -> BoxProblem:
    """The problem without the limits of some checks."""
    rows = np.array([row.label not in lost for row in actuator.rows], dtype=bool)

    def evaluate(points: Array) -> PointValues:
        values = actuator.evaluate(points)
        return PointValues(values.objective, values.constraints[rows])

    names = tuple(np.array(actuator.problem.constraint_names, dtype=object)[rows].tolist())
    return replace(
        actuator.problem, evaluate=evaluate, constraint_names=names, relaxable=None, groups=None,
        start=None,
    )  # fmt: skip


def _unfixable_checks(actuator: ActuatorProblem) -> frozenset[str]:
    """Labels of the missed checks that no variable can correct."""
    return frozenset(
        row.label
        for row in actuator.fixed
        if row.limit_of.origin == "check" and not float(row.margin[0]) >= -repairs.NOTHING
    )


def outward(value: float, digits: int, upwards: bool) -> float:
    """A number rounded upwards or downwards to `digits` digits; floating-point noise is ignored.

    >>> outward(283.0994, 4, True), outward(9.98645, 4, False), outward(400.00000001, 4, True)
    (283.1, 9.986, 400.0)
    """
    if not value or not math.isfinite(value):
        return value
    places = digits - 1 - math.floor(math.log10(abs(value)))
    scaled = value * 10.0**places
    slack = 1e-7 * abs(scaled)
    rounded = math.ceil(scaled - slack) if upwards else math.floor(scaled + slack)
    return round(rounded / 10.0**places, max(places, 0))


def _choices(
    actuator: ActuatorProblem, x: Vector, gains: Mapping[str, float], *, paired: bool
) -> tuple[tuple[Cure, ...], list[str], list[str]]:
    """Choices that make the design feasible, those not tried, and those that do not suffice.

    With `paired`, pairs of choices are tried if no single choice suffices.
    """
    subject, library = actuator.subject, load_library()
    present, values = _missed(actuator.problem, x), dict(zip(actuator.paths, x, strict=True))
    offered: list[_Offer] = []
    margins = np.ravel(actuator.evaluate(x[:, None]).constraints)
    rows = zip(actuator.rows, margins.tolist(), strict=True)
    places = {row.place for row, margin in rows if not margin >= -repairs.NOTHING}
    for path, word, beside in _candidate_choices(subject, library, gains, places):
        now = _word_at(subject.design, path)
        problem = None if word == now else _with_choice(actuator, {path: word, **beside}, library)
        missed = math.inf if problem is None else _missed(problem, _point(problem, values))
        if problem is not None and missed < present - repairs.NOTHING:
            offered.append((missed, Cure(path, now, word, beside), problem))
    offered.sort(key=lambda offer: (offer[0], offer[1].path))
    sufficient, failed, left = _sufficient(offered, values, MOST_CHOICES)
    if paired and not sufficient:
        pairs = _pairs(actuator, values, offered[:MOST_PAIRED], present, library)
        sufficient = _sufficient(pairs, values, MOST_PAIRS)[0]
    solved = {cure.path for cure in sufficient} | {cure.path for cure in failed}
    untried = dict.fromkeys(cure.path for cure in left if cure.path not in solved)
    return tuple(sufficient), [*untried], [f"{cure.path} {cure.needed}" for cure in failed]


_Offer: TypeAlias = tuple[float, Cure, BoxProblem]
"""A choice with the sum of missed margins at the point of least relaxation, and its problem."""


def _sufficient(
    offered: Sequence[_Offer], values: Mapping[str, float], most: int
) -> tuple[list[Cure], list[Cure], list[Cure]]:
    """The offers that make the design feasible, those that do not, and those not tried."""
    sufficient: list[Cure] = []
    failed: list[Cure] = []
    for number, (_, cure, problem) in enumerate(offered):
        if len(sufficient) == ENOUGH or number == most:
            return sufficient, failed, [offer for _, offer, _ in offered[number:]]
        tell(
            "infeasible: searching for a choice whose change makes the design feasible",
            number / len(offered),
        )
        best = best_near(problem, _point(problem, values))
        if best is None:
            failed.append(cure)
        else:
            sufficient.append(replace(cure, objective=best))
    return sufficient, failed, []


def _pairs(
    actuator: ActuatorProblem,
    values: Mapping[str, float],
    single: Sequence[_Offer],
    present: float,
    library: Library,
) -> list[_Offer]:
    """Pairs of single choices at different PATHs that miss less than at present, least first."""
    pairs: list[_Offer] = []
    for (_, first, _), (_, second, _) in itertools.combinations(single, 2):
        if first.path == second.path:
            continue
        beside = {second.path: str(second.needed), **first.beside, **second.beside}
        words = {first.path: str(first.needed), **beside}
        problem = _with_choice(actuator, words, library)
        missed = math.inf if problem is None else _missed(problem, _point(problem, values))
        if problem is not None and missed < present - repairs.NOTHING:
            pairs.append((missed, replace(first, beside=beside), problem))
    return sorted(pairs, key=lambda offer: (offer[0], offer[1].path))


def _point(problem: BoxProblem, values: Mapping[str, float]) -> Vector:
    """Values of the problem's variables; another joint has fewer variables than the design."""
    return np.array([values[name] for name in problem.names])


def _missed(problem: BoxProblem, x: Vector) -> float:
    """Sum of the missed margins at a point; infinite if the models have no result there."""
    rows = Evaluator.screen(problem.rows(x[:, None]))[1:, 0]
    return float(np.maximum(-rows, 0.0).sum()) if np.isfinite(rows).all() else math.inf


def _candidate_choices(
    subject: PreparedDesign, library: Library, gains: Mapping[str, float], places: set[str]
) -> Iterator[tuple[str, str, dict[str, str]]]:
    """Choices that may resolve the conflict: PATH, alternative, entries to change with it.

    A choice is included if numbers of its part have an effect (`gains`), and for a seal also if the
    seal misses a limit (`places`). Stops in the cylinder may always move outside it.
    """
    design = subject.design

    def matters(*starts: str) -> bool:
        return any(path.startswith(starts) for path in gains)

    for name in ("piston", "rod"):
        seal, section = getattr(design.seals, name), f"seals.{name}"
        fails = any(place.startswith(f"{name} seal") for place in places)
        if fails or matters(f"{section}.", f"materials.{seal.compound}."):
            for word, count in BACK_UPS.items():
                if (
                    count > seal.back_ups
                    and (beside := back_up_entries(seal, section, count)) is not None
                ):
                    yield f"{section}.back_up", word, beside
            if seal.seal_type.o_ring_gland:
                for compound in SUBSTITUTES["seal"]:
                    yield f"{section}.compound", compound, {}
                for size in _near_sections(seal.section):
                    yield f"{section}.section", INPUTS["cross_section"].text(size, 3), {}
    if design.cylinder.end_stop == "internal":
        yield "cylinder.end_stop", "external", {}
    blocks = [] if design.retention is None else list(design.retention.ends)
    ends = [f"retention.{name}" if name else "retention" for name in blocks]
    for end in ends:
        if matters(f"{end}."):
            yield from ((f"{end}.type", joint, {}) for joint in JOINTS.names)
    parts = ["rod", "second_rod", "piston", "head", "caps", *ends, "clevis"]
    parts += [f"barrel.layup[{i}]" for i in range(len(design.barrel.layup))]
    parts += [f"rod.layup[{i}]" for i in range(len(design.rod.layup))]
    for part in parts:
        material = _word_at(design, f"{part}.material")
        if material and matters(f"materials.{material}."):
            for other in SUBSTITUTES.get(library.kind(material) or "", ()):
                yield f"{part}.material", other, {}


def _near_sections(section: float) -> list[float]:
    """The next smaller and the next larger standard section of an O-ring."""
    sizes = standards.o_ring_sections("as568")
    smaller = [x for x in sizes if x < section - standards.WHOLE]
    larger = [x for x in sizes if x > section + standards.WHOLE]
    return [*smaller[-1:], *larger[:1]]


def back_up_entries(seal: SealElement, section: str, count: int) -> dict[str, str] | None:
    """Entries to change for `count` back-up rings on a seal; None if no standard gland fits."""
    if seal.back_up_material is not None and seal.back_up_thickness is not None:
        return {}
    try:
        gland = standards.gland(seal.section)
        room = sum(gland.widths(count)) / 2 - gland.width
    except InputError:
        return None
    thickness = INPUTS["part_length"].text(room / count, 2)
    return {f"{section}.back_up_material": BACK_UP, f"{section}.back_up_thickness": thickness}


def _word_at(design: Design, path: str) -> str:
    """The word, material or size that a design states at a PATH; "" if it states none."""
    value: object = design
    for step in re.split(r"\.|(?=\[)", path):
        layer = re.fullmatch(r"\[(\d+)\]", step)
        if layer is not None and isinstance(value, tuple):
            value = value[int(layer[1])]
        else:
            value = getattr(value, step, None)
    if isinstance(value, float):
        return quantity_of(path, design).text(value, 3)
    return value if isinstance(value, str) else ""


def _with_choice(
    actuator: ActuatorProblem, values: Mapping[str, str], library: Library
) -> BoxProblem | None:
    """The problem with other choices; None if they are invalid or miss a further check."""
    subject = actuator.subject
    try:
        other = build(replace(variant(subject, values, library), reserves=subject.reserves))
    except InputError:
        return None
    lost = _unfixable_checks(actuator)
    return _without_rows(other, lost) if _unfixable_checks(other) <= lost else None
