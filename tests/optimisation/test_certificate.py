"""The certificate is valid: no design that meets the limits is cut off, or below the bound."""

from __future__ import annotations

import math

import numpy as np
import pytest
from certificate_cases import HEAVIER, case

from actuator_opt.optimisation.certificate.bounding import Bounding
from actuator_opt.optimisation.certificate.certify import BOXES, BoxSearch, certify
from actuator_opt.optimisation.certificate.intervals import Box, Layout

FREE_PRESSURE = (
    ("variables.supply.pressure.lower", "150 bar"),
    ("variables.supply.pressure.upper", "210 bar"),
)
CASES = {
    "steel": ("steel_baseline", ("piston.material", "al_7075_t6")),
    "knee_bonded": ("knee_bonded",),
    "knee sized by strength": (
        "knee_bonded",
        ("requirements.proof_factor.min", "2.6"),
        ("requirements.seal_gap.max", "60e-6"),
        ("requirements.stiffness_min.min", "4e6"),
    ),
    "aerospace": ("aerospace",),
    "knee of free pressure": ("knee_bonded", *FREE_PRESSURE),
    "steel of free pressure": ("steel_baseline", *FREE_PRESSURE),
}
ROUNDING = 1e-9
"""Relative rounding of traced values."""


LONG = {
    "aerospace",
    "knee_bonded",
    "knee sized by strength",
    "knee of free pressure",
    "steel of free pressure",
    "knee sized by growth",
    "knee of 90 mm, sized by stiffness",
}
"""Slow cases; ``-m long`` runs them."""


def marked(names, long=frozenset()):
    """Names as parameters, those of `LONG` and `long` marked."""
    marks = {name: [pytest.mark.long] if name in LONG | long else [] for name in names}
    return [pytest.param(name, marks=found) for name, found in marks.items()]


@pytest.fixture(params=marked(CASES), scope="module")
def some(request):
    """A case with designs that meet every limit."""
    found = case(*CASES[request.param])
    return found, found.designs(15, 1)


def columns(bounding: Bounding, layout: Layout, y):
    """Every column of the linear programme at given atoms."""
    forms = layout.levels + np.bincount(layout.form, layout.power * y[layout.atom])
    found = np.zeros(bounding.columns)
    found[bounding.column] = forms[: len(bounding.column)]
    found[: len(y)] = y
    return found


def around(layout: Layout, root: Box, ways, rng) -> Box:
    """A part of the root box that holds a design, by random splits."""
    box = root
    for _ in range(rng.integers(0, 12)):
        number = int(rng.integers(layout.directions))
        at = rng.uniform(box.low[number], box.high[number])
        parts = box.split(number, at)
        box = parts[0 if ways[number] <= at else 1].tightened(layout)
    return box


def test_designs_meet_the_relaxation(some):
    """Designs that meet every limit lie in the root box and meet every row, curve and link."""
    found, designs = some
    relaxation, functions = found.relaxed.relaxation, found.layout.functions
    for x in designs:
        y = found.atoms(x)
        assert (found.root.lower - ROUNDING <= y).all()
        assert (y <= found.root.upper + ROUNDING).all()
        assert all(row.low.at(y) <= row.high.at(y) + ROUNDING for row in relaxation.rows)
        argument = np.array([curve.argument.at(y) for curve in relaxation.curves])
        out = np.array([curve.out.at(y) for curve in relaxation.curves])
        assert (np.abs(functions.value(argument) - out) <= functions.room + ROUNDING).all()
        for one in relaxation.products:
            product = math.exp(one.level) * y[one.first] * y[one.second]
            assert y[one.out] == pytest.approx(product, rel=ROUNDING)
        least, most = found.layout.ratios(found.root)
        for k, link in enumerate(found.layout.links):
            assert least[k] - ROUNDING <= y[link.out] / y[link.base] <= most[k] + ROUNDING


def test_parts_keep_their_designs_above_their_bound(some):
    """A part of the space keeps its designs: ranges, chords and tangents hold, bounds are below."""
    found, designs = some
    rng, layout = np.random.default_rng(2), found.layout
    bounding = Bounding(layout, found.relaxed.objective)
    bounding.add_first_tangents(found.root)
    for x in designs:
        y = found.atoms(x)
        point = columns(bounding, layout, y)
        box = around(layout, found.root, point[bounding.direction_columns], rng)
        bound = bounding.solve(box)
        lower, upper = bounding.enter(box)
        assert (lower - ROUNDING <= point).all()
        assert (point <= upper + ROUNDING).all()
        rows = bounding.matrix @ point
        assert (bounding.low - ROUNDING <= rows).all()
        assert (rows <= bounding.high + ROUNDING).all()
        lines = bounding.lines
        values = point[lines.out] + lines.coefficient * point[lines.ratio]
        assert (lines.low - ROUNDING <= values).all()
        assert (values <= lines.high + ROUNDING).all()
        objective = found.relaxed.objective.at(y)
        assert bound.value <= objective + ROUNDING
        kept = bounding.trimmed(box, bound, objective)
        assert (kept.lower - ROUNDING <= y).all()
        assert (y <= kept.upper + ROUNDING).all()


def test_objective_of_the_relaxation_is_that_of_the_design(some):
    """The relaxation's objective at a design is the evaluated one."""
    found, designs = some
    masses = found.actuator.problem.rows(designs.T)[0]
    there = [math.exp(found.relaxed.objective.at(found.atoms(x))) for x in designs]
    assert there == pytest.approx(masses, rel=1e-12)


@pytest.mark.long
def test_no_design_lies_below_the_bound(some):
    """The bound of a short search is no more than any design's objective, and only rises."""
    found, designs = some
    bounding = Bounding(found.layout, found.relaxed.objective)
    heard: list[float] = []
    best = math.log(HEAVIER * found.objective)
    bound = BoxSearch(found.layout, bounding, best, max_boxes=5).run(heard.append).bound
    masses = found.actuator.problem.rows(designs.T)[0]
    assert math.exp(bound) <= masses.min()
    assert heard == sorted(heard)


GAPS = {
    "steel in short": (CASES["steel"], 0.12),
    "steel": (CASES["steel"], 0.002),
    "knee_bonded": (("knee_bonded",), 0.16),
    "knee of 90 mm, sized by stiffness": (
        ("knee_bonded", ("cylinder.stroke", "90 mm"), ("requirements.stiffness_min.min", "12e6")),
        0.12,
    ),
    "knee sized by growth": (
        (
            "knee_bonded",
            ("requirements.seal_gap.max", "33e-6"),
            ("requirements.stiffness_min.min", "6e6"),
        ),
        0.05,
    ),
    "knee sized by strength": (CASES["knee sized by strength"], 0.13),
}
"""Designs with the gap that the proof leaves at most.

The knee as shipped runs at 248 N of friction: its limit of 290 N is slack and no longer sizes the
bore, so that the bound of knee and 90 mm rests on looser limits.
"""


@pytest.mark.parametrize("name", marked(GAPS, long={"steel"}))
def test_bound_and_gap(name):
    """The bound is below the optimum, closest on metal; every limit is covered or dropped.

    On metal, twice the boxes close the gap; with fewer it depends on the machine's last bits. A
    quarter of them leaves 9 %.
    """
    what, gap = GAPS[name]
    found = case(*what)
    most = {"steel": 2 * BOXES, "steel in short": BOXES // 4}.get(name, BOXES)
    relaxed, bound = certify(
        found.actuator, found.x, found.objective, seconds=math.inf, max_boxes=most
    )
    assert (1 - gap) * found.objective <= math.exp(bound.bound) <= found.objective
    told = [claim.limit.name for claim in relaxed.covered] + list(relaxed.dropped)
    for row in found.actuator.rows:
        assert any(one.startswith(row.limit_of.name) for one in told), row.label


@pytest.mark.long
def test_nothing_is_left_below_what_is_proven():
    """A box without a design no worse than a tenth of the best is empty, or bound above it."""
    found = case(*CASES["steel"])
    bounding = Bounding(found.layout, found.relaxed.objective)
    bound = BoxSearch(found.layout, bounding, math.log(0.1 * found.objective), max_boxes=3).run()
    assert bound.closed
