"""Charts: labels never touch, curves stay in their frames, and what has no value says why."""

from __future__ import annotations

import itertools
import json
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.rendering import heights, html, paper, terminal
from actuator_opt.rendering.blocks import Chart, Column, Table
from actuator_opt.rendering.chart import (
    Axis,
    Curve,
    Level,
    Panel,
    Points,
    ShadedMap,
    Stretch,
    scale,
)
from actuator_opt.rendering.chart_ink import drawn, titled
from actuator_opt.rendering.console import Console

ANY = st.floats(allow_nan=True, allow_infinity=True)
REAL = st.floats(-1e9, 1e9)
WORDS = st.sampled_from(["", "a", "measured", "Stribeck curve, 95 % band", "a name " * 9])


@st.composite
def pairs(draw, values, most=12):
    """Values of x and y, equally many."""
    both = draw(st.lists(st.tuples(values, values), max_size=most))
    return [x for x, _ in both], [y for _, y in both]


@st.composite
def panels(draw, values):
    """A panel of anything."""
    curves = [
        Curve(draw(WORDS), xs, ys, [y - 1 for y in ys], [y + 1 for y in ys], end=draw(WORDS))
        for xs, ys in draw(st.lists(pairs(values), max_size=4))
    ]
    points = [
        Points(
            draw(WORDS),
            xs,
            ys,
            [y - 1 for y in ys],
            ys,
            small=draw(st.booleans()),
            weight=draw(st.sampled_from(["normal", "guide", "strong"])),
        )
        for xs, ys in draw(st.lists(pairs(values), max_size=3))
    ]
    levels = draw(
        st.lists(
            st.builds(
                Level,
                values,
                WORDS,
                st.sampled_from(["", "min", "max"]),
                between=st.none() | st.tuples(REAL, REAL),
                upright=st.booleans(),
            ),
            max_size=5,
        )
    )
    ends = sorted(draw(st.lists(REAL, max_size=4, unique=True)))
    stretches = [
        Stretch(start, end, draw(st.sampled_from(["", "1", "12\nSR 2.5", "a long name"])), k)
        for k, (start, end) in enumerate(itertools.pairwise(ends))
    ]
    axes = [
        Axis(draw(st.sampled_from(["", "speed, mm/s"])), *draw(st.tuples(*[st.booleans()] * 3)))
        for _ in range(2)
    ]
    return Panel("Force, N", *axes, curves, points, levels, note=draw(WORDS), stretches=stretches)


def touching(ink):
    """Pairs of texts that overlap."""
    for one, other in itertools.combinations(ink.text_boxes(), 2):
        if not one[0].strip() or not other[0].strip():
            continue
        beside = one[3] <= other[1] + 0.01 or other[3] <= one[1] + 0.01
        if not (beside or one[4] <= other[2] + 0.01 or other[4] <= one[2] + 0.01):
            yield one, other


def corners(ink):
    """All corners of all paths."""
    return [p for mark in ink.marks if "path" in mark for line in mark["path"] for p in line]


def words(ink):
    """All words of a drawing."""
    return " ".join(mark["text"] for mark in ink.marks if "text" in mark)


@given(st.lists(st.lists(panels(REAL), min_size=1, max_size=2), min_size=1, max_size=2))
def test_labels_never_touch(columns):
    """Ticks, legends, notes, limits and ends of curves keep apart, and all stay on the paper."""
    ink = drawn(Chart("t", columns, height=120.0))
    assert list(touching(ink)) == []
    for text, left, top, right, bottom in ink.text_boxes():
        assert min(left, top, ink.width - right, ink.height - bottom) > -0.5, text
    for x, y in corners(ink):
        assert -0.8 <= x <= ink.width + 0.8
        assert -0.8 <= y <= ink.height + 0.8


@given(panels(ANY))
def test_any_value_is_drawn_or_left_out(panel):
    """NaN, infinity and absurd sizes: finite marks, and an empty frame says why."""
    ink = drawn(Chart("t", [panel]))
    json.dumps(ink.data(), allow_nan=False)
    assert ink.marks


@pytest.mark.parametrize(
    ("panel", "why"),
    [
        (Panel("F, N"), "No values."),
        (Panel("F, N", note="The record lies outside the stroke."), "outside the stroke"),
        (Panel("F, N", curves=[Curve("a", [1.0], [math.nan])]), "No value is a number."),
        (Panel("F, N", y=Axis(log=True), curves=[Curve("a", [1, 2], [0, -1])]), "above zero"),
    ],
)
def test_an_empty_frame_says_why(panel, why):
    """Nothing given, no number, no place on a logarithmic axis, or a stated reason."""
    assert why in words(drawn(Chart("t", [panel])))


def test_a_single_value_is_a_dot():
    """A curve of one value, or one between gaps, is drawn."""
    ink = drawn(Chart("t", [Panel("F, N", curves=[Curve("", [1.0], [5.0])])]))
    assert any(
        mark.get("fill") and len(mark["path"][0]) == 32 for mark in ink.marks if "path" in mark
    )


def test_a_million_values_keep_their_peak_in_few_marks():
    """A curve is thinned, its spike stays; points in one place are drawn once."""
    x = np.linspace(0.0, 1.0, 10**6)
    y = np.sin(20 * x)
    y[700_000] = 9.0
    curve = Panel("F, N", curves=[Curve("", x, y)])
    points = Panel("F, N", points=[Points("", x[:100_000], y[:100_000])])
    ink = drawn(Chart("t", [curve]))
    line = max((m["path"][0] for m in ink.marks if "path" in m), key=len)
    assert len(line) < 5000
    top = min(py for _, py in line)
    assert sum(py < top + 0.1 for _, py in line) == 1
    assert len(drawn(Chart("t", [points])).marks) < 20_000


def test_a_curve_ends_at_its_frame():
    """Beyond a stated range nothing is drawn."""
    x = np.linspace(-5, 5, 200)
    panel = Panel("F, N", Axis(range=(-1, 1)), Axis(range=(0, 4)), [Curve("", x, 3 * x)])
    ink = drawn(Chart("t", [panel]))
    (line,) = [m["path"] for m in ink.marks if "path" in m and m["pen"] == 0.4]
    ys = [y for part in line for _, y in part]
    grid = [m["path"][0] for m in ink.marks if "path" in m and m["pen"] == 0.1]
    edges = [y for part in grid for _, y in part]
    assert min(ys) >= min(edges) - 0.01
    assert max(ys) <= max(edges) + 0.01


def test_a_limit_is_named_and_hatched_on_its_forbidden_side():
    """At least 2: hatched below; a limit beyond the frame has an arrow."""
    curve = Curve("", [0, 1], [1, 3])
    for sense, side in (("min", 1.0), ("max", -1.0)):
        panel = Panel("F, N", curves=[curve], levels=[Level(2.0, "limit 2 N", sense)])
        ink = drawn(Chart("t", [panel]))
        (line,) = [m["path"][0] for m in ink.marks if "path" in m and m["dash"] == [1.8, 1.0]]
        hatched = [
            m for m in ink.marks if "path" in m and m["stroke"] == "#a8321a" and not m["dash"]
        ]
        ys = [y for m in hatched for part in m["path"] for _, y in part]
        assert all(side * (y - line[0][1]) >= -0.01 for y in ys)
        assert "limit 2 N" in words(ink)
    far = Panel("F, N", curves=[curve], levels=[Level(900.0, "limit 900 N", "max")])
    assert "limit 900 N ↑" in words(drawn(Chart("t", [far])))


def test_places_of_x_are_named_above_the_frame():
    """Upright limits are hatched on their forbidden side; stretches are shaded and named."""
    curve = Curve("", [0, 4], [1, 3])
    stretches = [Stretch(0.0, 2.0, "1\nSR 2.5"), Stretch(2.0, 4.0, "2", 1)]
    limit = Level(3.0, "limit 3 mm", "max", upright=True)
    panel = Panel("F, N", curves=[curve], levels=[limit], stretches=stretches)
    ink = drawn(Chart("t", [panel]))
    assert list(touching(ink)) == []
    (line,) = [m["path"][0] for m in ink.marks if "path" in m and m["dash"] == [1.8, 1.0]]
    assert line[0][0] == line[1][0]
    hatched = [m for m in ink.marks if "path" in m and m["stroke"] == "#a8321a" and not m["dash"]]
    assert all(x >= line[0][0] - 0.01 for m in hatched for part in m["path"] for x, _ in part)
    at = {m["text"]: m["at"] for m in ink.marks if "text" in m}
    top = min(y for _, y in line)
    assert at["1"][1] < at["SR 2.5"][1] < at["limit 3 mm"][1] < top
    assert at["1"][0] == at["SR 2.5"][0] < at["2"][0]
    fills = [m for m in ink.marks if "path" in m and m["fill"] and len(m["path"][0]) == 4]
    assert len({m["fill"] for m in fills}) == 2


def test_a_chart_alone_has_its_title_and_notes():
    """Title and notes above the panels, each line of the note below; nothing off the paper."""
    chart = Chart(
        "A long title " * 20, [Panel("F, N", curves=[Curve("a", [0, 1], [1, 2])])], "x\ny"
    )
    ink = titled(chart, ["a remark"])
    order = [
        m["text"] for m in sorted((m for m in ink.marks if "text" in m), key=lambda m: m["at"][1])
    ]
    assert order[0].startswith("A long title")
    assert order[1] == "a remark"
    assert order[-2:] == ["x", "y"]
    assert list(touching(ink)) == []
    assert all(b[1] >= 0 and b[3] <= ink.width and b[4] <= ink.height for b in ink.text_boxes())


def test_panels_of_a_column_share_the_axis_below():
    """Only the labelled panel has numbers of x; both have the same places."""
    x = [0.0, 10.0]
    upper = Panel("a", curves=[Curve("", x, x)])
    lower = Panel("b", Axis("time, s"), curves=[Curve("", [2.0, 8.0], x)])
    ink = drawn(Chart("t", [[upper, lower]]))
    assert words(ink).count("time, s") == 1
    lines = [m["path"][0] for m in ink.marks if "path" in m and m["pen"] == 0.4]
    (a, b), (c, d) = ([x for x, _ in line] for line in lines)
    assert (c - a) / (b - a) == pytest.approx(0.2, abs=1e-3)
    assert (d - a) / (b - a) == pytest.approx(0.8, abs=1e-3)


def test_a_map_shades_its_points():
    """The point of the largest value is the darkest, and a scale stands beside the frame."""
    xs, ys = np.linspace(1, 2, 5), np.linspace(1, 3, 4)
    surface = ShadedMap(xs, ys, np.outer(ys, xs) * 10)
    points = Points("", [1.2, 1.8], [1.5, 2.5], shades=[18.0, 45.0])
    ink = drawn(Chart("t", [Panel("c", points=[points], surface=surface)]))
    fills = [m["fill"] for m in ink.marks if "path" in m and m["fill"] and len(m["path"][0]) == 32]
    light, dark = fills[1], fills[3]
    assert int(light[1:3], 16) > int(dark[1:3], 16)


@given(st.lists(REAL, min_size=1, max_size=9), st.booleans(), st.booleans())
def test_scales_grow_with_their_values(values, log, signed):
    """Places ascend with the values and lie within the ends; ticks too."""
    values = sorted(values)
    found = scale(Axis(log=log, signed=signed), values)
    places = found.at(values)
    known = places[np.isfinite(places)]
    assert np.all(np.diff(known) >= 0)
    assert np.all((known >= found.range[0]) & (known <= found.range[1]))
    for across in (True, False):
        ticks = found.ticks(50.0, across=across)
        assert all(found.range[0] - 1e-9 <= at <= found.range[1] + 1e-9 for at, _ in ticks)


def test_a_chart_is_a_block():
    """Paper and HTML draw it, the terminal shows what stands instead, its height is known."""
    panel = Panel("F, N", curves=[Curve("a", [0, 1], [1, 2])])
    table = Table("F", [Column("x")], [["1"]])
    chart = Chart("Force", [panel], note="of a record", instead=table, height=50.0)
    (data,) = paper.plain_blocks([chart])
    assert data["ink"]["height"] == 50.0
    assert (data["title"], data["note"]) == ("Force", "of a record")
    assert heights.height(chart) > 50.0
    assert terminal.block_text(chart, Console()) == terminal.block_text(table, Console())
    assert terminal.block_text(Chart("Force", [panel]), Console()) == ""
    assert "<svg" in "".join(html._block(chart))
