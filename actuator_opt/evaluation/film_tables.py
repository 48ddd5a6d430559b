"""The film tables of a design: one per element that asks for a film, load case and stroke.

They are made once, from the design as it stands and the bounds of its variables.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal

import numpy as np

from ..design.model import Design
from ..numeric import Array
from .film import Running, Table, table
from .rings import Ring
from .values import Values, of_case

SAMPLES = 64
"""Points within the bounds of the variables that tell the box of the tables."""

Stroke = Literal["drive", "return"]
Key = tuple[str, int, Stroke]
"""Element, load case and stroke of a table."""

Tables = Mapping[Key, Table]


def films_asked(design: Design) -> bool:
    """Whether any element asks for a film."""
    seals = (design.seals.piston, design.seals.rod)
    return any(one.friction == "film" for seal in seals for one in seal.elements().values())


def on_stroke(ring: Ring, stroke: Stroke) -> Ring:
    """The ring as it is on a stroke: the way back has its own pressure."""
    return ring if stroke == "drive" else ring.at(pressure=ring["return_pressure"])


def _outward(ring: Ring, push: bool) -> dict[Stroke, bool]:
    """The strokes a film is asked of, and whether the counterface then moves outwards.

    The piston runs away from the driven chamber, which it seals: the bore moves inwards past its
    seal either way. The rod seal also tells what the way back returns of the oil dragged out.
    """
    return {"drive": False} if ring.name == "piston" else {"drive": push, "return": not push}


def _floats(ring: Ring, case: int, sample: int = 0) -> Ring:
    """One case's and one design's numbers of a ring."""

    def one(value: Array) -> float:
        array = np.atleast_2d(np.asarray(value, dtype=float))
        row = array[min(case, array.shape[0] - 1)]
        return float(row[min(sample, row.size - 1)])

    return ring.at(**{name: one(value) for name, value in ring.numbers.items()})


def tables(
    design: Design, values: Callable[..., Values], rings_of: Callable[[Values], tuple[Ring, ...]]
) -> dict[Key, Table]:
    """Every film table of a design.

    Parameters
    ----------
    design : the design
    values : its numbers, some of them replaced by arrays (`Subject.values`)
    rings_of : its sealing rings at such numbers
    """
    here = rings_of(values())
    spread = _spread(design)
    others = rings_of(values(spread)) if spread else ()
    found: dict[Key, Table] = {}
    for index, ring in enumerate(here):
        if ring.element.friction != "film":
            continue
        for case, one in enumerate(design.load_cases):
            if of_case(ring["speed"], case) == 0:
                continue
            for stroke, outward in _outward(ring, one.direction == "push").items():
                own = on_stroke(_floats(ring, case), stroke)
                samples = [
                    on_stroke(_floats(others[index], case, k), stroke)
                    for k in range(SAMPLES if spread else 0)
                ]
                usable = [s for s in samples if all(np.isfinite(list(s.numbers.values())))]
                found[ring.label, case, stroke] = table(own, usable, outward=outward)
    return found


def _spread(design: Design) -> dict[str, np.ndarray]:
    """Points within the bounds of the variables: even in each of them, mixed by a fixed seed."""
    mixed = np.random.default_rng(0)
    return {
        path: np.linspace(bounds.lower, bounds.upper, SAMPLES)[mixed.permutation(SAMPLES)]
        for path, bounds in design.variables.items()
    }


def running(tables: Tables, ring: Ring, stroke: Stroke, cases: int) -> Running | None:
    """The film of a ring in every case, (cases, designs); 0 where the case stands still.

    None where no case has a film on this stroke.
    """
    known = [tables.get((ring.label, case, stroke)) for case in range(cases)]
    if not any(known):
        return None
    rows = []
    for case, one in enumerate(known):
        if one is None:
            rows.append([np.zeros(1)] * len(Running.__slots__))
            continue
        film = one.running(_case_row(on_stroke(ring, stroke), case))
        rows.append([np.atleast_1d(getattr(film, name)) for name in Running.__slots__])
    columns = zip(*rows, strict=True)
    return Running(*(np.stack(np.broadcast_arrays(*column)) for column in columns))


def _case_row(ring: Ring, case: int) -> Ring:
    """One case's numbers of a ring, floats or (designs,)."""

    def row(value: Array) -> Array:
        array = np.asarray(value)
        return array[min(case, array.shape[0] - 1)] if array.ndim == 2 else array

    return ring.at(**{name: row(value) for name, value in ring.numbers.items()})
