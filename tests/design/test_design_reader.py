"""Reading a design: values in SI, and every fault of a file in one pass at its place."""

from __future__ import annotations

import io
import sys

import pytest

from actuator_opt.base import units
from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design
from actuator_opt.design.build import build, to_tree
from actuator_opt.design.writer import init_text


class Names(dict):
    """A material library reduced to names and kinds."""

    names = dict.keys
    kind = dict.get

    def meanings(self, kinds=()):
        """The names alone."""
        return {name: name for name, kind in self.items() if not kinds or kind in kinds}


MATERIALS = Names(
    iso_vg_32="fluid", iso_vg_46="fluid", al_6061_t6="metal", al_7075_t6="metal", ti_6al4v="metal",
    steel_42crmo4="metal", steel_e235="metal", t700_epoxy="ply", nbr_70="seal",
    epoxy_structural="adhesive", pa12="polymer",
)  # fmt: skip

GOOD = init_text("test")


def read(text, **options):
    """A design read with the names above."""
    return read_design(text, materials=MATERIALS, **options)


def faults(text, **options):
    """Every fault of a text."""
    with pytest.raises(InputError) as caught:
        read(text, **options)
    return caught.value.diagnostics


def changed(*pairs):
    """The good file with lines replaced; a line must occur once."""
    text = GOOD
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def only(*pairs):
    """The single fault that a change of the good file causes."""
    found = faults(changed(*pairs))
    assert len(found) == 1, [str(fault) for fault in found]
    return found[0]


def line_of(text, part):
    """Line and column (from 1) where a part of the text stands."""
    index = text.index(part)
    return text.count("\n", 0, index) + 1, index - (text.rfind("\n", 0, index) + 1) + 1


def test_good_file_is_si():
    """Units are converted once: mm to m, bar to Pa, degC to K, deg to rad, % to a ratio."""
    design = read(GOOD).design
    assert design.cylinder.bore == 0.025
    assert design.supply.pressure == 100e5
    assert design.fluid.temperature == 313.15
    assert design.barrel.layup[1].angle == pytest.approx(1.5358897417550099, rel=1e-15)
    assert design.fluid.air_content == 0.005
    assert design.requirements["stiffness_min"].min == 4e6
    assert design.requirements["seal_gap"].max == 80e-6
    bore = design.variables["cylinder.bore"]
    assert (bore.lower, bore.upper, bore.start) == (0.018, 0.040, 0.025)


BAD = """\
name: bad knee
fluid:
  material: iso_vg_23
  temprature: 40 degC
supply:
  pressure: 210 mm
  return_pressure: 12
cylinder:
  bore: -25 mm
  bore: 30 mm
  stroke: 1e300 mm
  mount: Cap_clevis
barrel:
  layup:
    - material: iso_vg_32
      thickness: 1,5 mm
    - thickness: .nan
rod:
  material: steel_42crmo4
  outer_diameter: 30 mm
  inner_diameter: 12:30 mm
piston:
  material: al_7075_t6
  length: 2 mm
head: 12 mm
seals:
  piston:
    compound: nbr_70
    section: 3.53 mm
    squeeze: no
  rod:
    compound: [nbr_70]
    section: 3.53 mm
    squeeze: 0.5 %
load_cases:
  - name: stance
    direction: push
  - name: stance
    direction: pull
    force: 0x10 kN
    joint_torque: 3 N*m
    position: 120 %
variables:
  cylinder.bor:
    lower: 18 mm
    upper: 40 mm
  rod.outer_diameter:
    lower: 20 mm
    upper: 10 mm
requirements:
  stifness_min:
    min: 8 kN/mm
  mass:
    max: 3
objective:
  minimise: mas
"""
EXPECTED = [
    # place in the text (line, column), path, part of the message, part of the remedy
    ((3, 13), "fluid.material", "unknown material", 'did you mean "iso_vg_32"?'),
    ((4, 3), "fluid.temprature", "unknown key", 'did you mean "temperature"?'),
    ((6, 13), "supply.pressure", "mm is a length, need a pressure", "bar"),
    ((7, 20), "supply.return_pressure", "unit missing", '"12 Pa"'),
    ((9, 9), "cylinder.bore", "-25 mm: must be > 0", "2 mm to 1000 mm"),
    ((10, 3), None, 'duplicate key "bore", first at line 9, column 3', "keep one"),
    ((11, 11), "cylinder.stroke", "1e300 mm: outside the valid range", "1 mm to 10000 mm"),
    ((12, 10), "cylinder.mount", "not a choice", 'did you mean "cap_clevis"?'),
    ((15, 17), "barrel.layup[0].material", "iso_vg_32 is a fluid", "al_6061_t6"),
    ((16, 18), "barrel.layup[0].thickness", "decimal comma", '"1.5 mm"'),
    ((17, 7), "barrel.layup[1].material", "missing", "material: "),
    ((17, 18), "barrel.layup[1].thickness", '".nan" is not a number', "1.2 mm"),
    ((21, 19), "rod.inner_diameter", 'unknown unit ":30 mm"', "mm"),
    ((25, 7), "head", 'need a block, not "12 mm"', "material, length"),
    ((30, 14), "seals.piston.squeeze", '"no" is not a number', "12 %"),
    ((32, 15), "seals.rod.compound", "need a text, not a list", "one value"),
    ((34, 14), "seals.rod.squeeze", "0.5 %: outside the range of the contact law", "2 % to 40 %"),
    ((36, 5), "load_cases[0].force", "missing", "joint_torque"),
    ((38, 11), "load_cases[1].name", "also the name of entry 0", "own name"),
    ((40, 12), "load_cases[1].force", 'unknown unit "x10 kN"', "kN"),
    ((41, 5), "load_cases[1].joint_torque", "either force, or joint_torque", "keep one"),
    ((42, 15), "load_cases[1].position", "120 %: outside", "0 % to 100 %"),
    ((44, 3), "variables.cylinder.bor", "unknown PATH", 'did you mean "cylinder.bore"?'),
    ((49, 12), "variables.rod.outer_diameter.upper", "bounds reversed", "swap"),
    ((51, 3), "requirements.stifness_min", "not a metric", 'did you mean "stiffness_min"?'),
    ((54, 10), "requirements.mass.max", "unit missing", '"3 kg"'),
    ((56, 13), "objective.minimise", "not a metric", 'did you mean "mass"?'),
]


def test_all_faults_in_one_pass():
    """Every fault of a bad file gives its line, in file order, with place, path and remedy."""
    found = faults(BAD)
    for fault, (place, path, message, remedy) in zip(found, EXPECTED, strict=True):
        assert (fault.line, fault.column) == place, str(fault)
        assert fault.path == path
        assert message in fault.message
        assert remedy in fault.remedy


def test_text_form_has_source_line_and_caret():
    """A fault prints as file:line:column: path: message; remedy, the line and a caret below."""
    fault = only(("  bore: 25 mm", "  bore: -1.5 mm"))
    line, column = line_of(changed(("  bore: 25 mm", "  bore: -1.5 mm")), "-1.5 mm")
    assert str(fault).splitlines() == [
        f"<text>:{line}:{column}: cylinder.bore: -1.5 mm: must be > 0; write 2 mm to 1000 mm",
        "      bore: -1.5 mm",
        "            ^",
    ]


CROSS = [
    # change of the good file, path of the fault, part of the message. Dimensions: bore 25, stroke
    # 110, piston 18, head 22, rod 12/4, ring 3.53 at 12 % squeeze -> gland 3.106 mm deep.
    ("  inner_diameter: 4 mm ", "  inner_diameter: 12 mm ", "rod.inner_diameter",
     "must be smaller than rod.outer_diameter"),
    ("  port_diameter: 6 mm", "  port_diameter: 25 mm", "cylinder.port_diameter", "smaller than"),
    ("    diameter: 10 mm", "    diameter: 14 mm", "rod.thread.diameter", "larger than the rod"),
    ("    pitch: 1.5 mm", "    pitch: 5 mm", "rod.thread.pitch", "no core"),
    ("  length: 18 mm", "  length: 3.5 mm", "seals.piston.section", "the grooves do not fit into "
                                                                    "the piston"),
    ("  length: 22 mm", "  length: 3.5 mm", "seals.rod.section", "the grooves do not fit into the "
                                                                 "head"),
    ("  model: auto  ", "  length: 149 mm\n  model: auto  ", "barrel.length",
     "shorter than stroke + piston + head (150 mm)"),
    ("  return_pressure: 2 bar", "  return_pressure: 100 bar", "supply.return_pressure",
     "not below supply.pressure"),
    ("  proof_ratio: 1.5 ", "  proof_ratio: 0.9 ", "supply.proof_ratio", "below supply"),
    ("  temperature_max: 80 degC", "  temperature_max: -30 degC",
     "environment.temperature_max", "range reversed"),
    ("    position: worst ", "    position: 111 mm ", "load_cases[stance].position",
     "beyond cylinder.stroke (110 mm)"),
    ("    force: 1 kN", "    joint_torque: 10 N*m", "load_cases[swing].lever_arm", "missing"),
    ("    force: 1 kN", "    lever_arm: 10 mm", "load_cases[swing].joint_torque", "missing"),
    ("    force: 1 kN", "    side_load: 1 N", "load_cases[swing].force", "missing"),
    ("    lower: 18 mm", "    lower: 26 mm", "cylinder.bore", "start value outside the bounds"),
    ("    upper: 40 mm", "    upper: 40 mm\n    start: 41 mm", "variables.cylinder.bore.start",
     "start value outside"),
    ("    upper: 40 mm", "    upper: 2000 mm", "variables.cylinder.bore.upper", "valid range"),
    ("    upper: 40 mm", "    upper: 40 bar", "variables.cylinder.bore.upper", "bar is a pressure"),
    ("  caps.thickness:", "  barrel.length:", "variables.barrel.length.start", "is not set"),
    ("  caps.thickness:", "  caps.material:", "variables.caps.material", "is text"),
    ("  caps.thickness:", "  seals.rod.count:", "variables.seals.rod.count", "is a count"),
    ("  caps.thickness:", "  caps:", "variables.caps", "names a block"),
    ("  caps.thickness:", "  requirements.buckling_factor.min:",
     "variables.requirements.buckling_factor.min", "not a dimension"),
    ("    max: 80 um", "    max: 80 um\n    min: 90 um", "requirements.seal_gap.max", "reversed"),
    ("    max: 80 um", "    max: 1e300 um", "requirements.seal_gap.max", "valid range"),
    ("    max: 80 um", "    max: -80 um", "requirements.seal_gap.max", "must be >= 0"),
    ("  minimise: mass", "  minimise: mass\n  maximise: push_force", "objective.maximise", "both"),
    ("  minimise: mass", "  minimise:\n    mass: 0", "objective.minimise.mass", "must be > 0"),
    ("  minimise: mass", "  minimise:\n    mass: 1 kg", "objective.minimise.mass", "mass"),
    ("  material: iso_vg_32  ", "  material: nbr_70  ", "fluid.material", "nbr_70 is a seal"),
    ("  material: epoxy_structural", "  material: al_7075_t6", "retention.material",
     "al_7075_t6 is a metal, need an adhesive"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "path", "message"), CROSS)
def test_cross_field_fault(old, new, path, message):
    """Values that contradict each other are one fault at the place of one of them."""
    fault = only((old, new))
    assert fault.path == path
    assert message in fault.message
    assert fault.line is not None
    assert fault.remedy


@pytest.mark.parametrize(
    "lower", ["1.1 cm", "0.011 m", "0.11 dm", "11000 um", "0.4330708661417323 in"]
)
def test_a_bound_is_its_own_value_in_any_unit(lower):
    """11 mm lies within a lower bound of 1.1 cm: units convert to the last bit, or are forgiven."""
    bounds = f"    upper: 40 mm\n    start: 11 mm\n    lower: {lower}"
    text = changed(("    lower: 18 mm\n", ""), ("    upper: 40 mm", bounds))
    variable = read(text).design.variables["cylinder.bore"]
    assert variable.start == 0.011
    assert variable.lower == pytest.approx(0.011, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "same", "dimension"),
    [
        ("1.1 cm", "11 mm", "length"),
        ("0.5 in", "12.7 mm", "length"),
        ("0.07 l", "70 ml", "volume"),
        ("0.3 bar", "30 kPa", "pressure"),
        ("0.29 kN", "290 N", "force"),
        ("0.7 %", "0.007", "ratio"),
        ("1e-400 mm", "0 m", "length"),
    ],
)
def test_units_convert_exactly(text, same, dimension):
    """A decimal in two units is one number: conversions are rounded once."""
    assert units.parse(text, dimension) == units.parse(same, dimension)


def test_limits_need_min_or_max():
    """A requirement without min and max says so beside its unknown key."""
    found = faults(changed(("    max: 80 um", "    mox: 80 um")))
    assert [f.path for f in found] == ["requirements.seal_gap.min", "requirements.seal_gap.mox"]


@pytest.mark.parametrize("name", ["12", "a]b", "a=b", '""', "' '", "x/../y"])
def test_case_names_can_stand_in_a_path(name):
    """A load case's name is usable inside brackets, unmistakable for an index."""
    found = faults(changed(("  - name: swing", f"  - name: {name}")))
    assert [f.path.rpartition(".")[2] for f in found] == ["name"]


def test_retention_needs_what_it_is_made_of():
    """A bond needs its adhesive, a thread its thread and metal, tie rods a thread and a metal."""
    no_material = ("  material: epoxy_structural\n", "")

    def paths(kind):
        found = faults(changed(("  type: bond  ", f"  type: {kind}  "), no_material))
        return [fault.path for fault in found]

    assert paths("bond") == ["retention.material"]
    assert paths("thread") == ["barrel.layup[2].material", "retention.thread"]
    assert paths("tie_rods") == ["retention.material", "retention.thread"]


def test_two_faults_of_one_value():
    """A rod as thick as the bore is outside its bounds as well: both are said, at its place."""
    found = faults(changed(("  outer_diameter: 12 mm", "  outer_diameter: 25 mm")))
    assert [f.path for f in found] == ["rod.outer_diameter"] * 2
    assert "must be smaller than cylinder.bore (25 mm)" in found[1].message


def test_groove_depth():
    """A ring whose gland leaves no core in the piston or leaves the head is refused.

    Section 8 mm at 12 %: gland 7.04 mm. Piston core 25 - 14.08 = 10.92 mm, above the rod's thread
    of 10 mm, so the piston is sound; the rod groove reaches 12 + 14.08 = 26.08 mm, outside the
    bore. With a 12 mm thread the piston's core is gone too.
    """
    wide = GOOD.replace("    section: 3.53 mm", "    section: 8 mm")
    (fault,) = faults(wide)
    assert fault.path == "seals.rod.section"
    assert "its diameter is 26.08 mm" in fault.message
    both = faults(wide.replace("    diameter: 10 mm", "    diameter: 12 mm"))
    assert [f.path for f in both] == ["seals.piston.section", "seals.rod.section"]
    assert "core with a diameter of 10.92 mm" in both[0].message


def test_lines_need_a_wall():
    """A line whose outer diameter does not exceed the inner one is refused, for each line."""
    found = faults(GOOD.replace("    outer_diameter: 8 mm", "    outer_diameter: 5 mm"))
    assert [f.path for f in found] == ["lines[0].outer_diameter", "lines[1].outer_diameter"]


def test_a_line_that_is_too_thin_says_why():
    """Its laminar drop 128 eta L q/(pi d^4) at 0.1 mm is 5^4 times that of the least, 0.5 mm."""
    found = faults(GOOD.replace("    inner_diameter: 6 mm", "    inner_diameter: 0.1 mm"))
    assert [f.path for f in found] == ["lines[0].inner_diameter", "lines[1].inner_diameter"]
    assert found[0].message.startswith("0.1 mm: too thin for a line: its laminar pressure drop")
    assert found[0].message.endswith("is 625 times that of 0.5 mm")
    assert found[0].remedy == "write 0.5 mm or more; a restriction is a ports.throttle"
    wide = faults(GOOD.replace("    inner_diameter: 6 mm", "    inner_diameter: 2 m"))
    assert "outside the valid range" in wide[0].message


def test_missing_keys_are_placed_at_their_block():
    """A missing key is reported at its section's key, a missing section at the top."""
    text = changed(("  bore: 25 mm\n", ""), ("  cylinder.bore:", "  supply.proof_ratio:"))
    found = {f.path: f for f in faults(text) if "missing" in f.message}
    assert (found["cylinder.bore"].line, found["cylinder.bore"].column) == line_of(
        text, "cylinder:"
    )
    assert found["cylinder.bore"].remedy == 'add e.g. "bore: 25 mm"'


def test_bare_numbers():
    """In files only 0, ratios and counts may be bare; 0 also not for a temperature."""
    assert read(changed(("    lower: 0 mm", "    lower: 0"))).design
    assert read(changed(("    squeeze: 12 %\n    tolerance: 0.05 mm\n  rod:",
                         "    squeeze: 0.12\n    count: 2\n  rod:"))).design  # fmt: skip
    assert "unit missing" in only(("  bore: 25 mm", "  bore: 25")).message
    assert "unit missing" in only(("  temperature: 40 degC", "  temperature: 0")).message


@pytest.mark.parametrize("value", ["1.5", "-1", "9", "1 mm", "one"])
def test_counts_are_whole_and_in_range(value):
    """A number of seals is a whole bare number in its range."""
    text = changed(("    squeeze: 12 %\n    tolerance: 0.05 mm\n  rod:",
                    f"    squeeze: 12 %\n    count: {value}\n  rod:"))  # fmt: skip
    assert [fault.path for fault in faults(text)] == ["seals.piston.count"]


def test_positions():
    """A position is worst, a length, or a share of the stroke that follows the stroke."""
    from actuator_opt.design import Fraction, position_at

    def position(text):
        changed_text = changed(("    position: worst ", f"    position: {text} "))
        return read(changed_text).design.load_cases[0].position

    assert position_at(position("worst"), 0.11) is None
    assert position_at(position("55 mm"), 0.11) == 0.055
    assert position("50 %") == Fraction(0.5)
    assert position_at(position("50 %"), 0.2) == 0.1
    fault = only(("    position: worst ", "    position: middle "))
    assert "50 %" in fault.remedy


def test_text_traps():
    """A design may be called no, 12:30 or 017; it stays that text."""
    for name in ("no", "12:30", "017", "1e5", "null"):
        assert read(GOOD.replace("name: test", f"name: {name}")).design.name == name


def test_windows_file_has_right_places():
    """CRLF line ends change no line or column, and no value."""
    good = GOOD.replace("\n", "\r\n")
    assert read(good).design == read(GOOD).design
    text = changed(("  bore: 25 mm", "  bore: 25 bar")).replace("\n", "\r\n")
    (fault,) = faults(text)
    assert (fault.line, fault.column) == line_of(text.replace("\r", ""), "25 bar")


def test_overrides():
    """--set values come first: a bare number is SI, a text needs its unit, faults name --set."""
    overrides = {
        "cylinder.bore": "0.03",
        "rod.material": "al_7075_t6",
        "load_cases[stance].force": "2 kN",
        "requirements.mass.max": "2 kg",
        "variables.cylinder.bore.upper": "50 mm",
        "barrel.length": "160 mm",
    }
    loaded = read(GOOD, overrides=overrides.items())
    design = loaded.design
    assert design.cylinder.bore == 0.03
    assert design.rod.material == "al_7075_t6"
    assert design.load_cases[0].force == 2000.0
    assert design.requirements["mass"].max == 2.0
    assert design.variables["cylinder.bore"].upper == 0.05
    assert design.barrel.length == 0.16
    found = faults(
        GOOD,
        overrides=[("cylinder.bor", "3"), ("cylinder.stroke", "3 bar"), ("supply.pressure", "-1")],
    )
    assert [(f.file, f.path) for f in found] == [
        ("--set", "cylinder.bor"), ("--set", "supply.pressure"), ("--set", "cylinder.stroke")
    ]  # fmt: skip
    assert "cylinder.bore" in found[0].remedy


def test_an_override_can_mend_a_file():
    """A value replaced by --set is not read, so its fault in the file does not count."""
    text = changed(("  bore: 25 mm", "  bore: 25"))
    assert read(text, overrides=[("cylinder.bore", "25 mm")]).design.cylinder.bore == 0.025


def test_changed_material_properties():
    """A design may replace library values; unknown materials and properties are faults."""
    text = GOOD + "materials:\n  t700_epoxy:\n    density: 1.6 g/cm^3\n"
    assert read(text).design.materials == {"t700_epoxy": {"density": 1600.0}}
    bad = text.replace("density: 1.6", "densty: 1.6").replace("t700_epoxy:\n", "t70_epoxy:\n")
    assert [f.path for f in faults(bad)] == ["materials.t70_epoxy", "materials.t70_epoxy.densty"]
    (fault,) = faults(text.replace("density: 1.6", "densty: 1.6"))
    assert 'did you mean "density"?' in fault.remedy


def test_later_faults_find_their_place():
    """An evaluation can report a fault at the value or variable of a PATH."""
    source = read(GOOD).source
    value = source.diagnostic("load_cases[swing].force", "too large", "write less")
    assert (value.line, value.column) == line_of(GOOD, "1 kN")
    unset = source.diagnostic("barrel.length", "needed")
    assert (unset.line, unset.column) == line_of(GOOD, "barrel:\n")
    variable = source.of_variable("caps.thickness", "no model reads it", "remove it")
    assert (variable.line, variable.column) == line_of(GOOD, "caps.thickness:")


def test_files_that_cannot_be_read(tmp_path):
    """A missing file, a folder and a misspelt name are input faults with a remedy."""
    (tmp_path / "knee.yaml").write_text(GOOD)
    with pytest.raises(InputError, match=r"no such file; did you mean .*knee\.yaml"):
        read(str(tmp_path / "kne.yaml"))
    with pytest.raises(InputError, match="is a folder"):
        read(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        read("a\0b")
    assert read(tmp_path / "knee.yaml").source.file == str(tmp_path / "knee.yaml")


def test_standard_input(monkeypatch):
    """``-`` reads standard input."""

    class Stdin:
        buffer = io.BytesIO(GOOD.encode())

    monkeypatch.setattr(sys, "stdin", Stdin)
    assert read("-").source.file == "<stdin>"


def test_head_and_caps_have_defaults():
    """A file without head and caps gets them from piston and bore."""
    tree = to_tree(read(GOOD).design)
    del tree["head"], tree["caps"]
    built = build(tree, materials=MATERIALS)
    assert built.design is not None, built.faults
    assert built.design.head.length == built.design.piston.length
    assert built.design.caps.thickness == pytest.approx(0.25 * built.design.cylinder.bore)


def test_many_faults_are_counted():
    """A file of nonsense gives the first hundred faults and the number of the rest."""
    found = faults("\n".join(f"key_{i}: 1" for i in range(5000)))
    assert len(found) == 101
    # 5000 unknown keys and 9 missing ones: 100 shown
    assert found[-1].message == "and 4909 more faults"


def test_messages_are_one_printable_line():
    """Control characters of a file never reach the terminal, long values are cut."""
    text = changed(("  bore: 25 mm", '  bore: "25\\x1b[31m\\nmm' + "x" * 500 + '"'))
    for fault in faults(text):
        line = str(fault).splitlines()[0]
        assert line.isprintable()
        assert len(line) < 300
