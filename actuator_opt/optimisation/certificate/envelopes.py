"""Envelopes of models without a closed expression: unknowns that contain the exact values."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from ...base.numeric import Array, maximum
from ...base.symbolic import Symbol
from ...base.symbolic.expression import bounds_of
from ...design.model import Design
from ...evaluation import PreparedDesign, beam, plies
from ...evaluation.barrel import LAMINATES, Swelling, Wall, compute, kind, load_path
from ...evaluation.barrel.load_path import LoadPath
from ...evaluation.geometry import Geometry
from ...evaluation.kernel import Implicit, ModelRun, Statics
from ...evaluation.limits import MaterialValues, MetricArrays
from ...evaluation.retention import clamped
from ...evaluation.rods import Rod
from ...evaluation.springs import Springs
from ...evaluation.state import LoadState
from ...evaluation.values import Values
from ...joints.joint import Clamp
from ...models import column, rod as rod_models, stepped, tube_bounds
from ...models.layered_tube import layered_tube, tube_state
from ...models.solid_ply import solid_rotated
from ...models.trial_motion import (Chamber, TrialMode, buckled_mode, least_energy_motion, trial_mode_load, trial_motion_stiffness)
from .relaxation import Unknown

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
        lengths = beam.lengths(self.there.geometry, self.there.state)
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

        def critical(design: Design, wall: Wall, rod: Rod, lengths: tuple[Array, Array]) -> Array:
            if mode is None:
                return beam.critical_load(design, wall, rod, lengths)
            load = trial_mode_load(
                mode=mode,
                bending_stiffness_1=wall.bending_stiffness,
                length_1=lengths[0],
                bending_stiffness_2=rod.bending_stiffness,
                length_2=lengths[1],
            )
            stiffer = maximum(wall.shear_stiffness, rod.shear_stiffness)
            found = self.unknown("critical_load", lambda done: done.beam.critical)
            most = column.engesser_load(critical_load=load, shear_stiffness=stiffer)
            self.problem.facts.append((most, found))
            return found

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
        held = done.held
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
            return load_path.derive(v, design, stock, g, state, swelling)
        name = load_path.STOP if design.cylinder.end_stop == "internal" else load_path.LARGEST
        share = self.problem.unknown(
            "barrel_share", lambda done: self.number(done.wall.path.per_pressure[name])
        )
        supply = v["supply.pressure"]
        proof = v["supply.proof_ratio"] * supply
        preload = v.get("retention.preload", proof * share)
        largest = supply * (load_path.largest_area(design, g) - share) + preload
        rods = Clamp(preload, largest, preload / (proof * share))
        barrel = 1 / (swelling.stretch * g.barrel_length)
        whole = barrel + load_path.clamp_stiffness(v, design, stock, g)
        return load_path.LoadPath({name: share}, 0.0, 0.0, rods, barrel / whole)


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
        (any(one.friction_law.film for one in elements), "a seal with an oil film"),
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
    along = _largest([one.tension_1 for one in strengths])
    around = tube_bounds.ply_hoop_strength(
        tension_1=along,
        tension_2=_largest([one.tension_2 for one in strengths]),
        shear_12=_largest([one.shear_12 for one in strengths]),
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
