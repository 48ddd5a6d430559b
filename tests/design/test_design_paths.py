"""PATHs: one canonical spelling, numbers by PATH, designs with other values."""

from __future__ import annotations

import pytest

from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.design import (
    Fraction,
    canonical,
    get,
    numbers,
    quantity_of,
    split_assignment,
    with_values,
)
from actuator_opt.design.build import build
from actuator_opt.design.writer import init_text
from actuator_opt.design.yaml_source import parse

DESIGN = build(parse(init_text("test"), "f").data).design


def test_numbers_are_si_by_canonical_path():
    """Every number that is set has its PATH; what is not set is absent."""
    found = numbers(DESIGN)
    assert found["cylinder.bore"] == 0.025
    assert found["barrel.layup[2].thickness"] == 0.0008
    assert found["load_cases[stance].force"] == 3000.0
    assert found["requirements.stiffness_min.min"] == 4e6
    assert "barrel.length" not in found
    assert "load_cases[stance].joint_torque" not in found
    assert all(isinstance(value, float) for value in found.values())


def test_every_number_can_be_got_named_and_set():
    """Each number has a canonical PATH and a quantity; writing it back changes nothing."""
    found = numbers(DESIGN)
    for path, value in found.items():
        assert canonical(path, DESIGN) == path
        assert get(DESIGN, path) == value
        assert quantity_of(path, DESIGN).lower <= value <= quantity_of(path, DESIGN).upper
    assert with_values(DESIGN, found) == DESIGN


@pytest.mark.parametrize(
    ("written", "spelled"),
    [
        ("load_cases[0].force", "load_cases[stance].force"),
        ("load_cases[swing].speed", "load_cases[swing].speed"),
        (" cylinder.bore ", "cylinder.bore"),
        ("variables.cylinder.bore.upper", "variables.cylinder.bore.upper"),
        ("variables.load_cases[1].force.lower", "variables.load_cases[swing].force.lower"),
        ("requirements.seal_gap.max", "requirements.seal_gap.max"),
        ("materials.t700_epoxy.density", "materials.t700_epoxy.density"),
        ("rod.thread.pitch", "rod.thread.pitch"),
        ("retention.thread.pitch", "retention.thread.pitch"),
    ],
)
def test_canonical_spelling(written, spelled):
    """Load cases are named, layers counted; PATHs into unset blocks are known too."""
    assert canonical(written, DESIGN) == spelled


@pytest.mark.parametrize(
    ("path", "remedy"),
    [
        ("cylinder.bor", 'did you mean "cylinder.bore"?'),
        ("Cylinder.Bore", 'did you mean "cylinder.bore"?'),
        ("bore", ""),
        ("cylinder", "add one of .bore, .stroke"),
        ("cylinder.bore.x", "write only this"),
        ("barrel.layup.thickness", "write barrel.layup[0]."),
        ("barrel.layup[7].thickness", "0, 1, 2"),
        ("load_cases[stanse].force", 'did you mean "stance"?'),
        ("requirements.stiffness.min", 'did you mean "stiffness_'),
        ("requirements.stiffness", 'did you mean "stiffness_min"'),
        ("requirements.stiffness_min", "end it with .min or .max"),
        ("stiffness.min", 'did you mean "requirements.stiffness_min.min"'),
        ("stiffness", "for a limit: requirements.stiffness_min.min"),
        ("mass", 'did you mean "requirements.mass.max"'),
        ("running friction", 'did you mean "requirements.friction_running.max"?'),
        ("stiffness_min.max", 'did you mean "requirements.stiffness_min.max"'),
        ("requirements.mass", "end it with .min or .max"),
        ("variables.cylinder.bore", "end it with .lower"),
        ("materials.x.dens", 'did you mean "density"?'),
        ("", "write e.g. cylinder.bore"),
        ("a..b", "write e.g. cylinder.bore"),
        ("x" * 500, "write e.g. cylinder.bore"),
    ],
)
def test_wrong_paths_name_the_right_one(path, remedy):
    """A PATH that names nothing is refused with the nearest PATH or what is missing."""
    with pytest.raises(InputError) as caught:
        canonical(path, DESIGN)
    (fault,) = caught.value.diagnostics
    assert remedy in fault.remedy
    assert fault.path == path


def test_texts_have_no_quantity():
    """A text can be got, but is not a number."""
    assert get(DESIGN, "rod.material") == "steel_42crmo4"
    assert get(DESIGN, "barrel.length") is None
    with pytest.raises(InputError, match="is text"):
        quantity_of("rod.material", DESIGN)


def test_with_values_checks_again():
    """New values are SI or text with a unit; ranges and contradictions are checked again."""
    moved = with_values(DESIGN, {"cylinder.bore": 0.03, "supply.pressure": "120 bar"})
    assert moved.cylinder.bore == 0.03
    assert moved.supply.pressure == 120e5
    assert DESIGN.cylinder.bore == 0.025
    with pytest.raises(InputError, match="must be smaller than cylinder"):
        with_values(DESIGN, {"rod.outer_diameter": 0.019, "cylinder.bore": 0.018})
    with pytest.raises(InputError, match="valid range"):
        with_values(DESIGN, {"cylinder.stroke": 1e300})
    with pytest.raises(InputError, match="did you mean"):
        with_values(DESIGN, {"cylinder.strok": 0.1})


def test_start_follows_the_value():
    """A variable starts from the design's new value, unless its start was stated."""
    moved = with_values(DESIGN, {"cylinder.bore": 0.03})
    assert moved.variables["cylinder.bore"].start == 0.03
    stated = with_values(DESIGN, {"variables.cylinder.bore.start": 0.02})
    assert with_values(stated, {"cylinder.bore": 0.03}).variables["cylinder.bore"].start == 0.02


def test_new_values_in_unset_places():
    """A PATH that is not set yet can be set: optional values, limits, material properties."""
    moved = with_values(
        DESIGN,
        {
            "barrel.length": 0.16,
            "requirements.mass.max": 2.0,
            "materials.t700_epoxy.density": 1600.0,
            "load_cases[stance].temperature": 350.0,
        },
    )
    new = set(numbers(moved)) - set(numbers(DESIGN))
    assert new == {
        "barrel.length",
        "requirements.mass.max",
        "materials.t700_epoxy.density",
        "load_cases[stance].temperature",
    }


def test_share_of_the_stroke_stays_a_share():
    """A number set on a position that is a share of the stroke is a share."""
    share = with_values(DESIGN, {"load_cases[stance].position": "50 %"})
    assert numbers(share)["load_cases[stance].position"] == 0.5
    assert quantity_of("load_cases[stance].position", share).name == "fraction"
    moved = with_values(share, {"load_cases[stance].position": 0.25})
    assert moved.load_cases[0].position == Fraction(0.25)


def test_assignments():
    """PATH=VALUE splits at the first sign; anything else is a usage error."""
    assert split_assignment("a.b = 1 mm") == ("a.b", "1 mm")
    assert split_assignment("name=a=b") == ("name", "a=b")
    for text in ("a.b", "=1", "a.b=", ""):
        with pytest.raises(UsageError, match="not PATH=VALUE"):
            split_assignment(text)
