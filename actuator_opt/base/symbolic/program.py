"""Programs: instructions that read and write numbered slots, run by a small virtual machine.

The virtual machine ("machine" for short) is a C extension. It is built at installation if there is
a C compiler; without it, callers use the models themselves, through NumPy.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Sequence
from dataclasses import field, fields
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..dataclass import dataclass
from ..numeric import Array
from .derivative import is_steep_at_zero
from .expression import Symbol, needed

try:
    COMPILED: Any = import_module("._machine", __package__)
except ImportError:
    COMPILED = None
OPERATIONS: Final[tuple[str, ...]] = getattr(COMPILED, "OPERATIONS", ())
AVAILABLE: Final = COMPILED is not None
"""Whether the virtual machine was built at installation."""
NOT_BUILT: Final = "the machine was not built at installation"
"""Reason why programs cannot be written or run."""
MACHINE: Final = Path(__file__).with_name("machine.h")
"""Text of the machine, without its Python module."""
SCRIPT: Final = Path(__file__).with_name("machine.js")
"""The same machine in JavaScript, for pages; it takes `Program.for_page`."""
WIDTH: Final = 4
"""The virtual machine computes derivatives along a multiple of this number of directions."""
SHARED: Final = ("real", "part")
"""Operations that compute nothing new: the value of the operand without its derivatives, and one of
the computed roots of a polynomial. Their value is in the slot of their operand."""
MOST_SLOTS: Final = 2**16
"""Largest number of slots that an instruction can name."""
NOTHING: Final = np.empty((0, 0, 0))
"""No shared inputs, or no seeds, of `Program.duals`."""
EQUAL: Final = np.empty(0, dtype=np.int32)
"""Groups of points of equal size, of `Program.duals`."""
_FROZEN: Final = 16
"""Flag of an instruction whose first operand counts as a constant, without derivative; the flag of
the second operand is twice this number, that of the third four times."""
_MISSING: Final = (7 * _FROZEN, 6 * _FROZEN, 4 * _FROZEN)
"""Flags of the operands that an operation with 0, 1 or 2 operands does not have."""


@dataclass(slots=True)
class Program:
    """Instructions that compute outputs from inputs.

    Parameters
    ----------
    code : (instructions, 5); each row has the operation with its flags, the slot of the result, and
        the slots of three operands
    extra : slots of the coefficients of polynomials whose roots are computed
    outputs : slot of every output
    frozen : for each output, whether it never has derivatives
    constants : values of the constants, whose slots follow all others
    slots : number of slots for inputs and for results of instructions
    inputs : number of inputs; they are in the first slots
    once : number of the first instructions, which need only the first inputs; points that share
        these inputs run them once
    shared : number of these inputs
    """

    code: Array
    extra: Array
    outputs: Array
    frozen: Array
    constants: Array
    slots: int
    inputs: int
    once: int = 0
    shared: int = 0
    _checked: dict[bytes | None, Any] = field(default_factory=dict)
    """Programs for the virtual machine, by the inputs that change (see `along`)."""

    def __getstate__(self) -> tuple[Any, ...]:
        return tuple(getattr(self, part.name) for part in fields(self)[:-1])

    def __setstate__(self, parts: tuple[Any, ...]) -> None:
        self.__init__(*parts)  # type: ignore[misc]

    def values(self, points: Array) -> Array:
        """Outputs (points, outputs) at points (points, inputs)."""
        return self.duals(NOTHING, points, NOTHING)[:, :, 0]

    def require_valid(self) -> None:
        """Raise `ValueError` if the program would use memory outside its slots."""
        self._runnable(None)

    def with_fixed(self, values: Array) -> Program:
        """The same program of fewer inputs: the last inputs become constants with these values."""
        count = self.inputs - len(values)
        places = np.arange(self.slots + len(self.constants))  # new slot of every old slot
        places[self.inputs :] -= len(values)
        places[count : self.inputs] = self.slots - len(values) + len(self.constants)
        places[count : self.inputs] += np.arange(len(values))
        code = self.code.copy()
        code[:, 1] = places[code[:, 1]]
        plain = code[:, 0] & 255 != OPERATIONS.index("roots")
        code[plain, 2:] = places[code[plain, 2:]]
        constants = np.append(self.constants, values)
        return Program(
            code, places[self.extra].astype(np.int32), places[self.outputs].astype(np.int32),
            self.frozen, constants, self.slots - len(values), count,
        )  # fmt: skip

    def used_inputs(self) -> Array:
        """Whether each input is read (inputs,)."""
        read = np.zeros(self.slots + len(self.constants), dtype=bool)
        plain = self.code[:, 0] & 255 != OPERATIONS.index("roots")  # it reads its slots from extra
        for slots in (self.code[plain, 2:], self.extra, self.outputs):
            read[slots.ravel()] = True
        return read[: self.inputs]

    def duals(
        self,
        shared: Array,
        own: Array,
        seeds: Array,
        rows: int | None = None,
        group: Array = EQUAL,
    ) -> Array:
        """Outputs and their slopes (rows, outputs, 1 + directions); outputs come first.

        Parameters
        ----------
        shared : the first inputs (groups, inputs), each for some successive points
        own : the other inputs of every point, (points, inputs)
        seeds : change of the first inputs in every direction (groups, inputs, directions), each for
            some successive points; empty: values only. A multiple of `WIDTH` directions needs no
            copy
        rows : number of rows, each the sum over some successive points; None: one for every point
        group : the group of every point (points,), int32, if groups differ in size
        """
        size = (len(own) if rows is None else rows, len(self.outputs))
        shared, own = (np.ascontiguousarray(part, dtype=float) for part in (shared, own))
        inputs, directions = seeds.shape[1:]
        active = np.arange(directions)
        if directions % WIDTH:
            active = np.flatnonzero(seeds.any(axis=(0, 1)))  # other directions change nothing
            padded = np.zeros((len(seeds), inputs, -(-len(active) // WIDTH) * WIDTH))
            padded[:, :, : len(active)] = seeds[:, :, active]
            seeds = padded
        seeds = np.ascontiguousarray(seeds, dtype=float)
        count, width = len(active), seeds.shape[2]
        found = np.empty((*size, 1 + width))
        runnable = self._runnable(seeds.any(axis=(0, 2)) if width else None)
        COMPILED.run(runnable, shared, shared.shape[1], own, seeds, inputs, width, group, found)
        if count == directions:
            return found[:, :, : 1 + count]
        results = np.zeros((*size, 1 + directions))
        results[:, :, 0], results[:, :, 1 + active] = found[:, :, 0], found[:, :, 1 : 1 + count]
        return results

    def repeated(
        self, point: Array, states: int, columns: Sequence[int] | None = None
    ) -> Callable[[float, Array], Array]:
        """A function of time and states that is cheap to call many times; other inputs stay fixed.

        Every call overwrites the result of the call before. The function raises
        `FloatingPointError` if a result is not finite.

        Parameters
        ----------
        point : all inputs (inputs,), first time and states; every call writes its time and states
            there
        states : number of states
        columns : None: the function returns the outputs (outputs,). Otherwise the indices of inputs
            that are states: it returns the derivatives (outputs, states), 0 for states not among
            them
        """
        places = np.array([] if columns is None else columns, dtype=np.int32)
        moving = np.isin(np.arange(self.inputs), places)
        count = len(self.outputs)
        results = np.zeros(count if columns is None else (count, states))
        prepared: Callable[[float, Array], Array] = COMPILED.prepare(
            self._runnable(moving), states, places, point, results, columns is not None
        )
        return prepared

    def for_page(self) -> dict[str, object]:
        """The program as JSON for the JavaScript virtual machine (`SCRIPT`); arrays are in base64.

        A program with 40 000 instructions, such as that of the example design of a knee, has 540
        kB.
        """

        def packed(array: Array, kind: str) -> str:
            return b64encode(np.ascontiguousarray(array, dtype=kind).tobytes()).decode("ascii")

        return {
            "operations": list(OPERATIONS),
            "code": packed(self.code, "<u2"),
            "extra": packed(self.extra, "<i4"),
            "outputs": packed(self.outputs, "<i4"),
            "frozen": packed(self.frozen, "u1"),
            "constants": packed(self.constants, "<f8"),
            "slots": self.slots,
            "inputs": self.inputs,
        }

    def along(self, moving: Array) -> tuple[Array, Array]:
        """Instructions that only compute derivatives by the `moving` inputs; which outputs vary.

        The moving inputs are those whose change is not 0 in at least one direction of
        differentiation. The others have no derivatives.

        Parameters
        ----------
        moving : whether each input changes, (inputs,); others of the inputs do not
        """
        code, active = self.code.copy(), np.zeros(self.slots, dtype=np.uint8)
        active[: len(moving)] = moving
        COMPILED.follow(code, active, self.slots)
        ends = np.append(active, np.zeros(len(self.constants), dtype=np.uint8))[self.outputs]
        return code, np.where(self.frozen, 0, ends).astype(np.int32)

    def _runnable(self, moving: Array | None) -> Any:
        """The program for the virtual machine, without derivatives (None) or along some inputs.

        The virtual machine checks a program once, here, and copies it. Raises `ValueError` for a
        damaged program.
        """
        key = None if moving is None else moving.tobytes()
        if key not in self._checked:
            code, varies = (self.code, self.frozen) if moving is None else self.along(moving)
            self._checked[key] = COMPILED.checked(
                code, self.extra, self.outputs, varies, self.constants,
                self.slots, self.inputs, self.once, self.shared,
            )  # fmt: skip
        return self._checked[key]


def program(inputs: Sequence[Symbol], outputs: Sequence[Any], shared: int = 0) -> Program:
    """Write the program that computes outputs (symbols or numbers) from inputs.

    A slot is used again once its value is no longer needed, so that all slots stay in fast memory.

    Parameters
    ----------
    shared : number of the first inputs that many points share; instructions that need no others
        come first
    """
    return _Writer(inputs, outputs, shared).program()


def _owner(node: Symbol) -> Symbol:
    """The node whose slot holds the value of `node`; an operation in `SHARED` has no own slot."""
    while node.op in SHARED:
        node = node.args[0]
    return node


class _Writer:
    """Assigns slots to the operations that outputs depend on, and writes the instructions."""

    def __init__(self, inputs: Sequence[Symbol], outputs: Sequence[Any], shared: int) -> None:
        self.inputs, self.outputs, self.shared = inputs, outputs, shared
        self.slot: dict[int, int] = {node.index: k for k, node in enumerate(inputs)}
        given = set(self.slot)
        nodes = [n for n in needed(outputs) if n.index not in given and n.op not in SHARED]
        self.first = self._of_shared(nodes) if shared else set()
        """Results that need only shared inputs."""
        self.nodes = sorted(nodes, key=lambda node: node.index not in self.first)
        self.constants: dict[float | str, int] = {}
        self.values: list[float] = []
        self.extra: list[int] = []
        self.code: list[tuple[int, ...]] = []
        self.count = len(inputs)

    def _of_shared(self, nodes: Sequence[Symbol]) -> set[int]:
        """Nodes that need only shared inputs."""
        found = {node.index for node in self.inputs[: self.shared]}
        for node in nodes:
            operands = (_owner(a).index for a in node.args if type(a) is Symbol)
            if all(index in found for index in operands):
                found.add(node.index)
        return found

    def program(self) -> Program:
        """Write all instructions."""
        codes = {name: k for k, name in enumerate(OPERATIONS)}
        slot, steep = self.slot, bool(self.nodes) and self.nodes[0].graph.truth is None
        last = {
            (a if a.op not in SHARED else _owner(a)).index: k
            for k, node in enumerate(self.nodes)
            for a in node.args
            if type(a) is Symbol
        }
        kept = {_owner(out).index for out in self.outputs if isinstance(out, Symbol)}
        kept |= {node.index for node in self.inputs}
        kept |= {  # of instructions that run once, what the others need
            index
            for node in self.nodes
            if node.index not in self.first
            for a in node.args
            if type(a) is Symbol and (index := _owner(a).index) in self.first
        }
        free: list[int] = []
        once = 0
        for k, node in enumerate(self.nodes):
            flags = _MISSING[len(node.args)] if len(node.args) < 3 else 0
            places: list[int] = []
            for operand in node.args:
                if type(operand) is not Symbol:
                    places.append(self._place(operand))
                    continue
                index = operand.index
                if operand.op in SHARED:
                    index = _owner(operand).index
                    if operand.op == "real" and len(places) < 3:
                        flags |= _FROZEN << len(places)
                    places.append(self._place(operand))
                else:
                    places.append(slot[index])
                if last[index] == k and index not in kept:
                    last[index] = -1
                    free.append(slot[index])
            wide, words = 1, places
            if node.op == "roots":
                kept.add(node.index)  # its slots are neighbours and are not used again
                wide, words = 2 * (len(places) - 1), [len(self.extra), len(places) - 1, 0]
                self.extra += places
            if wide == 1 and free:
                at = free.pop()
            else:
                at, self.count = self.count, self.count + wide
            slot[node.index] = at
            # a place without an operand repeats the first
            words = words + [words[0]] * (3 - len(words))
            self.code.append((codes[node.op] | flags << 8, at, *words))
            if steep and is_steep_at_zero(node):
                self.code.append((codes["where"], at, at, at, self._place(0.0)))
            if node.index in self.first:
                once = len(self.code)
        return self._finished(once)

    def _place(self, value: Any) -> int:
        """Slot of an operand; constants have -1, -2, ... until the number of slots is known."""
        if type(value) is Symbol:
            if value.op not in SHARED:
                return self.slot[value.index]
            at = 0
            while value.op in SHARED:
                at += value.args[1] if value.op == "part" else 0
                value = value.args[0]
            return self.slot[value.index] + at
        number = float(value)
        key = number or str(number)  # -0 and 0 are equal, but not their texts
        if key not in self.constants:
            self.constants[key] = -1 - len(self.values)
            self.values.append(number)
        return self.constants[key]

    def _finished(self, once: int) -> Program:
        outputs = [self._place(out) for out in self.outputs]
        frozen = [isinstance(out, Symbol) and out.op == "real" for out in self.outputs]

        def settled(places: Any) -> Array:
            array = np.array(places, dtype=np.int32)
            return np.where(array < 0, self.count - 1 - array, array).astype(np.int32)

        if self.count + len(self.values) > MOST_SLOTS:
            raise ValueError("the recorded models need too many intermediate values at once")
        code = np.array(self.code, dtype=np.int32).reshape(-1, 5)
        code[:, 2:] = settled(code[:, 2:])
        return Program(
            code.astype(np.uint16), settled(self.extra), settled(outputs),
            np.array(frozen, dtype=np.int32), np.array(self.values), self.count, len(self.inputs),
            once, self.shared,
        )  # fmt: skip
