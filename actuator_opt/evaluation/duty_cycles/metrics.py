"""Metrics of the duty cycles of a design."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import reduce

from ...base.numeric import Array, maximum, minimum, real, where
from ...design.model import Design
from ...metrics.table import ROWS
from ...models import fluid, wear as models_wear
from ..geometry import Geometry
from ..limits import MaterialValues, MetricArrays
from ..values import Values
from . import supply, thermal
from .numbers import smallest
from .results import Place

NO_DUTY = "no duty cycles stated: add duty"
NAMES = (
    "duty_flow_peak",
    "duty_flow_mean",
    "duty_supply_energy",
    "duty_work_out",
    "duty_work_in",
    "duty_throttling_energy",
    "duty_friction_energy",
    "duty_leakage_energy",
    "duty_efficiency",
    "duty_power_mean",
    "duty_power_peak",
    "duty_power_absorbed",
    "duty_force_margin",
    "duty_opening",
    "duty_supply_share",
    "duty_supply_needed",
    "duty_pressure_min",
    "duty_pressure_max",
    "duty_suction_ratio",
    "duty_stroke_margin",
    "duty_fatigue",
    "duty_sliding",
    "duty_wear",
    "duty_wear_share",
    "duty_pv",
    "duty_ripple_volume",
    "duty_gas_volume",
    "duty_tank_temperature",
    "system_mass",
    *thermal.METRICS,
)
"""All metrics of duty cycles."""

Extreme = Callable[[Array, Array], Array]


def skip(out: MetricArrays) -> None:
    """Record that a design without duty cycles has none of these metrics."""
    for name in NAMES:
        out.skip(name, NO_DUTY)


def compute(
    v: Values,
    design: Design,
    stock: MaterialValues,
    g: Geometry,
    results: Mapping[Place, Array],
    *,
    actuator_mass: Array,
    windows: bool,
    out: MetricArrays,
) -> None:
    """Compute the metrics of all duty cycles from their results.

    With `windows`, an extreme is given for the worst samples of every window of time, as limits of
    the optimiser; otherwise for each cycle.
    """
    extremes = _Extremes(results, windows=windows)
    for metric, result in (
        ("duty_flow_peak", "flow_peak"),
        ("duty_power_peak", "power_peak"),
        ("duty_supply_share", "share"),
        ("duty_supply_needed", "needed"),
    ):
        out.put(metric, extremes.of(result, maximum))
    for metric, result, why in (
        ("duty_opening", "opening", "no valve stated: add valve"),
        ("duty_pv", "pv", "no seals on piston and rod"),
    ):
        values = extremes.of(result, maximum)
        if values:
            out.put(metric, values)
        else:
            out.skip(metric, why)
    absorbed = {place: -x for place, x in extremes.of("power_least", minimum).items()}
    out.put("duty_power_absorbed", absorbed)
    out.put("duty_force_margin", extremes.of("reserve", minimum))
    low = extremes.of("pressure_a_min", minimum, "chamber A")
    low |= extremes.of("pressure_b_min", minimum, "chamber B")
    high = extremes.of("pressure_a_max", maximum, "chamber A")
    high |= extremes.of("pressure_b_max", maximum, "chamber B")
    out.put("duty_pressure_min", low)
    out.put("duty_pressure_max", high)
    air = fluid.ATMOSPHERIC_PRESSURE
    out.put("duty_suction_ratio", {place: (p + air) / air for place, p in low.items()})
    least = extremes.of("position_min", minimum, "retracted")
    most = extremes.of("position_max", maximum, "extended")
    out.put("duty_stroke_margin", least | {place: g.stroke - x for place, x in most.items()})
    _sums(v, design, results, out)
    _life(v, design, results, out)
    supply.compute(v, design, results, actuator_mass, out)
    tank = out.metrics.get("duty_tank_temperature", {}).get("")
    thermal.compute(v, design, stock, g, results, tank, out)


class _Extremes:
    """Extremes of the cycles, for each window or for each cycle."""

    def __init__(self, results: Mapping[Place, Array], *, windows: bool) -> None:
        self._results, self._windows = results, windows

    def of(self, name: str, pick: Extreme, word: str = "") -> dict[str, Array]:
        """Values by place; `word` names the chamber or end."""
        values: dict[str, Array] = {}
        for place, value in self._results.items():
            if place.name != name:
                continue
            part, _, window = place.place.rpartition("|")
            words = place.cycle, part, word, window if self._windows else ""
            label = ", ".join(x for x in words if x)
            values[label] = pick(values[label], value) if label in values else value
        return values


def _by_cycle(results: Mapping[Place, Array], name: str) -> dict[str, Array]:
    return {place.cycle: value for place, value in results.items() if place.name == name}


def _sums(v: Values, design: Design, results: Mapping[Place, Array], out: MetricArrays) -> None:
    """Energies, mean flow and power of every cycle."""
    duration = _by_cycle(results, "duration")
    energy = _by_cycle(results, "supply_energy")
    for name in (
        "supply_energy", "work_out", "work_in", "throttling_energy", "friction_energy",
        "leakage_energy", "ripple_volume",
    ):  # fmt: skip
        out.put(f"duty_{name}", _by_cycle(results, name))
    volume = _by_cycle(results, "volume")
    out.put("duty_flow_mean", {name: x / duration[name] for name, x in volume.items()})
    out.put("duty_power_mean", {name: x / duration[name] for name, x in energy.items()})
    work = _by_cycle(results, "work_out")
    moves = {name: real(x) > 0 for name, x in energy.items()}
    out.put(
        "duty_efficiency",
        {name: work[name] / where(moves[name], x, 1.0) for name, x in energy.items()},
    )


def _life(v: Values, design: Design, results: Mapping[Place, Array], out: MetricArrays) -> None:
    """Fatigue damage, sliding distance and wear of the whole life."""
    assert design.duty is not None
    damage = {
        place.place: value
        for place, value in results.items()
        if place.name == "damage" and not place.cycle
    }
    if damage:
        out.put("duty_fatigue", damage)
    repeats = {
        cycle.name: v[f"duty.cycles[{cycle.name}].repeats"]
        for cycle in design.duty.cycles
        if cycle.repeats is not None
    }
    if not repeats:
        for name in ("duty_fatigue", "duty_sliding", "duty_wear", "duty_wear_share"):
            out.skip(name, "no life stated: add duty.cycles[NAME].repeats")
        return
    way = _by_cycle(results, "way")
    out.put("duty_sliding", sum((count * way[name] for name, count in repeats.items()), 0.0))
    _wear(v, results, repeats, out)


def _wear(
    v: Values, results: Mapping[Place, Array], repeats: Mapping[str, Array], out: MetricArrays
) -> None:
    """Worn depth of the seals in a life, and its share of the permitted depth."""
    wear: dict[str, Array] = {}
    share: dict[str, Array] = {}
    for seal, severity in _severities(results, repeats):
        rate = v.get(f"duty.wear.{_block(seal)}.rate", None)
        if rate is not None:
            depth = models_wear.worn_depth(severity=severity, wear_rate=rate, repeats=1.0)
            wear[seal] = wear.get(seal, 0.0) + depth
    for seal, depth in wear.items():
        allowed = v.get(f"duty.wear.{_block(seal)}.depth", None)
        if allowed is None:
            allowed = _squeezed(v, seal, out)
        if allowed is not None:
            share[seal] = models_wear.wear_share(depth=depth, allowed_depth=allowed)
    for metric, values in (("duty_wear", wear), ("duty_wear_share", share)):
        if values:
            out.put(metric, values)
        else:
            out.skip(metric, "no measured wear rate stated: add duty.wear")
    if wear and not share:
        out.skip("duty_wear_share", "no permitted depth stated: add duty.wear.piston.depth")


def _block(seal: str) -> str:
    """Block of `seals` and of `duty.wear` of a seal."""
    return "piston" if seal.startswith("piston") else "rod"


def _squeezed(v: Values, seal: str, out: MetricArrays) -> Array | None:
    """Depth that a round ring may lose until its squeeze is the least permitted; else None."""
    squeezes = [
        value
        for place, value in out.metrics.get("seal_squeeze", {}).items()
        if place == seal or place.startswith(f"{seal},")
    ]
    if not squeezes:
        return None
    check = ROWS["seal_squeeze"].check
    assert check is not None
    assert check.limit is not None
    spare = smallest(reduce(minimum, squeezes)) - check.limit
    return v[f"seals.{_block(seal)}.section"] * spare


def _severities(
    results: Mapping[Place, Array], repeats: Mapping[str, Array]
) -> Iterator[tuple[str, Array]]:
    """Severity of every seal in a life, cycle by cycle."""
    for place, value in results.items():
        if place.name == "severity" and place.cycle in repeats:
            yield place.place, repeats[place.cycle] * value
