"""The words a design file may choose from: one type each, with what every word means.

Words of kinds (seal types, friction laws, laws of contact and hardness) come from their registry.
"""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from ..friction.kinds import LAWS as FRICTION_LAWS
from ..joints.kinds import JOINTS
from ..models.criteria import CRITERIA
from ..models.elastomer import MODULUS_LAWS
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from ..models.seals import LAWS as CONTACT_LAWS
from ..seals.kinds import TYPES as SEAL_TYPES
from .kinds import Choice, choice_of

Paper: TypeAlias = Annotated[
    Literal["ElAsswad2018", "AaltoThesis", "Huang2017"] | None,
    Choice(
        "the paper whose cylinder this is: reports set its published numbers beside ours; "
        "ElAsswad2018: composite knee cylinder of a humanoid robot; "
        "AaltoThesis: 40/25-220 test cylinder of a paper machine's actuator; "
        "Huang2017: 110/80-560 servo cylinder and 125 mm plunger, damping of their seals"
    ),
]
BulkModulusLaw: TypeAlias = Annotated[
    str | None,
    choice_of(
        "how the oil stiffens with pressure (default: linear where the oil states its slope, "
        "else constant)",
        BULK_MODULUS_LAWS,
    ),
]
ViscosityLaw: TypeAlias = Annotated[
    str | None,
    choice_of(
        "how the oil thickens with pressure (default: roelands where the oil states its "
        "coefficient, else none)",
        VISCOSITY_LAWS,
    ),
]
Mount: TypeAlias = Annotated[
    Literal["cap_clevis", "head_flange", "head_trunnion", "cap_flange"],
    Choice(
        "what holds the cylinder; cap_clevis: an eye at the cap end, free to swing; "
        "head_flange: bolted at the head; head_trunnion: pivots at the head, free to swing; "
        "cap_flange: bolted at the cap end"
    ),
]
EndStop: TypeAlias = Annotated[
    Literal["internal", "external"],
    Choice(
        "what ends the travel; internal: the piston runs onto cap or head and pulls at the barrel; "
        "external: a stop outside the actuator, before the piston touches"
    ),
]
WallModel: TypeAlias = Annotated[
    Literal["auto", "isotropic", "thin_laminate", "layered", "as_published"],
    Choice(
        "how the wall is computed; auto: isotropic for one metal layer, else layered; "
        "isotropic: thick tube of one material; "
        "thin_laminate: plies as a thin wall, fast, for t/r up to 0.05; "
        "layered: plies as a thick tube, exact; "
        "as_published: isotropic, but the bore grows as [ElAsswad2018] prints it"
    ),
]
Criterion: TypeAlias = Annotated[str, choice_of("when a ply of barrel or rod fails", CRITERIA)]
RetentionType: TypeAlias = Annotated[
    str, choice_of("what holds cap and head to the barrel", JOINTS)
]
SealType: TypeAlias = Annotated[
    str,
    choice_of("kind of seal", SEAL_TYPES),
]
BackUp: TypeAlias = Annotated[
    Literal["none", "one", "both"],
    Choice(
        "back-up rings that close the gap behind the seal; none: no ring; "
        "one: a ring on the side without pressure; both: a ring on either side"
    ),
]
FrictionModel: TypeAlias = Annotated[
    str,
    choice_of("how the friction of the seal follows", FRICTION_LAWS),
]
SealLaw: TypeAlias = Annotated[
    str,
    choice_of("contact width and force of the squeezed ring", CONTACT_LAWS),
]
HardnessModel: TypeAlias = Annotated[
    str,
    choice_of("Young's modulus of the rubber from its Shore A hardness", MODULUS_LAWS),
]
Direction: TypeAlias = Annotated[
    Literal["push", "pull"],
    Choice(
        "which way the actuator drives its load; push: the rod moves out, chamber A (cap side) is "
        "driven; pull: the rod moves in, chamber B (rod side) is driven"
    ),
]
Topology: TypeAlias = Annotated[
    Literal["per_chamber", "aalto_as_published", "elasswad_as_published"],
    Choice(
        "how oil, walls and lines combine; "
        "per_chamber: the parts of each chamber in series, both chambers side by side; "
        "aalto_as_published: totals of oil, walls and lines in series, as [AaltoThesis] prints it; "
        "elasswad_as_published: oil and wall in series, as [ElAsswad2018] prints it"
    ),
]
SealState: TypeAlias = Annotated[
    Literal["sliding", "sticking"],
    Choice(
        "whether the seals add stiffness; sliding: no; "
        "sticking: a spring beside the oil, until they break away"
    ),
]
Chamber: TypeAlias = Annotated[
    Literal["a", "b"], Choice("the chamber it belongs to; a: cap side; b: rod side")
]
LineType: TypeAlias = Annotated[
    Literal["pipe", "hose"],
    Choice(
        "where the stiffness budget counts its wall (the material says how far it gives); "
        "pipe: a stiff tube; hose: a flexible one"
    ),
]
End: TypeAlias = Annotated[
    Literal["closed", "valve", "constant_pressure", "reducing_valve"],
    Choice(
        "what ends both lines while the load shakes the actuator; closed: blocked; "
        "valve: the valve of this file, its spool where it holds the load; "
        "constant_pressure: a port that holds its pressure; "
        "reducing_valve: a pressure reducing valve, as ports.reducing_valve states it"
    ),
]
