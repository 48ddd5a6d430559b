"""Volumes of oil at one pressure: rate, mass and elastic energy."""

from __future__ import annotations

from typing import NamedTuple

from ...base.numeric import clip, maximum, where
from ...base.symbolic import Expression, Namespace, Symbol
from ...evaluation.springs import Give
from ...models import chamber, oil_energy
from ...models.chamber import cavity
from ...models.fluid import ATMOSPHERIC_PRESSURE
from ...studies.plant import Oil
from .circuit import Circuit

DEEPEST = -12.0
"""Travel into a stop, relative to half the dead volume's length, that leaves 6e-6 of it (a
choice)."""
FLOOR = 1e-6
"""Lower limit of the absolute pressure in the laws of oil and air [Pa], against rounding only."""
LEAST_DEAD = 0.5e-3
"""Least length of a dead volume [m] (a choice): without any, a chamber would have no compliance."""


class Volumes(NamedTuple):
    """The oil law at a pressure."""

    ratio: Expression
    modulus: Expression
    energy: Expression


def oil_at(oil: Oil, pressure: Expression) -> Volumes:
    """Density ratio, bulk modulus and energy density at a pressure above vacuum.

    Oil with (almost) no air forms a cavity below atmospheric pressure, which limits the vacuum.
    """
    held = maximum(pressure, FLOOR - ATMOSPHERIC_PRESSURE)
    mixed = Volumes(
        chamber.density_ratio(pressure=held, **oil.law),
        chamber.mixture_bulk_modulus(pressure=held, **oil.law),
        oil_energy.oil_energy_density(pressure=held, **oil.law),
    )
    if not oil.cavity:
        return mixed
    opened, falling, work = cavity(
        pressure=held, content=oil.cavity, polytropic_index=oil.polytropic_index
    )
    filled = (1 + oil.air_content) / mixed.ratio
    whole = filled + opened
    return Volumes(
        (1 + oil.air_content) / whole,
        whole / (filled / mixed.modulus + falling),
        (mixed.energy * filled + work) / whole,
    )


def node(
    circuit: Circuit,
    name: str,
    pressure: Symbol,
    *,
    inflow: Expression,
    volume: float,
    wall: float = 0.0,
) -> None:
    """Add a rigid volume with an elastic wall; its pressure follows the net inflow."""
    law = oil_at(circuit.plant.oil, pressure)
    whole = volume + wall * pressure
    circuit.system.rate(
        pressure,
        chamber.pressure_rate(
            flow=inflow, volume=whole, volume_rate=0.0, bulk_modulus=law.modulus, compliance=wall
        ),
    )
    _content(circuit, name, law, whole, inflow, volume)
    circuit.audit.stored.append((f"walls of {name}", 0.5 * wall * pressure * pressure))


def _content(
    circuit: Circuit,
    name: str,
    law: Volumes,
    volume: Expression,
    inflow: Expression,
    scale: float,
) -> None:
    """Count mass and energy of a volume; inflow carries its elastic energy."""
    system, audit = circuit.system, circuit.audit
    mass = system.integral(f"inflow of {name}", law.ratio * inflow, scale=1e-3 * scale)
    audit.mass.append((name, law.ratio * volume, mass))
    audit.stored.append((f"oil of {name}", law.energy * volume))
    carried = system.integral(f"carried into {name}", law.energy * inflow, scale=1e4 * scale)
    audit.flows.append(("carried by the oil", carried, True))


def _left(travel: Expression, film: float) -> tuple[Expression, Expression]:
    """Length of the oil relative to that of the dead volume, and its slope over the travel.

    Equal to the travel, also beyond the stop. Once half the dead volume is used up, the piston
    touches the end over a growing area, and the remaining volume shrinks.
    """
    half = 0.5 * film
    deep = clip((travel + half) / half, DEEPEST, 0.0)
    met = travel < -half
    left = where(met, half * Namespace.expm1(deep) - half, travel)
    return left, where(met, Namespace.exp(deep), 1.0)


def cylinder(
    circuit: Circuit,
    *,
    pressure_a: Expression,
    pressure_b: Expression,
    inflow_a: Expression,
    inflow_b: Expression,
    position: Expression,
    speed: Expression,
    area_a: float,
    area_b: float,
    stroke: float,
    dead_a: float,
    dead_b: float,
    walls: Give,
    flexibility: float,
    of: str = "",
) -> Expression:
    """Both chambers of a cylinder, coupled by walls and the compliance of the rod; their force [N].

    V_A = A_A x + V_0A + W_AA p_A + W_AB p_B, V_B = A_B (s - x) + V_0B + W_BB p_B + W_AB p_A, W(x)
    of the walls plus f a a^T of rod and mount with a = (A_A, -A_B). The force on the piston is a^T
    p + p^T W' p/2, from the work of the walls. A pressure given as a number is prescribed: its port
    supplies the flow for volume, walls and leakage. Deep in a stop x is that of `_left`.
    """
    system, audit, oil = circuit.system, circuit.audit, circuit.plant.oil
    beyond = stroke - position
    w_a = walls.a0 + walls.a1 * position + flexibility * area_a * area_a
    w_b = walls.b0 + walls.b1 * beyond + flexibility * area_b * area_b
    w_ab = walls.c0 + walls.c1 * position - flexibility * area_a * area_b
    (left_a, free_a), (left_b, free_b) = (
        _left(position, dead_a / area_a), _left(beyond, dead_b / area_b),
    )  # fmt: skip
    v_a = area_a * left_a + dead_a + w_a * pressure_a + w_ab * pressure_b
    v_b = area_b * left_b + dead_b + w_b * pressure_b + w_ab * pressure_a
    swept_a = area_a * free_a + walls.a1 * pressure_a + walls.c1 * pressure_b
    swept_b = -area_b * free_b - walls.b1 * pressure_b + walls.c1 * pressure_a
    law_a, law_b = oil_at(oil, pressure_a), oil_at(oil, pressure_b)
    c_a, c_b = v_a / law_a.modulus + w_a, v_b / law_b.modulus + w_b
    net_a, net_b = inflow_a - swept_a * speed, inflow_b - swept_b * speed
    moved_a, moved_b = isinstance(pressure_a, Symbol), isinstance(pressure_b, Symbol)
    det = c_a * c_b - (w_ab * w_ab if moved_a and moved_b else 0.0)
    rate_a = (c_b * net_a - (w_ab * net_b if moved_b else 0.0)) / det if moved_a else 0.0
    rate_b = (c_a * net_b - (w_ab * net_a if moved_a else 0.0)) / det if moved_b else 0.0
    for name, pressure, moved, own, asked in (
        ("a", pressure_a, moved_a, rate_a, w_ab * rate_b - net_a),
        ("b", pressure_b, moved_b, rate_b, w_ab * rate_a - net_b),
    ):
        if moved:
            system.rate(pressure, own)
        else:
            circuit.door("held ports", pressure * asked, state=f"held work {name}", into=True)
    if moved_a:
        scale = area_a * stroke + dead_a
        _content(circuit, f"chamber A{of}", law_a, v_a, inflow_a, scale)
    if moved_b:
        scale = area_b * stroke + dead_b
        _content(circuit, f"chamber B{of}", law_b, v_b, inflow_b, scale)
    energy = 0.5 * (
        w_a * pressure_a * pressure_a
        + w_b * pressure_b * pressure_b
        + 2 * w_ab * pressure_a * pressure_b
    )
    audit.stored.append((f"walls, rod and mount{of}", energy))
    bent = 0.5 * (
        walls.a1 * pressure_a * pressure_a
        - walls.b1 * pressure_b * pressure_b
        + 2 * walls.c1 * pressure_a * pressure_b
    )
    return area_a * free_a * pressure_a - area_b * free_b * pressure_b + bent


def dead_volume(circuit: Circuit, volume: float, area: float, chamber: str) -> float:
    """Dead volume of a chamber, at least a short length of it."""
    least = LEAST_DEAD * area
    if volume >= least:
        return volume
    circuit.system.notes.append(
        f"{chamber}: dead volume taken as {least * 1e6:.2g} ml, 0.5 mm of its area"
    )
    return least
