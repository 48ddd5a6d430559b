"""The stiffness budget: all compliances between load and ground, along the stroke."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import pi
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, array_of, real
from ..design.model import Design
from ..models import dynamics, lugre, stiffness, stiffness_published as published
from .barrel import Wall
from .circuit import Chamber, ChamberLines
from .geometry import Geometry, Numbers, end_at, joints_of
from .limits import MaterialValues, MetricArrays
from .rods import RodSection
from .state import LoadState
from .values import Values


class Give(NamedTuple):
    """Compliance from one cause (such as oil or barrel wall) as a function of piston position x.

    The compliance of chamber A is a0 + a1 x, that of chamber B is b0 + b1 (s - x), with stroke s.
    The coupling c0 + c1 x is the volume change of one chamber per unit pressure in the other.
    """

    a0: Array = 0.0
    a1: Array = 0.0
    b0: Array = 0.0
    b1: Array = 0.0
    c0: Array = 0.0
    c1: Array = 0.0

    def at(self, position: Array, stroke: Array) -> Compliances:
        """Compliances of both chambers at a piston position."""
        return Compliances(
            self.a0 + self.a1 * position,
            self.b0 + self.b1 * (stroke - position),
            self.c0 + self.c1 * position,
        )


class Compliances(NamedTuple):
    """Compliances of chamber A, of chamber B, and their coupling [m^3/Pa]."""

    a: Array
    b: Array
    ab: Array


OIL = ("oil A", "oil B", "oil in lines")
"""Names of the compliances that oil causes, not walls."""


@dataclass(frozen=True, slots=True)
class Springs:
    """All compliances between load and ground."""

    chambers: dict[str, Give]
    """Compliances of the chambers by cause: oil in A, in B and in the lines, barrel wall, axial
    stretch of the barrel, walls of pipes and hoses."""
    seals: Array | None
    """Stiffness of sticking seals, in parallel with the oil; None if the seals slide."""
    chain: dict[str, Array]
    """Stiffnesses in series with the chambers, such as rod, mount and load cell."""
    geometry: Geometry
    topology: str
    pressure: Array
    """Pressure difference across the piston, which only a published formula uses."""
    rod_place: str = ""

    @property
    def oil(self) -> tuple[str, ...]:
        """Names of the compliances that are due to oil."""
        return tuple(cause for cause in OIL if cause in self.chambers)

    def total(self, causes: Iterable[str] | None = None) -> Give:
        """Sum of the compliances of the named causes; default: of all causes."""
        chosen = [self.chambers[cause] for cause in (causes or self.chambers)]
        return Give(*(sum(part[1:], start=part[0]) for part in zip(*chosen, strict=True)))

    def hydraulic(self, position: Array, causes: Iterable[str] | None = None) -> Array:
        """Stiffness of the closed chambers at a position, with the named compliances only."""
        g = self.geometry
        a, b, ab = self.total(causes).at(position, g.stroke)
        return stiffness.hydraulic_stiffness(
            area_a=g.area_a, compliance_a=a, area_b=g.area_b, compliance_b=b, compliance_ab=ab
        )

    def series_compliance(self) -> Array:
        """Compliance of the parts in series with the chambers [m/N]."""
        return sum(1 / part for part in self.chain.values())

    def compliances(self, position: Array) -> dict[str, Array]:
        """Compliance by part at a position (m/N); the sum is 1/stiffness.

        The contribution of each part is twice its strain energy under a unit force, and therefore
        does not depend on the order of the parts. For a part of the chambers it is p^T C_part p,
        with the chamber pressures p and the part's compliance matrix C_part. For the seals it is
        k x^2, with stiffness k and displacement x.
        """
        if self.topology != "per_chamber":
            parts = self._published(position)
        else:
            parts = self._by_energy(position)
        return parts | {name: 1 / part for name, part in self.chain.items()}

    def _by_energy(self, position: Array) -> dict[str, Array]:
        g = self.geometry
        a, b, ab = self.total().at(position, g.stroke)
        det = a * b - ab * ab  # 0 if a chamber is empty (rigid); never divided by
        swing_a, swing_b = g.area_a * b + g.area_b * ab, -(g.area_a * ab + g.area_b * a)
        seals = 0.0 if self.seals is None else self.seals
        whole = g.area_a * swing_a - g.area_b * swing_b + seals * det
        displacement = det / whole  # displacement, pressures of A and B under a unit force
        force_a, force_b = swing_a / whole, swing_b / whole
        parts = {}
        for cause, give in self.chambers.items():
            compliance = give.at(position, g.stroke)
            parts[cause] = (
                force_a * force_a * compliance.a
                + force_b * force_b * compliance.b
                + 2 * force_a * force_b * compliance.ab
            )
        if self.seals is not None:
            parts["seals"] = displacement * displacement * seals
        return parts

    def _published(self, position: Array) -> dict[str, Array]:
        """Compliances by part, with the totals of oil, barrel and lines in series, as published."""
        g = self.geometry
        square_a, square_b = g.area_a * g.area_a, g.area_b * g.area_b

        def in_series(a: Array, b: Array) -> Array:
            """Compliance of two springs in parallel, one for each chamber."""
            return a * b / (a + b)

        def side_a(cause: str) -> Array:
            return self.chambers[cause].at(position, g.stroke).a / square_a

        def side_b(cause: str) -> Array:
            return self.chambers[cause].at(position, g.stroke).b / square_b

        oil_a = sum(side_a(cause) for cause in self.oil)
        oil_b = sum(side_b(cause) for cause in self.oil)
        oil = in_series(oil_a, oil_b)
        parts = {
            "oil A": oil * oil_b / (oil_a + oil_b),
            "oil B": oil * oil_a / (oil_a + oil_b),
        }
        if self.topology == "elasswad_as_published":
            bulge = published.cylinder_expansion_as_published(
                pressure=self.pressure, area=g.area_a, stroke=g.stroke
            )
            return parts | {"barrel": 1 / bulge}
        # eq. 23 uses the annulus for the wall of chamber B, not the bore
        parts["barrel"] = in_series(side_a("barrel"), side_b("barrel") * g.area_b / g.area_a)
        for cause in ("pipes", "hoses"):
            if cause in self.chambers:
                parts[cause] = in_series(side_a(cause), side_b(cause))
        return parts

    def stiffness(self, position: Array) -> Array:
        """Axial stiffness at a position."""
        return 1 / sum(self.compliances(position).values())

    def per_chamber_stiffness(self, position: Array) -> Array:
        """Axial stiffness at a position, with each chamber as a separate spring.

        This holds even if the design states another formula (`stiffness.topology`).
        """
        return 1 / (sum(self._by_energy(position).values()) + self.series_compliance())


def _joints(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> Iterator[Array]:
    """Yield the axial compliance of each joint of the barrel ends that states one [m/N]."""
    for end_joint in joints_of(design):
        give = end_joint.joint.give
        if give is not None:
            end = end_at(design, end_joint, Numbers(v, end_joint.path), g)
            yield end_joint.count * give(end, stock)


def _stretch(
    design: Design, g: Geometry, wall: Wall, extra: Array, joints: Iterable[Array]
) -> Give:
    """Compliance by axial stretch of barrel and joints, which the pressure of one chamber causes.

    With a cap mount, the axial force is N = p_B A_B along the whole barrel length L. The head moves
    by e_N L N + e_p (x p_A + y p_B), and N reduces the volume of both chambers by e_p N per unit
    length. Here e_N is the axial strain per unit axial force, and e_p that per unit pressure. The
    piston position is x, and y is the wetted length of chamber B: the rest of the stroke and the
    extra length of the barrel (`extra`). With a head mount, N = p_A A_A. Tie rods carry their share
    of N. The compliances of the `joints` add to that of the barrel.
    """
    shortening = wall.swelling.shortening * wall.path.share
    cap = design.cylinder.mount.startswith("cap")
    area = g.area_b if cap else g.area_a
    barrel_stretch = area * area * wall.swelling.stretch * wall.path.share * g.wall_length
    for give in joints:
        barrel_stretch = barrel_stretch + area * area * give
    twice, once = 2 * shortening * area, shortening * area
    if cap:
        return Give(b0=barrel_stretch + twice * extra, b1=twice, c1=once)
    return Give(a0=barrel_stretch, a1=twice, c0=once * (g.stroke + extra), c1=-once)


def springs(
    v: Values,
    design: Design,
    stock: MaterialValues,
    geometry: Geometry,
    state: LoadState,
    wall: Wall,
    rod: RodSection,
    breakaway: Array,
    branches: dict[Chamber, ChamberLines],
) -> Springs:
    """Derive the compliances of chambers, lines, rod, mount, seals and load cell.

    `breakaway` is the force at which the seals break away [N].
    """
    g = geometry
    extra = g.barrel_length - g.piston_length - g.head_length - g.stroke
    volume_a = v["cylinder.dead_volume_a"]
    volume_b = v["cylinder.dead_volume_b"] + g.area_b * extra
    swelling = 2 * pi * g.inner_radius * wall.swelling.growth
    oil_a, oil_b = state.bulk_modulus_a, state.bulk_modulus_b
    chambers = {
        "oil A": Give(a0=volume_a / oil_a, a1=g.area_a / oil_a),
        "oil B": Give(b0=volume_b / oil_b, b1=g.area_b / oil_b),
    }
    if design.lines:
        in_a, in_b = branches["a"].volume / oil_a, branches["b"].volume / oil_b
        chambers["oil in lines"] = Give(a0=in_a, b0=in_b)
    chambers["barrel"] = Give(a1=swelling, b0=swelling * extra, b1=swelling)
    chambers["stretch"] = _stretch(design, g, wall, extra, _joints(v, design, stock, g))
    kinds = {line.type for line in design.lines if not line.rigid}
    if "pipe" in kinds:
        chambers["pipes"] = Give(a0=branches["a"].pipes, b0=branches["b"].pipes)
    if "hose" in kinds:
        chambers["hoses"] = Give(a0=branches["a"].hoses, b0=branches["b"].hoses)
    chain = {"rod": rod.axial_stiffness / g.rod_length}
    for name, path in (
        ("mount", "cylinder.mount_stiffness"),
        ("load cell", "stiffness.load_cell"),
    ):
        if path in v:
            chain[name] = v[path]
    sticking = design.stiffness.seals == "sticking"
    return Springs(
        chambers=chambers,
        seals=lugre.lugre_bristle_stiffness(
            static=breakaway, largest_deflection=v["stiffness.seal_deflection"]
        )
        if sticking
        else None,
        chain=chain,
        geometry=g,
        topology=design.stiffness.topology,
        pressure=state.driven_pressure,
        rod_place=rod.place,
    )


def weakest(s: Springs) -> Array:
    """Position of least stiffness in every load case."""
    if s.topology != "per_chamber":
        return _softest(s.stiffness, s.geometry.stroke)
    return weakest_per_chamber(s)


def weakest_per_chamber(s: Springs) -> Array:
    """Position of least stiffness, with each chamber as a separate spring.

    This holds even if the design states another formula (`stiffness.topology`).
    """
    give = s.total()
    return stiffness.weakest_position(
        area_a=s.geometry.area_a,
        area_b=s.geometry.area_b,
        compliance_a0=give.a0,
        compliance_a_per_length=give.a1,
        compliance_b0=give.b0,
        compliance_b_per_length=give.b1,
        stroke=s.geometry.stroke,
        compliance_ab0=give.c0,
        compliance_ab_per_length=give.c1,
    )


def _softest(curve: Callable[[Array], Array], stroke: Array) -> Array:
    """Find the position of least stiffness by grid refinement.

    Only real parts are used. At a minimum, a small change of position does not affect the
    stiffness. The position therefore has no complex step for derivatives.
    """
    length = array_of(real(stroke))
    middle, reach = 0.5 * length, 0.5 * length
    for _ in range(5):
        grid = middle + np.linspace(-1.0, 1.0, 33).reshape(-1, 1, 1) * reach
        grid = np.clip(grid, 1e-6 * length, (1 - 1e-6) * length)
        values = array_of(real(curve(grid)))
        grid = np.broadcast_to(grid, values.shape)
        best = np.argmin(values, axis=0)[None]
        middle = np.take_along_axis(grid, best, axis=0)[0]
        reach = reach / 8
    return middle


def compute(s: Springs, moving_mass: Array, out: MetricArrays) -> Array:
    """Compute stiffness and frequency metrics; return the position of least stiffness."""
    position = weakest(s)
    parts = s.compliances(position)
    total = 1 / sum(parts.values())
    out.put("stiffness_min", total)
    out.put("stiffness_oil", s.hydraulic(position, s.oil))
    out.put("stiffness_barrel", 1 / parts["barrel"])
    out.put("stiffness_rod", {s.rod_place: s.chain["rod"]})
    if s.seals is not None:
        out.put("stiffness_seals", s.seals)
    else:
        out.skip(
            "stiffness_seals",
            "not available with sliding seals; for it, set "
            '"stiffness.seals: sticking" in the design',
        )
    out.put("natural_frequency", dynamics.natural_frequency(stiffness=total, mass=moving_mass))
    return position


def warnings(s: Springs) -> Iterable[tuple[str, str]]:
    """Yield (metric, sentence) for effects that the stiffness neglects or assumes."""
    if s.topology != "per_chamber":
        for metric in ("stiffness_min", "natural_frequency"):
            yield (
                metric,
                f"stiffness as published ({s.topology.partition('_')[0]}): the totals of oil, "
                "barrel and lines are in series, which is wrong by up to 13 % with hoses; "
                '"topology: per_chamber" is exact',
            )
        for cause in ("pipes", "hoses"):
            give = s.chambers.get(cause)
            if give is not None and not (np.all(give.a0) and np.all(give.b0)):
                yield (
                    "stiffness_min",
                    f"in the published formula, {cause} at only one chamber have no effect, "
                    "because the other chamber counts as infinitely stiff",
                )
    if s.seals is not None:
        yield (
            "",
            "the stiffness includes that of sticking seals, which is lost as soon as the seals "
            "slide",
        )
