"""Models without a closed expression, as unknown quantities between upper and lower estimates."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from ...base.numeric import Array, maximum
from ...base.symbolic import Symbol
from ...base.symbolic.bounds import bounds_of
from ...design.model import Design
from ...evaluation import PreparedDesign, plies, rod_strength
from ...evaluation.barrel import LAMINATES, OWN, Swelling, Wall, compute, kind, wall
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
from ...models.piston_nut import preload_range
from ...models.solid_ply import solid_rotated
from ...models.trial_motion import (
    Chamber,
    TrialMode,
    buckled_mode,
    least_energy_motion,
    trial_mode_load,
    trial_motion_stiffness,
)
from .relaxation import (
    Unknown,
)

LEAST_DECAY = 1e-3
"""Least exponent with which the displacement decays through a part of a layer, to avoid exponent 0.
"""


PARTS = 4
"""Number of parts into which each layer of known stiffness is cut in the bound on a wall's growth.
The bound is valid with any number."""


CONTRACTION = 0.2
"""Transverse contraction per axial strain, assumed in the bound on a wall's axial stiffness. The
bound is valid with any value.
"""


class EnvelopeProblem(Protocol):
    """Collects the unknown quantities of envelopes, and the relations between them."""

    facts: list[tuple[Any, Any]]

    def unknown(self, name: str, exact: Callable[[ModelRun], float]) -> Symbol:
        """Add a positive unknown."""


class Envelopes:
    """Bounds on models without a closed formula, in one load case.

    For the evaluated design `reference`, the bounds are exact.
    """

    def __init__(
        self,
        problem: EnvelopeProblem,
        subject: PreparedDesign,
        reference: ModelRun,
        decays: Sequence[Sequence[float]],
        case: int,
    ) -> None:
        self.problem, self.subject, self.reference = problem, subject, reference
        self.decays, self.case = decays, case
        self.bearable: Array | None = None
        """Upper bound on the pressure that a laminated wall bears before first damage; None if
        unknown."""

    def implicit(self) -> Implicit:
        """The models that the trace uses in place of the evaluation's own models."""
        return Implicit(
            wall=self.laminate if layered(self.subject) else compute,
            critical_load=self.column(self._mode()),
        )

    def number(self, value: Array) -> float:
        """The entry of an evaluated result that belongs to this load case."""
        rows = np.atleast_2d(np.asarray(value, dtype=float))
        return float(rows[min(self.case, len(rows) - 1), 0])

    def unknown(self, name: str, exact: Callable[[ModelRun], Array]) -> Symbol:
        """Add an unknown quantity of this load case."""
        return self.problem.unknown(f"{name}_{self.case}", lambda run: self.number(exact(run)))

    def _mode(self) -> TrialMode | None:
        """The shape in which the evaluated design buckles between its pins."""
        if self.subject.design.cylinder.mount != "cap_clevis":
            return None
        lengths = rod_strength.lengths(self.reference.geometry, self.reference.state)
        load = stepped.stepped_column_load(
            bending_stiffness_1=self.number(self.reference.wall.bending_stiffness),
            length_1=self.number(lengths[0]),
            bending_stiffness_2=self.number(self.reference.rod.bending_stiffness),
            length_2=self.number(lengths[1]),
        )
        return buckled_mode(
            critical_load=float(load),
            bending_stiffness_1=self.number(self.reference.wall.bending_stiffness),
            length_1=self.number(lengths[0]),
            bending_stiffness_2=self.number(self.reference.rod.bending_stiffness),
            length_2=self.number(lengths[1]),
        )

    def column(self, mode: TrialMode | None) -> Callable[..., Array]:
        """Model of the buckling load: an unknown quantity with an upper bound.

        The bound is the load for an assumed (trial) buckling shape `mode`, with the shear stiffness
        of the stiffer segment. Without a shape, the load is computed from its formula.
        """

        def critical(
            seat: rod_strength.Seat, wall: Wall, rod: RodSection, lengths: tuple[Array, Array]
        ) -> Array:
            if mode is None:
                return rod_strength.critical_load(seat, wall, rod, lengths)
            load = trial_mode_load(
                mode=mode,
                bending_stiffness_1=wall.bending_stiffness,
                length_1=lengths[0],
                bending_stiffness_2=rod.bending_stiffness,
                length_2=lengths[1],
            )
            stiffer = maximum(wall.shear_stiffness, rod.shear_stiffness)
            symbol = self.unknown("critical_load", lambda run: run.beam.critical)
            upper_bound = column.engesser_load(critical_load=load, shear_stiffness=stiffer)
            self.problem.facts.append((upper_bound, symbol))
            return symbol

        return critical

    def laminate(
        self, v: Values, design: Design, stock: MaterialValues, g: Geometry, state: LoadState
    ) -> Wall:
        """A laminated wall whose bore growth and axial stiffness are unknowns between bounds.

        Radial and axial motion are taken as uncoupled: the bore grows without axial strain, and the
        wall stretches without radial motion. The wall's strength enters only through `bearable`.

        Raises
        ------
        Unknown
            the wall has single plies, or is a membrane
        """
        if kind(design, stock.materials) != "layered":
            raise Unknown("no bound is implemented for a membrane wall")
        layers = plies.layers(v, stock, design.barrel.layup, "barrel.layup", (), [])
        if not all(layer.balanced for layer in layers):
            raise Unknown("no bound is implemented for a wall of unbalanced plies, which twists")
        walls = [solid_rotated(stiffness=layer.solid, angle=layer.angle) for layer in layers]
        thicknesses = [layer.thickness for layer in layers]
        self.bearable = _bearable(v, design, stock, g)
        growth, held_growth, stiffness = self._elastic(walls, thicknesses, g.inner_radius)
        supply_growth = self.unknown("grown", lambda run: run.wall.growth)
        case_growth = supply_growth
        if not np.array_equal(np.ravel(state.driven_pressure), np.ravel(v["supply.pressure"])):
            case_growth = self.unknown("grown_own", lambda run: run.wall.case_growth)
        self.problem.facts += [
            (supply_growth, v["supply.pressure"] * growth),
            (case_growth, state.driven_pressure * growth),
        ]
        bending, shear = rod_models.layered_section(
            walls=walls, thicknesses=thicknesses, inner_diameter=2 * g.inner_radius
        )
        axial_stiffness = tube_bounds.axial_stiffness(
            moduli=[one[0] for one in walls], thicknesses=thicknesses, inner_radius=g.inner_radius
        )
        rigid = Swelling(
            growth=held_growth, shortening=0.0, stretch=1 / axial_stiffness, growth_by_force=0.0
        )
        return Wall(
            swelling=rigid,
            path=self._path(v, design, stock, g, state, rigid),
            growths={OWN: supply_growth},
            case_growth=case_growth,
            bending_stiffness=bending,
            shear_stiffness=shear,
            thin_ratio=(g.outer_radius - g.inner_radius) / g.inner_radius,
            layered=len(layers) > 1,
            axial_line_stiffness=stiffness / (math.pi * (g.inner_radius + g.outer_radius)),
            why_no_mismatch="the proof does not cover it",
            missing=["the proof does not cover it"],
        )

    def _elastic(
        self, walls: Sequence[Sequence[Array]], thicknesses: Sequence[Array], radius: Array
    ) -> tuple[Symbol, Symbol, Symbol]:
        """Bore growth per unit pressure, axially free and fixed, and axial stiffness of a wall."""
        growth = self.problem.unknown("growth", lambda run: self.number(run.wall.swelling.growth))
        held_growth = self.problem.unknown(
            "held_growth", lambda run: self.number(_held_growth(run.wall.swelling))
        )
        stiffness = self.problem.unknown(
            "axial_stiffness", lambda run: self.number(1 / run.wall.swelling.stretch)
        )
        size = {"thicknesses": thicknesses, "inner_radius": radius}
        least_growth = tube_bounds.least_growth(
            hoop=[wall[3] for wall in walls],
            cross=[wall[4] for wall in walls],
            radial=[wall[5] for wall in walls],
            decays=self.decays,
            **size,
        )
        free_moduli = [rod_models.free_modulus(wall=wall) for wall in walls]
        contracting_moduli = [_contracting(wall, CONTRACTION) for wall in walls]
        self.problem.facts += [
            (held_growth, least_growth),
            (growth, held_growth),
            (stiffness, tube_bounds.axial_stiffness(moduli=free_moduli, **size)),
            (tube_bounds.axial_stiffness(moduli=contracting_moduli, **size), stiffness),
        ]
        return growth, held_growth, stiffness

    def stiffness(self, springs: Springs, share: float) -> Array:
        """Upper bound on the stiffness of both chambers at a share of the stroke."""
        cap = self.subject.design.cylinder.mount.startswith("cap")
        pulling: Chamber = "b" if cap else "a"
        reference = self._compliances(self.reference.springs, share, pulling)
        motion = least_energy_motion(
            **{name: self.number(value) for name, value in reference.items()}, pulling=pulling
        )
        compliances = self._compliances(springs, share, pulling)
        return trial_motion_stiffness(motion=motion, **compliances, pulling=pulling)

    @staticmethod
    def _compliances(springs: Springs, share: float, pulling: Chamber) -> dict[str, Array]:
        """Compliances of both chambers, at a piston position as a share of the stroke."""
        g = springs.geometry
        causes = [cause for cause in springs.chambers if cause not in ("barrel", "stretch")]
        x = share * g.stroke
        oil, wall = springs.total(causes).at(x, g.stroke), springs.total(["barrel"]).at(x, g.stroke)
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
    def joint(statics: Statics, out: MetricArrays) -> None:
        """Replace the retention factor of the barrel ends' joints by an unknown between estimates.

        Nothing changes for a joint that has no such factor or no estimates.
        """
        for end in statics.joints:
            if end.joint.envelope is None:
                continue
            factors, burst = (
                {place: x for place, x in out.metrics.get(name, {}).items()
                 if place.startswith(end.end_joint.name)}
                for name in ("retention_factor", "retention_burst_factor")
            )  # fmt: skip
            estimates = end.placed(end.joint.envelope(end.loaded, burst))
            if estimates:
                others = out.metrics.get("retention_factor", {}).items()
                out.metrics["retention_factor"] = estimates | {
                    place: x for place, x in others if place not in factors
                }

    def _path(
        self,
        v: Values,
        design: Design,
        stock: MaterialValues,
        g: Geometry,
        state: LoadState,
        swelling: Swelling,
    ) -> LoadPath:
        """Axial force in a laminated wall; with tie rods, the wall's share is an unknown.

        Settling and temperature, which only lower the least preload, are left out.
        """
        if not clamped(design):
            return wall.load_path(v, design, stock, g, state, swelling)
        name = wall.STOP if design.cylinder.end_stop == "internal" else wall.LARGEST
        share = self.problem.unknown(
            "barrel_share", lambda run: self.number(run.wall.path.per_pressure[name])
        )
        supply = v["supply.pressure"]
        proof = v["supply.proof_ratio"] * supply
        springs = wall.clamping(v, design, stock, g)
        low, high = preload_range(preload=1.0, tightening_factor=springs.tightening_factor)
        preload = v.get("retention.preload", proof * share / low)
        added = supply * (wall.largest_area(design, g) - share)
        rods = Clamp(
            preload, preload * high, added, {"at assembly": preload * low / (proof * share)}
        )
        barrel = 1 / (swelling.stretch * g.barrel_length)
        total = barrel + springs.stiffness
        return wall.LoadPath({name: share}, 0.0, 0.0, rods, barrel / total)


def refuse(design: Design) -> None:
    """Reject a design that uses a model without an envelope (upper and lower estimates).

    Raises
    ------
    Unknown
        a model has no envelope
    """
    elements = [*design.seals.piston.elements().values(), *design.seals.rod.elements().values()]
    for present, model in (
        (bool(design.rod.layup), "a rod of layers"),
        (design.double_rod, "a second rod"),
        (design.linkage is not None, "a linkage"),
        (any(element.friction_law.film for element in elements), "a seal with an oil film"),
    ):
        if present:
            raise Unknown(f"no bound is implemented yet for {model}")


def layered(subject: PreparedDesign) -> bool:
    """Whether a design has a layered wall."""
    return kind(subject.design, subject.materials) in LAMINATES


def decays(
    subject: PreparedDesign, v: Values, run: ModelRun, variables: Container[str]
) -> list[list[float]]:
    """Exponents with which the displacement decays through the parts of each layer.

    A layer whose angle is among the free PATHs `variables` is one part.
    """
    if not layered(subject):
        return []
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    plain = plies.layers(v, stock, subject.design.barrel.layup, "barrel.layup", (), [])
    counts = [1 if f"barrel.layup[{k}].angle" in variables else PARTS for k in range(len(plain))]
    parts = [
        replace(layer.as_tube(), thickness=layer.thickness / count)
        for layer, count in zip(plain, counts, strict=True)
        for _ in range(count)
    ]
    tube = layered_tube(layers=parts, inner_radius=run.geometry.inner_radius)
    state = tube_state(tube=tube, inner_pressure=1.0)
    radius = np.asarray(state.radius).reshape(2, -1)
    displacement = np.asarray(state.hoop_strain).reshape(2, -1) * radius
    rates = -np.log(displacement[1] / displacement[0]) / np.log(radius[1] / radius[0])
    rates = np.where(np.abs(rates) > LEAST_DECAY, rates, LEAST_DECAY)
    ends = np.cumsum(counts)[:-1]
    return [part.tolist() for part in np.split(rates, ends)]


def _held_growth(swelling: Swelling) -> Array:
    """Bore growth per unit pressure of an axially fixed wall."""
    pulled = swelling.growth_by_force / swelling.stretch
    return swelling.growth - pulled * swelling.shortening


def _contracting(wall: Sequence[Array], contraction: float) -> Array:
    """Axial modulus of a layer that contracts transversely by a given share of its axial strain."""
    zz, zt, zr, tt, tr, rr = wall[:6]
    return zz - 2 * contraction * (zt + zr) + contraction**2 * (tt + 2 * tr + rr)


def _bearable(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> Array | None:
    """Upper bound on the pressure that a laminated wall bears before first damage.

    None where no bound is proven: for another failure criterion, with autofrettage, without
    strengths, or with a ply that is stiffer through the wall than around it.
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
    """Largest hoop strength of a ply at its service temperatures; at least its fibre strength.

    So it is far above the hoop stress that axial strain and temperature cause alone, which
    `tube_bounds.greatest_pressure` requires.
    """
    strengths = layer.strengths
    fibre_tension = _largest([strength.tension_1 for strength in strengths])
    around = tube_bounds.ply_hoop_strength(
        tension_1=fibre_tension,
        tension_2=_largest([strength.tension_2 for strength in strengths]),
        shear_12=_largest([strength.shear_12 for strength in strengths]),
        angle=layer.angle,
    )
    return maximum(around, fibre_tension)


def _largest(values: Sequence[Array]) -> float:
    """The largest value; a variable is taken at its upper bound."""
    return max(bounds_of(number)[1] for value in values for number in np.ravel(value))


def _wraps(layer: plies.Layer) -> bool:
    """Whether a layer, at any angle, is at least as stiff around the tube as through its wall."""
    if layer.isotropic:
        return True
    low, high = bounds_of(layer.angle)
    if any(isinstance(part, Symbol) for part in layer.solid):
        return False
    c11, c12, _, c22, _, c33, c66 = (float(np.max(part)) for part in layer.solid)
    room = 1 + 1e-9
    stiff = c33 <= c22 * room and c22 <= c11 * room and c22 <= (c12 + 2 * c66) * room
    return stiff and low >= 0 and high <= (math.pi / 2) * room
