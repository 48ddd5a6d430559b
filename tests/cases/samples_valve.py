"""Samples of the law tests for lapped spools and the motion of a spool; see `model_samples`."""

from __future__ import annotations

from dataclasses import replace

from actuator_opt.models.lapped_spool import LappedSpool, SpoolEdge
from actuator_opt.models.metering_curve import CurveEdge, CurveSpool, MeteringCurve

GAP = {"clearance": 3e-6, "rounding": 1e-6}
OIL = {"density": 870.0, "dynamic_viscosity": 0.03, "flow_coefficient": 0.62}
EDGE = {"pressure_drop": 6e6, "area_gradient": 0.02, **OIL}
PLACES = (-4e-5, -1e-6, 2e-6, 1e-4)
EDGES = [
    *({"uncovered": y, **GAP, **EDGE} for y in PLACES),
    *({"uncovered": y, "clearance": None, **EDGE} for y in (-4e-5, 1e-4)),
    {"uncovered": -4e-5, **GAP, **EDGE, "pressure_drop": -2e5},
]
OPEN, CLOSED = -2e-5, 3e-5


def spool(overlap, clearance=3e-6):
    """A spool with four edges that differ a little."""
    edges = (
        SpoolEdge(overlap + shift, 0.02 + 100 * shift, clearance, 1e-6)
        for shift in (0.0, 1e-6, 2e-6, -1e-6)
    )
    return LappedSpool(*edges, 1e-3, 10.0, 870.0, 0.03)


PRESSURES = {
    "supply_pressure": 14e6, "return_pressure": 4e5, "pressure_a": 8e6, "pressure_b": 6.2e6,
}  # fmt: skip
CURVED = replace(spool(0.0), curve=((0.1, 0.02), (0.6, 0.4)))
POINTS = (-0.5, 0.0, 0.05, 0.4, 1.0), (0.002, 0.004, 0.01, 0.3, 1.0)
CURVE = MeteringCurve.through(*POINTS)
EDGES_BY_CURVE = [CurveEdge(CURVE, k, 1e-10) for k in (3e-7, 2.5e-7, 2e-7, 3.5e-7)]
BY_CURVE = CurveSpool(*EDGES_BY_CURVE, 10.0)
SPOOLS = [spool(OPEN), spool(CLOSED), spool(0.0), spool(OPEN, None), spool(CLOSED, None)]
LAG = {
    "command": 3.0, "opening": 2.0, "rate": 900.0, "natural_frequency": 250.0,
    "damping_ratio": 0.7,
}  # fmt: skip

SAMPLES = {
    "lapped_edge.edge_gap": [{"uncovered": y, **GAP} for y in PLACES],
    "lapped_edge.lapped_edge_flow": EDGES,
    "lapped_edge.lapped_edge_conductance": EDGES,
    "lapped_edge.lapped_edge_gain": [*EDGES, {**EDGES[3], "opens": True}],
    "lapped_spool.spool_stroke": [
        *({"spool": SPOOLS[0], "signal": signal} for signal in (-3.0, 13.0)),
        *({"spool": CURVED, "signal": signal} for signal in (-3.0, 0.5, 9.0)),
    ],
    "lapped_spool.stroke_slope": [
        {"spool": one, "place": x} for one in (SPOOLS[0], CURVED) for x in (-1e-5, 2e-4)
    ],
    "metering_spool.spool_flows": [
        {"spool": one, "signal": signal, **PRESSURES}
        for one in (*SPOOLS, BY_CURVE)
        for signal in (-0.1, 4.0)
    ],
    "metering_spool.holding_stroke": [
        {"spool": one, "chamber": chamber, "into": 9e6, "out": 5e6, "lost": lost}
        for one in (*SPOOLS[:4], BY_CURVE)
        for chamber, lost in (("a", 1e-7), ("b", -1e-7))
    ],
    "metering_spool.held_slopes": [
        {"spool": one, "piston_leakage": 1e-13, **PRESSURES} for one in (*SPOOLS, CURVED, BY_CURVE)
    ],
    "metering_curve.monotone_slopes": [
        {"places": POINTS[0], "values": POINTS[1]},
        {"places": (0.0, 0.2, 0.3, 1.0), "values": (0.5, 0.1, 0.3, 0.4)},
        {"places": (0.0, 1.0), "values": (0.5, 0.1)},
    ],
    "metering_curve.curve_value": [{"curve": CURVE, "share": x} for x in (-0.7, -0.2, 0.3, 1.4)],
    "metering_curve.curve_slope": [
        {"curve": CURVE, "share": x, "opens": x > 0} for x in (-0.7, -0.2, 0.3, 1.4)
    ],
    "lapped_leakage.clearance_of_leakage": [
        {
            "leakage": 2e-6,
            "leakage_drop": 5e6,
            "overlap": overlap,
            "stroke": 5e-4,
            "rated_flow": 3e-4,
            "rated_drop": 3.5e6,
            "rounding": 1e-6,
            **OIL,
        }
        for overlap in (1e-6, 3e-5)
    ],
    "play.play_half_widths": {"hysteresis": 0.3, "threshold": 0.1},
    "play.play_rate": [
        {"command": u, "output": 1.0, "half_width": 0.1, "natural_frequency": 120.0}
        for u in (0.7, 1.05, 1.4)
    ],
    "play.band_of_position": {"signal_band": 0.3, "gain": 500.0},
    "valve.limited_spool_acceleration": [{**LAG, "fastest": r} for r in (4e2, 4e3)],
    "valve.spool_bandwidth": [{"damping_ratio": ratio} for ratio in (0.4, 0.9)],
    "valve.spool_damping": {"bandwidth": 0.9},
}
