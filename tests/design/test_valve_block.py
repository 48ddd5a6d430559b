"""The block `valve`: what can be stated, what is refused, and the numbers that follow."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.evaluation import spool
from actuator_opt.pages import valve as page
from actuator_opt.studies.plant import plant

KNEE = "designs/servo_knee.yaml"
LITRE, UM = 1 / 60000, 1e-6
SIZE = "rated_flow: 20 l/min"
SPEED = "natural_frequency: 120 Hz"


def design(tmp_path, *lines, spool_lines=()):
    """The servo knee with a valve of these lines."""
    with open(KNEE, encoding="utf-8") as file:
        text = file.read()
    block = "valve:\n" + "".join(f"  {line}\n" for line in lines)
    if spool_lines:
        block += "  spool:\n" + "".join(f"    {line}\n" for line in spool_lines)
    changed = re.sub(r"(?m)^valve:.*\n(?:  .*\n)+", lambda _: block, text)
    assert block in changed
    path = tmp_path / "valve.yaml"
    path.write_text(changed)
    return ao.read(path)


REFUSED = {
    "no size": ([SPEED], [], "valve.rated_flow: missing"),
    "no frequency": ([SIZE], [], "valve.natural_frequency: missing"),
    "lap beyond the stroke": (
        [SIZE, SPEED], ["type: lapped", "stroke: 0.5 mm", "overlap: 600 um"],
        "valve.spool.overlap: 0.6 mm: not less than the stroke of the spool (0.5 mm), so that the "
        "edge never opens; write less than 0.5 mm",
    ),
    "lap of one edge": (
        [SIZE, SPEED], ["type: lapped", "stroke: 0.5 mm", "bt: {overlap: -600 um}"],
        "valve.spool.bt.overlap: -0.6 mm: not less than the stroke of the spool (0.5 mm), so that "
        "the edge never closes",
    ),
    "gap beyond the stroke": (
        [SIZE, SPEED], ["type: lapped", "stroke: 0.1 mm", "clearance: 200 um"],
        "valve.spool.clearance: 0.2 mm: not less than the stroke",
    ),
    "no stroke": (
        [SIZE, SPEED], ["type: lapped", "overlap: 10 um"],
        "valve.spool.stroke: missing: required with overlap, clearance, leakage_flow or "
        "area_gradient; add",
    ),
    "two sizes": (
        [SIZE, SPEED], ["type: lapped", "stroke: 0.5 mm", "area_gradient: 12 mm"],
        "valve.spool.area_gradient: states the size of the edges a second time, beside "
        "valve.rated_flow; keep one of them",
    ),
    "two leakages": (
        [SIZE, SPEED, "leakage_flow: 0.2 l/min", "rated_viscosity: 32 mm^2/s"],
        ["type: lapped", "stroke: 0.5 mm", "clearance: 3 um"],
        "valve.spool.clearance: states the leakage a second time, beside valve.leakage_flow; keep",
    ),
    "leakage in any oil": (
        [SIZE, SPEED, "leakage_flow: 0.2 l/min"], ["type: lapped", "stroke: 0.5 mm"],
        "valve.rated_viscosity: missing: oil of the data sheet, required with leakage_flow",
    ),
    "leakage of an open centre": (
        [SIZE, SPEED, "leakage_flow: 0.2 l/min", "rated_viscosity: 32 mm^2/s"],
        ["type: lapped", "stroke: 0.5 mm", "overlap: -5 um"],
        "valve.leakage_flow: without effect on edges that are open at the centre",
    ),
    "leakage of unequal edges": (
        [SIZE, SPEED, "leakage_flow: 0.2 l/min", "rated_viscosity: 32 mm^2/s"],
        ["type: lapped", "stroke: 0.5 mm", "pa: {overlap: 5 um}"],
        "valve.spool.pa.overlap: edges that differ do not leak alike, as valve.leakage_flow says",
    ),
    "leakage of half the flow": (
        [SIZE, SPEED, "leakage_flow: 12 l/min", "rated_viscosity: 32 mm^2/s"],
        ["type: lapped", "stroke: 0.5 mm"],
        "valve.leakage_flow: 12 l/min: no clearance follows from it; write more than zero and "
        "less than 11.95 l/min",
    ),
    "leakage by the width": (
        [SPEED, "leakage_flow: 0.2 l/min"],
        ["type: lapped", "stroke: 0.5 mm", "area_gradient: 12 mm"],
        "valve.leakage_flow: needs valve.rated_flow with a lapped spool",
    ),
    "threshold and hysteresis": (
        [SIZE, SPEED, "hysteresis: 1 %", "threshold: 2 %"], [],
        "valve.threshold: 2 %: more than the hysteresis (1 %), which includes it; write at most",
    ),
    "coefficients and flow": (
        [SIZE, SPEED, "edge_coefficients: {pa: 3 l/min/sqrt(bar), pb: 3 l/min/sqrt(bar), "
         "at: 3 l/min/sqrt(bar), bt: 3 l/min/sqrt(bar)}"], [],
        "valve.edge_coefficients: states the size of the edges a second time, beside rated_flow",
    ),
    "coefficients of two edges": (
        [SPEED, "edge_coefficients: {pa: 3 l/min/sqrt(bar), pb: 3 l/min/sqrt(bar), "
         "at: 3 l/min/sqrt(bar)}"], [],
        "valve.edge_coefficients.bt: missing",
    ),
    "coefficients and drop": (
        [SPEED, "rated_drop: 30 bar", "edge_coefficients: {pa: 3 l/min/sqrt(bar), "
         "pb: 3 l/min/sqrt(bar), at: 3 l/min/sqrt(bar), bt: 3 l/min/sqrt(bar)}"], [],
        "valve.rated_drop: without effect with edge_coefficients",
    ),
    "leakage of coefficients": (
        [SPEED, "leakage_flow: 8 l/min", "edge_coefficients: {pa: 3 l/min/sqrt(bar), "
         "pb: 1 l/min/sqrt(bar), at: 3 l/min/sqrt(bar), bt: 3 l/min/sqrt(bar)}"], [],
        "valve.leakage_flow: 8 l/min: not less than the flow of the open valve at the same "
        "pressure drop; write less than 7.071 l/min",
    ),
    "coefficient without root": (
        [SPEED, "edge_coefficients: {pa: 3 l/min/bar, pb: 3 l/min/sqrt(bar), "
         "at: 3 l/min/sqrt(bar), bt: 3 l/min/sqrt(bar)}"], [],
        "valve.edge_coefficients.pa",
    ),
    "lap of the course's law": (
        [SIZE, SPEED], ["overlap: 10 um"],
        'valve.spool.overlap: without effect with type: course; write "type: lapped", or remove it',
    ),
    "corners without clearance": (
        [SIZE, SPEED], ["type: lapped", "stroke: 1 mm", "rounding: 2 um"],
        "valve.spool.rounding: without effect on edges without clearance",
    ),
    "two natural frequencies": (
        [SIZE, SPEED, "frequency_90deg: 110 Hz"], [],
        "valve.frequency_90deg: states the same as natural_frequency",
    ),
    "two dampings": (
        [SIZE, SPEED, "frequency_3db: 110 Hz", "damping_ratio: 0.8"], [],
        "valve.damping_ratio: follows from frequency_3db",
    ),
    "no second order": (
        [SIZE, SPEED, "frequency_3db: 200 Hz"], [],
        "valve.frequency_3db: 200 Hz: no spool of second order lags by 90 degrees at 120 Hz and "
        "falls to -3 dB only there; write less than 186.5 Hz",
    ),
    "falling curve": (
        [SIZE, SPEED],
        ["type: lapped", "curve: [{signal: 20 %, flow: 8 %}, {signal: 30 %, flow: 5 %}]"],
        "valve.spool.curve[1].flow: 5 %: less than the flow at a smaller signal (8 %); write at",
    ),
    "curve back and forth": (
        [SIZE, SPEED],
        ["type: lapped", "curve: [{signal: 20 %, flow: 8 %}, {signal: 15 %, flow: 9 %}]"],
        "valve.spool.curve[1].signal: 15 %: not between the signal before it (20 %) and 100 %",
    ),
    "curve and lap": (
        [SIZE, SPEED],
        ["type: lapped", "stroke: 1 mm", "overlap: 9 um", "curve: [{signal: 20 %, flow: 8 %}]"],
        "valve.spool.overlap: states the dead band a second time, beside the curve",
    ),
    "unknown law": ([SIZE, SPEED], ["type: laped"], "valve.spool.type"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_contradictions_are_refused_in_one_line(name, tmp_path):
    """Each fault names its place and its remedy, and nothing else is wrong."""
    lines, spool_lines, words = REFUSED[name]
    with pytest.raises(InputError) as caught:
        design(tmp_path, *lines, spool_lines=spool_lines)
    (fault,) = caught.value.diagnostics
    assert words in str(fault).replace("\n", " ")


def test_the_valve_of_a_load_cylinder_is_checked_too():
    """A load cylinder's valve without a size is refused at its own place."""
    from actuator_opt.design.scenario.faults import cross_field

    block = {"natural_frequency": 100.0}
    (fault,) = cross_field({"duration": 1.0, "load": {"cylinder": {"valve": block}}})
    assert fault.loc == ("load", "cylinder", "valve", "rated_flow")


@pytest.mark.parametrize("clearance", [None, "4 um"])
@pytest.mark.parametrize("overlap", [-20, 0, 30])
def test_every_edge_passes_the_rated_flow(clearance, overlap, tmp_path):
    """At full signal and the rated drop each edge passes its flow, whatever its lap."""
    lines = ["type: lapped", "stroke: 0.5 mm", f"overlap: {overlap} um", "pb: {flow_share: 50 %}",
             "at: {overlap: 5 um}"]  # fmt: skip
    lines += [] if clearance is None else [f"clearance: {clearance}"]
    own = plant(design(tmp_path, SIZE, SPEED, spool_lines=lines).subject()).valve
    from actuator_opt.models.metering_spool import spool_flows

    for signal in (10.0, -10.0):
        found = spool_flows(
            spool=own.metering, signal=signal, supply_pressure=70e5, return_pressure=0.0,
            pressure_a=35e5, pressure_b=35e5,
        )  # fmt: skip
        shares = (found.supply_a, found.b_tank) if signal > 0 else (found.a_tank, found.supply_b)
        half = 1.0 if signal > 0 else 0.5
        assert shares[0] == pytest.approx(20 * LITRE, rel=1e-9)
        assert shares[1] == pytest.approx(half * 20 * LITRE, rel=1e-9)


@pytest.mark.parametrize("overlap", [0, 20])
def test_clearance_follows_from_the_leakage(overlap, tmp_path):
    """At the drop and in the oil of the data sheet each edge leaks and opens as stated."""
    lines = ["type: lapped", "stroke: 0.5 mm", f"overlap: {overlap} um"]
    leak = ["leakage_flow: 0.15 l/min", "leakage_drop: 60 bar", "rated_viscosity: 30 mm^2/s"]
    own = plant(design(tmp_path, SIZE, SPEED, *leak, spool_lines=lines).subject())
    spool = own.valve.metering
    assert 1e-6 < spool.supply_a.clearance < 20e-6
    from actuator_opt.models.lapped_edge import lapped_edge_flow
    from actuator_opt.models.lapped_leakage import clearance_of_leakage

    oil = {"density": own.oil.density, "dynamic_viscosity": 30e-6 * own.oil.density,
           "flow_coefficient": spool.flow_coefficient}  # fmt: skip
    edge = {"clearance": spool.a_tank.clearance, "area_gradient": spool.a_tank.area_gradient} | oil
    leaks = lapped_edge_flow(uncovered=-overlap * UM, pressure_drop=60e5, **edge)
    opened = lapped_edge_flow(uncovered=0.5e-3 - overlap * UM, pressure_drop=35e5, **edge)
    assert leaks == pytest.approx(0.15 * LITRE, rel=1e-8)
    assert opened == pytest.approx(20 * LITRE, rel=1e-8)
    again = clearance_of_leakage(
        leakage=0.15 * LITRE, leakage_drop=60e5, overlap=overlap * UM, stroke=0.5e-3,
        rated_flow=20 * LITRE, rated_drop=35e5, **oil,
    )  # fmt: skip
    assert again == pytest.approx(spool.b_tank.clearance, rel=1e-12)


def test_flow_follows_a_stated_curve(tmp_path):
    """Points of the data sheet: 40 % of the signal gives 15 % of the rated flow, either way."""
    lines = ["type: lapped", "curve: [{signal: 5 %, flow: 0 %}, {signal: 40 %, flow: 15 %}]"]
    made = design(tmp_path, SIZE, SPEED, spool_lines=lines)
    own = plant(made.subject()).valve
    from actuator_opt.models.metering_spool import spool_flows

    for signal, share in ((4.0, 0.15), (-4.0, -0.15), (0.4, 0.0), (7.0, 0.575), (10.0, 1.0)):
        found = spool_flows(
            spool=own.metering, signal=signal, supply_pressure=70e5, return_pressure=0.0,
            pressure_a=35e5, pressure_b=35e5,
        )  # fmt: skip
        assert found.into_a == pytest.approx(share * 20 * LITRE, rel=1e-9, abs=1e-15)
    assert own.start(1.0) == pytest.approx(0.5)
    notes = [text for text in ao.evaluate(made).warnings if "dead band" in text]
    assert len(notes) == 1
    assert "0.05 of its full signal" in notes[0]


def test_stated_width_is_the_area_gradient(tmp_path):
    """K of an edge is C w (s - o) sqrt(2/rho), by hand."""
    lines = ["type: lapped", "stroke: 0.4 mm", "area_gradient: 15 mm", "flow_coefficient: 0.65",
             "overlap: 20 um"]  # fmt: skip
    own = plant(design(tmp_path, SPEED, spool_lines=lines).subject())
    edge, density = own.valve.metering.supply_a, own.oil.density
    from actuator_opt.models.lapped_edge import lapped_edge_flow

    flow = lapped_edge_flow(
        uncovered=0.4e-3 - edge.overlap, pressure_drop=50e5, area_gradient=edge.area_gradient,
        density=density, dynamic_viscosity=0.03,
        flow_coefficient=own.valve.metering.flow_coefficient,
    )  # fmt: skip
    by_hand = 0.65 * 15e-3 * 0.38e-3 * math.sqrt(2 * 50e5 / density)
    assert flow == pytest.approx(by_hand, rel=1e-5)


def test_an_ideal_spool_gives_the_course_without_leakage(tmp_path):
    """Zero lap without clearance: the loop of the course's law with K0 = 0."""
    found = [
        ao.evaluate(design(tmp_path, SIZE, SPEED, spool_lines=lines))
        for lines in ([], ["type: lapped"])
    ]
    for name in ("ultimate_gain", "bandwidth", "damping_ratio", "phase_margin"):
        assert found[1].metrics[name].value == pytest.approx(found[0].metrics[name].value, rel=1e-4)


@pytest.mark.parametrize(
    ("lines", "frequency", "damping"),
    [
        (["natural_frequency: 120 Hz"], 120.0, 0.7),
        (["frequency_90deg: 120 Hz", "damping_ratio: 0.9"], 120.0, 0.9),
        # |G| = 1/sqrt(2) at r = 1 for zeta = 1/sqrt(2)
        (["frequency_90deg: 120 Hz", "frequency_3db: 120 Hz"], 120.0, math.sqrt(0.5)),
        (["frequency_3db: 120 Hz", f"damping_ratio: {math.sqrt(0.5)}"], 120.0, math.sqrt(0.5)),
    ],
)
def test_frequency_response_of_a_data_sheet(lines, frequency, damping, tmp_path):
    """-90 degrees is the natural frequency; -3 dB gives the damping, or the other way round."""
    own = plant(design(tmp_path, SIZE, *lines).subject()).valve
    assert own.natural_frequency == pytest.approx(frequency, rel=1e-12)
    assert own.damping_ratio == pytest.approx(damping, rel=1e-12)
    read = {"natural_frequency": frequency, "damping_ratio": damping}.get
    assert spool.spool_motion(read) == pytest.approx((frequency, damping))


# ---- the study and its page ----


def test_null_coefficients_of_the_textbook(tmp_path):
    """Sharp edges: K_q0 = C w sqrt(p/rho) critical, twice that open; K_p0 = 2 p/U; parabola."""
    lines = ["type: lapped", "stroke: 0.5 mm", "area_gradient: 12 mm", "overlap: -20 um"]
    made = design(tmp_path, SPEED, spool_lines=lines)
    study = ao.evaluate(made).valve
    own, opened, critical, closed = study.curves
    pressure = study.supply_pressure - study.return_pressure
    density = plant(made.subject()).oil.density
    root = 0.611 * 12e-3 * math.sqrt(pressure / density)
    per_volt = 0.5e-3 / 10.0
    assert own.overlap == pytest.approx(opened.overlap)
    assert critical.flow_gain == pytest.approx(root * per_volt, rel=1e-4)
    assert own.flow_gain == pytest.approx(2 * root * per_volt, rel=1e-4)
    assert closed.flow_gain == 0
    assert own.pressure_gain == pytest.approx(2 * pressure / (20 * UM) * per_volt, rel=1e-3)
    assert critical.pressure_gain is None
    assert own.null_leakage == pytest.approx(2 * root * 20 * UM, rel=1e-4)
    x = np.clip(np.abs(study.signal) * per_volt, 0, 20 * UM)
    falls = 2 * root * ((20 * UM) ** 2 - x**2) / np.hypot(20 * UM, x)
    np.testing.assert_allclose(own.leakage, falls, atol=1e-4 * own.null_leakage)
    np.testing.assert_allclose(critical.leakage, 0, atol=1e-9 * own.null_leakage)


def test_leakage_of_a_critical_centre(tmp_path):
    """With clearance it leaks at most pi w c^2 p/(32 mu), the limit of viscous flow."""
    lines = ["type: lapped", "stroke: 0.5 mm", "area_gradient: 12 mm", "clearance: 1 um"]
    made = design(tmp_path, SPEED, spool_lines=lines)
    study, oil = ao.evaluate(made).valve, plant(made.subject()).oil
    pressure = study.supply_pressure - study.return_pressure
    viscous = math.pi * 12e-3 * UM**2 * pressure / (32 * oil.dynamic_viscosity)
    found = study.curves[0]
    assert 0.8 * viscous < found.null_leakage < viscous
    product = found.flow_pressure_coefficient * found.pressure_gain
    assert product == pytest.approx(found.flow_gain)


def test_report_shows_the_valve_only_with_a_stated_spool(tmp_path):
    """Figure and table for a stated spool, one curve for the course's law; else nothing."""
    assert page.valve_blocks(ao.evaluate(design(tmp_path, SIZE, SPEED))) == []
    course = ao.evaluate(
        design(tmp_path, SIZE, "leakage_flow: 0.2 l/min", SPEED, spool_lines=["type: course"])
    )
    figure, table = page.valve_blocks(course)
    assert [len(column[0].curves) for column in figure.columns] == [1, 1, 1]
    assert len(table.rows) == 1
    assert course.valve.curves[0].null_leakage == pytest.approx(
        2 * 0.2 * LITRE * math.sqrt((course.valve.supply_pressure - 5e5) / 2 / 50e5), rel=1e-3
    )
    made = ao.evaluate(
        design(tmp_path, SIZE, SPEED,
               spool_lines=["type: lapped", "stroke: 1 mm", "clearance: 3 um"])
    )  # fmt: skip
    _, table = page.valve_blocks(made)
    assert [row[0] for row in table.rows] == ["this valve", "open", "critical", "closed"]
    assert made.to_dict()["valve"]["curves"][1]["name"] == "open"
    assert "valve" not in ao.evaluate(ao.read(KNEE)).to_dict()


def test_a_lapped_spool_may_be_changed_by_a_program(tmp_path):
    """A changed design states its defaults; leakage of the other law is still refused."""
    lines = ["type: lapped", "stroke: 0.5 mm", "clearance: 3 um"]
    made = design(tmp_path, "rated_flow: 10 l/min", "natural_frequency: 120 Hz", spool_lines=lines)
    assert made.changed({"supply.pressure": 150e5}).design.supply.pressure == 150e5
    with pytest.raises(InputError, match="a second time"):
        made.changed({"valve.leakage_flow": "0.2 l/min"})
