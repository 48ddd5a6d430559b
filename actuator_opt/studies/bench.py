"""Properties of a design that the evaluation of its test records needs, such as areas and mass."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.model import Design
from ..evaluation import state
from ..evaluation.barrel import SEAL_STEP
from ..evaluation.film import floats
from ..evaluation.kernel import ModelRun, PreparedDesign, compute
from ..evaluation.limits import MaterialValues
from ..evaluation.rings import Ring, seal_contact
from ..evaluation.sealing import WiperFriction, wipers
from ..evaluation.springs import Springs
from ..evaluation.weight import moving
from ..models import forces
from ..seals.contact import SealContact


@dataclass(frozen=True, slots=True)
class Bench:
    """Properties of a design on a test bench, SI.

    Parameters
    ----------
    design : the design of the tested actuator
    growth : radial growth of the bore at the piston seal per unit chamber pressure [m/Pa]
    mass : moving mass on the actuator's side of the force sensor: rod, piston, fastening [kg]
    rings, wipers : sealing rings and wipers, with their properties in the first load case
    springs : stiffness of the actuator, as contributions of its parts
    oil_pressures : pressures of chambers A and B in the first load case [Pa]
    temperature : oil temperature [K]
    bulk_modulus : bulk modulus [Pa] of the oil with air, as a function of gauge pressure, at the
        temperature of the first load case
    """

    design: Design
    bore: float
    rod_diameter: float
    stroke: float
    growth: float
    mass: float
    load_mass: float
    supply_pressure: float
    rings: tuple[Ring, ...]
    wipers: tuple[WiperFriction, ...]
    springs: Springs
    oil_pressures: tuple[float, float]
    temperature: float
    bulk_modulus: Callable[[Array], Array]

    @property
    def plunger(self) -> bool:
        """Whether no piston seal separates the chambers."""
        return all(ring.name != "piston" for ring in self.rings)

    def areas(self, highest_pressure: Array) -> tuple[Array, Array]:
        """Return cap and rod-end piston areas, with the bore grown by the higher chamber pressure.

        A_1 = pi (D/2 + u)^2 and A_2 = A_1 - pi d^2/4, with bore D and rod diameter d. The radial
        growth u is that at the piston seal, because the pressure acts on the area inside the seal.
        Without a piston seal the rod is a plunger, and the areas are pi d^2/4 and zero. Gauge
        pressure [Pa]; areas [m^2].
        """
        if self.plunger:
            area = forces.piston_area(bore=self.rod_diameter)
            return area + 0.0 * highest_pressure, 0.0 * highest_pressure
        bore = self.bore + 2 * self.growth * highest_pressure
        return (
            forces.piston_area(bore=bore),
            forces.annulus_area(bore=bore, rod_diameter=self.rod_diameter),
        )

    def normal_forces(self, pressure_1: Array, pressure_2: Array) -> list[tuple[Ring, Array]]:
        """Return every ring with its normal force [N], line load times circumference.

        Of several rings in series, the first seals the pressure; the others are only squeezed. The
        arguments are the gauge pressures in both chambers [Pa], arrays of any shape.
        """
        return [(ring, force) for ring, _, force in self._rubbing(pressure_1, pressure_2)]

    def _rubbing(
        self, pressure_1: Array, pressure_2: Array
    ) -> Iterator[tuple[Ring, SealContact, Array]]:
        """Yield each type of ring, its contact, and the normal force [N] of its rings in series."""
        for ring in self._loaded(pressure_1, pressure_2):
            contact = seal_contact(ring)
            load = contact.line_load
            count = float(ring["count"])
            if count != 1.0:
                idle = seal_contact(ring.at(pressure=0.0 * ring["pressure"]))
                load = load + (count - 1) * idle.line_load
            yield ring, contact, pi * ring["diameter"] * load

    def contact_forces(self, pressure_1: Array, pressure_2: Array) -> dict[str, Array]:
        """Return the normal force of all rings of piston and rod at chamber pressures [N]."""
        total = {"piston": 0.0 * pressure_1, "rod": 0.0 * pressure_1}
        for ring, force in self.normal_forces(pressure_1, pressure_2):
            total[ring.name] = total[ring.name] + force
        return total

    def coulomb(self, pressure_1: Array, pressure_2: Array) -> Array:
        """Return the Coulomb friction of rings and wipers [N], without side load on guides."""
        wiped = sum(float(wiper.friction) for wiper in self.wipers)
        return sum((friction for _, friction in self._coulomb(pressure_1, pressure_2)), wiped)

    def _coulomb(self, pressure_1: Array, pressure_2: Array) -> Iterator[tuple[Ring, Array]]:
        """Yield every type of ring with the Coulomb friction [N] of its rings in series."""
        for ring, contact, force in self._rubbing(pressure_1, pressure_2):
            yield ring, ring.element.friction_law.coefficient(ring.sizes, contact) * force

    def sliding(self, speed: Array, pressure_1: Array, pressure_2: Array) -> tuple[Array, Array]:
        """Return dry and viscous part [N] of the sliding friction, without side load on guides.

        The dry part is Coulomb friction plus the share of the extra breakaway friction that remains
        at this speed [m/s]. Gauge pressures [Pa].
        """
        level = sum((float(wiper.friction) for wiper in self.wipers), 0.0 * speed)
        viscous = 0.0 * speed
        for ring, coulomb in self._coulomb(pressure_1, pressure_2):
            level = level + ring.element.friction_law.level(ring.sizes, coulomb, speed)
            viscous = viscous + ring["viscous_friction"] * speed
        return level, viscous

    def contact_pressure(self, pressure_1: float, pressure_2: float) -> float:
        """Return the mean contact pressure [Pa] of the rings that seal the pressure."""
        rings = [ring for ring in self._loaded(pressure_1, pressure_2) if _leads(ring)]
        pairs = [(float(ring["diameter"]), seal_contact(ring)) for ring in rings]
        force = sum(diameter * float(contact.line_load) for diameter, contact in pairs)
        area = sum(diameter * float(contact.width) for diameter, contact in pairs)
        return force / area

    @property
    def contact_law(self) -> str:
        """Return the name of the contact law of the rings that seal the pressure."""
        return "; ".join(
            f"{ring.label}: "
            + ("stated profile" if ring.element.contact else ring.element.seal_type.title)
            + (
                f", {ring.element.law.replace('_', ' ')}"
                if ring.element.seal_type.round_ring
                else ""
            )
            for ring in self.rings
            if _leads(ring)
        )

    def _loaded(self, pressure_1: Array, pressure_2: Array) -> list[Ring]:
        """Return the rings at given chamber pressures; a seal's first ring bears the pressure."""
        p1, p2 = (
            np.maximum(pressure, 0.0) for pressure in np.broadcast_arrays(pressure_1, pressure_2)
        )
        sealed = {"piston": np.abs(p1 - p2), "rod": p1 if self.plunger else p2}
        outer = {"piston": np.minimum(p1, p2), "rod": 0.0 * p2}
        rings = []
        for ring in self.rings:
            grown = self.growth * np.maximum(p1, p2) if ring.name == "piston" else 0.0
            rings.append(
                ring.at(
                    pressure=sealed[ring.name] if _leads(ring) else 0.0 * p1,
                    outer_pressure=outer[ring.name],
                    squeeze_left=ring["squeeze"] - grown / ring["section"],
                )
            )
        return rings

    def stiffness(self, position: Array, pressure_1: Array, pressure_2: Array) -> Array:
        """Return the stiffness with closed ports at every sample [N/m]; NaN for a plunger.

        The arguments are arrays with one value per sample: position of the piston from the cap end
        [m] and gauge pressures [Pa]. The bulk modulus of the oil with air is taken at the pressure
        of each chamber.
        """
        place = np.clip(position, 0.0, self.stroke)[None, :]
        if self.plunger:
            return np.full(place.shape[1], np.nan)
        soft_a, soft_b = (
            self.bulk_modulus(reference) / self.bulk_modulus(np.maximum(pressure, 0.0))[None, :]
            for reference, pressure in zip(
                self.oil_pressures, (pressure_1, pressure_2), strict=True
            )
        )
        chambers = {
            name: give._replace(
                a0=give.a0 * soft_a, a1=give.a1 * soft_a, b0=give.b0 * soft_b, b1=give.b1 * soft_b
            )
            if name in self.springs.oil
            else give
            for name, give in self.springs.chambers.items()
        }
        parts = replace(self.springs, chambers=chambers).compliances(place)
        total = np.sum([np.broadcast_to(part, (1, place.size)) for part in _first(parts)], axis=0)
        return 1 / total[0]


def _leads(ring: Ring) -> bool:
    """Whether a ring is the first of its seal, which seals the pressure."""
    return ring.groove.path == f"seals.{ring.name}."


def _first(parts: dict[str, Array]) -> list[Array]:
    """Return the compliances of the first load case, (1, positions) each."""
    return [np.atleast_2d(np.asarray(part))[:1] for part in parts.values()]


def bench(subject: PreparedDesign, done: ModelRun | None = None) -> Bench:
    """Return the bench properties of a design, with oil and temperature of the first load case.

    `done` is the run of all models on this design, if there is one already.
    """
    v = subject.values()
    done = compute(subject, v) if done is None else done
    g = done.geometry
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    temperature = first_case(done.state.temperature)

    def bulk_modulus(pressure: Array) -> Array:
        modulus = state.bulk_modulus(v, subject.design.fluid, stock, temperature, pressure)
        return np.real(modulus) + 0.0 * pressure

    pressures = np.broadcast_to(_cases(done.state.driven_pressure), (len(v.cases),))
    growths = np.max(np.real(np.atleast_2d(SEAL_STEP * done.wall.case_growth)), axis=-1)
    growths = np.broadcast_to(growths, pressures.shape)
    loaded = pressures > 0
    growth = float(np.max(growths[loaded] / pressures[loaded])) if loaded.any() else 0.0
    return Bench(
        design=subject.design,
        bore=float(np.squeeze(g.bore)),
        rod_diameter=float(np.squeeze(g.rod_diameter)),
        stroke=float(np.squeeze(g.stroke)),
        growth=growth,
        mass=float(np.squeeze(moving(done.mass_parts))),
        load_mass=float(v["load.mass"]),
        supply_pressure=float(v["supply.pressure"]),
        rings=tuple(floats(ring, 0) for ring in done.rings),
        wipers=tuple(
            WiperFriction(wiper.path, first_case(wiper.coefficient), first_case(wiper.friction))
            for wiper in wipers(v, subject.design, g, done.state)
        ),
        springs=done.springs,
        oil_pressures=(first_case(done.state.holding_a), first_case(done.state.holding_b)),
        temperature=temperature,
        bulk_modulus=bulk_modulus,
    )


def first_case(value: Array) -> float:
    """Return the value of the first load case of a single design."""
    return float(np.ravel(np.real(np.asarray(value)))[0])


def _cases(value: Array) -> Array:
    """Return the values of all load cases of a single design."""
    return np.real(np.atleast_2d(np.asarray(value))[:, 0])
