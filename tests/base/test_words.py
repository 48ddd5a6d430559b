"""Near names: by letters, by synonyms of the trade, by meaning, and by what a key takes."""

from __future__ import annotations

import pytest
from cli_runner import KNEE, bench, refused, run

from actuator_opt.api.glossary import terms
from actuator_opt.base.errors import closest, remedy
from actuator_opt.base.quantities import INPUTS, MATERIAL_PROPERTIES, SCENARIOS
from actuator_opt.base.words import SYNONYMS, meaning_of, nearest, ranked, tokens
from actuator_opt.design.kinds import ValueFault, example, read_quantity
from actuator_opt.design.materials import load_library
from actuator_opt.design.structure import templates
from actuator_opt.joints.kinds import JOINTS
from actuator_opt.metrics import METRICS

MATERIALS = load_library().meanings()
PATHS = {path: entry.meaning for path, entry in templates().items()}
TABLES = (METRICS, MATERIALS, PATHS, JOINTS, MATERIAL_PROPERTIES)


@pytest.mark.parametrize(
    ("word", "names", "near"),
    [
        ("stiffness", METRICS, "stiffness_min"),
        ("rigidity", METRICS, "stiffness_min"),
        ("stifness", METRICS, "stiffness_min"),
        ("weight", METRICS, "mass"),
        ("Weight", METRICS, "mass"),
        ("eigenfrequency", METRICS, "natural_frequency"),
        ("stiction", METRICS, "friction_breakaway"),
        ("leak", METRICS, "leakage"),
        ("efficency", METRICS, "efficiency"),
        ("42CrMo4", MATERIALS, "steel_42crmo4"),
        ("titanium", MATERIALS, "ti_6al4v"),
        ("aluminum", MATERIALS, "al_6061_t6"),
        ("viton", MATERIALS, "fkm_75"),
        ("nbr70", MATERIALS, "nbr_70"),
        ("skydrol", MATERIALS, "phosphate_ester_type_iv"),
        ("bore", PATHS, "cylinder.bore"),
        ("stroke", PATHS, "cylinder.stroke"),
        ("supply pressure", PATHS, "supply.pressure"),
        ("glue", JOINTS, "bond"),
        ("modulus", MATERIAL_PROPERTIES, "youngs_modulus"),
    ],
)
def test_the_nearest_name_is_what_an_engineer_means(word, names, near):
    """The first name is the one meant, and the remedy offers it."""
    assert nearest(word, names)[0] == near
    assert f'"{near}"' in remedy(word, names)


def test_every_name_is_its_own_nearest():
    """A name in any spelling of case, spaces and hyphens gives itself, before all others."""
    for names in (METRICS, MATERIALS, PATHS, MATERIAL_PROPERTIES):
        for name in list(names)[::3]:
            spelled = name.upper().replace("_", " ")
            assert closest(spelled, names) == name
    assert ranked("Rod-Leakage", METRICS)[0][1] == "rod_leakage"


@pytest.mark.parametrize("word", ["", " ", "x" * 10_000, "\x1b[2J", "膝", "zzzzqq", "_", "..."])
def test_words_that_mean_nothing_have_no_near_name(word):
    """They list valid names instead, in one line."""
    assert ranked(word, METRICS) == []
    assert remedy(word, METRICS).startswith("use one of mass, ")


def test_synonyms_are_single_words_with_a_name_behind_them():
    """No word stands twice in a line; each line has a word that a name or its meaning uses."""
    known = {name: meaning_of(x) for table in TABLES for name, x in table.items()}
    spoken = {word for pair in known.items() for text in pair for word in tokens(text)}
    spoken |= {word for term in terms() for word in tokens(term)}
    for line in SYNONYMS.strip().splitlines():
        words = line.split()
        assert len(words) == len(set(words)) >= 2, line
        assert {word.replace("_", "") for word in words} & spoken or "_" in words[0], line


@pytest.mark.parametrize(
    ("changes", "path", "offered", "refused_kinds"),
    [
        (
            [("    friction_coefficient", "    back_up: one\n    back_up_thickness: 1.4 mm\n"
              "    back_up_material: tefln\n    friction_coefficient")],
            "seals.piston.back_up_material", "back_up_ptfe", {"metal", "ply"},
        ),
        ([("material: epoxy_structural", "material: glue")], "retention.material",
         "epoxy_structural", {"metal"}),
        ([("material: steel_42crmo4\n  outer", "material: 42CrMo4\n  outer")], "rod.material",
         "steel_42crmo4", {"polymer"}),
        ([("material: iso_vg_32", "material: water glycol")], "fluid.material",
         "water_glycol_46", {"metal", "seal"}),
    ],
)  # fmt: skip
def test_materials_are_offered_by_what_their_key_takes(changes, path, offered, refused_kinds):
    """A back-up ring gets polymers, a bond adhesives, a rod metals; the best match is first."""
    fault = next(x for x in refused(bench(*changes)) if x["path"] == path)
    library = load_library()
    names = fault["remedy"].replace('"', "").replace("?", "").replace(",", "").split()
    kinds = {library.kind(name) for name in names if name in library}
    assert offered in names
    assert kinds
    assert not kinds & refused_kinds


def test_near_names_stand_in_every_command():
    """--set, --vary, requirements, objectives and materials: one line, with the name meant."""
    for words, name in [
        (("evaluate", KNEE, "--set", "bore=25 mm"), "cylinder.bore"),
        (("evaluate", KNEE, "--set", "requirements.weight.max=1 kg"), "mass"),
        (("evaluate", KNEE, "--set", "rod.diameter=25 mm"), "rod.outer_diameter"),
        (("sweep", KNEE, "--vary", "stroke=0.1,0.2"), "cylinder.stroke"),
        (("pareto", KNEE, "--objective", "mass:min", "--objective", "rigidity:max"),
         "stiffness_min"),
        (("materials", "show", "titanium"), "ti_6al4v"),
    ]:  # fmt: skip
        result = run(*words)
        assert result.code in (2, 3), words
        assert name in result.err, (words, result.err)
        assert len(result.err.splitlines()) == 1


@pytest.mark.parametrize(
    "quantity", (INPUTS | MATERIAL_PROPERTIES | SCENARIOS).values(), ids=lambda q: q.name
)
def test_a_bare_number_is_offered_with_its_unit_as_si(quantity):
    """What is offered reads as the number in SI; if that is out of range, it lies in the range."""
    if not quantity.si_unit:
        return
    low, high = max(quantity.lower, -1e12), min(quantity.upper, 1e12)
    inside = [low, high, (low + high) / 2, 0.37 * high, 5000.0, 5.0, 0.012]
    for number in filter(None, inside):
        bare = repr(float(number))
        with pytest.raises(ValueFault, match="unit missing") as raised:
            read_quantity(bare, quantity)
        remedy = raised.value.remedy
        offered = remedy.split('"')[1]
        value = read_quantity(offered, quantity)
        if quantity.lower <= number <= quantity.upper:
            assert value == pytest.approx(number, rel=1e-12)
            if "(= " in remedy:
                shown = remedy.partition("(= ")[2].rpartition(")")[0]
                assert read_quantity(shown, quantity) == pytest.approx(number, rel=1e-5)
        else:
            assert offered in {f"{bare} {quantity.unit}", example(quantity)}
            assert f"{bare} {quantity.si_unit} is outside" in remedy


def test_a_force_without_a_unit_is_newtons():
    """5000 is 5 kN, never 5000 kN."""
    with pytest.raises(ValueFault) as raised:
        read_quantity("5000", INPUTS["force"])
    assert raised.value.remedy == 'write "5000 N" (= 5 kN), or the unit meant'
    with pytest.raises(ValueFault) as raised:
        read_quantity("25", INPUTS["bore"])
    assert raised.value.remedy == 'write e.g. "25 mm"; 25 m is outside 2 mm to 1000 mm'
