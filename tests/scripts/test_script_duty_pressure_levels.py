"""The study of pressure levels: masses that can be checked, and the effect of a longer mission."""

from __future__ import annotations

import pytest
from script_loader import ran, script

import actuator_opt as ao

study = script("duty_pressure_levels")


def entry(mission, *, mass, pressure, energy):
    """A row of the study."""
    values = {
        "supply.pressure": pressure, "cylinder.bore": 0.02, "linkage.crank_radius": 0.045,
        "valve.rated_flow": 1.5e-4,
    }  # fmt: skip
    return {
        "mission": mission, "mass": mass, "system_mass": 5.0, "status": "optimal",
        "values": values, "energy": energy, "leakage": 20.0,
    }  # fmt: skip


def test_table_and_sentences_of_numbers():
    """Rows by mission, in the units of their heads; the last sentence compares both ends."""
    long = entry(7200.0, mass=0.15, pressure=140e5, energy=320.0)
    short = entry(600.0, mass=0.13, pressure=150e5, energy=400.0)
    numbers = {"version": "0", "rows": [long, short]}
    table = study.table_rows(numbers)
    assert table[1][:8] == ["10", "5.000", "130.0", "150.0", "20.00", "45.0", "9.00", "400.0"]
    assert table[2][0] == "120"
    last = study.lead(numbers)[-1]
    assert last.startswith("From 10 to 120 min the pressure goes from 150.0 to 140.0 bar")
    assert len(study.lead({"version": "0", "rows": [long]})) == 2


def test_the_mission_is_all_that_is_changed():
    """Besides the objective; a start moves values only."""
    shipped = ao.read(study.DESIGN).design
    asked = study.asked(240, {"supply.pressure": 145e5}).design
    assert asked.duty.supply.mission_time == pytest.approx(4 * 3600)
    assert asked.objective.minimise == "system_mass"
    assert asked.supply.pressure == 145e5
    for block in ("linkage", "valve", "load_cases", "requirements", "cylinder"):
        assert getattr(asked, block) == getattr(shipped, block), block


@pytest.mark.long
def test_the_script_as_a_person_runs_it(tmp_path):
    """The optimum of an hour is lighter in all than that of least mass of the knee alone."""
    out, report = ran("duty_pressure_levels", tmp_path)
    assert report.exists()
    assert "optimal" in out
    (row,) = study.compute(quick=True)["rows"]
    lightest = ao.optimise(study.DESIGN, starts=1, prices=False)
    assert row["mass"] > lightest.objective_value
    assert row["system_mass"] < lightest.evaluation.metrics["system_mass"].value
