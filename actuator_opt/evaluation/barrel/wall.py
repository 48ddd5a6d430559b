"""What the barrel's wall does, whatever model found it."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...base.numeric import Array
from ...models.autofrettage import Autofrettage
from .load_path import LoadPath, Swelling

SEAL_STEP = 0.5
"""Share of the far-field growth that acts at a pressure step, `barrel.pressure_step_factor(0)`."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """Equivalent stress of a metal under pressure, per pressure pulse [Pa]: range, and its mean."""

    material: str
    span: Array
    mean: Array


@dataclass(slots=True)
class Wall:
    """The wall of a design. Pressures by place (part, mode, load path), Pa, (designs,).

    `cycles` are the stresses of metals while pressure comes and goes, by place; `ply_fatigue` the
    fatigue strength of fibres over their stress amplitude.

    `growth` is at supply pressure, the worse of the cases' own axial force and none, `case_growth`
    at the pressures of the cases; `missing` the strengths nobody states; `axial_line_stiffness` is
    E t of the wall along the axis, N/m; `mismatch` yield over the liner's stress and `bond`
    strength over its pull on the plies, after cooling from the cure.
    """

    swelling: Swelling
    path: LoadPath
    growth: Array
    case_growth: Array
    bending_stiffness: Array
    shear_stiffness: Array
    thin_ratio: Array
    layered: bool
    axial_line_stiffness: Array
    expansion: tuple[Array, Array] | None = None
    yield_pressure: dict[str, Array] = field(default_factory=dict)
    first_ply_pressure: dict[str, Array] = field(default_factory=dict)
    burst_pressure: dict[str, Array] = field(default_factory=dict)
    mismatch: dict[str, Array] = field(default_factory=dict)
    bond: dict[str, Array] = field(default_factory=dict)
    cycles: dict[str, Cycle] = field(default_factory=dict)
    ply_fatigue: dict[str, Array] = field(default_factory=dict)
    autofrettage: Autofrettage | None = None
    why_no_mismatch: str = "the wall is of one material"
    missing: list[str] = field(default_factory=list)
