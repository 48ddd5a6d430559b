"""The explorer's page in a browser: pointer and keys, ranges, ticks, the command; no fault told."""

from __future__ import annotations

import html
import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from sweep_case import KNEE, NEAR
from test_explore import command_of, data_of, unpacked

import actuator_opt as ao

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
BROWSER = next(filter(None, map(shutil.which, BROWSERS)), None)
pytestmark = pytest.mark.skipif(
    BROWSER is None, reason=f"no browser to look with: {', '.join(BROWSERS)}"
)

WATCH = """<script>
const FAULTS = [];
addEventListener("error", (event) => FAULTS.push(event.message));
addEventListener("unhandledrejection", (event) => FAULTS.push(String(event.reason)));
console.error = console.warn = (...words) => FAULTS.push(words.join(" "));
</script>"""

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


def dumped(path, tmp_path):
    """The document after its scripts have run."""
    done = subprocess.run(
        [
            BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1024,900",
            f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=4000", "--dump-dom",
            path.as_uri(),
        ],
        capture_output=True, text=True, timeout=90, check=False,
    )  # fmt: skip
    if done.returncode or not done.stdout:
        pytest.skip(f"the browser does not run here: {done.stderr[-200:]}")
    return done.stdout


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A small study, some of whose designs meet everything."""
    folder = tmp_path_factory.mktemp("page")
    vary = ["cylinder.bore=20.8..21.2 mm:4", "rod.outer_diameter=10.4..11.2 mm:5"]
    vary.append("rod.material=steel_42crmo4,ti_6al4v")
    ao.sweep(ao.read(KNEE, set=NEAR), vary, store=folder / "rows.db")
    return ao.explore(folder / "rows.db", out=folder)[0].path


def test_the_page_runs_under_its_own_policy(page, tmp_path):
    """As it is written: the script runs, the name and the count stand there."""
    found = dumped(page, tmp_path)
    assert '<h1 id="name">robot knee</h1>' in found
    assert "of 40 designs meet what is asked for" in found


def test_pointer_and_keys_choose_filter_and_let_go(page, tmp_path):
    """Arrows, click, ranges by drag and by slider, ticks; commands as Python tells them."""
    text = page.read_text("utf-8")
    data = data_of(text)
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', lambda _: WATCH, text)
    acted = tmp_path / "acted.html"
    acted.write_text(text.replace("</body>", f"<script>{ACTS}</script></body>"), encoding="utf-8")
    found = re.search(r'<pre id="result">(.*?)</pre>', dumped(acted, tmp_path), re.DOTALL)
    told = json.loads(html.unescape(found[1]))
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
