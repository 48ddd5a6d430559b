"""Kinds of a scenario: words, keys, equations; what is forgotten fails at import."""

from dataclasses import replace

import pytest

from actuator_opt.base.kinds import kinds, per_kind
from actuator_opt.design.scenario import Scenario, model
from actuator_opt.design.scenario.kinds import ENDS, FRICTIONS, LAWS, SHAPES, SUPPLIES
from actuator_opt.design.structure import entries
from actuator_opt.models.loop import ziegler_nichols
from actuator_opt.simulation.components.chambers import FEEDS
from actuator_opt.simulation.components.motion import FORCES
from actuator_opt.simulation.components.supply import DELIVERIES

CHOICES = {
    ("supply", "type"): SUPPLIES,
    ("friction", "model"): FRICTIONS,
    ("ends",): ENDS,
    ("control", "law"): LAWS,
}


def entry(loc, section=Scenario):
    """The entry of a key of a scenario."""
    for name in loc[:-1]:
        section = entries(section)[name].section
    return entries(section)[loc[-1]]


@pytest.mark.parametrize("loc", CHOICES, ids=".".join)
def test_words_and_help_come_from_the_kinds(loc):
    """Every kind has its word and its meaning in the help of its key."""
    known = entry(loc)
    assert known.choices == CHOICES[loc].names
    for kind in CHOICES[loc].values():
        assert f"{kind.name}: {kind.help}" in known.kind.help


@pytest.mark.parametrize("shape", SHAPES.values(), ids=lambda shape: shape.name)
def test_a_shape_reads_keys_that_parts_have(shape):
    """Needed keys, others, and the shapes a key without effect may mean."""
    known = entries(model.ForceSignal)
    assert shape.name in known["shape"].choices
    assert {*shape.needed, *shape.read} <= known.keys()
    assert {*shape.instead}.isdisjoint({*shape.needed, *shape.read})
    assert {*shape.instead.values()} <= {*SHAPES}


@pytest.mark.parametrize("kind", [*SUPPLIES.values(), *FRICTIONS.values()], ids=lambda x: x.name)
def test_a_component_leaves_keys_unread_that_its_section_has(kind):
    """A key that is needed is read."""
    section = "supply" if kind in SUPPLIES.values() else "friction"
    known = entries(entries(Scenario)[section].section)
    assert {*kind.unread} <= known.keys()
    assert {*kind.unread}.isdisjoint(getattr(kind, "needed", ()))


def test_every_component_has_its_equations():
    """Builders and rules stand for the same words as the kinds."""
    assert {*DELIVERIES} == {name for name, kind in SUPPLIES.items() if kind.pumps}
    assert {*FORCES} == {*FRICTIONS}
    assert {*FEEDS} == {*ENDS}
    for name, law in LAWS.items():
        gains = ziegler_nichols(law=name, ultimate_gain=1.0, ultimate_period=1.0)
        assert (gains.integral_time < float("inf")) == law.integral
        assert (gains.derivative_time > 0) == law.derivative


def test_a_component_without_equations_is_refused():
    """At import, by the word that lacks them; and equations without a word."""
    bellows = replace(SUPPLIES["fixed_pump"], name="bellows")
    more = kinds("supply", *SUPPLIES.values(), bellows)
    with pytest.raises(ValueError, match="bellows: no entry"):
        per_kind({name: kind for name, kind in more.items() if kind.pumps}, DELIVERIES)
    with pytest.raises(ValueError, match="bellows: not a kind"):
        per_kind(SUPPLIES, dict.fromkeys([*SUPPLIES, "bellows"], abs))


def test_an_incomplete_shape_is_refused():
    """A piece that is missing, at import."""
    with pytest.raises(TypeError, match="course"):
        type(SHAPES["step"])("wave", "up and down", (), (), instead={}, lasts=False)
    with pytest.raises(ValueError, match="course is missing"):
        kinds("shape", replace(SHAPES["step"], name="wave", course=None))
    with pytest.raises(ValueError, match="duplicate name"):
        kinds("shape", *SHAPES.values(), SHAPES["step"])
