"""The default contact law of O-rings: its grid of finite elements, and its fit; run by hand.

    python benchmarks/o_ring_law.py grid      computes benchmarks/o_ring_grid.csv (minutes)
    python benchmarks/o_ring_law.py fit       fits the law to it, prints coefficients and errors

The ring is in plane strain, of incompressible neo-Hookean rubber, without friction, in a groove
1.4 sections wide with rigid walls. The groove's width does not matter while the ring does not fill
it. The coefficients are in `actuator_opt/models/seals.py`; `tests/models/test_models_seal_fit.py`
compares them with the grid.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import astuple
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from actuator_opt.finite_elements.material import MooneyRivlin
from actuator_opt.finite_elements.o_ring import squeezed_ring
from actuator_opt.models import seals

GRID = Path(__file__).with_name("o_ring_grid.csv")
SQUEEZES = (0.08, 0.10, 0.125, 0.15, 0.175, 0.20, 0.225, 0.25)
PRESSURES = (0.05, 0.1, 0.15, 0.25, 0.4, 0.5, 0.75, 1.0, 1.25, 1.5)
GROOVE_WIDTH, ELEMENTS_AROUND = 1.4, 192
COLUMNS = ("squeeze", "pressure", "line_load", "width", "peak_pressure")
NORM = 8
"""Power of the error that the fit makes least: close to the largest error."""

Numbers = npt.NDArray[np.float64]


def computed() -> list[tuple[float, ...]]:
    """Load over E W, width over W and peak over E of the ring at every squeeze and p/E."""
    rows = []
    for squeeze in SQUEEZES:
        ring = squeezed_ring(
            section=1.0,
            squeeze=squeeze,
            groove_width=GROOVE_WIDTH,
            rubber=MooneyRivlin.of_modulus(1.0),
            pressures=PRESSURES,
            elements_around=ELEMENTS_AROUND,
        )
        if ring.failure:
            raise SystemExit(f"squeeze {squeeze}: {ring.failure}")
        rows += [
            (squeeze, one.pressure, one.line_load, one.width, one.peak_pressure)
            for one in ring.contacts
        ]
        print(f"squeeze {squeeze}: {len(ring.contacts)} pressures")
    return rows


def written(rows: list[tuple[float, ...]]) -> None:
    """The grid as CSV."""
    with GRID.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows([f"{value:.5g}" for value in row] for row in rows)


def read() -> dict[str, Numbers]:
    """Columns of the stored grid."""
    table = np.genfromtxt(GRID, delimiter=",", names=True)
    return {name: np.asarray(table[name]) for name in COLUMNS}


def errors(ring: seals.EnergisedRing, grid: dict[str, Numbers]) -> dict[str, Numbers]:
    """Relative errors of a law on a grid."""
    point = {"squeeze": grid["squeeze"], "pressure": grid["pressure"]}
    unit = {"section": 1.0, "youngs_modulus": 1.0}
    values = {
        "line_load": ring.line_load(**point, **unit),
        "width": ring.contact_width(**point, **unit),
        "peak_pressure": ring.peak_pressure(**point, **unit),
    }
    return {name: value / grid[name] - 1 for name, value in values.items()}


def fitted(grid: dict[str, Numbers]) -> seals.EnergisedRing:
    """The law of the least largest error in load and width, nearly."""

    def law(numbers: Numbers) -> seals.EnergisedRing:
        a, b, narrowing, growth, slope, half = (float(value) for value in numbers)
        return seals.EnergisedRing((a, b), narrowing, (growth, slope), half)

    def residuals(numbers: Numbers) -> Numbers:
        error = errors(law(numbers), grid)
        return np.concatenate((error["line_load"], error["width"]))

    def steep(numbers: Numbers) -> Numbers:
        return (30 * np.abs(residuals(numbers))) ** (NORM / 2)

    start = np.hstack(astuple(seals.ENERGISED_RING))
    return law(least_squares(steep, least_squares(residuals, start, xtol=1e-12).x, xtol=1e-12).x)


def main() -> None:
    """Compute the grid, or fit to it."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("what", choices=("grid", "fit"))
    if parser.parse_args().what == "grid":
        written(computed())
        return
    grid = read()
    for label, law in (("shipped", seals.ENERGISED_RING), ("fitted", fitted(grid))):
        print(label, " ".join(f"{value:.4f}" for value in np.hstack(astuple(law))))
        for name, error in errors(law, grid).items():
            worst = int(np.argmax(np.abs(error)))
            at = f"squeeze {grid['squeeze'][worst]:g}, p/E {grid['pressure'][worst]:g}"
            print(f"    {name}: within {100 * abs(error[worst]):.2f} %, worst at {at}")


if __name__ == "__main__":
    main()
