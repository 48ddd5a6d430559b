"""Equations: expressions as functions of time, states and flags (booleans), for one or many points.

The virtual machine of `program` computes them and their derivatives from one program. If it was not
built at installation, generated Python code computes them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ..dataclass import dataclass
from ..numeric import Array
from . import program as programs
from .code import function, vectorised
from .derivative import jacobian
from .expression import Expression, Symbol, needed
from .program import Program


@dataclass(frozen=True, slots=True)
class PointFunctions:
    """Functions of time and states for given flags.

    Attributes
    ----------
    values : (outputs,)
    slopes : derivatives by the states, (outputs, states)
    latest : the point of the last call, time and states (1 + states,)

    A call may overwrite the result of the call before. It raises `ArithmeticError` or `ValueError`
    where the equations have no finite value.
    """

    values: Callable[[float, Array], Array | list[float]]
    slopes: Callable[[float, Array], Array]
    latest: Callable[[], Array]


class Equations:
    """Outputs as functions of time, states and flags.

    Parameters
    ----------
    time, states, flags : the variables, all of one graph
    outputs : expressions of these variables and of tabulated functions of this time
    """

    def __init__(
        self,
        time: Symbol,
        states: Sequence[Symbol],
        flags: Sequence[Symbol],
        outputs: Sequence[Expression],
    ) -> None:
        self.time, self.states, self.flags = time, tuple(states), tuple(flags)
        self.outputs = tuple(outputs)
        looked_up, tables = time.graph.tables, []
        if looked_up:
            tables = [node for node in needed(self.outputs) if node.op == "table"]
        self._tables = [looked_up[node.args[0]] for node in tables]
        self._program: Program | None = None
        if programs.AVAILABLE:
            inputs = [time, *self.states, *self.flags, *tables]
            self._program = programs.program(inputs, self.outputs)

    def at_samples(self, t: Array, y: Array, m: Sequence[Array | bool]) -> Array:
        """Outputs (outputs, samples); not finite where the equations have no value.

        Parameters
        ----------
        t : times (samples,)
        y : states (states, samples)
        m : for each flag, one truth value for all samples, or an array (samples,)
        """
        results = np.empty((len(self.outputs), len(t)))
        if self._program is None:
            with np.errstate(all="ignore"):
                found = self._generated(vectorised, "y", self.outputs)(t, y, tuple(m))
            for row, values in zip(results, found, strict=True):
                row[:] = values
            return results
        points = np.empty((len(t), 1 + len(y) + len(m) + len(self._tables)))
        points[:, 0], points[:, 1 : 1 + len(y)] = t, y.T
        looked_up = (table(t) for table in self._tables)
        for k, values in enumerate((*m, *looked_up), 1 + len(y)):
            points[:, k] = values
        return self._program.values(points).T

    def at_point(self, m: Sequence[bool]) -> PointFunctions:
        """The functions of time and states for given flags."""
        return self._interpreted(m) if self._program is None else self._run(self._program, m)

    def _run(self, program: Program, m: Sequence[bool]) -> PointFunctions:
        size, tables = 1 + len(self.states), self._tables
        point = np.zeros(size + len(m) + len(tables))
        point[size : size + len(m)] = m

        columns = self._columns

        def with_tables(of: Callable[[float, Array], Array]) -> Callable[[float, Array], Array]:
            def at(t: float, y: Array) -> Array:
                for k, table in enumerate(tables, size + len(m)):
                    point[k] = table(t)
                return of(t, y)

            return at if tables else of

        return PointFunctions(
            with_tables(program.repeated(point, size - 1)),
            with_tables(program.repeated(point, size - 1, columns)),
            lambda: point[:size],
        )

    @cached_property
    def _columns(self) -> list[int]:
        """Inputs of the program that are states on which the outputs depend."""
        used = {node.index for node in needed(self.outputs)}
        return [k for k, state in enumerate(self.states, 1) if state.index in used]

    def _interpreted(self, m: Sequence[bool]) -> PointFunctions:
        flags, point = tuple(m), np.zeros(1 + len(self.states))
        values, slopes = self._functions

        def noted(function: Callable[..., Any]) -> Callable[[float, Array], Any]:
            def at(t: float, y: Array) -> Any:
                point[0], point[1:] = t, y
                return function(t, y, flags)

            return at

        return PointFunctions(noted(values), noted(slopes), lambda: point)

    @cached_property
    def _functions(self) -> tuple[Callable[..., list[float]], Callable[..., Array]]:
        """Generated functions of time, states and flags: the outputs, and their derivatives."""
        entries = [x for row in jacobian(self.outputs, self.states) for x in row]
        filled = np.array([k for k, x in enumerate(entries) if isinstance(x, Symbol) or x], int)
        flat = self._generated(function, "y.tolist()", [entries[k] for k in filled])
        shape = len(self.outputs), len(self.states)

        def slopes(t: float, y: Array, m: tuple[bool, ...]) -> Array:
            table = np.zeros(len(entries))
            table[filled] = flat(t, y, m)
            return table.reshape(shape)

        return self._generated(function, "y.tolist()", self.outputs), slopes

    def _generated(
        self,
        generate: Callable[..., Callable[..., list[float]]],
        states: str,
        outputs: Sequence[Expression],
    ) -> Callable[..., list[float]]:
        """Python code for outputs; `states` is the code that unpacks the states."""
        unpack = {str(self.time.args[0]): "t"}
        for symbols, code in ((self.states, states), (self.flags, "m")):
            if symbols:
                unpack["".join(f"{symbol.args[0]}, " for symbol in symbols).strip()] = code
        return generate("equations", "t, y, m", unpack, outputs)
