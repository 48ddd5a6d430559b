"""The oil of an evaluation: its laws, its limits, what the library lacks, its table and figure.

Expected values are the check values of the generic mineral oil, closed forms written out here, and
steam tables; never our own output.
"""

from __future__ import annotations

import math
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from cases.digests import digests
from cli_runner import bench, evaluated, refused, run
from hypothesis import given, strategies as st

import actuator_opt as ao
from actuator_opt.design.materials import load_library
from actuator_opt.evaluation import compute, state
from actuator_opt.pages.material import fluid_figure

KNEE = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"
FLUIDS = load_library().names(kind="fluid")
WARM, P_AIR = 313.15, 101325.0


def of(name, **choices):
    """An oil of the library with the laws chosen."""
    return state.alone(load_library().get(name), **choices)


def state_of(**changes):
    """Load-case quantities of the knee with keys of `fluid` or other PATHs replaced."""
    sets = {path.replace("__", "."): value for path, value in changes.items()}
    subject = ao.read(KNEE, set=sets).subject()
    return compute(subject, subject.values())


# --- laws ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("law", "bar", "expected"),
    [
        ("tait", 1, 1367), ("tait", 200, 1582), ("tait", 350, 1743),  # generic oil at 40 degC
        ("linear", 0, 1367), ("linear", 200, 1367 + 10.8 * 20), (None, 200, 1367 + 10.8 * 20),
        ("constant", 0, 1367), ("constant", 350, 1367),
    ],
)  # fmt: skip
def test_bulk_modulus_without_air(law, bar, expected):
    """Tait by its published table; linear and constant by hand from 1367 MPa and slope 10.8."""
    modulus = state.pure_bulk_modulus(*of("iso_vg_32", bulk_modulus_law=law), WARM, bar * 1e5)
    assert modulus / 1e6 == pytest.approx(expected, abs=0.55)


def test_the_default_law_is_linear_and_the_same_to_the_last_bit():
    """Without a stated law: K_ref e^(b (T_ref - T)) + m p, then [AaltoThesis] eq. 5."""
    for temperature, p in ((300.0, 20e5), (WARM, 105e5), (350.0, 0.0)):
        k = 1367e6 * np.exp(0.0058 * (313.15 - temperature)) + 10.8 * p
        r = 0.005 * (P_AIR / (p + P_AIR)) ** (1 / 1.4)
        expected = k * (1 + r) / (1 + r * k / (1.4 * (p + P_AIR)))
        assert state.bulk_modulus(*of("iso_vg_32"), temperature, p) == expected


def test_each_oil_of_a_paper_keeps_its_constant():
    """800 MPa of [ElAsswad2018] and 1600 MPa of [AaltoThesis] at every pressure and temperature."""
    for name, expected in (("elasswad2018_oil", 800e6), ("aalto_thesis_oil", 1600e6)):
        for temperature, pressure in ((280.0, 0.0), (350.0, 300e5)):
            assert state.pure_bulk_modulus(*of(name), temperature, pressure) == expected


@pytest.mark.parametrize("law", ["constant", "linear", "tait"])
@pytest.mark.parametrize("temperature", [280.0, WARM, 350.0])
def test_density_follows_the_bulk_modulus_of_its_law(law, temperature):
    """K = rho dp/drho by central difference, in every law; at p = 0 the thermal density."""
    given_oil, p, h = of("iso_vg_46", bulk_modulus_law=law), 180e5, 1e4
    low, rho, high = (state.oil_density(*given_oil, temperature, q) for q in (p - h, p, p + h))
    modulus = state.pure_bulk_modulus(*given_oil, temperature, p)
    assert modulus == pytest.approx(rho * 2 * h / (high - low), rel=1e-6)
    thermal = 875.0 / (1 + 7.7e-4 * (temperature - 288.15))
    assert state.oil_density(*given_oil, temperature) == pytest.approx(thermal, rel=1e-12)
    assert state.oil_density(*given_oil, temperature, 0.0) == pytest.approx(thermal, rel=1e-12)


def test_viscosity_under_pressure():
    """VG 32 at 60 degC, alpha 20/GPa of the table: Barus and Roelands written out."""
    rho = 870 / (1 + 7.7e-4 * (333.15 - 288.15))
    eta = rho * 15.13e-6  # ASTM D341 through 32 and 5.36 mm2/s
    p, alpha = 300e5, 20e-9
    size = math.log(eta) + 9.67
    growth = (1 + p / 1.96e8) ** (alpha / (5.1e-9 * size)) - 1
    for law, expected in (
        ("none", eta),
        ("barus", eta * math.exp(alpha * p)),
        ("roelands", eta * math.exp(size * growth)),
        (None, eta * math.exp(size * growth)),
    ):
        found = state.dynamic_viscosity(*of("iso_vg_32", viscosity_pressure=law), 333.15, p)
        assert found == pytest.approx(expected, rel=5e-4)  # the curve is given to four digits


def test_the_coefficient_of_viscosity_lies_between_its_temperatures():
    """28/GPa at 30 and 20/GPa at 60 degC are 24/GPa at 45 degC; 28/GPa holds below 30 degC."""
    for celsius, alpha in ((45, 24e-9), (10, 28e-9)):
        given_oil = of("iso_vg_32", viscosity_pressure="barus")
        ratio = [state.dynamic_viscosity(*given_oil, celsius + 273.15, p) for p in (0.0, 100e5)]
        assert ratio[1] / ratio[0] == pytest.approx(math.exp(alpha * 100e5), rel=1e-9)


@given(st.sampled_from(FLUIDS), st.floats(0, 340e5), st.floats(1e5, 100e5))
def test_pressure_never_thins_and_never_softens(name, pressure, step):
    """Viscosity, density and bulk modulus rise (or stay) with pressure in every oil."""
    given_oil = of(name)
    for quantity in (state.dynamic_viscosity, state.oil_density, state.bulk_modulus):
        low = quantity(*given_oil, WARM, pressure)
        assert quantity(*given_oil, WARM, pressure + step) >= low * (1 - 1e-12)


@given(st.sampled_from(FLUIDS), st.floats(0, 500e5), st.floats(0, 0.1))
def test_more_air_is_never_stiffer(name, pressure, air):
    """Air softens every oil at every pressure."""
    more, some, none = (
        float(state.bulk_modulus(*of(name, air_content=share), WARM, pressure))
        for share in (air + 0.01, air, 0.0)
    )
    assert more < some <= none


@pytest.mark.parametrize("name", FLUIDS)
def test_slow_air_is_softer_only_at_low_pressure(name):
    """Gas of compliance (p_a/p)^(1/n)/(n p): n = 1 is softer than 1.4 up to p/p_a = 1.4^3.5."""
    turn = 1.4**3.5 * P_AIR - P_AIR
    for pressure, softer in ((0.9 * turn, True), (1.1 * turn, False), (100e5, False)):
        fast, slow = (
            state.bulk_modulus(*of(name, polytropic_index=n), WARM, pressure) for n in (1.4, 1.0)
        )
        assert (slow < fast) == softer


@pytest.mark.parametrize(
    "choice", [{"bulk_modulus_law": "tait"}, {"viscosity_pressure": "barus"}, {}]
)
def test_laws_differentiate_by_complex_step(choice):
    """Slopes by temperature and pressure against central differences."""
    given_oil, at = of("iso_vg_68", **choice), (330.0, 150e5)
    for quantity in (state.dynamic_viscosity, state.oil_density, state.bulk_modulus):
        for i, h in enumerate((1e-3, 1e3)):
            up, down, tilted = ([*at] for _ in range(3))
            up[i], down[i], tilted[i] = at[i] + h, at[i] - h, at[i] + 1e-30j
            slope = np.imag(quantity(*given_oil, *(np.array([x]) for x in tilted)))[0] / 1e-30
            steps = quantity(*given_oil, *up) - quantity(*given_oil, *down)
            assert slope == pytest.approx(steps / (2 * h), rel=1e-6)


def test_the_state_knows_the_moving_chambers():
    """Roelands at supply pressure in the driven chamber, at return pressure in the other."""
    done = state_of()
    s = done.state
    given_oil = of("iso_vg_32")
    for chamber, pressure in (("a", s.moving_a), ("b", s.moving_b)):
        expected = state.dynamic_viscosity(*given_oil, s.temperature, pressure)
        np.testing.assert_allclose(getattr(s, f"dynamic_viscosity_{chamber}"), expected, rtol=1e-12)
    assert (np.maximum(s.dynamic_viscosity_a, s.dynamic_viscosity_b) > s.dynamic_viscosity).all()
    plain = state_of(fluid__viscosity_pressure="none").state
    assert (plain.dynamic_viscosity_a == plain.dynamic_viscosity).all()


def test_the_state_of_the_air_reaches_the_stiffness():
    """Far above 2.3 bar slow air is the stiffer one (less of it left); more air is softer."""
    fast, slow, airy = (
        ao.evaluate(ao.read(KNEE, set=sets)).metrics["stiffness_oil"].value
        for sets in ({}, {"fluid.polytropic_index": "1.0"}, {"fluid.air_content": "2 %"})
    )
    assert airy < fast < slow


# --- what the library lacks ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fluid", "line", "said", "remedy"),
    [
        ("mil_prf_5606", "bulk_modulus_law: tait", "tait: mil_prf_5606 has no tait_modulus",
         "write linear"),
        ("elasswad2018_oil", "viscosity_pressure: roelands",
         "roelands: elasswad2018_oil has no pressure_viscosity", "write none"),
        ("iso_vg_32", "bulk_modulus_law: tate", '"tate" is not a choice', 'did you mean "tait"'),
        ("iso_vg_32", "polytropic_index: 0.5", "outside the valid range", "write 1"),
    ],
)  # fmt: skip
def test_a_law_without_data_is_one_line_at_its_place(fluid, line, said, remedy):
    """Where, what, what to do: the line of the law, the properties it lacks, a remedy."""
    text = bench(("material: iso_vg_32", f"material: {fluid}\n  {line}"))
    (fault,) = refused(text)
    assert said in fault["message"]
    assert remedy in fault["remedy"]
    assert fault["path"] == f"fluid.{line.partition(':')[0]}"
    assert text.splitlines()[fault["line"] - 1].strip() == line


def test_a_design_may_state_what_the_library_lacks():
    """Tait constants under `materials` make the law usable: K0 e^(-c T) at zero pressure."""
    own = "\nmaterials:\n  mil_prf_5606:\n    tait_modulus: 8.5 GPa\n    tait_decay: 0.0058 1/K\n"
    law = ("material: iso_vg_32", "material: mil_prf_5606\n  bulk_modulus_law: tait")
    subject = ao.read(bench(law) + own + "    tait_coefficient: 11.9\n").subject()
    done = compute(subject, subject.values())
    given_oil = of("iso_vg_32", bulk_modulus_law="tait")
    share = done.state.bulk_modulus_a / state.bulk_modulus(*given_oil, WARM, done.state.holding_a)
    assert (share > 1).all()  # 8.5 instead of 8.4 GPa
    assert (share < 8.5 / 8.4).all()


# --- vapour and ranges ---------------------------------------------------------------------------


def test_cavitation_margin_by_hand():
    """Return pressure 5 bar + 1.01325 bar - 10 Pa, for neither moving nor holding lies lower."""
    margin = ao.evaluate(ao.read(KNEE)).metrics["cavitation_margin"].value
    assert margin == pytest.approx(5e5 + 101325 - 10, rel=1e-9)


def test_hot_water_glycol_boils_earlier():
    """Three quarters of the saturation pressure of water at 50 degC, 12.352 kPa by steam tables."""
    sets = {"fluid.material": "water_glycol_46", "fluid.temperature": "50 degC"}
    sets |= {"supply.return_pressure": "0 bar"}
    margin = ao.evaluate(ao.read(KNEE, set=sets)).metrics["cavitation_margin"]
    assert margin.value == pytest.approx(101325 - 0.75 * 12352, abs=0.003 * 9264)


def test_boiling_misses_the_check():
    """An oil whose vapour pressure is above the chamber's fails the check list."""
    own = "\nmaterials:\n  iso_vg_32:\n    vapour_pressure: 1000000 Pa\n"
    done = evaluated(bench() + own)
    (line,) = [c for c in done["checks"] if c["name"] == "cavitation in the chambers"]
    assert line["status"] == "missed"
    assert done["metrics"]["cavitation_margin"]["value"] == pytest.approx(5e5 + 101325 - 1e6)


def test_an_oil_without_vapour_pressure_says_so():
    """The published oil states none: no margin, with the reason."""
    text = bench(("material: iso_vg_32", "material: elasswad2018_oil"))
    metric = evaluated(text)["metrics"]["cavitation_margin"]
    assert metric["value"] is None
    assert "elasswad2018_oil has no vapour_pressure" in metric["why"]


@pytest.mark.parametrize(
    ("sets", "metric", "said"),
    [
        ({"supply.pressure": "400 bar", "fluid.bulk_modulus_law": "tait"}, "stiffness_oil",
         "but the tait law of the oil is valid up to 350 bar"),
        ({"supply.pressure": "600 bar"}, "stiffness_oil", "linear law of the oil is "
                                                          "valid up to 500 bar"),
        ({"supply.pressure": "1200 bar", "fluid.viscosity_pressure": "barus"}, "oil_viscosity",
         "1200 bar, but the Barus law is valid up to 1000 bar"),
        ({"fluid.material": "mil_prf_87257", "fluid.temperature": "110 degC"}, "oil_viscosity",
         "is below the lower limit of ASTM D341, 2 mm^2/s"),
        ({"fluid.temperature": "95 degC"}, "oil_viscosity", "outside the service range"),
    ],
)  # fmt: skip
def test_use_out_of_range_is_told(sets, metric, said):
    """Every range left is a warning, the metric marked; the shipped knee has none."""
    found = ao.evaluate(ao.read(KNEE, set=sets))
    assert any(said in text for text in found.warnings)
    assert not found.metrics[metric].in_range
    assert not any(said in text for text in ao.evaluate(ao.read(KNEE)).warnings)


def test_the_laws_of_the_oil_stand_among_the_models():
    """A reader finds air, bulk modulus and viscosity laws with their source."""
    names = {use.name: use for use in ao.evaluate(ao.read(KNEE)).models}
    assert {"fluid.effective_bulk_modulus", "fluid.bulk_modulus_linear", "fluid.roelands"} <= {
        *names
    }
    assert "AaltoThesis" in names["fluid.effective_bulk_modulus"].reference
    tait = {"fluid.bulk_modulus_law": "tait", "fluid.viscosity_pressure": "none"}
    names = {use.name: use for use in ao.evaluate(ao.read(KNEE, set=tait)).models}
    assert "oil_laws.bulk_modulus_tait" in names
    assert "fluid.roelands" not in names


# --- table and figure ----------------------------------------------------------------------------


def test_showing_a_fluid_tells_its_course_over_temperature():
    """ISO VG 32: 86.79 mm2/s at 20 degC, 870 kg/m3 expanded to 40 degC, 1367 MPa near 0 bar."""
    lines = run("materials", "show", "iso_vg_32").out.splitlines()
    rows = {line.split()[0]: line.split() for line in lines if line[:5].strip().isdigit()}
    assert rows["20"][1] == "86.79"
    density = f"{870 / (1 + 7.7e-4 * 25):.1f}"
    assert {density, "1368"} <= set(rows["40"])  # 1367 MPa + 10.8 x 1 bar
    assert [*rows][-1] == "80"


def test_only_fluids_have_the_table(tmp_path):
    """A metal shows no oil; asking for its figure is one line with the remedy."""
    assert "service range" not in run("materials", "show", "steel_42crmo4").out
    refusal = run("materials", "show", "steel_42crmo4", "--out", str(tmp_path))
    assert refusal.code == 2
    assert len(refusal.err.splitlines()) == 1
    assert "steel_42crmo4 is a metal, only fluids have a figure" in refusal.err
    assert list(tmp_path.iterdir()) == []


def test_the_figure_is_written_whole_or_not_at_all(tmp_path):
    """PNG and SVG of the same oil, the same bytes again; a file in the way is told."""
    folder = tmp_path / "new"
    done = run("materials", "show", "iso_vg_32", "--out", str(folder))
    assert done.code == 0
    assert {path.name for path in folder.iterdir()} == {"iso_vg_32.png", "iso_vg_32.svg"}
    assert done.err.count("wrote ") == 2
    before = digests(folder)
    assert (folder / "iso_vg_32.png").read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in (folder / "iso_vg_32.svg").read_bytes()[:600]
    run("materials", "show", "iso_vg_32", "--out", str(folder))
    assert digests(folder) == before
    (tmp_path / "file").touch()
    blocked = run("materials", "show", "iso_vg_32", "--out", str(tmp_path / "file"))
    assert blocked.code == 3
    assert len(blocked.err.splitlines()) == 1


@pytest.mark.parametrize("name", FLUIDS)
def test_nothing_in_a_figure_overlaps_or_is_clipped(name):
    """Texts keep clear of each other and lie on the paper; curves stay inside their frames."""
    ink = fluid_figure(load_library().get(name))
    boxes = ink.text_boxes()
    for (_, a, b, c, d), (_, e, f, g, h) in combinations(boxes, 2):
        assert c <= e or g <= a or d <= f or h <= b
    for text, left, top, right, bottom in boxes:
        inside = left >= 0 and top >= 0 and right <= ink.width and bottom <= ink.height
        assert inside, text
    for mark in ink.marks:
        for x, y in (point for line in mark.get("path", []) for point in line):
            assert 0 <= x <= ink.width
            assert 11 <= y <= ink.height  # below title and note
