"""Temperatures over time: oil, wall and rod warm up from the air while duty cycles repeat.

Heat enters as the mean of a cycle, and all coefficients are those of the steady state. How far the
heat of a single period moves a temperature is bounded apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ...base.numeric import Array
from ...design.model import Design
from ...models import heat_transfer, thermal_network
from ..limits import MaterialValues
from .results import turning_points
from .study import CycleStudy, Trace, Warming, WarmingPlace
from .thermal import MEAN, ThermalState, temperatures_of, thermal_places

POINTS = 61
"""Points of a curve; they are closest at the beginning, where oil and rod warm up."""
CONSTANTS = 5.0
"""Time of the curves in slowest time constants: then 99 % of the rise is reached."""
LAST = 40.0
"""Time constants within which a limit may be crossed."""
FINER = 3
"""Times that the interval of a crossing is divided into `POINTS` points."""


def warmings(
    design: Design,
    stock: MaterialValues,
    states: Mapping[str, ThermalState],
    cycles: Sequence[CycleStudy],
    numbers: Mapping[str, float],
) -> Iterator[Warming]:
    """Yield the warming under every cycle, or under the mean of all.

    Parameters
    ----------
    design : the design
    stock : values of its materials
    states : steady states by cycle, from `thermal.states`
    cycles : the cycles over time
    numbers : numbers of the design by name, see `numbers.collect`
    """
    assert design.duty is not None
    start, supply = design.duty.ambient, design.duty.supply
    for name, state in states.items():
        constant = thermal_network.slowest_time_constant(network=state.network, steady=state.steady)
        if not np.isfinite(constant):
            continue
        course = _Course(design, stock, state, start)
        time = CONSTANTS * constant * np.linspace(0.0, 1.0, POINTS) ** 2
        mission = None if supply is None else supply.mission_time
        lived = [c for c in cycles if c.repeats is not None] if name == MEAN else cycles
        own = [cycle for cycle in lived if name in (MEAN, cycle.name)]
        yield Warming(
            name=name,
            start=start,
            time_constant=constant,
            mission=mission,
            ripple=max(_ripple(cycle, state, numbers) for cycle in own),
            time=time,
            places=tuple(course.places(time, constant, mission)),
        )


class _Course:
    """Temperatures of all places as a function of time."""

    def __init__(
        self, design: Design, stock: MaterialValues, state: ThermalState, start: float
    ) -> None:
        self._state, self._start = state, start
        self._places = thermal_places(design)
        self._limits = [
            min(
                (
                    (float(most), material)
                    for material in place.materials
                    if (most := stock.get(material, "temperature_max")) is not None
                ),
                default=(None, ""),
            )
            for place in self._places
        ]

    def at(self, time: Trace | float) -> list[Array]:
        """Temperatures of all places."""
        nodes = thermal_network.temperatures_after(
            network=self._state.network, steady=self._state.steady, start=[self._start], time=time
        )
        return temperatures_of(self._state.network, nodes)

    def places(self, time: Trace, constant: float, mission: float | None) -> Iterator[WarmingPlace]:
        """Yield the curves of all places."""
        steady = temperatures_of(self._state.network, self._state.steady.nodes)
        curves = self.at(time)
        ends = self.at(0.0 if mission is None else mission)
        for k, (place, (limit, material)) in enumerate(
            zip(self._places, self._limits, strict=True)
        ):
            yield WarmingPlace(
                name=place.name,
                temperature=curves[k],
                steady=float(steady[k]),
                limit=limit,
                material=material,
                crossed=None if limit is None else self._crossed(k, limit, time, constant),
                after_mission=None if mission is None else float(ends[k]),
            )

    def _crossed(self, place: int, limit: float, time: Trace, constant: float) -> float | None:
        """Time at which a temperature first exceeds its limit; None if it never does."""
        grid = np.append(time, LAST * constant)
        for _ in range(FINER + 1):
            above = np.flatnonzero(self.at(grid)[place] > limit)
            if not above.size:
                return None
            at = int(above[0])
            if at == 0:
                return float(grid[0])
            grid = np.linspace(grid[at - 1], grid[at], POINTS)
        return float(grid[1])


def _ripple(cycle: CycleStudy, state: ThermalState, numbers: Mapping[str, float]) -> float:
    """Bound of the deviation from the mean within a period, of any temperature [K].

    The heat of each node moves its own temperature at most by `thermal_network.ripple_bound`, and
    all others less. So the sum over the nodes with heat bounds them all.
    """
    speed = np.abs(cycle.traces["speed"])
    rubbed = {"piston": 0.0 * speed, "rod": 0.0 * speed}
    for i, seal in enumerate(cycle.severity):
        block = "piston" if seal.startswith("piston") else "rod"
        rubbed[block] = rubbed[block] + cycle.traces[f"friction{i}"] * speed
    heat = heat_transfer.friction_heat(piston_seal=rubbed["piston"], rod_seal=rubbed["rod"])
    network = state.network
    pairs = (
        (heat.oil + _exchange(cycle, state, numbers), network.oil.heat_capacity),
        (heat.layer + heat.head, network.layer_capacities[0]),
        (heat.rod, network.parts[0].heat_capacity),
    )
    bounds = [
        thermal_network.ripple_bound(time=cycle.time, power=power, heat_capacity=capacity)
        for power, capacity in pairs
    ]
    return float(sum(bounds))


def _exchange(
    cycle: CycleStudy, state: ThermalState, numbers: Mapping[str, float]
) -> npt.NDArray[np.float64]:
    """Heat that fresh oil brings into the chambers at every sample, at their steady temperature.

    A stroke first takes back the oil that its line holds.
    """
    position, speed = cycle.traces["position"], cycle.traces["speed"]
    turns = turning_points(position)
    began = turns[np.searchsorted(turns, np.arange(position.size), side="right") - 1]
    travel = np.abs(position - position[began])
    flow = np.zeros(position.size)
    for chamber, sign in (("a", 1.0), ("b", -1.0)):
        area = numbers[f"area_{chamber}"]
        fresh = (area * travel >= numbers[f"line_volume_{chamber}"]) & (sign * speed > 0)
        flow += np.where(fresh, area * np.abs(speed), 0.0)
    rise = heat_transfer.throttle_temperature_rise(
        pressure_drop=cycle.traces["inlet_drop"], **state.oil
    )
    carried = heat_transfer.oil_exchange_conductance(exchange_flow=flow, **state.oil)
    heat: npt.NDArray[np.float64] = carried * (state.supplied + rise - state.steady.oil)
    return heat
