"""Traced values as monomials of atoms, with curves that relate the atoms.

A model without a closed expression becomes an unknown within envelopes that contain its values.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from ...base.numeric import Array, maximum
from ...base.symbolic import Symbol
from ...base.symbolic.expression import bounds_of
from ...design.model import Design
from ...evaluation import PreparedDesign, plies, rod_strength
from ...evaluation.barrel import LAMINATES, Swelling, Wall, compute, kind, wall
from ...evaluation.barrel.wall import LoadPath
from ...evaluation.geometry import Geometry, clamped
from ...evaluation.kernel import Implicit, ModelRun, Statics
from ...evaluation.limits import MaterialValues, MetricArrays
from ...evaluation.rods import RodSection
from ...evaluation.springs import Springs
from ...evaluation.state import LoadState
from ...evaluation.values import Values
from ...joints.joint import Clamp
from ...models import column, rod as rod_models, stepped, tube_bounds
from ...models.layered_tube import layered_tube, tube_state
from ...models.solid_ply import solid_rotated
from ...models.trial_motion import (
    Chamber,
    TrialMode,
    buckled_mode,
    least_energy_motion,
    trial_mode_load,
    trial_motion_stiffness,
)
from .bounding import CAUTION, SAMPLES, Leads, function
from .intervals import branch, extreme
from .relaxation import (
    FAR,
    AtomFunction,
    ConstraintRow,
    Form,
    Kind,
    Mixed,
    Relaxation,
    SampledFunction,
    Signomial,
    Unknown,
)

WIDEST = 20.0
"""Widest logarithmic range that is sampled."""

LARGEST = 8
"""Maximum terms of a sum that stays expanded, so that terms can cancel."""

_MONOMIAL = ("variable", "mul", "div", "neg", "sqrt", "pow")
"""Operations that keep a monomial a monomial."""


class Builder:
    """Relaxes traced values one by one; equal values share an atom."""

    def __init__(self) -> None:
        self.found = Relaxation()
        self._forms: dict[int, tuple[float, Form] | Unknown] = {}
        self._sums: dict[int, Signomial | None] = {}
        self._leads = Leads()
        self.variables: dict[str, Form] = {}

    def form(self, value: Any) -> tuple[float, Form]:
        """Sign and logarithm of a value.

        Raises
        ------
        Unknown
            its sign is not known, or one of its models has no relaxation
        """
        if not isinstance(value, Symbol):
            number = float(value)
            if number == 0 or not math.isfinite(number):
                raise Unknown(f"a part of it is {number:g}")
            return math.copysign(1.0, number), Form(math.log(abs(number)))
        if value.index not in self._forms:
            try:
                self._forms[value.index] = self._either(value)
            except Unknown as reason:
                self._forms[value.index] = reason
        known = self._forms[value.index]
        if isinstance(known, Unknown):
            raise known
        return known

    def _either(self, node: Symbol) -> tuple[float, Form]:
        """The sampled form if it is tighter than the parts, else the parts."""
        if node.op not in _MONOMIAL or self._repeats(node):
            with suppress(Unknown):
                return self._sampled(node)
        return self._made(node)

    def _repeats(self, node: Symbol) -> bool:
        """Whether both factors of a product depend on one value, other than as powers of it."""
        if node.op not in ("mul", "div"):
            return False
        lead, (first, second) = self._leads.of(node), node.args
        single = first is second or _power(first, lead) or _power(second, lead)
        return lead is not node and not single

    def _made(self, node: Symbol) -> tuple[float, Form]:
        op, args = node.op, node.args
        if op == "variable":
            return self._variable(node)
        if op in ("add", "sub"):
            return self._of_sum(node)
        if op in ("mul", "div"):
            (s, a), (t, b) = self.form(args[0]), self.form(args[1])
            return s * t, a + b if op == "mul" else a - b
        if op == "neg":
            sign, form = self.form(args[0])
            return -sign, form
        if op in ("sqrt", "pow"):
            sign, form = self.form(args[0])
            if sign < 0:
                raise Unknown("a root of a negative number")
            return 1.0, form.scaled(0.5 if op == "sqrt" else args[1])
        if op == "where":
            return self._chosen(node)
        return self._of_function(node)

    def _variable(self, node: Symbol) -> tuple[float, Form]:
        low, high = node.bounds
        if not low > 0:
            raise Unknown(f"{node.args[0]} may be zero or negative")
        form = self.found.atom(low, high, lambda y: math.nan)  # an atom of the design itself
        self.variables[node.args[0]] = form
        return 1.0, form

    def _sampled(self, node: Symbol) -> tuple[float, Form]:
        """The sampled form of a function of one other value."""
        lead = self._leads.of(node)
        if lead is node:
            raise Unknown("it depends on several values")
        sign, argument = self.form(lead)
        if sign < 0:
            raise Unknown("its argument is negative")
        t = np.linspace(*self.found.reach(argument), SAMPLES)
        if not 0 < t[-1] - t[0] < WIDEST:
            raise Unknown("its argument is fixed or unbounded")
        values = function([node], lead)(t)[0]
        with np.errstate(all="ignore"):
            logs = np.log(np.abs(values))
        if not np.isfinite(logs).all():
            raise Unknown("it is not defined everywhere")
        table = SampledFunction.of(t, logs, CAUTION)
        if (values[0] > 0) != (values[-1] > 0) or values.min() * values.max() <= 0:
            raise Unknown("its sign is not known")
        least, most = float(logs.min()) - table.room, float(logs.max()) + table.room
        return math.copysign(1.0, values[0]), self._curve(table, argument, least, most)

    def expanded(self, value: Any) -> Signomial | None:
        """A value as a sum of monomials; None if it has too many terms."""
        if not isinstance(value, Symbol):
            return Signomial.number(value) if math.isfinite(value) else None
        if value.index not in self._sums:
            signomial = self._expand(value)
            kept = signomial is not None and len(signomial.terms) <= LARGEST
            self._sums[value.index] = signomial if kept else None
        return self._sums[value.index]

    def _expand(self, node: Symbol) -> Signomial | None:
        op, args = node.op, node.args
        if op in ("add", "sub"):
            a, b = self.expanded(args[0]), self.expanded(args[1])
            if a is None or b is None:
                return None
            return a.plus(b, 1.0 if op == "add" else -1.0)
        if op == "neg":
            inner = self.expanded(args[0])
            return None if inner is None else Signomial({}).plus(inner, -1.0)
        if op == "mul":
            a, b = self.expanded(args[0]), self.expanded(args[1])
            if a is not None and b is not None and len(a.terms) * len(b.terms) <= 2 * LARGEST:
                return a.times(b)
        if op == "div":
            a = self.expanded(args[0])
            try:
                sign, form = self.form(args[1])
            except Unknown:
                return None
            return None if a is None else a.times(Signomial.monomial(sign, Form(0.0) - form))
        if op == "where":
            taken = branch(node)
            if taken is not None:
                return self.expanded(taken)
        try:
            return Signomial.monomial(*self.form(node))
        except Unknown:
            return None

    def _of_sum(self, node: Symbol) -> tuple[float, Form]:
        """A sum as its terms, expanded where some cancel or signs differ."""
        low, high = node.bounds
        parts = self._cancelled(node) or self._terms(node)
        known = parts.single
        if known is not None:
            return known
        if not parts.terms:
            raise Unknown("it is zero")
        plus, minus = parts.sides()
        low, high = max(low, self._least(plus, minus)), min(high, -self._least(minus, plus))
        if not minus or not plus:
            sign = -1.0 if minus else 1.0
            ends = (low, high) if sign > 0 else (-high, -low)
            return sign, self.found.total(plus or minus, *ends)
        if low > 0:
            return 1.0, self._difference(plus, minus, low, high)
        if high < 0:
            return -1.0, self._difference(minus, plus, -high, -low)
        raise Unknown("the sign of a difference is not known")

    def _least(self, plus: Sequence[Form], minus: Sequence[Form]) -> float:
        """Lower bound of a difference of sums, by its expanded terms."""
        least = sum(math.exp(self.found.reach(one)[0]) for one in plus)
        return least - sum(math.exp(min(self.found.reach(one)[1], 700.0)) for one in minus)

    def _cancelled(self, node: Symbol) -> Signomial | None:
        """An expanded sum, if terms of its operands cancel."""
        parts = [self.expanded(one) for one in (node, *node.args)]
        if None in parts:
            return None
        whole, *sizes = (part.size for part in parts if part is not None)
        return parts[0] if whole < (1 - 1e-9) * sum(sizes) else None

    def _terms(self, node: Symbol) -> Signomial:
        """A sum by its operands, each an atom; operands of unknown sign are expanded."""
        first, second = (self.opened(arg) for arg in node.args)
        return first.plus(second, -1.0 if node.op == "sub" else 1.0)

    def opened(self, value: Any) -> Signomial:
        """A value of any sign as a sum of as few monomials as possible.

        Raises
        ------
        Unknown
            one of its models has no relaxation
        """
        try:
            return Signomial.monomial(*self.form(value))
        except Unknown:
            if not isinstance(value, Symbol):
                if value == 0:
                    return Signomial({})
                raise
            parts = self.expanded(value)
            if parts is not None and not parts.terms:
                return parts
            if value.op in ("add", "sub"):
                return self._terms(value)
            if value.op == "neg":
                return Signomial({}).plus(self.opened(value.args[0]), -1.0)
            if value.op == "mul":
                return self.opened(value.args[0]).times(self.opened(value.args[1]))
            if value.op == "div":
                sign, form = self.form(value.args[1])
                inverse = Signomial.monomial(sign, Form(0.0) - form)
                return self.opened(value.args[0]).times(inverse)
            raise

    def at_least(self, value: Any, bound: Any) -> None:
        """Add the constraint that a value is at least another value or a number.

        Raises
        ------
        Unknown
            one of their models has no relaxation
        """
        plus, minus = self.opened(value).plus(self.opened(bound), -1.0).sides()
        if minus and not plus:
            raise Unknown("it is below its limit")
        if minus:
            most = math.inf
            whole, rest = (self.found.total(side, 0.0, most) for side in (plus, minus))
            self.found.rows.append(ConstraintRow(rest, whole))

    def _difference(
        self, plus: Sequence[Form], minus: Sequence[Form], low: float, high: float
    ) -> Form:
        """Plus - minus > 0."""
        whole = self.found.total(plus, 0.0, math.inf)
        rest = self.found.total(minus, 0.0, math.inf)

        def apart(y: Sequence[float]) -> float:
            ratio = whole.at(y) - rest.at(y)
            return rest.at(y) + math.log(math.expm1(ratio)) if ratio > 0 else -math.inf

        out = self.found.atom(low, high, apart)
        self.found.split(whole, out, rest)
        return out

    def _chosen(self, node: Symbol) -> tuple[float, Form]:
        taken = branch(node)
        if taken is not None:
            return self.form(taken)
        kind = extreme(node)
        if kind is None:
            raise Unknown("it depends on a condition that is not decided")
        (s, a), (t, b) = self.form(node.args[1]), self.form(node.args[2])
        low, high = node.bounds
        if s != t:
            raise Unknown("the sign of a choice is not known")
        ends = (low, high) if s > 0 else (-high, -low)
        larger = (kind == "max") == (s > 0)
        pick = max if larger else min
        out = self.found.atom(*ends, lambda y: pick(a.at(y), b.at(y)))
        for one in (a, b):
            self.found.rows.append(ConstraintRow(one, out) if larger else ConstraintRow(out, one))
        return s, out

    def _of_function(self, node: Symbol) -> tuple[float, Form]:
        op, argument = node.op, node.args[0]
        low, high = node.bounds
        if op == "log1p":
            return self._logarithm(argument.graph, 1.0 + argument, low, high)
        if op == "log":
            return self._logarithm(argument.graph, argument, low, high)
        if op == "exp":
            return 1.0, self._exponential(argument, low, high)
        if op == "tanh" and low > 0:
            _, form = self.form(argument)
            return 1.0, self._curve("tanh", form, math.log(low), math.log(high))
        raise Unknown(f"{op} has no relaxation")

    def _logarithm(
        self, graph: object, argument: Any, low: float, high: float
    ) -> tuple[float, Form]:
        """The form of ln x > 0: affine in the atoms; its own logarithm is a curve of it."""
        parts = self.expanded(argument)
        if parts is not None:  # a ratio such as 1.2 + t/r exceeds one for all t and r
            plus, minus = parts.sides()
            least = self._least(plus, minus)
            low = max(low, math.log(least)) if least > 0 else low
        _, form = self.form(argument)
        if low <= 0 <= high:
            raise Unknown("the sign of a logarithm is not known")
        sign = 1.0 if low > 0 else -1.0
        inner = form if sign > 0 else Form(0.0) - form
        ends = (low, high) if sign > 0 else (-high, -low)
        return sign, self._curve("log", inner, math.log(ends[0]), math.log(ends[1]))

    def _exponential(self, argument: Any, low: float, high: float) -> Form:
        """The form of e^x: its logarithm is x, a curve of the logarithm of x."""
        sign, form = self.form(argument)
        if sign > 0:
            return self._curve("exp", form, math.log(low) if low > 0 else -FAR, math.log(high))
        out = self.found.atom(low, high, lambda y: -math.exp(form.at(y)))
        self.found.curves.append(AtomFunction("exp", form, Form(0.0) - out))
        return out

    def _curve(self, kind: Kind, argument: Form, low: float, high: float) -> Form:
        """A new atom as a function of a monomial's logarithm; ends are logarithms."""
        mixed = Mixed([kind])
        out = self.found.atom(
            math.exp(low),
            math.exp(high),
            lambda y: float(mixed.value(np.array([argument.at(y)]))[0]),
        )
        self.found.curves.append(AtomFunction(kind, argument, out))
        return out


def _power(value: Any, lead: Symbol) -> bool:
    """Whether a value is a number times a power of another."""
    if value is lead or not isinstance(value, Symbol):
        return True
    return value.op in _MONOMIAL and all(_power(arg, lead) for arg in value.args)


LEAST_DECAY = 1e-3
"""Least decay of the displacement through part of a layer, so that no power is zero."""


PARTS = 4
"""Parts of a layer of known stiffness in the bound on its growth; any number is valid."""


CONTRACTION = 0.2
"""Contraction of a wall over its axial strain in the bound on its stiffness; any value is valid."""


class EnvelopeProblem(Protocol):
    """Collects the unknowns of envelopes and their known relations."""

    facts: list[tuple[Any, Any]]

    def unknown(self, name: str, exact: Callable[[ModelRun], float]) -> Symbol:
        """Add a positive unknown."""


class Envelopes:
    """Envelopes of one load case, tight at an evaluated design of one column."""

    def __init__(
        self,
        problem: EnvelopeProblem,
        subject: PreparedDesign,
        there: ModelRun,
        decays: Sequence[Sequence[float]],
        case: int,
    ) -> None:
        self.problem, self.subject, self.there = problem, subject, there
        self.decays, self.case = decays, case
        self.bearable: Array | None = None
        """Upper bound on the pressure of any laminated wall before first damage; None if
        unknown."""

    def implicit(self) -> Implicit:
        """The models for the evaluation."""
        return Implicit(
            wall=self.laminate if layered(self.subject) else compute,
            critical_load=self.column(self._mode()),
        )

    def number(self, value: Array) -> float:
        """The value of an evaluated design in this load case."""
        rows = np.atleast_2d(np.asarray(value, dtype=float))
        return float(rows[min(self.case, len(rows) - 1), 0])

    def unknown(self, name: str, exact: Callable[[ModelRun], Array]) -> Symbol:
        """Add an unknown of this load case."""
        return self.problem.unknown(f"{name}_{self.case}", lambda done: self.number(exact(done)))

    def _mode(self) -> TrialMode | None:
        """The buckling shape of the evaluated design between its pins."""
        if self.subject.design.cylinder.mount != "cap_clevis":
            return None
        lengths = rod_strength.lengths(self.there.geometry, self.there.state)
        load = stepped.stepped_column_load(
            bending_stiffness_1=self.number(self.there.wall.bending_stiffness),
            length_1=self.number(lengths[0]),
            bending_stiffness_2=self.number(self.there.rod.bending_stiffness),
            length_2=self.number(lengths[1]),
        )
        return buckled_mode(
            critical_load=float(load),
            bending_stiffness_1=self.number(self.there.wall.bending_stiffness),
            length_1=self.number(lengths[0]),
            bending_stiffness_2=self.number(self.there.rod.bending_stiffness),
            length_2=self.number(lengths[1]),
        )

    def column(self, mode: TrialMode | None) -> Callable[..., Array]:
        """Critical load: an unknown, at most that of one shape with the stiffer segment's shear."""

        def critical(
            design: Design, wall: Wall, rod: RodSection, lengths: tuple[Array, Array]
        ) -> Array:
            if mode is None:
                return rod_strength.critical_load(design, wall, rod, lengths)
            load = trial_mode_load(
                mode=mode,
                bending_stiffness_1=wall.bending_stiffness,
                length_1=lengths[0],
                bending_stiffness_2=rod.bending_stiffness,
                length_2=lengths[1],
            )
            stiffer = maximum(wall.shear_stiffness, rod.shear_stiffness)
            symbol = self.unknown("critical_load", lambda done: done.beam.critical)
            most = column.engesser_load(critical_load=load, shear_stiffness=stiffer)
            self.problem.facts.append((most, symbol))
            return symbol

        return critical

    def laminate(
        self, v: Values, design: Design, stock: MaterialValues, g: Geometry, state: LoadState
    ) -> Wall:
        """A laminated wall: growth and axial stiffness unknown between their bounds.

        Its swelling is that of a held wall: growth without axial strain, stretch without radial
        motion. Its strength is only `bearable`.

        Raises
        ------
        Unknown
            the wall has single plies, or is a membrane
        """
        if kind(design, stock.materials) != "layered":
            raise Unknown("a membrane wall has no envelope")
        layers = plies.layers(v, stock, design.barrel.layup, "barrel.layup", (), [])
        if not all(layer.balanced for layer in layers):
            raise Unknown("a wall of unbalanced single plies, which twists, has no envelope")
        walls = [solid_rotated(stiffness=layer.solid, angle=layer.angle) for layer in layers]
        thicknesses = [layer.thickness for layer in layers]
        self.bearable = _bearable(v, design, stock, g)
        growth, held, stiffness = self._elastic(walls, thicknesses, g.inner_radius)
        supply = self.unknown("grown", lambda done: done.wall.growth)
        own = supply
        if not np.array_equal(np.ravel(state.driven_pressure), np.ravel(v["supply.pressure"])):
            own = self.unknown("grown_own", lambda done: done.wall.case_growth)
        self.problem.facts += [
            (supply, v["supply.pressure"] * growth),
            (own, state.driven_pressure * growth),
        ]
        bending, shear = rod_models.layered_section(
            walls=walls, thicknesses=thicknesses, inner_diameter=2 * g.inner_radius
        )
        along = tube_bounds.axial_stiffness(
            moduli=[one[0] for one in walls], thicknesses=thicknesses, inner_radius=g.inner_radius
        )
        rigid = Swelling(growth=held, shortening=0.0, stretch=1 / along, growth_by_force=0.0)
        return Wall(
            swelling=rigid,
            path=self._path(v, design, stock, g, state, rigid),
            growth=supply,
            case_growth=own,
            bending_stiffness=bending,
            shear_stiffness=shear,
            thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
            layered=len(layers) > 1,
            axial_line_stiffness=stiffness / (math.pi * (g.inner_radius + g.outer_radius)),
            why_no_mismatch="not covered by the relaxation",
            missing=["not covered by the relaxation"],
        )

    def _elastic(
        self, walls: Sequence[Sequence[Array]], thicknesses: Sequence[Array], radius: Array
    ) -> tuple[Symbol, Symbol, Symbol]:
        """Growth per pressure of a laminated wall, free and held axially; axial stiffness."""
        growth = self.problem.unknown("growth", lambda done: self.number(done.wall.swelling.growth))
        held = self.problem.unknown(
            "held_growth", lambda done: self.number(_held_growth(done.wall.swelling))
        )
        stiffness = self.problem.unknown(
            "axial_stiffness", lambda done: self.number(1 / done.wall.swelling.stretch)
        )
        size = {"thicknesses": thicknesses, "inner_radius": radius}
        least = tube_bounds.least_growth(
            hoop=[one[3] for one in walls],
            cross=[one[4] for one in walls],
            radial=[one[5] for one in walls],
            decays=self.decays,
            **size,
        )
        free = [rod_models.free_modulus(wall=one) for one in walls]
        alike = [_contracting(one, CONTRACTION) for one in walls]
        self.problem.facts += [
            (held, least),
            (growth, held),
            (stiffness, tube_bounds.axial_stiffness(moduli=free, **size)),
            (tube_bounds.axial_stiffness(moduli=alike, **size), stiffness),
        ]
        return growth, held, stiffness

    def stiffness(self, springs: Springs, share: float) -> Array:
        """Upper bound on the stiffness of both chambers at a share of the stroke."""
        cap = self.subject.design.cylinder.mount.startswith("cap")
        pulling: Chamber = "b" if cap else "a"
        there = self._gives(self.there.springs, share, pulling)
        motion = least_energy_motion(
            **{name: self.number(value) for name, value in there.items()}, pulling=pulling
        )
        gives = self._gives(springs, share, pulling)
        return trial_motion_stiffness(motion=motion, **gives, pulling=pulling)

    @staticmethod
    def _gives(springs: Springs, share: float, pulling: Chamber) -> dict[str, Array]:
        """Compliances of both chambers at a share of the stroke."""
        g = springs.geometry
        kept = [cause for cause in springs.chambers if cause not in ("barrel", "stretch")]
        x = share * g.stroke
        oil, wall = springs.total(kept).at(x, g.stroke), springs.total(["barrel"]).at(x, g.stroke)
        pulled = springs.chambers["stretch"]
        return {
            "area_a": g.area_a,
            "area_b": g.area_b,
            "oil_a": oil.a,
            "oil_b": oil.b,
            "wall_a": wall.a,
            "wall_b": wall.b,
            "stretch": pulled.a0 if pulling == "a" else pulled.b0,
        }

    @staticmethod
    def joint(done: Statics, out: MetricArrays) -> None:
        """Treat the joint of caps and head where its factor is not convex."""
        held = done.joint
        if held is None or held.joint.envelope is None:
            return
        burst = out.metrics.get("retention_burst_factor", {})
        found = held.joint.envelope(held.loaded, burst)
        if found:
            out.metrics["retention_factor"] = dict(found)

    def _path(
        self,
        v: Values,
        design: Design,
        stock: MaterialValues,
        g: Geometry,
        state: LoadState,
        swelling: Swelling,
    ) -> LoadPath:
        """Axial force in a laminated wall; between tie rods its share is unknown."""
        if not clamped(design):
            return wall.load_path(v, design, stock, g, state, swelling)
        name = wall.STOP if design.cylinder.end_stop == "internal" else wall.LARGEST
        share = self.problem.unknown(
            "barrel_share", lambda done: self.number(done.wall.path.per_pressure[name])
        )
        supply = v["supply.pressure"]
        proof = v["supply.proof_ratio"] * supply
        preload = v.get("retention.preload", proof * share)
        largest = supply * (wall.largest_area(design, g) - share) + preload
        rods = Clamp(preload, largest, preload / (proof * share))
        barrel = 1 / (swelling.stretch * g.barrel_length)
        whole = barrel + wall.clamp_stiffness(v, design, stock, g)
        return wall.LoadPath({name: share}, 0.0, 0.0, rods, barrel / whole)


def refuse(design: Design) -> None:
    """Reject designs with models that have no envelope yet.

    Raises
    ------
    Unknown
        names the model
    """
    elements = [*design.seals.piston.elements().values(), *design.seals.rod.elements().values()]
    for there, what in (
        (bool(design.rod.layup), "a rod of layers"),
        (design.linkage is not None, "a linkage"),
        (any(element.friction_law.film for element in elements), "a seal with an oil film"),
    ):
        if there:
            raise Unknown(f"{what} has no envelope yet")


def layered(subject: PreparedDesign) -> bool:
    """Whether the wall of a design is layered."""
    return kind(subject.design, subject.materials) in LAMINATES


def decays(
    subject: PreparedDesign, v: Values, there: ModelRun, free: Container[str]
) -> list[list[float]]:
    """Decay of the displacement through the parts of each layer of an evaluated design.

    A layer whose angle is one of the PATHs `free` is one part.
    """
    if not layered(subject):
        return []
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    plain = plies.layers(v, stock, subject.design.barrel.layup, "barrel.layup", (), [])
    counts = [1 if f"barrel.layup[{k}].angle" in free else PARTS for k in range(len(plain))]
    parts = [
        replace(layer.as_tube(), thickness=layer.thickness / count)
        for layer, count in zip(plain, counts, strict=True)
        for _ in range(count)
    ]
    tube = layered_tube(layers=parts, inner_radius=there.geometry.inner_radius)
    state = tube_state(tube=tube, inner_pressure=1.0)
    radius = np.asarray(state.radius).reshape(2, -1)
    moved = np.asarray(state.hoop_strain).reshape(2, -1) * radius
    falls = -np.log(moved[1] / moved[0]) / np.log(radius[1] / radius[0])
    falls = np.where(np.abs(falls) > LEAST_DECAY, falls, LEAST_DECAY)
    ends = np.cumsum(counts)[:-1]
    return [part.tolist() for part in np.split(falls, ends)]


def _held_growth(swelling: Swelling) -> Array:
    """Bore growth per pressure of an axially held wall."""
    pulled = swelling.growth_by_force / swelling.stretch
    return swelling.growth - pulled * swelling.shortening


def _contracting(wall: Sequence[Array], contraction: float) -> Array:
    """Axial modulus of a layer that contracts by a given share of its strain."""
    zz, zt, zr, tt, tr, rr = wall[:6]
    return zz - 2 * contraction * (zt + zr) + contraction**2 * (tt + 2 * tr + rr)


def _bearable(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> Array | None:
    """Upper bound on the pressure of any laminated wall before first damage.

    None if not proven: another criterion, autofrettage, strengths not stated, or a ply stiffer
    through the wall than around it.
    """
    if design.barrel.criterion != "max_stress" or design.barrel.autofrettage_pressure is not None:
        return None
    states, missing = plies.climates(v, design), list[str]()
    layers = plies.layers(v, stock, design.barrel.layup, "barrel.layup", states, missing)
    if missing or not all(_wraps(layer) for layer in layers):
        return None
    return tube_bounds.greatest_pressure(
        yields=[_largest(layer.yields) if layer.yields else None for layer in layers],
        hoops=[_hoop(layer) if layer.strengths else None for layer in layers],
        thicknesses=[layer.thickness for layer in layers],
        inner_radius=g.inner_radius,
    )


def _hoop(layer: plies.Layer) -> Array:
    """Largest hoop stress of a ply in its best climate, at least that along its fibres.

    Axial strain and temperature alone stress a ply in the hoop direction far less, by the
    equilibrium of the wall (`tube_bounds.greatest_pressure`).
    """
    strengths = layer.strengths
    along = _largest([strength.tension_1 for strength in strengths])
    around = tube_bounds.ply_hoop_strength(
        tension_1=along,
        tension_2=_largest([strength.tension_2 for strength in strengths]),
        shear_12=_largest([strength.shear_12 for strength in strengths]),
        angle=layer.angle,
    )
    return maximum(around, along)


def _largest(values: Sequence[Array]) -> float:
    """The largest of some numbers; a variable one counts with its upper bound."""
    return max(bounds_of(one)[1] for value in values for one in np.ravel(value))


def _wraps(layer: plies.Layer) -> bool:
    """Whether a layer is as stiff around the tube as through its wall, at any angle."""
    if layer.isotropic:
        return True
    low, high = bounds_of(layer.angle)
    if any(isinstance(part, Symbol) for part in layer.solid):
        return False
    c11, c12, _, c22, _, c33, c66 = (float(np.max(part)) for part in layer.solid)
    room = 1 + 1e-9
    stiff = c33 <= c22 * room and c22 <= c11 * room and c22 <= (c12 + 2 * c66) * room
    return stiff and low >= 0 and high <= (math.pi / 2) * room
