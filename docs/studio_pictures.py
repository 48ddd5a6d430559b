"""Pictures of the studio for its tutorial: ``python docs/studio_pictures.py``, run by hand.

It starts the studio on the tutorial's design, drives the page by Chromium (extra ``browser``), and
writes PNG into ``docs/images/studio``, which are committed: the build of the pages has no browser.
Run it again when the page changes. Light mode, 1280 pixels wide, at most 120 kB each.
"""

from __future__ import annotations

import io
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Browser, Locator, Page, sync_playwright

FOLDER = Path(__file__).resolve().parent / "images" / "studio"
CHROMIUM = "/usr/bin/chromium"
LIMIT = 120_000
"""Bytes of a picture, at most."""
PUSH, STIFFNESS = "load_cases[push].force", "requirements.stiffness_min.min"
DUTY = ["--push", "9 kN", "--pull", "5 kN", "--stroke", "180 mm", "--pressure", "160 bar"]


def rise(u: float) -> float:
    """From 0 to 1, smooth at both ends."""
    u = min(max(u, 0.0), 1.0)
    return u**3 * (10 - 15 * u + 6 * u**2)


LIFT = "time [s],position [mm],force [N]\n" + "\n".join(
    f"{t:.3f},{15 + 150 * (rise((t - 0.2) / 1.2) - rise((t - 1.8) / 1.2)):.3f},4905"
    for t in (0.025 * k for k in range(129))
)
WAIT = 180_000


def kept(name: str, place: Page | Locator) -> None:
    """Write the picture of a page or an element."""
    with Image.open(io.BytesIO(place.screenshot())) as picture:
        flat = picture.convert("RGB").quantize(96, dither=Image.Dither.NONE)
    target = FOLDER / f"{name}.png"
    flat.save(target, optimize=True)
    size = target.stat().st_size
    print(target.name, flat.size, size // 1000, "kB")
    if size > LIMIT:
        raise SystemExit(f"{target.name} is larger than {LIMIT} bytes")


@contextmanager
def opened(browser: Browser, folder: Path, design: str, height: int = 900) -> Iterator[Page]:
    """The page of a design in the studio, once prices stand on it."""
    command = [sys.executable, "-m", "actuator_opt", "studio", design, "--no-browser"]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    context = browser.new_context(
        viewport={"width": 1280, "height": height}, color_scheme="light", reduced_motion="reduce"
    )
    try:
        page = context.new_page()
        page.goto(process.stdout.readline().split()[-1])
        settled(page)
        yield page
    finally:
        context.close()
        process.kill()
        process.wait()


def settled(page: Page) -> None:
    """Wait until the newest optimum and its prices stand on the page."""
    page.locator('#main[aria-busy="false"]').wait_for(timeout=WAIT)
    page.locator('#objective:not([class="about"])').wait_for(timeout=WAIT)
    page.locator(".wish .price strong").first.wait_for(timeout=WAIT)
    page.wait_for_timeout(15_000)  # curves and the trade-off follow


def top(page: Page) -> None:
    """Scroll to the head of the page."""
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    page.wait_for_timeout(300)


def typed(page: Page, path: str, text: str) -> None:
    """Type a value into the field of a slider."""
    field = page.locator(f'.wish[data-path="{path}"] input[type=text]')
    field.fill(text)
    field.press("Enter")


def start(folder: Path, name: str, *options: str) -> None:
    """Write a start file, as in the tutorial."""
    command: list[Any] = [sys.executable, "-m", "actuator_opt", "init", name, *options, "--yes"]
    subprocess.run(command, cwd=folder, check=True)


def duty(browser: Browser, folder: Path) -> None:
    """Write the picture of a duty cycle."""
    (folder / "lift.csv").write_text(LIFT)
    start(folder, "lift", "--cycle", "lift.csv", "--pressure", "160 bar")
    with opened(browser, folder, "lift.yaml", 1400) as page:
        if page.locator("#duty").is_visible():
            page.locator("#least").click()
            page.wait_for_timeout(2000)
            kept("duty", page.locator("#duty"))


def main() -> None:
    """Write all pictures."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home, sync_playwright() as playwright:
        folder = Path(home)
        browser = playwright.chromium.launch(executable_path=CHROMIUM)
        start(folder, "leg", *DUTY, "--stiffness", "8 kN/mm")
        with opened(browser, folder, "leg.yaml") as page:
            page.locator("#across").select_option(label="stiffness")
            page.locator("#trade-text", has_text=re.compile(r"\d")).wait_for(timeout=WAIT)
            kept("trade-off", page.locator("#tradeoff"))
            top(page)
            kept("open", page)
            page.locator("#pin").click()
            typed(page, STIFFNESS, "10 kN/mm")
            settled(page)
            top(page)
            kept("moved", page)
            menus = page.locator("#choices")
            if menus.is_visible():
                if menus.get_attribute("open") is None:
                    menus.locator("summary").click()
                menus.locator('[data-path="piston.material"] select').select_option("al_7075_t6")
                settled(page)
                kept("choices", menus)
            typed(page, PUSH, "20 kN")
            page.locator("#card", has_text=re.compile("change|less")).wait_for(timeout=WAIT)
            kept("nothing", page.locator("#drawing"))
        duty(browser, folder)
        browser.close()


if __name__ == "__main__":
    main()
