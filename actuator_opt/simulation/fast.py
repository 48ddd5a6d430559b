"""Fast integration by CVODES of SUNDIALS through CasADi (extra ``fast``), without Python code.

The graph of a system becomes symbols of CasADi, each operation once; CasADi derives the exact
Jacobian. No compiler is needed. If CVODES fails, another integrator takes over that section or
reports why it cannot. A servo takes about half of LSODA's time, at the same error.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import Any

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.symbolic import Symbol
from ..base.symbolic.expression import needed
from .methods import CHUNK, Advance
from .system import Compiled

SHARPER = 0.1
"""Absolute tolerance relative to the stated one (a choice: gives the measured error of LSODA)."""
_EVEN = 1e-8
"""Relative difference of two steps that counts as rounding."""
_BUFFERED = 1
"""Address of the first buffer in the memory of a CasADi function."""


def library() -> Any:
    """Import ``casadi``, with a clear message if the extra is not installed.

    Raises
    ------
    InputError
        CasADi is missing
    """
    try:
        import casadi
    except ImportError as missing:
        message = "the method cvodes needs CasADi"
        raise InputError(Diagnostic(message, 'pip install "actuator-opt[fast]"')) from missing
    return casadi


def translate(outputs: Sequence[Any]) -> tuple[dict[str, Any], list[Any]]:
    """Translate expressions to CasADi's symbols.

    Parameters
    ----------
    outputs : expressions of one graph

    Returns
    -------
    the free symbols by name (variables and flags), and the outputs

    Raises
    ------
    InputError
        a record, which is looked up and has no formula
    """
    casadi = library()
    free: dict[str, Any] = {}
    known: dict[int, Any] = {}

    def said(value: Any) -> Any:
        return known[value.index] if isinstance(value, Symbol) else float(value)

    for node in needed(outputs):
        if node.op in ("variable", "flag"):
            known[node.index] = free[node.args[0]] = casadi.SX.sym(node.args[0])
        elif node.op == "table":
            message = "the method cvodes cannot look up a record"
            raise InputError(Diagnostic(message, "integrate by lsoda, without --fast"))
        else:
            known[node.index] = _operation(casadi, node.op, [said(one) for one in node.args])
    return free, [said(one) for one in outputs]


def _operation(casadi: Any, op: str, args: Sequence[Any]) -> Any:
    """An operation by CasADi's own number; its operators are slow, as they check shapes."""
    unary, binary = casadi.SX.unary, casadi.SX.binary
    if op == "where":
        condition, yes, no = args
        taken = binary(casadi.OP_IF_ELSE_ZERO, condition, yes)
        left = binary(casadi.OP_IF_ELSE_ZERO, unary(casadi.OP_NOT, condition), no)
        return binary(casadi.OP_ADD, taken, left)
    number = getattr(casadi, f"OP_{op.upper()}")
    found = unary(number, *args) if len(args) == 1 else binary(number, *args)
    if op == "sqrt" or (op == "pow" and 0 < args[1] < 1):  # no slope at zero, as in `symbolic`
        return binary(casadi.OP_IF_ELSE_ZERO, args[0], found)
    return found


def cvodes(compiled: Compiled, relative: float, counted: list[int], otherwise: Advance) -> Advance:
    """Integration by CVODES.

    Parameters
    ----------
    compiled : the equations
    relative : relative tolerance of a step
    counted : counter of rate evaluations
    otherwise : takes over a section where CVODES fails

    Raises
    ------
    InputError
        CasADi is missing or a record is looked up
    """
    casadi = library()
    equations = _equations(casadi, compiled)
    unit = compiled.tolerances
    built: dict[int, _Integrator] = {}

    def advance(times: Array, y: Array, m: tuple[bool, ...], most: int) -> Array:
        if most not in built:
            built[most] = _Integrator(casadi, equations, relative, most)
        run = built[most]
        found = np.empty((len(times), len(y)))
        found[0] = y
        for begin, end in _even(times):
            try:
                with interruptible():
                    states = run(times[begin], times[end], end - begin, found[begin] / unit, m)
            except RuntimeError:
                return otherwise(times, y, m, most)
            counted[0] += run.evaluations()
            found[begin + 1 : end + 1] = states * unit
        return found

    return advance


@contextmanager
def interruptible() -> Iterator[None]:
    """Preserve Ctrl-C, which CasADi turns into an integration failure."""
    pressed = False
    before = signal.getsignal(signal.SIGINT)

    def press(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        pressed = True
        if callable(before):
            before(number, frame)
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    signal.signal(signal.SIGINT, press)
    try:
        yield
    except RuntimeError:
        if pressed:
            raise KeyboardInterrupt from None
        raise
    finally:
        signal.signal(signal.SIGINT, before)


class _Integrator:
    """CVODES over `CHUNK` samples; unused ones have zero length."""

    def __init__(self, casadi: Any, equations: dict[str, Any], relative: float, most: int) -> None:
        options = {
            "reltol": relative, "abstol": SHARPER, "max_num_steps": most,
            "disable_internal_warnings": True, "show_eval_warnings": False,
        }  # fmt: skip
        ends = np.arange(1.0, CHUNK + 1.0)
        run = casadi.integrator("states", "cvodes", equations, 0.0, ends, options)
        self.function = run
        size: int = run.nnz_in("x0")
        self.begin, self.parameters = np.zeros(size), np.zeros(run.nnz_in("p"))
        self.steps, self.states = np.zeros(CHUNK), np.zeros((CHUNK, size))
        self.buffer, self.call = run.buffer()
        for name, values in (("x0", self.begin), ("p", self.parameters), ("u", self.steps)):
            self.buffer.set_arg(run.index_in(name), values.data)
        self.buffer.set_res(run.index_out("xf"), self.states.data)

    def __call__(
        self, start: float, stop: float, count: int, states: Array, m: tuple[bool, ...]
    ) -> Array:
        """States at evenly spaced samples after the start."""
        self.begin[:], self.parameters[0], self.parameters[1:] = states, start, m
        self.steps[:count], self.steps[count:] = (stop - start) / count, 0.0
        self.call()
        return self.states[:count]

    def evaluations(self) -> int:
        """Rate evaluations in the last call."""
        return int(self.function.stats(_BUFFERED)["nfevals"])


def _equations(casadi: Any, compiled: Compiled) -> dict[str, Any]:
    """The rates per sample, scaled by each state's tolerance, as CVODES takes a single one."""
    system, unit = compiled.system, compiled.tolerances
    free, rates = translate([state.rate for state in system.states])

    def symbol(name: str) -> Any:
        return free.get(name, casadi.SX.sym(name))

    states = casadi.vertcat(*(symbol(str(s.symbol.args[0])) for s in system.states))
    sample, start, step = (casadi.SX.sym(name) for name in ("sample", "start", "step"))
    scaled = casadi.SX.sym("x", len(system.states))
    (ode,) = casadi.substitute(
        [step * casadi.vertcat(*rates) / unit],
        [casadi.vertcat(states, symbol("t"))],
        [casadi.vertcat(scaled * unit, start + step * sample)],
    )
    parameters = casadi.vertcat(start, *(symbol(name) for name in system.flags))
    return {"t": sample, "x": scaled, "p": parameters, "u": step, "ode": ode}


def _even(times: Array) -> Iterator[tuple[int, int]]:
    """First and last sample of every evenly spaced section, at most `CHUNK` steps long."""
    steps = np.diff(times)
    changes = np.flatnonzero(np.abs(np.diff(steps)) > _EVEN * steps[1:]) + 1
    for first, last in zip([0, *changes], [*changes, len(steps)], strict=True):
        for begin in range(first, last, CHUNK):
            yield begin, min(begin + CHUNK, last)
