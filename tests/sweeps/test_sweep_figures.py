"""Figures of a sweep: lines where limits are just met, Pareto lines, what is drawn of many rows."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from cases.digests import digest
from hypothesis import given, strategies as st
from sweep_case import KNEE, NEAR, STEEL, WAYS

import actuator_opt as ao
from actuator_opt.api import reports
from actuator_opt.base.bounds import SWEEP_FIGURES
from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.pages.sweep import page
from actuator_opt.pages.sweep_figures import shared
from actuator_opt.pages.sweep_figures.contour import contour_figure
from actuator_opt.pages.sweep_figures.shared import (
    SweepFigure,
    SweepFigureData,
    fits,
    sweep_figures,
)
from actuator_opt.pages.sweep_figures.ucurves import differences
from actuator_opt.rendering import html, paper, terminal
from actuator_opt.sweeps import result
from actuator_opt.sweeps.field import field
from actuator_opt.sweeps.result import Pool, better, front

GRID = ["cylinder.bore=20.6..22 mm:9", "barrel.layup[1].thickness=2.2..3.6 mm:9"]
PAIR = ("mass", "stiffness_min")
LIMITED = NEAR | {"requirements.friction_running.max": "246.5 N"}
"""Designs of the grid that meet all else run at 245.3 N to 248.0 N: a limit between them."""


@pytest.fixture(scope="module")
def knee():
    """A knee some of whose neighbours meet everything."""
    return ao.read(KNEE, set=NEAR)


@pytest.fixture(scope="module")
def swept():
    """A grid of it, with a limit of friction inside."""
    return ao.sweep(ao.read(KNEE, set=LIMITED), GRID)


@pytest.fixture(scope="module")
def mixed(knee):
    """Random points of it, with a name."""
    vary = [*WAYS, "rod.material=steel_42crmo4,ti_6al4v"]
    return ao.sweep(knee, vary, method="sobol", n=256, figures=["scatter"])


def overlaps(ink):
    """Pairs of unrotated texts that lie on one another, and those beyond the paper."""
    boxes = ink.text_boxes()
    out = [b[0] for b in boxes if b[1] < 0 or b[2] < 0 or b[3] > ink.width or b[4] > ink.height]
    both = [
        (a[0], b[0])
        for a, b in combinations(boxes, 2)
        if a[1] < b[3] - 0.1 and b[1] < a[3] - 0.1 and a[2] < b[4] - 0.1 and b[2] < a[4] - 0.1
    ]
    return out + both


@pytest.mark.long
def test_boundaries_pass_where_the_margin_is_zero(swept):
    """Points of every line, each read and evaluated by itself, just meet their limit."""
    found = list(field(swept.study).boundaries())
    names = {swept.study.limits[one.number] for one in found}
    assert {"stiffness_min", "friction_running", "seal_gap", "buckling_factor"} <= names
    paths = [axis.path for axis in swept.study.plan.axes]
    for one in found:
        name = swept.study.limits[one.number]
        points = np.concatenate(one.lines)
        for point in points[:: max(1, len(points) // 3)]:
            values = {path: str(float(x)) for path, x in zip(paths, point, strict=True)}
            alone = ao.evaluate(ao.read(KNEE, set=LIMITED | values))
            margins = [row.margin for row in alone.requirements if row.name == name]
            margins += [
                row.margin
                for row in alone.checks
                if row.name == name and getattr(row, "margin", None) is not None
            ]
            assert margins, name
            assert min(margins) == pytest.approx(0.0, abs=1e-7), (name, point)


def test_the_hatched_side_is_the_missed_one(swept):
    """Nodes inside a missed area miss its limit, nodes outside meet it."""
    from matplotlib.path import Path

    grid = field(swept.study)
    nodes = np.array([(x, y) for x in grid.xs for y in grid.ys])
    inner = np.array([(0 < k // 9 < 8) and (0 < k % 9 < 8) for k in range(81)])
    for one in grid.boundaries():
        inside = np.zeros(len(nodes), dtype=bool)
        for area in one.missed:
            for ring in area:
                inside ^= Path(ring).contains_points(nodes)
        missed = grid.margins[one.number].ravel() < 0
        assert (inside == missed)[inner].all(), swept.study.limits[one.number]


def test_what_is_just_met_is_not_hatched():
    """Nodes that meet a limit to rounding count as met, as in every verdict."""
    vary = ["retention.length=18.6..21 mm:5", "caps.thickness=5.6..6.4 mm:5"]
    near = ao.evaluate(ao.read(KNEE, set=NEAR))
    limit = near.metrics["seal_squeeze"].value * (1 + 1e-12)
    changes = NEAR | {"requirements.seal_squeeze.min": str(limit)}
    swept = ao.sweep(ao.read(KNEE, set=changes), vary)
    grid = field(swept.study)
    number = swept.study.limits.index("seal_squeeze")
    assert (grid.margins[number] > 0).all()
    assert number not in {one.number for one in grid.boundaries()}
    assert grid.room[number] > 0
    assert not grid.room[swept.study.limits.index("stiffness_min")]


def test_a_limit_that_varies_has_its_boundary_too(knee):
    """Where the limit is an axis, the line is the metric itself."""
    vary = ["requirements.stiffness_min.min=8..12 kN/mm:5", "cylinder.bore=20.6..22 mm:5"]
    swept = ao.sweep(knee, vary)
    one = next(
        b
        for b in field(swept.study).boundaries()
        if swept.study.limits[b.number] == "stiffness_min"
    )
    for limit, bore in np.concatenate(one.lines)[::2]:
        alone = ao.evaluate(ao.read(KNEE, set=NEAR | {"cylinder.bore": str(float(bore))}))
        assert alone.metrics["stiffness_min"].value == pytest.approx(limit, rel=1e-7)


def test_where_the_rod_has_no_wall_there_is_no_design(knee):
    """A rod thinner than its bore (5.3 mm) has no margin but those of its shape."""
    swept = ao.sweep(knee, ["rod.outer_diameter=4..12 mm:9", "cylinder.bore=20.6..22 mm:3"])
    grid = field(swept.study)
    assert grid.failed.tolist() == [[bool(diameter < 5.3e-3)] * 3 for diameter in grid.xs]
    place = swept.study.limits.index("stiffness_min")
    assert np.isnan(grid.margins[place][grid.failed]).all()
    assert np.isfinite(grid.margins[place][~grid.failed]).all()
    walls = grid.margins[swept.study.limits.index("geometry_rod_wall")]
    expected = ((grid.xs - 5.3e-3) / 2 - 1e-3) / 1e-3  # at least 1 mm
    assert walls == pytest.approx(np.tile(expected[:, None], 3))


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=40))
def test_a_front_is_what_nothing_betters(points):
    """Against every pair compared, less being better in both."""
    values = np.array(points, dtype=float).reshape(-1, 2)
    kept = {tuple(values[k]) for k in front(values[:, 0], values[:, 1])}
    expected = {
        (x, y)
        for x, y in points
        if not any(a <= x and b <= y and (a, b) != (x, y) for a, b in points)
    }
    assert kept == expected
    assert len(front(values[:, 0], values[:, 1])) == len(kept)


def test_the_pareto_line_is_of_every_feasible_design(knee, monkeypatch):
    """However few rows are kept, it is that of all rows, found by comparing all pairs."""
    whole = ao.sweep(knee, WAYS, method="lhs", n=300)
    rows = whole.sample.feasible.rows
    assert len(rows) == whole.feasible > 20
    mass, stiffness = (rows[:, whole.study.place(name)] for name in PAIR)
    assert [better(whole.study, name) for name in PAIR] == [-1, 1]
    expected = {
        (m, s)
        for m, s in zip(mass, stiffness, strict=True)
        if not ((mass <= m) & (stiffness >= s) & ((mass < m) | (stiffness > s))).any()
    }
    monkeypatch.setattr(result, "MOST_POINTS", 8)
    few = ao.sweep(knee, WAYS, method="lhs", n=300, figures=["scatter"], show=PAIR)
    assert len(few.sample.feasible.rows) <= 8
    for pair in (PAIR, PAIR[::-1]):
        values, exact = few.sample.front(few.study, pair)
        assert exact
        assert {tuple(one[:: 1 if pair == PAIR else -1]) for one in values.T} == expected
    assert not few.sample.front(few.study, ("mass", "seal_gap"))[1]


@given(st.lists(st.integers(0, 25), max_size=12))
def test_what_is_kept_is_every_kth_row(sizes):
    """Whatever the chunks, the kept rows are those of numbers 0, k, 2k, ... and not too few."""
    pool, most, total = Pool(), result.MOST_POINTS, 0
    result.MOST_POINTS = 10
    try:
        for size in sizes:
            rows = np.arange(total, total + size, dtype=float)[:, None]
            pool.add(rows[:, 0].astype(int), rows)
            total += size
    finally:
        result.MOST_POINTS = most
    assert pool.rows.ravel().tolist() == list(range(0, total, pool.step))
    assert len(pool.rows) <= 10
    assert pool.step == 1 or len(pool.rows) >= 5


@pytest.mark.parametrize(
    ("kinds", "show"),
    [
        (["parallel", "ucurves"], []),
        (["scatter"], []),
        (["scatter"], list(PAIR)),
        (["scatter"], [*PAIR, "friction_running", "seal_gap", "power", "bore_growth", "flow"]),
    ],
)
def test_figures_are_whole_and_clear(mixed, kinds, show):
    """No words on others or beyond the paper."""
    for name, ink in sweep_figures(mixed, kinds, show).items():
        assert not overlaps(ink), name


def test_contours_are_whole_and_clear(swept):
    """Every boundary is named at its line or by a letter of the key."""
    grid = field(swept.study)
    lines = list(grid.boundaries())
    drawn = SweepFigureData(swept)
    for metric in PAIR:
        ink = contour_figure(drawn, grid, lines, metric)
        assert not overlaps(ink)
        said = " ".join(mark["text"] for mark in ink.marks if "text" in mark)
        for one in lines:
            assert drawn.limit_words(swept.study.binding[one.number]) in said


@pytest.mark.long
def test_same_sweep_same_bytes(knee, tmp_path):
    """Two runs into two folders write the same files."""
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        ao.sweep(
            knee, GRID, figures=["parallel", "scatter", "contour", "ucurves"], show=PAIR, out=folder
        )
    names = sorted(path.name for path in folders[0].iterdir())
    assert names == sorted(
        f"robot_knee-sweep-{name}.{kind}"
        for name in ("parallel", "scatter", "ucurves", *(f"contour-{one}" for one in PAIR))
        for kind in ("png", "svg")
    )
    for name in names:
        assert digest(folders[0] / name) == digest(folders[1] / name)


@pytest.mark.parametrize(
    ("vary", "how", "kinds", "show", "said"),
    [
        (WAYS[:1], {"method": "lhs", "n": 4}, ["contour"], [], "exactly two --vary, not 1"),
        (WAYS, {"method": "lhs", "n": 4}, ["contour"], [], "needs a grid, not --method lhs"),
        ([*GRID, "caps.thickness=4..5 mm:2"], {}, ["contour"], [], "exactly two --vary, not 3"),
        ([GRID[0], "rod.material=steel_42crmo4,ti_6al4v"], {}, ["contour"], [], "takes names"),
        ([GRID[0], "caps.thickness=5 mm"], {}, ["contour"], [], "at least two values of caps"),
        (GRID, {}, ["scatter"], ["mas"], 'did you mean "mass"'),
        (GRID, {}, ["scatter"], ["mass"], "two metrics or more"),
        (GRID, {}, ["pie"], [], "--figure pie: unknown"),
    ],
)
def test_figures_that_cannot_be_are_refused_before_the_work(
    knee, monkeypatch, vary, how, kinds, show, said
):
    """One line each; nothing has run."""
    monkeypatch.setattr("actuator_opt.sweeps.run._computed", None)
    with pytest.raises(UsageError) as fault:
        ao.sweep(knee, vary, figures=kinds, show=show, **how)
    assert said in str(fault.value)
    assert len(fault.value.diagnostics) == 1


def test_a_metric_without_values_is_told(swept, tmp_path):
    """A film under seals that have none; nothing is written."""
    missing = next(
        name
        for name in swept.study.metrics
        if np.isnan(swept.sample.others.rows[:, swept.study.place(name)]).all()
        and all(np.isnan(row[swept.study.place(name)]) for row in swept.sample.feasible.rows)
    )
    for kind in ("parallel", "scatter", "contour"):
        with pytest.raises(InputError, match="it has no value for any design of this sweep"):
            ao.draw_sweep(swept, [kind], show=["mass", missing], out=tmp_path / "figures")
    assert not (tmp_path / "figures").exists()


@pytest.mark.long
def test_without_a_feasible_design_the_results_are_still_told(tmp_path):
    """The command prints the sweep, then one line; in JSON both in one object."""
    command = [sys.executable, "-m", "actuator_opt", "sweep", STEEL, "--vary"]
    command += ["cylinder.bore=18..20 mm:3", "--figure", "ucurves", "--out", str(tmp_path)]
    found = subprocess.run(command, capture_output=True, text=True)
    assert "3 variants" in found.stdout
    assert found.stderr.count("\n") == 1
    assert "no feasible design among 3 variants" in found.stderr
    told = subprocess.run([*command, "--json"], capture_output=True, text=True)
    data = json.loads(told.stdout)
    assert data["requested"] == 3
    assert "no feasible design" in data["errors"][0]["message"]
    assert found.returncode == told.returncode == 3
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_a_reduced_sweep_computes_what_is_shown(knee, tmp_path):
    """--reduce leaves metrics out, but for those of the figures; contours need no kept rows."""
    swept = ao.sweep(
        knee, GRID, reduce=True, figures=["contour", "ucurves"], show=["power"], out=tmp_path
    )
    assert "power" in swept.study.metrics
    assert "flow" not in swept.study.metrics
    assert len(list(tmp_path.iterdir())) == 4
    with pytest.raises(UsageError, match="need every design"):
        ao.sweep(knee, GRID, reduce=True, figures=["parallel"])


def test_differences_of_curves_are_those_from_the_first():
    """A tenth stiffer everywhere is 10 %, as far as both curves go; the first is at 0."""
    curves = [([0.0, 10.0, 30.0], [4.0, 2.0, 3.0]), ([0.0, 20.0, 40.0], [4.4, 2.75, 5.0])]
    first, second = differences([tuple(map(np.array, curve)) for curve in curves])
    assert first.ys.tolist() == [0.0, 0.0, 0.0]
    assert second.xs.tolist() == [0.0, 20.0]  # at 40 mm the first curve has ended
    assert second.ys == pytest.approx([10.0, 10.0])


def test_the_page_of_a_sweep(knee, tmp_path):
    """On paper and in HTML with parallel axes; without a feasible design it says why."""
    swept = ao.sweep(knee, GRID, workers=1)
    sheet = page(swept)
    assert sheet.hero(100.0).width == 180.0
    assert sheet.hero(100.0).marks
    origin = reports.origin(knee.design, knee.source)
    files = paper.write(sheet, origin, folder=tmp_path, stem="sweep")
    assert files[0].pages == 1
    assert "Best designs" in html.document(sheet, origin)
    missed = page(ao.sweep(STEEL, ["cylinder.bore=18..20 mm:3"], workers=1))
    assert not missed.hero(100.0).marks
    assert "None meets every requirement" in terminal.text(missed, width=200)


@pytest.mark.parametrize("kind", SWEEP_FIGURES)
def test_every_figure_of_a_sweep_is_whole(kind):
    """Its module states a complete figure; modules with a figure are listed."""
    own = shared.figure(kind)
    assert callable(own.check)
    assert callable(own.draw)
    folder = Path(shared.__file__).parent
    modules = {
        file.stem for file in folder.glob("*.py") if "\nFIGURE = " in file.read_text("utf-8")
    }
    assert modules == {*SWEEP_FIGURES}
    assert len(modules) == len(SWEEP_FIGURES)
    assert all(re.fullmatch(r"[a-z_]+", word) for word in SWEEP_FIGURES)


def test_a_figure_that_forgets_a_piece_is_refused():
    """At import of its module."""
    with pytest.raises(TypeError, match="draw"):
        SweepFigure(every=True, lines=False, check=fits)
