"""Write the circuit of a scenario as a unit by FMI 2.0 [FMI-2].

The unit contains C that integrates the equations by itself (co-simulation, `fmu_source`) or lets
the host do so (model exchange, `fmu_exchange`), and a library for this platform if there is a C
compiler. Its inputs are the signal of the valve or, with a controller, the
reference of the loop; force or torque of the load; and, for a supply of constant pressure, supply
and return pressure. An input that the host never sets follows the course of the scenario. Outputs
are all signals of a simulation.

Parameters are numbers of scenario and design by PATH, so far as they enter the equations directly
(`PARAMETERS`). Bore, walls, oil, valve flow, line sizes and Coulomb friction are no parameters:
many numbers are computed from them, in Python. Numbers that are computed from a parameter keep the
value of the export: those of the end stops and bristles, the tuned gain, and pressures that hold
the load. FMI 3 is not offered.
"""

from __future__ import annotations

import hashlib
import io
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.quantities import INPUTS as DESIGNS, SCENARIOS, Quantity
from ..base.symbolic.derivative import jacobian
from ..base.symbolic.expression import Expression, Symbol, needed
from ..base.symbolic.program import Program
from ..design.scenario.kinds import Records
from ..design.scenario.model import SAMPLES, Scenario
from ..evaluation.kernel import PreparedDesign
from ..simulation.components.circuit import (
    LOOPS,
    Circuit,
    FreeValue,
    SampledCourse,
    SampledSlope,
)
from ..simulation.system import SystemState, guard_rates
from .c import file_word, filled, machine, number, program_tables, quoted, remark, table, word
from .c_scenario import circuit_of, programs_of
from .dxf import plain
from .fmu_exchange import EXCHANGE
from .fmu_source import SOURCE

_PRESSURE = DESIGNS["pressure"]
INPUTS: Final[dict[str, tuple[Quantity, str]]] = {
    "signal": (SCENARIOS["signal_value"], "signal to the valve"),
    "load.force": (SCENARIOS["force_value"], "force of the load, pushing the rod in"),
    "load.torque": (SCENARIOS["torque_value"], "torque of the load on the joint"),
    "motor.torque": (SCENARIOS["torque_value"], "torque of the load on the shaft"),
    "supply.pressure": (_PRESSURE, "supply pressure"),
    "supply.return_pressure": (_PRESSURE, "return pressure"),
}
"""Inputs of a unit by name, with quantity and description; `reference` is that of the loop."""
FIXED: Final[dict[str, tuple[Quantity, str]]] = {
    "initial.position": (SCENARIOS["position_value"], "position at the start"),
    "initial.speed": (SCENARIOS["speed_value"], "speed at the start"),
    "initial.pressure_a": (_PRESSURE, "pressure in chamber A at the start"),
    "initial.pressure_b": (_PRESSURE, "pressure in chamber B at the start"),
}
"""Parameters that count at the start only."""
PARAMETERS: Final[dict[str, tuple[Quantity, str]]] = {
    **FIXED,
    "load.mass": (DESIGNS["load_mass"], "mass of the load, without rod and piston"),
    "load.stiffness": (SCENARIOS["load_stiffness"], "stiffness of the load"),
    "load.damping": (SCENARIOS["load_damping"], "damping of the load"),
    "friction.viscous": (DESIGNS["viscous_friction"], "viscous friction of the seals"),
    "valve.offset": (DESIGNS["signal_offset"], "signal that centres the spool"),
    **{
        f"control.{loop}_gain": (SCENARIOS[f"{loop}_gain"], f"gain on the {followed.words}")
        for loop, followed in LOOPS.items()
    },
    "control.integral_time": (SCENARIOS["time_constant"], "integral time of the controller"),
    "control.derivative_time": (SCENARIOS["time_constant"], "derivative time of the controller"),
}
"""Parameters of a unit by PATH, with quantity and description."""
PLATFORMS: Final = {
    ("linux", "x86_64"): ("linux64", ".so"),
    ("linux", "i686"): ("linux32", ".so"),
    ("darwin", "x86_64"): ("darwin64", ".dylib"),
    ("win32", "amd64"): ("win64", ".dll"),
}
"""Folder and suffix of a library, by system and processor, so far as FMI 2.0 names them."""
FLAGS: Final = (
    "-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-fvisibility=hidden",
    "-shared",
)  # fmt: skip
"""Flags of the compiler; results are rounded as in the simulation (no fused products)."""
RELATIVE: Final = 1e-6
"""Relative tolerance, as in `simulate`; absolute tolerances divided by it are nominal values."""
PATIENCE: Final = 300.0
"""Longest time of the compiler [s] (our choice)."""
_GUID: Final = "@guid@"
"""Place of the GUID, which is a hash of all the rest."""
_DAY: Final = (1980, 1, 1, 0, 0, 0)
"""Date of all files in the archive, so that equal units have equal bytes."""


@dataclass(frozen=True, slots=True)
class UnitVariable:
    """A variable of the unit, as its description declares it."""

    name: str
    label: str
    quantity: Quantity
    causality: str
    variability: str
    start: float | None = None
    nominal: float | None = None
    derivative: int | None = None
    """Index of the state of which this is the time derivative, from 1."""

    @property
    def initial(self) -> str | None:
        """Origin of the value at the start: computed by the unit, or stated by the description."""
        return {"output": "calculated", "local": "calculated", "parameter": "exact"}.get(
            self.causality
        )


@dataclass(frozen=True, slots=True)
class _Equations:
    """The equations of a unit; integrals that only serve the balance are left out."""

    circuit: Circuit
    states: Sequence[SystemState]
    free: Mapping[str, FreeValue]
    settable: Sequence[str]
    """Inputs that follow the scenario until they are set."""
    courses: Sequence[SampledCourse | SampledSlope]
    signals: Sequence[UnitVariable]
    programs: Mapping[str, Program]


def unit(
    scenario: Scenario,
    subject: PreparedDesign,
    records: Records,
    *,
    stem: str,
    program: str,
    date: str | None,
) -> tuple[str, bytes, str]:
    """File name, content and note of the unit of a scenario.

    Parameters
    ----------
    scenario, records : inputs over time, and the columns of files that they name
    subject : the design, already with the values that the scenario sets
    stem : file name without suffix; its letters and digits name the unit
    program, date : origin of the unit

    Returns
    -------
    the name, the bytes of the archive, and what it lacks ("" if it has a library for this platform)

    Raises
    ------
    InputError
        the scenario lacks a valve or a gain, its equations are too long or have no value at the
        start, or the package was installed without its compiled part
    """
    name = file_word(stem)
    equations = _equations(scenario, subject, records)
    variables = _variables(equations)
    title = f"{scenario.name}: circuit of a scenario, design {subject.design.name}"
    origin = f"Written by {program}" + (f" on {date}." if date else ".")
    source = _source(equations, variables, title=title, origin=origin)
    description = _description(
        name, scenario, variables, switches=len(equations.circuit.system.switches),
        title=title, program=program, date=date,
    )  # fmt: skip
    digest = hashlib.sha256((source + description).encode("utf-8")).hexdigest()[:32]
    guid = "-".join(digest[a:b] for a, b in ((0, 8), (8, 12), (12, 16), (16, 20), (20, 32)))
    source, description = (text.replace(_GUID, f"{{{guid}}}") for text in (source, description))
    binary, note = _library(name, source)
    files = {
        "modelDescription.xml": description.encode("utf-8"),
        f"sources/{name}.c": source.encode("ascii"),
        "documentation/index.html": _page(title, origin, variables).encode("utf-8"),
        **binary,
    }
    return f"{name}.fmu", _archive(files), note


# ---- equations ----


def _equations(scenario: Scenario, subject: PreparedDesign, records: Records) -> _Equations:
    """The circuit with free inputs and parameters, and the programs of its equations."""
    circuit = circuit_of(scenario, subject, records, free={*INPUTS, *PARAMETERS, "reference"})
    system = circuit.system
    states = [state for state in system.states if not state.integral]
    symbols, rates = [s.symbol for s in states], [s.rate for s in states]
    starts = [s.initial for s in states]
    guards = [switch.guard for switch in system.switches]
    shown = [signal.value for signal in system.signals]
    used = {node.index for node in needed([*starts, *rates, *guards, *shown])}
    free = {name: x for name, x in circuit.freed.items() if x.symbol.index in used}
    replaced = {id(x.value) for x in free.values()}
    signals = [x for x in system.signals if id(x.value) not in replaced]
    outputs = {
        "START": starts,
        "RATES": rates,
        "SLOPES": [x for row in jacobian(rates, [*symbols, system.time]) for x in row],
        "GUARDS": [*guards, *guard_rates(system)],
        "OUTPUTS": [*(x.value for x in free.values()), *(signal.value for signal in signals)],
    }
    tables = [n for n in needed([x for part in outputs.values() for x in part]) if n.op == "table"]
    flags = [system.graph.flag(name) for name in system.flags]
    set_flags = [x.flag for x in free.values() if x.flag is not None]
    frees = [x.symbol for x in free.values()]
    given = [system.time, *symbols, *flags, *set_flags, *frees, *tables]
    names = {*free}
    return _Equations(
        circuit=circuit,
        states=states,
        free=free,
        settable=[name for name, x in free.items() if x.flag is not None],
        courses=[_course(circuit, node) for node in tables],
        signals=[
            UnitVariable(
                f"{x.name}_out" if x.name in names else x.name, x.label, x.quantity,
                "output", "continuous",
            )
            for x in signals
        ],
        programs=programs_of(given, outputs),
    )  # fmt: skip


def _course(circuit: Circuit, node: Symbol) -> SampledCourse | SampledSlope:
    """The samples of a recorded course."""
    course = circuit.system.graph.tables[node.args[0]]
    assert isinstance(course, SampledCourse | SampledSlope)
    return course


def _number(value: Expression) -> float:
    """A stated number; 0 for a course of time, whose value at the start is computed later."""
    return 0.0 if isinstance(value, Symbol) else float(value)


def _starts(equations: _Equations) -> Array:
    """Values of inputs and parameters at the start."""
    system, programs = equations.circuit.system, equations.programs
    switches = len(system.switches)
    flags = np.zeros(len(system.instants) + switches + len(equations.settable))
    frees = [_number(x.stated) for x in equations.free.values()]
    courses = [float(course(0.0)) for course in equations.courses]
    point = np.concatenate(([0.0], np.zeros(len(equations.states)), flags, frees, courses))
    first = 1 + len(equations.states)
    point[1:first] = programs["START"].values(point[None])[0]
    if switches:
        guards = programs["GUARDS"].values(point[None])[0, :switches]
        point[first + len(system.instants) :][:switches] = guards > 0
    starts = programs["OUTPUTS"].values(point[None])[0, : len(frees)]
    if not np.isfinite(starts).all():
        raise InputError(Diagnostic("an input has no finite value at 0 s", "check its course"))
    return starts


def _variables(equations: _Equations) -> list[UnitVariable]:
    """All variables in the order of their references.

    These are inputs and parameters, outputs, time, states, and the derivatives of the states.
    """
    variables = []
    loop = equations.circuit.loop
    inputs = dict(INPUTS)
    if loop is not None:
        inputs["reference"] = LOOPS[loop].quantity, f"reference of the {LOOPS[loop].words}"
    for (name, value), start in zip(
        equations.free.items(), _starts(equations).tolist(), strict=True
    ):
        if name in inputs:
            quantity, label = inputs[name]
            course = "; follows the scenario until it is set" if value.flag is not None else ""
            variables.append(
                UnitVariable(name, label + course, quantity, "input", "continuous", start)
            )
            continue
        quantity, label = PARAMETERS[name]
        variability = "fixed" if name in FIXED else "tunable"
        variables.append(UnitVariable(name, label, quantity, "parameter", variability, start))
    seconds = Quantity("time", "t", "time", "s", "time")
    clock = UnitVariable("time", seconds.label, seconds, "independent", "continuous")
    variables += [*equations.signals, clock]
    first = len(variables) + 1
    kind = Quantity("state", "", "ratio", "", "state")
    states = [
        UnitVariable(
            f"state.{word(state.name)}", "state of the integration, in SI units", kind, "local",
            "continuous", nominal=float(state.tolerance) / RELATIVE,
        )
        for state in equations.states
    ]  # fmt: skip
    slopes = [
        UnitVariable(
            f"der({state.name})", "rate of a state", kind, "local", "continuous",
            derivative=first + k,
        )
        for k, state in enumerate(states)
    ]  # fmt: skip
    return [*variables, *states, *slopes]


# ---- C ----


def _source(
    equations: _Equations, variables: Sequence[UnitVariable], *, title: str, origin: str
) -> str:
    """The C file; its GUID remains to be filled in."""
    system, programs = equations.circuit.system, equations.programs
    tolerances = [float(state.tolerance) for state in equations.states]
    instants = [float(instant.time) for instant in system.instants]
    stops = np.unique(np.array([*instants, *system.bends], dtype=float)).tolist()
    free = variables[: len(equations.free)]
    kinds = [0 if x.causality == "input" else 1 + (x.variability == "fixed") for x in free]
    places = {name: k for k, name in enumerate(equations.settable)}
    return filled(
        SOURCE,
        title=remark(title),
        origin=remark(origin),
        machine=machine(),
        exchange=EXCHANGE,
        guid=_GUID,
        states=len(equations.states),
        instants=len(instants),
        switches=len(system.switches),
        settable=len(equations.settable),
        free=len(free),
        courses=len(equations.courses),
        stops=len(stops),
        signals=len(free) + len(equations.signals),
        work=max(program.slots + len(program.constants) for program in programs.values()),
        tables="".join(program_tables(key, x, x.code) for key, x in programs.items()),
        tolerances=table("double", "TOLERANCES", tolerances),
        instant_times=table("double", "INSTANT_TIMES", instants),
        stop_times=table("double", "STOP_TIMES", stops),
        starts=table("double", "STARTS", [float(x.start or 0.0) for x in free]),
        kinds=table("int", "KINDS", kinds),
        flags=table("int", "FLAGS_OF", [places.get(x.name, -1) for x in free]),
        switch_names=", ".join(quoted(x.name) for x in system.switches) or '""',
        course_tables=_course_tables(equations.courses),
    )


def _course_tables(courses: Sequence[SampledCourse | SampledSlope]) -> str:
    """The samples of all recorded courses in C."""
    parts, rows = [], []
    for k, course in enumerate(courses):
        parts.append(table("double", f"TIMES_{k}", [float(x) for x in course.time]))
        parts.append(table("double", f"VALUES_{k}", [float(x) for x in course.values]))
        slope = int(isinstance(course, SampledSlope))
        rows.append(f"{{TIMES_{k}, VALUES_{k}, {len(course.time)}, {slope}}}")
    listed = ", ".join(rows) or "{0, 0, 0, 0}"
    return "".join(parts) + f"static const Course COURSE[] = {{{listed}}};\n"


def _library(name: str, source: str) -> tuple[dict[str, bytes], str]:
    """The library for this platform by its file name; else none, and a note that says why."""
    known = PLATFORMS.get((sys.platform, platform.machine().lower()))
    if known is None:
        return {}, "sources only: FMI 2.0 has no name for this platform"
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        return {}, "sources only: no C compiler (cc, gcc or clang) to build a library"
    file = f"{name}{known[1]}"
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, f"{name}.c").write_text(source, "ascii")
        command = [compiler, *FLAGS, f"{name}.c", "-o", file, "-lm"]
        try:
            subprocess.run(
                command, cwd=folder, check=True, capture_output=True, timeout=PATIENCE,
                env={**os.environ, "SOURCE_DATE_EPOCH": "0"},
            )  # fmt: skip
            return {f"binaries/{known[0]}/{file}": Path(folder, file).read_bytes()}, ""
        except subprocess.CalledProcessError as error:
            reason = plain(error.stderr.decode("utf-8", "replace").strip() or str(error))
        except (OSError, subprocess.SubprocessError) as error:
            reason = plain(str(error))
    return {}, f"sources only: the C compiler failed ({reason})"


# ---- description ----

_ATOMS: Final[dict[str, dict[str, int]]] = {
    "m": {"m": 1}, "kg": {"kg": 1}, "s": {"s": 1}, "K": {"K": 1}, "rad": {"rad": 1},
    "N": {"kg": 1, "m": 1, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2}, "W": {"kg": 1, "m": 2, "s": -3}, "Hz": {"s": -1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1}, "1": {},
}  # fmt: skip
"""Base units of the units in `units.BASE`."""


def base_units(unit_text: str) -> dict[str, int]:
    """Exponents of the base units of an SI unit; zero exponents are left out.

    >>> base_units("m^3/(s*Pa)")
    {'m': 4, 's': 1, 'kg': -1}
    """
    total: dict[str, int] = {}
    over, _, under = unit_text.partition("/")
    for part, sign in ((over, 1), (under.strip("()"), -1)):
        for factor in filter(None, part.split("*")):
            atom, _, power = factor.partition("^")
            for base, exponent in _ATOMS[atom].items():
                total[base] = total.get(base, 0) + sign * exponent * int(power or 1)
    return {base: exponent for base, exponent in total.items() if exponent}


def _tag(tag: str, inside: str = "", /, **attributes: object) -> str:
    """An element of XML; attributes that are None are left out."""
    texts = [
        f" {key}={quoteattr(str(value))}" for key, value in attributes.items() if value is not None
    ]
    head = f"{tag}{''.join(texts)}"
    return f"<{head}>{inside}</{tag}>" if inside else f"<{head}/>"


def _units(variables: Sequence[UnitVariable]) -> str:
    """Definitions of all units, with the units in which values are usually shown."""
    shown: dict[str, dict[str, float]] = {}
    for variable in variables:
        quantity = variable.quantity
        if quantity.si_unit:
            displays = shown.setdefault(quantity.si_unit, {})
            if quantity.unit != quantity.si_unit:
                displays[quantity.unit] = quantity.to_display(1.0)
    definitions = []
    for name, displays in shown.items():
        inside = _tag("BaseUnit", **base_units(name))
        inside += "".join(
            _tag("DisplayUnit", name=display, factor=number(factor))
            for display, factor in displays.items()
        )
        definitions.append(_tag("Unit", inside, name=name))
    return "\n".join(definitions)


def _scalar(reference: int, variable: UnitVariable) -> str:
    """Element of a variable."""
    quantity = variable.quantity
    display = quantity.unit if quantity.si_unit and quantity.unit != quantity.si_unit else None
    real = _tag(
        "Real",
        unit=quantity.si_unit or None,
        displayUnit=display,
        start=None if variable.start is None else number(variable.start),
        nominal=None if variable.nominal is None else number(variable.nominal),
        derivative=variable.derivative,
    )
    return _tag(
        "ScalarVariable", real, name=variable.name, valueReference=reference,
        description=plain(variable.label), causality=variable.causality,
        variability=variable.variability, initial=variable.initial,
    )  # fmt: skip


def _unknowns(name: str, listed: Sequence[bool]) -> str:
    """Part of the model structure: the indices of the listed variables, from 1."""
    return _tag(name, "".join(_tag("Unknown", index=k) for k, x in enumerate(listed, 1) if x))


def _description(
    name: str,
    scenario: Scenario,
    variables: Sequence[UnitVariable],
    *,
    switches: int,
    title: str,
    program: str,
    date: str | None,
) -> str:
    """The model description; its GUID remains to be filled in."""
    sources = _tag("SourceFiles", _tag("File", name=f"{name}.c"))
    able = {
        "modelIdentifier": name, "canBeInstantiatedOnlyOncePerProcess": "false",
        "canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true",
    }  # fmt: skip
    structure = {
        "Outputs": [x.causality == "output" for x in variables],
        "Derivatives": [x.derivative is not None for x in variables],
        "InitialUnknowns": [x.initial == "calculated" for x in variables],
    }
    parts = [
        _tag("ModelExchange", sources, **able),
        _tag("CoSimulation", sources, **able, canHandleVariableCommunicationStepSize="true"),
        _tag("UnitDefinitions", f"\n{_units(variables)}\n"),
        _tag("LogCategories", _tag("Category", name="logStatusError")),
        _tag(
            "DefaultExperiment", startTime="0", stopTime=number(scenario.duration),
            tolerance=number(RELATIVE),
            stepSize=number(scenario.sample_time or scenario.duration / SAMPLES),
        ),
        _tag("ModelVariables", "\n" + "\n".join(map(_scalar, range(len(variables)), variables))),
        _tag("ModelStructure", "".join(_unknowns(*part) for part in structure.items())),
    ]  # fmt: skip
    head = _tag(
        "fmiModelDescription", "\n" + "\n".join(parts) + "\n", fmiVersion="2.0", modelName=name,
        guid=_GUID, description=plain(title), generationTool=program,
        generationDateAndTime=f"{date}T00:00:00Z" if date else None,
        variableNamingConvention="structured", numberOfEventIndicators=switches,
    )  # fmt: skip
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{head}\n'


def _page(title: str, origin: str, variables: Sequence[UnitVariable]) -> str:
    """Documentation: the variables, and how inputs and parameters act."""
    rows = []
    for x in variables:
        start = "" if x.start is None else f"{x.start:.6g}"
        cells = (x.name, x.causality, x.variability, x.quantity.si_unit, start, plain(x.label))
        rows.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
    return filled(
        PAGE, title=escape(plain(title)), origin=escape(plain(origin)), rows="\n".join(rows)
    )


def _archive(files: Mapping[str, bytes]) -> bytes:
    """A zip archive with fixed dates."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, _DAY)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system, entry.external_attr = 3, 0o644 << 16  # equal on every system
            archive.writestr(entry, content)
    return buffer.getvalue()


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>@title@</title></head><body>
<h1>@title@</h1>
<p>@origin@ A unit for co-simulation and model exchange by FMI 2.0. All numbers are in SI units;
pressures are gauge pressures.</p>
<p>An input that is never set follows the course of the scenario over time. Once it is set, it keeps
its last value. Fixed parameters count at the start only; tunable parameters may change at any time.
Numbers that the exporting program computed from a parameter do not change with it: stiffness and
damping of the end stops and of the bristles, the tuned gain, and pressures that hold the load.</p>
<p>In co-simulation, the equations are integrated by RODAS, a Rosenbrock method of order 4, with
error control; the relative tolerance is that of the experiment, or else 1e-6. In model exchange,
the state of a pressure p is p above zero, and a log(1 + p/a) below; a is the atmospheric
pressure.</p>
<table border="1"><tr><th>name</th><th>causality</th><th>variability</th><th>unit</th><th>start</th>
<th>description</th></tr>
@rows@
</table></body></html>
"""
