"""All rows of the page of validation: published values, statements, and second programs.

A value that deviates by more than its tolerance needs a reason, and one that does not must have
none; `tests/project/test_validation.py` and the build compare both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from . import validation_benchmarks, validation_papers
from .validation_rows import Agreement, Case, Claim

GROUPS: dict[str, Callable[[], Iterator[Case]]] = {
    "benchmarks": validation_benchmarks.benchmarks,
    "optimisation": validation_benchmarks.optima,
    "elasswad": validation_papers.elasswad,
    "aalto": validation_papers.thesis,
    "huang": validation_papers.plunger,
    "course": validation_papers.course,
    "foreign": validation_papers.foreign,
    "independent": validation_papers.independent,
}
"""Cases by the word of the directive."""

_HUANG = "tests/replicas/test_huang.py::"
CLAIMS = (
    Claim(
        "damping of the piston cylinder falls with speed", "{source}`Huang2017` figure 3",
        "falls at every pressure", f"{_HUANG}test_damping_falls_with_speed", True,
    ),
    Claim(
        "damping of the piston cylinder rises with pressure",
        "{source}`Huang2017` conclusion 2", "rises",
        f"{_HUANG}test_piston_cylinder_rises_with_pressure", True,
    ),
    Claim(
        "damping of the plunger falls with pressure", "{source}`Huang2017` section 2",
        "our films rise: equal flows leave the outer seal over 80 % of the pressure",
        f"{_HUANG}test_plunger_rises_too_because_the_yx_bears_the_pressure", False,
    ),
    Claim(
        "at high speed the damping tends to a constant", "{source}`Huang2017` figure 15",
        "by its own table 2 only from 19 to 129 times the fastest test on",
        "tests/replicas/test_huang_published.py::test_sigma2_is_reached_far_beyond_the_tests_only",
        False,
    ),
    Claim(
        "the pressure between the seals can exceed the sealed pressure",
        "{source}`Huang2017` section 3.2", "it does from 0.16 m/s on",
        f"{_HUANG}test_pressure_between_exceeds_the_sealed_one_when_fast", True,
    ),
    Claim(
        "beyond 5 MPa the largest contact stress of the step ring falls",
        "{source}`Huang2017` figure 17", "ours grows on; only its excess falls, after 6 MPa",
        f"{_HUANG}test_contact_over_pressure", False,
    ),
    Claim(
        "both damping laws have positive exponents", "{source}`Huang2017` section 2",
        "every fit over 0.5 to 10 mm/s has negative exponents",
        "tests/replicas/test_huang_published.py::test_both_laws_fit_with_falling_exponents", False,
    ),
    Claim(
        "the shear of the chamber can be neglected", "{source}`Huang2017` section 4",
        "41.72 N s/m is below 0.1 % of the seals",
        "tests/replicas/test_huang_published.py::test_chamber_shear_can_be_neglected", True,
    ),
    Claim(
        "soft to 15 Hz, more than doubled at 20 Hz, static at 30 Hz",
        "{source}`AaltoThesis` sections 4.2.2 and 5.2",
        "with a reducing valve of our numbers; constant line pressure shows no peak",
        "tests/replicas/test_aalto.py::test_the_reducing_valve_does_what_the_thesis_tells", True,
    ),
    Claim(
        "trapped air explains the static displacement in both directions",
        "{source}`AaltoThesis` figures 42 and 67",
        "upwards needs about 1 % of air, downwards 4 to 5 %; the stated bubbles fit neither",
        "tests/replicas/test_aalto.py::test_the_bubbles_fit_neither_reading", False,
    ),
    Claim(
        "the throttle at 75 % stiffens at 10 Hz and lowers the peak",
        "{source}`AaltoThesis` section 5.5", "the stated 0.22 cm² throttles nothing",
        "tests/replicas/test_aalto.py::test_the_stated_needle_throttles_nothing", False,
    ),
)  # fmt: skip
"""Statements of papers without a number of their own."""

AGREEMENTS = (
    Agreement(
        "exact tube: any lay-up, load, angle; all stresses and strains",
        "finite elements along the radius", "1e-8",
        "tests/models/test_layered_tube_oracle.py::test_any_lay_up_under_any_load",
    ),
    Agreement(
        "autofrettage of a wrapped liner", "incremental plastic finite elements",
        "5e-5 (1e-7 once yielded through); stresses 1e-3 of the yield strength",
        "tests/models/test_models_liner.py::test_incremental_solution",
    ),
    Agreement(
        "O-ring law: force and width, 3 %; peak, 6 %", "plane-strain finite elements", "3 %",
        "tests/models/test_models_seal_fit.py"
        "::test_the_default_law_is_within_3_percent_of_the_finite_elements",
    ),
    Agreement(
        "bending at a rigid clamp", "axisymmetric finite elements", "−20 to +25 %",
        "tests/models/test_end_bending.py::test_clamp_against_finite_elements",
    ),
    Agreement(
        "metal under the groove of a retaining ring", "axisymmetric finite elements",
        "at most 7 % below",
        "tests/models/test_retaining_ring.py::test_metal_under_the_groove_against_finite_elements",
    ),
    Agreement(
        "stepped column with shear, P/S up to 0.1", "Timoshenko columns by finite elements",
        "0.5 % (2 % at a fixed end)",
        "tests/models/test_models_rods_buckling.py::test_shear_of_a_stepped_column",
    ),
    Agreement(
        "servo in time: states, flows, energies", "a second simulator", "2e-6 of the span",
        "tests/simulation/test_simulation_oracle.py::test_run_is_that_of_the_oracle",
    ),
    Agreement(
        "dynamic stiffness of every circuit", "differential equations, rational arithmetic",
        "rounding",
        "tests/models/test_models_linear.py::test_dynamic_stiffness_to_the_last_digits",
    ),
    Agreement(
        "margins and bandwidth of the loop", "python-control", "1e-5",
        "tests/models/test_models_loop.py::test_margins_and_bandwidth_are_those_of_python_control",
    ),
    Agreement(
        "duty cycles: 200 random designs, every quantity", "a second program",
        "1e-6, largest found 2.2e-9",
        "tests/evaluation/test_duty_oracle.py::test_a_second_program_finds_the_same",
    ),
    Agreement(
        "rainflow cycles", "four-point rule on random histories", "equal",
        "tests/models/test_models_rainflow.py::test_equals_the_four_point_rule",
    ),
    Agreement(
        "steady temperatures of the wall", "radial finite volumes, 400 rings a layer", "1e-5",
        "tests/models/test_thermal_network.py::test_wall_is_that_of_radial_finite_volumes",
    ),
    Agreement(
        "bound of the certificate's relaxation", "an interior-point solver", "never above",
        "tests/optimisation/test_certificate_parts.py"
        "::test_bound_is_never_above_that_of_another_solver",
    ),
    Agreement(
        "recorded programs: values and gradients at 200 points", "the models", "rounding",
        "tests/evaluation/test_recorded_models.py::test_a_recorded_design_equals_its_models",
    ),
    Agreement(
        "drawing, mass model and STEP solids", "volumes read back", "1e-9",
        "tests/metrics/test_joints_sleeve.py::test_mass_section_and_step_agree",
    ),
)  # fmt: skip
"""Second programs that share no code with the package."""


def faults() -> list[str]:
    """Cases whose verdict does not fit their reason, one line each."""
    found = []
    for group, cases in GROUPS.items():
        for case in cases():
            if case.reproduced() == bool(case.why):
                words = "deviates without a reason" if not case.why else "is reproduced after all"
                found.append(f"{group}: {case.subject}: {words} ({case.deviation():+.3%})")
    return found
