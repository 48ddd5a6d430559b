"""Write the evaluation of a design as C: metrics, limits and their gradients by the variables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array, namespace, real, where
from ..base.symbolic.program_store import Recording
from ..base.symbolic.recorded import RecordedFunction
from ..design.paths import quantity_of
from ..evaluation.kernel import PreparedDesign, compute, governing
from ..evaluation.limits import fixed_when_prepared
from ..metrics import METRICS
from ..optimisation.actuator import ActuatorProblem, build, margins
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
    table,
)

NO_LOAD = 1e9
"""Margin above which a limited part counts as unloaded and its margin as infinite (our choice)."""


@dataclass(frozen=True, slots=True)
class _Recorded:
    """The evaluation of a design, recorded as a program; its first inputs are the variables."""

    recording: Recording
    inputs: Sequence[DeclaredNumber]
    metrics: Sequence[DeclaredNumber]
    limits: Sequence[DeclaredNumber]
    variables: int


def design_files(
    subject: PreparedDesign, *, stem: str, program: str, date: str | None
) -> dict[str, bytes]:
    """A design's evaluation with gradients as a C source file and its header, by file name.

    Parameters
    ----------
    subject : the prepared design
    stem : file name without suffix; its letters and digits name the files, and start all names in C
    program, date : origin of the files, for a comment

    Raises
    ------
    InputError
        the design has no variables or has custom metrics, or a model cannot be recorded
    """
    found = _recorded(subject)
    name, written = file_word(stem), found.recording.program
    capitals, count = name.upper(), found.variables
    code, varies = written.along(np.arange(written.inputs) < count)
    outputs = [*found.metrics, *found.limits]
    slots = written.slots + len(written.constants)
    facts: dict[str, object] = {
        "name": name,
        "NAME": capitals,
        "title": remark(f"{subject.design.name}: a design with its metrics, limits and gradients"),
        "origin": remark(f"Written by {program}" + (f" on {date}." if date else ".")),
        "variables": count,
        "results": found.recording.rows,
        "guards": len(found.recording.answers),
        "values_work": slots,
        "gradients_work": slots + written.slots * count,
        "example": constants(f"{name}_in", [found.inputs[0].name])[0],
        "in": enumeration(
            constants(f"{name}_in", [x.name for x in found.inputs]), found.inputs,
            f"{capitals}_INPUTS",
        ),
        "out": enumeration(
            constants(f"{name}_out", [x.name for x in found.metrics]), found.metrics,
            f"{capitals}_FIRST_LIMIT",
        ),
        "machine": machine(),
        "tables": program_tables("DESIGN", written, code)
        + table("unsigned char", "VARIES", varies[: found.recording.rows].tolist())
        + table("unsigned char", "ANSWERS", found.recording.answers.astype(int).tolist()),
        "inputs": listing(f"{name}_input", f"{name}_inputs", found.inputs, bounds=True),
        "outputs": listing(f"{name}_output", f"{name}_outputs", outputs, bounds=False),
    }  # fmt: skip
    return {
        f"{name}.h": filled(HEADER, **facts).encode("ascii"),
        f"{name}.c": filled(SOURCE, **facts).encode("ascii"),
    }


@np.errstate(all="ignore")  # results that are not finite are written as such
def _recorded(subject: PreparedDesign) -> _Recorded:
    """Record the computation of objective, metrics and limits of a design as a program."""
    if subject.plugins:
        remedy = "leave out --plugin, and the requirements on metrics of the plug-in"
        raise InputError(Diagnostic("custom metrics cannot be written as C", remedy))
    if subject.design.duty is not None:
        message = "duty cycles cannot be written as C: they are computed from their records"
        raise InputError(Diagnostic(message, "add --unset duty", path="duty"))
    if not subject.design.variables:
        message = "a C file needs variables, by which it computes gradients"
        remedy = "add a `variables` block with lower and upper bounds"
        raise InputError(Diagnostic(message, remedy, path="variables"))
    actuator = build(subject)
    assert actuator.recorded is not None  # a design without custom metrics has one
    names = tuple(
        path
        for path in actuator.recorded.names
        if path in actuator.paths
        or (path in subject.numbers and not (fixed_when_prepared(path) or _counted(subject, path)))
    )
    present = np.array([subject.numbers[path] for path in names])
    known = {row.label for row in actuator.rows}
    limits = (*actuator.rows, *(row for row in actuator.fixed if row.label not in known))
    metrics = [*compute(subject, subject.values()).computed.metrics]

    def results(inputs: Array) -> Array:
        numbers = subject.values(dict(zip(names, inputs, strict=True)))
        computed = compute(subject, numbers).computed
        count = inputs.shape[1]
        values = [actuator.goal.value(computed, subject.cases)]
        values += [governing(metric, computed, numbers, subject) for metric in metrics]
        spare = margins(limits, computed, numbers, count, subject.reserves)
        spare = where(real(spare) > NO_LOAD, np.inf, spare)
        xp = namespace(spare, *values)
        rows = [xp.broadcast_to(xp.asarray(value), (1, count)) for value in values]
        return xp.concatenate([*rows, spare])

    recorded = RecordedFunction(results, names, present)
    recorded(present[:, None])
    recording = recorded.recording
    if recording is None:
        reason = f"the design cannot be written as C: {recorded.reason}"
        raise InputError(Diagnostic(reason, "export another format"))
    shown = recording.program.values(present[None])[0].tolist()
    inputs = [_input(actuator, *pair) for pair in zip(names, present.tolist(), strict=True)]
    known_metrics = [DeclaredNumber("objective", "", shown[0], "sum to minimise")]
    for metric, value in zip(metrics, shown[1:], strict=False):
        quantity = METRICS[metric]
        known_metrics.append(DeclaredNumber(metric, quantity.si_unit, value, quantity.label))
    spare = zip(limits, shown[len(known_metrics) : recording.rows], strict=True)
    return _Recorded(
        recording,
        inputs,
        known_metrics,
        [DeclaredNumber(row.label, "", value) for row, value in spare],
        len(actuator.paths),
    )


def _counted(subject: PreparedDesign, path: str) -> bool:
    """Whether the number at a PATH is whole, such as a number of seals."""
    return quantity_of(path, subject.design).dimension == "count"


def _input(actuator: ActuatorProblem, path: str, present: float) -> DeclaredNumber:
    """An input of the program: a number of the design at a PATH."""
    quantity = quantity_of(path, actuator.subject.design)
    bounds: tuple[float | None, float | None] = (None, None)
    if path in actuator.paths:
        k = actuator.paths.index(path)
        bounds = float(actuator.problem.lower[k]), float(actuator.problem.upper[k])
    return DeclaredNumber(path, quantity.si_unit, present, "", *bounds)


HEADER = """\
/* @title@

   @origin@

   Compile @name@.c with any C99 or C++ compiler, with the mathematics library (-lm). The functions
   allocate no memory and keep nothing between calls: several threads may call them at once, each
   with its own `work`. All numbers are in SI units. An example:

       #include <stdio.h>
       #include "@name@.h"

       static double inputs[@NAME@_INPUTS], outputs[@NAME@_OUTPUTS], work[@NAME@_GRADIENTS_WORK];
       static double gradients[@NAME@_OUTPUTS * @NAME@_VARIABLES];

       int main(void) {
           for (int k = 0; k < @NAME@_INPUTS; k++) inputs[k] = @name@_inputs[k].present;
           inputs[@example@] *= 1.01;
           if (@name@_gradients(inputs, outputs, gradients, work) != 0) return 1;
           for (int k = 0; k < @NAME@_OUTPUTS; k++)
               printf("%s: %g %s\\n", @name@_outputs[k].name, outputs[k], @name@_outputs[k].unit);
           return 0;
       }
*/
#ifndef @NAME@_H
#define @NAME@_H
#ifdef __cplusplus
extern "C" {
#endif

/* Indices of the inputs, with the values of the design file. The variables are first; gradients
   are by these. Keep the other inputs positive. Counts, zeros, knock-downs, and temperatures of
   oil and environment are no inputs: they have the values of the design file. */
@in@
/* Indices of the outputs, with the values of the design file: the objective, then the governing
   value of each metric over all load cases and locations, then the margins of the limits. */
@out@
/* A margin is (value - limit) / |limit| for a lower limit, with the opposite sign for an upper
   limit; a limit of zero does not divide. The limit is met if the margin is 0 or more. */
enum {
    @NAME@_VARIABLES = @variables@,
    @NAME@_OUTPUTS = @results@,
    @NAME@_VALUES_WORK = @values_work@,   /* numbers in `work` for values */
    @NAME@_GRADIENTS_WORK = @gradients_work@ /* numbers in `work` for gradients */
};

/* An input; a fixed number has its present value as both bounds. */
typedef struct {
    const char *name, *unit;
    double present, lower, upper;
} @name@_input;
extern const @name@_input @name@_inputs[@NAME@_INPUTS];

/* An output, with its value at the present inputs. */
typedef struct {
    const char *name, *unit;
    double present;
} @name@_output;
extern const @name@_output @name@_outputs[@NAME@_OUTPUTS];

/* Compute the outputs from the inputs.

   Returns 0, or 1 if the models take another branch at these inputs than at those of the design
   file: this file then cannot compute the outputs, and all are NaN. After a return of 0, an output
   is NaN if the design has no such value. */
int @name@_values(const double *inputs, double *outputs, double *work);

/* Compute the outputs and their derivatives, gradients[output * @NAME@_VARIABLES + variable].

   Returns as @name@_values does. */
int @name@_gradients(const double *inputs, double *outputs, double *gradients, double *work);

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
/* ---- the program of the design ---- */

@tables@
@inputs@
@outputs@
enum { GUARDS = @guards@ };

/* Copy the outputs; all are NaN if a branch differs from the recorded branches. */
static int finished(const double *V, double *outputs) {
    int outside = 0;
    for (int k = 0; k < GUARDS; k++)
        outside |= (V[OUTPUTS_OF_DESIGN[@NAME@_OUTPUTS + k]] != 0) != ANSWERS[k];
    for (int k = 0; k < @NAME@_OUTPUTS; k++) outputs[k] = outside ? NAN : V[OUTPUTS_OF_DESIGN[k]];
    return outside;
}

int @name@_values(const double *inputs, double *outputs, double *work) {
    run(&DESIGN, inputs, work);
    return finished(work, outputs);
}

int @name@_gradients(const double *inputs, double *outputs, double *gradients, double *work) {
    enum { T = @NAME@_VARIABLES };
    double *V = work, *D = work + @NAME@_VALUES_WORK;
    start(&DESIGN, inputs, V);
    for (int k = 0; k < T * T; k++) D[k] = k % (T + 1) == 0;
    dual(DESIGN.code, DESIGN.count, DESIGN.extra, V, D, T, 1);
    const int outside = finished(V, outputs);
    for (int k = 0; k < @NAME@_OUTPUTS; k++)
        for (int t = 0; t < T; t++) {
            const double slope = VARIES[k] ? D[(size_t)OUTPUTS_OF_DESIGN[k] * T + t] : 0.0;
            gradients[(size_t)k * T + t] = outside ? NAN : slope;
        }
    return outside;
}
"""
