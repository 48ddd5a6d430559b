"""Geometry that cannot be gives NaN in every model, and NaN only there."""

from __future__ import annotations

import dataclasses
import inspect
import math
import re

import numpy as np
import pytest
from model_samples import called, cases, leaves, public_functions

from actuator_opt.base.numeric import PAIRS, sizes
from actuator_opt.models import barrel, forces
from actuator_opt.models.layered_tube import TubeLayer, layered_tube, tube_state

SIGNED = {
    "angle_offset": "an angle",
    "area_gradient": "of a spool, checked when the file is read",
    "axial_force_per_pressure": "a force over a pressure",
    "compression": "below zero a body is off its stop",
    "deflection": "of a bristle, either way",
    "distance": "from a step in pressure, either way; of a wear path its factor",
    "eccentricity": "a place beside an axis",
    "energiser_slope": "a slope",
    "first": "of two roughnesses that enter by their squares",
    "free_shortening": "below zero the barrel lengthens",
    "growth": "of a bore, which may shrink",
    "interference": "below zero a lip does not touch",
    "largest_deflection": "of a bristle",
    "left_growth": "of a wall, which may shrink",
    "place": "distance from the bore; a thickness that is checked as such",
    "profile": "corners of a section",
    "ring_growth": "of a ring, which may shrink",
    "tube_growth": "of a wall, which may shrink",
    "least_lever_arm": "a lever arm has the sign of its motion",
    "lever_arm": "has the sign of the motion",
    "offset": "beside an axis",
    "overhang": "before or behind the guide",
    "overlap": "below zero the edges stand open",
    "points": "a table",
    "position": "along a stroke and beyond it",
    "remaining": "below zero a cushion has ended",
    "right_growth": "of a wall, which may shrink",
    "ring_limit": "a limit",
    "seal_limit": "a limit",
    "start": "a place in a wall",
    "second": "of two roughnesses that enter by their squares",
    "shear_modulus": "a modulus; its unit names a length of the same line",
    "spool_position": "either way",
    "squeeze": "below zero the contact is lost",
    "steps": "a table",
    "table": "a table",
    "rounding": "of a spool's edge, checked when the file is read",
    "spool": "a structure of lengths, checked when the file is read",
    "uncovered": "below zero the edge is covered",
}
"""Documented lengths that may be negative, or are no sizes, with the reason."""
LENGTH = re.compile(r"\[m(\^[234])?\]")


def documented_lengths(function):
    """Parameters of a docstring whose unit is a length, an area, a volume or a second moment."""
    text = inspect.getdoc(function) or ""
    section = re.search(r"Parameters\n-+\n(.*?)(?:\n\n[A-Z][a-z]+\n-+|\Z)", text, re.DOTALL)
    for entry in re.split(r"\n(?=\S)", section[1]) if section else ():
        names, _, said = entry.partition(" : ")
        if LENGTH.search(said):
            yield from (name.strip("*") for name in names.split(", "))


def named_leaves(value, name=""):
    """Argument names of a sample's numbers, in the order of `leaves`; a layer's as in its type."""
    if isinstance(value, bool | str) or value is None:
        return []
    if isinstance(value, dict):
        return [leaf for key, entry in value.items() for leaf in named_leaves(entry, key)]
    if isinstance(value, tuple | list):
        return [leaf for entry in value for leaf in named_leaves(entry, name)]
    if dataclasses.is_dataclass(value):
        own = [(f.name, getattr(value, f.name)) for f in dataclasses.fields(value)]
        inside = name if name == "layers" else None
        return [leaf for key, entry in own for leaf in named_leaves(entry, inside and key)]
    return [name]


CASES = [
    pytest.param(function, sample, id=label)
    for label, function, sample in cases()
    if "layer_thickness_for_strain" not in label  # refuses what has no solution
]


def test_every_documented_length_is_a_size_or_may_be_negative():
    """Each argument in m, m^2, m^3 or m^4 is checked, or stands in SIGNED with its reason."""
    loose = {
        name: label
        for label, function in public_functions().items()
        for name in documented_lengths(function)
        if name not in sizes(inspect.unwrap(function))
    }
    assert set(loose) <= set(SIGNED), {n: loose[n] for n in set(loose) - set(SIGNED)}


@pytest.mark.parametrize(("function", "sample"), CASES)
def test_a_negative_size_is_nan_and_its_neighbours_are_not(function, sample):
    """Of two elements of an array the one with a negative size is NaN, the other as alone."""
    names, numbers = named_leaves(sample), np.array(leaves(sample), dtype=float)
    known = set(sizes(inspect.unwrap(function))) | {"thickness"}
    regular = called(function, sample, [*numbers], 0)
    for index, name in enumerate(names):
        if name not in known or numbers[index] == 0:
            continue
        more = numbers.copy()
        more[index] *= 1.01
        moved = called(function, sample, [*more], 0)
        negative = numbers.copy()
        negative[index] *= -1
        both = np.stack((numbers, negative), axis=1)
        found = called(function, sample, [*both], 1)
        for value, alone, other in zip(found, regular, moved, strict=True):
            if other == pytest.approx(alone, rel=1e-12, nan_ok=True):
                continue  # does not depend on it
            assert value[0] == pytest.approx(alone, rel=1e-9), name
            assert math.isnan(np.real(value[1])), name


@pytest.mark.parametrize(
    "label", [n for n, f in public_functions().items() if sizes(inspect.unwrap(f))]
)
def test_what_lies_inside_is_smaller(label):
    """The greater size of a pair at or below the lesser gives NaN."""
    for case, function, sample in cases():
        if case.split("-")[0] != label or not isinstance(sample, dict):
            continue
        for greater, lesser in PAIRS:
            if greater in sample and lesser in sample:
                for factor in (1.0, 0.9):
                    changed = {**sample, greater: sample[lesser] * factor}
                    for value in called(function, changed, leaves(changed), 0):
                        assert math.isnan(value)


def test_a_layer_of_negative_thickness_has_no_growth():
    """The tube of the issue: a thickness of -1 mm gave a growth of -8.9 um."""
    steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=-1e-3)], inner_radius=16e-3)
    state = tube_state(tube=tube, inner_pressure=25e6)
    assert np.isnan(state.bore_displacement)


def test_the_examples_of_the_issue():
    """A bore's growth with the outer radius inside, a rod wider than its bore."""
    metal = {"youngs_modulus": 71.7e9, "poissons_ratio": 0.33, "pressure": 25e6}
    for outer in (16e-3, 12e-3, -20e-3):
        growth = barrel.bore_growth(
            inner_radius=16e-3, outer_radius=outer, axial_force=0.0, **metal
        )
        assert math.isnan(growth)
    assert math.isnan(forces.annulus_area(bore=10e-3, rod_diameter=12e-3))
