"""Designs that are the same to a model are given to it once, and every design gets its answer."""

from dataclasses import dataclass

import numpy as np
import pytest

from actuator_opt.evaluation.barrel.laminate import FEW, distinct


@dataclass(frozen=True)
class _Part:
    width: object
    name: str = "part"


def _model(*, parts, load, share):
    """Something of every argument, (cases, designs)."""
    return sum(part.width**2 for part in parts) * np.sin(load) + share


@pytest.mark.parametrize("points", [1, 4, 9])
def test_every_design_gets_its_own_answer(points):
    """Copies of a point that differ in what the model does not take are one design to it."""
    rng = np.random.default_rng(points)
    copies = 12
    width = np.repeat(rng.random(points) + 1, copies).astype(complex)
    width[::copies] += 1e-30j  # one copy of every point has a step of its own
    load = np.repeat(rng.random((2, points)), copies, axis=-1)
    given = {"parts": [_Part(width), _Part(3.0)], "load": load, "share": 0.5}
    some, every = distinct(given)
    expected = _model(**given)
    np.testing.assert_array_equal(every(_model(**some)), expected)
    if points * copies > FEW:
        assert some["load"].shape == (2, 2 * points)
        assert some["parts"][0].width.shape == (2 * points,)
        assert some["parts"][1] == _Part(3.0)
    else:
        assert some["load"] is load


def test_designs_that_all_differ_are_left_alone():
    """Nothing is taken out where nothing repeats, nor where there are no designs."""
    load = np.random.default_rng(0).random((2, 5 * FEW))
    some, every = distinct({"load": load, "share": np.ones((3, 1))})
    assert some["load"] is load
    assert every(load) is load
    some, _ = distinct({"share": 2.0, "names": ("a", "b")})
    assert some == {"share": 2.0, "names": ("a", "b")}


def test_what_does_not_depend_on_the_design_stays_so():
    """An answer with one column for all designs keeps it."""
    given = {"load": np.repeat([1.0, 2.0], 2 * FEW)}
    _, every = distinct(given)
    assert every(np.ones((3, 1))).shape == (3, 1)
    assert every(np.ones((3, 2))).shape == (3, 4 * FEW)
