"""Words that a design file allows for some keys: a type for each key, with each word's meaning.

Other words (seal types, friction laws, laws of contact and hardness) come from registries.
"""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from ..friction.kinds import LAWS as FRICTION_LAWS
from ..joints.kinds import JOINTS
from ..models.elastomer import MODULUS_LAWS
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from ..models.seals import LAWS as CONTACT_LAWS
from ..models.strength import CRITERIA
from ..seals.kinds import TYPES as SEAL_TYPES
from .kinds import Choice, TableRow, choice_of

Paper: TypeAlias = Annotated[
    Literal["ElAsswad2018", "AaltoThesis", "Huang2017"] | None,
    Choice(
        "paper that describes this cylinder: reports compare its published numbers with ours; "
        "ElAsswad2018: composite knee cylinder of a humanoid robot; "
        "AaltoThesis: 40/25-220 test cylinder of a paper machine's actuator; "
        "Huang2017: 110/80-560 servo cylinder and 125 mm plunger, damping of their seals"
    ),
]
BulkModulusLaw: TypeAlias = Annotated[
    str | None,
    choice_of(
        "how the bulk modulus of the oil rises with pressure "
        "(default: linear if the oil states its slope, else constant)",
        BULK_MODULUS_LAWS,
    ),
]
ViscosityLaw: TypeAlias = Annotated[
    str | None,
    choice_of(
        "how the viscosity of the oil rises with pressure (default: roelands if the oil states its "
        "coefficient, else none)",
        VISCOSITY_LAWS,
    ),
]
Mount: TypeAlias = Annotated[
    Literal["cap_clevis", "head_flange", "head_trunnion", "cap_flange"],
    Choice(
        "how the cylinder is mounted; cap_clevis: an eye at the cap end, free to swing; "
        "head_flange: bolted at the head; head_trunnion: pivots at the head, free to swing; "
        "cap_flange: bolted at the cap end"
    ),
]
EndStop: TypeAlias = Annotated[
    Literal["internal", "external"],
    Choice(
        "what limits the travel; internal: the piston hits cap or head and loads the barrel; "
        "external: a stop outside the actuator, reached before the piston touches cap or head"
    ),
]
WallModel: TypeAlias = Annotated[
    Literal["auto", "isotropic", "thin_laminate", "layered", "as_published"],
    Choice(
        "how the wall is computed; auto: isotropic for one metal layer, else layered; isotropic: "
        "thick tube of one material; thin_laminate: plies as a thin wall, fast, for ratios of "
        "wall thickness to radius up to 0.05; layered: plies as a thick tube, exact; "
        "as_published: isotropic, but with the bore growth formula printed in [ElAsswad2018]"
    ),
]
Criterion: TypeAlias = Annotated[
    str, choice_of("failure criterion for the plies of barrel and rod", CRITERIA)
]
PortThread: TypeAlias = Annotated[
    str | None,
    TableRow(
        "thread of both ports, in the rims of the end plates, or in bosses on a barrel that "
        "encloses them",
        "ports",
    ),
]
Bearing: TypeAlias = Annotated[
    str | None,
    TableRow(
        "spherical plain bearing of both eyes, series E of ISO 12240-1, steel on steel",
        "spherical_bearings",
    ),
]
JOINT_TYPE = choice_of("how cap and head are joined to the barrel", JOINTS)
RetentionType: TypeAlias = Annotated[str, JOINT_TYPE]
SealType: TypeAlias = Annotated[
    str,
    choice_of("kind of seal", SEAL_TYPES),
]
BackUp: TypeAlias = Annotated[
    Literal["none", "one", "both"],
    Choice(
        "back-up rings that close the extrusion gap; none: no ring; "
        "one: a ring on the low-pressure side; both: a ring on each side"
    ),
]
FrictionModel: TypeAlias = Annotated[
    str,
    choice_of("friction model of the seal", FRICTION_LAWS),
]
SealLaw: TypeAlias = Annotated[
    str,
    choice_of("law for contact width and force of the squeezed ring", CONTACT_LAWS),
]
HardnessModel: TypeAlias = Annotated[
    str,
    choice_of("formula for Young's modulus of the rubber from its Shore A hardness", MODULUS_LAWS),
]
Direction: TypeAlias = Annotated[
    Literal["push", "pull"],
    Choice(
        "direction of the actuator's force; push: the rod extends, chamber A (cap side) is "
        "driven; pull: the rod retracts, chamber B (rod side) is driven"
    ),
]
Topology: TypeAlias = Annotated[
    Literal["per_chamber", "aalto_as_published", "elasswad_as_published"],
    Choice(
        "how the stiffness of oil, walls and lines combines; per_chamber: the parts of each "
        "chamber in series, both chambers in parallel; aalto_as_published: the totals of oil, "
        "walls and lines in series, the formula printed in [AaltoThesis]; elasswad_as_published: "
        "oil and wall in series, the formula printed in [ElAsswad2018]"
    ),
]
SealState: TypeAlias = Annotated[
    Literal["sliding", "sticking"],
    Choice(
        "stiffness contribution of the seals; sliding: none; "
        "sticking: a spring parallel to the oil, until breakaway"
    ),
]
COMPONENTS = {
    "ports": "ports and fittings",
    "static_seals": "static seals of the ends",
    "piston_fastening": "fastening of the piston to the rod",
    "bearings": "spherical bearings of the eyes",
    "sensor": "position sensor",
    "manifold": "valve and manifold",
    "hoses": "hoses and pipes",
}
"""Components of an actuator that no model weighs: kind, and words for it."""
_KINDS = COMPONENTS | {"other": "any other component"}
Component: TypeAlias = Annotated[
    str,
    Choice("; ".join(["kind of the component", *map(": ".join, _KINDS.items())]), tuple(_KINDS)),
]
Carrier: TypeAlias = Annotated[
    Literal["barrel", "cap", "head", "piston", "rod"],
    Choice(
        "part that carries the component; barrel: does not move; cap: does not move, at the cap "
        "end; head: does not move, at the rod end; piston: moves; rod: moves, outside the piston"
    ),
]
Sensing: TypeAlias = Annotated[
    Literal["magnetostrictive", "lvdt"],
    Choice(
        "principle of the position sensor; magnetostrictive: a rod with a wave guide, read through "
        "a magnet on the piston; lvdt: a rod with coils or core of a differential transformer"
    ),
]
Turn: TypeAlias = Annotated[
    Literal["cut_off", "pins"],
    Choice(
        "how a helical winding turns at the ends; cut_off: on the mandrel beyond the barrel, where "
        "it is cut off as scrap; pins: around a ring of pins at the end, without extra length"
    ),
]
CushionEnd: TypeAlias = Annotated[
    Literal["both", "cap", "rod"],
    Choice(
        "where there is a cushion; both: at both ends; cap: at full retraction; "
        "rod: at full extension"
    ),
]
Chamber: TypeAlias = Annotated[
    Literal["a", "b"], Choice("chamber that the line feeds; a: cap side; b: rod side")
]
LineType: TypeAlias = Annotated[
    Literal["pipe", "hose"],
    Choice(
        "kind of line, under which the stiffness budget lists the compliance of its wall (which "
        "follows from the material); pipe: a rigid tube; hose: a flexible hose"
    ),
]
End: TypeAlias = Annotated[
    Literal["closed", "valve", "constant_pressure", "reducing_valve"],
    Choice(
        "end of both lines while the load excites the actuator; closed: blocked; valve: the valve "
        "of this file, with the spool position at which it holds the load; constant_pressure: a "
        "port at constant pressure; reducing_valve: the pressure reducing valve of "
        "ports.reducing_valve"
    ),
]
SpoolLaw: TypeAlias = Annotated[
    Literal["course", "lapped"],
    Choice(
        "how the metering edges of the valve open and leak; course: an edge opens with the signal "
        "from its stated leakage, which stays constant when it closes; lapped: edges with overlap, "
        "clearance and width, whose leakage falls with the overlap"
    ),
]
