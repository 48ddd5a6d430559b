"""Faults found by attacking the seals: each stands here until it is mended."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError

DESIGNS = Path(__file__).parents[2] / "designs"
KNEE = DESIGNS / "knee_bonded.yaml"
THICK_WIPER = """    wiper:
      compound: pu_94_u_cup
      section: 2 mm
      squeeze: 45 %
      thickness: 200 mm
      width: 0.1 mm
      groove_width: 3 mm
"""
NO_STRESS = """    contact:
      - pressure: 0 bar
        positions: [0 mm, 1 mm]
        stresses: [0 bar, 0 bar]
      - pressure: 210 bar
        positions: [0 mm, 1 mm]
        stresses: [0 bar, 0 bar]
"""


def _seal(folder, *options):
    command = [sys.executable, "-m", "actuator_opt", "seal", str(KNEE), "--seal", "rod", *options]
    return subprocess.run(
        command,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": str(DESIGNS.parent)},
    )


def _with_rod(lines):
    """The knee with more lines in its rod seal."""
    text = KNEE.read_text(encoding="utf-8")
    return text.replace("\nload:\n", f"\n{lines}\nload:\n", 1)


def test_map_makes_its_folder(tmp_path):
    """A map alone is written into a folder that does not exist yet."""
    done = _seal(tmp_path, "--map", "--out", "new", "--quiet")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "new" / "knee_bonded_rod_seal_map.csv").is_file()


def test_remedy_for_no_speed_is_accepted(tmp_path):
    """What the message on standstill tells to write is a speed the option takes."""
    told = _seal(tmp_path, "--speed", "0 m/s").stderr
    example = told.split('--speed "')[1].split('"')[0]
    assert _seal(tmp_path, "--speed", example, "--quiet").returncode == 0


def test_sections_between_the_tables_with_back_up_rings():
    """A ring between two standard sections has a groove width with back-up rings too."""
    text = KNEE.read_text(encoding="utf-8")
    text = text.replace("length: 14 mm", "length: 25 mm")
    for section in (1.78, 1.9, 2.62):
        ao.evaluate(ao.read(text, set={"seals.piston.section": f"{section} mm"}))


def test_wiper_thicker_than_its_section_is_refused():
    """A lip 200 mm thick in a section of 2 mm is a fault, not a friction of 500 GN."""
    with pytest.raises(InputError):
        ao.read(_with_rod(THICK_WIPER), set={"head.length": "30 mm"})


def test_profile_without_stress_is_refused():
    """Stated profiles that press nowhere hold no pressure: a fault, not a seal free of friction."""
    with pytest.raises(InputError):
        ao.evaluate(ao.read(_with_rod(NO_STRESS)))
