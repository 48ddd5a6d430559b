"""Collect the uncertain inputs of a design, with their distributions.

The sources, in order of precedence, are: an entry of the block ``uncertainty``; the 95 % bounds in
the block ``measured`` (normal distribution); the scatter that a library states for a property; ISO
286 and common practice for diameters, walls, angles and air content. Scatter given as a coefficient
of variation means a normal distribution, a tolerance a uniform distribution, and a factor a uniform
distribution of the logarithm, since bounds give no more information [JCGM100]. Values that are
already evaluated at their worst do not vary: strengths stay at their allowables, and glands at the
limits of their tolerances.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array, minimum, namespace, where
from ..base.quantities import Quantity
from ..base.symbolic.recorded import RecordedFunction
from ..design import quantity_of
from ..design.kinds import ValueFault
from ..design.material import Property, Spread
from ..design.standard_sizes import citation, tables
from ..design.uncertain import misfit, source
from ..evaluation import PreparedDesign, compute
from ..evaluation.kernel import governing
from ..evaluation.limits import UNLIMITED, MetricArrays, MetricLimit, all_limits, rows_of
from ..evaluation.values import Values
from ..models.elastomer import MODULUS_LAWS
from ..optimisation.problem import Vector
from .estimate import Distribution, about

GUARANTEED = ("limit", "minimum", "maximum", "A", "B", "S")
"""Statistical bases of material values that are already bounds, so that they do not vary."""
OWN = ("friction_coefficient", "breakaway_ratio", "stribeck_speed")
"""Seal properties that a design may state; otherwise the values of the compound apply."""
NORMAL_95 = 1.959964
_ANYTHING = (-np.inf, np.inf)


@dataclass(frozen=True, slots=True)
class Input:
    """An uncertain input.

    Parameters
    ----------
    path : path of the input in the design file (PATH)
    quantity : its quantity
    value : nominal value in the design, SI
    distribution : distribution of its draws
    origin : kind of source: "design", "measured", "library" or "practice"
    why : source of the scatter, in words
    confidence : confidence in that source
    """

    path: str
    quantity: Quantity
    value: float
    distribution: Distribution
    origin: str
    why: str
    confidence: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form, SI."""
        ends = self.distribution.at(np.array([0.05, 0.5, 0.95])).tolist()
        return {
            "path": self.path, "unit": self.quantity.si_unit, "value": self.value,
            "distribution": self.distribution.shape,
            "lower": self.distribution.low, "upper": self.distribution.high,
            "deviation": self.distribution.deviation,
            "p5": ends[0], "p50": ends[1], "p95": ends[2],
            "origin": self.origin, "source": self.why, "confidence": self.confidence,
        }  # fmt: skip


def inputs(subject: PreparedDesign) -> tuple[Input, ...]:
    """Return every uncertain input of a design, by PATH.

    Raises
    ------
    InputError
        if no model reads an entry of ``uncertainty``, or its draws would leave the valid range
    """
    paths_read = read_by_models(subject)
    candidates = (
        *_library(subject),
        *_practice(subject),
        *_measured(subject),
    )  # later sources replace earlier ones
    by_path = {
        candidate.path: candidate for candidate in candidates if candidate.path in paths_read
    }
    for path, entry in subject.design.uncertainty.items():
        if path not in paths_read and subject.design.choices:
            continue  # read only with another option of a choice
        by_path[path] = _stated(subject, path, entry.model_dump(), path in paths_read)
    ordered = (by_path[path] for path in sorted(by_path))
    return tuple(entry for entry in ordered if entry.distribution.shape != "fixed")


def read_by_models(subject: PreparedDesign) -> set[str]:
    """Return the PATHs that models read, including factors on moduli that follow from hardness."""
    factors = {f"materials.{name}.{_FACTOR}": np.ones(2) for name in _compounds(subject)}
    values = subject.values(factors)
    compute(subject, values)
    return values.read


# ---- what the file states ----


def _stated(subject: PreparedDesign, path: str, entry: dict[str, Any], is_read: bool) -> Input:
    quantity = quantity_of(path, subject.design)
    place = f"uncertainty.{path}.distribution"
    value = subject.numbers.get(path, 1.0 if path.endswith(_FACTOR) else None)
    if value is None or not is_read:
        message = "no model of this design uses this value, so its uncertainty has no effect"
        raise InputError(Diagnostic(message, "remove the entry", path=place))
    message, remedy = misfit(entry["distribution"], entry, value, quantity)
    if message:
        raise InputError(Diagnostic(message, remedy, path=place))
    distribution = about(entry["distribution"], entry, value, (quantity.lower, quantity.upper))
    origin = entry["source"] or "stated in the design"
    if entry["tolerance"]:
        origin += f", {entry['tolerance']} of {source()}"
    return Input(path, quantity, value, distribution, "design", origin)


def _measured(subject: PreparedDesign) -> Iterator[Input]:
    for path, bounds in subject.design.measured.items():
        quantity, value = quantity_of(path, subject.design), subject.numbers.get(path)
        deviation = (bounds.upper - bounds.lower) / (2 * NORMAL_95)
        if value is not None:
            stated = {"deviation": deviation}
            distribution = about("normal", stated, value, (quantity.lower, quantity.upper))
            why = f"95 % bounds of {bounds.record}"
            yield Input(path, quantity, value, distribution, "measured", why, "verified")


# ---- libraries ----


def _library(subject: PreparedDesign) -> Iterator[Input]:
    """Yield the properties of materials and seals for which a library states scatter."""
    for name, material in subject.materials.items():
        for key, entry in material.properties.items():
            if "strength" not in key and entry.basis not in GUARANTEED:
                yield from _property(subject, f"materials.{name}.{key}", entry, name)
    for place in ("piston", "rod"):
        for tail, element in getattr(subject.design.seals, place).elements().items():
            properties = subject.materials[element.compound].properties
            for key in OWN:
                path = f"seals.{place}.{tail}{key}"
                if path in subject.numbers and key in properties:
                    yield from _property(subject, path, properties[key], element.compound)
    yield from _moduli(subject)


def _property(subject: PreparedDesign, path: str, entry: Property, name: str) -> Iterator[Input]:
    value = subject.numbers[path]
    if entry.spread is None or value == 0:
        return
    shape, stated = _shape(entry.spread, value)
    quantity = quantity_of(path, subject.design)
    within = (quantity.lower, quantity.upper)
    if shape == "loguniform" and value < 0:
        return
    distribution = about(shape, stated, value, within)
    why = f"{name}: {entry.scatter}"
    yield Input(path, quantity, value, distribution, "library", why, entry.confidence)


def _shape(spread: Spread, value: float) -> tuple[str, dict[str, float]]:
    """Return the distribution shape, with its parameters, for scatter that a library states."""
    if spread.kind == "cv":
        return "normal", {"cv": spread.size}
    if spread.kind == "tolerance":
        return "uniform", {"half_width": spread.size * abs(value)}
    return "loguniform", {"factor": spread.size}


_FACTOR = "hardness_modulus_factor"


def _compounds(subject: PreparedDesign) -> list[str]:
    return [name for name, material in subject.materials.items() if material.kind == "seal"]


def _moduli(subject: PreparedDesign) -> Iterator[Input]:
    """Yield an uncertain factor on the modulus of each seal compound.

    Published laws give different moduli for the same hardness. The bounds of the factor give the
    smallest and the largest of these moduli; its logarithm is uniformly distributed.
    """
    laws: dict[str, set[str]] = {}
    for place in ("piston", "rod"):
        for element in getattr(subject.design.seals, place).elements().values():
            laws.setdefault(element.compound, set()).add(element.hardness_model)
    for name, laws_used in laws.items():
        hardness = subject.numbers.get(f"materials.{name}.hardness")
        if hardness is None:
            continue
        design_law = min(laws_used)
        moduli = {key: float(law.modulus(hardness=hardness)) for key, law in MODULUS_LAWS.items()}
        ratios = [modulus / moduli[design_law] for modulus in moduli.values()]
        path = f"materials.{name}.{_FACTOR}"
        stated = {"lower": min(ratios), "upper": max(ratios)}
        distribution = about("loguniform", stated, 1.0, _ANYTHING)
        references = " and ".join(law.reference for law in MODULUS_LAWS.values())
        why = f"published laws for the modulus at a hardness differ: {references}"
        quantity = quantity_of(path, subject.design)
        value = subject.numbers.get(path, 1.0)
        yield Input(path, quantity, value, distribution, "library", why, "verified")


# ---- practice ----


def _practice(subject: PreparedDesign) -> Iterator[Input]:
    """Yield inputs with scatter from practice: diameters, walls, ply angles, air content."""
    table: Mapping[str, str] = tables()["scatter_of_dimensions"]
    origin = citation(table["source"])
    classes = {
        "cylinder.bore": table["bore"],
        "rod.outer_diameter": table["rod"],
        "rod.inner_diameter": table["rod_bore"],
        "second_rod.outer_diameter": table["rod"],
        "second_rod.inner_diameter": table["rod_bore"],
    }
    spreads: dict[str, tuple[str, dict[str, Any]]] = {
        "fluid.air_content": ("lognormal", {"factor": float(table["air_content_factor"])})
    }
    for tube in ("barrel", "rod"):
        for index, ply in enumerate(getattr(subject.design, tube).layup):
            place = f"{tube}.layup[{index}]"
            if subject.materials[ply.material].isotropic:
                classes[f"{place}.thickness"] = table["metal_wall"]
                continue
            share = float(table["ply_thickness_percent"]) / 100
            spreads[f"{place}.thickness"] = ("uniform", {"half_width": share * ply.thickness})
            angle = np.radians(float(table["angle_deg"]))
            spreads[f"{place}.angle"] = ("uniform", {"half_width": float(angle)})
    spreads |= {path: ("uniform", {"tolerance": name}) for path, name in classes.items()}
    for path, (shape, stated) in spreads.items():
        value = subject.numbers.get(path, 0.0)
        if value == 0 and not path.endswith("angle"):
            continue
        quantity = quantity_of(path, subject.design)
        try:
            distribution = about(shape, stated, value, (quantity.lower, quantity.upper))
        except ValueFault:  # the size is outside the table of ISO 286
            continue
        why = f"{stated['tolerance']}, {origin}" if "tolerance" in stated else origin
        yield Input(path, quantity, value, distribution, "practice", why, table["confidence"])


CHUNK = 2048
"""Maximum number of draws in one model call, which limits memory."""
TOLERANCE = 1e-6
"""A limit is met at a margin of -TOLERANCE or more, as in an evaluation."""


def chunks(points: Vector) -> Iterator[Vector]:
    """Yield points (d, n) in chunks of up to `CHUNK` points."""
    for first in range(0, points.shape[1], CHUNK):
        yield points[:, first : first + CHUNK]


@dataclass(frozen=True, slots=True)
class ModelDraws:
    """Input values (d, n), margins of all limits (m, n) and metrics (k, n) for n draws."""

    values: Vector
    margins: Vector
    metrics: Vector

    @property
    def met(self) -> Vector:
        """Return which draws meet which limits (m, n); a limit without a value counts as missed."""
        return np.asarray(self.margins >= -TOLERANCE)


class UncertainModel:
    """A prepared design with uncertain inputs.

    Parameters
    ----------
    subject : the design
    inputs : uncertain inputs
    metrics : metrics to evaluate in addition to the margins
    """

    def __init__(
        self, subject: PreparedDesign, inputs: Sequence[Input], metrics: Sequence[str] = ()
    ) -> None:
        self.subject = replace(without_drawn_basis(subject, inputs), lenient=True)
        self.inputs = tuple(inputs)
        self.metrics = tuple(metrics)
        nominal = compute(self.subject, self.subject.values())
        origins = ("requirement", "case", "check")
        self.limits = tuple(
            limit
            for limit in all_limits(subject.design, subject.plugins)
            if limit.origin in origins
            and (limit.origin != "check" or nominal.computed.metrics.get(limit.metric))
        )
        self.own = np.array([limit.origin != "check" for limit in self.limits], dtype=bool)
        """Whether each limit is a requirement, of the design or of a load case, and not a check."""
        _require_metrics(self.metrics, nominal.computed)
        self._wanted = {limit.metric for limit in self.limits} | set(self.metrics)
        self._evaluate: Callable[[Vector], Vector] = self._rows

    @property
    def nominal(self) -> ModelDraws:
        """Return margins and metrics of the nominal design."""
        return self.where(np.array([[entry.value] for entry in self.inputs]).reshape(-1, 1))

    def at(self, shares: Vector) -> ModelDraws:
        """Return margins and metrics at cumulative probabilities (d, n) of the inputs."""
        quantiles = [
            entry.distribution.at(row) for entry, row in zip(self.inputs, shares, strict=True)
        ]
        return self.where(np.array(quantiles).reshape(len(self.inputs), shares.shape[1]))

    def outputs(self, shares: Vector) -> Vector:
        """Return the m margins, least margin of the requirements, k metrics: (m + 1 + k, n)."""
        return np.concatenate([self.flat(self.at(part)) for part in chunks(shares)], axis=1)

    def flat(self, drawn_inputs: ModelDraws) -> Vector:
        """Stack margins, least margin and metrics; a margin of 1e9 or more becomes NaN."""
        margins = np.where(np.abs(drawn_inputs.margins) < 1e9, drawn_inputs.margins, np.nan)
        with np.errstate(all="ignore"):
            least = np.min(drawn_inputs.margins[self.own], axis=0, initial=np.inf)
        return np.concatenate([margins, least[None], drawn_inputs.metrics])

    def record(self) -> None:
        """Record the models, so that the machine evaluates many draws; not with custom metrics."""
        if not self.subject.plugins:
            present = np.array([entry.value for entry in self.inputs])
            self._evaluate = RecordedFunction(self._rows, [x.path for x in self.inputs], present)

    @np.errstate(all="ignore")
    def where(self, values: Vector) -> ModelDraws:
        """Return margins and metrics at the given input values (d, n), SI."""
        rows = self._evaluate(values)
        return ModelDraws(values, rows[: len(self.limits)], rows[len(self.limits) :])

    def _rows(self, values: Array) -> Array:
        """Margins, then metrics (m + k, n), by the models; also of symbols."""
        count = values.shape[1]
        varied = {entry.path: row for entry, row in zip(self.inputs, values, strict=True)}
        numbers = self.subject.values(varied)
        wanted = None if self.subject.plugins else self._wanted
        computed = compute(self.subject, numbers, wanted).computed
        rows = [_margin(limit, computed, numbers, count) for limit in self.limits]
        rows += [governing(name, computed, numbers, self.subject) for name in self.metrics]
        if not rows:
            return np.empty((0, count))
        xp = namespace(*rows)
        return xp.stack([xp.broadcast_to(xp.asarray(row), (count,)) for row in rows])


def _margin(limit: MetricLimit, computed: MetricArrays, numbers: Values, count: int) -> Array:
    """Return the least margin of a limit over load cases and places (n,); NaN without a value."""
    least: Array = np.full(count, np.inf)
    has_value = False
    for row in rows_of(limit, computed, numbers):
        least, has_value = minimum(least, row.margin), True
    return where(least > UNLIMITED / 1e6, np.inf, least) if has_value else np.full(count, np.nan)


def _require_metrics(metrics: Sequence[str], computed: MetricArrays) -> None:
    for name in metrics:
        if not computed.metrics.get(name):
            reason = computed.why.get(name, "this design has no such metric")
            remedy = "choose a metric that `actuator-opt evaluate` lists with a value"
            raise InputError(Diagnostic(f"{name} cannot be evaluated: {reason}", remedy))


def without_drawn_basis(subject: PreparedDesign, inputs: Sequence[Input]) -> PreparedDesign:
    """Return the design without the basis knock-down of those strengths that are drawn.

    The basis knock-down reduces a mean strength to an allowable. It accounts for scatter, as
    drawing the strength already does. Knock-downs for temperature, moisture and process still
    apply.
    """
    drawn_paths = {uncertain.path for uncertain in inputs}
    factors = dict(subject.factors)
    for (name, key, cold), factor in subject.factors.items():
        path = f"materials.{name}.{key}"
        knockdown = subject.numbers.get(f"materials.{name}.basis_knockdown")
        entry = subject.materials[name].properties[key]
        if path in drawn_paths and knockdown and entry.basis in ("typical", "mean"):
            factors[name, key, cold] = factor / knockdown
    return replace(subject, factors=factors) if factors != subject.factors else subject
