"""Run the command line inside the test process: exit code, stdout, stderr, as a shell sees them."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from actuator_opt import cli

ROOT = Path(__file__).resolve().parents[2]
DESIGNS = ROOT / "designs"
KNEE = DESIGNS / "knee_bonded.yaml"

BENCH = """\
name: test bench

fluid:
  material: iso_vg_32
  temperature: 40 degC
  air_content: 0.5 %

supply:
  pressure: 210 bar
  return_pressure: 5 bar

environment:
  temperature_min: 0 degC
  temperature_max: 80 degC
  trapped_rise: 4 K
  cure_temperature: 120 degC

cylinder:
  bore: 22 mm
  stroke: 110 mm
  mount: cap_clevis
  end_stop: internal
  dead_volume_a: 3 ml
  dead_volume_b: 3 ml
  port_diameter: 6 mm
  stop_travel: 1 mm

barrel:
  layup:
    - material: al_7075_t6
      thickness: 0.4 mm
    - material: t700_epoxy
      angle: 88 deg
      thickness: 1.2 mm
    - material: t700_epoxy
      angle: 25 deg
      thickness: 1.6 mm

rod:
  material: steel_42crmo4
  outer_diameter: 11.5 mm
  inner_diameter: 7 mm
  extension: 12 mm
  thread:
    diameter: 10 mm
    pitch: 1.25 mm

piston:
  material: al_7075_t6
  length: 14 mm
  clearance: 30 um

head:
  material: al_7075_t6
  length: 14 mm
  clearance: 30 um

caps:
  material: ti_6al4v
  thickness: 8 mm

retention:
  type: bond
  material: epoxy_structural
  length: 22 mm
  wall: 2 mm

clevis:
  material: steel_42crmo4
  pin_diameter: 8 mm

seals:
  piston:
    type: o_ring
    compound: nbr_90
    section: 1.78 mm
    squeeze: 16 %
    tolerance: 0.05 mm
    friction_coefficient: 0.10
  rod:
    type: o_ring
    compound: nbr_90
    section: 1.78 mm
    squeeze: 16 %
    tolerance: 0.05 mm
    friction_coefficient: 0.10

load:
  mass: 20 kg

load_cases:
  - name: stance
    direction: push
    force: 4 kN
    speed: 0.1 m/s
    side_load: 30 N
  - name: swing
    direction: pull
    force: 2 kN
    speed: 0.2 m/s

variables:
  cylinder.bore:
    lower: 20 mm
    upper: 30 mm
  barrel.layup[1].thickness:
    lower: 0.5 mm
    upper: 4 mm
  retention.wall:
    lower: 1 mm
    upper: 10 mm

requirements:
  stiffness_min:
    min: 6 kN/mm
  seal_gap:
    max: 60 um
  friction_running:
    max: 500 N
  burst_factor:
    min: 3
  first_ply_factor:
    min: 2
  buckling_factor:
    min: 2.5

waivers:
  seal_section: 1.78 mm rings fit the small bore; spiral failure judged on the test rig

objective:
  minimise: mass
"""
"""A design of our own with room in every requirement: shipped ones change with their numbers."""


PLIES = (
    ("      thickness: 1.2 mm\n", "      thickness: 1.2 mm\n      ply_thickness: 0.2 mm\n"),
    ("      thickness: 1.6 mm\n", "      thickness: 1.6 mm\n      ply_thickness: 0.2 mm\n"),
)
"""Changes that make both layers of fibres of the bench design of whole plies."""


@dataclass(frozen=True)
class Result:
    """What a command left behind."""

    code: int
    out: str
    err: str

    @property
    def json(self):
        """The one JSON object on stdout; numbers that are no JSON are refused."""
        return one_object(self.out)

    @property
    def errors(self):
        """The diagnostics of a failure under --json."""
        data = self.json
        assert list(data) == ["errors"], list(data)
        for fault in data["errors"]:
            assert set(fault) == {"file", "line", "column", "path", "message", "remedy"}
        return data["errors"]


def one_object(text):
    """Parse exactly one JSON object, without NaN or Infinity."""

    def refuse(word):
        raise AssertionError(f"{word} is no JSON")

    data = json.loads(text, parse_constant=refuse)
    assert isinstance(data, dict)
    return data


def run(*arguments, stdin=b"", encoding="utf-8", environment=None):
    """Run one command in this process; sub-processes are for what a process alone can show."""
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    given = io.TextIOWrapper(io.BytesIO(stdin), encoding="utf-8")
    patches = [
        mock.patch.object(sys, "argv", ["actuator-opt", *map(str, arguments)]),
        mock.patch.object(sys, "stdin", given),
        mock.patch.object(sys, "stdout", streams[0]),
        mock.patch.object(sys, "stderr", streams[1]),
        mock.patch.dict(os.environ, environment or {}),
    ]
    code = 0
    for patch in patches:
        patch.start()
    try:
        cli.main()
    except SystemExit as leaving:
        code = leaving.code or 0
    finally:
        for patch in reversed(patches):
            patch.stop()
    texts = []
    for stream in streams:
        stream.flush()
        texts.append(stream.buffer.getvalue().decode(encoding))
    result = Result(code, *texts)
    assert "Traceback" not in result.err + result.out
    return result


def command(*arguments):
    """The command line for a process of its own."""
    return [sys.executable, "-m", "actuator_opt", *map(str, arguments)]


def surroundings(**changes):
    """Environment of a process of its own, without what would colour or date its output."""
    clean = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "SOURCE_DATE_EPOCH")}
    return clean | {"PYTHONPATH": str(ROOT)} | changes


def spawn(*arguments, **options):
    """Run one command in a process of its own."""
    environment = options.pop("environment", {})
    return subprocess.run(
        command(*arguments),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env=surroundings(**environment),
        **options,
    )


def bench(*changes):
    """The bench design's text with (old, new) pairs replaced, each of them found."""
    text = BENCH
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def block(name):
    """The text of one top-level block of the bench design."""
    start = BENCH.index(f"\n{name}:") + 1
    lines = BENCH[start:].splitlines(keepends=True)
    end = next((i for i, line in enumerate(lines) if i and line[:1].isalpha()), len(lines))
    return "".join(lines[:end])


def evaluated(text=BENCH, *arguments):
    """The JSON of `evaluate` of a text; its own laws are checked on the way."""
    result = run("evaluate", "-", "--json", *arguments, stdin=text.encode())
    assert result.code in (0, 1), result.out
    data = result.json
    assert (result.code == 0) == all(row["met"] for row in data["requirements"])
    for name, metric in data["metrics"].items():
        keys = {"value", "unit", "label", "model", "reference", "in_range", "case"}
        assert keys <= set(metric), name
        assert (metric["value"] is None) == bool(metric.get("why")), name
    for check in data["checks"]:
        assert check["status"] in ("met", "missed", "not_checked")
        assert check["reason"] or check["status"] != "not_checked", check
    for row in data["requirements"]:
        if row["value"] is not None:
            margin = (row["value"] - row["limit"]) / (abs(row["limit"]) or 1.0)
            margin = margin if row["sense"] == "min" else -margin
            assert abs(margin - row["margin"]) <= 1e-9 * max(1.0, abs(margin)), row
            assert row["met"] == (row["margin"] >= -1e-6), row
    return data


def refused(text=BENCH, *arguments, command="evaluate"):
    """The faults of a design that must be refused (exit 3)."""
    result = run(command, "-", "--json", *arguments, stdin=text.encode())
    assert result.code == 3, result.out
    assert result.err == ""
    return result.errors
