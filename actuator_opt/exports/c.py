"""Write recorded computations as C: a source file with its header, for any C99 or C++ compiler.

A recorded computation, called a program, becomes tables of numbers, which an interpreter runs. The
interpreter is that of the Python extension, called the machine; its text (`machine.h`) is copied
into the file. C statements instead of tables would give values five times as fast, but even for the
values of the example design `knee` alone, a compiler takes 15 s for them instead of 0.3 s. The
files allocate no memory, have no variables outside functions, and need only the mathematics
library.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from math import inf
from typing import Any

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..base.symbolic.program import MACHINE, Program
from .dxf import plain

LONGEST_NAME = 48
"""Largest number of characters of a name in C; longer names are cut (our choice: C99 compilers
distinguish at least 63)."""
HEADERS = frozenset({
    "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "iso646", "limits",
    "locale", "math", "setjmp", "signal", "stdarg", "stdbool", "stddef", "stdint", "stdio",
    "stdlib", "string", "tgmath", "time", "wchar", "wctype",
})  # fmt: skip
"""Names of the headers of C99; a file of the same name could hide them."""
LINE = 96
"""Number of characters of a line in a table."""


@dataclass(frozen=True, slots=True)
class DeclaredNumber:
    """An input or output that a header declares.

    Parameters
    ----------
    name, unit, label : name, SI unit, and description ("" if the name says it)
    present : value in the exported design or at the start of the scenario, in SI
    lower, upper : bounds of a variable; a fixed number has none
    """

    name: str
    unit: str
    present: float
    label: str = ""
    lower: float | None = None
    upper: float | None = None


# ---- texts and numbers in C ----


def word(text: str) -> str:
    """The ASCII letters and digits of a text, with underscores between them.

    >>> word("load_cases[stance].force")
    'load_cases_stance_force'
    """
    return re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")[:LONGEST_NAME].rstrip("_")


def file_word(stem: str) -> str:
    """Name of C files, with which all names in them start.

    >>> file_word("knee"), file_word("40 mm"), file_word("µ"), file_word("math")
    ('knee', 'design_40_mm', 'design', 'design_math')
    """
    name = word(stem)
    if name[:1].isalpha() and name.lower() not in HEADERS:
        return name
    return f"design_{name}".rstrip("_")


def constants(prefix: str, texts: Iterable[str]) -> list[str]:
    """Names of constants in C for texts, in capitals and different from each other.

    >>> constants("knee", ["rod.length", "rod length"])
    ['KNEE_ROD_LENGTH', 'KNEE_ROD_LENGTH_2']
    """
    names: dict[str, None] = {}
    for text in texts:
        first = name = f"{prefix}_{word(text)}".upper()
        count = 1
        while name in names:
            count += 1
            name = f"{first}_{count}"
        names[name] = None
    return list(names)


def quoted(text: str) -> str:
    r"""A string in C; bytes beyond ASCII are escaped, so that the file needs no encoding.

    >>> print(quoted('5 µm "x"?'))
    "5 \302\265m \"x\"\?"
    """
    characters = []
    for byte in plain(text).encode("utf-8", "replace"):
        character = chr(byte)
        if not 32 <= byte <= 126:
            character = f"\\{byte:03o}"
        elif character in '"\\?':
            character = f"\\{character}"
        characters.append(character)
    return f'"{"".join(characters)}"'


def remark(text: str) -> str:
    r"""Text for a comment in C: ASCII, and nothing that would end or continue the comment.

    >>> remark("end */ of m² \\")
    'end * / of m? /'
    """
    line = plain(text).encode("ascii", "replace").decode("ascii").replace("\\", "/")
    return re.sub(r"\?(?=\?)", "? ", line).replace("*/", "* /").replace("/*", "/ *")


def number(value: float) -> str:
    """A number in C, with all its digits."""
    if value != value:
        return "NAN"
    if value in (inf, -inf):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def table(kind: str, name: str, values: Sequence[Any] | Array) -> str:
    """A constant array in C; an empty one gets an entry, which C requires."""
    entries = [number(value) if isinstance(value, float) else str(value) for value in values]
    lines, line = [], ""
    for entry in entries or ["0"]:
        if len(line) + len(entry) + 1 > LINE:
            lines.append(line)
            line = ""
        line += f"{entry},"
    body = "\n".join([*lines, line.rstrip(",")])
    return f"static const {kind} {name}[] = {{\n{body}\n}};\n"


def listing(kind: str, name: str, entries: Sequence[DeclaredNumber], bounds: bool) -> str:
    """A constant array of the inputs or outputs that the header declares."""
    rows = []
    for entry in entries:
        values = [entry.present]
        if bounds:
            values += [entry.present if b is None else b for b in (entry.lower, entry.upper)]
        shown = ", ".join(map(number, values))
        rows.append(f"    {{{quoted(entry.name)}, {quoted(entry.unit)}, {shown}}}")
    return f"const {kind} {name}[] = {{\n" + ",\n".join(rows) + "\n};\n"


def enumeration(names: Sequence[str], entries: Sequence[DeclaredNumber], last: str) -> str:
    """Constants in C that number the entries, each with its description; the last is their count.

    Names and entries have equal lengths.
    """
    rows = []
    for name, entry in zip(names, entries, strict=True):
        unit = f" [{entry.unit}]" if entry.unit else ""
        label = f", {entry.label}" if entry.label else ""
        text = f"{entry.name}{unit}{label}: {entry.present:.6g}"
        if entry.lower is not None:
            text += f", variable from {entry.lower:.6g} to {entry.upper:.6g}"
        rows.append(f"    {name}, /* {remark(text)} */")
    return "enum {\n" + "\n".join([*rows, f"    {last}"]) + "\n};\n"


def program_tables(name: str, program: Program, code: Array) -> str:
    """A program as constant arrays in C, and the structure that the interpreter takes."""
    parts = [
        table("uint16_t", f"CODE_OF_{name}", code.ravel().tolist()),
        table("int32_t", f"EXTRA_OF_{name}", program.extra.tolist()),
        table("int32_t", f"OUTPUTS_OF_{name}", program.outputs.tolist()),
        table("double", f"CONSTANTS_OF_{name}", program.constants.tolist()),
    ]
    sizes = (
        len(code), len(program.extra), len(program.outputs), len(program.constants),
        program.slots, program.inputs,
    )  # fmt: skip  # in the order of the structure in `machine.h`
    arrays = ", ".join(f"{part}_OF_{name}" for part in ("CODE", "EXTRA", "OUTPUTS", "CONSTANTS"))
    structure = f"static const Program {name} = {{\n    {arrays},\n    {', '.join(map(str, sizes))}"
    return "".join(parts) + structure + "\n};\n"


def filled(template: str, **values: object) -> str:
    """A template with ``@key@`` replaced by values."""
    return re.sub(r"@(\w+)@", lambda match: str(values[match[1]]), template)


def machine() -> str:
    """C text of the interpreter (`machine.h`), with the function that runs a program once."""
    return MACHINE.read_text("utf-8") + RUN


RUN = """
/* Write the inputs and the constants of a program to their slots. */
static void start(const Program *p, const double *inputs, double *V) {
    for (ptrdiff_t k = 0; k < p->inputs; k++) V[k] = inputs[k];
    constants_to(p, V, 1);
}

/* Compute all slots of a program from its inputs. */
static void run(const Program *p, const double *inputs, double *V) {
    start(p, inputs, V);
    for (ptrdiff_t k = 0; k < p->count; k++) value_of(p->code + WORDS * k, p->extra, V, 1);
}
"""
