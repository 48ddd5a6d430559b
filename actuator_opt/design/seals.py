"""Seals of piston and rod: sealing elements, wipers, guide rings."""

# Annotations are objects here, not texts, which Pydantic would compile one by one at each start.

from typing import Annotated

from pydantic import Field

from ..friction import coefficient
from ..friction.kinds import LAWS
from ..friction.law import FrictionLaw
from ..seals import o_ring
from ..seals.contact import GROOVE_WIDTH
from ..seals.kinds import SIZES, TYPES
from ..seals.seal_type import SealType
from . import choices
from .kinds import MaterialName, Of, Section

BACK_UPS = {"none": 0, "one": 1, "both": 2}
"""Number of back-up rings for each value of the key `back_up`."""


class ContactProfile(Section):
    """Static contact pressure along an element at one sealed pressure, from test or simulation.

    Between the sealed pressures of two profiles, the contact pressure is interpolated. The last
    profile must be at or above supply pressure.
    """

    pressure: Annotated[float, Of("pressure", "sealed pressure of this profile, gauge")]
    positions: Annotated[
        tuple[Annotated[float, Of("length", "distance from the sealed side")], ...],
        Field(min_length=2, max_length=400),
    ]
    stresses: Annotated[
        tuple[Annotated[float, Of("pressure", "contact pressure at that distance, gauge")], ...],
        Field(min_length=2, max_length=400),
    ]


class SealElement(Section):
    """Radial sealing ring in its groove, or `count` of them in a row.

    `section` is the free radial height of the squeezed part: the O-ring, the O-ring behind a step
    ring, the lips of a U-cup, the body of a compact seal.
    """

    type: choices.SealType = o_ring.TYPE.name
    compound: Annotated[str, MaterialName("seal")]
    section: Annotated[float, Of("cross_section", "free cross-section of the ring")]
    squeeze: Annotated[
        float, Of("squeeze", "nominal squeeze, as a share of the free cross-section")
    ]
    tolerance: Annotated[float, Of("tolerance", "tolerance of the gland depth")] = 0.0
    section_tolerance: Annotated[float, Of("tolerance", "tolerance of the free cross-section")] = (
        0.0
    )
    groove_width: Annotated[float | None, Of(GROOVE_WIDTH.quantity, GROOVE_WIDTH.help)] = None
    stretch: Annotated[float, Of("stretch", "stretch of the ring in its groove")] = 0.02
    count: Annotated[float, Of("seal_count", "number of seals in a row")] = 1.0
    __annotations__.update(  # a field for every size of any seal type
        {
            size.key: Annotated[float | None, Of(size.quantity, size.help), Field(default=None)]
            for size in SIZES
            if size != GROOVE_WIDTH
        }
    )
    law: choices.SealLaw = "energised"
    hardness_model: choices.HardnessModel = "gent"
    contact: Annotated[tuple[ContactProfile, ...], Field(max_length=50)] = ()
    back_up: choices.BackUp = "none"
    back_up_material: Annotated[str | None, MaterialName("isotropic", ("polymer",))] = None
    back_up_thickness: Annotated[
        float | None,
        Of("part_length", "axial thickness of a back-up ring, including its axial clearance"),
    ] = None
    friction: choices.FrictionModel = coefficient.LAW.name
    friction_coefficient: Annotated[
        float | None,
        Of(
            "friction_coefficient",
            "dry friction coefficient on the counterface; default: the compound's",
        ),
    ] = None
    breakaway_ratio: Annotated[
        float | None,
        Of("breakaway_ratio", "ratio of breakaway to running friction; default: the compound's"),
    ] = None
    stribeck_speed: Annotated[
        float | None,
        Of(
            "stribeck_speed",
            "sliding speed over which breakaway friction decays to running friction; default: the "
            "compound's",
        ),
    ] = None
    viscous_friction: Annotated[
        float, Of("viscous_friction", "viscous part of the seal friction, per speed")
    ] = 0.0

    @property
    def seal_type(self) -> SealType:
        """Seal type of the element."""
        return TYPES[self.type]

    @property
    def friction_law(self) -> FrictionLaw:
        """Friction law of the element."""
        return LAWS[self.friction]

    @property
    def back_ups(self) -> int:
        """Number of back-up rings in the groove."""
        return BACK_UPS[self.back_up]

    def stated_sizes(self) -> dict[str, float]:
        """Sizes that the seal type requires and the design states, SI."""
        sizes = {size.key: getattr(self, size.key) for size in SIZES}
        return {key: value for key, value in sizes.items() if value is not None}


class Wiper(Section):
    """A lip that keeps dirt out; it seals no pressure."""

    compound: Annotated[str, MaterialName("seal")]
    section: Annotated[float, Of("cross_section", "free radial height over the lip")]
    squeeze: Annotated[float, Of("squeeze", "interference, as a share of the free radial height")]
    thickness: Annotated[float, Of("part_length", "radial thickness of the lip at its root")]
    width: Annotated[float, Of("part_length", "length of the lip")]
    groove_width: Annotated[float, Of("groove_width", "axial width of the groove")]
    hardness_model: choices.HardnessModel = "gent"
    friction_coefficient: Annotated[
        float | None,
        Of(
            "friction_coefficient",
            "dry friction coefficient on the counterface; default: the compound's",
        ),
    ] = None


class Guide(Section):
    """Guide rings that carry the side load."""

    material: Annotated[str, MaterialName("structural", ("polymer", "metal"))]
    thickness: Annotated[float, Of("part_length", "radial thickness of a ring")]
    width: Annotated[float, Of("part_length", "axial width of a ring")]
    count: Annotated[float, Of("seal_count", "rings")] = 1.0
    friction_coefficient: Annotated[
        float,
        Of("friction_coefficient", "friction coefficient of the oiled guide on the counterface"),
    ] = 0.1


class Seal(SealElement):
    """Seals of piston or rod: the element that seals the pressure, with wiper and guide rings."""

    counterface_roughness: Annotated[
        float, Of("rms_roughness", "RMS roughness of the rod or the bore")
    ] = 0.2e-6
    secondary: SealElement | None = None
    """A second element in tandem, on the outer side of the first."""
    wiper: Wiper | None = None
    guide: Guide | None = None

    def elements(self) -> dict[str, SealElement]:
        """Sealing elements from the pressure side outwards.

        Each key is the end of the element's PATH.
        """
        second = {} if self.secondary is None else {"secondary.": self.secondary}
        return {"": self, **second}

    def materials(self) -> list[str]:
        """All materials of these seals."""
        names: list[str | None] = []
        for element in self.elements().values():
            names += [element.compound, element.back_up_material]
        names.append(None if self.wiper is None else self.wiper.compound)
        names.append(None if self.guide is None else self.guide.material)
        return [name for name in names if name is not None]


class StaticSeal(Section):
    """Static O-ring at each end of the barrel, in a groove of cap and head, against the bore.

    A plug in the bore has the groove in its rim. Otherwise, the head has it on its outside, and the
    cap on a spigot, which lengthens the barrel.
    """

    compound: Annotated[str, MaterialName("seal")]
    section: Annotated[float, Of("cross_section", "free cross-section of the ring")]
    squeeze: Annotated[
        float, Of("squeeze", "nominal squeeze, as a share of the free cross-section")
    ] = 0.2
    tolerance: Annotated[float, Of("tolerance", "tolerance of the gland depth")] = 0.0
    section_tolerance: Annotated[float, Of("tolerance", "tolerance of the free cross-section")] = (
        0.0
    )
    stretch: Annotated[float, Of("stretch", "stretch of the ring in its groove")] = 0.02
    clearance: Annotated[
        float, Of("radial_clearance", "radial clearance between cap or head and the bore")
    ] = 2e-5

    @property
    def element(self) -> SealElement:
        """The O-ring as a sealing element, for the models of glands."""
        return SealElement.model_construct(
            compound=self.compound, section=self.section, squeeze=self.squeeze
        )


class Seals(Section):
    """Seals of piston and rod, and static seals of the ends."""

    piston: Seal
    rod: Seal
    static: StaticSeal | None = None
