"""Results of a barrel wall, for every wall model."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...base.numeric import Array
from ...models.autofrettage import Autofrettage
from .load_path import LoadPath, Swelling

SEAL_STEP = 0.5
"""Share of the far-field growth at a pressure step, `barrel.pressure_step_factor(0)`."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """Equivalent stress of a metal per pressure pulse [Pa]: range and mean."""

    material: str
    span: Array
    mean: Array


@dataclass(slots=True)
class Wall:
    """The wall of a design. Pressures by place (part, mode, load path), Pa, (designs,).

    `cycles` are the stresses of metals under pulsating pressure, by place; `ply_fatigue` is the
    fatigue strength of fibres over their stress amplitude.

    `growth` is at supply pressure, the larger value with and without the axial force of the cases;
    `case_growth` at the pressures of the cases; `missing` are unknown strengths;
    `axial_line_stiffness` is the axial E t of the wall, N/m; `mismatch` is yield over liner stress,
    `bond` strength over liner tension on the plies, both after cool-down from cure.
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
    why_no_mismatch: str = "the wall has a single material"
    missing: list[str] = field(default_factory=list)
