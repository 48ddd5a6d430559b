"""A round rubber ring in a rectangular groove, squeezed and then pressurised."""

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
    DisplacementBounds,
    ElementProblem,
    ElementState,
    NotConverged,
    check_inputs,
    follow,
)
from .material import Floats, MooneyRivlin
from .mesh import disc
from .section import Assembly, MeshedBody, MountedContact, SealSolution

MOST_FILL = 0.98
"""Largest share of the groove that an incompressible section may fill; the groove's corners always
stay open."""


class RoundRing:
    """A round ring as a finite-element problem, made dimensionless by its section and modulus.

    Parameters
    ----------
    rubber : strain energy, scaled to Young's modulus 1
    around : number of elements along the circumference of the section
    sliding_radius, outward : as in `Assembly`
    """

    def __init__(
        self,
        rubber: MooneyRivlin,
        around: int,
        sliding_radius: float | None,
        outward: int,
    ) -> None:
        mesh = disc(diameter=1.0, around=around)
        self.section = Assembly([MeshedBody(mesh, rubber, (0.0, 0.5))], sliding_radius, outward)
        self.boundary = boundary_nodes(self.section, 0)
        level = level_pair(self.section, len(mesh.nodes), 0.5)
        bounds = DisplacementBounds.none(self.section)
        self.problem = ElementProblem(self.section, bounds, self.wet_part, level)
        self.centre = middle_node(self.section, len(mesh.nodes))
        bounds.lower[2 * self.boundary + 1] = -self.section.nodes[self.boundary, 1]

    def wet_part(self, state: ElementState, places: Floats, pressure: float) -> Floats:
        """Share of the fluid pressure at every node.

        The fluid comes from the left and advances along the ring's upper and lower side.
        """
        pressing = wall_pressing(self.section, state)
        barrier = barriers(self.section, state, places, pressing, pressure)
        start = int(np.argmin(places[self.boundary, 0]))
        wet = np.zeros(len(places))
        for chain in both_ways(self.boundary, start):
            part, last = wetted(chain, barrier, state, pressure)
            wet[part] = 1.0
        if last is None or wet[self.boundary].all():
            raise NotConverged("the fluid leaks past the ring")
        return wet

    def mount(self, squeeze: float, groove_width: float) -> ElementState:
        """Lower the groove bottom and the side walls onto the ring.

        Without friction, it does not matter which of them moves first. The centre of the ring keeps
        its axial position.
        """
        bounds, centre = self.problem.bounds, 2 * self.centre
        state = self.problem.start()
        bounds.lower[centre] = bounds.upper[centre] = 0.0
        for part in np.linspace(0, squeeze, max(1, math.ceil(squeeze / SQUEEZE_STEP)) + 1)[1:]:
            bounds.upper[2 * self.boundary + 1] = 1 - part - self.section.nodes[self.boundary, 1]
            state = equilibrium.solve(self.problem, state, 0.0)
            self.problem.steps += 1
        return self._add_groove_walls(state, groove_width)

    def _add_groove_walls(self, state: ElementState, groove_width: float) -> ElementState:
        """Add the side walls of the groove; a narrow groove squeezes the ring between them."""
        bounds, place = self.problem.bounds, self.section.places(state.values)
        bounds.lower[2 * self.centre], bounds.upper[2 * self.centre] = -np.inf, np.inf
        state.at_lower[2 * self.centre] = state.at_upper[2 * self.centre] = False
        first = int(self.boundary[np.argmax(place[self.boundary, 0])])
        self.wall = float(place[first, 0])
        nodes = self.section.nodes[self.boundary, 0]
        bounds.upper[2 * self.boundary] = self.wall - nodes
        bounds.lower[2 * self.boundary] = self.wall - groove_width - nodes
        state.at_upper[2 * first] = True
        if np.min(place[self.boundary, 0]) < self.wall - groove_width:
            return equilibrium.solve(self.problem, state, 0.0)
        return state

    def release(self, state: ElementState) -> ElementState:
        """Return the state unchanged, because the ring already touches the outer wall."""
        return state

    def contact(
        self, state: ElementState, pressure: float, length: float, modulus: float
    ) -> MountedContact:
        """Contact on the sliding face in SI, from a solution scaled by `length` and `modulus`."""
        return mounted_contact(
            self.section, state, self.boundary, pressure, length, modulus, wall=self.wall
        )


def squeezed_ring(
    *,
    section: float,
    squeeze: float,
    groove_width: float,
    rubber: MooneyRivlin,
    pressures: Sequence[float] = (),
    sliding_radius: float | None = None,
    on_rod: bool = True,
    elements_around: int = 128,
) -> SealSolution:
    """Mount a round rubber ring in a groove and raise the sealed pressure on one side.

    Walls are rigid and frictionless, and there is no extrusion gap. The ring rests against the
    outer side wall. The fluid acts on every part of the boundary that it reaches.

    Parameters
    ----------
    section : free section W [m]
    squeeze : radial compression of the ring divided by its free section [-]
    groove_width : axial width of the groove [m]
    rubber : strain energy of the rubber
    pressures : sealed pressures above the outer pressure, increasing [Pa]
    sliding_radius : radius of rod or bore [m]; None for plane strain
    on_rod : whether the sliding face is a rod (groove outside) or a bore
    elements_around : number of elements along the circumference of the section, a multiple of 4

    Returns
    -------
    contact of the ring without pressure, then one for every pressure that was reached; if a
    pressure was not reached, the reason

    Notes
    -----
    Valid: squeeze 0.02 to 0.35, section fits the groove; no friction, no relaxation.

    The ring is not stretched around the rod and does not roll.

    References
    ----------
    [derived] total Lagrangian formulation with Taylor-Hood elements; contact as bounds on
    displacements

    Examples
    --------
    >>> ring = squeezed_ring(
    ...     section=2e-3, squeeze=0.15, groove_width=2.8e-3, rubber=MooneyRivlin.of_modulus(6e6)
    ... )
    >>> print(f"{ring.contacts[0].line_load / (2e-3 * 6e6):.3f} of section times modulus")
    0.096 of section times modulus
    """
    area, room = math.pi / 4 * section**2, section * (1 - squeeze) * groove_width
    check_inputs(
        section,
        squeeze,
        rubber,
        pressures,
        elements_around,
        (
            not area <= MOST_FILL * room,
            f"the section of {area:.3g} m^2 fills its groove of {room:.3g} m^2",
            "widen the groove",
        ),
    )
    modulus = rubber.youngs_modulus
    ring = RoundRing(
        rubber.over(modulus),
        elements_around,
        None if sliding_radius is None else sliding_radius / section,
        1 if on_rod else -1,
    )
    return follow(ring, squeeze, groove_width / section, pressures, section, modulus)
