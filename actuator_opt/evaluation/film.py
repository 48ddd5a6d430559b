"""The oil film under a running seal: solved at nodes, a polynomial between them.

Every element, load case and direction has its own surrogate. It runs along the inputs that the
variables of the design move most; all others enter to the first order, by the exact slopes of the
film. Its box follows from the bounds of the variables, so that a design evaluated alone and the
same design inside the optimiser read one film.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log, pi

import numpy as np

from ..errors import Diagnostic, InputError
from ..lubrication import Contact, Elastic, Film, Lubricant, Surface, sensitivities, solve_film
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..models.rough_surface import composite_roughness
from ..numeric import STEP, Array, maximum
from ..surrogate import Answer, Axis, Surrogate, surrogate
from .rings import Ring
from .touch import static_profile

NODES = 121
"""Nodes along the contact: within 0.3 % of finer ones."""

POINTS = 6
"""Nodes of a surrogate along each of its axes."""

MOST_AXES = 2
"""Axes of a surrogate: one more would cost `POINTS` times as many films."""

CHECKS = 4
"""Points of the box at which a surrogate is compared with the film itself."""

EXTENT = 0.02
"""Relative change of an output over the extent of an input below which the first order is
enough."""

LEAST_SQUEEZE = 0.02
"""Squeeze at which the film is held: below it the contact is lost, as the squeeze tells."""


@dataclass(frozen=True, slots=True)
class Running:
    """A running film per case, over the whole circumference.

    Parameters
    ----------
    viscous : drag of the oil, positive against the motion [N]
    load : normal force between the asperities [N]
    flow : towards the outer side [m^3/s]
    thickness : mean film [m]
    viscous_slope, load_slope : derivatives of the first two by the speed [N s/m]
    """

    viscous: Array
    load: Array
    flow: Array
    thickness: Array
    viscous_slope: Array
    load_slope: Array


_OF_RING = (
    "squeeze_left",
    "section",
    "diameter",
    "youngs_modulus",
    "face_modulus",
    "seal_roughness",
    "counterface_roughness",
    "groove_width",
    "gland_depth",
    "thickness",
    "width",
    "land",
    "relief",
    "root_clearance",
)


def inputs(ring: Ring) -> dict[str, Array]:
    """What a film depends on, each above zero; pressures absolute, the squeeze held."""
    outer = ring["outer_pressure"] + ATMOSPHERIC_PRESSURE
    found = {
        "speed": ring["speed"],
        "viscosity": ring["viscosity"],
        "sealed": outer + ring["pressure"],
        "outer": outer,
    }
    found |= {name: ring[name] for name in _OF_RING if name in ring.numbers}
    found["squeeze_left"] = maximum(found["squeeze_left"], LEAST_SQUEEZE)
    return found


def _with(ring: Ring, point: Mapping[str, Array]) -> Ring:
    """The ring at a point of `inputs`."""
    numbers = dict(point)
    outer, sealed = numbers.pop("outer"), numbers.pop("sealed")
    numbers["outer_pressure"] = outer - ATMOSPHERIC_PRESSURE
    return ring.at(**numbers, pressure=sealed - outer)


def contact(ring: Ring, *, outward: bool, nodes: int = NODES) -> Contact:
    """What the film solver takes of a ring; `outward`: its counterface moves to the outer side.

    A complex step may ride on any number.
    """
    outer = ring["outer_pressure"] + ATMOSPHERIC_PRESSURE
    width, static = static_profile(ring, nodes)
    own, other = ring["seal_roughness"], ring["counterface_roughness"]
    roughness = composite_roughness(first=own, second=other)
    return Contact(
        width=width,
        static_pressure=static + ATMOSPHERIC_PRESSURE,
        elastic=Elastic(ring["face_modulus"], ring["face_poissons_ratio"]),
        surface=Surface(
            roughness=roughness,
            asperity_density=ring["asperity_density"],
            asperity_radius=ring["asperity_radius"],
            rod_share=(other / roughness) ** 2,
        ),
        lubricant=Lubricant(
            dynamic_viscosity=ring["viscosity"],
            pressure_law=ring.viscosity_law,
            pressure_coefficient=ring["viscosity_coefficient"],
        ),
        speed=ring["speed"] if outward else -ring["speed"],
        sealed_pressure=outer + ring["pressure"],
        outer_pressure=outer,
    )


def outputs(film: Film) -> tuple[float, float, float, float]:
    """Viscous drag, contact load, flow and mean film of a film."""
    return film.viscous_drag, film.contact_load, film.flow, float(np.mean(film.film))


class _Walker:
    """Films at points near each other, each begun from the one before."""

    def __init__(self, ring: Ring, *, outward: bool) -> None:
        self.ring, self.outward = ring, outward
        self.last: Film | None = None

    def film(self, point: Mapping[str, Array]) -> Film:
        found = solve_film(contact(_with(self.ring, point), outward=self.outward), self.last)
        self.last = found if found.converged else self.last
        return found

    def __call__(self, point: dict[str, float]) -> Answer:
        film = self.film(point)
        if not film.converged:
            return Answer(np.zeros(6), {}, why=film.reason)
        steps = [
            contact(
                _with(self.ring, {**point, name: value * (1 + 1j * STEP)}), outward=self.outward
            )
            for name, value in point.items()
        ]
        found = dict(zip(point, sensitivities(film, steps), strict=True))
        slopes = {name: self._shown(row, np.zeros(2)) for name, row in found.items()}
        by_speed = slopes["speed"][:2] / point["speed"]
        return Answer(self._shown(outputs(film), by_speed), slopes)

    def _shown(self, values: Sequence[float], by_speed: np.ndarray) -> np.ndarray:
        """Drag against the motion, load, flow, film; then the slopes of the first two by speed."""
        drag, load, flow, thickness = values
        sign = 1.0 if self.outward else -1.0
        return np.array([sign * drag, load, flow, thickness, *by_speed])


@dataclass(frozen=True, slots=True)
class Table:
    """The surrogate of one ring's film in one case, and how far it is off at the design."""

    surrogate: Surrogate
    film: Film
    error: float
    """Largest relative difference of the drag to films solved at the design and in the box."""

    def running(self, ring: Ring) -> Running:
        """The film at the numbers of the ring, as arrays (designs,) or floats."""
        around = pi * ring["diameter"]
        viscous, load, flow, thickness, by_speed, load_by_speed = self.surrogate(inputs(ring))
        return Running(
            viscous=around * viscous,
            load=around * load,
            flow=around * flow,
            thickness=thickness,
            viscous_slope=around * by_speed,
            load_slope=around * load_by_speed,
        )


def table(ring: Ring, samples: Sequence[Ring], *, outward: bool) -> Table:
    """The surrogate of a ring of floats over the box that other rings of floats span.

    Raises
    ------
    InputError
        the film has no solution at the ring itself, or at too many points of the box
    """
    walker = _Walker(ring, outward=outward)
    base = {name: float(value) for name, value in inputs(ring).items() if value > 0}
    here = walker(base)
    if here.why:
        raise _unsolved(ring, here.why)
    film = walker.last
    assert film is not None
    others = [inputs(sample) for sample in samples]
    axes = _axes(base, others, here)
    found = surrogate(walker, base=base, axes=axes)
    if found is None:
        raise _unsolved(ring, "too many points within the bounds of the variables have none")
    checks = [base, *others[:CHECKS]] if axes else []
    return Table(found, film, max((_error(ring, walker, found, p) for p in checks), default=0.0))


def _unsolved(ring: Ring, why: str) -> InputError:
    path = ring.groove.path.rstrip(".")
    message = f"the oil film of the {ring.label} has no solution: {why}"
    remedy = (
        'write "friction: coefficient", or bring squeeze, pressure and speed nearer to practice'
    )
    return InputError(Diagnostic(message, remedy, path=f"{path}.friction"))


def _axes(
    base: Mapping[str, float], others: Sequence[Mapping[str, Array]], here: Answer
) -> tuple[Axis, ...]:
    """The inputs whose extent moves drag or load the most."""
    found = []
    scale = np.abs(here.values[:3]) + 1e-3 * abs(here.values[1]) * np.array([1.0, 1.0, 0.0])
    for name, value in base.items():
        values = [value, *(float(other[name]) for other in others)]
        lower, upper = min(values), max(values)
        if lower <= 0 or upper <= lower * (1 + 1e-9):
            continue
        effect = np.max(np.abs(here.slopes[name][:2]) / scale[:2]) * log(upper / lower)
        if effect > EXTENT:
            found.append((effect, Axis(name, lower, upper, POINTS)))
    found.sort(key=lambda pair: -pair[0])
    return tuple(axis for _, axis in found[:MOST_AXES])


def _error(ring: Ring, walker: _Walker, found: Surrogate, point: Mapping[str, Array]) -> float:
    """Relative difference of the drag between surrogate and film at a point; 0 without a film."""
    film = walker.film({name: float(point[name]) for name in found.base})
    if not film.converged:
        return 0.0
    coefficient = ring["asperity_friction"]
    viscous, load = found({name: point[name] for name in found.base})[:2]
    sign = 1.0 if walker.outward else -1.0
    exact = sign * film.viscous_drag + coefficient * film.contact_load
    return float(abs(viscous + coefficient * load - exact) / abs(exact))
