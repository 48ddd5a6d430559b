"""Walls of barrel and rod in a design: their options, and every fault at its place."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import LoadedDesign, get, numbers, read_design, with_values
from actuator_opt.design.materials import load_library
from actuator_opt.design.writer import init_text, to_yaml
from actuator_opt.joints.kinds import JOINTS

DESIGNS = Path(__file__).parents[2] / "designs"
GOOD = init_text("test")
HOLLOW = "  inner_diameter: 4 mm         # 0 = solid\n"
MOVED = "  rod.inner_diameter:\n    lower: 0 mm\n    upper: 16 mm\n"
LAYUP = """\
  layup:
    - material: t700_epoxy
      angle: 10 deg
      thickness: 1.6 mm
    - material: steel_e235
      thickness: 0.4 mm
"""
FITTING = """\
  fitting:
    adhesive: epoxy_structural
    length: 25 mm
"""
MODEL = "  model: auto  "


def changed(*pairs):
    """The start file with parts replaced; each must occur once."""
    text = GOOD
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def laminated(rod=LAYUP + FITTING):
    """The start file with a rod of 12 mm outside and walls of 2 mm."""
    return changed((HOLLOW, rod), (MOVED, ""))


def faults(text, **options):
    """Every fault of a text."""
    with pytest.raises(InputError) as caught:
        read_design(text, **options)
    return caught.value.diagnostics


def only(text, **options):
    """The single fault of a text."""
    found = faults(text, **options)
    assert len(found) == 1, [str(fault) for fault in found]
    return found[0]


def test_options_of_a_wall():
    """Criterion, autofrettage, allowed angles, signed plies and preload are read in SI."""
    text = changed(
        (MODEL, "  criterion: puck\n  autofrettage_pressure: 500 bar\n"
                "  allowed_angles: [0 deg, 45 deg, 90 deg]\n  model: layered  "),
        ("      angle: 20 deg\n", "      angle: -20 deg\n      balanced: false\n"
                                  "      ply_thickness: 0.2 mm\n"),
        (f"  type: bond                   # or {', '.join(JOINTS.names[1:])}\n"
         "  material: epoxy_structural\n",
         "  type: tie_rods\n  material: steel_bolt_10_9\n  preload: 20 kN\n  thread:\n"
         "    diameter: 4 mm\n    pitch: 0.7 mm\n"),
    )  # fmt: skip
    loaded = read_design(text)
    design = loaded.design
    assert (design.barrel.criterion, design.barrel.model) == ("puck", "layered")
    assert design.barrel.autofrettage_pressure == 5e7
    assert design.barrel.allowed_angles == pytest.approx((0, math.pi / 4, math.pi / 2), rel=1e-15)
    ply = design.barrel.layup[2]
    assert (ply.angle, ply.balanced, ply.ply_thickness) == (-math.radians(20), False, 2e-4)
    assert design.retention.preload == 20e3
    assert to_yaml(design, loaded.source) == text
    assert read_design(to_yaml(design)).design == design


def test_defaults_of_a_wall():
    """What a file of before does not state: maximum stress, balanced pairs, no laminated rod."""
    design = read_design(GOOD).design
    assert design.barrel.criterion == "max_stress"
    assert design.barrel.autofrettage_pressure is design.barrel.allowed_angles is None
    assert all(ply.balanced and ply.ply_thickness is None for ply in design.barrel.layup)
    assert (design.rod.layup, design.rod.fitting) == ((), None)


def test_allowed_angles_have_paths():
    """Each allowed angle is a number with a PATH, which can be set but not moved."""
    text = changed((MODEL, "  allowed_angles:\n    - 0 deg\n    - 45 deg\n" + MODEL))
    loaded = read_design(text, overrides=[("barrel.allowed_angles[1]", "50 deg")])
    assert get(loaded.design, "barrel.allowed_angles[1]") == math.radians(50)
    assert "barrel.allowed_angles[0]" in numbers(loaded.design)
    assert to_yaml(loaded.design, loaded.source) == text.replace("- 45 deg", "- 50 deg")
    moved = text.replace(
        "  caps.thickness:\n    lower: 3 mm\n    upper: 12 mm",
        "  barrel.allowed_angles[1]:\n    lower: 3 deg\n    upper: 50 deg",
    )
    assert "not a dimension" in only(moved).message


@pytest.mark.parametrize(("word", "value"), [("no", False), ("True", True), ("off", False)])
def test_flags_are_written_back(word, value):
    """A yes or no may be written in several words; a changed one is written true or false."""
    text = changed(("  trapped_rise: 5 K ", f"  wet: {word}\n  trapped_rise: 5 K "))
    loaded = read_design(text)
    assert loaded.design.environment.wet is value
    assert to_yaml(loaded.design, loaded.source) == text
    turned = with_values(loaded.design, {"environment.wet": str(not value).lower()})
    written = to_yaml(turned, loaded.source)
    assert written == text.replace(f"wet: {word}", f"wet: {str(not value).lower()}")
    fault = only(text.replace(f"wet: {word}", "wet: damp"))
    assert (fault.path, fault.remedy) == ("environment.wet", "write true or false")


def test_laminated_rod():
    """A laminated rod is read, moved by PATH, and written with comments kept."""
    loaded = read_design(laminated())
    rod = loaded.design.rod
    assert [ply.thickness for ply in rod.layup] == [1.6e-3, 0.4e-3]
    assert (rod.material, rod.fitting.adhesive) == ("steel_42crmo4", "epoxy_structural")
    assert (rod.fitting.material, rod.fitting.wall, rod.inner_diameter) == (None, None, 0.0)
    moved = with_values(loaded.design, {"rod.layup[0].thickness": 2e-3, "rod.fitting.wall": 1e-3})
    text = to_yaml(moved, loaded.source)
    assert read_design(text).design == moved
    assert "# length outside the head when retracted" in text


BALANCE = "      angle: 20 deg\n      thickness: 0.8 mm\n"
FAULTS = [
    # text, path of the single fault, the text at its place, part of message, part of remedy
    (laminated(LAYUP), "rod.fitting", "rod:", "needs bonded end fittings", "adhesive and length"),
    (laminated(HOLLOW + LAYUP + FITTING), "rod.inner_diameter", "inner_diameter: 4 mm",
     "follows from", "remove the line"),
    (changed((HOLLOW, LAYUP + FITTING)), "variables.rod.inner_diameter", "rod.inner_diameter:",
     "follows from", "rod.layup[0].thickness"),
    (changed((HOLLOW, FITTING), (MOVED, "")), "rod.fitting", "fitting:", "rod with layup",
     "layers"),
    (laminated(LAYUP.replace("1.6 mm", "5.6 mm") + FITTING), "rod.layup", "layup:\n    - material: "
     "t700_epoxy\n      angle: 10", "layers of 6 mm leave no bore in a rod of 12 mm", "6 mm"),
    (laminated(LAYUP.replace("1.6 mm", "0 mm") + FITTING), "rod.layup[0].thickness", "0 mm\n    - ",
     "must be > 0", "0.01 mm"),
    (laminated(LAYUP + FITTING + "    wall: 4.5 mm\n"), "rod.fitting.wall", "4.5 mm",
     "radius of 4 mm", "solid"),
    (laminated(LAYUP + FITTING.replace("epoxy_structural", "al_7075_t6")), "rod.fitting.adhesive",
     "al_7075_t6\n    length: 25", "need an adhesive", "epoxy_structural"),
    (laminated(LAYUP + FITTING + "    material: t700_epoxy\n"), "rod.fitting.material",
     "t700_epoxy\n  extension", "need a metal or polymer", "al_"),
    (laminated(LAYUP + FITTING).replace("  material: steel_42crmo4\n", "  material: t700_epoxy\n"),
     "rod.material", "t700_epoxy\n  outer", "need a metal or polymer", "steel_42crmo4"),
    (changed((BALANCE, BALANCE.replace("20 deg", "-20 deg"))), "barrel.layup[2].angle", "-20 deg",
     "a balanced +-pair has no sign", 'write 20 deg, or add "balanced: false"'),
    (changed((BALANCE, BALANCE.replace("20 deg", "-95 deg"))), "barrel.layup[2].angle", "-95 deg",
     "outside the valid range", "-90 deg to 90 deg"),
    (changed((BALANCE, BALANCE.replace("0.8 mm", "0 mm"))), "barrel.layup[2].thickness",
     "0 mm\n\nrod", "must be > 0", "0.01 mm"),
    (changed(("  caps.thickness:\n    lower: 3 mm\n    upper: 12 mm",
              "  barrel.layup[2].angle:\n    lower: -5 deg\n    upper: 80 deg")),
     "variables.barrel.layup[2].angle.lower", "-5 deg", "has no sign", "barrel.layup[2]"),
    (changed((BALANCE, BALANCE + "      balanced: perhaps\n")), "barrel.layup[2].balanced",
     "perhaps", "need true or false", "write true or false"),
    (changed((MODEL, "  model: isotropic  ")), "barrel.model", "isotropic",
     "supports a single layer", "auto"),
    (changed((MODEL, "  criterion: tsai_hu\n" + MODEL)), "barrel.criterion", "tsai_hu",
     "not a choice", "tsai_wu"),
    (changed((MODEL, "  autofrettage_pressure: 90 bar\n" + MODEL)), "barrel.autofrettage_pressure",
     "90 bar", "not above supply.pressure (100 bar)", "100 bar"),
    (changed((MODEL, "  autofrettage_pressure: 400 bar\n" + MODEL),
             ("    - material: al_6061_t6 ", "    - material: woven_cfrp ")),
     "barrel.autofrettage_pressure", "autofrettage_pressure", "not a metal liner", "metal liner"),
    (changed((MODEL, "  allowed_angles: [0 deg, -45 deg]\n" + MODEL)), "barrel.allowed_angles[1]",
     "-45 deg", "outside the valid range", "0 deg to 90 deg"),
    (changed((MODEL, "  allowed_angles: 45 deg\n" + MODEL)), "barrel.allowed_angles", "45 deg",
     "need a list", "each entry"),
    (changed((MODEL, "  allowed_angles: []\n" + MODEL)), "barrel.allowed_angles", "[]",
     "the list is empty", "add one"),
    (changed(("  type: bond ", "  preload: 5 kN\n  type: bond ")), "retention.preload", "preload",
     "a bond has no preload", "tie_rods"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "path", "at", "message", "remedy"), FAULTS, ids=[fault[1] for fault in FAULTS]
)
def test_fault_at_its_place(text, path, at, message, remedy):
    """What cannot be is one line at its place in the file, with what to do about it."""
    fault = only(text)
    assert fault.path == path
    lines = text.splitlines(keepends=True)
    rest = "".join(lines[fault.line - 1 :])[fault.column - 1 :]
    assert rest.startswith(at)
    assert message in fault.message
    assert remedy in fault.remedy


@pytest.mark.parametrize(
    ("changes", "path", "said", "remedy"),
    [
        # 2 (23.6 + 5) sin(pi/48) mm apart, and 1.5 x 5 x 2/sqrt(3) mm over the corners
        ({"count": "48"}, "retention.count", "8.66 mm wide over the corners, and 3.741", "most 20"),
        ({"thread.diameter": "40 mm"}, "retention.count", "69.28 mm wide", "most 5"),
        ({"preload": "0 N"}, "retention.preload", "nothing closes the joint", "20 kN"),
    ],
)
def test_tie_rods_that_cannot_be_are_refused(changes, path, said, remedy):
    """Nuts that meet on the pitch circle, and a joint that no preload closes."""
    text = (DESIGNS / "aerospace.yaml").read_text("utf-8")
    start, end = text.index("variables:"), text.index("requirements:")
    text = text[:start] + text[end:]
    ao.read(text)
    with pytest.raises(InputError) as error:
        ao.read(text, set={f"retention.{key}": value for key, value in changes.items()})
    (fault,) = error.value.diagnostics
    assert fault.path == path
    assert said in fault.message
    assert remedy in fault.remedy


def test_varied_tie_rods_that_meet_are_a_warning():
    """Sizes that are variables can still change, so their start is not refused."""
    aerospace = ao.read(DESIGNS / "aerospace.yaml", set={"retention.count": "48"})
    assert any("nuts of the tie rods meet" in text for text in ao.evaluate(aerospace).warnings)


def test_autofrettage_needs_a_wrap():
    """A wall of one metal layer has no liner to yield."""
    text = changed((MODEL, "  autofrettage_pressure: 400 bar\n" + MODEL))
    first = text.index("    - material: t700_epoxy     # hoop")
    text = text[:first] + text[text.index("\nrod:\n") :]
    head, _, rest = text.partition("  barrel.layup[1].thickness:")
    text = head + rest[rest.index("  rod.outer_diameter:") :]
    fault = only(text)
    assert fault.path == "barrel.autofrettage_pressure"
    assert "nothing around it keeps a liner compressed" in fault.message


class Stock(dict):
    """A library of names, kinds and properties."""

    names = dict.keys

    def kind(self, name):
        """Kind of an entry."""
        return self[name][0] if name in self else None

    def meanings(self, kinds=()):
        """Names with nothing more about them."""
        return {name: name for name in self if not kinds or self.kind(name) in kinds}

    def numbers(self, name):
        """Properties of an entry."""
        return self[name][1]


ELASTIC = {"youngs_modulus_1": 135e9, "youngs_modulus_2": 8.5e9, "shear_modulus_12": 4.3e9,
           "poissons_ratio_12": 0.3}  # fmt: skip
STRENGTHS = dict.fromkeys(("strength_1_tension", "strength_1_compression", "strength_2_tension",
                           "strength_2_compression", "strength_12"), 1e8)  # fmt: skip


def stock(**ply):
    """The start file's materials, its ply with these properties."""
    metal = {"youngs_modulus": 70e9, "poissons_ratio": 0.3}
    names = {"iso_vg_32": "fluid", "nbr_70": "seal", "epoxy_structural": "adhesive"}
    names |= dict.fromkeys(
        ("al_6061_t6", "al_7075_t6", "ti_6al4v", "steel_42crmo4", "steel_e235"), "metal"
    )
    found = {name: (kind, metal if kind == "metal" else {}) for name, kind in names.items()}
    return Stock(found | {"t700_epoxy": ("ply", ply)})


def test_criterion_needs_its_strengths():
    """A stated criterion names ply and missing strength at its place; the design may add it."""
    some = {key: value for key, value in STRENGTHS.items() if key != "strength_12"}
    lacking = stock(**ELASTIC, **some)
    text = changed((MODEL, "  criterion: hashin\n" + MODEL))
    fault = only(text, materials=lacking)
    assert fault.path == "barrel.criterion"
    assert text.splitlines()[fault.line - 1] == "  criterion: hashin"
    assert fault.message == "hashin: t700_epoxy has no strength_12"
    assert "materials.t700_epoxy" in fault.remedy
    added = text + "materials:\n  t700_epoxy:\n    strength_12: 80 MPa\n"
    assert read_design(added, materials=lacking).design
    assert read_design(text, materials=stock(**ELASTIC, **STRENGTHS)).design
    assert read_design(GOOD, materials=lacking).design  # none chosen: the evaluation says why not


def test_shipped_plies_have_the_strengths_of_every_criterion():
    """No anisotropic ply of the library is refused by a criterion."""
    text = changed((MODEL, "  criterion: puck\n" + MODEL))
    library = load_library()
    for name in library.names(kind="ply"):
        if not library.get(name).isotropic:
            assert read_design(text.replace("t700_epoxy", name)).design


def smallest_eigenvalue(e1, e2, e3, nu12, nu13, nu23):
    """Of the normal part of the compliance, scaled to a unit diagonal."""
    off12, off13 = -nu12 / e1, -nu13 / e1
    compliance = np.array(
        [[1 / e1, off12, off13], [off12, 1 / e2, -nu23 / e2], [off13, -nu23 / e2, 1 / e3]]
    )
    scale = np.sqrt(np.diag(compliance))
    return np.linalg.eigvalsh(compliance / np.outer(scale, scale))[0]


@given(
    st.floats(1, 200), st.floats(1, 200), st.floats(1, 200),
    st.floats(0, 0.7), st.floats(0, 0.7), st.floats(0, 0.9),
)  # fmt: skip
def test_changed_constants_stay_positive_definite(e1, e2, e3, nu12, nu13, nu23):
    """Changed elastic constants are a fault exactly where the compliance has an eigenvalue <= 0."""
    smallest = smallest_eigenvalue(e1, e2, e3, nu12, nu13, nu23)
    if abs(smallest) < 1e-9:
        return
    lines = [
        f"    youngs_modulus_{i}: {value!r} GPa\n"
        for i, value in zip("123", (e1, e2, e3), strict=True)
    ]
    lines += [
        f"    poissons_ratio_{key}: {value!r}\n"
        for key, value in zip(("12", "13", "23"), (nu12, nu13, nu23), strict=True)
    ]
    text = GOOD + "materials:\n  t700_epoxy:\n" + "".join(lines)
    library = stock(**ELASTIC, **STRENGTHS)
    if smallest > 0:
        assert isinstance(read_design(text, materials=library), LoadedDesign)
        return
    fault = only(text, materials=library)
    assert fault.path == "materials.t700_epoxy.poissons_ratio_23"
    assert "not positive definite" in fault.message


def test_changed_constant_without_ratio():
    """A changed modulus alone is pointed at: nu_12^2 = 0.49 > E1/E2 = 3/8.5."""
    library = stock(**ELASTIC | {"poissons_ratio_12": 0.7}, **STRENGTHS)
    text = (
        GOOD + "materials:\n  t700_epoxy:\n    youngs_modulus_1: 3 GPa\n    density: 1.5 g/cm^3\n"
    )
    fault = only(text, materials=library)
    assert fault.path == "materials.t700_epoxy.youngs_modulus_1"
    assert "    youngs_modulus_1: 3 GPa" in str(fault)
    assert only(GOOD, overrides=[("materials.t700_epoxy.youngs_modulus_1", "3e9")],
                materials=library).file == "--set"  # fmt: skip
