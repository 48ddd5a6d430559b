"""Time of the studio in a browser, from a slider's input event to the painted optimum.

``python benchmarks/studio.py [DESIGN] [MOVES] [--offline]`` drags the first requirement; it needs
Playwright and Chromium. Cold solves between the moves are printed beside it, as times depend on the
machine. With ``--offline``, the offline page of the same design is measured in turns with it.
"""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

import actuator_opt as ao

FLAGS = ("--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run")
MOVE = """async (share) => {
  const frame = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  const range = document.querySelector("#asked input[type=range]");
  const main = document.getElementById("main");
  const low = Number(range.min), high = Number(range.max);
  const start = performance.now();
  range.value = low + share * (high - low);
  range.dispatchEvent(new Event("input", { bubbles: true }));
  const about = document.getElementById("objective").textContent.startsWith("about");
  await frame();
  const forecast = performance.now() - start;
  while (main.getAttribute("aria-busy") === "true") await frame();
  return { truth: performance.now() - start, forecast: about ? forecast : null };
}"""


ROUNDS = 5
"""Number of cold solves, each before its share of the moves."""


def cold(actuator):
    """Milliseconds of a cold solve without prices."""
    start = time.perf_counter()
    ao.optimise(actuator, prices=False)
    return 1000 * (time.perf_counter() - start)


def served(design, moves):
    """The live page: milliseconds of cold solves, and to the forecast and result of each move."""
    command = [sys.executable, "-m", "actuator_opt", "studio", design, "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        address = server.stdout.readline().split()[-1]
        return dragged(design, address, moves)
    finally:
        server.kill()
        server.wait()


def offline(design, moves):
    """The same moves on the offline page of the design, which is written first."""
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        command = [sys.executable, "-m", "actuator_opt", "studio", design, "--offline", page, "-q"]
        subprocess.run(command, check=True)
        print(f"offline page: {page.stat().st_size / 1000:.0f} kB")
        return dragged(design, page.as_uri(), moves)


def dragged(design, address, moves):
    """Milliseconds of cold solves, and to the forecast and the result of each move.

    The moves lead to 85 to 108 % of the value in the file.
    """
    actuator = ao.read(design)
    ao.optimise(actuator, prices=False)
    with sync_playwright() as driver, tempfile.TemporaryDirectory() as profile:
        browser = shutil.which("chromium") or shutil.which("google-chrome")
        context = driver.chromium.launch_persistent_context(
            profile, executable_path=browser, args=[*FLAGS]
        )
        page = context.new_page()
        page.goto(address)
        page.locator("#fixed .wish").first.wait_for(timeout=120_000)
        shares = [0.2 + 0.45 * ((k * 0.618034) % 1) for k in range(moves)]
        solves, rows = [], []
        for k in range(ROUNDS):
            solves.append(cold(actuator))
            rows += [page.evaluate(MOVE, share) for share in shares[k::ROUNDS]]
        context.close()
    return solves, rows


def main():
    """Print median and 95th percentile, in ms and as a share of a cold solve."""
    words = [word for word in sys.argv[1:] if word != "--offline"]
    design = words[0] if words else "designs/knee.yaml"
    moves = int(words[1]) if len(words) > 1 else 60
    both = (served, offline, served, offline) if "--offline" in sys.argv else (served,)
    for measure in both:
        solves, rows = measure(design, moves)
        whole = statistics.median(solves)
        print(f"{design}, load {os.getloadavg()[0]:.1f}; cold solve {whole:.0f} ms")
        for name in ("forecast", "truth"):
            times = sorted(row[name] for row in rows if row[name] is not None)
            if times:
                p50, p95 = statistics.median(times), times[int(0.95 * (len(times) - 1))]
                shares = f"{p50 / whole:.2f} and {p95 / whole:.2f} of cold"
                told = f"{len(times)} moves, p50 {p50:.0f} ms, p95 {p95:.0f} ms ({shares})"
                print(f"{measure.__name__}, {name}: {told}")


if __name__ == "__main__":
    main()
