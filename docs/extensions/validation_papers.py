"""Papers, foreign simulations and independent values beside ours."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from math import atan2, degrees, exp, hypot, pi
from pathlib import Path
from typing import Any

import numpy as np

from .validation_rows import Case

ROOT = Path(__file__).resolve().parents[2]


def elasswad() -> Iterator[Case]:
    """Numbers of Elasswad's work on a composite cylinder."""
    from actuator_opt.models import (
        barrel,
        damping,
        forces,
        friction,
        rod,
        seals,
        stiffness_published,
    )

    paper = "{source}`ElAsswad2018`"
    tests = "tests/models/test_models_hydraulics_published.py::test_elasswad_"
    area = float(forces.piston_area(bore=25e-3))
    ring = float(forces.annulus_area(bore=25e-3, rod_diameter=12e-3))
    chord = float(seals.width_as_published(section=2e-3, gland_height=1.7e-3))

    def oil(dead: float) -> float:
        return float(
            stiffness_published.oil_stiffness_as_published(
                bulk_modulus_a=8e8, bulk_modulus_b=8e8, area_a=area, area_b=ring,
                volume_a=area * 0.055 + dead, volume_b=ring * 0.055 + dead,
            )
        )  # fmt: skip

    def rubbing(pressure: float) -> float:
        return float(
            friction.coulomb_as_published(
                pressure=pressure, friction_coefficient=0.61, bore=25e-3, rod_diameter=12e-3,
                piston_contact_width=chord, rod_contact_width=chord,
            )
        )  # fmt: skip

    yield Case(
        "viscous damping at the stroke of the text, 150 mm, with 0.0265 Pa s",
        f"{paper} text on eq. 6", 0.1,
        lambda: damping.pipe_flow(dynamic_viscosity=0.0265, length=0.150),
        f"{tests}damping_means_a_viscosity", "N s/m", solved="the viscosity",
    )  # fmt: skip
    yield Case(
        "viscous damping at the stroke of table 1, 110 mm", f"{paper} table 1", 0.1,
        lambda: damping.pipe_flow(dynamic_viscosity=0.0265, length=0.110),
        f"{tests}damping_with_the_table_stroke", "N s/m",
        why="table and text state different strokes",
    )  # fmt: skip
    yield Case(
        "oil stiffness at mid-stroke, numbers of table 1", f"{paper} text on eq. 9", 2480.0,
        lambda: oil(0.0) / 1e3, f"{tests}published_oil_stiffness", "N/mm",
        why="eq. 9 with the paper's own table; nothing is said of line volumes",
    )  # fmt: skip
    yield Case(
        "oil stiffness at mid-stroke with 99 ml of line volume on each side",
        f"{paper} text on eq. 9", 2480.0,
        lambda: oil(99e-6) / 1e3, f"{tests}oil_stiffness_needs_99_ml", "N/mm", 0.02,
        solved="the line volume",
    )  # fmt: skip
    yield Case(
        "rod stiffness of eq. 8 with 13.06 GPa over 110 mm", f"{paper} text on eq. 8", 13430.0,
        lambda: float(
            rod.axial_stiffness_as_published(
                youngs_modulus=13.0625e9, outer_diameter=12e-3, length=0.11
            )
        )
        / 1e3,
        f"{tests}rod_stiffness_fixes_only_e_over_l", "N/mm", solved="the modulus",
    )  # fmt: skip
    yield Case(
        "rod stiffness with the published modulus of 3.48 GPa", f"{paper} text on eq. 8 and 13",
        13430.0,
        lambda: float(rod.axial_stiffness(youngs_modulus=3.48e9, outer_diameter=12e-3, length=0.11))
        / 1e3,
        f"{tests}rod_stiffness_fixes_only_e_over_l", "N/mm",
        why="the modulus of the bending test is not that behind the rod's stiffness",
    )  # fmt: skip
    grown = {
        "pressure": 1e6, "inner_radius": 12.5e-3, "outer_radius": 15e-3, "youngs_modulus": 3.48e9,
        "poissons_ratio": 0.3,
    }  # fmt: skip
    yield Case(
        "bore growth by eq. 12 as printed, k = 1.2, 1 MPa", f"{paper} eq. 12",
        float(barrel.bore_growth_as_published(**grown)) * 1e6,
        lambda: float(barrel.bore_growth(**grown)) * 1e6,
        "tests/models/test_models_structure_barrel.py"
        "::test_published_growth_is_wall_ratio_times_too_large",
        "µm", why="eq. 12 has the outer radius where theory has the inner radius",
    )  # fmt: skip
    compliance = 2 * pi * 12.5e-3 * 0.11 * float(barrel.bore_growth(**grown)) / 1e6
    yield Case(
        "expansion stiffness of the cylinder by eq. 10, 1 MPa", f"{paper} eq. 10", 4.46,
        lambda: area**2 / compliance / 1e3, f"{tests}cylinder_stiffness_against_compliance",
        "N/mm", why="Δp A/L is no stiffness: it grows with the pressure",
    )  # fmt: skip
    for force, loss in ((166.0, 0.12), (400.0, 0.31)):
        yield Case(
            f"pressure loss of {force:.0f} N on a bore of 25 mm", f"{paper} text on figure 11",
            loss, lambda f=force: float(forces.pressure_loss(friction=f, area=area)) / 1e6,
            f"{tests}friction_and_pressure_imply_another_area", "MPa",
            why="force and pressure imply an area of 1383 or 1290 mm², the bore has 491 mm²",
        )  # fmt: skip
    yield Case(
        "friction of eq. 15 to 20 with 0.61 at 0.12 MPa", f"{paper} text on figure 11", 166.0,
        lambda: rubbing(0.12e6), f"{tests}published_friction_coefficient", "N",
        why="the pressure that belongs to the coefficient is not stated",
    )  # fmt: skip
    yield Case(
        "friction of eq. 15 to 20 with 0.61 at 2.22 MPa", f"{paper} text on figure 11", 166.0,
        lambda: rubbing(2.22e6),
        f"{tests}published_friction_coefficient_needs_two_megapascal", "N", 0.01,
        solved="the pressure",
    )  # fmt: skip


@cache
def _aalto() -> Any:
    import actuator_opt as ao
    from actuator_opt.replicas import aalto_models

    design = ao.read(ROOT / "designs" / "aalto_40_25_220.yaml").design
    return design, aalto_models.static_test(design), aalto_models.dynamic_test(design)


def _moved(assumption: str, direction: str) -> float:
    """Largest displacement of an assumption over the positions of the thesis [mm]."""
    _, static, _ = _aalto()
    (found,) = [a for a in static.assumptions if a.name == assumption]
    return float(np.nanmax(getattr(found, direction).displacement)) * 1e3


def thesis() -> Iterator[Case]:
    """Numbers of the thesis of Aalto on a composite cylinder."""
    from actuator_opt.models import transmission_line

    thesis, tests = "{source}`AaltoThesis`", "tests/replicas/test_aalto.py::"
    yield Case(
        "plugged branch for 20 Hz at 1300 m/s", f"{thesis} eq. 18", 16.25,
        lambda: transmission_line.quarter_wave_length(frequency=20.0, sound_speed=1300.0),
        f"{tests}test_t_pipe_and_hose", "m",
    )  # fmt: skip
    yield Case(
        "stiffness of the load cell, 5 kN over 0.047 mm", f"{thesis} section 3.2", 106.0,
        lambda: _aalto()[0].stiffness.load_cell / 1e6,
        f"{tests}test_the_design_is_the_cylinder_of_the_thesis", "kN/mm",
        solved="the design file states the thesis' value",
    )  # fmt: skip
    yield Case(
        "Reynolds number of the needle at 20 mm/s", f"{thesis} section 3.3.3", 100.8,
        lambda: _aalto()[2].needle.reynolds, f"{tests}test_the_reynolds_number_means_a_viscosity",
        within=0.02, solved="the viscosity",
    )  # fmt: skip
    yield Case(
        "flow coefficient there, 'around 0.611'", f"{thesis} section 3.3.3", 0.611,
        lambda: _aalto()[2].needle.flow_coefficient,
        "tests/models/test_models_orifice.py::test_coefficient_at_the_thesis_reynolds_number",
        within=0.05,
    )  # fmt: skip
    yield Case(
        "pressure drop of the open needle at 20 mm/s, where the check valve opens",
        f"{thesis} section 3.3.5", 0.4, lambda: _aalto()[2].needle.drop / 1e5,
        f"{tests}test_the_needle_drops_far_less_than_was_measured", "bar",
        why="eq. 9 with the stated 0.22 cm²; a fifth of this area would drop 0.4 bar",
    )  # fmt: skip
    yield Case(
        "force on the chambers by the measured pressures, load up", f"{thesis} figure 41",
        (3400.0, 3500.0), lambda: _aalto()[1].up.force,
        f"{tests}test_the_by_pass_of_the_measured_pressures", "N",
        why="a quarter of the load goes past the chambers: seals and guides carry it",
    )  # fmt: skip
    yield Case(
        "force on the chambers by the measured pressures, load down", f"{thesis} figure 41",
        (4600.0, 5100.0),
        lambda: _aalto()[1].down.force, f"{tests}test_the_by_pass_of_the_measured_pressures", "N",
        why="a tenth of the load goes past the chambers",
    )  # fmt: skip
    yield Case(
        "largest displacement, load up, with fitted air", f"{thesis} figure 42", (0.20, 0.21),
        lambda: _moved("fitted air, by-pass", "up"),
        f"{tests}test_the_assumption_that_meets_the_largest", "mm", 0.02, solved="the air",
    )  # fmt: skip
    yield Case(
        "frequency of the stiffness peak, with a reducing valve of our numbers",
        f"{thesis} section 4.2.2", 20.0, lambda: _aalto()[2].peak.antiresonance_frequency[-1],
        f"{tests}test_the_peak_lies_at_20_hz", "Hz", 0.02, solved="the reducing valve",
    )  # fmt: skip
    yield Case(
        "stiffness of the rod chamber's barrel by eq. 23, over the correct value",
        f"{thesis} eq. 23", 1600 / 975, 1.0,
        "tests/models/test_models_hydraulics_stiffness.py"
        "::test_eq_23_is_too_stiff_by_the_area_ratio",
        why="the wall swells over the full bore, not over the annulus",
    )  # fmt: skip


def plunger() -> Iterator[Case]:
    """Numbers of Huang's paper on a plunger cylinder."""
    from actuator_opt.replicas import huang_published

    paper, tests = "{source}`Huang2017` section 2", "tests/replicas/test_huang_published.py::"
    first, *_, last = huang_published.friction.HUANG_TABLE_2

    def damping(row: Any, speed: float) -> float:
        return float(huang_published.secant_of(row, speed)) / 1e6

    for row, value in ((first, 0.65), (last, 0.2)):
        mega = f"{row.pressure / 1e6:.1f} MPa"
        yield Case(
            f"damping of the seals at {mega} and 2.1 mm/s, by table 2", paper, value,
            lambda row=row: damping(row, 2.1e-3),
            f"{tests}test_the_printed_fall_holds_near_two_millimetres_per_second_only", "MN s/m",
            0.15, solved="the speed",
        )  # fmt: skip
        yield Case(
            f"damping of the seals at {mega} and 0.5 mm/s, by table 2", paper, value,
            lambda row=row: damping(row, 0.5e-3),
            f"{tests}test_the_printed_fall_fails_over_the_tested_speeds", "MN s/m", 0.15,
            why="the printed pair of values has no speed; table 2 has it near 2.1 mm/s only",
        )  # fmt: skip
    yield Case(
        "gap behind the chamber's 41.72 N s/m, with 560 mm and 0.043 Pa s, 'fairly large'",
        "{source}`Huang2017` section 4", 1.0,
        lambda: huang_published.plausible_chamber().gap * 1e3,
        f"{tests}test_chamber_shear_needs_a_narrow_gap", "mm",
        why="the paper states no inputs; 1 mm would need 2.5 m of plunger",
    )  # fmt: skip


def course() -> Iterator[Case]:
    """Numbers of course slides and exercises."""
    from actuator_opt.models import friction, wilson
    from actuator_opt.models.valve import edge_coefficient, valve_flows, viscosity_corrected

    slides = "{source}`MECE5005`"
    k10 = edge_coefficient(flow=40 / 60000, pressure_drop=35e5)
    k0 = edge_coefficient(flow=0.45 / 60000, pressure_drop=50e5)

    def flow(name: str, signal: float, supply: float, port: float) -> float:
        found = valve_flows(
            signal=signal, rated_coefficient=k10, leakage_supply=k0, leakage_tank=k0,
            full_signal=10.0, supply_pressure=supply, return_pressure=0.0, pressure_a=port,
            pressure_b=port,
        )  # fmt: skip
        return float(getattr(found, name)) * 60000

    servo = "tests/models/test_models_servo.py::"
    full = "70 bar supply, ports at 35 bar, 10 V"
    yield Case(
        f"{full}: flow into A", f"{slides} valve", 39.62, lambda: flow("into_a", 10.0, 70e5, 35e5),
        f"{servo}test_full_signal_check_values", "l/min",
    )  # fmt: skip
    yield Case(
        f"{full}: flow of the supply", f"{slides} valve", 40.38,
        lambda: flow("supply", 10.0, 70e5, 35e5), f"{servo}test_full_signal_check_values", "l/min",
    )  # fmt: skip
    yield Case(
        "100 bar, blocked ports, 0 V: leakage", f"{slides} valve", 0.9,
        lambda: flow("supply", 0.0, 100e5, 50e5),
        f"{servo}test_blocked_ports_rest_where_the_leakages_agree", "l/min",
    )  # fmt: skip
    yield Case(
        "pressure drop at twice the viscosity, same flow", f"{slides} viscosity", 1.189,
        lambda: float(
            viscosity_corrected(coefficient=1.0, rated_viscosity=32e-6, viscosity=64e-6)
        ) ** -2,
        f"{servo}test_viscosity_check_values",
    )  # fmt: skip
    motor = {
        "speed": 1000 / 60 * 2 * pi, "pressure_difference": 100e5, "displacement": 13.3e-6,
        "dynamic_viscosity": 32e-6 * 870,
    }  # fmt: skip
    losses = {"coulomb_coefficient": 0.16, "viscous_coefficient": 100e3, "constant_torque": 0.1}
    machine = "tests/models/test_models_machines.py::test_motor_at_1000_rpm_and_100_bar"
    yield Case(
        "motor at 1000 rpm and 100 bar: flow", f"{slides} pumps and motors", 20.14,
        lambda: float(wilson.motor_flow(**motor, slip_coefficient=150e-9)) * 60000, machine,
        "l/min",
    )  # fmt: skip
    yield Case(
        "motor at 1000 rpm and 100 bar: torque", f"{slides} pumps and motors", 17.06,
        lambda: float(wilson.motor_torque(**motor, **losses)), machine, "N m",
    )  # fmt: skip
    yield Case(
        "Stribeck curve at 40 mm/s", f"{slides} friction, by hand", 500 + 500 * exp(-4) + 40,
        lambda: float(
            friction.stribeck(
                speed=0.04, coulomb=500.0, static=1000.0, stribeck_speed=0.02, exponent=2.0,
                viscous=1000.0,
            )
        ),
        "tests/models/test_models_hydraulics_friction.py::test_stribeck_check_values", "N", 1e-6,
    )  # fmt: skip


# ---- foreign simulations ----


@cache
def _simulation(name: str) -> Any:
    import actuator_opt as ao

    return ao.simulate(ao.read_scenario(ROOT / "designs" / "scenarios" / f"{name}.yaml"))


def _named(rows: Iterable[Any]) -> Iterator[tuple[str, Any]]:
    """Rows with a subject of their own: "same" stands for that of the row before."""
    subject = ""
    for row in rows:
        subject = f"{subject}{row.subject[4:]}" if row.subject[:4] == "same" else row.subject
        yield subject, row


def foreign() -> Iterator[Case]:
    """Numbers of foreign simulations."""
    from actuator_opt.replicas import exudyn, fossee

    cases = "tests/replicas/test_published_cases.py::"
    source = "{source}`Exudyn2022`"
    for subject, row in _named(exudyn.end_values(_simulation("exudyn_arm"))):
        yield Case(
            f"arm of EXUDYN at 0.4 s: {subject}", f"{source}, {row.place}", row.published,
            row.ours, f"{cases}test_the_end_is_that_of_exudyn_but_for_its_steps", row.unit,
        )  # fmt: skip
    for name, words in (("exudyn_arm", "arm"), ("exudyn_press", "press")):
        for signal, residual in exudyn.compared(_simulation(name)).residuals.items():
            share = residual.largest / residual.span
            label = signal.replace("_a", " A").replace("_b", " B")
            yield Case(
                f"{words}, every sample: 1 − largest difference of the {label}/span",
                f"{source}, steps of 10 µs", 1.0, 1 - share,
                f"{cases}test_the_{words}_is_that_of_exudyn", agreement=True,
            )  # fmt: skip
    for subject, row in _named(fossee.values(_simulation("textbook_servo"))):
        yield Case(
            f"textbook servo: {subject}", f"{{source}}`FOSSEE788` example {row.place}",
            row.published, row.ours, f"{cases}test_the_servo_is_that_of_the_textbook", row.unit,
            0.01,
        )  # fmt: skip


# ---- independent check values ----


def independent() -> Iterator[Case]:
    """Numbers of collections that others made or that the project made apart."""
    from actuator_opt.models import forces
    from actuator_opt.models.line_ends import LineEnd
    from actuator_opt.models.linear import Side, dynamic_stiffness, linear_actuator
    from actuator_opt.replicas import aalto_models

    own = "own calculation, written apart"
    area_a = float(forces.piston_area(bore=32e-3))
    area_b = float(forces.annulus_area(bore=32e-3, rod_diameter=18e-3))

    @cache
    def stiffness(frequency: float, leak: float) -> tuple[float, float]:
        sides = [
            Side(area=a, compliance=(8e-6 + a * 0.08) / 1.4e9, end=LineEnd((leak,)))
            for a in (area_a, area_b)
        ]
        model = linear_actuator(side_a=sides[0], side_b=sides[1], mass=30.0, damping=400.0)
        k = dynamic_stiffness(model=model, frequency=frequency)
        return hypot(k.real, k.imaginary) / 1e6, degrees(atan2(k.imaginary, k.real))

    test = "tests/models/test_models_linear.py::test_dynamic_stiffness_check_values"
    for f, leak, size in ((10, 0.0, 20.5399), (40, 0.0, 18.7636), (10, 2e-11, 2.95833),
                          (40, 2e-11, 9.51768)):  # fmt: skip
        ends = "leaking" if leak else "closed"
        yield Case(
            f"cylinder 32/18-160, {ends} ports, {f} Hz: dynamic stiffness", own, size,
            lambda f=f, leak=leak: stiffness(f, leak)[0], test, "MN/m", 1e-5,
        )  # fmt: skip

    def aalto(hoses: bool, chamber: bool) -> Any:
        design = _aalto()[0]
        lines = design.lines if hoses else aalto_models.pipes(design)
        found = aalto_models.total(design, lines, 1300e6 if hoses else 1600e6)
        return (found.per_chamber_at if chamber else found.published_at) / 1e6

    figures = "tests/replicas/test_aalto.py::"
    for subject, test, row, values in (
        ("eq. 37 as printed", "test_figure_29", (False, False), (56.0, 19.5, 42.8)),
        ("eq. 38 as printed", "test_figure_32", (True, False), (20.5, 11.33, 12.4)),
        ("eq. 38 per chamber", "test_figure_32", (True, True), (20.1, 11.20, 11.0)),
    ):
        for k, value in enumerate(values):
            yield Case(
                f"cylinder 40/25-220, {subject}, at {(5, 110, 215)[k]} mm", own, value,
                lambda k=k, row=row: float(aalto(*row)[k]), figures + test, "MN/m",
            )  # fmt: skip
