"""The material libraries: what they hold, how they are read, what they say of faults."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from actuator_opt.base import files as store
from actuator_opt.base.errors import InputError
from actuator_opt.base.quantities import MATERIAL_PROPERTIES
from actuator_opt.design.material import BASES, CONFIDENCES, compliance_determinant
from actuator_opt.design.materials import (
    Library,
    Spread,
    allowable_factor,
    compatible,
    load_library,
    ply_constants,
)
from actuator_opt.models.fluid import viscosity_astm_d341
from actuator_opt.models.oil_laws import bulk_modulus_tait
from actuator_opt.pages import material as material_page
from actuator_opt.rendering.terminal import blocks_text


@pytest.fixture(scope="module")
def library() -> Library:
    """Shipped library."""
    return load_library()


def own(tmp_path: Path, text: str) -> Path:
    """Write a library file of one's own."""
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    return path


def faults_of(path: Path) -> list[str]:
    """Collect what reading a faulty library file tells."""
    with pytest.raises(InputError) as caught:
        load_library([path])
    return [str(diagnostic) for diagnostic in caught.value.diagnostics]


META = "  source: test\n  confidence: verified\n  basis: typical\n"
METAL = (
    "foo:\n  kind: metal\n  label: Foo\n" + META + "  properties:\n"
    "    density: 7850 kg/m^3\n    youngs_modulus: 200 GPa\n    poissons_ratio: 0.3\n"
)


def test_the_library_has_no_fault_and_enough_of_every_kind(library):
    """At least 20 structural materials, 8 fluids and 6 seal compounds, all readable."""
    assert library.check() == []
    assert len(library.names(role="structural")) >= 20
    assert len(library.names(kind="fluid")) >= 8
    assert len(library.names(kind="seal")) >= 6
    assert len(library.names(kind="adhesive")) >= 1


def test_binding_names_are_there(library):
    """Names that designs are promised to find."""
    for name in ("t700_epoxy", "steel_42crmo4", "al_6061_t6", "iso_vg_32"):
        assert name in library


def test_every_property_knows_source_scatter_confidence_and_basis(library):
    """No number without origin; every value lies in its quantity's range."""
    for material in library:
        for name, entry in material.completed().items():
            where = f"{material.name}.{name}"
            assert entry.source, where
            assert entry.scatter, where
            assert entry.confidence in CONFIDENCES, where
            assert entry.basis in BASES, where
            quantity = MATERIAL_PROPERTIES[name]
            assert quantity.lower <= entry.value <= quantity.upper, where
            assert math.isfinite(entry.value), where


def test_values_from_memory_or_rules_are_never_verified(library):
    """A source that admits memory or a rule of thumb is ``unverified`` (or derived by a formula).

    Hardness is the class that the name itself states.
    """
    for material in library:
        for name, entry in material.properties.items():
            recalled = entry.source.endswith("quoted from memory")
            if (recalled or entry.source.startswith("rule of thumb")) and name != "hardness":
                assert entry.confidence in ("unverified", "derived"), f"{material.name}.{name}"


def test_unverified_values_are_listed_without_the_conditions(library):
    """The remembered T700 strength is listed; the temperature of its knock-down is a condition."""
    unverified = library.get("t700_epoxy").unverified
    assert "strength_1_tension" in unverified
    assert "youngs_modulus_1" not in unverified  # a public vendor table repeats it
    assert "knockdown_temperature" not in unverified


@pytest.mark.parametrize(
    ("name", "prop", "value"),
    [
        # EN 10083-3, 16 < d <= 40 mm; EN 10305-1; Aluminum Association; Toray lamina; paper
        ("steel_42crmo4", "yield_strength", 750e6),
        ("steel_e355", "yield_strength", 450e6),
        ("al_6061_t6", "youngs_modulus", 68.9e9),
        ("al_7075_t6", "ultimate_strength", 572e6),
        ("t700_epoxy", "youngs_modulus_1", 135e9),
        ("elasswad2018_oil", "bulk_modulus", 800e6),
        ("elasswad2018_barrel_bending", "youngs_modulus", 3.48e9),
        ("aalto_thesis_oil", "bulk_modulus", 1600e6),
        ("hose_steel_braid", "youngs_modulus", 17.8e9),
        ("nbr_70_on_composite", "friction_coefficient", 0.61),
        ("al_6061_t6", "thermal_expansion", 23.6e-6),
        ("nbr_70", "temperature_max", 373.15),
    ],
)
def test_published_values(library, name, prop, value):
    """Values are those of the named source, in SI."""
    assert library.get(name).properties[prop].value == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("grade", "celsius", "expected"),
    # ASTM D341 through the ISO 3448 mid-point and a viscosity index of 100 (independent table)
    [(15, 0, 101.98), (22, 20, 54.35), (32, 0, 341.36), (32, 20, 86.79), (46, 60, 20.56),
     (46, 0, 584.93), (68, 0, 1024.93), (68, 80, 14.77), (100, 20, 334.68)],
)  # fmt: skip
def test_viscosity_grades_follow_their_published_curve(library, grade, celsius, expected):
    """Two points of each grade reproduce the VI 100 curve within 0.1 %."""
    points = library.get(f"iso_vg_{grade}").viscosity_points
    found = viscosity_astm_d341(
        temperature=celsius + 273.15,
        points_temperature=[t for t, _ in points],
        points_viscosity=[nu for _, nu in points],
    )
    assert found * 1e6 == pytest.approx(expected, rel=1e-3)


CURVES = {  # mm2/s at -20, 0, 20, 40, 60, 80, 100 degC: log10 log10(nu + 0.7) = A - B log10 T
    32: (9.58029, 3.76640, (2367, 341.36, 86.79, 32, 15.13, 8.48, 5.36)),
    46: (9.45549, 3.69946, (4641.2, 584.93, 134.49, 46, 20.56, 11.05, 6.76)),
    68: (9.28859, 3.61594, (9201.03, 1024.93, 214.12, 68, 28.71, 14.77, 8.73)),
}


@pytest.mark.parametrize("grade", CURVES)
def test_viscosity_grades_over_the_whole_chart(library, grade):
    """Constants A and B and seven published values of each grade, -20 to 100 degC."""
    a, b, values = CURVES[grade]
    points = library.get(f"iso_vg_{grade}").viscosity_points
    for celsius, expected in zip(range(-20, 101, 20), values, strict=True):
        kelvin = celsius + 273.15
        found = viscosity_astm_d341(
            temperature=kelvin,
            points_temperature=[t for t, _ in points],
            points_viscosity=[nu for _, nu in points],
        )
        assert found * 1e6 == pytest.approx(expected, rel=2.5e-3)
        chart = 10 ** (10 ** (a - b * math.log10(kelvin))) - 0.7
        assert found * 1e6 == pytest.approx(chart, rel=2.5e-3)


@pytest.mark.parametrize(
    ("grade", "values"),
    # Stachowiak and Batchelor, Table 2.3 (1/GPa at 30, 60, 100 degC): spindle oils a and b, light
    # machine oil b, medicinal white oil
    [(15, (20.0, 16.0, 13.0)), (22, (25.7, 20.3, 15.4)), (32, (28.0, 20.0, 16.0)),
     (68, (29.6, 22.8, 17.8))],
)  # fmt: skip
def test_pressure_viscosity_is_that_of_the_published_table(library, grade, values):
    """Coefficients of an oil of equal viscosity, at the temperatures of the table."""
    entry = library.get(f"iso_vg_{grade}").properties["pressure_viscosity"]
    assert [t - 273.15 for t in entry.arguments] == pytest.approx([30, 60, 100])
    assert [1e9 * alpha for alpha in entry.values] == pytest.approx(values)


@pytest.mark.parametrize("grade", [15, 22, 32, 46, 68, 100])
def test_mineral_grades_carry_the_tait_law_of_the_generic_oil(library, grade):
    """Tangent bulk modulus at 20 and 80 degC, 200 and 350 bar: the published constants' values."""
    numbers = library.numbers(f"iso_vg_{grade}")
    for celsius, bar, expected in ((20, 200, 1751), (20, 350, 1911), (40, 350, 1743),
                                   (60, 200, 1433), (80, 200, 1299), (80, 350, 1459)):  # fmt: skip
        found = bulk_modulus_tait(
            temperature=celsius + 273.15,
            pressure=bar * 1e5,
            zero_modulus=numbers["tait_modulus"],
            temperature_coefficient=numbers["tait_decay"],
            pressure_coefficient=numbers["tait_coefficient"],
        )
        assert found / 1e6 == pytest.approx(expected, abs=0.6)


@pytest.mark.parametrize(
    ("name", "modulus"), [("aalto_thesis_oil", 1600e6), ("huang2017_oil", 1400e6)]
)
def test_oils_of_papers_keep_their_modulus_in_the_tait_law(library, name, modulus):
    """At 40 degC and zero pressure the Tait law gives the modulus that the paper states."""
    numbers = library.numbers(name)
    assert numbers["bulk_modulus"] == modulus
    found = numbers["tait_modulus"] * math.exp(-numbers["tait_decay"] * 313.15)
    assert found == pytest.approx(modulus, rel=1e-4)


def test_fluids_cover_the_families_with_service_ranges(library):
    """Six mineral grades, three aircraft fluids, phosphate ester, water-glycol, a second ester."""
    names = set(library.names(kind="fluid"))
    grades = {f"iso_vg_{grade}" for grade in (15, 22, 32, 46, 68, 100)}
    aircraft = {"mil_prf_5606", "mil_prf_83282", "mil_prf_87257", "phosphate_ester_type_iv"}
    assert grades | aircraft | {"water_glycol_46", "polyol_ester_46"} <= names
    for name in names:
        numbers = library.numbers(name)
        assert numbers["temperature_min"] < 313.15 < numbers["temperature_max"], name
        assert all(entry.confidence == "unverified" or name != "polyol_ester_46"
                   for key, entry in library.get(name).properties.items()
                   if key in ("density", "kinematic_viscosity", "bulk_modulus"))  # fmt: skip


def test_mil_prf_5606_needs_its_cold_points(library):
    """495 mm2/s at -40 degC, below the limit of 600; 40 and 100 degC alone miss it by half."""
    points = library.get("mil_prf_5606").viscosity_points
    ends = [[pair[i] for pair in points if pair[0] > 300] for i in (0, 1)]
    two = viscosity_astm_d341(
        temperature=233.15, points_temperature=ends[0], points_viscosity=ends[1]
    )
    every = viscosity_astm_d341(
        temperature=233.15,
        points_temperature=[t for t, _ in points],
        points_viscosity=[nu for _, nu in points],
    )
    assert every == pytest.approx(495e-6, rel=1e-9)
    assert two < 0.55 * every
    limits = {313.15: 13.2e-6, 373.15: 4.9e-6}  # least values of the specification
    assert all(nu >= limits.get(t, 0) for t, nu in points)


@pytest.mark.parametrize("name", ["mil_prf_5606", "mil_prf_83282", "mil_prf_87257"])
def test_aerospace_fluids_have_three_points_down_to_the_cold(library, name):
    """A two-point fit fails at -40 degC, so the cold point is in the table."""
    points = library.get(name).viscosity_points
    assert len(points) >= 3
    assert points[0][0] <= 233.15


def test_the_published_oil_gives_the_published_damping(library):
    """Damping c = 8 pi rho nu L = 0.1 N s/m at L = 150 mm, at the density's own temperature."""
    numbers = library.numbers("elasswad2018_oil")
    damping = 8 * math.pi * numbers["density"] * numbers["kinematic_viscosity"] * 0.150
    assert damping == pytest.approx(0.1, rel=1e-6)


def test_every_ply_is_stable_and_isotropic_materials_are_plies(library):
    """Positive-definite compliance; metals give nine equal-axes constants."""
    for name in library.names(role="structural"):
        assert compliance_determinant(ply_constants(library.numbers(name))) > 0, name
    steel = ply_constants({"youngs_modulus": 210e9, "poissons_ratio": 0.3, "yield_strength": 3e8})
    assert steel["youngs_modulus_1"] == steel["youngs_modulus_3"] == 210e9
    assert steel["shear_modulus_12"] == pytest.approx(210e9 / 2.6)
    assert steel["strength_12"] == pytest.approx(3e8 / math.sqrt(3))


def test_missing_ply_constants_are_completed_and_say_so(library):
    """Transverse isotropy: E3 = E2, nu13 = nu12, G13 = G12, nu23 = 0.40, G23 = E2/(2(1+nu23))."""
    base = {"youngs_modulus_1": 138e9, "youngs_modulus_2": 9e9, "shear_modulus_12": 5e9}
    full = ply_constants(base | {"poissons_ratio_12": 0.28})
    assert full["youngs_modulus_3"] == 9e9
    assert full["poissons_ratio_13"] == 0.28
    assert full["poissons_ratio_23"] == 0.40
    assert full["shear_modulus_13"] == 5e9
    assert full["shear_modulus_23"] == pytest.approx(9e9 / 2.8)
    entry = library.get("t700_epoxy").completed()["shear_modulus_23"]
    assert entry.confidence == "derived"
    assert "assumed" in entry.note


def test_ply_constants_differentiate_by_complex_step():
    """dG23/dE2 = 1/(2(1 + nu23)) through the completion."""
    numbers = {"youngs_modulus_1": 138e9, "youngs_modulus_2": 9e9 + 1e-20j,
               "shear_modulus_12": 5e9, "poissons_ratio_12": 0.28}  # fmt: skip
    slope = ply_constants(numbers)["shear_modulus_23"].imag / 1e-20
    assert slope == pytest.approx(1 / 2.8, rel=1e-12)


def test_allowables_multiply_the_stated_knock_downs(library):
    """Lap shear at 80 degC, wet: 0.855 x 0.865 x basis; half-way in temperature half the loss."""
    numbers = library.numbers("epoxy_structural")
    factor = allowable_factor(numbers, "bond_strength", basis="mean", temperature=353.15, wet=True)
    assert factor == pytest.approx(0.855 * 0.865 * 0.8)
    half = allowable_factor(
        numbers, "bond_strength", basis="minimum", temperature=(353.15 + 296.15) / 2
    )
    assert half == pytest.approx(1 - 0.145 / 2)
    cold = allowable_factor(numbers, "bond_strength", basis="B", temperature=np.array([250.0]))
    assert cold == pytest.approx([1.0])


def test_wound_fibre_tension_carries_the_process_knock_down(library):
    """T700: flat coupon to wound tube 0.75, mean to B-basis 0.88, room temperature dry."""
    factor = allowable_factor(
        library.numbers("t700_epoxy"), "strength_1_tension", basis="mean", temperature=296.15
    )
    assert factor == pytest.approx(0.75 * 0.88)


def test_tables_interpolate_and_scale(library):
    """Extrusion gap of a step ring: table value at 200 bar, mean half-way, held at the ends."""
    gap = library.get("ptfe_bronze_nbr_70").properties["extrusion_gap_max"]
    assert gap.at(200e5) == pytest.approx(0.20e-3)
    assert gap.at(150e5) == pytest.approx(0.25e-3)
    assert gap.at(1e5) == pytest.approx(0.30e-3)
    assert gap.at(5e7) == pytest.approx(0.15e-3)
    assert gap.value == pytest.approx(0.15e-3)
    assert gap.at(200e5, value=2 * gap.value) == pytest.approx(0.40e-3)
    slope = gap.at(np.array([120e5 + 1e-25j])).imag / 1e-25
    assert slope == pytest.approx((0.20e-3 - 0.30e-3) / 100e5)


def test_scatter_is_a_number_too(library):
    """Texts "5 % CV", "+-5 ShoreA" and "factor 2" become numbers for uncertainty work."""
    assert library.get("t700_epoxy").properties["strength_1_tension"].spread == Spread("cv", 0.05)
    hardness = library.get("nbr_70").properties["hardness"].spread
    assert hardness == Spread("tolerance", pytest.approx(5 / 70))
    assert library.get("nbr_70").properties["friction_coefficient"].spread == Spread("factor", 2.0)


def test_fluids_and_seals_know_each_other(library):
    """Phosphate ester needs EPDM; mineral oil must not meet it."""
    get = library.get
    assert compatible(get("phosphate_ester_type_iv"), get("epdm_80")) is True
    assert compatible(get("iso_vg_46"), get("epdm_80")) is False
    assert compatible(get("iso_vg_46"), get("nbr_70")) is True


def test_the_bending_modulus_of_the_paper_carries_its_warning(library):
    """The apparent modulus is flagged, so that a report can say so."""
    assert "DO NOT" in library.get("elasswad2018_barrel_bending").warning


def test_unknown_names_get_the_best_matches(library):
    """A near miss names its neighbours; a wrong kind names fitting ones."""
    with pytest.raises(InputError, match=r"best matches are .*t700_epoxy"):
        library.get("T700-Epoxi")
    with pytest.raises(InputError, match="is a seal, not a fluid material"):
        library.get("nbr_70", role="fluid")
    with pytest.raises(InputError, match="unknown material"):
        library.get("_cfrp_epoxy")
    assert library.kind("nothing") is None


def test_own_materials_override_and_inherit(tmp_path):
    """A design's own file replaces a shipped entry and may build on it."""
    path = own(
        tmp_path,
        "t700_epoxy:\n  inherit: t700_epoxy\n  kind: ply\n  label: our lot\n"
        "  source: coupon tests\n  confidence: verified\n  basis: B\n  properties:\n"
        "    youngs_modulus_1: {value: 128 GPa, scatter: 2 % CV}\n" + METAL,
    )
    mine = load_library([path])
    entry = mine.get("t700_epoxy")
    assert entry.properties["youngs_modulus_1"].value == 128e9
    assert entry.properties["youngs_modulus_1"].basis == "B"
    assert entry.properties["youngs_modulus_2"].value == 8.5e9
    assert entry.line == 1
    assert mine.get("foo").numbers["density"] == 7850
    assert load_library().get("t700_epoxy").properties["youngs_modulus_1"].value == 135e9


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("200 GPa", "200", 9, "unit missing"),
        ("200 GPa", "200 mm", 9, "mm is a length, need a pressure"),
        ("7850 kg/m^3", "7.85 kg/m^3", 8, "outside the valid range"),
        ("density:", "densty:", 8, 'did you mean "density"'),
        ("confidence: verified", "confidence: sure", 5, 'unknown confidence "sure"'),
        ("basis: typical", "basis: guess", 6, 'unknown basis "guess"'),
        ("kind: metal", "kind: metall", 2, 'did you mean "metal"'),
        ("0.3", "{value: 0.3, scatter: lots}", 10, 'unknown scatter "lots"'),
        ("0.3", "{valu: 0.3}", 10, 'unknown key "valu"'),
        ("    density: 7850 kg/m^3\n", "", 2, "a metal needs density"),
        ("  source: test\n", "", 7, "the source is missing"),
        ("label: Foo", "lable: Foo", 3, 'did you mean "label"'),
        ("0.3", "{points: [{temperature: 0 degC, value: 0.3}, "
                "{temperature: 0 degC, value: 0.3}]}", 10, "must rise"),
        ("kind: metal", "kind: metal\n  inherit: nowhere", 3, 'unknown material "nowhere"'),
        ("kind: metal", "kind: metal\n  inherit: foo", 1, "inherits from itself"),
    ],
)  # fmt: skip
def test_a_faulty_library_file_is_told_where_and_what(tmp_path, old, new, line, said):
    """Every fault names file and line and a remedy."""
    path = own(tmp_path, METAL.replace(old, new, 1))
    told = faults_of(path)
    assert any(said in fault and f"{path}:{line}:" in fault for fault in told), told


def test_all_faults_of_a_file_come_at_once(tmp_path):
    """Two faults in one entry, one in another, a stray line: one pass."""
    text = METAL.replace("200 GPa", "200").replace("0.3", "0.9") + "stray text\n"
    told = faults_of(own(tmp_path, text + METAL.replace("foo:", "bar:").replace("200", "2e9")))
    assert len(told) >= 4


def test_an_impossible_ply_is_refused(tmp_path):
    """nu12 = 0.6 with E2 = E1 * 3 makes 1 - nu12 nu21 negative."""
    path = own(
        tmp_path,
        "ply:\n  kind: ply\n" + META + "  properties:\n    density: 1600 kg/m^3\n"
        "    youngs_modulus_1: 10 GPa\n    youngs_modulus_2: 30 GPa\n"
        "    shear_modulus_12: 5 GPa\n    poissons_ratio_12: 0.6\n",
    )
    assert "not positive definite" in faults_of(path)[0]


def test_a_fluid_needs_its_viscosity_over_temperature(tmp_path):
    """One viscosity cannot carry the temperature law."""
    path = own(
        tmp_path,
        "oil:\n  kind: fluid\n" + META + "  properties:\n    density: 870 kg/m^3\n"
        "    bulk_modulus: 1400 MPa\n    volume_expansion: 7e-4 1/K\n"
        "    kinematic_viscosity: 32 mm^2/s\n",
    )
    assert "two or more temperatures" in faults_of(path)[0]


def test_a_table_of_vapour_pressures_starts_above_zero(tmp_path):
    """The law between the points takes logarithms: a zero is told, not turned into nothing."""
    points = "{temperature: 0 degC, value: 0 Pa}, {temperature: 40 degC, value: 9 Pa}"
    path = own(
        tmp_path,
        f"oil:\n  inherit: iso_vg_32\n{META}  properties:\n"
        f"    vapour_pressure: {{points: [{points}]}}\n",
    )
    (fault,) = faults_of(path)
    assert f"{path}:7:" in fault
    assert "vapour pressures needs values above zero" in fault


def test_a_missing_file_is_an_input_error(tmp_path):
    """No traceback for a wrong path."""
    assert "the material library does not exist" in faults_of(tmp_path / "none.yaml")[0]


def test_duplicate_materials_in_one_file_are_refused(tmp_path):
    """The second of two equal names is told with the place of the first."""
    assert "first at line 1" in faults_of(own(tmp_path, METAL + METAL))[0]


def test_data_folders_packaged_first_then_checkout(tmp_path):
    """A wheel's own data win; a checkout counts only with its pyproject.toml beside."""
    package = tmp_path / "actuator_opt"
    (tmp_path / "materials").mkdir()
    package.mkdir()
    with pytest.raises(InputError, match="missing from this installation"):
        store.data_folder("materials", package=package)
    (tmp_path / "pyproject.toml").touch()
    assert store.data_folder("materials", package=package) == tmp_path / "materials"
    packaged = package / "_data" / "materials"
    packaged.mkdir(parents=True)
    assert store.data_folder("materials", package=package) == packaged


def test_text_tables_can_be_ascii_and_show_everything(library):
    """List, show and compare are plain lines; sources are numbered; ratios to the first."""

    def lines(blocks):
        return blocks_text(blocks, colour=False, unicode=False, width=100).split("\n")

    listed = lines(material_page.listing(library))
    assert all(line.isascii() for line in listed)
    for name in library.names():
        assert any(line.startswith(f"{name} ") for line in listed), name
    for material in library:
        shown = lines(material_page.blocks(material))
        assert all(line.isascii() for line in shown)
        assert sum(line.startswith("[") for line in shown) >= 1
    pair = [library.get("steel_e355"), library.get("al_6061_t6")]
    compared = lines(material_page.comparison(pair))
    (modulus,) = [line for line in compared if line.startswith("youngs_modulus ")]
    assert "206 GPa" in modulus
    assert "(x0.334)" in modulus  # 68.9/206


# ---- heat ----


def through_wall(material):
    """Conductivity through a wall of the material, None if it states none."""
    stated = [material.numbers[key] for key in material.through_wall if key in material.numbers]
    return stated[0] if stated else None


def test_every_wall_and_fluid_conducts_and_stores_heat(library):
    """Metals, plies and fluids state conductivity and specific heat; plies also through the ply."""
    for material in library:
        if material.kind in ("metal", "ply", "fluid"):
            assert through_wall(material) is not None, material.name
            assert "specific_heat" in material.numbers, material.name
        if material.kind == "ply":
            assert "thermal_conductivity_through" in material.numbers, material.name


@pytest.mark.parametrize(
    ("name", "along", "through", "heat"),
    # dealers' pages of 7075-T6 and 6061-T6; maker's page of 42CrMo4; Rabie, section 2.2.12
    [
        ("al_7075_t6", 130.0, 130.0, 960.0),
        ("al_6061_t6", 167.0, 167.0, 896.0),
        ("steel_42crmo4", 42.6, 42.6, 470.0),
        ("iso_vg_32", 0.12, 0.12, 2060.0),
        ("t700_epoxy", 5.5, 0.65, 950.0),
    ],
)
def test_published_heat_values(library, name, along, through, heat):
    """Values of the named pages, in SI; through a ply, the conductivity is that across fibres."""
    material = library.get(name)
    numbers = material.numbers
    assert numbers["thermal_conductivity"] == pytest.approx(along, rel=1e-12)
    assert through_wall(material) == pytest.approx(through, rel=1e-12)
    assert numbers["specific_heat"] == pytest.approx(heat, rel=1e-12)


def test_heat_values_follow_wiedemann_and_franz_and_dulong_and_petit(library):
    """Metals: k near L T/resistivity; the heat of a mole is near 3 R. Two laws, no table."""
    # electrical resistivity at 20 degC [Ohm m] and mean molar mass [kg/mol]
    for name, resistivity, molar in (
        ("al_6061_t6", 3.99e-8, 27.0e-3),
        ("al_7075_t6", 5.15e-8, 28.4e-3),
        ("steel_42crmo4", 0.19e-6, 55.6e-3),
    ):
        numbers = library.get(name).numbers
        electrons = 2.44e-8 * 293.0 / resistivity
        assert numbers["thermal_conductivity"] == pytest.approx(electrons, rel=0.25), name
        assert numbers["specific_heat"] * molar == pytest.approx(3 * 8.314, rel=0.12), name


def test_a_ply_without_its_own_value_through_has_none(tmp_path):
    """The conductivity along the fibre never serves for that through the ply; a metal's does."""
    elastic = (
        "    youngs_modulus_1: 135 GPa\n    youngs_modulus_2: 8 GPa\n"
        "    shear_modulus_12: 4 GPa\n    poissons_ratio_12: 0.3\n"
    )
    ply = (
        "bar:\n  kind: ply\n  label: Bar\n" + META + "  properties:\n    density: 1570 kg/m^3\n"
        + elastic + "    thermal_conductivity: 5 W/(m*K)\n"
    )  # fmt: skip
    path = own(tmp_path, METAL + "    thermal_conductivity: 40 W/m/K\n" + ply)
    mine = load_library([path])
    assert through_wall(mine.get("bar")) is None
    assert through_wall(mine.get("foo")) == 40.0


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("thermal_conductivity: 130 W/K", "W/K"),
        ("thermal_conductivity: 0 W/(m*K)", "0.01 W/(m*K) to 2500 W/(m*K)"),
        ("specific_heat: 960", "unit"),
        ("specific_heat: 0.96 J/(kg*K)", "50 J/(kg*K) to"),
    ],
)
def test_faulty_heat_values_are_refused(tmp_path, text, fault):
    """A wrong unit, no unit and a value out of range each get one line with place and remedy."""
    messages = faults_of(own(tmp_path, METAL + f"    {text}\n"))
    assert len(messages) == 1
    assert fault in messages[0]
    assert text.partition(":")[0] in messages[0]


def test_heat_values_are_printed(library):
    """The page of a material shows the three properties with unit and confidence."""
    page = material_page.blocks(library.get("t700_epoxy"))
    lines = blocks_text(page, colour=False, unicode=False, width=100).split("\n")
    for name, value in (
        ("thermal_conductivity ", "5.5 W/(m*K)"),
        ("thermal_conductivity_through", "0.65 W/(m*K)"),
        ("specific_heat", "950 J/(kg*K)"),
    ):
        (line,) = (line for line in lines if line.strip().startswith(name))
        assert value in line
        assert "unverified" in line
