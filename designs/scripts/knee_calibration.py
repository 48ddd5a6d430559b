"""From a bench record to the redesigned knee: identify, calibrate, optimise again, one page.

The bonded prototype ran on a bench against a load cylinder with a load cell between: constant
speeds from 1 to 200 mm/s, out and in, at three loads. The record is SYNTHETIC: made by this script
from the friction of `TRUTH`, with noise, steps, lag and outliers of real sensors, so that what is
identified can be held against what was put in.

    python designs/scripts/knee_calibration.py                  # prints what changed
    python designs/scripts/knee_calibration.py --out reports    # and writes both pages there
    python designs/scripts/knee_calibration.py --record F.csv   # makes the record anew
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import actuator_opt as ao
from actuator_opt.base.tables import aligned
from actuator_opt.identification import Record, synthetic
from actuator_opt.rendering import terminal
from actuator_opt.studies.bench import Bench, bench

DESIGN = Path(__file__).resolve().parents[1] / "knee_bonded.yaml"
RECORD = DESIGN.parent / "records" / "knee_bench.csv"
TRUTH = synthetic.Truth(
    coulomb=33.0,
    static=60.0,
    stribeck_speed=3e-3,
    exponent=2.0,
    viscous=40.0,
    bristle_stiffness=2e6,
    bristle_damping=400.0,
    pressure_slope=8e-6,
    reference_pressure=5e5,
)
"""Friction put in (SI): seals somewhat smoother than the design states, with a viscous part that it
leaves out. It rises with pressure along a straight line, not by the contact law of the design."""
SENSORS = synthetic.Sensors(pressure_lag=4e-3, spikes=0.01, force_noise=5.0)
"""1 bar noise on 250 bar sensors, 10 um steps, 4 ms lag, one sample in a hundred an outlier."""
SPEEDS = (0.001, 0.002, 0.003, 0.005, 0.01, 0.03, 0.1, 0.2)
LOADS = (0.0, 2000.0, 5000.0)
BACK_PRESSURE = 5e5
EVERY = 4
"""The record keeps one of so many samples of a millisecond: 250 Hz."""
SEED = 6
COLUMNS = {"p1": ("p1 [bar]", 1e-5, 2), "p2": ("p2 [bar]", 1e-5, 2),
           "x": ("x [mm]", 1e3, 2), "F_L": ("F_L [N]", 1.0, 0)}  # fmt: skip


def course() -> tuple[synthetic.PrescribedMotion, np.ndarray]:
    """The motion of the bench, and the load along it [N]."""
    once = synthetic.plateaus(SPEEDS, travel=0.08, begin=0.015, longest=0.8)
    count, step = once.time.size, float(once.time[1])
    velocity = np.tile(once.velocity, len(LOADS))
    load = np.repeat(LOADS, count)
    ramp = np.hanning(201) / np.sum(np.hanning(201))
    load = np.convolve(np.pad(load, 100, mode="edge"), ramp, "valid")
    return synthetic.course(velocity, begin=0.015, step=step), load


def made(own: Bench) -> Record:
    """The record of the bench, from the friction put in."""
    motion, load = course()
    highest = np.full(motion.time.size, BACK_PRESSURE)
    for _ in range(3):  # friction makes pressure, pressure makes friction
        rubbed = synthetic.friction_along(TRUTH, motion, highest)
        highest = np.maximum(
            *synthetic.pressures(
                own, motion, rubbed + load, back_pressure=BACK_PRESSURE, mass=own.mass
            )
        )
    whole = synthetic.record(
        own,
        motion,
        rubbed,
        load=load,
        mass=own.mass,
        back_pressure=BACK_PRESSURE,
        sensors=SENSORS,
        rng=np.random.default_rng(SEED),
    )
    channels = {name: one[::EVERY] for name, one in whole.channels.items()}
    return Record(whole.time[::EVERY], channels, "knee_bench.csv")


def write(record: Record, path: Path) -> None:
    """Write the record as a bench would."""
    names = list(COLUMNS)
    lines = [
        "# SYNTHETIC record of the knee prototype, made by designs/scripts/knee_calibration.py",
        "# load cylinder and load cell on the rod; pressures gauge; F_L against extension",
        ",".join(["t [s]", *(COLUMNS[name][0] for name in names)]),
    ]
    for k, time in enumerate(record.time):
        cells = [f"{record[n][k] * COLUMNS[n][1]:.{COLUMNS[n][2]}f}" for n in names]
        lines.append(",".join([f"{time:.3f}", *cells]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def recovered(calibrated: ao.Calibrated) -> list[list[str]]:
    """What was put in beside what came out, with its bounds."""
    fit = calibrated.calibration.identification.stribeck
    assert not isinstance(fit, str)
    level = TRUTH.coulomb + TRUTH.pressure_slope * (
        fit.reference_pressure - TRUTH.reference_pressure
    )
    truths = {
        "coulomb": ("F_C [N]", level, 1.0),
        "static": ("F_S [N]", level * TRUTH.static / TRUTH.coulomb, 1.0),
        "stribeck_speed": ("v_s [mm/s]", TRUTH.stribeck_speed, 1e3),
        "viscous": ("sigma_2 [N s/m]", TRUTH.viscous, 1.0),
        "pressure_slope": ("dF_C/dp [N/bar]", TRUTH.pressure_slope, 1e5),
    }
    rows = [["", "put in", "found", "lower", "upper", "error"]]
    for name, (words, truth, scale) in truths.items():
        one = fit.parameters[name]
        numbers = [f"{scale * v:.4g}" for v in (truth, one.value, one.lower, one.upper)]
        rows.append([words, *numbers, f"{100 * (one.value / truth - 1):+.1f} %"])
    return rows


def pages(folder: Path) -> list[Path]:
    """Write the page of the record and that of the redesign."""
    knee = ao.read(DESIGN)
    found = ao.identify(RECORD, design=knee)
    return _pages(knee, found, ao.calibrate(found, design=knee), folder)


def _pages(
    knee: ao.Actuator, found: ao.Identification, calibrated: ao.Calibrated, folder: Path
) -> list[Path]:
    command = "python designs/scripts/knee_calibration.py"
    files = ao.write_identification(found, folder=folder, actuator=knee, command=command)
    files += ao.write_calibration(calibrated, folder=folder, command=command)
    return [file.path for file in files]


def main() -> None:
    """Print what the record changes; write the pages where a folder is given."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=Path, help="folder for the pages")
    parser.add_argument("--record", type=Path, help="write the synthetic record there and stop")
    asked = parser.parse_args()
    knee = ao.read(DESIGN)
    if asked.record is not None:
        write(made(bench(knee.subject())), asked.record)
        return
    found = ao.identify(RECORD, design=knee)
    calibrated = ao.calibrate(found, design=knee)
    print(terminal.text(calibrated.page(), colour=False, unicode=True, width=100))
    print(aligned(recovered(calibrated), right=(1, 2, 3, 4, 5)))
    if asked.out is not None:
        for path in _pages(knee, found, calibrated, asked.out):
            print(f"wrote {path}")


if __name__ == "__main__":
    main()
