"""The nut that clamps the piston on the rod: strength, fatigue, mass and clearances.

The nut is in a recess of the piston, on a stud of the rod with the same thread. The pull of the
rod-side pressure loads the stud; the push of the cap-side pressure and the preload press the rod's
shoulder on the piston.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Any

from ..base.dataclass import dataclass
from ..base.numeric import Array, maximum, minimum
from ..design.model import Design
from ..joints.joint import Life
from ..models import endurance, piston_nut
from ..models.forces import piston_area
from ..models.rod import thread_stress
from ..models.thread import minor_diameter
from .geometry import Geometry
from .limits import MaterialValues
from .plies import warmings
from .values import Values

NO_NUT = "no nut of the piston stated: add piston.nut"
PLACE = "piston nut"


@dataclass(frozen=True, slots=True)
class _Nut:
    """Sizes and preload of the nut, and the largest and least share of a force its stud feels.

    `least` is the preload of a loose tightening after settling, `greatest` that of a tight one
    before it. `changes` are their changes, cold and hot [N]; empty without a temperature range or
    with unknown expansions.
    """

    size: dict[str, Array]
    least: Array
    greatest: Array
    share: Array
    least_share: Array
    changes: Mapping[str, Array]
    shoulder: Array

    @property
    def largest(self) -> Array:
        """Largest preload at any stated temperature [N]."""
        largest = self.greatest
        for change in self.changes.values():
            largest = maximum(largest, self.greatest + change)
        return largest


def _nut(v: Values, design: Design, stock: MaterialValues, g: Geometry) -> _Nut | None:
    """The nut of a design; None if it states none or a modulus is unknown."""
    if design.piston.nut is None:
        return None
    names = design.rod.material, design.piston.material
    moduli = [stock.get(name, "youngs_modulus") for name in names]
    if any(modulus is None for modulus in moduli):
        return None
    seat = {"diameter": g.nut, "shoulder_diameter": g.rod_diameter}
    elastic = {"stud_modulus": moduli[0], "piston_modulus": moduli[1]}
    length = g.piston_length - recess(g)[0]
    clamped = {
        "diameter": g.nut,
        "piston_diameter": g.bore - 2 * g.piston_clearance,
        "length": length,
        **elastic,
    }
    stud, piston = (stock.get(name, "thermal_expansion") for name in names)
    changes = {}
    if stud is not None and piston is not None:
        changes = {
            word: piston_nut.preload_change(**clamped, strain_difference=(piston - stud) * warming)
            for word, warming in warmings(v, design).items()
        }
    least, greatest = piston_nut.preload_range(
        preload=v["piston.nut.preload"], tightening_factor=v["piston.nut.tightening_factor"]
    )
    compliance = piston_nut.clamp_compliance(**seat, length=length, **elastic)
    settled = piston_nut.settling_loss(threads=1, seats=2, joints=0, compliance=compliance)
    return _Nut(
        size={"diameter": g.nut, "pitch": v["piston.nut.pitch"]},
        least=least - settled,
        greatest=greatest,
        share=piston_nut.stud_share(**seat, **elastic),
        least_share=piston_nut.least_stud_share(**clamped),
        changes=changes,
        shoulder=piston_nut.shoulder_area(**seat),
    )


def thread_factor(
    v: Values, design: Design, stock: MaterialValues, g: Geometry, pull: Array
) -> dict[str, Array]:
    """Pull at which the stud yields, over the pull: with the largest preload, and without any."""
    nut = _nut(v, design, stock, g)
    strength = stock.allowable(design.rod.material, "yield_strength")
    if nut is None or strength is None:
        return {}
    borne = strength / thread_stress(force=1.0, **nut.size)
    twist = piston_nut.torsion_factor(**nut.size, share=piston_nut.LEFT)
    return {PLACE: minimum((borne / twist - nut.largest) / nut.share, borne) / pull}


def closed(
    v: Values, design: Design, stock: MaterialValues, g: Geometry, pull: Array
) -> dict[str, Array] | None:
    """Least preload divided by the clamping force that the pull takes away at proof pressure.

    It is given at assembly and, with a temperature range, cold and hot. "while tightened" is the
    preload that tightening may cause, by the stud's yield strength, divided by the greatest.
    """
    nut = _nut(v, design, stock, g)
    if nut is None:
        return None
    taken = (1 - nut.least_share) * v["supply.proof_ratio"] * pull
    at = {"at assembly": 0.0, **nut.changes}
    factors = {place: (nut.least + change) / taken for place, change in at.items()}
    strength = stock.allowable(design.rod.material, "yield_strength")
    if strength is not None:
        stress = piston_nut.torsion_factor(**nut.size) * thread_stress(
            force=nut.greatest, **nut.size
        )
        factors["while tightened"] = piston_nut.USED * strength / stress
    return factors


def yields(
    v: Values, design: Design, stock: MaterialValues, g: Geometry, push: Array, pull: Array
) -> dict[str, Array]:
    """Yield of the piston under the shoulder, and of its web.

    The greatest preload presses on the shoulder too. It is known, so the factor is that of the
    push: push at yield divided by the push. At the web, it is yield strength divided by stress. The
    push of the ring around the shoulder bends the web at the shoulder, and the pull at the nut.
    """
    nut = _nut(v, design, stock, g)
    strengths = [
        stock.allowable(name, "yield_strength")
        for name in (design.rod.material, design.piston.material)
    ]
    known = [strength for strength in strengths if strength is not None]
    if nut is None or not known:
        return {}
    weakest = minimum(known[0], known[-1])
    rows = {"piston under the rod's shoulder": (weakest * nut.shoulder - nut.largest) / push}
    piston = strengths[1]
    if piston is not None:
        height, corner = recess(g)
        shoulder, flats = g.rod_diameter / 2, piston_nut.FLATS * g.nut / 2
        around = 1 - g.rod_diameter * g.rod_diameter / (g.bore * g.bore)
        if design.double_rod:  # the pressure acts beside the second rod
            around = around * piston_area(bore=g.bore) / g.area_a
        stress = maximum(
            *(
                piston_nut.web_stress(
                    force=force,
                    radius=radius,
                    reach_length=maximum(corner - radius, 0.0),
                    thickness=g.piston_length - height,
                )
                for force, radius in ((push * around, shoulder), (pull, flats))
            )
        )
        rows["piston web under the nut"] = piston / stress
    return rows


def lives(
    v: Values, design: Design, stock: MaterialValues, g: Geometry, push: Array, pull: Array
) -> dict[str, Life]:
    """Fatigue of the stud's thread under alternating pull and push; the push relieves the stud."""
    nut = _nut(v, design, stock, g)
    if nut is None:
        return {}
    amplitude = thread_stress(force=nut.share * (pull + push) / 2, **nut.size)
    endured = endurance.bolt_endurance_amplitude(diameter=nut.size["diameter"])
    cycles = endurance.bolt_cycles(amplitude=amplitude, diameter=nut.size["diameter"])
    return {PLACE: Life(cycles, endured / amplitude)}


def masses(v: Values, design: Design, g: Geometry) -> dict[str, Array]:
    """Mass of nut and stud, and of the metal cut from the piston, with a negative sign."""
    if design.piston.nut is None:
        return {}
    steel = v[f"materials.{design.rod.material}.density"]
    piston = v[f"materials.{design.piston.material}.density"]
    height, corner = recess(g)
    shank = pi / 4 * g.nut * g.nut
    stud = shank * g.piston_length
    hole = shank * (g.piston_length - height) + pi * corner * corner * height
    return {
        "fastening": steel * piston_nut.nut_volume(diameter=g.nut),
        "rod": steel * stud,
        "piston": -piston * hole,
    }


def recess(g: Geometry) -> tuple[Array, Array]:
    """Depth and radius of the recess in the piston."""
    return piston_nut.HEIGHT * g.nut, piston_nut.corner_radius(diameter=g.nut)


def lands(v: Values, design: Design, g: Geometry) -> dict[str, Any]:
    """Metal of the piston under the nut, and clearance over a second rod, kept by the optimiser."""
    if design.piston.nut is None:
        return {}
    web = g.piston_length - recess(g)[0]
    if not design.double_rod:
        return {"geometry_piston_web": web}
    hole = minor_diameter(diameter=g.nut, pitch=v["piston.nut.pitch"])
    over = (hole - g.rods[1].diameter) / 2
    return {"geometry_piston_web": {"web": web, "nut over the second rod": over}}
