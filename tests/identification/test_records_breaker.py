"""What broke `identify` and `calibrate` once: odd names, odd options, odd outcomes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases.digests import digest
from cli_runner import DESIGNS, KNEE, ROOT, run
from identification_case import identified
from test_calibration import changed, knee, rubbed

import actuator_opt as ao
from actuator_opt.identification import Record, calibration
from actuator_opt.identification.stribeck_fit import StribeckFit
from actuator_opt.studies.bench import bench

RECORD = DESIGNS / "records" / "knee_bench.csv"


def named(name):
    """The identification of plateaus under another name."""
    whole = identified("plateaus")
    return replace(whole, record=replace(whole.record, name=name))


@pytest.mark.long
@pytest.mark.parametrize("name", ["", " ", "x" * 300, "two\nlines.csv", "b\udce9d.csv", "a: b #c"])
def test_any_name_of_a_record_fits_a_design_and_a_page(name, tmp_path):
    """Empty, long, with control letters or bytes that are no UTF-8: written, read back, printed."""
    found = ao.calibrate(named(name), design=knee(), search=False)
    file = ao.save(found.actuator, tmp_path / "k.yaml")
    assert ao.read(file).design.measured == found.actuator.design.measured
    pytest.importorskip("typst")
    files = ao.write_calibration(found, folder=tmp_path)
    assert all(one.path.is_file() for one in files)


def test_a_record_that_parts_nothing_is_one_line():
    """No parameter known: nothing to calibrate, with the reasons."""
    whole = rubbed(changed(1.0, 2.0, 3e-3, 100.0))
    assert isinstance(whole.stribeck, StribeckFit)
    unknown = {
        name: one._replace(lower=-np.inf, upper=np.inf, standard_error=np.inf, identifiable=False)
        for name, one in whole.stribeck.parameters.items()
    }
    blind = replace(whole, stribeck=replace(whole.stribeck, parameters=unknown))
    with pytest.raises(ao.InputError, match="determines no parameter of the seals"):
        calibration(blind)


def test_what_is_not_identifiable_stays_as_stated():
    """Coulomb friction that is not parted from viscous leaves coefficient and ratio alone."""
    whole = rubbed(changed(1.0, 2.0, 3e-3, 100.0))
    parameters = dict(whole.stribeck.parameters)
    parameters["coulomb"] = parameters["coulomb"]._replace(
        lower=-5.0, upper=900.0, identifiable=False
    )
    found = calibration(replace(whole, stribeck=replace(whole.stribeck, parameters=parameters)))
    assert {"friction_coefficient", "breakaway_ratio", "stribeck_speed"} <= set(found.left)
    assert {path.rsplit(".", 1)[1] for path in found.values()} == {"viscous_friction"}


def test_a_value_no_design_can_state_is_left_with_its_reason():
    """A breakaway ratio of seven: the rest is learned, the reason names the range."""
    found = calibration(rubbed(changed(1.0, 2.0, 3e-3, 100.0)))
    whole = rubbed(changed(1.0, 2.0, 3e-3, 100.0))
    high = dict(whole.stribeck.parameters)
    static = high["static"]
    high["static"] = static._replace(**{k: 4 * v for k, v in static._asdict().items()
                                        if k not in ("identifiable",)})  # fmt: skip
    other = calibration(replace(whole, stribeck=replace(whole.stribeck, parameters=high)))
    assert "a design accepts 1 to 5" in other.left["breakaway_ratio"]
    for path in found.values():
        if not path.endswith("breakaway_ratio"):
            assert other.values()[path] == pytest.approx(found.values()[path])


def test_the_factor_is_the_ratio_said_and_its_bounds_hold_every_pressure():
    """Friction that pressure leaves alone: the means agree, the bounds hold both ends."""
    points = rubbed(changed(1.0, 2.0, 3e-3, 100.0), pressures=((10e5, 5e5),)).points
    flat = [one._replace(pressure_1=p, pressure=p) for p in (10e5, 120e5) for one in points]
    whole = identified("plateaus")
    from actuator_opt.identification.stribeck_fit import fit_stribeck

    own = bench(knee().subject())
    fit = fit_stribeck(flat, float(own.areas(np.float64(0.0))[0]))
    found = calibration(replace(whole, points=tuple(flat), stribeck=fit, lugre="none", bench=own))
    factor = next(one for one in found.learned if one.name == "friction_coefficient").known
    assert factor.value == pytest.approx(found.coulomb / found.stated, rel=1e-9)
    stated = [float(own.coulomb(one.pressure_1, one.pressure_2)) for one in flat]
    low, high = (found.coulomb / v for v in (max(stated), min(stated)))
    assert factor.lower <= 1.02 * low
    assert factor.upper >= 0.98 * high


def test_a_slow_speed_rests_on_the_designs_ratio_and_says_so():
    """One speed within the Stribeck rise: bounds allow for none, the doubt names the rise."""
    found = calibration(rubbed({}, speeds=(1e-3,)))
    factor = found.learned[0].known
    assert factor.value == pytest.approx(1.0, rel=1e-6)
    assert factor.upper > 1.5
    assert any("times its Coulomb part" in words for words in found.doubts)


def test_a_measured_coefficient_is_no_variable_any_more():
    """What was measured is held; the doubt says so, the search does not move it."""
    path = "seals.piston.friction_coefficient"
    text = KNEE.read_text(encoding="utf-8").replace(
        "variables:", f"variables:\n  {path}:\n    lower: 0.01\n    upper: 0.3"
    )
    found = ao.calibrate(identified("plateaus"), design=ao.read(text), search=False)
    assert path not in found.actuator.design.variables
    assert any("fixed at the measured value" in words for words in found.calibration.doubts)


@pytest.mark.parametrize("verb", ["identify", "calibrate"])
def test_nothing_that_is_read_is_written_over(verb, tmp_path):
    """The record and the design stay what they were."""
    record, design = tmp_path / "r.csv", tmp_path / "k.yaml"
    record.write_bytes(RECORD.read_bytes())
    design.write_bytes(KNEE.read_bytes())
    link = tmp_path / "link.csv"
    link.symlink_to(record)
    option = "--csv" if verb == "identify" else "--write"
    targets = [record, link] + ([design] if verb == "identify" else [])
    for target in targets:
        result = run(verb, str(record), "--design", str(design), option, str(target))
        assert result.code == 3
        assert "is an input and would be overwritten" in result.err
    assert digest(record) == digest(RECORD)
    assert digest(design) == digest(KNEE)


def test_options_without_use_for_a_bending_test_are_refused():
    """--span with what only friction needs: a usage error that names the options."""
    result = run("identify", str(RECORD), "--design", str(KNEE), "--span", "300 mm",
                 "--report", "--bootstrap", "100")  # fmt: skip
    assert result.code == 2
    assert "--report, --bootstrap" in result.err


def test_few_resamples_are_a_usage_error():
    """Fewer than have a tail: said before the work."""
    result = run("identify", str(RECORD), "--design", str(KNEE), "--bootstrap", "10")
    assert result.code == 2
    assert "use 80 or more" in result.err


def test_a_load_stated_twice_is_refused():
    """--load-force beside a column F_L."""
    result = run("identify", str(RECORD), "--design", str(KNEE), "--load-force", "1 kN")
    assert result.code == 3
    assert "F_L" in result.err


@pytest.mark.long
def test_a_record_from_standard_input():
    """`-` reads the record from a pipe, as designs do."""
    done = subprocess.run(
        [sys.executable, "-m", "actuator_opt", "identify", "-", "--design", str(KNEE), "--json"],
        input=RECORD.read_bytes(),
        capture_output=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        check=True,
    )
    assert json.loads(done.stdout)["record"] == "<stdin>"


def test_a_newline_in_a_path_stays_in_its_line():
    """One fault, one line."""
    result = run("identify", "none\nexist.csv", "--design", str(KNEE))
    assert result.code == 3
    assert len(result.err.strip().splitlines()) == 1


def test_a_part_that_is_none_is_refused():
    """The library checks what the terminal checks."""
    record = Record(np.arange(3.0), {"F_L": np.arange(3.0), "w": np.arange(3.0)})
    with pytest.raises(ao.InputError, match="write rod or barrel"):
        ao.bending(record, design=knee(), span=0.3, part="piston")


def test_stiffness_is_at_the_pressures_of_the_record():
    """Oil with air is soft at low pressure: the stiffness over time follows the chambers."""
    own = bench(knee().subject())
    low, high = (
        float(own.stiffness(np.array([0.05]), np.array([p]), np.array([p]))[0])
        for p in (5e5, 150e5)
    )
    assert low < 0.7 * high


def test_the_shipped_record_is_where_the_readme_says():
    """Both commands of the README name it; its first line says that it is synthetic."""
    assert RECORD.read_text(encoding="utf-8").startswith("# SYNTHETIC")
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert text.count(str(Path("designs/records/knee_bench.csv"))) >= 2


@pytest.mark.long
def test_weighted_objectives_are_compared_term_by_term():
    """A weighted sum has other divisors before and after: each metric is shown by itself."""
    text = KNEE.read_text(encoding="utf-8").replace(
        "minimise: mass", "minimise:\n    mass: 1\n    friction_running: 0.2"
    )
    design = ao.read(text)
    found = ao.calibrate(ao.identify(RECORD, design=design), design=design)
    goals = {one.metric: one for one in found.redesign.goals}
    assert set(goals) == {"mass", "friction_running"}
    best = found.redesign.best_after.evaluation.metrics
    assert all(goals[name].after == best[name].value for name in goals)
    (words,) = [one for one in found.redesign.sentences if one.startswith("the best design")]
    old = found.redesign.best_before.evaluation.metrics
    for name, one in goals.items():
        assert one.before == old[name].value
        was, now = (one.quantity.text(value, 5) for value in (one.before, one.after))
        assert (f"{name} stays {now}" if was == now else f"{name} {was} to {now}") in words
    assert set(found.to_dict()["optimum"]["objective"]) == set(goals)


def test_other_compounds_take_the_measured_friction_over_and_it_is_said():
    """Choices of compound keep the coefficient measured with one; a chosen coefficient is held."""
    text = KNEE.read_text(encoding="utf-8") + (
        "\nchoices:\n  seals.rod.compound: [nbr_70, nbr_90]\n"
        "  seals.rod.friction_coefficient: [0.1, 0.2]\n"
    )
    found = ao.calibrate(identified("plateaus"), design=ao.read(text), search=False)
    assert set(found.actuator.design.choices) == {"seals.rod.compound"}
    said = " ".join(found.calibration.doubts)
    assert "the choices allow: seals.rod.compound" in said
    assert "fixed at the measured value: seals.rod.friction_coefficient" in said
