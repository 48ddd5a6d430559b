"""The Design: contents of a design file in SI, with a class for each block.

Every number names its quantity (`Of`), which is declared once in `quantities.INPUTS` for parsing,
range checks, JSON Schema and reports. A value may be an optimisation variable with bounds, or have
confidence bounds from a test, or scatter. These classes contain no physics.
"""

# Annotations are objects here, not texts, which Pydantic would compile one by one at each start.

from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import Field, create_model

from ..base.quantities import Sense
from ..base.tables import headline
from ..joints.kinds import JOINTS
from ..models.piston_nut import TIGHTENING
from . import choices
from .choices import Paper
from .duty import DutySection
from .ideal import Ideal
from .kinds import (
    Boolean,
    CaseName,
    Choice,
    Fraction,
    MaterialName,
    ObjectiveKind,
    Of,
    Position,
    PositionKind,
    Section,
    SizesKind,
    Text,
)
from .seals import Seals
from .valve import Valve


class Line(Section):
    """A pipe or hose of chamber a (cap side) or b (rod side); listed from the port outwards."""

    chamber: choices.Chamber
    type: choices.LineType = "pipe"
    length: Annotated[float, Of("part_length", "length of the line")]
    inner_diameter: Annotated[float, Of("line_diameter", "inner diameter")]
    outer_diameter: Annotated[float, Of("diameter", "outer diameter")]
    material: Annotated[str, MaterialName("isotropic")]
    loss_coefficient: Annotated[float, Of("loss_coefficient", "sum for bends, fittings")] = 0.0
    rigid: Annotated[
        bool, Boolean("whether the wall counts as rigid, so that only the oil is compliant")
    ] = False
    beyond_throttle: Annotated[
        bool, Boolean("whether the throttle is between the actuator and this line")
    ] = False


class ExtraMass(Section):
    """A component of the actuator whose mass is stated, because no model computes it."""

    kind: choices.Component
    mass: Annotated[float, Of("component_mass", "mass of the component")]
    place: choices.Carrier
    count: Annotated[float, Of("piece_count", "number of such components")] = 1.0
    length: Annotated[
        float,
        Of("length", "length of each along the axis, between cap or rod and its eye"),
    ] = 0.0


class Throttle(Section):
    """One-way flow-control valves that throttle the outflow, linearised for each load case."""

    area: Annotated[float, Of("orifice_area", "flow area of the fully open needle")]
    opening: Annotated[float, Of("opening", "opening of the needle")] = 1.0
    check_area: Annotated[float, Of("orifice_area", "flow area of the open check valve")]
    cracking_pressure: Annotated[
        float, Of("pressure_drop", "opening pressure of the check valve")
    ] = 0.4e5


class ReducingValve(Section):
    """A pressure reducing valve at the end of a line: a second-order model for small signals."""

    conductance: Annotated[
        float,
        Of(
            "conductance",
            "change of flow per change of regulated pressure, by slow (static) motion of the spool",
        ),
    ]
    passive_conductance: Annotated[
        float,
        Of(
            "conductance",
            "change of flow per change of pressure with the spool at rest, at any frequency",
        ),
    ] = 0.0
    natural_frequency: Annotated[float, Of("frequency", "natural frequency of the valve")]
    damping_ratio: Annotated[float, Of("damping_ratio", "damping ratio of the valve")]


class Accumulator(Section):
    """A gas accumulator on the line of one chamber; fluid.polytropic_index applies to its gas."""

    chamber: choices.Chamber
    gas_volume: Annotated[float, Of("gas_volume", "gas volume at the precharge")]
    precharge: Annotated[float, Of("precharge", "gas precharge, gauge")]
    neck_length: Annotated[float, Of("part_length", "length of the neck")]
    neck_diameter: Annotated[float, Of("diameter", "inner diameter of the neck")]


class Ports(Section):
    """Components at the far ends of both lines, for the response of the uncontrolled actuator."""

    end: choices.End = "closed"
    throttle: Throttle | None = None
    reducing_valve: ReducingValve | None = None
    accumulators: Annotated[tuple[Accumulator, ...], Field(max_length=8)] = ()


class PositionLoop(Section):
    """The position loop: signal = gain x position error, measured at the load."""

    gain: Annotated[
        float | None,
        Of("gain", "signal per position error; default: half the ultimate gain"),
    ] = None


class Linkage(Section):
    """A revolute joint driven by the actuator; the joint angle grows as the actuator extends."""

    base_radius: Annotated[float, Of("pivot_radius", "distance from joint axis to fixed pivot")]
    crank_radius: Annotated[float, Of("pivot_radius", "distance from joint axis to crank pin")]
    angle_offset: Annotated[
        float,
        Of("joint_angle", "angle between base radius and crank radius at joint angle 0, signed"),
    ] = 0.0


class Load(Section):
    """The load on the rod."""

    mass: Annotated[float, Of("load_mass", "moving mass, reflected to the rod")] = 0.0
    inertia: Annotated[
        float,
        Of(
            "load_inertia",
            "moment of inertia about the linkage's joint, reflected to the rod and added to mass",
        ),
    ] = 0.0


class Variable(Section):
    """Bounds and start (SI) of a dimension that the optimiser varies.

    It varies continuously, or takes the `sizes` of a series or a list, or multiples of `step`.
    """

    lower: float
    upper: float
    start: float
    sizes: Annotated[str | tuple[float, ...] | None, SizesKind()] = None
    step: float | None = None


class TestBounds(Section):
    """95 % confidence bounds of a value of the design, from a test.

    The bounds are in SI here; in the file, they have units that suit the PATH.
    """

    lower: float
    upper: float
    record: Annotated[str, Text("name of the record in a report", 200)]


Shape: TypeAlias = Literal["normal", "lognormal", "uniform", "loguniform", "triangular", "fixed"]


class Uncertain(Section):
    """Scatter of a value: here in SI, in the file with units that suit the PATH."""

    distribution: Annotated[
        Shape,
        Choice(
            "distribution of the value; normal: mean at the value, with deviation or cv; "
            "lognormal: median at the value, with cv or the factor that covers 95 %; "
            "uniform: between bounds, half_width about the value, or an ISO 286 tolerance; "
            "loguniform: the logarithm is uniform, between bounds or value/factor to value*factor; "
            "triangular: as uniform, with the mode at the value; "
            "fixed: no scatter, even if libraries or common practice state some"
        ),
    ]
    lower: float | None = None
    upper: float | None = None
    deviation: float | None = None
    half_width: float | None = None
    cv: float | None = None
    factor: float | None = None
    tolerance: Annotated[str | None, Text("ISO 286 class of a diameter or length, e.g. H8", 10)] = (
        None
    )
    source: Annotated[str | None, Text("source, named in reports", 200)] = None


class FluidSection(Section):
    """The oil and its condition."""

    material: Annotated[str, MaterialName("fluid")]
    temperature: Annotated[
        float, Of("temperature", "oil temperature, unless a load case states its own")
    ] = 313.15
    air_content: Annotated[
        float, Of("air_content", "entrained air at atmospheric pressure, by volume")
    ] = 0.005
    polytropic_index: Annotated[
        float,
        Of(
            "polytropic_index",
            "polytropic index of entrained air and accumulators: 1.4 for fast changes, 1 for slow",
        ),
    ] = 1.4
    bulk_modulus_law: choices.BulkModulusLaw = None
    viscosity_pressure: choices.ViscosityLaw = None


class Supply(Section):
    """Gauge pressures of supply and return, at the actuator's ports."""

    pressure: Annotated[float, Of("working_pressure", "gauge pressure at the driven port")]
    return_pressure: Annotated[
        float, Of("pressure", "gauge pressure at the port that is not driven")
    ] = 0.0
    proof_ratio: Annotated[
        float, Of("safety_factor", "ratio of proof pressure to supply pressure")
    ] = 1.5


class Environment(Section):
    """Environmental temperatures, for trapped oil, thermal mismatch and service limits."""

    temperature_min: Annotated[float, Of("temperature", "lowest temperature of the actuator")]
    temperature_max: Annotated[float, Of("temperature", "highest temperature of the actuator")]
    assembly_temperature: Annotated[
        float, Of("temperature", "temperature at assembly and oil filling")
    ] = 293.15
    wet: Annotated[bool, Boolean("whether the laminate is saturated with moisture")] = True
    trapped_rise: Annotated[
        float | None,
        Of("temperature_rise", "temperature rise of the oil while both ports are blocked"),
    ] = None
    cure_temperature: Annotated[
        float | None, Of("temperature", "temperature at which the laminate is stress-free")
    ] = None


class Cylinder(Section):
    """Main dimensions and mounting."""

    bore: Annotated[float, Of("bore", "inner diameter of the barrel")]
    stroke: Annotated[float, Of("stroke", "travel of the piston")]
    type: choices.CylinderType = "differential"
    mount: choices.Mount = "cap_clevis"
    end_stop: choices.EndStop = "internal"
    dead_volume_a: Annotated[
        float, Of("volume", "dead oil volume of the cap side at zero stroke, including ports")
    ] = 0.0
    dead_volume_b: Annotated[
        float, Of("volume", "dead oil volume of the rod side at full stroke, including ports")
    ] = 0.0
    port_diameter: Annotated[float | None, Of("diameter", "inner diameter of both ports")] = None
    port_thread: choices.PortThread = None
    stop_travel: Annotated[
        float,
        Of(
            "stop_travel",
            "deflection of an internal end stop under the force of the supply pressure",
        ),
    ] = 0.2e-3
    mount_stiffness: Annotated[float | None, Of("stiffness", "axial stiffness of the mounting")] = (
        None
    )


class Ply(Section):
    """One layer of a tube wall; the layers are listed from the inside outwards.

    In the file, an entry in compact notation (`layup`) may give several layers.
    """

    material: Annotated[str, MaterialName("structural")]
    thickness: Annotated[float, Of("wall_thickness", "thickness of the layer")]
    angle: Annotated[
        float, Of("winding_angle", "winding angle from the tube axis; signed if not balanced")
    ] = 0.0
    balanced: Annotated[
        bool,
        Boolean(
            "true: a balanced pair at +-angle; false: one ply at the signed angle (wall may twist)"
        ),
    ] = True
    ply_thickness: Annotated[
        float | None,
        Of(
            "ply_thickness",
            "cured thickness of one ply; when a design is rounded, each layer gets a whole number "
            "of plies",
        ),
    ] = None


MOST_LAYERS = 24
"""Largest number of layers of a wall."""


class Barrel(Section):
    """The pressure tube, from layers; a metal barrel has a single isotropic layer."""

    layup: Annotated[tuple[Ply, ...], Field(min_length=1, max_length=MOST_LAYERS)]
    model: choices.WallModel = "auto"
    criterion: choices.Criterion = "max_stress"
    turn: choices.Turn | None = None
    autofrettage_pressure: Annotated[
        float | None,
        Of("autofrettage_pressure", "pressure applied once before use, to yield the metal liner"),
    ] = None
    allowed_angles: Annotated[
        tuple[
            Annotated[
                float,
                Of(
                    "allowed_angle",
                    "winding angle that can be made; designs are rounded to such angles",
                ),
            ],
            ...,
        ]
        | None,
        Field(min_length=1, max_length=100),
    ] = None
    length: Annotated[
        float | None, Of("part_length", "length of the tube; default: piston + stroke + head")
    ] = None


class Thread(Section):
    """A metric thread."""

    diameter: Annotated[float, Of("thread_diameter", "nominal diameter")]
    pitch: Annotated[float, Of("thread_pitch", "pitch")]


class RetentionThread(Section):
    """Metric thread of tie rods, or of caps screwed onto the barrel's outside.

    For caps, the barrel's end is turned down to the thread diameter. If no thread diameter is
    stated, it equals the outer diameter of the barrel.
    """

    diameter: Annotated[
        float | None,
        Of(
            "thread_diameter",
            "nominal diameter (default: barrel outer diameter; tie rods: no default)",
        ),
    ] = None
    pitch: Annotated[float, Of("thread_pitch", "pitch")]


class Fitting(Section):
    """Metal ends bonded into a laminated rod."""

    material: Annotated[str | None, MaterialName("isotropic")] = None
    """Material of the fittings; default: the rod's material."""
    adhesive: Annotated[str, MaterialName("adhesive")]
    length: Annotated[float, Of("part_length", "length of the fitting inside the tube (overlap)")]
    wall: Annotated[
        float | None,
        Of("wall_thickness", "wall thickness of the fitting in the overlap; default: solid"),
    ] = None


class Rod(Section):
    """The piston rod; `extension` is its length outside the head when retracted.

    A laminated rod has a `layup` with the outer diameter `outer_diameter`. Its bore follows from
    the layers, and `material` is the metal of its end fittings.
    """

    material: Annotated[str, MaterialName("isotropic", ("metal",))]
    outer_diameter: Annotated[
        float, Of("rod_diameter", "diameter of the rod where it passes the rod seal")
    ]
    inner_diameter: Annotated[
        float, Of("rod_inner_diameter", "bore of a hollow rod; 0: a solid rod")
    ] = 0.0
    extension: Annotated[float, Of("length", "length outside the head when retracted")] = 0.0
    thread: Thread | None = None
    layup: Annotated[tuple[Ply, ...], Field(max_length=MOST_LAYERS)] = ()
    fitting: Fitting | None = None


class SecondRod(Section):
    """The rod through the cap of a double-rod cylinder, where it differs from the block `rod`.

    Without this block, material, diameters and extension are those of `rod`. The second rod is of
    one metal, and has no thread. `extension` is its length outside the cap when the piston is fully
    extended; retracted, the stroke adds to it.
    """

    material: Annotated[str | None, MaterialName("isotropic", ("metal",))] = None
    outer_diameter: Annotated[
        float | None,
        Of("rod_diameter", "diameter of the second rod; default: that of the rod"),
    ] = None
    inner_diameter: Annotated[
        float | None,
        Of("rod_inner_diameter", "bore of the second rod; 0: solid; default: that of the rod"),
    ] = None
    extension: Annotated[
        float | None,
        Of("length", "length outside the cap when fully extended; default: that of the rod"),
    ] = None


class PistonNut(Section):
    """Nut that clamps the piston on a stud of the rod, in a recess of the piston."""

    diameter: Annotated[float, Of("thread_diameter", "nominal diameter of the thread")]
    pitch: Annotated[float, Of("thread_pitch", "pitch")]
    preload: Annotated[float, Of("force", "mean tension of the stud after tightening")]
    tightening_factor: Annotated[
        float, Of("tightening_factor", "greatest divided by least preload after tightening")
    ] = TIGHTENING
    """Default: a torque wrench (`models.piston_nut`)."""


class Cushion(Section):
    """A cushioning spear that throttles the oil shortly before a stop."""

    ends: choices.CushionEnd = "both"
    length: Annotated[float, Of("part_length", "length of the cushioned travel")]
    open_area: Annotated[float, Of("orifice_area", "flow area when the spear enters")]
    end_area: Annotated[float, Of("orifice_area", "remaining flow area at the stop")]
    exponent: Annotated[
        float,
        Of(
            "stribeck_exponent",
            "exponent of the curve by which the flow area falls along the travel",
        ),
    ] = 1.0


class BuiltCushion(Cushion):
    """Cushions of the cylinder: a spear on the piston and a collar on the rod, in bushes.

    The bushes lengthen the cylinder. A scenario simulates these cushions unless it states its own.
    """

    diameter: Annotated[float, Of("diameter", "diameter of spear and collar")]


class Sensor(Section):
    """A position sensor, fixed in the cap, whose straight element is inside the hollow rod."""

    type: choices.Sensing
    diameter: Annotated[float, Of("diameter", "diameter of the element inside the rod")]
    dead_length: Annotated[
        float, Of("length", "length of the element inside the rod beyond the stroke")
    ]
    mass: Annotated[float, Of("component_mass", "mass of the sensor")]


class Piston(Section):
    """The piston: a disc with the seal grooves."""

    material: Annotated[str, MaterialName("structural")]
    length: Annotated[float, Of("part_length", "axial length of the piston")]
    bearing: Annotated[str | None, MaterialName("structural", ("polymer", "metal"))] = None
    clearance: Annotated[
        float, Of("radial_clearance", "radial clearance between piston and bore")
    ] = 3e-5
    leakage_conductance: Annotated[
        float, Of("conductance", "leakage flow across the piston per pressure difference")
    ] = 0.0
    nut: PistonNut | None = None


class Head(Section):
    """Rod-end head: contains rod bearing, rod seal and wiper over `length` inside the barrel."""

    material: Annotated[str, MaterialName("structural")]
    length: Annotated[float, Of("part_length", "axial length inside the barrel")]
    bearing: Annotated[str | None, MaterialName("structural", ("polymer", "metal"))] = None
    clearance: Annotated[float, Of("radial_clearance", "radial clearance between rod and head")] = (
        3e-5
    )


class Caps(Section):
    """End plates of cap end and head end."""

    material: Annotated[str, MaterialName("structural")]
    thickness: Annotated[float, Of("wall_thickness", "thickness of both end plates")]


_OVERLAP = Of(
    "part_length",
    "length of the skirt over the barrel, of the barrel's lip outside a retaining ring, of the "
    "barrel outside a pinned plug's plate, of the crest before a cone, or of the engaged thread of "
    "the tie rods",
)


class Sleeve(Section):
    """Metal sleeve under the end of the winding, into which the joint is cut.

    If it is of the metal of the innermost layer, it is one piece with it. It extends beyond the
    winding by the part outside the plug, or under the skirt.
    """

    material: Annotated[str, MaterialName("structural")]
    wall: Annotated[float, Of("wall_thickness", "thickness of the sleeve")]
    inner_length: Annotated[
        float, Of("part_length", "length of the sleeve under the winding, with its conical tip")
    ]


class _EndRetention(Section):
    """Joint of one end of the barrel, of the cap or of the head; keys as in `retention`."""

    type: choices.RetentionType
    length: Annotated[float, _OVERLAP]
    wall: Annotated[
        float,
        Of(
            "wall_thickness",
            "thickness of the skirt, of a shrunk ring, or of the plug in the bore before a cone",
        ),
    ] = 1.5e-3
    material: Annotated[str | None, MaterialName("fastening")] = None
    count: Annotated[float, Of("bolt_count", "number of tie rods, or of pins in a row")] = 4.0
    thread: RetentionThread | None = None
    preload: Annotated[
        float | None, Of("force", "total tension of all tie rods without pressure")
    ] = None
    sleeve: Sleeve | None = None


def _own_keys() -> dict[str, Any]:
    """Keys of `retention` that only some joints have, each with its quantity."""
    fields = [field for joint in JOINTS.values() for field in joint.fields]
    own = {field.key: field for field in fields if field.quantity}
    for key in own.keys() & _EndRetention.model_fields.keys():
        raise ValueError(
            f"joint field {key}: all joints share this key, so none may state its quantity"
        )
    return {
        key: (Annotated[float | None, Of(field.quantity, field.help)], None)
        for key, field in own.items()
    }


if TYPE_CHECKING:
    EndRetention: TypeAlias = _EndRetention
else:  # with the keys that only some joints have
    EndRetention = create_model(
        "EndRetention",
        __base__=_EndRetention,
        __doc__=_EndRetention.__doc__,
        __module__=__name__,
        **_own_keys(),
    )


class Retention(EndRetention):
    """Joint of caps and head to the barrel: skirts over the barrel (bond, thread), or tie rods.

    `length` is the overlap of skirt and barrel, `wall` the thickness of the skirt, `material` the
    adhesive or the tie-rod metal. A thread is cut into the metal of barrel and caps. The joint
    holds for both ends; the blocks `cap` and `head`, stated instead, hold for one end each.
    """

    type: Annotated[str | None, choices.JOINT_TYPE] = None  # type: ignore[assignment]
    length: Annotated[float | None, _OVERLAP] = None  # type: ignore[assignment]
    cap: EndRetention | None = None
    head: EndRetention | None = None

    @property
    def ends(self) -> dict[str, EndRetention]:
        """The joint of each end, `cap` and `head`; or the joint of both ends, with the name ""."""
        if self.cap is not None and self.head is not None:
            return {"cap": self.cap, "head": self.head}
        return {"": self}


class Clevis(Section):
    """Eyes at both ends, each on a pin in double shear."""

    material: Annotated[str, MaterialName("structural")]
    pin_diameter: Annotated[
        float | None, Of("diameter", "diameter of the pins; default: bore of the bearings")
    ] = None
    neck: Annotated[
        float, Of("length", "additional length of the cap eye's neck, past a barrel around it")
    ] = 0.0
    bearing: choices.Bearing = None


class Stiffness(Section):
    """Contributions to the axial stiffness that the model includes, and how they are combined."""

    topology: choices.Topology = "per_chamber"
    seals: choices.SealState = "sliding"
    seal_deflection: Annotated[
        float, Of("breakaway_travel", "travel at which sticking seals break away")
    ] = 1e-4
    load_cell: Annotated[
        float | None, Of("stiffness", "stiffness of the load cell of a test rig")
    ] = None


class LoadCase(Section):
    """A load case: force or joint torque, direction, speed and position.

    A joint torque acts on the stated lever arm, or through the linkage.
    """

    name: Annotated[str, CaseName("name of the case in reports and PATHs")]
    direction: choices.Direction
    force: Annotated[float | None, Of("force", "axial force that the actuator must deliver")] = None
    joint_torque: Annotated[
        float | None,
        Of("torque", "joint torque that the actuator must deliver, instead of a force"),
    ] = None
    lever_arm: Annotated[
        float | None, Of("lever_arm", "lever arm of the joint torque; default: from the linkage")
    ] = None
    angle: Annotated[
        float | None, Of("joint_angle", "joint angle of the linkage, instead of a position")
    ] = None
    speed: Annotated[float, Of("speed", "piston speed")] = 0.0
    joint_speed: Annotated[
        float | None, Of("joint_speed", "joint speed of the linkage, instead of speed")
    ] = None
    position: Annotated[Position, PositionKind()] = "worst"
    pressure: Annotated[
        float | None, Of("pressure", "gauge pressure at the driven port; default: supply.pressure")
    ] = None
    temperature: Annotated[
        float | None, Of("temperature", "oil temperature; default: fluid.temperature")
    ] = None
    side_load: Annotated[float, Of("force", "lateral force at the rod end")] = 0.0
    frequency: Annotated[
        float | None, Of("frequency", "excitation frequency of the load on the held actuator")
    ] = None
    pressure_a: Annotated[
        float | None,
        Of(
            "pressure",
            "gauge pressure in chamber A while the valve holds the force; default: the pressure "
            "with a critical-centre valve",
        ),
    ] = None
    pressure_b: Annotated[
        float | None,
        Of(
            "pressure",
            "gauge pressure in chamber B while the valve holds the force; default: the pressure "
            "with a critical-centre valve",
        ),
    ] = None

    @property
    def through_linkage(self) -> bool:
        """Whether a joint torque acts through the linkage."""
        return self.joint_torque is not None and self.lever_arm is None

    @property
    def moves(self) -> bool:
        """Whether the case states a speed of piston or joint."""
        return self.speed > 0 or (self.joint_speed or 0.0) > 0


class Limit(Section):
    """Limits of a metric (SI); the file uses units of the metric."""

    min: float | None = None
    max: float | None = None


class RequirementLimit(Limit):
    """Limits of a metric (SI) that the design must meet, and why they are what they are."""

    reason: Annotated[str | None, Text("where the limit comes from, for the report", 400)] = None


class Objective(Section):
    """Metric to optimise, or several with weights, each divided by its value in the design."""

    minimise: Annotated[str | dict[str, float] | None, ObjectiveKind()] = None
    maximise: Annotated[str | dict[str, float] | None, ObjectiveKind()] = None

    @property
    def aim(self) -> Sense:
        """Sense of the objective: "min" if small values are better, "max" if large values are."""
        return "max" if self.minimise is None else "min"

    @property
    def metrics(self) -> tuple[str, ...]:
        """Metrics of the objective."""
        stated = self.maximise if self.minimise is None else self.minimise
        return (stated,) if isinstance(stated, str) else tuple(stated or ())


def _like_the_piston(stated: dict[str, Any]) -> Head:
    """Add a head with the piston's material and length if the file describes none."""
    piston = stated.get("piston")
    if piston is None:  # a missing piston is a separate fault
        return Head.model_construct(material="", length=0.0)
    return Head(material=piston.material, length=piston.length)


PLAIN_CAP = 0.25
"""Default thickness of the end plates, divided by the bore."""


def _plain_caps(stated: dict[str, Any]) -> Caps:
    """Add caps if the file describes none: piston material, a quarter of the bore thick."""
    piston, cylinder = stated.get("piston"), stated.get("cylinder")
    if piston is None or cylinder is None:
        return Caps.model_construct(material="", thickness=0.0)
    return Caps(material=piston.material, thickness=PLAIN_CAP * cylinder.bore)


class Design(Section):
    """A hydraulic actuator with its load cases, variables and requirements."""

    name: Annotated[str, Text("title of the design")]
    notes: Annotated[str, Text("free text for the report", 20000, multiline=True)] = ""
    reproduces: Paper = None
    fluid: FluidSection
    supply: Supply
    environment: Environment | None = None
    cylinder: Cylinder
    barrel: Barrel
    rod: Rod
    second_rod: SecondRod | None = None
    piston: Piston
    head: Annotated[Head, Field(default_factory=_like_the_piston)]
    caps: Annotated[Caps, Field(default_factory=_plain_caps)]
    retention: Retention | None = None
    clevis: Clevis | None = None
    sensor: Sensor | None = None
    cushion: BuiltCushion | None = None
    seals: Seals
    extra_masses: Annotated[tuple[ExtraMass, ...], Field(max_length=24)] = ()
    lines: Annotated[tuple[Line, ...], Field(max_length=24)] = ()
    stiffness: Stiffness = Stiffness.model_construct()
    valve: Valve | None = None
    ports: Ports = Ports.model_construct()
    control: PositionLoop | None = None
    load: Load = Load.model_construct()
    linkage: Linkage | None = None
    ideal: Ideal | None = None
    load_cases: Annotated[tuple[LoadCase, ...], Field(min_length=1, max_length=100)]
    duty: DutySection | None = None
    variables: dict[str, Variable] = {}  # noqa: RUF012 (pydantic copies it)
    choices: dict[str, tuple[float | bool | str | Fraction, ...]] = {}  # noqa: RUF012 (pydantic copies it)
    requirements: dict[str, RequirementLimit] = {}  # noqa: RUF012 (pydantic copies it)
    waivers: dict[str, Annotated[str, Text("why the check does not apply")]] = {}  # noqa: RUF012 (pydantic copies it)
    measured: dict[str, TestBounds] = {}  # noqa: RUF012 (pydantic copies it)
    """Confidence bounds of values from a test record, by PATH."""
    uncertainty: dict[str, Uncertain] = {}  # noqa: RUF012 (pydantic copies it)
    """Scatter of values by PATH, in addition to the scatter in libraries and practice tables."""
    materials: dict[str, dict[str, float]] = {}  # noqa: RUF012 (pydantic copies it)
    """Properties (SI) that replace those of the library in this design, by material name."""
    objective: Objective = Objective.model_construct(minimise="mass")

    @property
    def double_rod(self) -> bool:
        """Whether a rod passes through the cap, too."""
        return self.cylinder.type == "double_rod"

    @property
    def in_short(self) -> tuple[str, str]:
        """The name; and the objective, with the numbers of variables and requirements."""
        aim = "minimise" if self.objective.aim == "min" else "maximise"
        limits = len(self.load_cases)  # each must be carried
        limits += sum((x.min is not None) + (x.max is not None) for x in self.requirements.values())
        words = f"{aim} {' and '.join(self.objective.metrics)}, {len(self.variables)} variables"
        return self.name, f"{words}, {limits} requirements"

    def __repr__(self) -> str:
        """Name, objective, and the numbers of variables and requirements."""
        return headline(type(self).__name__, *self.in_short)

    __str__ = __repr__
