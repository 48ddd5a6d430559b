"""Menus and the duty cycle of the studio in a real browser, by keyboard and by choice."""

from __future__ import annotations

import re
import subprocess
import sys
import textwrap
from contextlib import contextmanager

import numpy as np
import pytest
from browser import violations
from cli_runner import DESIGNS

import actuator_opt as ao

MATERIAL, JOINT = "rod.material", "retention.type"
TIMES = np.linspace(0, 2 * np.pi, 13)
CYCLE = "\n".join(
    ["time [s],position [mm],force [N]",
     *(f"{t:.6f},{55 + 20 * np.sin(t):.6f},{900 - 600 * np.cos(t):.6f}" for t in TIMES)]
)  # fmt: skip
STEEL = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
DUTY = f"duty:\n  cycles:\n    - name: lift\n      file: |\n{textwrap.indent(CYCLE, ' ' * 8)}\n\n"


class Page:
    """The page of a studio."""

    def __init__(self, page):
        self.page = page
        self.messages = []
        page.on("console", lambda message: self.messages.append(message.text))
        page.on("pageerror", lambda error: self.messages.append(str(error)))

    def menu(self, path):
        """The menu of a key."""
        return self.page.locator(f'.menu[data-path="{path}"] select')

    def told(self, path):
        """The line below a menu, once its optimum is final."""
        line = self.page.locator(f'.menu[data-path="{path}"] p').filter(
            has_text=re.compile(r"^[\d.]+ g, \S+ g$|^[\d.]+ g, no change$|^nothing fits$")
        )
        line.wait_for(timeout=60_000)
        return line.text_content().replace("\N{MINUS SIGN}", "-")

    @property
    def mass(self):
        """The headline in g, once it is true."""
        self.page.locator('#main[aria-busy="false"]').wait_for(timeout=60_000)
        self.page.locator('#objective:not([class="about"])').wait_for()
        return float(re.match(r"[\d.]+", self.page.locator("#objective").text_content())[0])


@contextmanager
def opened(browser, folder, text):
    """A design in the studio, as a user starts it."""
    (folder / "design.yaml").write_text(text, "utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "actuator_opt", "studio", "design.yaml", "--no-browser"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    context = browser.new_context(viewport={"width": 1200, "height": 900}, reduced_motion="reduce")
    try:
        page = Page(context.new_page())
        page.page.goto(process.stdout.readline().split()[-1])
        yield page
    finally:
        context.close()
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def studio(browser, tmp_path_factory):
    """The steel knee in the studio."""
    folder = tmp_path_factory.mktemp("choices")
    with opened(browser, folder, STEEL) as page:
        page.folder = folder
        yield page


def test_undo_keeps_the_menus_of_the_file(studio):
    """Undo of a number repaints the menus; each still reads what the design states."""
    page = studio.page
    field = page.locator('.wish[data-path="requirements.stiffness_min.min"] input[type=text]')
    before, menus = studio.mass, page.locator("#menus select")
    words = menus.evaluate_all("all => all.map((x) => x.value)")
    assert studio.menu(MATERIAL).input_value() == "steel_42crmo4"
    field.fill("9.5")
    field.press("Enter")
    page.locator(".wish.changed").wait_for()
    assert studio.mass != before
    page.locator("#undo").click()
    assert studio.mass == before
    assert menus.evaluate_all("all => all.map((x) => x.value)") == words


def test_a_choice_is_solved_undone_and_saved(studio):
    """Its effect stands below the menu; undo, redo, A and the saved file carry the word."""
    page, before = studio.page, studio.mass
    page.keyboard.press("p")
    studio.menu(MATERIAL).focus()
    studio.menu(MATERIAL).select_option("ti_6al4v")
    mass, step = (float(x.partition(" ")[0]) for x in studio.told(MATERIAL).split(", "))
    after = studio.mass
    assert mass == pytest.approx(after, abs=0.06)
    assert step == pytest.approx(after - before, abs=0.11)
    page.locator("#swap").click()
    assert (studio.mass, studio.menu(MATERIAL).input_value()) == (before, "steel_42crmo4")
    page.keyboard.press("Control+z")
    assert (studio.mass, studio.menu(MATERIAL).input_value()) == (after, "ti_6al4v")
    page.keyboard.press("p")
    page.locator("#save").click()
    page.locator("#file").fill("titanium.yaml")
    page.locator("#save-yes").click()
    page.locator("#note").filter(has_text="Saved titanium.yaml").wait_for()
    evaluation = ao.evaluate(studio.folder / "titanium.yaml")
    assert 1000 * evaluation.metrics["mass"].value == pytest.approx(after, abs=0.06)
    assert evaluation.met


def test_another_joint_changes_drawing_and_dimensions(studio):
    """A joint that lacks keys is not offered, with the reason; another one is drawn."""
    pins = studio.menu(JOINT).locator("option[value=pins]")
    assert pins.is_disabled()
    assert "needs retention.count" in pins.text_content()
    paths = studio.page.locator("#section path").count()
    studio.menu(JOINT).select_option("bond")
    studio.told(JOINT)
    assert studio.page.locator("#section path").count() != paths
    assert studio.menu("retention.material").input_value() == "epoxy_structural"
    studio.page.locator("#undo").click()
    assert studio.mass > 0
    assert studio.page.locator("#section path").count() == paths
    assert studio.menu("retention.material").count() == 0
    assert studio.messages == []


def test_the_duty_cycle_runs(browser, tmp_path):
    """One marker on traces and plane, by slider, keys and Play; numbers of energy as text."""
    head, _, rest = STEEL.partition("  rod.inner_diameter:\n    lower")
    few = head + rest[rest.index("\n# The same requirements") :]  # three variables: a fast search
    with opened(browser, tmp_path, few.replace("load_cases:", f"{DUTY}load_cases:", 1)) as studio:
        page = studio.page
        page.locator("#told").filter(has_text="force reserve").wait_for(timeout=60_000)
        position, told = page.locator("#position"), page.locator("#told")
        spots = [page.locator(f"#{name} .marker") for name in ("trace-1", "trace-2", "plane-1")]
        position.focus()
        position.press("Home")
        first = [spot.get_attribute("cx") for spot in spots]
        assert told.text_content().startswith("0 s, force ")
        position.press("ArrowRight")
        assert all(x.get_attribute("cx") != y for x, y in zip(spots, first, strict=True))
        assert position.get_attribute("aria-valuetext") == told.text_content()
        assert page.locator("#play").text_content() == "Play"  # nothing runs by itself
        before = told.text_content()
        page.locator("#play").click()
        page.locator("#play", has_text="Pause").wait_for()
        told.filter(has_not_text=before).wait_for()
        page.locator("#play").click()
        page.locator("#least").click()
        least = page.locator("#least-text").text_content()
        assert re.search(r"[\d.]+ k?N at [\d.]+ s", least)
        assert told.text_content().startswith(re.search(r"at ([\d.]+ s)", least)[1])
        page.locator("#shown-1").select_option(index=3)
        assert page.locator("#sinks tr").count() >= 4
        assert re.search(r"J from the supply.*Efficiency", page.locator("#sources").text_content())
        told_at_once = page.evaluate(
            """() => { document.getElementById("cycle").dispatchEvent(new Event("change"));
              const ids = ["told", "sinks", "sources"];
              return ids.map((id) => document.getElementById(id).textContent); }"""
        )
        assert told_at_once == ["The run is being calculated …", "", ""]
        told.filter(has_text="force reserve").wait_for(timeout=60_000)
        assert page.locator("#duty.old").count() == 0
        old = page.evaluate(
            """() => { change("requirements.stiffness_min.min", 9.8); solve(); paint();
              return document.getElementById("duty").classList.contains("old"); }"""
        )
        assert old
        page.locator("#duty:not(.old)").wait_for(timeout=60_000)
        assert violations(page) == []
        page.set_viewport_size({"width": 320, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= 320
        assert studio.messages == []
