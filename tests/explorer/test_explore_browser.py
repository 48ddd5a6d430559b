"""The explorer's page in a browser: pointer and keys, ranges, ticks, the command; no fault told."""

from __future__ import annotations

import csv
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from browser import contrasts, controls, violations
from sweep_case import KNEE, NEAR
from test_explore import command_of, data_of, drawn, unpacked

import actuator_opt as ao
from actuator_opt.evaluation.outline_templates import LENGTHS

ACTS = (Path(__file__).parent / "explore_acts.js").read_text("utf-8")


def pareto(data):
    """Rows that no other betters in stiffness and mass, by comparing all pairs, stiffest first."""
    place = {one["name"]: unpacked(one["data"]) for one in data["columns"] if "data" in one}
    stiff, mass = place["stiffness_min"], place["mass"]
    rows = [
        k
        for k in range(len(mass))
        if not (
            (stiff >= stiff[k]) & (mass <= mass[k]) & ((stiff > stiff[k]) | (mass < mass[k]))
        ).any()
    ]
    return sorted(rows, key=lambda k: -stiff[k])


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A small study, some of whose designs meet everything."""
    folder = tmp_path_factory.mktemp("page")
    vary = ["cylinder.bore=20.8..21.2 mm:4", "rod.outer_diameter=10.4..11.2 mm:5"]
    vary.append("rod.material=steel_42crmo4,ti_6al4v")
    ao.sweep(ao.read(KNEE, set=NEAR), vary, store=folder / "rows.db")
    return ao.explore(folder / "rows.db", out=folder)[0].path


def test_pointer_and_keys_choose_filter_and_let_go(page, visit):
    """Arrows, click, ranges by drag and by slider, ticks; commands as Python tells them."""
    data = data_of(page.read_text("utf-8"))
    opened = visit(page)
    assert opened.locator("#name").inner_text() == "robot knee"
    assert "of 40 designs meet what is asked for" in opened.locator("#count").inner_text()
    told = opened.evaluate(ACTS)
    assert told["faults"] == []
    assert told["began"]["pinned"] == data["start"]["row"] >= 0
    assert told["none"]["count"] == 40
    assert told["focus"] == "scatter"
    assert told["escaped"]["pinned"] == -1
    assert told["escaped"]["command"] == ""
    assert told["home"]["pinned"] >= 0
    assert told["right"]["pinned"] != told["home"]["pinned"] == told["left"]["pinned"]
    assert told["end"]["pinned"] not in (told["home"]["pinned"], told["right"]["pinned"])
    assert told["over"]["title"] == "Design 4 of 40"
    assert told["away"]["title"] == told["end"]["title"]
    assert told["clicked"]["pinned"] == 3
    assert told["paths"] > 10
    assert told["slider"] == ["slider", 0, True]
    assert 0 < told["slid"]["count"] < 40 == told["deleted"]["count"]
    assert 0 < told["brushed"]["count"] <= 40 == told["cleared"]["count"]
    assert told["range"][0] < told["range"][1]
    assert told["front"] == pareto(data)
    assert f"{len(told['front'])} designs that none betters in both" in told["line"]
    pair = [data["columns"][data["start"][name]] for name in "xy"]
    assert [one["name"] for one in pair] == ["stiffness_min", "mass"]
    framed = told["framed"]
    values = [unpacked(one["data"]) for one in pair]
    inside = [
        (one >= low) & (one <= high)
        for one, (low, high) in zip(values, (framed["x"], framed["y"]), strict=True)
    ]
    assert 0 < framed["count"] == int((inside[0] & inside[1]).sum()) < 40
    assert framed["x"][0] == values[0].min()
    assert framed["y"][1] == values[1].max()
    assert framed["pinned"] == told["cleared"]["pinned"]
    assert told["unframed"]["count"] == 40
    assert told["undirected"][0] == []
    assert "nothing says which way rod.outer_diameter is better" in told["undirected"][1]
    assert told["printed"][:2] == ["printing", "none"]
    assert told["printed"][2] < 690
    assert told["after"] == ""
    assert told["every"]["count"] == told["began"]["count"] < 40 == told["unticked"]["count"]
    assert told["wide"] <= 1024
    for row, one in enumerate(told["commands"]):
        pairs = [word.split("=", 1) for word in shlex.split(one)[4::2]]
        expected = [word.split("=", 1) for word in command_of(data, row)[4::2]]
        for (path, value), (name, wanted) in zip(pairs, expected, strict=True):
            assert path == name
            assert value == wanted or float(value) == float(wanted)


def columns_of(data):
    """Numbers of every column, and the place of a text in the alphabet."""
    found = []
    for one in data["columns"]:
        if "texts" in one:
            order = sorted(one["texts"])
            codes = unpacked(one["codes"], "<u2")
            found.append(np.array([order.index(one["texts"][k]) for k in codes], dtype="<f4"))
        else:
            told = unpacked(one["data"]) if "data" in one else np.float32(one["value"])
            found.append(np.broadcast_to(told, data["rows"]))
    return found


def chosen_rows(opened):
    """Numbers of the designs in the table, from the first."""
    return [int(text) - 1 for text in opened.locator("#rows th button").all_inner_texts()]


def test_the_table_sorts_by_every_column(page, visit):
    """Ascending, then descending; equal rows in their order, rows without a value last."""
    data = data_of(page.read_text("utf-8"))
    opened = visit(page)
    opened.get_by_role("button", name="Ask for none").click()
    opened.get_by_label("every column").check()
    heads = opened.locator("#heads th")
    expect = columns_of(data)
    opened.wait_for_function(f"() => document.querySelectorAll('#heads th').length > {len(expect)}")
    assert heads.count() == 1 + len(expect)
    mass = next(k for k, one in enumerate(data["columns"]) if one["name"] == "mass")
    assert heads.nth(mass + 1).get_attribute("aria-sort") == "ascending"
    heads.nth(mass + 1).get_by_role("button").click()
    assert heads.nth(mass + 1).get_attribute("aria-sort") == "descending"
    assert chosen_rows(opened) == np.lexsort((range(40), -expect[mass])).tolist()
    assert opened.get_by_role("status").inner_text() == (
        "Sorted by mass of the dry actuator, g, descending"
    )
    opened.get_by_label("every column").uncheck()
    opened.wait_for_function("() => HEADS.length < 10")
    for column, values in ((0, np.arange(40.0)), (1, expect[0]), (2, expect[1])):
        for way, word in ((1, "ascending"), (-1, "descending")):
            heads.nth(column).get_by_role("button").click()
            assert heads.nth(column).get_attribute("aria-sort") == word
            assert opened.locator("#heads [aria-sort]").count() == 1
            assert chosen_rows(opened) == np.lexsort((range(40), way * values)).tolist()
    expect[mass] = expect[mass].copy()
    expect[mass][[3, 30]] = np.nan
    orders = opened.evaluate(
        """(mass) => {
             for (const row of [3, 30]) COLUMNS[mass].values[row] = NaN;
             return COLUMNS.map((_, column) => [1, -1].map((way) => {
             Object.assign(SORT, { column, way });
             return sortedRows();
           })); }""",
        mass,
    )
    for values, both in zip(expect, orders, strict=True):
        for way, rows in zip((1, -1), both, strict=True):
            assert rows == np.lexsort((range(40), way * values)).tolist()


def test_csv_has_the_designs_left_with_units_and_no_formula(page, visit, tmp_path):
    """The filtered rows in the order of the table, every column, single precision kept."""
    text = page.read_text("utf-8")
    forged = tmp_path / "forged.html"
    forged.write_text(text.replace('"ti_6al4v"', r'"=1+1,\"a\""'), "utf-8")
    data = data_of(forged.read_text("utf-8"))
    opened = visit(forged)
    opened.get_by_role("button", name="Ask for none").click()
    bore = opened.get_by_role("slider", name="least cylinder.bore, mm")
    bore.press("PageUp")
    bore.press("PageUp")
    opened.locator("#heads").get_by_role("button", name="cylinder.bore").click()
    button = opened.get_by_role("button", name="CSV of these 20")
    with opened.expect_download() as download:
        button.click()
    assert download.value.suggested_filename == "robot_knee_20_designs.csv"
    saved = Path(download.value.path()).read_text("utf-8")
    head, *rows = csv.reader(saved.splitlines())
    assert head[:4] == ["design", "rod.material", "cylinder.bore [mm]", "rod.outer_diameter [mm]"]
    assert {"mass [g]", "stiffness_min [kN/mm]", "seal_gap [um]", "proof_factor"} <= set(head)
    values = columns_of(data)
    bores = values[1]
    order = np.lexsort((range(40), bores))
    wanted = [int(k) for k in order if bores[k] > 20.96]
    assert [int(row[0]) - 1 for row in rows] == wanted
    assert {row[1] for row in rows} == {'\'=1+1,"a"', "steel_42crmo4"}
    for column, numbers in enumerate(values[1:], 2):
        told = [np.float32(row[column] or "nan") for row in rows]
        np.testing.assert_array_equal(told, numbers[wanted])
    cells = opened.evaluate('["=a", "+a", "-a", "@a", "\\ta", "a=", "a,b", "a\\nb"].map(cell)')
    assert cells == ["'=a", "'+a", "'-a", "'@a", "'\ta", "a=", '"a,b"', '"a\nb"']
    assert opened.evaluate("exactly(Math.fround(-0.1)) + exactly(NaN)") == "-0.1"


def test_a_beside_b(page, visit):
    """Every difference of columns; A dashed in the section; swapped; let go."""
    data = data_of(page.read_text("utf-8"))
    opened = visit(page)
    opened.get_by_role("button", name="Ask for none").click()
    beside = opened.get_by_role("region", name="A beside B")
    assert not beside.is_visible()
    opened.get_by_role("button", name="Choose design 4", exact=True).click()
    opened.get_by_role("button", name="Pin as A").click()
    assert "Choose another design; it becomes B." in beside.inner_text()
    opened.get_by_role("button", name="Choose design 31", exact=True).click()
    values = columns_of(data)
    rows = beside.locator("#compared tr")
    differ = [k for k, one in enumerate(values) if one[3] != one[30]]
    labels = [one["label"] for one in data["columns"]]
    assert rows.locator("th").all_inner_texts() == [labels[k] for k in differ]
    assert f"{len(differ)} differ, {len(values) - len(differ)} are equal." in beside.inner_text()
    told = rows.evaluate_all(
        "(rows) => rows.map((row) => [...row.cells].slice(1).map((one) => one.innerText))"
    )
    names = [data["columns"][k]["name"] for k in differ]
    assert told[names.index("rod.material")] == ["steel_42crmo4", "ti_6al4v", "", "", "", ""]
    mass = told[names.index("mass")]
    a, b = (float(values[labels.index("mass of the dry actuator")][k]) for k in (3, 30))
    number = [float(word.replace("−", "-").removesuffix(" %")) for word in (*mass[:3], mass[4])]
    np.testing.assert_allclose(number, [a, b, b - a, 100 * (b - a) / a], rtol=6e-3)
    assert (mass[3], mass[5]) == ("g", "better" if b < a else "worse")
    stiffness = told[names.index("stiffness_min")]
    assert stiffness[5] == ("better" if stiffness[2].startswith("+") else "worse")
    template, section = drawn(data, 3)
    count = sum(k * len(one.get("sides", (1, -1))) for one in template["parts"]
                if one["kind"] != "oil" for k in one["polygons"])  # fmt: skip
    outline = opened.locator("#section .other").get_attribute("d")
    points = np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", outline), dtype=float)
    assert len(points) == count
    assert points[:, 0].max() == pytest.approx(section[: -len(LENGTHS) : 2].max(), abs=1e-4)
    opened.emulate_media(media="print")
    opened.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    for box in ("#pair", "#table-box"):  # whole on the sheet
        assert opened.locator(box).evaluate(
            "(node) => [node.scrollWidth - node.clientWidth, node.scrollHeight - node.clientHeight]"
        ) == [0, 0]
    opened.evaluate("window.dispatchEvent(new Event('afterprint'))")
    opened.emulate_media(media="screen")
    opened.get_by_role("button", name="Swap A and B").click()
    assert opened.locator("#design-title").inner_text() == "Design 4 of 40"
    swapped = rows.nth(names.index("mass")).locator("td").all_inner_texts()
    assert swapped[:2] == mass[1::-1]
    opened.get_by_role("button", name="Let A go").click()
    assert not beside.is_visible()
    assert opened.locator("#section .other").count() == 0


def test_a_point_opens_as_a_studio(page, visit):
    """The command names the studio instead of the report; its values stay."""
    opened = visit(page)
    command = opened.get_by_role("textbox", name="Command")
    report = shlex.split(command.inner_text())
    opened.get_by_label("Command for").select_option("studio")
    studio = shlex.split(command.inner_text())
    assert studio[:2] == ["actuator-opt", "studio"]
    assert studio[2:] == report[2:]


VIEW = "() => [spanOf(0), spanOf(1)]"


def test_zoom_by_wheel_keys_and_buttons(page, visit):
    """The point under the pointer stays; keys, pan, reset; the page scrolls without the focus."""
    opened = visit(page, height=700)
    scatter = opened.locator("#scatter")
    whole = opened.evaluate(VIEW)
    box = scatter.bounding_box()
    at = (round(box["x"] + 0.7 * box["width"]), round(box["y"] + 0.3 * box["height"]))
    value = f"() => {{ const s = onScatter({{ clientX: {at[0]}, clientY: {at[1]} }});" + (
        " return [0, 1].map((k) => { const [a, b] = spanOf(k); return a + s[k] * (b - a); }); }"
    )
    opened.mouse.move(*at)
    opened.mouse.wheel(0, 100)
    opened.wait_for_function("() => scrollY > 0")
    opened.mouse.wheel(0, -200)
    opened.wait_for_function("() => scrollY === 0")
    assert opened.evaluate(VIEW) == whole
    scatter.focus()
    before = opened.evaluate(value)
    opened.mouse.wheel(0, -300)
    opened.wait_for_function("() => VIEW !== WHOLE")
    assert opened.evaluate("scrollY") == 0
    assert opened.locator("#times").inner_text() == "2×"
    np.testing.assert_allclose(opened.evaluate(value), before, rtol=1e-9)
    (near,) = np.diff(opened.evaluate(VIEW)[0])
    assert near == pytest.approx(np.diff(whole[0])[0] / 2)
    scatter.press("+")
    assert np.diff(opened.evaluate(VIEW)[1])[0] == pytest.approx(np.diff(whole[1])[0] / 3)
    held = opened.evaluate(VIEW)
    scatter.press("Shift+ArrowRight")
    scatter.press("Shift+ArrowLeft")
    np.testing.assert_allclose(opened.evaluate(VIEW), held, rtol=1e-9)
    scatter.press("Shift+ArrowDown")
    assert opened.evaluate(VIEW)[1][0] < held[1][0]
    assert "stiffness" in opened.get_by_role("status").inner_text()
    held = opened.evaluate(VIEW)
    opened.keyboard.down("Shift")
    opened.mouse.down()
    opened.mouse.move(at[0] - 40, at[1])
    opened.mouse.up()
    opened.keyboard.up("Shift")
    panned = opened.evaluate(VIEW)
    assert panned[0][0] > held[0][0]
    assert panned[1] == pytest.approx(held[1])
    assert opened.evaluate("STATE.ranges.size") == 0
    opened.mouse.move(at[0] - 200, at[1])
    opened.mouse.down()
    opened.mouse.move(*at)
    opened.mouse.up()
    low, high = opened.evaluate("rangeOf(STATE.x)")
    assert panned[0][0] < low < high < panned[0][1]  # a frame lies in the view
    opened.evaluate("() => { for (let k = 0; k < 30; k++) zoom(1.5); }")
    scatter.press("ArrowRight")
    assert opened.evaluate("inView(placeOf(STATE.pinned))")
    assert np.diff(opened.evaluate(VIEW)[0])[0] == pytest.approx(np.diff(whole[0])[0] / 1000)
    labels = opened.evaluate("places(COLUMNS[STATE.x], ...spanOf(0), 4).map(([, text]) => text)")
    assert len(labels) == len(set(labels)) > 1
    opened.get_by_role("button", name="Show all").click()
    assert opened.evaluate(VIEW) == whole
    opened.get_by_role("button", name="Zoom in").click()
    opened.get_by_label("across").select_option(label="cylinder.bore, mm")
    assert opened.evaluate("VIEW === WHOLE")


def test_by_keyboard_alone(page, visit):
    """Every stop of Tab has a name and shows the focus; sort, choose, pin and save by keys."""
    opened = visit(page)
    stops = []
    for _ in range(120):
        opened.keyboard.press("Tab")
        stop = opened.evaluate(
            """() => { const node = document.activeElement, style = getComputedStyle(node);
                 return [node.id || node.closest("[id]").id, style.outlineStyle,
                         parseFloat(style.outlineWidth), node.matches(":focus-visible")]; }"""
        )
        if stop[0] == "base-card":
            break
        stops.append(stop)
    assert all(stop[1:] == ["solid", 3, True] for stop in stops)
    ids = [stop[0] for stop in stops]
    order = [
        "x",
        "y",
        "c",
        "closer",
        "farther",
        "whole",
        "scatter",
        "pin",
        "verb",
        "command",
        "copy",
    ]
    assert [one for one in ids if one in order] == order
    assert {"axes", "limits", "csv", "all", "table-box", "heads", "rows", "copy-base"} <= set(ids)
    opened.locator("#scatter").focus()
    opened.keyboard.press("Home")
    opened.keyboard.press("p")
    opened.keyboard.press("End")
    assert opened.get_by_role("button", name="Swap A and B").is_visible()
    sort = opened.locator("#heads button").nth(2)
    sort.focus()
    opened.keyboard.press("Enter")
    assert opened.locator("#heads th").nth(2).get_attribute("aria-sort") == "ascending"
    opened.keyboard.press("Space")
    assert opened.locator("#heads th").nth(2).get_attribute("aria-sort") == "descending"
    assert sort.evaluate("(node) => node === document.activeElement")
    choice = opened.locator("#rows button").nth(1)
    choice.focus()
    opened.keyboard.press("Enter")
    assert choice.get_attribute("aria-current") == "true"
    assert choice.evaluate("(node) => node === document.activeElement")
    assert opened.locator("#rows tr").nth(1).locator("b").inner_text() == "B"
    opened.locator("#csv").focus()
    with opened.expect_download():
        opened.keyboard.press("Enter")


@pytest.mark.parametrize(("scheme", "width"), [("light", 1600), ("dark", 320)])
def test_names_contrast_and_width(page, visit, scheme, width):
    """WCAG 2.2, 1.4.3: text at least 4.5 to 1; controls named; no sideways scroll of the page."""
    opened = visit(page, width=width, color_scheme=scheme, reduced_motion="reduce")
    opened.locator("#none").click()
    opened.locator("#pin").click()
    opened.locator("#rows button").nth(1).click()
    opened.locator("#numbers-box summary").click()
    ratios = contrasts(opened)
    assert len(ratios) > 500
    assert ratios[0][0] >= 4.5, ratios[0]
    assert opened.evaluate("document.documentElement.scrollWidth") == width
    assert opened.evaluate("getComputedStyle(byId('csv')).transitionDuration") == "0s"
    names = controls(opened)
    assert len(names) > 100
    assert [role for role, name in names if not name] == []


@pytest.mark.long
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(page, visit, scheme):
    """Every rule of axe-core, with A beside B."""
    opened = visit(page, color_scheme=scheme)
    opened.locator("#pin").click()
    opened.locator("#rows button").nth(1).click()
    assert violations(opened) == []
