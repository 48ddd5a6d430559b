"""The machine of pages, in node and in a browser: equal to that in C, values and derivatives."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from test_recording import BINARY, UNARY, grown, recorded

import actuator_opt as ao
from actuator_opt.base.polynomial import root_parts
from actuator_opt.base.symbolic import program as programs
from actuator_opt.optimisation.actuator import build

ROOT = Path(__file__).parents[2]
SCRIPT = programs.SCRIPT.read_text("utf-8")
NODE = shutil.which("node")
pytestmark = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
in_node = pytest.mark.skipif(NODE is None, reason="no node")
RUN = """
const results = [];
for (const [data, points, seeds] of JOBS) {
  const program = Machine.program(data), numbers = [];
  for (const text of points) {
    const point = new Float64Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
    const { values, slopes } = Machine.run(program, point, seeds);
    numbers.push(...values, ...slopes);
  }
  const bytes = new Uint8Array(Float64Array.from(numbers).buffer);
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  results.push(btoa(text));
}
"""


def compared(jobs, folder, visit=None):
    """Values and slopes of every job by JavaScript and by C; a job is (program, points, seeds)."""
    data = [
        (
            made.for_page(),
            [
                base64.b64encode(np.asarray(point, dtype="<f8").tobytes()).decode()
                for point in points
            ],
            [] if seeds is None else seeds.T.tolist(),
        )
        for made, points, seeds in jobs
    ]
    code = f"{SCRIPT}\nconst JOBS = {json.dumps(data)};\n{RUN}"
    answer = browsed(code, folder, visit) if visit else noded(code, folder)
    for (made, points, seeds), text in zip(jobs, answer, strict=True):
        found = np.frombuffer(base64.b64decode(text), "<f8").reshape(len(points), -1)
        count = len(made.outputs)
        if seeds is None:
            yield found, made.values(points)
            continue
        repeated = np.broadcast_to(seeds, (len(points), *seeds.shape)).copy()
        duals = made.duals(programs.NOTHING, points, repeated)
        yield found[:, :count], duals[:, :, 0]
        yield found[:, count:].reshape(len(points), count, -1), duals[:, :, 1:]


def noded(code, folder):
    """Results of a script in node."""
    file = folder / "run.js"
    file.write_text(f"{code}console.log(JSON.stringify(results));\n", "utf-8")
    done = subprocess.run([NODE, file], capture_output=True, text=True, check=True, timeout=300)
    return json.loads(done.stdout)


def browsed(code, folder, visit):
    """Results of a script in a page without network."""
    file = folder / "run.html"
    file.write_text(f'<meta charset="utf-8"><script>{code}</script>', "utf-8")
    return visit(file).evaluate("results")


def close(found, expected, room, least=1e-30):
    """Check numbers relative to their size, but at least `least`; NaN and infinity are equal."""
    finite = np.isfinite(expected)
    assert np.array_equal(finite, np.isfinite(found))
    np.testing.assert_array_equal(found[~finite], expected[~finite])
    mine, theirs = found[finite], expected[finite]
    error = np.abs(mine - theirs) / np.maximum(np.abs(theirs), least)
    worst = float(np.max(error, initial=0.0))
    assert worst <= room


def test_names_are_those_of_the_machine():
    """The operations in both languages, in one order."""
    words = re.search(r"const NAMES = \((.*?)\)\.split", SCRIPT, re.DOTALL)[1]
    assert tuple(" ".join(re.findall(r'"([^"]*)"', words)).split()) == programs.OPERATIONS
    cases = re.search(r"function valueOf.*?\n  }", SCRIPT, re.DOTALL)[0]
    assert len(re.findall(r"case \d+:", cases)) + 2 == len(programs.OPERATIONS)


@in_node
def test_every_operation(tmp_path):
    """At ordinary numbers, zeros, infinities and NaN."""
    known = [0.0, -0.0, 1.0, -1.0, 0.3, -0.7, 2.5, -3.0, 40.0, np.inf, -np.inf, np.nan]
    singles, pairs = np.array(known)[:, None], np.array([(a, b) for a in known for b in known])
    jobs = [(recorded(ufunc, np.array([0.5]))[1], singles, np.eye(1)) for ufunc in UNARY]
    for ufunc in BINARY:
        made = recorded(lambda x, ufunc=ufunc: ufunc(x[:1], x[1:]), np.array([0.5, 0.7]))[1]
        jobs.append((made, pairs, np.eye(2)))
    for found, expected in compared(jobs, tmp_path):
        close(found, expected, 1e-15)


@in_node
def test_random_programs(tmp_path):
    """Chains of exactly rounded operations: the same bits, any number of directions."""
    rng, jobs = np.random.default_rng(5), []
    for k in range(60):
        steps = [tuple(row) for row in rng.integers(0, (12, 10**6, 10**6), (40, 3)).tolist()]
        points = rng.choice([-1.0, 1.0], (4, 3)) * np.exp(2 * rng.standard_normal((4, 3)))

        def chain(x, steps=steps):
            return np.stack(np.broadcast_arrays(*grown(steps, list(x[:, None]))))

        jobs.append((recorded(chain, np.ones(3))[1], points, rng.standard_normal((3, k % 6 + 1))))
    for found, expected in compared(jobs, tmp_path):
        close(found, expected, 1e-13)


@in_node
def test_roots(tmp_path):
    """Polynomials of degree 1 to 8; roots are sorted, because equal distances have no order."""
    rng = np.random.default_rng(6)
    for degree in range(1, 9):

        def parts(x):
            along, across = root_parts(list(x))
            return np.concatenate([along.reshape(-1), across.reshape(-1)])

        points = rng.standard_normal((20, degree + 1)) * 10.0 ** rng.integers(-3, 4, (20, 1))
        made = recorded(parts, np.ones(degree + 1))[1]
        ((found, expected),) = compared([(made, points, None)], tmp_path)
        for mine, theirs in zip(found, expected, strict=True):
            first, second = (
                np.sort_complex(np.round(x[:degree] + 1j * x[degree:], 9)) for x in (mine, theirs)
            )
            np.testing.assert_allclose(first, second, rtol=1e-8)


@pytest.mark.parametrize("place", [pytest.param("node", marks=in_node), "browser"])
def test_the_knee(place, tmp_path, request):
    """Values and all gradients of a whole design, at points of its box.

    Functions such as exp differ in the last digit between languages. Where slopes of a thousand
    cancel, this shows in a slope near zero: one in a thousand may differ by more than 1e-13.
    """
    visit = request.getfixturevalue("visit") if place == "browser" else None
    actuator = build(ao.read(ROOT / "designs/knee_bonded.yaml").subject())
    recorded_function = actuator.recorded
    recorded_function(recorded_function.present[:, None])
    made, count = recorded_function.recording.program, len(actuator.paths)
    low, high = actuator.problem.lower, actuator.problem.upper
    points = np.repeat(recorded_function.present[None], 12, axis=0)
    points[1:, :count] = low + (high - low) * np.random.default_rng(8).random((11, count))
    seeds = np.eye(made.inputs)[:, :count]
    (values, slopes) = compared([(made, points, seeds)], tmp_path, visit)
    close(*values, 1e-13, least=1.0)
    close(*slopes, 1e-11, least=1.0)
    found, expected = (np.where(np.isfinite(x), x, 0.0) for x in slopes)
    differ = np.abs(found - expected) > 1e-13 * np.maximum(np.abs(expected), 1.0)
    assert differ.mean() < 2e-3
    assert len(json.dumps(made.for_page())) < 700_000
