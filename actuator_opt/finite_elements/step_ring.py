"""A step ring: a stiff slide ring on the rod, energised by a squeezed rubber ring behind it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from . import equilibrium
from .contact import (
    barriers,
    both_ways,
    boundary_nodes,
    level_pair,
    middle_node,
    mounted_contact,
    wall_pressing,
    wetted,
)
from .equilibrium import (
    SQUEEZE_STEP,
    ContactPair,
    DisplacementBounds,
    ElementProblem,
    ElementState,
    NotConverged,
    check_inputs,
    follow,
)
from .material import Floats, MooneyRivlin
from .mesh import SlideRing, disc, slide_ring
from .section import Assembly, MeshedBody, MountedContact, SealSolution

COARSE = 0.12
"""Largest element size of the slide ring, relative to the section of the rubber ring."""
RAMP = 0.03
"""The fluid pressure on the back of the slide ring does not drop abruptly where the fluid ends, but
linearly, from this distance before it to this distance beyond it. The distance is a share of the
rubber's section and equals the spacing of the nodes there."""
SHIFT_STEP = 0.05
"""Axial displacement of the rubber ring per load step, as a share of its section."""


class StepRing:
    """Both rings as a finite-element problem, scaled by the rubber's section and modulus.

    Parameters
    ----------
    rubber, plastic : strain energies, scaled so that the rubber's Young's modulus is 1
    shape : dimensions of the slide ring
    around : number of elements along the circumference of the rubber's section
    fine : element size at the ends of the land
    sliding_radius, outward : as in `Assembly`
    """

    def __init__(
        self,
        rubber: MooneyRivlin,
        plastic: MooneyRivlin,
        shape: SlideRing,
        around: int,
        fine: float,
        sliding_radius: float | None,
        outward: int,
    ) -> None:
        middle = shape.thickness + 0.5
        round_mesh, flat_mesh = (
            disc(diameter=1.0, around=around),
            slide_ring(shape, fine=fine, coarse=COARSE),
        )
        self.section = Assembly(
            [
                MeshedBody(round_mesh, rubber, (-shape.width / 2, middle)),
                MeshedBody(flat_mesh, plastic),
            ],
            sliding_radius,
            outward,
        )
        self.round, self.flat = (boundary_nodes(self.section, body) for body in (0, 1))
        nodes = self.section.nodes
        back = nodes[self.section.edges[1], 1].min(axis=1) > shape.thickness - 1e-9
        self.pair = ContactPair(self.round, self.section.edges[1][back])
        level = level_pair(self.section, len(round_mesh.nodes), middle)
        bounds = DisplacementBounds.none(self.section)
        self.problem = ElementProblem(self.section, bounds, self.wet_part, level, self.pair)
        self.centre = middle_node(self.section, len(round_mesh.nodes))
        at_end = self.flat[nodes[self.flat, 0] > -1e-9]
        self.end = int(at_end[np.argmin(np.abs(nodes[at_end, 1] - shape.thickness / 2))])
        sealed = np.abs(nodes[self.flat] - [-shape.width, shape.thickness / 2])
        self.sealed_end = int(np.argmin(sealed.sum(axis=1)))
        bounds.lower[2 * self.flat + 1] = -nodes[self.flat, 1]
        bounds.upper[2 * self.flat] = -nodes[self.flat, 0]
        self.top = shape.thickness + 1
        self.front = (0.0, -1, -1)
        self.groove_width = math.inf
        self.back_wet: Floats = np.zeros(len(nodes))

    def wet_part(self, state: ElementState, places: Floats, pressure: float) -> Floats:
        """Share of the fluid pressure at every node.

        The fluid comes from the left and also enters between the rings, up to their contact.
        """
        pressing = wall_pressing(self.section, state)
        pressing[self.round] += state.pair_force
        barrier = barriers(self.section, state, places, pressing, pressure)
        wet = np.zeros(len(places))
        start = int(np.argmin(places[self.round, 0]))
        lower, upper = both_ways(self.round, start)
        for chain in (upper, lower):
            part, last = wetted(chain, barrier, state, pressure)
            wet[part] = 1.0
        if len(part) in (last, len(lower)):
            raise NotConverged("the fluid passes between the rings")
        front = int(lower[len(part) - 1]), int(lower[len(part)])
        if (pressure, *front) != self.front:
            self.front = (pressure, *front)
            self.back_wet = self._wet_back(places, float(np.mean(places[list(front), 0])))
        wet += self.back_wet
        face, _ = both_ways(self.flat, self.sealed_end)
        part, last = wetted(face, barrier, state, pressure)
        if len(part) == last:
            raise NotConverged("the fluid leaks past the slide ring")
        wet[part] = 1.0
        return np.minimum(wet, 1.0)

    def _wet_back(self, places: Floats, front: float) -> Floats:
        """Share of the fluid pressure on the back of the slide ring, which drops to 0 at `front`.

        This share is kept until the fluid between the rings reaches another node. If it followed
        every motion of the nodes, the iteration for a tilting ring would oscillate.
        """
        _, back = both_ways(self.flat, self.sealed_end)
        x = places[back, 0]
        beyond = np.flatnonzero(x > front + RAMP)
        if not len(beyond):
            raise NotConverged("the fluid passes between the rings")
        count = int(beyond[0])
        share = np.zeros(len(places))
        share[back[:count]] = np.clip((front - x[:count]) / (2 * RAMP) + 0.5, 0.0, 1.0)
        return share

    def _hold(self, unknown: int, value: float) -> None:
        self.problem.bounds.lower[unknown] = self.problem.bounds.upper[unknown] = value

    def mount(self, squeeze: float, groove_width: float) -> ElementState:
        """Lower the groove bottom onto the rubber ring, which lies on the slide ring's middle."""
        self.groove_width = groove_width
        nodes, bounds, problem = self.section.nodes, self.problem.bounds, self.problem
        state = problem.start()
        state.at_lower[2 * self.flat + 1] = nodes[self.flat, 1] < 1e-9
        self._hold(2 * self.centre, 0.0)
        self._hold(2 * self.end, 0.0)
        for part in np.linspace(0, squeeze, max(1, math.ceil(squeeze / SQUEEZE_STEP)) + 1)[1:]:
            bounds.upper[2 * self.round + 1] = self.top - part - nodes[self.round, 1]
            state = equilibrium.solve(problem, state, 0.0)
            problem.steps += 1
        return state

    def release(self, state: ElementState) -> ElementState:
        """Move the rubber ring to the outer side wall, then free both rings axially."""
        nodes, bounds, problem = self.section.nodes, self.problem.bounds, self.problem
        distance = -float(np.max(self.section.places(state.values)[self.round, 0]))
        for part in np.linspace(0, distance, math.ceil(abs(distance) / SHIFT_STEP) + 1)[1:]:
            self._hold(2 * self.centre, part)
            state = equilibrium.solve(problem, state, 0.0)
            problem.steps += 1
        places = self.section.places(state.values)
        for unknown in (2 * self.centre, 2 * self.end):
            bounds.lower[unknown], bounds.upper[unknown] = -np.inf, np.inf
            state.at_lower[unknown] = state.at_upper[unknown] = False
        bounds.upper[2 * self.end] = -nodes[self.end, 0]
        first = int(self.round[np.argmax(places[self.round, 0])])
        bounds.upper[2 * self.round] = -nodes[self.round, 0]
        bounds.upper[2 * first] = max(places[first, 0], 0.0) - nodes[first, 0]
        bounds.lower[2 * self.round] = -self.groove_width - nodes[self.round, 0]
        state.at_upper[[2 * first, 2 * self.end]] = True
        return state

    def contact(
        self, state: ElementState, pressure: float, length: float, modulus: float
    ) -> MountedContact:
        """Contact on the rod in SI, from a solution scaled by `length` and `modulus`."""
        return mounted_contact(self.section, state, self.flat, pressure, length, modulus)


def squeezed_step_ring(
    *,
    section: float,
    squeeze: float,
    groove_width: float,
    rubber: MooneyRivlin,
    plastic: MooneyRivlin,
    shape: SlideRing,
    pressures: Sequence[float] = (),
    sliding_radius: float | None = None,
    on_rod: bool = True,
    elements_around: int = 64,
    edge_elements: int = 4,
) -> SealSolution:
    """Mount a slide ring with its rubber ring in a groove and raise the sealed pressure.

    Walls, rod and the contact between the rings are frictionless, and there is no extrusion gap.
    Both rings rest against the outer side wall. Plastic and rubber are elastic.

    Parameters
    ----------
    section : free section W of the rubber ring [m]
    squeeze : radial compression of the rubber ring divided by its free section [-]
    groove_width : axial width of the groove [m]
    rubber : strain energy of the rubber ring
    plastic : strain energy of the slide ring
    shape : section of the slide ring
    pressures : sealed pressures above the outer pressure, increasing [Pa]
    sliding_radius : radius of rod or bore [m]; None for plane strain
    on_rod : whether the sliding face is a rod (groove outside) or a bore
    elements_around : number of elements along the circumference of the rubber's section, a multiple
        of 4
    edge_elements : number of elements along the rounding at each end of the land

    Returns
    -------
    contact of the seal without pressure, then one for every pressure that was reached; if a
    pressure was not reached, the reason

    Notes
    -----
    Valid: no friction, no creep, no yielding of the plastic, closed groove corners.

    Line load and contact width hardly depend on the mesh. The peak pressure at an end of the land
    does; it needs at least 8 `edge_elements`.

    References
    ----------
    [derived] total Lagrangian formulation with Taylor-Hood elements; contact with walls as bounds
    on displacements, contact of the rings as constraints between nodes and surface

    Examples
    --------
    >>> shape = SlideRing(4e-3, 1.5e-3, 3e-3, 0.5e-3, 0.3e-3, 0.12, 0.15e-3)
    >>> seal = squeezed_step_ring(
    ...     section=2.6e-3, squeeze=0.15, groove_width=4.2e-3, rubber=MooneyRivlin.of_modulus(8e6),
    ...     plastic=MooneyRivlin.of_modulus(5e8, poissons_ratio=0.46), shape=shape,
    ...     elements_around=32, edge_elements=2,
    ... )
    >>> print(f"{seal.contacts[0].line_load / (2.6e-3 * 8e6):.3f} of section times modulus")
    0.095 of section times modulus
    """
    faults = _slide_ring_faults(shape, plastic, groove_width)
    check_inputs(section, squeeze, rubber, pressures, elements_around, *faults)
    modulus = rubber.youngs_modulus
    seal = StepRing(
        rubber.over(modulus),
        plastic.over(modulus),
        shape.over(section),
        elements_around,
        shape.edge_radius / section / edge_elements,
        None if sliding_radius is None else sliding_radius / section,
        1 if on_rod else -1,
    )
    return follow(seal, squeeze, groove_width / section, pressures, section, modulus)


def _slide_ring_faults(
    shape: SlideRing, plastic: MooneyRivlin, groove_width: float
) -> tuple[tuple[bool, str, str], ...]:
    """Possible faults of a slide ring: whether each is present, message and remedy."""
    thinnest = shape.thickness - max(shape.chamfer_height, float(shape.face(np.zeros(1))[0]))
    return (
        (
            not shape.width <= groove_width,
            f"the slide ring is {shape.width:g} m wide, but its groove {groove_width:g} m",
            "widen the groove",
        ),
        (
            not min(shape.thickness, shape.land_width, shape.chamfer_width) > 0,
            "thickness, land width or chamfer width of the slide ring is not positive",
            "give all three",
        ),
        (
            not shape.chamfer_width + shape.land_width < shape.width,
            "chamfer and land leave no width for the relief of the slide ring",
            "shorten them",
        ),
        (
            not 0 <= shape.relief_angle < 1,
            f"relief angle {shape.relief_angle:g} rad is outside 0 to 1",
            "give the slope of the face behind the land",
        ),
        (not plastic.youngs_modulus > 0, "the plastic has no stiffness", "give its modulus"),
        (not shape.edge_radius > 0, "the land has sharp ends", "give their edge_radius"),
        (
            not thinnest >= 0.2 * shape.thickness,
            "chamfer or relief uses up the thickness of the slide ring",
            "make chamfer and relief flatter, or the ring thicker",
        ),
    )
