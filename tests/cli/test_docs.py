"""`docs`: a topic leads to its page in the unpacked copy; without a copy, `explain` answers."""

from __future__ import annotations

import io
import json
import tarfile
import webbrowser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from cli_runner import run

from actuator_opt.api import documentation

METRICS = "reference/metrics.html"
TOPICS = {
    "stiffness_min": [
        {"address": f"{METRICS}#metric-stiffness-min", "title": "metric stiffness_min"},
        {"address": "theory/stiffness.html", "title": "Stiffness"},
    ],
    "load_cases[*].force": [{"address": "reference/keys/load_cases.html", "title": "key"}],
    "mass": [{"address": f"{METRICS}#metric-mass", "title": "metric mass"}],
    "optimality_and_prices": [{"address": "theory/optimality.html", "title": "Optimality"}],
}
PAGES = {
    "index.html": "<title>Documentation</title>",
    "reference/metrics.html": '<p id="metric-stiffness-min">',
    "topics.json": json.dumps(TOPICS),
}


def packed(path: Path, pages: dict[str, str] = PAGES) -> Path:
    """An archive with pages."""
    with tarfile.open(path, "w:xz") as archive:
        for name, text in pages.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(text)
            archive.addfile(entry, io.BytesIO(text.encode()))
    return path


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """An installation with four topics, and an empty cache."""
    path = packed(tmp_path / "docs.tar.xz")
    monkeypatch.setattr(documentation, "archive", lambda: path)
    monkeypatch.setattr(documentation.store, "user_folder", lambda kind: tmp_path / kind)
    monkeypatch.setattr(webbrowser, "get", lambda: webbrowser.GenericBrowser("w3m"))
    return tmp_path


@pytest.mark.parametrize(
    ("words", "page"),
    [
        ((), "index.html"),
        (("stiffness_min",), "reference/metrics.html"),
        (("Stiffness", "min"), "reference/metrics.html"),
        (("weight",), "reference/metrics.html"),  # a synonym of mass
        (("weakest", "stiffness"), "reference/metrics.html"),  # words of a label
        (("load_cases[stance].force",), "reference/keys/load_cases.html"),
        (("optimality", "and", "prices"), "theory/optimality.html"),
    ],
)
def test_a_topic_leads_to_its_page(copy, words, page):
    """By name, other spelling, synonym, PATH with any name in brackets, and title."""
    done = run("docs", *words, "--json")
    answer = json.loads(done.out)
    assert (done.code, done.err) == (0, "")
    assert answer["file"].endswith(page)
    assert unquote(urlsplit(answer["address"]).path) == answer["file"]
    named = page.endswith("metrics.html") and words != ("weight",)
    assert [place["title"] for place in answer["also"]] == (["Stiffness"] if named else [])


def test_pages_are_unpacked_once_beside_those_of_other_builds(copy):
    """The second call reads; another archive has its own folder; no part remains."""
    first = Path(json.loads(run("docs", "--json").out)["file"])
    assert first.read_text("utf-8") == PAGES["index.html"]
    first.write_text("changed", encoding="utf-8")
    assert Path(json.loads(run("docs", "--json").out)["file"]).read_text("utf-8") == "changed"
    packed(copy / "docs.tar.xz", PAGES | {"index.html": "other"})
    second = Path(json.loads(run("docs", "--json").out)["file"])
    assert second.parent != first.parent
    assert {path.name for path in (copy / "cache" / "docs").iterdir()} == {
        first.parent.name, second.parent.name,
    }  # fmt: skip


def test_the_browser_is_led_to_the_place(copy, monkeypatch):
    """A file beside the pages passes the anchor on, which some desktops drop."""

    class Browser(webbrowser.BaseBrowser):
        def open(self, url, new=0, autoraise=True):
            self.text = Path(unquote(urlsplit(url).path)).read_text("utf-8")
            return True

    browser = Browser()
    monkeypatch.setattr(webbrowser, "get", lambda: browser)
    done = run("docs", "stiffness_min")
    assert done.code == 0
    assert "reference/metrics.html#metric-stiffness-min" in done.out
    assert 'url=reference/metrics.html#metric-stiffness-min"' in browser.text


def test_an_unknown_topic_gets_the_nearest(copy):
    """At most five names, exit 2."""
    done = run("docs", "stifness")
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith('no page about "stifness"; nearest: ')
    assert "stiffness_min" in done.err
    assert done.err.count(",") <= 4


def test_without_pages_explain_answers(monkeypatch):
    """The answer of `explain` on stdout, and how to get the pages on stderr; no topic: a fault."""
    monkeypatch.setattr(documentation, "archive", lambda: None)
    done = run("docs", "stiffness_min")
    assert (done.code, done.out) == (0, run("explain", "stiffness_min").out)
    assert "python docs/build.py" in done.err
    assert run("docs").code == 3


def test_hostile_archives_leave_nothing(copy):
    """A damaged archive, and one whose file would lie outside the folder: a line, no page."""
    path = copy / "docs.tar.xz"
    outside = PAGES | {"../../outside.html": "x"}
    for content in (b"no archive", packed(path, outside).read_bytes()):
        path.write_bytes(content)
        done = run("docs")
        assert done.code == 3
        assert "the packed pages are damaged" in done.err
        assert not list((copy / "cache" / "docs").iterdir())
    assert not (copy / "cache" / "outside.html").exists()
