"""Records of a wall through its thickness; `wall_study` fills them. SI throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any, Literal

from ..base.numeric import Array
from .wall_alternatives import Difference, MetalTube, Settling, Thickness

YIELD = "yield"
"""Criterion of metal layers: von Mises."""


@dataclass(frozen=True, slots=True)
class LayerRow:
    """A layer; `strengths` are after knock-downs at the hottest, `factors` the remaining share.

    `angle` in rad from the tube axis; lengths in m, moduli and strengths in Pa.
    """

    material: str
    kind: Literal["metal", "composite", "polymer"]
    angle: float
    balanced: bool
    thickness: float
    inner_radius: float
    outer_radius: float
    moduli: Mapping[str, float]
    strengths: Mapping[str, float]
    factors: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Profile:
    """Stresses [Pa] through the wall under one load, each (layers, points) from the bore.

    `used` is 1/SR by the criterion of the design (metals: yield), including the cure stress of the
    worst climate; NaN if unknown, None at rest.
    """

    name: str
    hoop: Array
    axial: Array
    radial: Array
    used: Array | None = None


@dataclass(frozen=True, slots=True)
class Ratio:
    """Least strength ratio of a layer by one criterion; None if unloaded."""

    layer: int
    criterion: str
    ratio: float | None
    mode: str
    radius: float
    face: Literal["inner face", "inside", "outer face"]
    path: str
    climate: str


@dataclass(frozen=True, slots=True)
class Shares:
    """Stress over strength through the wall, (layers, points), under its most severe load.

    Signed along the fibre, across it and in shear; for metals von Mises over yield. NaN elsewhere.
    """

    path: str
    climate: str
    along: Array
    across: Array
    shear: Array
    mises: Array


@dataclass(frozen=True, slots=True)
class Step:
    """A failure before burst: layer (0 at the bore), mode, pressure [Pa]."""

    layer: int
    mode: str
    pressure: float


@dataclass(frozen=True, slots=True)
class Ladder:
    """Pressures [Pa] from working to burst, None if unknown; places as in the metrics.

    `steps` belong to the load path with the lowest burst, by maximum stress.
    """

    working: float
    proof: float
    metal_yield: float | None
    metal_yield_place: str
    first_ply: float | None
    first_ply_place: str
    criterion: str
    burst: float | None
    path: str
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class WallStudy:
    """The complete study; `radius` is (layers, points) [m], `criterion` that of the design."""

    layers: tuple[LayerRow, ...]
    criterion: str
    radius: Array
    profiles: tuple[Profile, ...]
    rest: tuple[Profile, ...]
    """Cure stress and clamp without pressure, by climate; empty without such stresses."""
    ratios: tuple[Ratio, ...]
    shares: Shares | None
    ladder: Ladder
    differences: tuple[Difference, ...]
    main_layer: int
    thicknesses: tuple[Thickness, ...]
    settling: Settling
    metals: tuple[MetalTube, ...]

    def to_dict(self) -> dict[str, Any]:
        """The `wall` object of `evaluate --json` (SI); profiles are in the report only."""
        found: dict[str, Any] = _finite(
            {
                "layers": [asdict(row) for row in self.layers],
                "ratios": [asdict(row) for row in self.ratios],
                "ladder": asdict(self.ladder),
                "models": [asdict(row) for row in self.differences],
                "main_layer": self.main_layer,
                "thicknesses": [asdict(row) for row in self.thicknesses],
                "settling": asdict(self.settling),
                "metals": [asdict(row) for row in self.metals],
            }
        )
        return found


def _finite(value: Any) -> Any:
    """The same records with None for values that are not finite."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not isfinite(value) else value
