"""The Scenario: signals and events that act on a design over time, with a class for each block.

A signal is the sum of the parts in its list.
"""

# Annotations are objects here, not texts, which Pydantic would compile one by one at each start.

from typing import Annotated

from pydantic import Field

from ..kinds import Boolean, CaseName, FileName, Label, Of, Position, Section, Text
from ..model import Cushion, Limit
from ..valve import Valve
from . import kinds
from .kinds import StartPosition


class SignalSegment(Section):
    """A part of a signal; the signal is the sum of the parts in its list."""

    shape: kinds.Shape
    start: Annotated[
        float,
        Of(
            "instant",
            "start time; for a record, the scenario time at which the record's own time is 0",
        ),
    ] = 0.0
    end: Annotated[float | None, Of("instant", "end time")] = None
    frequency: Annotated[float | None, Of("frequency", "frequency of a sine")] = None
    phase: Annotated[float, Of("phase", "phase of a sine at its start")] = 0.0
    file: Annotated[
        str | None, FileName("CSV file of a record, in the folder of the scenario", "record.csv")
    ] = None
    column: Annotated[
        str | None, Label("header of the record's column in the CSV file", "force")
    ] = None
    scale: Annotated[float, Of("factor", "factor that multiplies a record")] = 1.0


class ValveSignal(SignalSegment):
    """A part of the signal that drives the valve."""

    value: Annotated[
        float | None, Of("signal_value", "height of this part, or amplitude of a sine")
    ] = None


class PositionSignal(SignalSegment):
    """A part of a signal that states a position over time."""

    value: Annotated[
        float | None, Of("position_value", "height of this part, or amplitude of a sine")
    ] = None


class SpeedSignal(SignalSegment):
    """A part of a signal that states a speed over time."""

    value: Annotated[
        float | None, Of("speed_value", "height of this part, or amplitude of a sine")
    ] = None


class ForceSignal(SignalSegment):
    """A part of the signal of the load force, which is positive against extension."""

    value: Annotated[
        float | None, Of("force_value", "height of this part, or amplitude of a sine")
    ] = None


class TorqueSignal(SignalSegment):
    """A part of the signal of the load torque on a shaft or joint."""

    value: Annotated[
        float | None, Of("torque_value", "height of this part, or amplitude of a sine")
    ] = None


class ShaftSpeedSignal(SignalSegment):
    """A part of a signal that states a shaft's speed over time."""

    value: Annotated[
        float | None, Of("shaft_speed_value", "height of this part, or amplitude of a sine")
    ] = None


class ShaftAngleSignal(SignalSegment):
    """A part of a signal that states a shaft's angle over time."""

    value: Annotated[
        float | None, Of("shaft_angle_value", "height of this part, or amplitude of a sine")
    ] = None


SAMPLES = 2000
"""Default number of samples of a run."""
MOST_SAMPLES = 2_000_000
"""Largest number of samples of a run."""
FEWEST_SAMPLES = 10
"""Smallest number of samples of a run, and of each period of a sine in it."""

Parts = Annotated[tuple[ValveSignal, ...], Field(max_length=100)]


class Initial(Section):
    """Initial state; by default the rod is at rest and the pressures balance the load."""

    position: Annotated[Position | None, StartPosition()] = None
    """Default: mid-stroke."""
    pressure_a: Annotated[float | None, Of("pressure", "gauge pressure in chamber A")] = None
    pressure_b: Annotated[float | None, Of("pressure", "gauge pressure in chamber B")] = None
    speed: Annotated[float, Of("speed_value", "speed of the rod")] = 0.0


class Machine(Section):
    """A pump or motor, with Wilson's model of its losses."""

    displacement: Annotated[float, Of("displacement", "displacement per revolution")]
    setting: Annotated[float, Of("displacement_setting", "displacement setting")] = 1.0
    slip: Annotated[float, Of("slip_coefficient", "coefficient C_s of laminar slip")]
    coulomb: Annotated[
        float,
        Of(
            "coulomb_coefficient",
            "coefficient C_f of the friction that is proportional to pressure",
        ),
    ]
    viscous: Annotated[
        float,
        Of("viscous_coefficient", "coefficient C_v of the friction that is proportional to speed"),
    ]
    constant_torque: Annotated[
        float, Of("constant_torque", "torque loss T_c, the same at any speed and pressure")
    ] = 0.0


class PumpMachine(Machine):
    """A pump whose shaft is driven at a constant speed."""

    shaft_speed: Annotated[float, Of("drive_speed", "speed of the shaft")]


class ReliefValve(Section):
    """A relief valve."""

    pressure: Annotated[float, Of("pressure_drop", "cracking pressure above the tank pressure")]
    override: Annotated[
        float, Of("pressure_drop", "pressure rise from cracking to the rated flow")
    ] = 10e5
    rated_flow: Annotated[float, Of("rated_flow", "flow through the fully open valve")]


class SupplyAccumulator(Section):
    """A gas accumulator on the supply line."""

    gas_volume: Annotated[float, Of("gas_volume", "gas volume at the precharge")]
    precharge: Annotated[float, Of("precharge", "gas precharge, gauge")]


class SupplyLine(Section):
    """A pipe between supply and valve."""

    length: Annotated[float, Of("part_length", "length of the pipe")]
    inner_diameter: Annotated[float, Of("line_diameter", "inner diameter")]


class ValveSupply(Section):
    """The supply of the valve; its set pressure is the supply pressure of the design."""

    type: kinds.Supply = "constant"
    volume: Annotated[float | None, Of("oil_volume", "oil volume of the supply line")] = None
    flow: Annotated[
        float | None, Of("rated_flow", "flow of a fixed pump, or largest flow of a controlled pump")
    ] = None
    pump: PumpMachine | None = None
    """Pump with losses by Wilson's model, instead of a constant `flow`."""
    relief: ReliefValve | None = None
    gain: Annotated[float | None, Of("pump_gain", "controller gain of a controlled pump")] = None
    time_constant: Annotated[
        float | None, Of("time_constant", "time constant of the lag of a controlled pump")
    ] = None
    accumulator: SupplyAccumulator | None = None
    line: SupplyLine | None = None


class Stops(Section):
    """Stops at the ends of the stroke; their stiffness follows from the design's stop_travel."""

    damping: Annotated[
        float,
        Of(
            "damping_factor",
            "damping of a stop, divided by sqrt(stiffness of the stop x moving mass)",
        ),
    ] = 0.5
    cushion: Cushion | None = None


class ScenarioFriction(Section):
    """Friction of the seals: calculated from the design, or stated in the scenario."""

    model: kinds.Friction = "lugre"
    coulomb: Annotated[
        float | None, Of("coulomb_force", "Coulomb friction F_C; default: from the design")
    ] = None
    static: Annotated[float | None, Of("static_force", "breakaway friction F_S; default: F_C")] = (
        None
    )
    stribeck_speed: Annotated[float | None, Of("stribeck_speed", "v_s")] = None
    exponent: Annotated[float, Of("stribeck_exponent", "delta")] = 2.0
    viscous: Annotated[float | None, Of("viscous_friction", "sigma_2")] = None
    bristle_travel: Annotated[
        float | None,
        Of("breakaway_travel", "breakaway travel z_max; default: stiffness.seal_deflection"),
    ] = None
    bristle_damping: Annotated[
        float | None,
        Of(
            "bristle_damping",
            "bristle damping sigma_1; default: sqrt(sigma_0 m), with bristle stiffness sigma_0 and "
            "moving mass m",
        ),
    ] = None
    bristle_taper: Annotated[
        bool | None,
        Boolean(
            "whether the bristle damping falls with speed so that friction adds no energy; "
            "default: true, but false if bristle_damping is stated"
        ),
    ] = None


class Motor(Section):
    """A hydraulic motor that replaces the cylinder, between two pipes."""

    machine: Machine
    inertia: Annotated[float, Of("inertia", "inertia of motor and load together")]
    pipe_volume: Annotated[float, Of("oil_volume", "oil volume of each pipe")]
    damping: Annotated[float, Of("shaft_damping", "damping of the load")] = 0.0
    torque: Annotated[tuple[TorqueSignal, ...], Field(max_length=100)] = ()


class HeldPorts(Section):
    """The valve alone, on a test bench that keeps its port pressures constant."""

    pressure_a: Annotated[float, Of("pressure", "gauge pressure at port A")]
    pressure_b: Annotated[float, Of("pressure", "gauge pressure at port B")]


class Drive(Section):
    """An external drive that moves the rod through a spring, such as a stiff test machine."""

    position: Annotated[tuple[PositionSignal, ...], Field(min_length=1, max_length=100)]
    stiffness: Annotated[
        float, Of("load_stiffness", "stiffness of the spring between test machine and load")
    ]
    damping: Annotated[
        float, Of("load_damping", "damping of the damper between test machine and load")
    ] = 0.0


class LoadCylinder(Section):
    """A double-rod cylinder with its own valve, coupled to the rod to load it.

    It starts at mid-stroke; the oil is that of the design.
    """

    bore: Annotated[float, Of("bore", "inner diameter")]
    rod_diameter: Annotated[float, Of("rod_diameter", "diameter of both rods")]
    stroke: Annotated[float, Of("stroke", "travel of the load cylinder's piston")]
    dead_volume: Annotated[
        float, Of("volume", "oil volume of each chamber's line and dead space")
    ] = 0.0
    supply_pressure: Annotated[float, Of("working_pressure", "gauge")]
    return_pressure: Annotated[float, Of("pressure", "gauge")] = 0.0
    valve: Valve
    signal: Annotated[tuple[ValveSignal, ...], Field(max_length=100)] = ()
    force: Annotated[
        float, Of("force_value", "initial force of the load cylinder on the rod, positive outwards")
    ] = 0.0


class ScenarioLoad(Section):
    """The load on the rod; its mass is load.mass of the design."""

    force: Annotated[tuple[ForceSignal, ...], Field(max_length=100)] = ()
    torque: Annotated[tuple[TorqueSignal, ...], Field(max_length=100)] = ()
    """Torque on the joint of the design's linkage."""
    stiffness: Annotated[
        float, Of("load_stiffness", "stiffness of a spring between load and ground")
    ] = 0.0
    damping: Annotated[float, Of("load_damping", "damping between load and ground")] = 0.0
    drive: Drive | None = None
    cylinder: LoadCylinder | None = None


class Controller(Section):
    """A continuous controller that sets the valve signal so that the motion follows its reference.

    The reference is one of four: position, speed, shaft speed or shaft angle.
    """

    position: Annotated[tuple[PositionSignal, ...], Field(max_length=100)] = ()
    speed: Annotated[tuple[SpeedSignal, ...], Field(max_length=100)] = ()
    shaft_speed: Annotated[tuple[ShaftSpeedSignal, ...], Field(max_length=100)] = ()
    shaft_angle: Annotated[tuple[ShaftAngleSignal, ...], Field(max_length=100)] = ()
    law: kinds.Law = "p"
    tuning: kinds.Tuning = "margins"
    tuning_side: kinds.TuningSide = "worst"
    margin: Annotated[
        float | None,
        Of("margin", 'gain margin for "tuning: margins"; default: 2 for law p, 3 for law pi'),
    ] = None
    position_gain: Annotated[float | None, Of("position_gain", "gain of a position loop")] = None
    speed_gain: Annotated[float | None, Of("speed_gain", "gain of a speed loop")] = None
    shaft_speed_gain: Annotated[
        float | None, Of("shaft_speed_gain", "gain of a shaft-speed loop")
    ] = None
    shaft_angle_gain: Annotated[
        float | None, Of("shaft_angle_gain", "gain of a shaft-angle loop")
    ] = None
    gain_factor: Annotated[
        float, Of("part_factor", "factor that multiplies the gain, tuned or stated")
    ] = 1.0
    integral_factor: Annotated[
        float, Of("part_factor", "factor that multiplies the integral part")
    ] = 1.0
    derivative_factor: Annotated[
        float, Of("part_factor", "factor that multiplies the derivative part")
    ] = 1.0
    integral_time: Annotated[float | None, Of("time_constant", "T_i")] = None
    derivative_time: Annotated[float | None, Of("time_constant", "T_d")] = None
    filter_time: Annotated[float, Of("time_constant", "filter time T_f of the derivative")] = 1e-3
    speed_feedback: Annotated[
        float,
        Of("speed_gain", "gain of an inner speed loop; its output is subtracted from the signal"),
    ] = 0.0
    pressure_feedback: Annotated[
        float,
        Of(
            "pressure_gain",
            "gain on changes of the load pressure; the product is subtracted from the signal",
        ),
    ] = 0.0
    pressure_time: Annotated[
        float, Of("time_constant", "time constant of the high-pass filter for pressure changes")
    ] = 0.05
    feed_forward: Annotated[tuple[ValveSignal, ...], Field(max_length=100)] = ()
    """Signal that is added to that of the controller; default with a duty cycle: the opening of the
    valve that the cycle needs."""
    rate_limit: Annotated[float | None, Of("signal_rate", "rate limit of the signal")] = None
    dead_band_jump: Annotated[
        float | None,
        Of(
            "signal",
            "signal that is added in its own direction, to pass the dead band of the valve; it "
            "fades to zero within 1 % of the full signal; tuning and margins leave it out",
        ),
    ] = None


class Analysis(Section):
    """Settings for the analysis of the simulated signals."""

    window_cycles: Annotated[
        float,
        Of(
            "cycles_per_window",
            "number of sine cycles in each window over which dynamic stiffness is evaluated",
        ),
    ] = 5.0


class Scenario(Section):
    """Signals and events that act on a design over time."""

    name: Annotated[str, Label("title of the scenario", "step response")]
    notes: Annotated[str, Text("free text for the report", 20000, multiline=True)] = ""
    reproduces: kinds.PublishedCase = None
    design: Annotated[str, FileName("the design file, in the folder of the scenario", "knee.yaml")]
    set: dict[str, str] = {}  # noqa: RUF012 (pydantic copies it)
    """Values of the design that the scenario changes, by PATH."""
    unset: Annotated[
        tuple[
            Annotated[
                str,
                Label("key or block of the design to remove, before any is set", "cushion"),
            ],
            ...,
        ],
        Field(max_length=100),
    ] = ()
    """PATHs of keys and blocks of the design; a removed key takes its default."""
    cycle: Annotated[
        str | None,
        CaseName(
            "duty cycle of the design that is simulated: its position over time is the reference, "
            "its force, with the inertia of the load in it, loads the rod",
        ),
    ] = None
    duration: Annotated[float, Of("duration", "simulated time")]
    sample_time: Annotated[
        float | None, Of("sample_time", "sample time of the signals; default: duration / 2000")
    ] = None
    initial: Initial = Initial.model_construct()
    supply: ValveSupply = ValveSupply.model_construct()
    ends: kinds.Ends = None
    friction: ScenarioFriction = ScenarioFriction.model_construct()
    stops: Stops = Stops.model_construct()
    motor: Motor | None = None
    held_ports: HeldPorts | None = None
    load: ScenarioLoad = ScenarioLoad.model_construct()
    signal: Parts = ()
    control: Controller | None = None
    analysis: Analysis = Analysis.model_construct()
    requirements: dict[str, Limit] = {}  # noqa: RUF012 (pydantic copies it)
