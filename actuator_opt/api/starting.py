"""Start designs: a complete, solved design file from a few answers.

The answers are push and pull force, stroke, supply pressure, goal and wall; a lever arm, a speed
and a stiffness may be added. Simple formulas give sizes, and bounds around them, to a template of
one line per part. The optimiser then solves this file, and its result is written with round
numbers.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import ceil, pi, sqrt

from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError, remedy, shown
from ..base.quantities import INPUTS, Quantity
from ..design import Design, standard_sizes, with_values
from ..design.kinds import Text, ValueFault, read_quantity
from ..design.paths import quantity_of
from ..design.writer import exact_text, scalar, to_yaml
from ..evaluation import evaluate, prepare
from ..evaluation.build import limits_of, margins_many
from ..metrics import METRICS
from ..optimisation.result import Optimisation
from ..optimisation.solution import MET
from .actuator import Actuator, read
from .starting_limits import unsuitable
from .starting_parts import BOLTS, ROD_THREADS, compound_of, section_of, thread_of

ASKED: Mapping[str, tuple[Quantity, str]] = {
    "push": (INPUTS["force"], "5 kN"),
    "pull": (INPUTS["force"], "3 kN"),
    "stroke": (INPUTS["stroke"], "100 mm"),
    "pressure": (INPUTS["working_pressure"], "160 bar"),
}
"""The numbers that every start design needs, each with its quantity and default."""

ADDED: Mapping[str, Quantity] = {
    "lever_arm": INPUTS["lever_arm"],
    "speed": INPUTS["speed"],
    "stiffness": METRICS["stiffness_min"],
}
"""Numbers that may be added; without them there is no lever arm and no such limit."""


@dataclass(frozen=True, slots=True)
class StartGoal:
    """A goal: its words, and the objective of the design file."""

    words: str
    objective: str


GOALS: Mapping[str, StartGoal] = {
    "mass": StartGoal("lightest", "minimise: mass"),
    "stiffness": StartGoal("stiffest", "maximise: stiffness_min"),
    "friction": StartGoal("least friction", "minimise: friction_running"),
}
"""The goals; all but the first limit the mass to `HEAVIER` times the lightest."""

HEAVIER = 1.25
"""Largest mass of a design that is not the lightest, divided by the least mass. Our choice: without
such a limit, the stiffest design has every wall at its upper bound."""


@dataclass(frozen=True, slots=True)
class StartWall:
    """Material of the barrel: its words, and the materials and joint that suit it.

    `strength` [Pa] is that of the wall, for its first size. A layer is a material, its angle (empty
    for metal) and its share of the wall; `thinnest` is the lower bound of a metal layer [m].
    `clearance` is the radial clearance of a large piston, divided by the bore.
    """

    words: str
    layers: tuple[tuple[str, str, float], ...]
    strength: float
    caps: str
    joint: str
    thinnest: float = 1e-3
    clearance: float = 1 / 2000


_PLIES = "t700_epoxy"
WALLS: Mapping[str, StartWall] = {
    "steel": StartWall("steel", (("steel_e355", "", 1.0),), 580e6, "steel_42crmo4", "thread"),
    "aluminium": StartWall("aluminium", (("al_7075_t6", "", 1.0),), 570e6, "al_7075_t6", "thread"),
    "lined_carbon": StartWall(
        "lined carbon",
        (("al_7075_t6", "", 0.2), (_PLIES, "88 deg", 0.8)),
        500e6,
        "al_7075_t6",
        "plug_thread",
        0.4e-3,
    ),
    "linerless": StartWall(
        "linerless carbon",
        ((_PLIES, "88 deg", 0.65), (_PLIES, "25 deg", 0.35)),
        500e6,
        "al_7075_t6",
        "tie_rods",
        clearance=1 / 1000,
    ),
}
"""The walls. Lined carbon has the joint of the robot knee (designs/knee.yaml), metal that of
designs/steel_baseline.yaml, carbon alone that of designs/aerospace.yaml. In carbon alone, which
hardly expands, an aluminium piston takes (24e-6/K)(60 K)/2 of the bore and 5 um. The ratio for
the others is our choice."""

TYPES: Mapping[str, str] = {
    "differential": "mount: cap_clevis",
    "double_rod": "type: double_rod, mount: head_trunnion",
}
"""The types of cylinder, with their keys in the file. A second rod leaves no eye at the cap."""

BURST, BUCKLING = 4.0, 3.5
"""Safety factors, as in the check list and in the template."""

SPEED = 0.1
"""Default piston speed [m/s], at which the friction coefficients of the seals apply."""

_USUAL = {key: (quantity, read_quantity(text, quantity)) for key, (quantity, text) in ASKED.items()}
_USUAL |= {"speed": (ADDED["speed"], SPEED), "stiffness": (ADDED["stiffness"], 1e6)}
"""A usual number of each answer, for which there are first sizes."""

PORT_SPEED = 4.0
"""Oil speed in the ports, related to the bore [m/s]: half the limit of the check list."""

LARGEST = 0.6
"""Largest bore of a start [m]; its bounds stay within the range of bores."""

CLEARANCE = 30e-6
"""Least radial clearance of piston and head [m], as in the shipped designs."""
GAP_RATIO = 2.5
"""Gap that the seals must bear, divided by the clearance: the bore grows. Our choice."""

RESERVE = 0.01
"""Margin that the solved start keeps beyond each limit, so that round numbers still meet it."""
ROUNDING = 5e-5
"""The same for geometry with a limit of zero [m]: five last decimals of a written length."""
LIFE = 0.1
"""The same for `cycle_life`, which falls with a high power of the stress."""
STARTS = 4
"""Number of local searches; more than four were no better for twelve random loads."""

RODS = 6
"""Number of tie rods, as in designs/aerospace.yaml."""
_ROD_YIELD, _BOLT_YIELD, _ROD_MODULUS = 650e6, 1080e6, 205e9
"""Yield strengths of rod and tie rods, Young's modulus of the rod [Pa], for first sizes only."""
STIFFER = 1.7
"""Factor of the stiffness for second sizes: in a short cylinder, threads and walls give way more
than the oil. Our choice."""
_OIL = 4e9
"""Stiffness at mid-stroke times stroke, divided by the bore's area [Pa], for first sizes only:
two oil columns of 1.4 GPa in parallel give 4 x 1.4 GPa, less the rod's area and other parts."""
_HOLLOW = 0.8
"""Inner by outer diameter of the rod, for first sizes only."""


@dataclass(frozen=True, slots=True)
class StartAnswers:
    """Forces, stroke and supply pressure of an actuator (SI), its goal, wall and type.

    With a lever arm, the file states torques. Without `stiffness` there is no such limit.
    """

    push: float
    pull: float
    stroke: float
    pressure: float
    goal: str = "mass"
    wall: str = "steel"
    lever_arm: float | None = None
    speed: float = SPEED
    stiffness: float | None = None
    type: str = "differential"

    @property
    def return_pressure(self) -> float:
        """Pressure at the other port: 2 % of supply, at most the 5 bar of the shipped designs."""
        return min(5e5, 0.02 * self.pressure)

    @property
    def words(self) -> str:
        """Forces, stroke and supply pressure in words."""
        short = {key: quantity.text(getattr(self, key)) for key, (quantity, _) in ASKED.items()}
        return "{push} push, {pull} pull, {stroke} stroke at {pressure}".format(**short)


@dataclass(frozen=True, slots=True)
class Start:
    """A start design, whether it meets its limits, and what to do if it does not."""

    actuator: Actuator
    met: bool
    sentence: str

    @property
    def solved(self) -> str:
        """Mass and the limits in words, with the advice that the design does not follow."""
        evaluation = evaluate(prepare(self.actuator.design))
        mass = evaluation.metrics["mass"].value
        assert mass is not None
        advice = [check.name for check in evaluation.checks if check.status == "missed"]
        words = f"{METRICS['mass'].text(mass, 4)}, every limit is met"
        return f"{words}; advice not followed: {', '.join(advice)}" if advice else words

    @property
    def text(self) -> str:
        """Text of the design file."""
        assert self.actuator.source is not None
        return self.actuator.source.text


def start(
    *,
    push: float | str = "5 kN",
    pull: float | str = "3 kN",
    stroke: float | str = "100 mm",
    pressure: float | str = "160 bar",
    goal: str = "mass",
    wall: str = "steel",
    lever_arm: float | str | None = None,
    speed: float | str = SPEED,
    stiffness: float | str | None = None,
    type: str = "differential",
    name: str = "my actuator",
) -> Actuator:
    """A complete design for two load cases, solved, and with round numbers.

    Every number is SI, or a text with a unit. If nothing fits, this is the nearest design, and
    `evaluate` lists what it misses.

    Parameters
    ----------
    push, pull : forces, N; 0: no load case in this direction. With a lever arm, a text may
        be a torque, such as "540 N*m"
    stroke : m
    pressure : gauge supply pressure, Pa
    goal : "mass", "stiffness" or "friction"
    wall : "steel", "aluminium", "lined_carbon" or "linerless"
    lever_arm : lever arm of the joint, m; None: the file states forces
    speed : piston speed in both directions, m/s
    stiffness : least stiffness over the stroke, N/m; None: no limit
    type : "differential" or "double_rod", a cylinder with a rod through both ends
    name : title of the design

    Raises
    ------
    UsageError : a value is unsuitable, or no first sizes suit all values
    """
    stated = {
        "push": push, "pull": pull, "stroke": stroke, "pressure": pressure, "goal": goal,
        "wall": wall, "lever_arm": lever_arm, "speed": speed, "stiffness": stiffness, "type": type,
    }  # fmt: skip
    values = start_answers({key: value for key, value in stated.items() if value is not None})
    answers = StartAnswers(**values)  # type: ignore[arg-type]
    return solved_start(answers, name).actuator


_WORDS: Mapping[str, Mapping[str, object]] = {"goal": GOALS, "wall": WALLS, "type": TYPES}
"""The words that each answer in words may be."""


def start_answers(
    stated: Mapping[str, object], prefix: str = "", arm: float | None = None
) -> dict[str, float | str]:
    """Answers as numbers in SI and words; a fault names an answer as ``prefix + key``.

    With a lever arm, among the answers or as `arm` [m], a force may be stated as a torque.

    >>> start_answers({"push": "540 N*m", "lever_arm": "60 mm", "wall": "lined carbon"})
    {'push': 9000.0, 'lever_arm': 0.06, 'wall': 'lined_carbon'}

    Raises
    ------
    UsageError : an answer is unsuitable
    """
    if "lever_arm" in stated:
        arm = _number("lever_arm", stated["lever_arm"], prefix, None)
    return {
        key: _word(key, str(value), prefix) if key in _WORDS else _number(key, value, prefix, arm)
        for key, value in stated.items()
    }


def _number(key: str, value: object, prefix: str, arm: float | None) -> float:
    quantity = ADDED[key] if key in ADDED else ASKED[key][0]
    try:
        if quantity.dimension == "force" and isinstance(value, str) and _is_torque(value):
            torque = read_quantity(value, INPUTS["torque"])
            if arm is None:
                raise ValueFault(f"{shown(value)} is a torque", "add the lever arm")
            return torque / arm
        return read_quantity(value, quantity)
    except ValueFault as fault:
        place = prefix + (key.replace("_", "-") if prefix else key)
        raise UsageError(Diagnostic(f"{place}: {fault.message}", fault.remedy)) from None


def _is_torque(text: str) -> bool:
    """Whether a text is a number with a unit of torque."""
    try:
        units.parse(text, "torque")
    except units.UnitError:
        return False
    return True


def _word(key: str, value: str, prefix: str) -> str:
    words = _WORDS[key]
    word = value.strip().casefold().replace("-", "_").replace(" ", "_")
    if word not in words:
        message = f'{prefix}{key}: "{shown(value)}" is not a {key}'
        raise UsageError(Diagnostic(message, remedy(word, words)))
    return word


def solved_start(answers: StartAnswers, name: str = "my actuator", prefix: str = "") -> Start:
    """A start design with its verdict; `name` and faults as for `start`.

    A fault names an answer as ``prefix + key``.
    """
    try:
        title = Text().validate(name)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"name: {fault.message}", fault.remedy)) from None
    if answers.push == 0 and answers.pull == 0:
        raise UsageError(Diagnostic("push and pull: both are 0", "state a force"))
    if _fault(answers, {}):
        numbers = {key: getattr(answers, key) for key in _USUAL}
        stated = {key: number for key, number in numbers.items() if number is not None}
        raise UsageError(unsuitable(stated, _USUAL, partial(_fault, answers), prefix))
    sizes = _first_sizes(answers)
    light = _solved(replace(answers, goal="mass"), sizes, title)
    if not light.met and answers.stiffness is not None:
        stiffer = {"stiffness": STIFFER * answers.stiffness}
        if not _fault(answers, stiffer):
            sizes = _first_sizes(_changed(answers, stiffer))
            light = _solved(replace(answers, goal="mass"), sizes, title)
    if answers.goal == "mass" or not light.met:
        return light
    return _solved(answers, sizes, title, light.actuator.design)


def _solved(
    answers: StartAnswers, sizes: _Sizes, title: str, lightest: Design | None = None
) -> Start:
    """Solve the template, with stops in the cylinder if possible, else outside it."""
    limit = None if lightest is None else HEAVIER * _mass(lightest)
    templates = [read(_text(answers, sizes, title, stop, limit)) for stop in sizes.stops]
    if lightest is not None:
        templates = [
            replace(x, design=with_values(x.design, _values(lightest, x.design))) for x in templates
        ]
    for reserve in (True, False):
        for template in templates:
            optimum = _optimum(template, reserve=reserve)
            missed = _missed(optimum.design)
            if not missed:
                return Start(_written(template, optimum.design), True, "")
            if optimum.status != "infeasible":  # no variable affects what is missed
                return _unfit(template, optimum, missed)
    return _unfit(template, optimum, missed)


def _unfit(template: Actuator, optimum: Optimisation, missed: Sequence[str]) -> Start:
    """A start that misses limits, with the nearest repair, or else with these limits."""
    sentence = f"missed: {', '.join(missed)}"
    if optimum.infeasibility is not None:
        sentence = optimum.infeasibility.sentence.removeprefix("infeasible: ")
    try:
        actuator = _written(template, optimum.design, sentence)
    except InputError:  # its sizes contradict each other, so no file can state them
        actuator = _written(template, template.design, sentence)
    return Start(actuator, False, sentence)


def _mass(design: Design) -> float:
    """Mass of a design, kg."""
    mass = evaluate(prepare(design)).metrics["mass"].value
    assert mass is not None
    return mass


def _optimum(actuator: Actuator, *, reserve: bool) -> Optimisation:
    """The optimum of a template; with `reserve`, every limit keeps `RESERVE`."""
    from ..optimisation.run import optimise

    subject = actuator.subject()
    if reserve:
        values, reserves = subject.values(), {}
        for limit in limits_of(subject):
            if limit.value(values):
                reserves[limit.name] = LIFE if limit.metric == "cycle_life" else RESERVE
            elif limit.origin == "geometry":
                reserves[limit.name] = ROUNDING
        subject = replace(subject, reserves=reserves)
    return optimise(subject, prices=False, starts=STARTS, explain=not reserve)


def _missed(design: Design) -> tuple[str, ...]:
    """The limits that a design misses: requirements, checks and geometry."""
    margins = margins_many(prepare(design), {}, 1)
    return tuple(name for name, margin in margins.items() if not margin[0] >= -MET)


def _values(source: Design, target: Design) -> dict[str, float]:
    """The values in `source` of the variables of `target`."""
    numbers = prepare(source).numbers
    return {path: numbers[path] for path in target.variables}


_STEPS = {"length": (2, "mm"), "ratio": (1, "%"), "angle": (1, "deg"), "force": (2, "kN")}
"""Decimals and unit of a written variable, by dimension."""


def _written(template: Actuator, design: Design, remark: str = "") -> Actuator:
    """The design in the template's text, with the roundest numbers that meet the limits."""
    chosen = design
    for finer in (0, 2):
        rounded = with_values(design, _rounded(design, finer), contradictions=False)
        if not _missed(rounded):
            chosen = rounded
            break
    text = to_yaml(chosen, template.source)
    return read(f"# Nothing fits yet: {remark}.\n{text}" if remark else text)


def _rounded(design: Design, finer: int) -> dict[str, float]:
    """The variables with the decimals of `_STEPS` and `finer` more, within their bounds."""
    values = {}
    for path, value in _values(design, design).items():
        quantity, variable = quantity_of(path, design), design.variables[path]
        decimals, unit = _STEPS[quantity.dimension]
        number = units.unit(unit, quantity.dimension).from_si(value)
        text = f"{number:.{decimals + finer}f} {unit}"
        rounded = units.parse(text, quantity.dimension)
        values[path] = min(max(rounded, variable.lower), variable.upper)
    return values


# --- first sizes ----------------------------------------------------------------------------


def _changed(answers: StartAnswers, numbers: Mapping[str, float]) -> StartAnswers:
    """The answers with other numbers."""
    return replace(answers, **numbers)  # type: ignore[arg-type]


def _fault(answers: StartAnswers, numbers: Mapping[str, float]) -> str:
    """The fault of the first sizes for answers with other numbers; empty if they make a file."""
    try:
        changed = _changed(answers, numbers)
        sizes = _first_sizes(changed)
        for stop in sizes.stops:
            read(_text(changed, sizes, "start", stop, None))
    except InputError as error:
        first = error.diagnostics[0]
        return ": ".join(filter(None, (first.path, first.message)))
    return ""


@dataclass(frozen=True, slots=True)
class _Sizes:
    """First sizes of the parts (SI)."""

    bore: float
    rod: float
    wall: float
    layers: tuple[float, ...]
    clearance: float
    stops: tuple[str, ...]
    rod_thread: tuple[float, float]
    stall: float
    """Force of the supply pressure on the piston, N."""

    @property
    def pitch(self) -> float:
        """Pitch of the caps' thread: 2 % of the bore, at least 1 mm."""
        return max(1e-3, 0.02 * self.bore)

    @property
    def section(self) -> float:
        """Section of the piston's ring."""
        return section_of(self.bore)

    @property
    def piston(self) -> float:
        """Length of a piston with one groove."""
        return 1.4 * self.section + 2e-3

    @property
    def pin(self) -> float:
        """Diameter of the pins in double shear, with a factor of 2.2 on shear yield."""
        return max(4e-3, sqrt(2.2 * self.stall / (2 * pi / 4 * 0.577 * _ROD_YIELD)))


def _first_sizes(answers: StartAnswers) -> _Sizes:
    """Bore, rod and wall from simple formulas, each with some reserve.

    The rod is a hollow column over twice the stroke that carries the stall force with the
    safety factor of buckling (Euler); it also carries the pull. The bore has the area for
    push, for pull beside the rod, and for the stiffness of the oil at mid-stroke; it has room
    for the rings of piston and rod. The wall is a thin tube at burst pressure. Stops in the
    cylinder suddenly meet all force that the load leaves over, so oil at the stop reaches twice
    this force by its area; above proof pressure the stops must be outside. A second rod takes as
    much from the area for the push as the rod from that for the pull.
    """
    pressure, back = answers.pressure, answers.return_pressure
    bore = rod = 6e-3
    for _ in range(80):  # converges: rod area grows with the root of the bore's area
        area = _pushed(answers, bore, rod)
        inertia = 0.9 * BUCKLING * pressure * area * (2 * answers.stroke + 0.05) ** 2
        inertia /= pi**2 * _ROD_MODULUS
        column = (64 * inertia / (pi * (1 - _HOLLOW**4))) ** 0.25
        tension = sqrt(4 * 2.2 * answers.pull / (pi * 0.9 * _ROD_YIELD * (1 - _HOLLOW**2)))
        rod += 0.5 * (max(6e-3, column, tension) - rod)
        needed = max(answers.push / pressure, answers.pull / (pressure - back)) * 1.06
        needed = max(needed, (answers.stiffness or 0.0) * answers.stroke / _OIL)
        beside = answers.pull if answers.type == "differential" else max(answers.pull, answers.push)
        pulled = 1.06 * beside / (pressure - back) + pi / 4 * rod**2
        least = rod + max(8e-3, 2 * section_of(rod) + 2e-3)
        bore += 0.5 * (max(sqrt(4 / pi * max(needed, pulled)), least) - bore)
    if rod >= bore:
        raise InputError(f"rod ({1e3 * rod:.0f} mm) too thick for the bore ({1e3 * bore:.0f} mm)")
    if bore > LARGEST:
        raise InputError(f"the bore would be {1e3 * bore:.0f} mm, more than {1e3 * LARGEST:.0f} mm")
    area, ring = _pushed(answers, bore, rod), pi / 4 * (bore**2 - rod**2)
    peak = max(
        2 * (pressure * area - back * ring - answers.push) / ring,
        2 * (pressure * ring - back * area - answers.pull) / area,
    )
    wall = WALLS[answers.wall]
    thickness = max(1.3 * BURST * pressure * bore / 2 / wall.strength, 1e-3)
    if wall.joint == "thread":  # metal that must remain under the thread
        thickness = max(thickness, 1.1e-3 + 0.62 * max(1e-3, 0.02 * bore))
    layers = tuple(max(share * thickness, 0.6e-3) for _, _, share in wall.layers)
    thread = thread_of(ROD_THREADS, 4 / pi * 2 * pressure * area / _ROD_YIELD)
    return _Sizes(
        bore,
        max(rod, thread[0]),
        thickness,
        layers,
        max(CLEARANCE, wall.clearance * bore),
        ("external",) if peak > 1.35 * pressure else ("internal", "external"),
        thread,
        pressure * area,
    )


def _pushed(answers: StartAnswers, bore: float, rod: float) -> float:
    """Area of the chamber that pushes: the piston's, or the annulus around a second rod."""
    rods = rod**2 if answers.type == "double_rod" else 0.0
    return pi / 4 * max(bore**2 - rods, 0.0)


@dataclass(frozen=True, slots=True)
class _Joint:
    """The joint of both ends: its line in the file, and the bounds of its variables."""

    line: str
    bounds: tuple[str, ...]


def _screwed_caps(sizes: _Sizes) -> _Joint:
    """Caps screwed over the barrel, with a pitch of 2 % of the bore, at least 1 mm."""
    bore, pitch = sizes.bore, sizes.pitch
    return _Joint(
        f"{{type: thread, length: {_mm(max(0.2 * bore, 6 * pitch))}, "
        f"wall: {_mm(max(0.05 * bore, 1.5e-3))}, thread: {{pitch: {_mm(pitch)}}}}}",
        (
            _bounds("retention.length", 3 * pitch, bore + 10 * pitch),
            _bounds("retention.wall", 1e-3, 0.25 * bore + 3e-3),
        ),
    )


def _screwed_plugs(sizes: _Sizes) -> _Joint:
    """Plugs screwed into the ends of the liner, which is thicker there under a cone of 1:5."""
    bore, pitch, liner = sizes.bore, 0.75 * sizes.pitch, sizes.layers[0]
    lift = 0.04 * bore + 1e-3
    return _Joint(
        f"{{type: plug_thread, length: {_mm(max(0.2 * bore, 6 * pitch))}, "
        f"wall: {_mm(max(0.1 * bore, 2e-3))}, thread: {{pitch: {_mm(pitch)}}},\n"
        f"  sleeve: {{material: al_7075_t6, wall: {_mm(liner + lift)}, "
        f"inner_length: {_mm(5.2 * lift + 1e-3)}}}}}",
        (
            _bounds("retention.length", 3 * pitch, bore + 10 * pitch),
            _bounds("retention.wall", 1e-3, 0.25 * bore + 3e-3),
            _bounds("retention.sleeve.wall", 1e-3, 0.25 * bore + 3e-3),
            _bounds("retention.sleeve.inner_length", 3e-3, bore + 10e-3),
        ),
    )


def _tie_rods(sizes: _Sizes) -> _Joint:
    """Rods of class 12.9 between the caps, whose preload proof pressure does not take away."""
    stall = sizes.stall
    diameter, pitch = thread_of(BOLTS, 4 / pi * 1.2 * BURST * stall / RODS / _BOLT_YIELD)
    return _Joint(
        f"{{type: tie_rods, material: steel_bolt_12_9, count: {RODS}, "
        f"length: {_mm(1.2 * diameter)},\n"
        f"  preload: {1.5e-3 * stall:.2f} kN, "
        f"thread: {{diameter: {_mm(diameter)}, pitch: {_mm(pitch)}}}}}",
        (
            f"  retention.preload: {{lower: {0.5e-3 * stall:.2f} kN, "
            f"upper: {min(20e-3 * stall, 1e-3 * INPUTS['force'].upper):.2f} kN}}",
        ),
    )


_JOINTS = {"thread": _screwed_caps, "plug_thread": _screwed_plugs, "tie_rods": _tie_rods}


# --- the text -------------------------------------------------------------------------------

_TEMPLATE = """\
# @wall@ actuator, @goal@: @asked@.
# The sizes are solved. After a change: actuator-opt evaluate FILE, or actuator-opt optimise FILE.
# Every value has a PATH, such as cylinder.bore, for --set and for `variables`.
name: @name@

# Every requirement holds in the worst load case.
load_cases:
@cases@
requirements:                   # besides those of the check list
  burst_factor: {min: 4}        # burst divided by supply pressure
  proof_factor: {min: 1}        # first damage divided by proof pressure
  buckling_factor: {min: 3.5}   # extended, stalled at supply pressure
@limits@objective: {@objective@}

# Oil and surroundings
supply: {pressure: @pressure@, return_pressure: @return_pressure@}
fluid: {material: iso_vg_32, temperature: 40 degC}
environment: {temperature_min: 0 degC, temperature_max: 80 degC@cure@}

cylinder: {bore: @bore@, stroke: @stroke@, @type@, end_stop: @stop@,
  port_diameter: @port@, stop_travel: 1 mm}
barrel:
  layup:                        # from the bore outwards
@layers@
rod: {material: steel_42crmo4, outer_diameter: @rod@, inner_diameter: @inner@,
  extension: @extension@, thread: {diameter: @thread@, pitch: @pitch@}}
piston: {material: @metal@, length: @piston@, clearance: @clearance@ um}
head: {material: @metal@, length: @head@, clearance: @clearance@ um}
caps: {material: @metal@, thickness: @cap@}
retention: @joint@
clevis: {material: steel_42crmo4, pin_diameter: @pin@}
seals:
@seals@

# Sizes that the optimiser varies between these bounds; all others are fixed.
variables:
@bounds@
"""
"""The file; names between @ are replaced."""


_THICKEST = INPUTS["wall_thickness"].upper
"""Largest valid thickness, m."""


def _mm(value: float) -> str:
    return f"{1e3 * value:.2f}".rstrip("0").rstrip(".") + " mm"


def _bounds(path: str, lower: float, upper: float) -> str:
    return f"  {path}: {{lower: {_mm(lower)}, upper: {_mm(upper)}}}"


def _text(answers: StartAnswers, sizes: _Sizes, title: str, stop: str, mass: float | None) -> str:
    """The template with first sizes; `mass` is the largest mass, if limited."""
    wall, bore, rod = WALLS[answers.wall], sizes.bore, sizes.rod
    stated = {key: exact_text(getattr(answers, key), ASKED[key][0]) for key in ASKED}
    limits = []
    if answers.stiffness is not None:
        least = exact_text(answers.stiffness, ADDED["stiffness"])
        limits.append(f"  stiffness_min: {{min: {least}}}".ljust(30) + "  # least over the stroke")
    if mass is not None:
        limit = f"  mass: {{max: {1e3 * mass:.4g} g}}".ljust(30)
        limits.append(f"{limit}  # {HEAVIER} x the lightest")
    cases = [
        f"  - {{name: {key}, direction: {key}, {_load(answers, key)}, "
        f"speed: {exact_text(answers.speed, ADDED['speed'])}}}"
        for key in ("push", "pull")
        if getattr(answers, key) > 0
    ]
    layers = [
        f"    - {{material: {material}, {f'angle: {angle}, ' if angle else ''}"
        f"thickness: {_mm(thickness)}}}"
        for (material, angle, _), thickness in zip(wall.layers, sizes.layers, strict=True)
    ]
    joint = _JOINTS[wall.joint](sizes)
    fields = {
        "wall": wall.words.capitalize(),
        "goal": GOALS[answers.goal].words,
        "asked": answers.words,
        "name": scalar(title),
        "cases": "\n".join(cases),
        "limits": "".join(f"{line}\n" for line in limits),
        "objective": GOALS[answers.goal].objective,
        "pressure": stated["pressure"],
        "return_pressure": exact_text(answers.return_pressure, ASKED["pressure"][0]),
        "cure": ", cure_temperature: 120 degC" if len(wall.layers) > 1 else "",
        "bore": _mm(bore),
        "stroke": stated["stroke"],
        "type": TYPES[answers.type],
        "stop": stop,
        "port": f"{ceil(max(3.0, 1e3 * bore * sqrt(answers.speed / PORT_SPEED)))} mm",
        "layers": "\n".join(layers),
        "rod": _mm(rod),
        "inner": _mm(min(_HOLLOW * rod, rod - 2.2e-3)),
        "extension": _mm(0.5 * rod + 5e-3),
        "thread": _mm(sizes.rod_thread[0]),
        "pitch": _mm(sizes.rod_thread[1]),
        "metal": wall.caps,
        "piston": _mm(sizes.piston),
        "head": _mm(max(1.5 * rod, sizes.piston)),
        "clearance": f"{1e6 * sizes.clearance:.0f}",
        "cap": _mm(0.18 * bore),
        "joint": joint.line,
        "pin": f"{ceil(1e3 * sizes.pin)} mm",
        "seals": "\n".join(_seals(answers, sizes)),
        "bounds": "\n".join([*_part_bounds(wall, sizes), *joint.bounds]),
    }
    return re.sub(r"@(\w+)@", lambda match: fields[match[1]], _TEMPLATE)


def _load(answers: StartAnswers, key: str) -> str:
    """The load of a direction: a force, or a torque on the lever arm."""
    force = getattr(answers, key)
    if answers.lever_arm is None:
        return f"force: {exact_text(force, ASKED[key][0])}"
    torque = exact_text(force * answers.lever_arm, INPUTS["torque"])
    return f"joint_torque: {torque}, lever_arm: {exact_text(answers.lever_arm, ADDED['lever_arm'])}"


def _part_bounds(wall: StartWall, sizes: _Sizes) -> list[str]:
    """Bounds of the variables that every joint has, around the first sizes."""
    bore, rod, longest = sizes.bore, sizes.rod, 2 * sizes.piston + 3 * sizes.rod
    bounds = [_bounds("cylinder.bore", bore / 1.4, 1.4 * bore)]
    for index, (layer, thickness) in enumerate(zip(wall.layers, sizes.layers, strict=True)):
        least = 0.2e-3 if layer[1] else wall.thinnest
        bounds.append(
            _bounds(f"barrel.layup[{index}].thickness", least, min(3 * thickness + 2e-3, _THICKEST))
        )
    return [
        *bounds,
        _bounds("rod.outer_diameter", max(sizes.rod_thread[0], rod / 1.5), 1.5 * rod),
        _bounds("rod.inner_diameter", 1e-3, 1.4 * rod),
        _bounds("piston.length", sizes.piston - 1e-3, longest),
        _bounds("head.length", sizes.piston - 1e-3, longest),
        _bounds("caps.thickness", 1e-3, min(0.5 * bore + 2e-3, _THICKEST)),
        *(f"  seals.{place}.squeeze: {{lower: 8 %, upper: 25 %}}" for place in ("piston", "rod")),
        _bounds("clevis.pin_diameter", sizes.pin / 2, min(4 * sizes.pin, INPUTS["diameter"].upper)),
    ]


def _seals(answers: StartAnswers, sizes: _Sizes) -> list[str]:
    """O-rings of piston, rod and ends, with back-up rings where their gap needs them."""
    compound, back_up = compound_of(answers.pressure, GAP_RATIO * sizes.clearance)
    lines = []
    for place, diameter, rings in (("piston", sizes.bore, "both"), ("rod", sizes.rod, "one")):
        section = section_of(diameter)
        line = (
            f"  {place}: {{type: o_ring, compound: {compound}, section: {_mm(section)}, "
            "squeeze: 14 %, tolerance: 0.05 mm"
        )
        if back_up:
            gland = standard_sizes.gland(section)
            ring = (sum(gland.widths(1)) - sum(gland.widths(0))) / 2
            line += (
                f",\n    back_up: {rings}, back_up_material: back_up_ptfe, "
                f"back_up_thickness: {_mm(ring)}"
            )
        lines.append(f"{line}}}")
    static = (
        f"  static: {{compound: {compound}, section: {_mm(sizes.section)}, squeeze: 20 %, "
        "tolerance: 0.05 mm}"
    )
    return [*lines, static]
