"""The block `valve` of a design or a load cylinder: data sheet, spool and edges."""

from typing import Annotated

from pydantic import Field

from ..models.orifice import TURBULENT_COEFFICIENT
from . import choices
from .data_file import DataFileName, as_read
from .flow_curve import MOST_BYTES, FlowTable, flow_table
from .kinds import Of, Section


class StatedEdge(Section):
    """Values of one metering edge of a lapped spool, where they differ from the other edges."""

    overlap: Annotated[
        float | None, Of("spool_overlap", "overlap of this edge; default: valve.spool.overlap")
    ] = None
    clearance: Annotated[
        float | None,
        Of("spool_clearance", "radial clearance of this edge; default: valve.spool.clearance"),
    ] = None
    rounding: Annotated[
        float | None,
        Of("edge_rounding", "corner radius of this edge; default: valve.spool.rounding"),
    ] = None
    flow_share: Annotated[
        float,
        Of("flow_share", "width of this edge, as a share of the width that the valve states"),
    ] = 1.0


class CurvePoint(Section):
    """A point of the curve of flow over signal, both as shares of their full values."""

    signal: Annotated[float, Of("opening", "share of the full signal")]
    flow: Annotated[float, Of("opening", "share of the rated flow at this signal")]


class Spool(Section):
    """Law and geometry of the metering edges of a valve."""

    type: choices.SpoolLaw = "course"
    stroke: Annotated[
        float | None, Of("spool_stroke", "travel of the spool from its centre at full signal")
    ] = None
    overlap: Annotated[
        float, Of("spool_overlap", "overlap of every edge; negative: open at the centre")
    ] = 0.0
    clearance: Annotated[
        float | None,
        Of(
            "spool_clearance",
            "radial clearance of the spool, or state valve.leakage_flow; default: no leakage",
        ),
    ] = None
    rounding: Annotated[float, Of("edge_rounding", "radius of the corners of every edge")] = 0.0
    area_gradient: Annotated[
        float | None,
        Of(
            "area_gradient",
            "width of the ports around the spool, instead of valve.rated_flow: flow area of an "
            "edge per opening",
        ),
    ] = None
    flow_coefficient: Annotated[
        float, Of("coefficient", "discharge coefficient of the turbulent flow through an edge")
    ] = TURBULENT_COEFFICIENT
    curve: Annotated[tuple[CurvePoint, ...], Field(max_length=30)] = ()
    pa: StatedEdge | None = None
    pb: StatedEdge | None = None
    at: StatedEdge | None = None
    bt: StatedEdge | None = None


class EdgeCoefficients(Section):
    """Flow coefficients K of the fully open edges, q = K sqrt(dp)."""

    pa: Annotated[float, Of("edge_coefficient", "K of the open edge from supply to port A")]
    pb: Annotated[float, Of("edge_coefficient", "K of the open edge from supply to port B")]
    at: Annotated[float, Of("edge_coefficient", "K of the open edge from port A to tank")]
    bt: Annotated[float, Of("edge_coefficient", "K of the open edge from port B to tank")]


class Valve(Section):
    """A proportional or servo valve with four metering edges."""

    rated_flow: Annotated[
        float | None,
        Of(
            "rated_flow",
            "flow through one metering edge at full signal; or state edge_coefficients, "
            "flow_curve or spool.area_gradient",
        ),
    ] = None
    rated_drop: Annotated[
        float,
        Of("pressure_drop", "pressure drop across the edge at rated flow, or of the flow curve"),
    ] = 35e5
    edge_coefficients: EdgeCoefficients | None = None
    flow_curve: Annotated[
        str | None,
        DataFileName(
            "flow over signal at rated_drop, as CSV: a file in the folder of the design, or the "
            "table itself; columns: signal [%] or [V]; q [l/min], or q_pa, q_pb, q_at and q_bt",
            "valve_curve.csv",
            most=MOST_BYTES,
            parse=lambda file, valve: file.parsed(flow_table),
        ),
    ] = None
    leakage_flow: Annotated[
        float,
        Of(
            "leakage_flow",
            "leakage of one metering edge with centred spool: half of the valve's leakage; with a "
            "lapped spool, the clearance follows from it",
        ),
    ] = 0.0
    leakage_drop: Annotated[
        float, Of("pressure_drop", "pressure drop across the edge at the leakage flow")
    ] = 50e5
    tank_leakage_drop: Annotated[
        float | None,
        Of(
            "pressure_drop",
            "pressure drop across an edge to tank at the leakage flow; default: leakage_drop",
        ),
    ] = None
    rated_viscosity: Annotated[
        float | None,
        Of(
            "oil_viscosity",
            "oil viscosity at which the rated flow applies; default: the rated "
            "flow applies to any oil",
        ),
    ] = None
    offset: Annotated[float, Of("signal_offset", "signal that centres the spool")] = 0.0
    signal: Annotated[float, Of("signal", "signal of the fully open spool")] = 10.0
    natural_frequency: Annotated[
        float | None,
        Of("frequency", "natural frequency of the spool; or state frequency_90deg, frequency_3db"),
    ] = None
    damping_ratio: Annotated[float, Of("damping_ratio", "damping ratio of the spool")] = 0.7
    frequency_90deg: Annotated[
        float | None,
        Of("frequency", "frequency at which the spool lags its signal by 90 degrees"),
    ] = None
    frequency_3db: Annotated[
        float | None,
        Of("frequency", "frequency at which the stroke of the spool falls to -3 dB"),
    ] = None
    slew_rate: Annotated[
        float | None,
        Of("signal_rate", "fastest motion of the spool in volts of signal; default: no limit"),
    ] = None
    hysteresis: Annotated[
        float | None,
        Of(
            "hysteresis",
            "largest difference of the signals that give the same flow over a cycle, as a share of "
            "the full signal, in simulations",
        ),
    ] = None
    threshold: Annotated[
        float | None,
        Of(
            "threshold",
            "change of the signal that reverses the flow's change after a stop, as a share of the "
            "full signal, in simulations; default: hysteresis",
        ),
    ] = None
    spool: Spool | None = None

    @property
    def flow_table(self) -> FlowTable | None:
        """The table of `flow_curve`; raises `InputError` if its file was not read."""
        if self.flow_curve is None:
            return None
        return as_read(self.flow_curve, "valve.flow_curve").parsed(flow_table)
