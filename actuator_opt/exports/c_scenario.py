"""Write the equations of a scenario as C: rates of the states, their Jacobian, and all signals."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.symbolic import program as programs
from ..base.symbolic.derivative import jacobian
from ..base.symbolic.expression import Expression, Symbol, needed
from ..base.symbolic.program import Program
from ..design.scenario.kinds import Records
from ..design.scenario.model import Scenario
from ..evaluation.kernel import PreparedDesign
from ..simulation.assemble import assemble
from ..simulation.components.circuit import Circuit
from ..simulation.linear import tune
from ..simulation.system import System
from ..studies.plant import plant
from .c import (
    DeclaredNumber,
    constants,
    enumeration,
    file_word,
    filled,
    listing,
    machine,
    program_tables,
    remark,
)


def scenario_files(
    scenario: Scenario,
    subject: PreparedDesign,
    records: Records,
    *,
    stem: str,
    program: str,
    date: str | None,
) -> dict[str, bytes]:
    """The equations of a scenario as a C source file and its header, by file name.

    Parameters
    ----------
    scenario, records : inputs over time, and the columns of files that they name
    subject : the design, already with the values that the scenario sets
    stem : file name without suffix; its letters and digits name the files, and start all names in C
    program, date : origin of the files, for a comment

    Raises
    ------
    InputError
        the scenario lacks a valve or a gain, its equations are too long, or the package was
        installed without its compiled part
    """
    system = circuit_of(scenario, subject, records).system
    symbols = [state.symbol for state in system.states]
    rates = [state.rate for state in system.states]
    slopes = [entry for row in jacobian(rates, symbols) for entry in row]
    results = [x.value for x in system.signals] + [switch.guard for switch in system.switches]
    tables = [node for node in needed([*rates, *slopes, *results]) if node.op == "table"]
    flags = [system.graph.flag(name) for name in system.flags]
    given = [system.time, *symbols, *flags, *tables]
    written = programs_of(given, {"RATES": rates, "JACOBIAN": slopes, "SIGNALS": results})
    inputs, signals = _declared(system, tables, written["SIGNALS"])
    return _texts(
        file_word(stem), inputs, signals, len(symbols), written,
        title=remark(f"{scenario.name}: the equations of a scenario, design {subject.design.name}"),
        origin=remark(f"Written by {program}" + (f" on {date}." if date else ".")),
    )  # fmt: skip


def circuit_of(
    scenario: Scenario, subject: PreparedDesign, records: Records, *, free: Collection[str] = ()
) -> Circuit:
    """The circuit of a scenario with its tuned gains; the names in `free` stay variables.

    Raises
    ------
    InputError
        the scenario lacks a valve or a gain, or the package was installed without its compiled part
    """
    if not programs.AVAILABLE:
        reason = f"the scenario cannot be written as C: {programs.NOT_BUILT}"
        raise InputError(Diagnostic(reason, "install a C compiler, then reinstall actuator-opt"))
    actuator = plant(subject)
    tuned = tune(scenario, actuator, records)
    gains = None if tuned is None else tuned.gains
    return assemble(scenario, actuator, records, gains, free=free)


def programs_of(
    given: Sequence[Symbol], outputs: Mapping[str, Sequence[Expression]]
) -> dict[str, Program]:
    """Programs that compute outputs from the same inputs, by name; raises `InputError`."""
    try:
        return {name: programs.program(given, values) for name, values in outputs.items()}
    except ValueError as error:
        reason = f"the scenario cannot be written as C: {error}"
        raise InputError(
            Diagnostic(reason, "use fewer hydraulic lines, or signals with fewer pieces")
        ) from None


def _declared(
    system: System, tables: Sequence[Symbol], signals: Program
) -> tuple[list[DeclaredNumber], list[DeclaredNumber]]:
    """The inputs, then the signals and guards of switches, with their values at the start."""
    count = len(system.instants)
    start = np.array(
        [
            0.0,
            *(state.initial for state in system.states),
            *(0.0 for _ in system.flags),
            *(float(system.graph.tables[node.args[0]](0.0)) for node in tables),
        ]
    )
    first = 1 + len(system.states) + count
    switches = slice(first, first + len(system.switches))
    shown = signals.values(start[None])[0]
    for _ in system.switches:  # the guard of a switch may depend on other switches
        start[switches] = shown[len(system.signals) :] > 0
        shown = signals.values(start[None])[0]
    labels = [("time", "s", "")]
    labels += [
        (state.name, "", f"state, tolerance {state.tolerance:.3g}") for state in system.states
    ]
    labels += [(f"after {x.time:.6g} s", "", "1 after this time, else 0") for x in system.instants]
    labels += [
        (x.name, "", "1 while the guard of this switch is positive") for x in system.switches
    ]
    labels += [(system.graph.labels[node.args[0]], "", "value at this time") for node in tables]
    inputs = [
        DeclaredNumber(name, unit, value, label)
        for (name, unit, label), value in zip(labels, start.tolist(), strict=True)
    ]
    names = [(x.name, x.quantity.si_unit, x.label) for x in system.signals]
    names += [(x.name, "", "guard of this switch") for x in system.switches]
    outputs = [
        DeclaredNumber(name, unit, value, label)
        for (name, unit, label), value in zip(names, shown.tolist(), strict=True)
    ]
    return inputs, outputs


def _texts(
    name: str,
    inputs: Sequence[DeclaredNumber],
    signals: Sequence[DeclaredNumber],
    states: int,
    written: dict[str, Program],
    **facts: object,
) -> dict[str, bytes]:
    """Header and source file, from the programs of rates, Jacobian and signals."""
    capitals = name.upper()
    facts |= {
        "name": name,
        "NAME": capitals,
        "states": states,
        "work": max(program.slots + len(program.constants) for program in written.values()),
        "in": enumeration(
            constants(f"{name}_in", [x.name for x in inputs]), inputs, f"{capitals}_INPUTS"
        ),
        "out": enumeration(
            constants(f"{name}_out", [x.name for x in signals]), signals, f"{capitals}_SIGNALS"
        ),
        "machine": machine(),
        "tables": "".join(program_tables(key, x, x.code) for key, x in written.items()),
        "inputs": listing(f"{name}_input", f"{name}_inputs", inputs, bounds=False),
        "outputs": listing(f"{name}_signal", f"{name}_signals", signals, bounds=False),
    }
    return {
        f"{name}.h": filled(HEADER, **facts).encode("ascii"),
        f"{name}.c": filled(SOURCE, **facts).encode("ascii"),
    }


HEADER = """\
/* @title@

   @origin@

   Compile @name@.c with any C99 or C++ compiler, with the mathematics library (-lm). The functions
   allocate no memory and keep nothing between calls: several threads may call them at once, each
   with its own `work`. All numbers are in SI units. Where the equations have no value, results are
   NaN. An example, a millisecond of steps that are short enough for Euler's method:

       #include <stdio.h>
       #include "@name@.h"

       static double inputs[@NAME@_INPUTS], rates[@NAME@_STATES], signals[@NAME@_SIGNALS];
       static double work[@NAME@_WORK];

       int main(void) {
           for (int k = 0; k < @NAME@_INPUTS; k++) inputs[k] = @name@_inputs[k].present;
           for (int step = 0; step < 1000; step++) {
               @name@_rates(inputs, rates, work);
               for (int k = 0; k < @NAME@_STATES; k++) inputs[1 + k] += 1e-6 * rates[k];
               inputs[@NAME@_IN_TIME] += 1e-6;
           }
           @name@_outputs(inputs, signals, work);
           for (int k = 0; k < @NAME@_SIGNALS; k++)
               printf("%s: %g %s\\n", @name@_signals[k].name, signals[k], @name@_signals[k].unit);
           return 0;
       }
*/
#ifndef @NAME@_H
#define @NAME@_H
#ifdef __cplusplus
extern "C" {
#endif

/* Indices of the inputs, with their values at the start: the time, the states, the flags, then
   recorded inputs. A flag is 1 after a given time, or while the guard of its switch is positive;
   else it is 0. Restart the integration where a flag changes. The state s of a gauge pressure p
   is p above zero; below, it is a * log(1 + p / a) with the atmospheric pressure a. */
@in@
/* Indices of the outputs, with their values at the start: first the signals, then the guards of the
   switches, each of which sets the flag of the same name. */
@out@
enum { @NAME@_STATES = @states@, @NAME@_WORK = @work@ /* numbers in `work` */ };

/* An input or a signal, with its value at the start; units of states are those of SI. */
typedef struct {
    const char *name, *unit;
    double present;
} @name@_input, @name@_signal;
extern const @name@_input @name@_inputs[@NAME@_INPUTS];
extern const @name@_signal @name@_signals[@NAME@_SIGNALS];

/* Compute the time derivatives of the states, in the order of the states. */
void @name@_rates(const double *inputs, double *rates, double *work);

/* Compute the derivatives of the rates by the states, jacobian[rate * @NAME@_STATES + state]. */
void @name@_jacobian(const double *inputs, double *jacobian, double *work);

/* Compute the signals, then the guards of the switches. */
void @name@_outputs(const double *inputs, double *signals, double *work);

#ifdef __cplusplus
}
#endif
#endif
"""

SOURCE = """\
/* @title@

   @origin@ The functions are described in @name@.h.
*/
#include "@name@.h"

@machine@
/* ---- the programs of the scenario ---- */

@tables@
@inputs@
@outputs@
static void computed(const Program *p, const double *inputs, double *outputs, double *work) {
    run(p, inputs, work);
    for (ptrdiff_t k = 0; k < p->results; k++) outputs[k] = work[p->outputs[k]];
}

void @name@_rates(const double *inputs, double *rates, double *work) {
    computed(&RATES, inputs, rates, work);
}

void @name@_jacobian(const double *inputs, double *jacobian, double *work) {
    computed(&JACOBIAN, inputs, jacobian, work);
}

void @name@_outputs(const double *inputs, double *signals, double *work) {
    computed(&SIGNALS, inputs, signals, work);
}
"""
