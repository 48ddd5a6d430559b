"""A browser for tests of pages: Playwright drives the one that is installed, or they skip."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
ARGUMENTS = (
    "--no-sandbox", "--disable-gpu", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--no-first-run",
)  # fmt: skip
WAIT = 20_000  # ms; a loaded machine is no failure


@contextmanager
def started() -> Iterator[object]:
    """The installed browser with an empty profile; nothing is downloaded."""
    api = pytest.importorskip(
        "playwright.sync_api", reason="no Playwright: pip install 'actuator-opt[browser]'"
    )
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed")
    with api.sync_playwright() as playwright:
        try:
            launched = playwright.chromium.launch(executable_path=program, args=[*ARGUMENTS])
        except api.Error as error:
            pytest.skip(f"the browser does not run here: {str(error).splitlines()[0]}")
        yield launched
        launched.close()


class Visits:
    """Pages that a test opens; each must stay silent and load nothing but its own file."""

    def __init__(self, browser):
        self.browser = browser
        self.contexts, self.faults = [], []

    def __call__(self, path: Path, *, width: int = 1024, height: int = 900, **options):
        """Open a file; `options` are those of a context, such as `color_scheme`."""
        context = self.browser.new_context(viewport={"width": width, "height": height}, **options)
        context.set_default_timeout(WAIT)
        self.contexts.append(context)
        address = Path(path).as_uri()

        def requested(request):
            if request.url != address and not request.url.startswith("blob:"):
                self.faults.append(f"asked for {request.url}")

        context.on("request", requested)
        context.on("console", lambda message: self.faults.append(f"console: {message.text}"))
        context.on("weberror", lambda error: self.faults.append(f"error: {error.error}"))
        page = context.new_page()
        page.goto(address)
        return page

    def close(self):
        """Close the pages; return what they should not have done."""
        for context in self.contexts:
            context.close()
        return self.faults


CONTRAST = Path(__file__).with_name("contrast.js").read_text("utf-8")
CONTROLS = r"^ *- (button|checkbox|combobox|slider|spinbutton|textbox|region|table)\b(.*)$"


def contrasts(page):
    """Contrast of every visible text, the lowest first: (ratio, element, text)."""
    return page.evaluate(CONTRAST)


def controls(page):
    """Role and name of every control, as a screen reader says them; empty if it has no name."""
    found = re.findall(CONTROLS, page.locator("body").aria_snapshot(), re.MULTILINE)
    return [(role, rest if rest.startswith(' "') else "") for role, rest in found]


def violations(page):
    """What axe-core objects to: (rule, elements); skips without axe-playwright-python."""
    axe = pytest.importorskip("axe_playwright_python", reason="no axe-playwright-python")
    page.evaluate(Path(axe.__file__).with_name("axe.min.js").read_text("utf-8"))
    found = page.evaluate("axe.run()")["violations"]
    return [(rule["id"], [node["html"] for node in rule["nodes"]]) for rule in found]
