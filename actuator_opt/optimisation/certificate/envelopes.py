"""Envelopes of the models that are no closed expression: never less able than the exact model."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...design.model import Design
from ...evaluation import beam
from ...evaluation.barrel import Wall
from ...evaluation.kernel import Implicit, Pass
from ...evaluation.rods import Rod
from ...models import column, stepped
from ...models.trial_mode import TrialMode, buckled_mode, trial_mode_load
from ...numeric import Array, maximum


def at_design(design: Design, done: Pass, case: int) -> Implicit:
    """Envelopes that are tight at an evaluated design of one column, in one load case."""
    return Implicit(critical_load=_column(_mode(design, done, case)))


def _pinned(design: Design) -> bool:
    return design.cylinder.mount == "cap_clevis"


def _mode(design: Design, done: Pass, case: int) -> TrialMode | None:
    """The shape in which a design buckles."""
    if not _pinned(design):
        return None

    def number(value: Array) -> float:
        rows = np.atleast_2d(np.asarray(value, dtype=float))
        return float(rows[min(case, len(rows) - 1), 0])

    lengths = beam.lengths(done.geometry, done.state)
    segments = {
        "bending_stiffness_1": number(done.wall.bending_stiffness),
        "length_1": number(lengths[0]),
        "bending_stiffness_2": number(done.rod.bending_stiffness),
        "length_2": number(lengths[1]),
    }
    load = float(stepped.stepped_column_load(**segments))
    return buckled_mode(critical_load=load, **segments)


def _column(mode: TrialMode | None) -> Callable[..., Array]:
    """Critical load from above: bent in a given shape, sheared with the stiffer segment's ease."""

    def critical(design: Design, wall: Wall, rod: Rod, lengths: tuple[Array, Array]) -> Array:
        if mode is None:
            return beam.critical_load(design, wall, rod, lengths)
        load = trial_mode_load(
            mode=mode,
            bending_stiffness_1=wall.bending_stiffness,
            length_1=lengths[0],
            bending_stiffness_2=rod.bending_stiffness,
            length_2=lengths[1],
        )
        stiffer = maximum(wall.shear_stiffness, rod.shear_stiffness)
        return column.engesser_load(critical_load=load, shear_stiffness=stiffer)

    return critical
