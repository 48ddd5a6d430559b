"""The page of an Identification: its numbers, its figures, its words, its bytes; the terminal."""

from __future__ import annotations

import doctest
import hashlib
import itertools
import json
import math
import re
import struct
from dataclasses import replace

import identification_case as case
import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.identification.record import Record
from actuator_opt.pages import (
    identification as rows,
    identification_figures as figures,
    read_attachment,
)
from actuator_opt.rendering import axes, chart, paper, paper_plain as fallback, terminal
from actuator_opt.rendering.blocks import Origin
from actuator_opt.rendering.chart import Axis
from actuator_opt.rendering.series import csv_text

ORIGIN = Origin(case.SOURCE, "a.yaml", "identify r.csv", "12ab")
USUAL = ("plateaus", "outside", "levels", "one way", "bare")
"""Kinds of records that between them have every table, figure and reason."""


def each(kinds):
    """Parameters of a test; the unusual kinds are marked long."""
    return [x if x in USUAL else pytest.param(x, marks=pytest.mark.long) for x in kinds]


EACH = each(case.KINDS)
WITH_CURVE = each(x for x in case.KINDS if x not in ("pre-sliding", "one speed", "bare"))
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def paged(kind):
    """The page of a kind of record as data."""
    return paper.plain(rows.page(case.identified(kind)), ORIGIN)


def written(identification, tmp_path):
    """Its report as files."""
    sha256 = rows.samples_hash(identification.record)
    page = rows.page(identification)
    return paper.write(page, ORIGIN, folder=tmp_path, stem="s", record_sha256=sha256)


def text(identification, *, colour=False, unicode=True, width=100):
    """Its text for the terminal."""
    return terminal.text(rows.page(identification), colour=colour, unicode=unicode, width=width)


def printed(words):
    """Number that a text begins with, and what its rounding may hide."""
    words = words.replace("\N{MINUS SIGN}", "-").replace("\N{NARROW NO-BREAK SPACE}", "")
    match = re.match(r"(-?)(\d+(?:\.(\d+))?)(?:×10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+))?", words)
    power = int(match[4].translate(_RAISED)) if match[4] else 0
    value = float(match[1] + match[2]) * 10.0**power
    return value, 0.5001 * 10.0 ** (power - len(match[3] or ""))


def agrees(words, value):
    """Whether a text shows a value, rounded; None and infinity show as infinity."""
    if value is None:
        return words in ("∞", "\N{MINUS SIGN}∞")
    number, hidden = printed(words)
    return abs(number - value) <= hidden + 1e-12 * abs(value)


def tables(data):
    """All tables of a page, by title."""
    pair = data["blocks"][0]
    assert pair["kind"] == "pair"
    return {one["title"].partition(",")[0]: one for side in pair["sides"] for one in side}


def words_of(data):
    """All words of a page, blanks made one."""
    found = []

    def walk(one):
        if isinstance(one, str):
            found.append(one)
        elif isinstance(one, dict):
            for value in one.values():
                walk(value)
        elif isinstance(one, list):
            if one and all(isinstance(value, str) for value in one):
                found.append("".join(one))
            for value in one:
                walk(value)

    walk(data)
    return re.sub(r"\s+", " ", " ".join(found))


def drawn(kind, height=100.0):
    """The figure of a kind of record."""
    return figures.identification_figure(case.identified(kind), height)


# ---- numbers ----


@pytest.mark.parametrize("kind", EACH)
def test_parameters_are_those_of_the_json(kind):
    """Value, bounds and verdict of every parameter of both models, in the declared units."""
    found = case.identified(kind).to_dict()
    shown = tables(paged(kind))
    for key, title in (("stribeck", "Stribeck curve"), ("lugre", "LuGre model")):
        if found[key] is None:
            assert title not in shown
            continue
        body = shown[title]["rows"]
        assert len(body) == len(found[key])
        ordered = [name for name in rows.PARAMETERS if name in found[key]]
        for name, row in zip(ordered, body, strict=True):
            one, scale = found[key][name], rows.PARAMETERS[name].scale
            for cell, end in zip(row[2:5], ("value", "lower", "upper"), strict=True):
                value = one[end]
                assert agrees(cell, None if value is None else value * scale), (name, end)
            assert row[5]["text"] == {"identifiable": "yes", "weakly identifiable": "weakly"}.get(
                one["verdict"], "no"
            )


@pytest.mark.parametrize("kind", EACH)
def test_fits_are_those_of_the_json(kind):
    """Parameters of both fits in kN s/m and s/m, in order; a fit without a value has no row."""
    found = case.identified(kind).to_dict()["fits"]
    wanted = []
    for fit in found.values():
        for name, one in fit.get("parameters", {}).items():
            wanted.append(one["value"] * (1e-3 if "coefficient" in name else 1.0))
    shown = tables(paged(kind)).get("Secant damping", {"rows": []})["rows"]
    assert len(shown) == len(wanted)
    assert all(agrees(row[2], value) for row, value in zip(shown, wanted, strict=True))


@pytest.mark.parametrize("kind", EACH)
def test_key_figures_are_those_of_the_json(kind):
    """Mean with bounds, maximum, both pressures, Coulomb friction, coefficient of friction."""
    found = case.identified(kind).to_dict()
    tiles = {tile["label"]: tile for tile in paged(kind)["tiles"]}
    force = found["friction"]
    slides = "while sliding" if force["slides"] else "without sliding"
    mean = tiles[next(name for name in tiles if name.startswith("mean") and name.endswith(slides))]
    assert agrees(mean["value"], force["mean"])
    low, _, high = mean["note"].removeprefix("95 %: ").partition(" to ")
    assert agrees(low, force["lower"])
    assert agrees(high, force["upper"])
    assert agrees(tiles["maximum friction"]["value"], force["max"])
    loss = tiles["equivalent pressure loss"]
    assert agrees(loss["value"], force["pressure_loss"] / 1e5)
    assert agrees(loss["note"], force["pressure_loss_max"] / 1e5)
    mu = tiles["friction coefficient"]
    if found["mu"] is None:
        assert mu["value"] == "–"
    else:
        assert agrees(mu["value"], found["mu"]["value"])
        note = mu["note"].removeprefix("contact pressure ")
        assert agrees(note, found["mu"]["contact_pressure"] / 1e6)
        assert found["mu"]["contact_law"] in words_of(paged(kind))


def test_channels_tell_what_was_mended():
    """Samples missing, spikes and clipped of every channel, and its step and noise."""
    found = case.identified("gaps")
    shown = tables(paged("gaps"))["Channels of the record"]["rows"]
    assert [row[0] for row in shown] == list(found.motion.quality)
    for row, (name, one) in zip(shown, found.motion.quality.items(), strict=True):
        counts = [printed(cell)[0] for cell in row[1:4]]
        assert counts == [one.missing, one.spikes, one.clipped]
        if name == "x":
            assert agrees(row[4], 1e6 * one.resolution)
    assert shown[0][1] == "400"


def test_bounds_tell_how_many_digits_are_shown():
    """Four digits at most, none finer than the bounds; a lag far inside its bounds is 0."""
    assert rows.rounded(148.23, 146.21, 150.25) == ("148.2", "146.2", "150.2")
    assert rows.rounded(1.4e-6, -0.3, 0.3) == ("0.000", "−0.300", "0.300")
    assert rows.rounded(4.604, -329.2, 338.6) == ("4.60", "−329", "339")
    assert rows.rounded(1e-20, -1e-19, 3e-19)[0] == "1.0×10⁻²⁰"
    assert rows.rounded(2.0, -math.inf, math.inf) == ("2.000", "−∞", "∞")


def test_the_hash_is_that_of_the_samples():
    """SHA-256 over names and little-endian doubles; one sample changes it, the name does not."""
    record = Record(np.array([0.0, 1.0]), {"x": np.array([2.0, 3.0]), "p1": np.zeros(2)}, "a")
    by_hand = b"t\0" + struct.pack("<2d", 0, 1) + b"p1\0" + struct.pack("<2d", 0, 0)
    by_hand += b"x\0" + struct.pack("<2d", 2, 3)
    assert rows.samples_hash(record) == hashlib.sha256(by_hand).hexdigest()
    assert rows.samples_hash(replace(record, name="b")) == rows.samples_hash(record)
    other = replace(record, channels={**record.channels, "x": np.array([2.0, 3.0000001])})
    assert rows.samples_hash(other) != rows.samples_hash(record)


# ---- words ----


@pytest.mark.parametrize("kind", EACH)
def test_no_words_are_lost_and_none_are_nan(kind):
    """Reasons, doubts, notes, cut-off sentence and the record stand on page and terminal alike."""
    found = case.identified(kind)
    data = paged(kind)
    json.dumps(data, allow_nan=False)
    page_words = words_of(data)
    shown = re.sub(r"\s+", " ", text(found, width=400))
    assert not re.search(r"\bnan\b", page_words + shown, re.IGNORECASE)
    wanted = [found.spectrum.says(found.motion.cutoff), rows.samples_hash(found.record)]
    for one in (found.stribeck, found.lugre, *found.fits.values()):
        wanted += [one] if isinstance(one, str) else list(one.doubts)
    if isinstance(found.coefficient, str):
        wanted.append(found.coefficient)
    wanted += [rows.pretty(note) for note in found.notes if " samples " not in note]
    for words in wanted:
        rest = words[1:]  # a sentence begins with a capital
        assert rest in page_words, words
        assert rest in shown, words


def test_what_has_no_value_says_why_in_its_place():
    """Figures of a record without models hold the reasons; both sides stay filled."""
    words = " ".join(mark["text"] for mark in drawn("bare").marks if "text" in mark)
    assert "No Stribeck curve: no steady sliding" in words
    assert "No secant damping: the record has no steady sliding" in words
    data = paged("bare")
    assert data["verdict"]["text"] == "NO MODEL"
    assert list(tables(data)) == ["Channels of the record"]
    outside = " ".join(mark["text"] for mark in drawn("outside").marks if "text" in mark)
    assert "The record lies outside the stroke" in outside
    assert "The record lies outside" not in " ".join(
        mark["text"] for mark in drawn("plateaus").marks if "text" in mark
    )


def test_the_verdict_counts_what_is_identifiable():
    """All known: found; some: in part; none: said so in red."""
    found = case.identified("plateaus")
    known = [*found.stribeck.parameters.values(), *found.lugre.parameters.values()]
    sure = sum(one.identifiable for one in known)
    seen = rows.verdict(found)
    assert (seen.state, seen.text) == ("checks", "PARTLY IDENTIFIED")
    assert seen.lines[1] == f"{sure} of {len(known)} parameters identifiable"

    def turned(model, told):
        own = {n: one._replace(identifiable=told) for n, one in model.parameters.items()}
        return replace(model, parameters=own)

    for told, state in ((True, "met"), (False, "missed")):
        models = {"stribeck": turned(found.stribeck, told), "lugre": turned(found.lugre, told)}
        assert rows.verdict(replace(found, **models)).state == state


def test_held_values_are_named():
    """What was not asked for is said with its value, without a rise nothing of v_s."""
    assert rows.held({"exponent": 2.0, "offset": 0.0}) == "Held: exponent 2, no offset."
    flat = {"exponent": 2.0, "static": 150.0, "stribeck_speed": 2e-4, "viscous": 0.0}
    assert rows.held(flat) == "Held: no rise towards rest, no viscous friction."
    assert rows.held({}) == ""


def test_channel_names_keep_their_letter():
    """A note about x begins with x; another note begins with a capital."""
    found = replace(case.identified("sine"), notes=("x ranges from -3.0 to 5 mm", "2 gaps", "late"))
    assert rows.remarks(found) == ["x ranges from −3.0 to 5 mm.", "2 gaps.", "Late."]


# ---- figures ----


@pytest.mark.parametrize("height", [figures.LEAST, 100.0, figures.MOST])
@pytest.mark.parametrize("kind", EACH)
def test_nothing_written_collides(kind, height):
    """No two texts overlap, all stay on the paper, and so does every line."""
    ink = drawn(kind, height)
    boxes = ink.text_boxes()
    for words, left, top, right, bottom in boxes:
        assert min(left, ink.width - right) > -0.5, words
        assert min(top, ink.height - bottom) > -0.5, words
    for one, other in itertools.combinations(boxes, 2):
        apart = one[3] <= other[1] or other[3] <= one[1]
        assert apart or one[4] <= other[2] or other[4] <= one[2], (one, other)
    points = [p for mark in ink.marks if "path" in mark for line in mark["path"] for p in line]
    assert all(-0.01 <= x <= ink.width + 0.01 for x, _ in points)
    assert all(-0.01 <= y <= ink.height + 0.01 for _, y in points)


def circles(ink, left, right):
    """Centres of the points' circles between two places across."""
    found = []
    for mark in ink.marks:
        if mark.get("closed") and mark.get("pen") == 0.3 and len(mark["path"][0]) == 32:
            xs, ys = zip(*mark["path"][0], strict=True)
            centre = sum(xs) / 32, sum(ys) / 32
            if left < centre[0] < right:
                found.append(centre)
    return found


def ticks_of(ink, anchor, left, right):
    """Place and value of every number at the side of an axis between two places across."""
    found = []
    for mark in ink.marks:
        here = mark.get("anchor") == anchor and left < mark["at"][0] < right
        if here and re.fullmatch(r"\N{MINUS SIGN}?[\d.]+", mark["text"]):
            found.append((mark["at"], printed(mark["text"])[0]))
    return found


def straight(places, values):
    """Place over value by the ticks of one axis."""
    slope, start = np.polyfit(values, places, 1)
    assert np.allclose(start + slope * np.array(values), places, atol=0.01)
    return lambda value: start + slope * value


def test_points_stand_where_the_ticks_say():
    """Every point of a sine lies at velocity, friction and residual by the ticks of its axes."""
    found = case.identified("sine")
    ink = drawn("sine", 110.0)
    seen = [at for at in circles(ink, 66.0, 122.0) if at[1] > 12.0]  # below the legend
    count = len(found.points)
    assert len(seen) == 2 * count
    sides = ticks_of(ink, "right", 60.0, 68.0)
    border = next(m["at"][1] for m in ink.marks if m.get("text") == "Residual, N")
    upper = [(at[1], value) for at, value in sides if at[1] < border]
    lower = [(at[1], value) for at, value in sides if at[1] > border]
    below = [(at[0], value) for at, value in ticks_of(ink, "center", 66.0, 122.0)]
    force, residual = (straight(*zip(*one, strict=True)) for one in (upper, lower))
    velocity = straight(*zip(*below, strict=True))
    for k, point in enumerate(found.points):
        assert seen[k][1] == pytest.approx(force(point.friction), abs=0.02)
        assert seen[count + k][1] == pytest.approx(
            residual(float(found.stribeck.residuals[k])), abs=0.02
        )
        for x, _ in (seen[k], seen[count + k]):
            assert x == pytest.approx(velocity(1e3 * point.velocity), abs=0.02)


@given(
    st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=400),
    st.integers(4, 60),
)
def test_thinning_keeps_every_peak(values, most):
    """Least and greatest of every stretch stay, in order; no more are kept than asked for and 2."""
    whole = np.array(values)
    kept = axes.thinned(whole, most)
    assert np.all(np.diff(kept) > 0) or kept.size == 1
    assert kept.size <= max(most + 2, 2)
    assert whole[kept].max() == whole.max()
    assert whole[kept].min() == whole.min()
    assert (kept[0], kept[-1]) == (0, whole.size - 1)


@pytest.mark.long
def test_a_long_record_stays_small():
    """Sixty times the samples add no path points beyond the envelope's: a spike of one stays."""
    found = case.identified("sine")
    (one,) = found.slidings
    count = 60 * one.piece.time.size
    time = found.motion.sample_time * np.arange(count)
    channels = {name: np.tile(values, 60) for name, values in one.piece.channels.items()}
    piece = replace(
        one.piece,
        time=time,
        channels=channels,
        velocity=np.tile(one.piece.velocity, 60),
        acceleration=np.tile(one.piece.acceleration, 60),
        sound=np.ones(count, dtype=bool),
    )
    hydraulic = np.tile(one.hydraulic, 60)
    hydraulic[count // 3] += 5e3
    sliding = replace(
        one,
        piece=piece,
        hydraulic=hydraulic,
        resisting=np.tile(one.resisting, 60),
        pressure=np.tile(one.pressure, 60),
    )
    long = replace(found, slidings=(sliding,))
    peak = np.nanmax(figures._over_time(long)[2].curves[0].ys)
    assert peak == pytest.approx(float(sliding.friction.max()))
    sizes = [len(json.dumps(figures.identification_figure(f).data())) for f in (found, long)]
    assert sizes[1] < 2 * sizes[0]


@given(
    st.lists(
        st.floats(1e-3, 1e3).flatmap(lambda v: st.sampled_from([v, -v])), min_size=2, max_size=9
    )
)
def test_velocities_keep_their_order_and_their_sign(values):
    """The axis is odd and increasing, and holds every value."""
    scale = chart.scale(Axis(log=True, signed=True), values)
    places = scale.at(sorted(values))
    assert np.all(np.diff(places) >= 0)
    assert scale.at([-v for v in values]) == pytest.approx(-scale.at(values))
    assert np.all((scale.range[0] <= places) & (places <= scale.range[1]))
    ticks = scale.ticks(60.0, across=True)
    assert all(scale.range[0] - 1e-9 <= at <= scale.range[1] + 1e-9 for at, _ in ticks)


@given(st.floats(-1e3, 1e3), st.floats(1e-4, 1e3))
def test_even_ticks_are_written_as_they_stand(low, span):
    """Words of neighbours differ and give back their value."""
    found = axes.even_ticks(low, low + span, 4)
    assert len({words for _, words in found}) == len(found)
    for value, words in found:
        assert printed(words)[0] == pytest.approx(value, abs=0.05 * span)


def test_a_map_needs_levels_of_pressure_one_way():
    """Three loads make a map; out and in without a load do not."""
    levels = figures.pressure_levels(case.identified("levels").points)
    assert len(levels) == 3
    assert all(b[0].pressure > a[-1].pressure for a, b in itertools.pairwise(levels))
    for kind in ("plateaus", "sine", "plunger", "bare"):
        assert figures.pressure_levels(case.identified(kind).points) == []
    words = " ".join(mark["text"] for mark in drawn("levels").marks if "text" in mark)
    assert "vertical axis: pressure, bar; circles: measured" in words


def test_the_map_is_shaded_by_the_measured_damping():
    """The darkest circle is the point of the largest damping."""
    found = case.identified("levels")
    ink = drawn("levels")
    filled = [m for m in ink.marks if m.get("stroke") and m.get("fill")]
    spots = [m["fill"] for m in filled if m["pen"] == 0.18 and len(m["path"][0]) == 32]
    assert len(spots) == len(found.points)
    lightness = [sum(int(fill[k : k + 2], 16) for k in (1, 3, 5)) for fill in spots]
    damping = [one.damping for one in found.points]
    assert lightness[int(np.argmax(damping))] == min(lightness)
    assert lightness[int(np.argmin(damping))] == max(lightness)


# ---- documents ----


@pytest.mark.parametrize("kind", EACH)
def test_a_record_makes_one_sheet(kind, tmp_path):
    """One A4 sheet as PDF and PNG; the design inside, the record not."""
    found = case.identified(kind)
    files = written(found, tmp_path)
    assert [file.path.name for file in files] == ["s.pdf", "s.png"]
    assert files[0].pages == 1
    inside = read_attachment(files[0].path)
    assert inside.source == case.SOURCE
    assert inside.run["record_sha256"] == rows.samples_hash(found.record)


@pytest.mark.long
def test_equal_records_make_equal_bytes(tmp_path):
    """Identified anew, the same record gives the same PDF and PNG."""
    hashes = []
    for k in range(2):
        found = case.identify(case.record_of("gaps"), case.knee())
        files = written(found, tmp_path / str(k))
        hashes.append([file.sha256 for file in files])
    assert hashes[0] == hashes[1]


def test_many_notes_go_on_to_a_second_sheet(tmp_path):
    """What has no room on one sheet is not clipped."""
    notes = tuple(f"note {k} about something that a reader has to know of" for k in range(60))
    found = replace(case.identified("sine"), notes=notes)
    files = written(found, tmp_path)
    assert files[0].pages == 2


@pytest.mark.long
@pytest.mark.parametrize("kind", ["levels", "bare"])
def test_the_plain_renderer_draws_it_too(kind):
    """Without typst every table and note is drawn, one below the other."""
    data = paper._printable(paged(kind))
    data |= {"title": "x", "source": "a: 1\n", "source_file": "a.yaml", "run": "{}"}
    pdf, images = fallback.render(data, 0)
    assert pdf.startswith(b"%PDF")
    assert images


# ---- CSV ----


def test_the_csv_holds_the_samples():
    """A row for each sample, units in the heads, an empty cell where there is no value."""
    found = case.identified("outside")
    heads, *lines = csv_text(rows.series(found)).splitlines()
    assert heads == (
        "t [s],x [mm],v [mm/s],acceleration [m/s^2],p1 [bar],p2 [bar],friction [N],k_eq [kN/mm],"
        "growth at seal [um]"
    )
    arrays = found.series()
    assert len(lines) == arrays["time"].size
    cells = lines[1000].split(",")
    assert cells[0] == f"{arrays['time'][1000]:.6f}"
    assert cells[6] == f"{arrays['friction'][1000]:.5g}"
    assert cells[7] == ""


# ---- terminal ----


@pytest.mark.parametrize("kind", EACH)
def test_the_terminal_keeps_its_width(kind):
    """No line is longer than the terminal, also in plain ASCII."""
    found = case.identified(kind)
    for width in (40, 80, 140):
        for unicode in (True, False):
            shown = text(found, width=width, unicode=unicode)
            assert max(map(len, shown.splitlines())) <= width, width
        assert shown.isascii()
        assert "\\u" not in shown


@pytest.mark.parametrize("kind", WITH_CURVE)
def test_the_terminal_shows_the_numbers_of_the_page(kind):
    """Value, bounds and verdict of every parameter stand in one line."""
    found = case.identified(kind)
    lines = text(found, width=160).splitlines()
    for model in (found.stribeck, found.lugre):
        for row in rows.parameter_rows(model.parameters):
            cells = (row.label, row.symbol, row.value, row.lower, row.upper, row.verdict)
            assert any(all(cell in line for cell in cells) for line in lines), row


def test_colour_is_never_the_only_sign():
    """Without colour every verdict has its own sign, in Unicode and in ASCII."""
    found = case.identified("one way")
    shown = text(found, width=120)
    assert "✘ no" in shown
    assert "○ weakly" in shown
    assert "x no" in text(found, width=120, unicode=False)
    assert "\x1b[" not in shown
    assert "\x1b[31;1m" in text(found, width=120, colour=True)


@pytest.mark.parametrize("module", [axes, rows])
def test_examples_in_docstrings(module):
    """What the docstrings show is what comes out."""
    assert doctest.testmod(module).failed == 0
