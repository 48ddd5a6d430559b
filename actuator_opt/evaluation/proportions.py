"""Warnings of implausible values: wrong units or decimal points that no limit would reveal.

`TABLE` contains ratios with their usual ranges. Every range is our choice, wider than in
catalogues. A value outside its range gives a warning, never a fault. The ratios need only
dimensions and no models, so the command `check` gives these warnings too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from math import inf, pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.model import Design
from ..joints.joint import End, EndDimensions, Joint
from ..joints.kinds import JOINTS
from . import geometry
from .geometry import Geometry, Numbers, end_at, joints_of
from .kernel import PreparedDesign
from .values import Values

Ratio = Callable[[Values, Design, Geometry], Array | None]


@dataclass(frozen=True, slots=True)
class Proportion:
    """A ratio with a usual range in sensible designs.

    `path` is the PATH of the value to check. `meaning` are the words that follow the number in the
    warning, and `source` is the reason for the range. `ratio` returns one or several numbers, or
    None if the ratio does not apply.
    """

    path: str
    meaning: str
    least: float
    most: float
    source: str
    ratio: Ratio

    def beyond(self, number: float) -> str | None:
        """Warning about a number outside the usual range; None if it is within."""
        if self.least <= number <= self.most:
            return None
        low, high = _plain(self.least), _plain(self.most)
        usual = f"{low} to {high}"
        if self.most == inf:
            usual = f"at least {low}"
        elif self.least in (0.0, -inf):
            usual = f"at most {high}"
        return (
            f"{self.path} is out of proportion: it is {_plain(number)} {self.meaning}; {usual} is "
            f"usual ({self.source}); check its unit and decimal point"
        )


def _plain(number: float) -> str:
    """Format a number with three digits, without an exponent up to a million.

    >>> _plain(2187.3), _plain(0.016), _plain(1.2345e9)
    ('2190', '0.016', '1.23e+09')
    """
    return f"{float(f'{number:.3g}'):g}"


def _dead(chamber: str) -> Ratio:
    def ratio(v: Values, design: Design, g: Geometry) -> Array:
        area = g.area_a if chamber == "a" else g.area_b
        return v[f"cylinder.dead_volume_{chamber}"] / (area * g.stroke)

    return ratio


def _stated(path: str, over: Callable[[Geometry], Array]) -> Ratio:
    """Return a function for the ratio of an optional value, at a PATH, to a dimension.

    The ratio is None if the design does not state the value.
    """

    def ratio(v: Values, design: Design, g: Geometry) -> Array | None:
        value = v.get(path, None)
        return None if value is None else value / over(g)

    return ratio


def _pin(v: Values, design: Design, g: Geometry) -> Array | None:
    return None if design.clevis is None else g.pin_diameter / g.bore


def _wall(v: Values, design: Design, g: Geometry) -> Array:
    return (g.outer_radius - g.inner_radius) / g.inner_radius


def _hoop(v: Values, design: Design, g: Geometry) -> Array:
    return v["supply.pressure"] * 1e-6 / _wall(v, design, g)


def _gland(place: str) -> Ratio:
    def ratio(v: Values, design: Design, g: Geometry) -> Array | None:
        grooves = g.piston_grooves if place == "piston" else g.rod_grooves
        size = g.bore if place == "piston" else g.rod_diameter
        depths = [groove.gland_depth / size for groove in grooves if groove.role == "element"]
        return np.array(depths, dtype=float) if depths else None

    return ratio


def _skirt(path: str, of: Callable[[EndDimensions], Array]) -> Ratio:
    """Ratio of a skirt's dimension to the bore; `path` is the PATH of the joint's block."""

    def ratio(v: Values, design: Design, g: Geometry) -> Array | None:
        for end in joints_of(design):
            if end.path == path and end.joint.form == "skirts":
                return of(g.head_fit if end.name == "head" else g.cap_fit) / g.bore
        return None

    return ratio


def _joint_ratio(path: str, joint: Joint, number: Callable[[End], Array]) -> Ratio:
    def ratio(v: Values, design: Design, g: Geometry) -> Array | None:
        for end in joints_of(design):
            if end.path == path and end.joint.name == joint.name:
                return number(end_at(design, end, Numbers(v, path), g))
        return None

    return ratio


def _acceleration(v: Values, design: Design, g: Geometry) -> Array | None:
    mass = v.get("load.mass", None)
    return None if mass is None or mass == 0 else v["supply.pressure"] * g.area_a / mass


def _strokes(v: Values, design: Design, g: Geometry) -> Array | None:
    speeds = np.array([case.speed for case in design.load_cases if case.speed], dtype=float)
    return speeds / g.stroke if speeds.size else None


def _temperatures(v: Values, design: Design, g: Geometry) -> Array:
    cases = [c.temperature for c in design.load_cases if c.temperature is not None]
    return np.array([v["fluid.temperature"], *cases], dtype=float) - 273.15


def _climate(v: Values, design: Design, g: Geometry) -> Array | None:
    if design.environment is None:
        return None
    return v["environment.temperature_max"] - v["environment.temperature_min"]


def _lines(v: Values, design: Design, g: Geometry) -> Array | None:
    volumes = [
        pi / 4 * line.inner_diameter**2 * line.length / (g.area_a * g.stroke)
        for line in design.lines
    ]
    return np.array(volumes, dtype=float) if volumes else None


_BORE = "times the bore"
_WIDE = "our choice"


def _of_joint(path: str) -> Iterator[Proportion]:
    """Proportions of the joint whose block is at a PATH: of skirts, and of each type of joint."""
    yield Proportion(f"{path}.wall", _BORE, 0.01, 0.7, _WIDE, _skirt(path, lambda fit: fit.wall))
    yield Proportion(f"{path}.length", _BORE, 0.1, 4.0, _WIDE, _skirt(path, lambda fit: fit.length))
    for joint in JOINTS.values():
        for usual in joint.usual:
            yield Proportion(
                usual.path.replace("retention", path, 1),
                usual.meaning, usual.least, usual.most, usual.source,
                _joint_ratio(path, joint, usual.number),
            )  # fmt: skip


TABLE: tuple[Proportion, ...] = (
    Proportion(
        "cylinder.dead_volume_a", "times the swept volume of the piston", 0.0, 1.0,
        "our choice: most of the oil should be swept", _dead("a"),
    ),
    Proportion(
        "cylinder.dead_volume_b", "times the swept volume of the piston", 0.0, 1.0,
        "our choice: most of the oil should be swept", _dead("b"),
    ),
    Proportion(
        "lines", "times the swept volume of the piston (volume of one line)", 0.0, 20.0, _WIDE,
        _lines,
    ),
    Proportion(
        "rod.outer_diameter", _BORE, 0.15, 0.98, "our choice; ISO 6020-2 has 0.44 to 0.72",
        lambda v, design, g: g.rod_diameter / g.bore,
    ),
    Proportion(
        "second_rod.outer_diameter", _BORE, 0.15, 0.98, "our choice, as for the rod",
        _stated("second_rod.outer_diameter", lambda g: g.bore),
    ),
    Proportion(
        "clevis.pin_diameter", _BORE, 0.1, 1.5, "our choice; 0.4 to 0.6 is common", _pin,
    ),
    Proportion(
        "rod.thread.diameter", _BORE, 0.1, 1.0, "our choice; 0.4 to 0.7 is common",
        _stated("rod.thread.diameter", lambda g: g.bore),
    ),
    Proportion(
        "cylinder.port_diameter", _BORE, 0.02, 0.9, _WIDE,
        _stated("cylinder.port_diameter", lambda g: g.bore),
    ),
    Proportion(
        "cylinder.stroke", _BORE, 0.1, 60.0, _WIDE, lambda v, design, g: g.stroke / g.bore,
    ),
    Proportion(
        "barrel.layup", "times the inner radius (wall thickness)", 0.005, 2.0, _WIDE, _wall,
    ),
    Proportion(
        "supply.pressure", "MPa as mean hoop stress (pressure x radius / wall thickness)", 0.2,
        2500.0, "our choice: the fibres of the library do not withstand more", _hoop,
    ),
    Proportion(
        "supply.return_pressure", "times the supply pressure", 0.0, 0.5, _WIDE,
        lambda v, design, g: v["supply.return_pressure"] / v["supply.pressure"],
    ),
    Proportion(
        "supply.proof_ratio", "times the supply pressure", 1.0, 4.0, "our choice; ISO 10100 has "
                                                                     "1.5",
        lambda v, design, g: v["supply.proof_ratio"],
    ),
    Proportion(
        "piston.clearance", _BORE, 5e-5, 0.01, "our choice; the radial clearance of a fit "
                                               "H8/f7 of 25 mm is 0.0004 to 0.0015 times the bore",
        lambda v, design, g: g.piston_clearance / g.bore,
    ),
    Proportion(
        "head.clearance", "times the rod diameter", 5e-5, 0.02, "our choice, as for the piston",
        lambda v, design, g: g.head_clearance / g.rod_diameter,
    ),
    Proportion(
        "piston.length", _BORE, 0.1, 5.0, _WIDE, lambda v, design, g: g.piston_length / g.bore,
    ),
    Proportion(
        "head.length", _BORE, 0.1, 5.0, _WIDE, lambda v, design, g: g.head_length / g.bore,
    ),
    Proportion(
        "caps.thickness", _BORE, 0.03, 2.0, _WIDE, lambda v, design, g: g.plate / g.bore,
    ),
    Proportion(
        "rod.extension", "times the sum of bore and stroke", 0.0, 3.0, _WIDE,
        lambda v, design, g: g.rod_extension / (g.bore + g.stroke),
    ),
    Proportion(
        "barrel.length", "times the sum of stroke, piston and head", 0.0, 3.0, _WIDE,
        lambda v, design, g: g.barrel_length / (g.stroke + g.piston_length + g.head_length),
    ),
    Proportion(
        "cylinder.stop_travel", "times the stroke", 0.0, 0.2, _WIDE,
        lambda v, design, g: v["cylinder.stop_travel"] / g.stroke,
    ),
    Proportion(
        "seals.piston", "times the bore (groove depth)", 0.004, 0.25,
        "our choice, from ISO 3601-2 grooves", _gland("piston"),
    ),
    Proportion(
        "seals.rod", "times the rod diameter (groove depth)", 0.004, 0.4,
        "our choice, from ISO 3601-2 grooves", _gland("rod"),
    ),
    *_of_joint("retention"),
    Proportion(
        "load.mass", "m/s^2 as acceleration of the load at supply pressure", 0.05, inf, _WIDE,
        _acceleration,
    ),
    Proportion("load_cases", "strokes per second", 1e-5, 200.0, _WIDE, _strokes),
    Proportion(
        "fluid.temperature", "degC of oil", -60.0, 200.0, "our choice, for hydraulic oils",
        _temperatures,
    ),
    Proportion(
        "environment", "K between lowest and highest temperature", 0.0, 250.0, _WIDE, _climate,
    ),
)  # fmt: skip
"""All checked proportions."""


@np.errstate(all="ignore")  # values that are not finite are reported elsewhere
def warnings(subject: PreparedDesign, v: Values, g: Geometry | None = None) -> Iterator[str]:
    """A sentence for each implausible value."""
    g = geometry.derive(v, subject.design) if g is None else g
    ends = [end.path for end in joints_of(subject.design) if end.name]
    for proportion in chain(TABLE, *map(_of_joint, ends)):
        ratio = proportion.ratio(v, subject.design, g)
        numbers: Iterable[float] = [] if ratio is None else np.ravel(np.real(ratio)).tolist()
        texts = [proportion.beyond(number) for number in numbers if np.isfinite(number)]
        yield from dict.fromkeys(text for text in texts if text is not None)
