"""The offline page of the studio: its file, its refusals, and its optima beside the library's."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import shlex
import zlib

import numpy as np
import pytest
import yaml
from browser import contrasts, violations
from cli_runner import DESIGNS, run

import actuator_opt as ao
from actuator_opt.base.errors import UsageError
from actuator_opt.base.symbolic import program as programs
from actuator_opt.base.symbolic.recorded import RecordedFunction
from actuator_opt.rendering.attachments import extract
from actuator_opt.rendering.blocks import AttachedFile
from actuator_opt.studio import offline
from actuator_opt.studio.model import Studio
from actuator_opt.studio.page import FOLDER

pytestmark = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
KNEE = DESIGNS / "knee.yaml"
STEEL = DESIGNS / "steel_baseline.yaml"
NAME = "knee </script><b>&\"' @DATA@"
PLUGIN = """from actuator_opt import metric
@metric("own_mass", dimension="mass")
def own_mass(view): return view.metric("mass")
"""
SOLVE = """async ([jobs, number]) => {
  const ends = [];
  for (const [data, start] of jobs) {
    const box = { lower: [0.1, 0.1], upper: [4, 4], rows: 2, answers: [] };
    const problem = new Problem(Machine.program(data), box);
    const valley = { z: Float64Array.from(start, Math.log), hessian: problem.units, scale: 1,
      price: 3, prices: new Float64Array(5), numbers: [1] };
    const { point, optimum, descent } = await solved(problem, [valley], [number], () => null);
    const within = optimum ? 0 : promised(problem, descent);
    ends.push([optimum, ...point.x, point.objective, within]);
  }
  return ends;
}"""
SAME = 1e-8
"""Relative difference of masses that counts as the same optimum."""


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    """The offline page of the knee, whose name has the letters of HTML."""
    folder = tmp_path_factory.mktemp("offline")
    design = folder / "knee.yaml"
    text = KNEE.read_text("utf-8")
    design.write_text(re.sub("^name:.*", f"name: {json.dumps(NAME)}", text, flags=re.M), "utf-8")
    offline.write_offline(folder / "knee.html", str(design))
    return folder / "knee.html"


@pytest.fixture
def page(page_file, visit):
    """The page, opened and at rest."""
    opened = visit(page_file)
    opened.locator("#fixed .wish").first.wait_for()
    return opened


def asked(page, route, wish):
    """The answer of the page's worker; asked again while the page itself wants optima."""
    while True:
        data = page.evaluate("([route, wish]) => ask(route, wish)", [route, wish])
        if not data.get("dropped"):
            return data


def moves(page, count, seed):
    """Random changes of one or two numbers by at most 10 %, as texts with units."""
    rng = np.random.default_rng(seed)
    rows = page.evaluate("S.design.numbers")
    for k in range(count):
        chosen = rng.choice(len(rows), 1 + k % 2, replace=False)
        wish = {}
        for row in (rows[i] for i in chosen):
            ends = [row["factor"] * row[key] + row["offset"] for key in ("lower", "upper")]
            shown = row["factor"] * row["value"] + row["offset"]
            value = float(np.clip(shown * (1 + rng.uniform(-0.1, 0.1)), *ends))
            wish[row["path"]] = f"{value!r} {row['typed']}".strip()
        yield wish


def same_optima(page, session, count, seed):
    """Compare optima of the page with those of the library; the number that agree."""
    agree = 0
    for changes in moves(page, count, seed):
        found, optimum = asked(page, "solve", {"changes": changes}), session.solve(changes)
        if not found["feasible"]:
            assert not optimum.optimum, changes
            continue
        room = SAME * abs(optimum.objective_value)
        if found["within"] is not None:  # the page says "about", and how far it may be
            room += found["within"]
        else:
            agree += 1
        assert found["objective"] <= optimum.objective_value + room, changes
        assert found["objective"] >= optimum.objective_value - room or optimum.samples, changes
    return agree


def test_the_file_is_small_and_loads_nothing(page_file):
    """At most 400 kB; a policy with the hashes of its script and style; no text of the design."""
    text = page_file.read_text("utf-8")
    assert len(text.encode()) <= offline.LARGEST == 400_000
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert policy.startswith("default-src 'none'; ")
    assert not re.search("connect-src|unsafe", policy)
    own = {"style": re.findall(r"<style>(.*?)</style>", text, re.S)}
    own["script"] = re.findall(r"<script>(.*?)</script>", text, re.S)
    for kind, found in own.items():
        (content,) = found
        digest = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in policy
    assert set(re.findall(r"https?://[\w./-]*", text)) == {"http://www.w3.org/2000/svg"}
    assert not re.findall(r"(?:src|href)=(?!\"data:,\")", text.replace("-src", ""))
    assert "knee </" not in text
    assert html.escape(NAME) in text  # in the title
    assert not re.search('id="(save|report)"', text)  # they need a server
    packed = re.search('id="data">([A-Za-z0-9+/=]*)</script>', text)[1]
    assert str(page_file.parent).encode() not in zlib.decompress(base64.b64decode(packed))


def test_what_cannot_be_offline_is_refused_by_name(tmp_path):
    """One line that says why, exit 2, and nothing written; a foreign file is never replaced."""
    out = tmp_path / "page.html"
    plugin = tmp_path / "own.py"
    plugin.write_text(PLUGIN, "utf-8")
    weighted = tmp_path / "weighted.yaml"
    tree = yaml.safe_load(STEEL.read_text("utf-8"))
    tree["objective"] = {"minimise": {"mass": 1, "closed_length": 1}}
    weighted.write_text(yaml.safe_dump(tree, sort_keys=False), "utf-8")
    for words, reason in (
        ([DESIGNS / "knee_walking.yaml"], "duty cycles"),
        ([DESIGNS / "knee_choices.yaml"], "choices"),
        ([KNEE, "--plugin", plugin], "own_mass"),
        ([KNEE, "--port", "8000"], "--port"),
        (["-"], "needs a file"),
        ([weighted], "weighted sum"),
    ):
        done = run("studio", *words, "--offline", out)
        assert done.code == 2
        assert reason in done.err
        assert done.err.count("\n") <= 2
    assert run("studio", KNEE, "--offline", tmp_path / "page.txt").code == 2
    out.write_text("<!DOCTYPE html>mine", "utf-8")
    done = run("studio", KNEE, "--offline", out)
    assert done.code == 3
    assert "is no offline page" in done.err
    assert out.read_text("utf-8") == "<!DOCTYPE html>mine"
    assert run("studio", KNEE, "--offline", tmp_path / "none" / "page.html").code == 3


@pytest.mark.long
def test_a_design_without_an_optimum_is_refused(tmp_path):
    """The page starts at an optimum."""
    tree = yaml.safe_load(STEEL.read_text("utf-8"))
    tree["requirements"]["stiffness_min"] = {"min": "9000 kN/mm"}
    file = tmp_path / "steel.yaml"
    file.write_text(yaml.safe_dump(tree, sort_keys=False), "utf-8")
    with pytest.raises(UsageError, match="no design meets"):
        offline.page_of(str(file))


def test_optima_prices_and_drawing_equal_those_of_the_studio(page):
    """Ten random moves, and everything that the page shows of one of them."""
    studio = Studio(str(KNEE))
    assert same_optima(page, studio.session, 10, seed=3) >= 7
    changes = {"requirements.stiffness_min.min": "10.4 kN/mm", "cylinder.stroke": "108 mm"}
    found, expected = asked(page, "solve", {"changes": changes}), studio.solve(changes, bool)
    lineless = [x for x in expected["section"]["parts"] if x["kind"] != "line"]  # no threads here
    assert found["section"]["parts"] == lineless
    assert found["section"]["lengths"] == expected["section"]["lengths"]
    drawn = [np.array(one["section"]["numbers"]) for one in (found, expected)]
    apart = np.abs(drawn[0] - drawn[1][: len(drawn[0])])
    assert apart.max() < 0.05  # mm; the edge of a plug is not linear
    assert [x["part"] for x in found["masses"]] == [x["part"] for x in expected["masses"]]
    for mine, theirs in zip(found["masses"], expected["masses"], strict=True):
        assert mine["mass"] == pytest.approx(theirs["mass"], rel=1e-8)
    assert found["dimensions"] == pytest.approx(expected["dimensions"], rel=1e-6)
    assert [x["name"] for x in found["holds"]] == [x["name"] for x in expected["holds"]]
    paths = page.evaluate("S.design.numbers.map((row) => row.path)")
    assert len(paths) > 50
    wish = {"changes": changes, "paths": paths, "draw": True}
    mine = {x["path"]: x for x in asked(page, "prices", wish)["prices"]}
    theirs = {x["path"]: x for x in studio.prices(changes, paths, bool, draw=True)["prices"]}
    assert mine.keys() == theirs.keys()
    for path, price in mine.items():
        size, other = expected["objective"] / price["value"], theirs[path]
        for key in ("down", "up", "low", "high"):
            room = 1e-5 * abs(size if key in ("down", "up") else price["value"])
            same = price[key] is other[key] or abs(price[key] - other[key]) <= room
            assert same, (path, key, price[key], other[key])
        assert (price["below"], price["above"]) == (other["below"], other["above"])
    stiffness = [np.array(x["requirements.stiffness_min.min"]["section"]) for x in (mine, theirs)]
    stiffness[1] = stiffness[1][: len(stiffness[0])]
    assert np.abs(stiffness[0] - stiffness[1]).max() < 0.02 * np.abs(stiffness[1]).max()


@pytest.mark.long
def test_200_random_moves_give_the_optima_of_the_library(page):
    """The same mass to 1e-8, or "about" and how far; the knee in a real browser."""
    assert same_optima(page, ao.session(KNEE), 200, seed=11) >= 180


def test_drag_type_copy_and_nothing_fits(page, page_file):
    """What a reader does: arrow keys, units, an impossible wish, undo, the command."""
    stiffness = page.locator('.wish[data-path="requirements.stiffness_min.min"]')
    field, rest = stiffness.locator("input[type=text]"), page.locator('#main[aria-busy="false"]')
    before = page.locator("#objective").text_content()
    assert page.locator("#name").text_content() == NAME
    assert violations(page) == []
    assert contrasts(page)[0][0] >= 4.5
    stiffness.locator("input[type=range]").press("ArrowLeft")
    rest.wait_for()
    page.locator("#objective:not(.about)").wait_for()
    assert float(page.locator("#objective").text_content()[:5]) < float(before[:5])
    for text, fault in (
        ("9 furlong", "unknown unit"), ("9 KN/mm", 'did you mean "kN/mm"'),
        ("much", "not a number"), ("90", "This page covers 5 kN/mm to 15 kN/mm"),
    ):  # fmt: skip
        field.fill(text)
        field.press("Enter")
        stiffness.locator(".fault", has_text=fault).wait_for()
    field.fill("9e6 N/m")
    field.press("Enter")
    stiffness.locator(".fault[hidden]").wait_for(state="attached")
    friction = page.locator('.wish[data-path="requirements.friction_running.max"] input[type=text]')
    friction.fill("160 N")
    friction.press("Enter")
    page.locator("#card", has_text="asked ≤ 160 N").wait_for()
    assert page.locator("#objective").text_content() == "nothing fits"
    page.keyboard.press("Tab")
    page.locator("#copy").click()
    words = shlex.split(page.locator("#command").input_value())
    design = page_file.with_suffix(".yaml")
    assert words[:3] == ["actuator-opt", "optimise", design.name]
    sets = [ao.design.split_assignment(word) for word in words[4::2]]
    changed = ao.read(design, set=sets).design
    assert changed.requirements["stiffness_min"].min == 9e6
    assert changed.requirements["friction_running"].max == 160
    page.locator("#copy-no").click()
    page.locator("#undo").click()
    page.locator("#objective:not(.about)", has_text=" g").wait_for()
    page.evaluate("truth({ ...S.shown, within: 0.00021 }, S.changes)")
    assert re.fullmatch(r"about [\d.]+ g, within 0.21 g", page.locator("#objective").text_content())


def test_the_optimiser_on_problems_with_known_optima(visit, tmp_path):
    """A quadratic with a limit and a kink on which no gradient vanishes, in JavaScript."""

    def circle(x):  # x² + y² with x + y >= number: both half the number, price the number
        return np.stack([x[0] ** 2 + x[1] ** 2, x[0] + x[1] - x[2]])

    def kink(x):  # |x - number| + y²: the optimum is a kink
        return np.stack([abs(x[0] - x[2]) + (x[1] - 0.5) ** 2, x[0] + 10.0])

    number, jobs = 1.3, []
    for function, start in ((circle, [0.5, 0.5]), (kink, [1.0, 0.5])):
        recorded = RecordedFunction(function, ["x", "y", "number"], np.array([*start, 1.0]))
        recorded(recorded.present[:, None])
        jobs.append([recorded.recording.program.for_page(), start])
    script = "".join(
        file.read_text("utf-8")
        for file in (programs.SCRIPT, *(FOLDER / f"{x}.js" for x in ("algebra", "optimiser")))
    )
    file = tmp_path / "run.html"
    file.write_text(f'<meta charset="utf-8"><script>{script}</script>', "utf-8")
    found = visit(file).evaluate(SOLVE, [jobs, number])
    optimum, x, y, objective, _ = found[0]
    assert optimum
    assert (x, y) == pytest.approx((number / 2, number / 2), rel=1e-6)
    assert objective == pytest.approx(number**2 / 2, rel=1e-10)
    optimum, x, y, objective, within = found[1]
    assert not optimum
    assert objective - within <= 0 < objective < 0.05


def test_files_are_attached_to_a_report(tmp_path):
    """Both layouts of the PDF contain the file, and the page names it."""
    from pypdf import PdfReader

    evaluation = ao.evaluate(STEEL)
    page = AttachedFile("steel_studio.html", "text/html", "<p>é</p>", offline.ABOUT)
    paths = [x.path for x in ao.report(evaluation, folder=tmp_path, attached=[page])]
    reader = PdfReader(paths[0])
    assert reader.attachments["steel_studio.html"] == ["<p>é</p>".encode()]
    assert "steel_studio.html: drag a limit" in " ".join(
        " ".join(sheet.extract_text() for sheet in reader.pages).split()
    )
    assert extract(paths[0].read_bytes(), ("text/html",))["text/html"] == "<p>é</p>".encode()


@pytest.mark.long
def test_attach_studio(tmp_path):
    """The attached page is the offline page; a design without one gives a warning and its PDF."""
    from pypdf import PdfReader

    done = run("optimise", STEEL, "--attach-studio", "--out", tmp_path, "--no-record", "--quiet")
    assert done.code == 0
    (page,) = PdfReader(tmp_path / "steel_baseline.pdf").attachments["steel_baseline_studio.html"]
    assert page.decode() == offline.page_of(str(STEEL))
    done = run("rerun", tmp_path / "steel_baseline.pdf", "--json")
    assert done.code == 0
    assert done.json["rerun"]["repeats"]
    walking = DESIGNS / "knee_walking.yaml"
    done = run("report", walking, "--attach-studio", "--out", tmp_path, "--quiet")
    assert re.search("--attach-studio: not attached: .*duty cycles", done.err)
    assert "knee_walking_studio.html" not in PdfReader(tmp_path / "knee_walking.pdf").attachments
