"""Components for OpenMDAO: partials against differences, and a supply that shares the mass."""

from __future__ import annotations

import numpy as np
import pytest
from cli_runner import DESIGNS

import actuator_opt as ao

om = pytest.importorskip("openmdao.api", reason="OpenMDAO is not installed: extra openmdao")

from actuator_opt.openmdao import EvaluateComponent, OptimumComponent  # noqa: E402

KG = {"units": "kg"}
STEEL = DESIGNS / "steel_baseline.yaml"


def problem(component):
    """A set-up problem with one component."""
    model = om.Problem(reports=False)
    model.model.add_subsystem("knee", component, promotes=["*"])
    model.setup()
    return model


def test_metrics_and_their_partials():
    """Values equal those of the evaluation, partials central differences of it."""
    inputs = ["cylinder.bore", "supply.pressure", "load_cases[swing].force"]
    outputs = ["mass", "stiffness_min", "pull_force", "buckling_factor"]
    model = problem(EvaluateComponent(STEEL, inputs=inputs, outputs=outputs))
    model.run_model()
    design = ao.read(STEEL)
    evaluation = ao.evaluate(design)
    for metric in outputs:
        assert model.get_val(metric)[0] == pytest.approx(evaluation.metrics[metric].value)
    names = ["cylinder_bore", "supply_pressure", "load_cases_swing_force"]
    totals = model.compute_totals(of=outputs, wrt=names)
    for path, name in zip(inputs, names, strict=True):
        present = model.get_val(name)[0]
        for metric in outputs:
            ends = [
                ao.evaluate(ao.read(STEEL, set={path: present * (1 + s)})).metrics[metric].value
                for s in (-1e-5, 1e-5)
            ]
            slope = (ends[1] - ends[0]) / (2e-5 * present)
            scale = abs(evaluation.metrics[metric].value / present)
            assert totals[metric, name][0, 0] == pytest.approx(slope, rel=1e-4, abs=1e-7 * scale)


@pytest.mark.long
def test_the_best_supply_pressure_of_actuator_and_pump():
    """With a pump whose mass grows with pressure, the system's slope is price plus pump."""
    model = om.Problem(reports=False)
    actuator = OptimumComponent(STEEL, inputs=["supply.pressure", "cylinder.stroke"])
    model.model.add_subsystem("knee", actuator, promotes=["*"])
    pump = om.ExecComp("pump = 2e-8*supply_pressure", pump=KG, supply_pressure={"units": "Pa"})
    model.model.add_subsystem("pump", pump, promotes=["*"])
    total = om.ExecComp("system = mass + pump", **dict.fromkeys(["system", "mass", "pump"], KG))
    model.model.add_subsystem("total", total, promotes=["*"])
    model.model.set_input_defaults("supply_pressure", 20e6, units="Pa")
    model.setup()
    totals = []
    for pressure in (20e6, 20e6 * (1 + 1e-4), 20.5e6):
        model.set_val("supply_pressure", pressure)
        model.run_model()
        slopes = model.compute_totals(of=["system"], wrt=["supply_pressure", "cylinder_stroke"])
        totals.append((pressure, model.get_val("system")[0], slopes["system", "supply_pressure"]))
    (p0, m0, s0), (p1, m1, s1), _ = totals
    assert (m1 - m0) / (p1 - p0) == pytest.approx((s0[0, 0] + s1[0, 0]) / 2, rel=1e-3)
    assert slopes["system", "cylinder_stroke"][0, 0] > 0
    cold = ao.optimise(ao.read(STEEL, set={"supply.pressure": 20.5e6}), prices=False)
    assert totals[2][1] == pytest.approx(cold.objective_value + 0.41, rel=1e-6)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: EvaluateComponent(STEEL, inputs=[]), "name one or more"),
        (lambda: EvaluateComponent(STEEL, inputs=["cylinder.bor"]), "cylinder.bore"),
        (
            lambda: EvaluateComponent(STEEL, inputs=["cylinder.bore"], outputs=["mas"]),
            "mass",
        ),
        (
            lambda: EvaluateComponent(STEEL, inputs=["cylinder.bore"], outputs=["bandwidth"]),
            "has no value",
        ),
        (lambda: OptimumComponent(STEEL, inputs=["cylinder.bore"]), "free dimension"),
    ],
)
def test_refusals(make, said):
    """One line each, with the place."""
    with pytest.raises(ao.ActuatorError, match=said):
        make()


def test_no_design_for_these_inputs():
    """An impossible force is said, and not a number without meaning."""
    model = problem(OptimumComponent(STEEL, inputs=["load_cases[swing].force"]))
    model.set_val("load_cases_swing_force", 1e6)
    with pytest.raises(ao.ActuatorError, match="no design meets"):
        model.run_model()
    assert np.isfinite(model.get_val("load_cases_swing_force"))
