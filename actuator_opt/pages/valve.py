"""The valve about its null in a report: no-load flow, load pressure and leakage over the signal."""

from __future__ import annotations

import numpy as np

from ..base.quantities import INPUTS, SCENARIOS
from ..evaluation.result import Evaluation
from ..evaluation.valve_study import ValveCurve, ValveStudy
from ..models.play import band_of_position
from ..rendering import text
from ..rendering.blocks import Block, Cell, Chart, Column, Table
from ..rendering.chart import Axis, Curve, Panel
from ..rendering.text import DASH

HEIGHT = 62.0
"""Height of the figure [mm]."""
OWN, CENTRES = 0, {"open": 1, "critical": 2, "closed": 3}
"""Styles of the curves."""
FLOW, PRESSURE = SCENARIOS["flow_value"], INPUTS["pressure"]
SIGNAL, POSITION = SCENARIOS["signal_value"], INPUTS["stop_travel"]
CONDUCTANCE, OVERLAP = INPUTS["conductance"], INPUTS["spool_overlap"]


def valve_blocks(evaluation: Evaluation) -> list[Block]:
    """All blocks on the valve; empty if the design does not state its spool."""
    study = evaluation.valve
    if study is None:
        return []
    valve = evaluation.design.valve
    whole = valve is not None and valve.flow_curve is not None
    title = "Valve over its whole signal" if whole else "Valve about its null"
    blocks = [_figure(study, title), _table(study)]
    return blocks if study.hysteresis is None else [*blocks, _hysteresis(study)]


def _figure(study: ValveStudy, title: str) -> Block:
    lap = max((abs(curve.overlap or 0.0) for curve in study.curves[1:]), default=0.0)
    note = (
        f'Supply at {PRESSURE.text(study.supply_pressure)}, oil of load case "{study.case}". Flow: '
        "ports A and B joined, without load. Load pressure and leakage: both ports blocked."
    )
    if lap:
        note += (
            f" For comparison, the same spool with open ({text.value_text(OVERLAP, -lap)}), "
            f"critical, and closed ({text.value_text(OVERLAP, lap)}) centre."
        )
    return Chart(title, panels(study), note, height=HEIGHT)


def panels(study: ValveStudy) -> list[Panel]:
    """No-load flow, load pressure and leakage over the signal."""
    return [
        _panel(study, "No-load flow, l/min", "flow", FLOW.to_display(1.0), named=True),
        _panel(study, "Load pressure, bar", "load_pressure", PRESSURE.to_display(1.0)),
        _panel(study, "Leakage, l/min", "leakage", FLOW.to_display(1.0)),
    ]


def _panel(
    study: ValveStudy, title: str, values: str, scale: float, *, named: bool = False
) -> Panel:
    curves = [
        Curve(
            curve.name if named else "",
            study.signal,
            scale * np.asarray(getattr(curve, values)),
            style=CENTRES.get(curve.name, OWN),
            weight="normal" if curve.name not in CENTRES else "thin",
        )
        for curve in _shown(study)
    ]
    ends = float(study.signal[0]), float(study.signal[-1])
    return Panel(
        title, Axis("signal from the centre, V", range=ends), Axis(zero=True), curves=curves
    )


def _shown(study: ValveStudy) -> list[ValveCurve]:
    """The textbook's centres, with this valve drawn last, on top of them."""
    return [*study.curves[1:], study.curves[0]]


def _hysteresis(study: ValveStudy) -> Block:
    """Hysteresis and threshold, with the bands of position that they leave."""
    assert study.hysteresis is not None
    assert study.threshold is not None
    gain = study.position_gain

    def row(name: str, volts: float) -> list[Cell]:
        band = None if gain is None else float(band_of_position(signal_band=volts, gain=gain))
        return [
            name,
            text.value_text(SIGNAL, volts),
            DASH if band is None else text.value_text(POSITION, band),
        ]

    columns = [
        Column("", "left", 1.0),
        Column("signal", "right", 1.0),
        Column("position", "right", 1.0),
    ]
    note = (
        "Position: signal divided by the gain of the position loop. With the hysteresis, the loop "
        "stops within this band; a reversal within the threshold has no effect. Gain and phase "
        "margins leave out both; a simulation includes them."
    )
    rows = [row("hysteresis", study.hysteresis), row("threshold", study.threshold)]
    return Table("Valve: hysteresis and threshold", columns, rows, note=note)


def _table(study: ValveStudy) -> Block:
    def row(curve: ValveCurve) -> list[Cell]:
        gain, leaks = curve.pressure_gain, curve.flow_pressure_coefficient
        overlap = DASH if curve.overlap is None else text.value_text(OVERLAP, curve.overlap)
        return [
            curve.name,
            overlap,
            text.number(FLOW.to_display(curve.flow_gain)),
            DASH if gain is None else text.number(PRESSURE.to_display(gain)),
            DASH if leaks is None else text.number(CONDUCTANCE.to_display(leaks)),
            text.number(FLOW.to_display(curve.null_leakage)),
        ]

    columns = [
        Column("centre", "left", 1.0),
        Column("overlap", "right", 0.8),
        Column("flow gain, l/min/V", "right", 1.0),
        Column("pressure gain, bar/V", "right", 1.0),
        Column("K_c0, ml/min/bar", "right", 1.0),
        Column("leakage, l/min", "right", 1.0),
    ]
    note = (
        "At the null, with both directions averaged. A valve that does not leak has no pressure "
        "gain there: any signal brings the full pressure."
    )
    return Table("Valve: null coefficients", columns, [row(c) for c in study.curves], note=note)
