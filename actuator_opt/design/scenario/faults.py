"""Check a scenario for values that contradict each other or the design."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

from ...base import quantities
from ...base.errors import Fault
from ...base.quantities import length_text
from .. import valve_faults
from ..kinds import Section, position_at
from ..model import Design
from ..structure import (
    FileView,
    Loc,
    child_at,
    entries,
    how_to_add,
    without_effect,
)
from .kinds import FRICTIONS, LAWS, SHAPES, SUPPLIES, ControlLaw
from .model import (
    FEWEST_SAMPLES,
    MOST_SAMPLES,
    SAMPLES,
    Controller,
    Scenario,
    ScenarioFriction,
    ScenarioLoad,
    SignalSegment,
    ValveSupply,
)

_SLACK = 1e-9
"""Relative tolerance for comparisons of times."""
_time = quantities.SCENARIOS["instant"].text
_short = quantities.SCENARIOS["sample_time"].text
_hertz = quantities.INPUTS["frequency"].text


@cache
def part_lists(
    section: type[Section] = Scenario, loc: tuple[str, ...] = ()
) -> Mapping[tuple[str, ...], type[Section]]:
    """Locations of the signals in a scenario, with the class of their parts.

    >>> [".".join(loc) for loc in part_lists()][:3]
    ['motor.torque', 'load.force', 'load.torque']
    """
    lists: dict[tuple[str, ...], type[Section]] = {}
    for name, entry in entries(section).items():
        if entry.section is None:
            continue
        if entry.shape == "list" and issubclass(entry.section, SignalSegment):
            lists[*loc, name] = entry.section
        elif entry.shape == "section":
            lists |= part_lists(entry.section, (*loc, name))
    return lists


def _parts(view: FileView) -> Iterator[tuple[Loc, str, type[Section]]]:
    """Location, name of the waveform and class of every signal part whose waveform is known."""
    for place, section in part_lists().items():
        for index in range(len(view.items(*place))):
            shape = view.text(*place, index, "shape")
            if shape is not None and shape in SHAPES:
                yield (*place, index), shape, section


def shapes(view: FileView) -> Iterator[Fault]:
    """Check that each part of a signal has the keys that its shape needs, and no others."""
    for loc, shape, section in _parts(view):
        shape_kind, keys = SHAPES[shape], entries(section)
        for key in shape_kind.needed:
            if not view.has(*loc, key):
                advice = how_to_add(key, keys[key])
                yield Fault((*loc, key), f"missing: required by a {shape}", advice)
        for key in keys:
            if key == "shape" or key in shape_kind.needed or key in shape_kind.read:
                continue
            other = shape_kind.instead.get(key)
            remedy = "remove the line" + (f', or write "shape: {other}"' if other else "")
            yield from without_effect(view, loc, [key], f"on a {shape}", remedy)


def order(view: FileView) -> Iterator[Fault]:
    """Check that each part of a signal ends after its start and starts before the scenario ends."""
    duration = view.number("duration")
    for loc, shape, _ in _parts(view):
        start, end = view.number(*loc, "start"), view.number(*loc, "end")
        if start is None:
            continue
        reads = (*SHAPES[shape].needed, *SHAPES[shape].read)
        if end is not None and "end" in reads and end <= start:
            message = f"{_time(end)}: not after start ({_time(start)})"
            yield Fault((*loc, "end"), message, f"write more than {_time(start)}")
        if duration is not None and "start" in reads and start >= duration:
            message = f"{_time(start)}: not before the scenario ends ({_time(duration)})"
            remedy = f"write less than {_time(duration)}, or raise duration"
            yield Fault((*loc, "start"), message, remedy)


def sampling(view: FileView) -> Iterator[Fault]:
    """Check that the number of samples is reasonable, for the run and for each period of a sine."""
    duration, stated = view.number("duration"), view.number("sample_time")
    if duration is None or (stated is None and view.has("sample_time")):
        return
    finest, coarsest = duration / MOST_SAMPLES, duration / FEWEST_SAMPLES
    sample = duration / SAMPLES if stated is None else stated
    if sample < finest * (1 - _SLACK):
        yield Fault(
            ("sample_time",),
            f"{_short(sample)}: gives more than {MOST_SAMPLES / 1e6:g} million samples",
            f"write at least {_short(_rounded(finest, math.ceil))}, or shorten duration",
        )
    elif sample > coarsest * (1 + _SLACK):
        yield Fault(
            ("sample_time",),
            f"{_short(sample)}: gives fewer than {FEWEST_SAMPLES} samples in {_time(duration)}",
            f"write at most {_short(_rounded(coarsest, math.floor))}",
        )
    else:
        yield from _sines(view, duration, sample, stated is not None)


def _sines(view: FileView, duration: float, sample: float, stated: bool) -> Iterator[Fault]:
    """Yield a fault for the fastest sine if the sample time is too long to resolve it."""
    waves: list[tuple[float, Loc]] = []
    for loc, shape, _ in _parts(view):
        frequency = view.number(*loc, "frequency")
        if "frequency" in SHAPES[shape].needed and frequency is not None:
            waves.append((frequency, (*loc, "frequency")))
    if not waves:
        return
    frequency, loc = max(waves, key=lambda wave: wave[0])
    needed = 1 / (FEWEST_SAMPLES * frequency)
    if sample <= needed * (1 + _SLACK):
        return
    if needed < duration / MOST_SAMPLES * (1 - _SLACK):
        message = (
            f"a sine of {_hertz(frequency)} during {_time(duration)} "
            f"would need more than {MOST_SAMPLES / 1e6:g} million samples"
        )
        yield Fault(loc, message, "lower the frequency, or shorten duration")
        return
    good = _short(_rounded(needed, math.floor))
    message = f"sample time too coarse: {_hertz(frequency)} needs {good} or less"
    if stated:
        yield Fault(("sample_time",), message, f"write {good}")
    else:
        yield Fault(loc, message, f'add "sample_time: {good}"')


def _rounded(value: float, way: Callable[[float], int]) -> float:
    """Round a time to three digits, with `way` (up or down)."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return way(value / step * (1 + (_SLACK if way is math.floor else -_SLACK))) * step


SIGNAL_CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (shapes, order, sampling)
REFERENCES: Mapping[str, str] = {
    "position": "position_gain",
    "speed": "speed_gain",
    "shaft_speed": "shaft_speed_gain",
    "shaft_angle": "shaft_angle_gain",
}
"""Name of the gain for each reference that a control loop can have."""
STEP_RESULTS = ("rise_time", "settling_time", "overshoot", "steady_state_ratio")
"""Results derived from the response to a single step."""


def stated(view: FileView, *loc: str) -> bool:
    """Whether the file states this value; an empty list counts as not stated."""
    return child_at(view.tree, loc) not in (None, [], ())


def stated_references(view: FileView) -> list[str]:
    """Names of the references that the block `control` states."""
    return [name for name in REFERENCES if stated(view, "control", name)]


def drives(view: FileView) -> Iterator[Fault]:
    """Check that `signal` or `control`, not both, drives the valve, and the valve is connected."""
    driven = [name for name in ("signal", "control") if stated(view, name)]
    if len(driven) == 2:
        message = "both signal and control are stated, and both would drive the valve"
        yield Fault(("signal",), message, "keep one of them", at_key=True)
    ends = view.text("ends")
    if ends == "valve" or ends not in entries(Scenario)["ends"].choices:
        return
    if driven:
        message = f"{ends}: the {driven[0]} would drive a valve that is not connected"
        yield Fault(("ends",), message, f'write "valve", or remove {driven[0]}')
    supply = SUPPLIES.get(view.text("supply", "type") or "")
    if supply is not None and supply.pumps:
        message = f"{ends}: the pump of the supply is not connected"
        yield Fault(("ends",), message, 'write "valve", or remove supply')


def reference(view: FileView) -> Iterator[Fault]:
    """Check that control has exactly one reference, for the rod or, with a motor, for the shaft."""
    if not isinstance(child_at(view.tree, ("control",)), dict):
        return
    references = stated_references(view)
    if view.has("cycle"):  # which states the reference itself
        return
    if not references:
        remedy = f'add a list "position:" (or {", ".join(list(REFERENCES)[1:])})'
        yield Fault(("control", "position"), "missing: no reference", remedy)
    for name in references[1:]:
        message = f"a second reference, beside {references[0]}"
        yield Fault(("control", name), message, "keep one of them", at_key=True)
    if not references or references[0].startswith("shaft") == view.has("motor"):
        return
    if view.has("motor"):
        message = "with a motor there is no rod to move"
        remedy = "write shaft_speed or shaft_angle, or remove motor"
    else:
        message, remedy = (
            "without a motor there is no shaft",
            "add motor, or write position or speed",
        )
    yield Fault(("control", references[0]), message, remedy, at_key=True)


def tuning(view: FileView) -> Iterator[Fault]:
    """Check that the control states the gain and times that its tuning needs, and no others."""
    references, law, tuning_kind = (
        stated_references(view),
        view.text("control", "law"),
        view.text("control", "tuning"),
    )
    if not isinstance(child_at(view.tree, ("control",)), dict):
        return
    keys = entries(Controller)
    control_law = LAWS.get(law or "")
    if control_law is None or tuning_kind not in keys["tuning"].choices:
        return
    references = references or (["position"] if view.has("cycle") else [])
    loop = references[0] if references else None
    for name, gain in REFERENCES.items():
        if not view.has("control", gain):
            continue
        if loop is not None and name != loop:
            message = f"this is the gain of a {name} loop, but the reference is a {loop}"
            yield Fault(("control", gain), message, f"write {REFERENCES[loop]}", at_key=True)
        elif tuning_kind != "stated":
            message = f"stated, although tuning ({tuning_kind}) calculates it"
            remedy = 'remove it, or write "tuning: stated"'
            yield Fault(("control", gain), message, remedy, at_key=True)
    times = [f"{part}_time" for part in control_law.parts]
    needed = ([] if loop is None else [REFERENCES[loop]]) + times
    for key in needed if tuning_kind == "stated" else ():
        if not view.has("control", key):
            owner = "stated tuning" if key not in times else f"a stated {law} law"
            advice = how_to_add(key, keys[key])
            yield Fault(("control", key), f"missing: required by {owner}", advice)
    yield from _unread(view, control_law, tuning_kind)


def _unread(view: FileView, law: ControlLaw, tuning_kind: str) -> Iterator[Fault]:
    """Yield faults for keys without effect under this control law and tuning."""
    for part in ("integral", "derivative"):
        if part not in law.parts:
            keys = [f"{part}_time", f"{part}_factor"]
            yield from without_effect(view, ("control",), keys, f"on a {law.name} law")
    if not law.derivative:
        yield from without_effect(view, ("control",), ["filter_time"], f"on a {law.name} law")
    if tuning_kind != "margins":
        yield from without_effect(view, ("control",), ["margin"], f"where tuning is {tuning_kind}")
    if not view.number("control", "pressure_feedback"):
        keys = ["pressure_time"] if not view.has("control", "pressure_feedback") else []
        yield from without_effect(view, ("control",), keys, "without pressure_feedback")


def step_results(view: FileView) -> Iterator[Fault]:
    """Check that requirements on a step response have a reference with a step."""
    step_requirements = [name for name in STEP_RESULTS if view.has("requirements", name)]
    references = stated_references(view)
    if not step_requirements or len(references) > 1:
        return
    shapes = []
    for name in references:
        for index in range(len(view.items("control", name))):
            shapes.append(view.text("control", name, index, "shape"))
    known_shapes = [SHAPES[shape] for shape in shapes if shape is not None and shape in SHAPES]
    if len(known_shapes) < len(shapes) or (references and not shapes):
        return
    if "step" in shapes and all(shape.settles for shape in known_shapes):
        return
    where = f"control.{references[0]}" if references else "control with a reference"
    for name in step_requirements:
        message = "the reference has no step"
        remedy = f'add a part "shape: step" to {where}, without sine or record, or remove the line'
        yield Fault(("requirements", name), message, remedy, at_key=True)


CONTROL_CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    drives,
    reference,
    tuning,
    step_results,
)
_force = quantities.SCENARIOS["coulomb_force"].text
_flow = quantities.INPUTS["rated_flow"].text
_area = quantities.INPUTS["orifice_area"].text


def supply(view: FileView) -> Iterator[Fault]:
    """Check that a supply has the keys that its type needs, and no others."""
    kind = view.text("supply", "type")
    supply_kind = SUPPLIES.get(kind or "")
    if supply_kind is None:  # reported as a separate fault
        return
    keys = entries(ValveSupply)
    for key in supply_kind.needed:
        if not view.has("supply", key):
            message = f"missing: required by a {kind}"
            yield Fault(("supply", key), message, how_to_add(key, keys[key]))
    flow, pump = view.has("supply", "flow"), view.has("supply", "pump")
    if kind == "fixed_pump" and not flow and not pump:
        remedy = f'{how_to_add("flow", keys["flow"])}, or a block "pump:"'
        yield Fault(("supply", "flow"), f"missing: a {kind} needs flow or pump", remedy)
    if kind == "fixed_pump" and flow and pump:
        message = "both pump and flow are stated, and both define the delivery"
        yield Fault(("supply", "pump"), message, "keep one of them", at_key=True)
    delivered, relief_flow = (
        view.number("supply", *loc) for loc in (("flow",), ("relief", "rated_flow"))
    )
    if (
        kind == "fixed_pump"
        and delivered is not None
        and relief_flow is not None
        and relief_flow < delivered
    ):
        message = f"{_flow(relief_flow)}: less than the pump delivers ({_flow(delivered)})"
        yield Fault(
            ("supply", "relief", "rated_flow"), message, f"write {_flow(delivered)} or more"
        )
    where = "on a constant supply" if kind == "constant" else f"on a {kind}"
    remedy = "remove it, or write another type" if kind == "constant" else "remove the line"
    yield from without_effect(view, ("supply",), supply_kind.unread, where, remedy)


def cushion(view: FileView) -> Iterator[Fault]:
    """Check that a cushion reduces the flow area of the oil, but not to zero."""
    loc = ("stops", "cushion")
    opened, closed = view.number(*loc, "open_area"), view.number(*loc, "end_area")
    if opened is not None and closed is not None and closed >= opened:
        message = f"{_area(closed)}: not smaller than open_area ({_area(opened)})"
        yield Fault((*loc, "end_area"), message, f"write less than {_area(opened)}")
    elif closed == 0:
        message = (
            f"{_area(closed)}: the oil could not escape, and the piston would never reach its stop"
        )
        yield Fault((*loc, "end_area"), message, "write the area of the remaining gap")


def load_cylinder(view: FileView) -> Iterator[Fault]:
    """Check that a load cylinder has an effective area and a pressure difference."""
    loc = ("load", "cylinder")
    bore, rod = view.number(*loc, "bore"), view.number(*loc, "rod_diameter")
    if bore is not None and rod is not None and rod >= bore:
        message = f"{length_text(rod)}: not smaller than bore ({length_text(bore)})"
        yield Fault((*loc, "rod_diameter"), message, f"write less than {length_text(bore)}")
    high, low = view.number(*loc, "supply_pressure"), view.number(*loc, "return_pressure")
    if high is not None and low is not None and low >= high:
        text = quantities.INPUTS["pressure"].text
        message = f"{text(low)}: not below supply_pressure ({text(high)})"
        yield Fault((*loc, "return_pressure"), message, f"write less than {text(high)}")


def load_valve(view: FileView) -> Iterator[Fault]:
    """Check the valve of the load cylinder."""
    yield from valve_faults.valve(view, ("load", "cylinder", "valve"))


def friction(view: FileView) -> Iterator[Fault]:
    """Check that Coulomb friction is stated where needed and does not exceed breakaway friction."""
    model = view.text("friction", "model")
    friction_model = FRICTIONS.get(model or "")
    if friction_model is not None:
        yield from without_effect(
            view, ("friction",), friction_model.unread, f"where model is {model}"
        )
    if model == "none":
        return
    keys = entries(ScenarioFriction)
    if not view.has("friction", "coulomb"):
        for key in ("static", "stribeck_speed", "viscous"):
            if view.has("friction", key):
                message = f"missing: required with {key}"
                advice = how_to_add("coulomb", keys["coulomb"])
                yield Fault(("friction", "coulomb"), message, advice)
                break
    if view.has("friction", "static") and not view.has("friction", "stribeck_speed"):
        remedy = 'add e.g. "stribeck_speed: 5 mm/s"'
        yield Fault(("friction", "stribeck_speed"), "missing: required with static", remedy)
    low, high = view.number("friction", "coulomb"), view.number("friction", "static")
    if low is not None and high is not None and high < low:
        message = f"{_force(high)}: below coulomb ({_force(low)})"
        yield Fault(("friction", "static"), message, f"write {_force(low)} or more")


def motor(view: FileView) -> Iterator[Fault]:
    """Check that a scenario with a motor, which replaces the cylinder, states no cylinder data."""
    if not view.has("motor"):
        return
    where = "with a motor in place of the cylinder"
    if view.has("held_ports"):
        message = "with both held_ports and motor, no oil would flow to the motor"
        yield Fault(("held_ports",), message, "keep one of them", at_key=True)
    yield from without_effect(view, (), ("stops", "friction"), where)
    yield from without_effect(view, ("initial",), ("position", "speed"), where)
    yield from without_effect(
        view,
        ("load",),
        entries(ScenarioLoad),
        where,
        'state the motor\'s load in the block "motor:"',
    )
    yield from without_effect(view, ("control",), ["speed_feedback"], where)


def held_ports(view: FileView) -> Iterator[Fault]:
    """Check that a scenario of the valve alone (held ports) states no load and no actuator."""
    if not view.has("held_ports") or view.has("motor"):  # both: a separate fault
        return
    where, idle = "with held ports", ("control", "stops", "friction", "initial")
    yield from without_effect(view, (), idle, where, "remove it, or remove held_ports")
    yield from without_effect(view, ("load",), entries(ScenarioLoad), where)
    ends = view.text("ends")
    if ends != "valve" and ends in entries(Scenario)["ends"].choices:
        remedy = 'write "valve", or remove held_ports'
        yield Fault(("ends",), f"{ends}: held_ports needs the lines to end at the valve", remedy)


def duty_cycle(view: FileView) -> Iterator[Fault]:
    """Check that a scenario of a duty cycle states no other reference, load or start."""
    if not view.has("cycle"):
        return
    where = "beside a duty cycle, which states reference, load and start"
    remedy = "remove it, or remove cycle"
    keys = ("signal", "motor", "held_ports")
    yield from without_effect(view, (), keys, where, remedy)
    yield from without_effect(view, ("control",), REFERENCES, where, remedy)
    yield from without_effect(view, ("load",), entries(ScenarioLoad), where, remedy)
    yield from without_effect(view, ("initial",), ("position", "speed"), where, remedy)
    ends = view.text("ends")
    if ends is not None and ends != "valve" and ends in entries(Scenario)["ends"].choices:
        message = f"{ends}: a duty cycle needs the lines to end at the valve"
        yield Fault(("ends",), message, 'write "valve", or remove cycle')


CHECKS: tuple[Callable[[FileView], Iterator[Fault]], ...] = (
    *SIGNAL_CHECKS,
    *CONTROL_CHECKS,
    supply,
    cushion,
    load_cylinder,
    load_valve,
    friction,
    motor,
    held_ports,
    duty_cycle,
)


def cross_field(tree: Any) -> Iterator[Fault]:
    """Yield all contradictions between values of a scenario's tree in SI."""
    view = FileView(tree, Scenario)
    for check in CHECKS:
        yield from check(view)


def design_faults(scenario: Scenario, design: Design) -> Iterator[Fault]:
    """Yield all contradictions between scenario and design, at locations of the scenario."""
    yield from _missing_components(scenario, design)
    yield from _cycle_of_design(scenario, design)
    stroke = design.cylinder.stroke
    begin = scenario.initial.position
    place = None if begin is None else position_at(begin, stroke)
    if place is not None and place > stroke:
        message = f"{length_text(place)}: beyond cylinder.stroke ({length_text(stroke)})"
        remedy = f'write at most {length_text(stroke)}, or a share such as "50 %"'
        yield Fault(("initial", "position"), message, remedy)
    cushion = scenario.stops.cushion
    if cushion is not None and cushion.length > stroke:
        message = f"{length_text(cushion.length)}: beyond cylinder.stroke ({length_text(stroke)})"
        yield Fault(("stops", "cushion", "length"), message, f"write at most {length_text(stroke)}")


def _missing_components(scenario: Scenario, design: Design) -> Iterator[Fault]:
    """Yield a fault for each component that the scenario uses and the design lacks."""
    needs_valve = {
        ("signal",): bool(scenario.signal),
        ("control",): scenario.control is not None,
        ("cycle",): scenario.cycle is not None,
        ("held_ports",): scenario.held_ports is not None,
        ("motor",): scenario.motor is not None,
        ("ends",): scenario.ends == "valve",
        ("supply", "type"): scenario.supply.type != "constant",
    }
    missing = [loc for loc, needed in needs_valve.items() if needed]
    if design.valve is None and missing:
        remedy = f"add valve to the design, or remove {'.'.join(missing[0])}"
        yield Fault(missing[0], "the design has no valve", remedy, at_key=True)
    if scenario.ends == "reducing_valve" and design.ports.reducing_valve is None:
        remedy = "add ports.reducing_valve to the design, or change ends"
        yield Fault(("ends",), "reducing_valve: the design has no reducing valve", remedy)
    if scenario.load.torque and getattr(design, "linkage", None) is None:
        remedy = "add linkage to the design, or write load.force"
        yield Fault(("load", "torque"), "the design has no linkage", remedy, at_key=True)


PERIODS = 3
"""Number of periods of a duty cycle that a remedy proposes, and that are simulated by default (our
choice: the last of them is periodic)."""


def _cycle_of_design(scenario: Scenario, design: Design) -> Iterator[Fault]:
    """Check that the design has the duty cycle, and that the scenario lasts for one period."""
    if scenario.cycle is None:
        return
    cycles = () if design.duty is None else design.duty.cycles
    cycle = next((cycle for cycle in cycles if cycle.name == scenario.cycle), None)
    if cycle is None:
        names = ", ".join(cycle.name for cycle in cycles)
        remedy = f"write one of {names}" if names else "add duty.cycles to the design"
        yield Fault(("cycle",), f"the design has no duty cycle {scenario.cycle}", remedy)
        return
    if design.ideal is not None:
        message = "a design with the block ideal has no quasi-static results of duty cycles"
        yield Fault(("cycle",), message, "remove cycle, and state load.force and control")
        return
    if cycle.record.supply_pressure is not None:
        message = f"{cycle.name} states the supply pressure of every sample"
        remedy = "list supply_pressure under ignore of this cycle: the supply of a run is constant"
        yield Fault(("cycle",), message, remedy)
    period = cycle.record.duration * cycle.time_scale
    if scenario.duration < period * (1 - _SLACK):
        message = f"{_time(scenario.duration)}: shorter than {cycle.name} ({_time(period)})"
        remedy = f"write at least {_time(PERIODS * period)}, so that the last period is periodic"
        yield Fault(("duration",), message, remedy)
