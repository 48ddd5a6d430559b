"""The studio in a real browser: drag, keys, undo, A and B, save, refusals, phone width, Ctrl-C.

One studio and one browser serve all tests, in order: starting them is most of the time.
"""

from __future__ import annotations

import io
import re
import signal
import subprocess
import sys

import pytest
from cli_runner import DESIGNS
from pypdf import PdfReader

import actuator_opt as ao

STIFFNESS = "requirements.stiffness_min.min"


class Studio:
    """A running studio, and its page."""

    def __init__(self, folder, page, process, address):
        self.folder, self.page, self.process, self.address = folder, page, process, address
        self.messages = []
        page.on("console", lambda message: self.messages.append(message.text))
        page.on("pageerror", lambda error: self.messages.append(str(error)))

    def slider(self, path=STIFFNESS):
        """The slider of a number."""
        return self.page.locator(f'.wish[data-path="{path}"] input[type=range]')

    def field(self, path=STIFFNESS):
        """The field of a number."""
        return self.page.locator(f'.wish[data-path="{path}"] input[type=text]')

    def text(self, name):
        """The text of an element."""
        return self.page.locator(f"#{name}").text_content()

    def rest(self):
        """Wait until the truth of the newest wish is painted."""
        self.page.locator('#main[aria-busy="false"]').wait_for(timeout=60_000)

    @property
    def mass(self):
        """The headline in g, once it is true."""
        self.rest()
        self.page.locator('#objective:not([class="about"])').wait_for()
        return float(re.match(r"[\d.]+", self.text("objective"))[0])

    @property
    def value(self):
        """The stiffness in the field, in kN/mm."""
        return float(self.field().input_value().partition(" ")[0])


@pytest.fixture(scope="module")
def studio(browser, tmp_path_factory):
    """The steel knee in the studio, as a user starts it."""
    folder = tmp_path_factory.mktemp("browser")
    (folder / "steel.yaml").write_text((DESIGNS / "steel_baseline.yaml").read_text("utf-8"))
    process = subprocess.Popen(
        [sys.executable, "-m", "actuator_opt", "studio", "steel.yaml", "--no-browser"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    address = process.stdout.readline().split()[-1]
    try:
        context = browser.new_context(
            viewport={"width": 1200, "height": 900}, reduced_motion="reduce"
        )
        one = Studio(folder, context.new_page(), process, address)
        one.page.goto(address)
        yield one
        context.close()
    finally:
        process.kill()
        process.wait()


def test_it_opens_with_the_optimum_and_hides_its_key(studio):
    """The page shows the best mass, and the token is no longer in the address bar."""
    best = ao.optimise(studio.folder / "steel.yaml", prices=False).objective_value
    assert studio.mass == pytest.approx(1000 * best, abs=0.06)
    assert studio.page.url == studio.address.partition("#")[0]
    assert studio.page.locator("#section path").count() > 10
    studio.page.locator(f'.wish[data-path="{STIFFNESS}"] .price strong').wait_for()
    studio.page.locator("#fixed .wish").first.wait_for(timeout=60_000)
    prices = studio.page.locator("#asked .price").all_text_contents()
    assert any(" g per kN/mm here; the same limits hold from about " in x for x in prices)
    found = (re.fullmatch(r"costs nothing above (\S+) N \(now (\S+) N\)", x) for x in prices)
    ((edge, now),) = (map(float, x.groups()) for x in found if x)
    assert edge == pytest.approx(now, rel=5e-3)
    studio.page.reload()  # the tab keeps its key
    assert studio.mass == pytest.approx(1000 * best, abs=0.06)
    studio.page.keyboard.press("Tab")
    studio.page.keyboard.press("Enter")
    assert studio.page.evaluate("document.activeElement.closest('#asked') !== null")


def test_keys_forecast_and_truth(studio):
    """One step inside `holds`: a forecast in the same frame, then the truth, equal to 0.1 g."""
    page = studio.page
    page.locator(f'.wish[data-path="{STIFFNESS}"] .price:not(.old) strong').wait_for()
    before = studio.mass
    studio.slider().focus()
    forecast = page.evaluate(
        """() => {
          document.activeElement.dispatchEvent(
            new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, cancelable: true }));
          return document.getElementById("objective").textContent;
        }"""
    )
    assert forecast.startswith("about ")
    after = studio.mass
    assert after < before
    assert float(re.search(r"[\d.]+", forecast)[0]) == pytest.approx(after, abs=0.15)
    assert re.search(r"kN/mm, .* g per kN/mm", studio.slider().get_attribute("aria-valuetext"))


def test_a_drag_is_one_step_back(studio):
    """Many moves of the pointer are undone at once, and done again."""
    page, before, start = studio.page, studio.mass, studio.value
    box = studio.slider().bounding_box()
    y = box["y"] + box["height"] / 2
    at = box["x"] + 9 + (box["width"] - 18) * 0.48
    page.mouse.move(at, y)
    page.mouse.down()
    for k in range(6):
        page.mouse.move(at - 9 * k, y)
    page.mouse.up()
    dragged, moved = studio.mass, studio.value
    assert moved < start
    assert dragged < before
    page.keyboard.press("Control+z")
    assert (studio.value, studio.mass) == (start, before)
    page.keyboard.press("Control+Shift+z")
    assert (studio.value, studio.mass) == (moved, dragged)


def test_a_beside_b(studio):
    """A stays as outline, masses and difference; swapping brings it back."""
    page, first = studio.page, studio.mass
    page.keyboard.press("p")
    assert page.locator("#section .other").count() == 1
    studio.field().fill("9.1")
    studio.field().press("Enter")
    studio.slider().focus()
    second = studio.mass
    assert second != first
    shown = studio.text("against").replace("\N{MINUS SIGN}", "-")
    assert float(shown.split(", ")[1]) == pytest.approx(second - first, abs=0.11)
    assert page.locator("#masses tr").first.locator("td").count() == 4
    page.keyboard.press("x")
    assert studio.mass == first
    assert studio.text("against").startswith(f"A {second:.4g} g")
    page.keyboard.press("p")
    assert page.locator("#section .other").count() == 0


def test_typing_takes_units_and_refuses_nonsense(studio):
    """A refusal says which units there are, keeps the design, and is taken back by a good value."""
    before = studio.mass
    messages = len(studio.messages)
    studio.field().fill("9 bananas")
    studio.field().press("Enter")
    fault = studio.page.locator(f'.wish[data-path="{STIFFNESS}"] .fault')
    fault.filter(has_text="bananas").wait_for()
    assert studio.field().get_attribute("aria-invalid") == "true"
    assert studio.mass == before
    assert all("422" in text for text in studio.messages[messages:])
    del studio.messages[messages:]
    studio.field().fill("9200 N/mm")
    studio.field().press("Enter")
    fault.wait_for(state="hidden")
    studio.slider().focus()
    studio.mass  # noqa: B018
    assert studio.field().input_value() == "9.2 kN/mm"


def test_the_trade_off_is_traced(studio):
    """A curve of optima with the present design on it, also of a dimension."""
    page = studio.page
    page.locator("#trade-text").filter(has_text="Every point is an optimum").wait_for(
        timeout=60_000
    )
    assert page.locator("#trade .now").count() == 1
    page.locator("#up").select_option(label="bore")
    assert studio.text("trade-text").startswith("bore: ")
    page.locator("#up").select_option(label="best running friction")
    page.locator("#trade-text").filter(
        has_text=re.compile("best running friction at .* g or less: ")
    ).wait_for(timeout=60_000)
    page.locator("#up").select_option("")


def test_what_nothing_reaches_is_searched_for(studio):
    """The page says so at once, keeps the last design in grey, and a newer wish ends the search."""
    page, before = studio.page, studio.mass
    studio.field().fill("60 kN/mm")
    studio.field().press("Enter")
    page.locator("#objective").filter(has_text="no design found yet, searching").wait_for()
    assert page.locator("body.stale").count() == 1
    assert re.search(r"shown in grey: [\d.]+ g, at stiffness 9.2 kN/mm", studio.text("lengths"))
    assert float(studio.slider().get_attribute("min")) <= 9.2
    assert page.locator("#asked .price strong").count() == 0
    page.keyboard.press("Escape")
    studio.slider().focus()
    page.keyboard.press("Control+z")
    assert studio.mass == before
    assert page.locator("body.stale").count() == 0


def test_saving_asks_before_it_replaces(studio):
    """The file agrees with the page; a second time the name is questioned, then replaced."""
    page, mass = studio.page, studio.mass
    for answer in ("Save", "Replace"):
        page.keyboard.press("s")
        page.locator("#file").fill("best.yaml")
        page.locator("#save-yes").click()
        if answer == "Replace":
            page.locator("#save-note").filter(has_text="Replace best.yaml?").wait_for()
            page.locator("#save-yes", has_text="Replace").click()
        page.locator("#save-dialog").wait_for(state="hidden")
        notice = page.locator("header #note").filter(has_text="Saved best.yaml")
        notice.wait_for()
        notice.get_by_role("button").click()
        notice.wait_for(state="hidden")
    evaluation = ao.evaluate(studio.folder / "best.yaml")
    assert 1000 * evaluation.metrics["mass"].value == pytest.approx(mass, abs=0.06)
    assert evaluation.met
    messages = len(studio.messages)
    page.keyboard.press("s")
    page.locator("#file").fill("../best")
    page.locator("#save-yes").click()
    page.locator("#save-note").filter(has_text="not a plain file name").wait_for()
    page.keyboard.press("Escape")
    assert not (studio.folder.parent / "best.yaml").exists()
    del studio.messages[messages:]


@pytest.mark.parametrize("width", [320, 1600])
def test_it_fits_every_width(studio, width):
    """No sideways scrolling, and every control has a name."""
    page = studio.page
    page.set_viewport_size({"width": width, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    nameless = page.locator("input, select, button, svg[role]").evaluate_all(
        """all => all.filter(x => !(x.ariaLabel || x.textContent.trim() || (x.labels || []).length))
          .map(x => x.outerHTML)"""
    )
    assert nameless == []


def test_it_prints_on_one_page(studio):
    """With prices, without what cannot be printed."""
    studio.rest()
    printed = PdfReader(io.BytesIO(studio.page.pdf()))
    assert len(printed.pages) == 1
    text = printed.pages[0].extract_text()
    assert "Mass by part" in text
    assert "per kN/mm" in text
    assert "Undo" not in text
    assert "Trade-off" not in text


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_have_contrast(studio, scheme):
    """At least 4.5 to 1, the least of WCAG 2.2 AA, for ink, grey, A and faults on both papers."""
    page = studio.page
    page.emulate_media(color_scheme=scheme)
    colours = page.evaluate(
        """() => { const style = getComputedStyle(document.documentElement);
          return Object.fromEntries(["paper", "card", "ink", "grey", "a", "bad", "accent"].map(
            (name) => [name, style.getPropertyValue(`--${name}`).trim()])); }"""
    )

    def light(colour):
        digits = colour[1:] if len(colour) == 7 else "".join(2 * x for x in colour[1:])
        parts = [int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    for text in ("ink", "grey", "a", "bad", "accent"):
        for paper in ("paper", "card"):
            dark, bright = sorted((light(colours[text]), light(colours[paper])))
            assert (bright + 0.05) / (dark + 0.05) >= 4.5, (text, paper)


def test_a_foreign_key_is_explained(studio):
    """A page without the key of this start says so, and shows nothing of the design."""
    other = studio.page.context.new_page()
    other.goto(f"{studio.page.url}#{'x' * 32}")
    other.locator("#bar").filter(has_text="Open the address").wait_for()
    assert other.locator(".wish").count() == 0
    other.close()


def test_the_server_may_go_and_ctrl_c_says_how_to_go_on(studio):
    """Ctrl-C prints the command of the present design; the page says that it waits."""
    assert studio.messages == []
    studio.rest()
    studio.process.send_signal(signal.SIGINT)
    out, _ = studio.process.communicate(timeout=20)
    assert out.strip() == f"actuator-opt optimise steel.yaml --set '{STIFFNESS}=9.2 kN/mm'"
    assert studio.process.returncode == 130
    studio.slider().focus()
    studio.page.keyboard.press("ArrowRight")
    studio.page.locator("#bar").filter(has_text="does not answer").wait_for()
    assert studio.value > 9.2
