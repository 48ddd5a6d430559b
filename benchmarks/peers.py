"""Speed beside well-known peers: CasADi, OpenMDAO and AeroSandbox; run by hand.

    python benchmarks/peers.py [--json FILE] [--rounds N]

A peer that is not installed is listed as such; the servo needs pytest. Times are processor time
on one core, which a busy machine disturbs least, and medians of N rounds. In each round every
program runs once, in turn; ratios are medians of the ratios within a round.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import json
import math
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cylinder import SOLVERS, mass_and_margins

ROOT = Path(__file__).resolve().parent.parent
KNEE = ROOT / "designs" / "knee_bonded.yaml"
PEERS = ("casadi", "openmdao", "aerosandbox")
HOPSAN = (20.0, 90.0)
"""Hopsan, a simulator in C++, for a servo of 5 s, ms: recorded earlier, not run here."""
SAME = 1e-9
"""Largest difference between two engines, relative to the value (or to 1 if it is smaller)."""
SAME_OPTIMUM = 1e-6
"""Largest relative difference between the optima of two solvers."""


Timing = dict[str, float]
"""Median time in milliseconds, and median of the ratios to the reference of the same round."""


def installed(name: str) -> bool:
    """Whether a module can be imported; it is not imported."""
    return importlib.util.find_spec(name) is not None


def in_turns(programs: Mapping[str, Callable[[], float]], rounds: int) -> dict[str, Timing]:
    """Timings of programs that return their time in s; the first is the reference."""
    for run in programs.values():
        run()  # compiles modules and fills caches
    times = [{name: run() for name, run in programs.items()} for _ in range(rounds)]
    reference = next(iter(programs))
    return {
        name: {
            "milliseconds": 1e3 * statistics.median(row[name] for row in times),
            "ratio": statistics.median(row[name] / row[reference] for row in times),
        }
        for name in programs
    }


def cold(*arguments: str, status: int = 0, folder: Path = ROOT) -> Callable[[], float]:
    """A function that runs a fresh process and returns its processor time, s."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT), "OPENMDAO_REPORTS": "0"}

    def run() -> float:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=folder)
        assert done.returncode == status, done.stderr
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime

    return run


def warm(function: Callable[[], object], repeats: int = 1) -> Callable[[], float]:
    """A function that calls another several times and returns the mean processor time, s."""

    def run() -> float:
        begin = time.process_time()
        for _ in range(repeats):
            function()
        return (time.process_time() - begin) / repeats

    return run


def starts(rounds: int) -> dict[str, Timing]:
    """Fresh processes beside `import numpy`; the knee's file misses limits, hence its status."""
    programs = {
        "import numpy": cold("-c", "import numpy"),
        "import actuator_opt": cold("-c", "import actuator_opt"),
        "actuator-opt evaluate designs/knee_bonded.yaml --json": cold(
            "-m", "actuator_opt", "evaluate", str(KNEE), "--json", status=1
        ),
    }
    modules = {"casadi": "casadi", "openmdao": "openmdao.api", "aerosandbox": "aerosandbox"}
    for name, module in modules.items():
        if installed(name):
            programs[f"import {module}"] = cold("-c", f"import {module}")
    return in_turns(programs, rounds)


def in_casadi(program: Any, rows: int, variables: int) -> tuple[Any, Any, list[bool], list[int]]:
    """The instructions of a program as a CasADi function: values and Jacobian by the variables.

    CasADi cannot compute the roots of a polynomial. Their computed values are further inputs.

    Returns
    -------
    the function of variables and of other inputs with roots, the sparsity of its Jacobian, for
    each row whether it depends on roots, and the slots of the roots
    """
    import casadi as ca

    from actuator_opt.base.symbolic.program import OPERATIONS

    names = {"arctan": "ATAN", "arcsin": "ASIN", "arccos": "ACOS", "abs": "FABS"}
    pairs = {"add", "sub", "mul", "div", "pow", "atan2", "copysign", "hypot", "lt", "le", "eq"}
    pairs |= {"and", "or"}
    unary, binary = ca.SX.unary, ca.SX.binary
    inputs = [ca.SX.sym(f"input {k}") for k in range(program.inputs)]
    unused = [ca.SX(0)] * (program.slots - program.inputs)
    slots = [*inputs, *unused, *(ca.SX(float(value)) for value in program.constants)]
    depends = [False] * len(slots)
    roots: dict[int, Any] = {}
    for word, result, *places in program.code.tolist():
        operation = OPERATIONS[word & 255]
        if operation == "roots":
            for place in range(result, result + 2 * places[1]):
                slots[place] = roots[place] = ca.SX.sym(f"root {place}")
                depends[place] = True
            continue
        first, second, third = (slots[place] for place in places)
        if operation == "where":
            otherwise = unary(ca.OP_NOT, first)
            parts = [(first, second), (otherwise, third)]
            slots[result] = binary(
                ca.OP_ADD, *(binary(ca.OP_IF_ELSE_ZERO, *part) for part in parts)
            )
        elif operation == "isnan":  # CasADi would simplify "x is not equal to x"
            slots[result] = unary(ca.OP_NOT, binary(ca.OP_LE, first, ca.SX(math.inf)))
        else:
            code = getattr(ca, f"OP_{names.get(operation, operation.upper())}")
            two = operation in pairs
            slots[result] = binary(code, first, second) if two else unary(code, first)
        # a place without an operand repeats the first
        depends[result] = any(depends[place] for place in places)
    values = ca.vertcat(*(slots[k] for k in program.outputs[:rows]))
    x = ca.vertcat(*inputs[:variables])
    jacobian = ca.jacobian(values, x)
    further = ca.vertcat(*inputs[variables:], *roots.values())
    function = ca.Function("knee", [x, further], [values, jacobian])
    return function, jacobian.sparsity(), [depends[k] for k in program.outputs[:rows]], [*roots]


def gradients(rounds: int) -> dict[str, Any]:
    """Value and all gradients of the knee: our machine beside CasADi, which must agree."""
    import numpy as np

    from actuator_opt.base.symbolic.program import Program
    from actuator_opt.base.symbolic.recorded import RecordedFunction
    from actuator_opt.design import read_design
    from actuator_opt.evaluation import prepare
    from actuator_opt.optimisation.actuator import build

    knee = build(prepare(read_design(KNEE).design))
    recorded, x = knee.recorded, knee.problem.start
    assert recorded is not None
    assert x is not None

    def record() -> Any:
        function = RecordedFunction(recorded.function, recorded.names, recorded.present)
        function(recorded.present[:, None])
        assert function.recording is not None, function.reason
        return function.recording

    recording = record()
    program, rows, n = recording.program, recording.rows, len(x)
    point, seeds = recorded.present[None], np.eye(program.inputs, n)[None]
    values, slopes = (part[0, :rows] for part in program.slopes(point, seeds))
    ours = {"actuator-opt": warm(lambda: program.slopes(point, seeds), 50)}
    result: dict[str, Any] = {
        "variables": n, "rows": rows, "instructions": len(program.code),
        "build": in_turns({"actuator-opt": warm(record)}, rounds),
    }  # fmt: skip
    if not installed("casadi"):
        return result | {"run": in_turns(ours, rounds)}
    built = in_turns({"CasADi": warm(lambda: in_casadi(program, rows, n))}, rounds)
    function, sparsity, depends, places = in_casadi(program, rows, n)
    at_roots = Program(
        program.code, program.extra, np.array(places, dtype=np.int32),
        np.zeros(len(places), dtype=np.int32), program.constants, program.slots, program.inputs,
    )  # fmt: skip
    further = np.concatenate([point[0, n:], at_roots.values(point)[0]])
    first = np.array(point[0, :n])
    buffer, call = function.buffer()  # CasADi's fastest way to call
    by_casadi, nonzeros = np.empty(rows), np.empty(sparsity.nnz())
    for place, array in enumerate((first, further)):
        buffer.set_arg(place, array.data)
    for place, array in enumerate((by_casadi, nonzeros)):
        buffer.set_res(place, array.data)
    call()
    jacobian = np.zeros((rows, n))
    jacobian[np.array(sparsity.row()), np.array(sparsity.get_col())] = nonzeros
    comparable = ~np.array(depends)
    for mine, other in ((values, by_casadi), (slopes, jacobian)):
        difference = np.abs(mine - other) / np.maximum(np.abs(mine), 1.0)
        assert difference[comparable].max() <= SAME, f"they differ by {difference.max():.1e}"
    result["compared_rows"] = int(comparable.sum())
    result["build"]["CasADi"] = built["CasADi"]
    return result | {"run": in_turns(ours | {"CasADi": warm(call, 50)}, rounds)}


def cylinders(rounds: int, folder: Path) -> dict[str, Any]:
    """The lightest cylinder by every solver, in fresh processes and warm; optima must agree."""
    names = [name for name in SOLVERS if name not in PEERS or installed(name)]
    solvers = {name: SOLVERS[name]() for name in names}
    optima = {name: list(solve()) for name, solve in solvers.items()}
    reference = optima[names[0]]
    for name, optimum in optima.items():
        for value, expected in zip(optimum, reference, strict=True):
            same = math.isclose(value, expected, rel_tol=SAME_OPTIMUM)
            assert same, f"{name}: optimum {optimum} mm instead of {reference} mm"
    script = str(ROOT / "benchmarks" / "cylinder.py")
    processes = {name: cold(script, name, folder=folder) for name in names}
    return {
        "optimum_mm": optima,
        "mass_kg": {name: mass_and_margins(*x)[0] for name, x in optima.items()},
        "cold": in_turns({"import numpy": cold("-c", "import numpy")} | processes, rounds),
        "warm": in_turns({name: warm(solve, 3) for name, solve in solvers.items()}, rounds),
    }


def servo(rounds: int) -> dict[str, Any]:
    """The servo with LuGre friction of `test_simulation`, 5 s: equations and integration."""
    import test_simulation as case

    import actuator_opt as ao
    from actuator_opt.simulation.assemble import assemble
    from actuator_opt.simulation.integrate import integrate
    from actuator_opt.studies.plant import plant

    knee = plant(ao.read(case.KNEE).subject())

    def compiled() -> Any:
        return assemble(case.SCENE, knee, {}, case.GAINS).system.compiled()

    equations = compiled()
    run: Mapping[str, Any] = case.RUN
    programs = {
        "equations and LSODA": warm(lambda: integrate(compiled(), **run)),
        "LSODA": warm(lambda: integrate(equations, **run)),
    }
    return {"run": in_turns(programs, rounds), "hopsan_recorded_ms": HOPSAN}


def table(title: str, timings: Mapping[str, Timing]) -> None:
    """Print timings; ratios to the first row."""
    print(f"\n{title}")
    for name, timing in timings.items():
        print(f"  {name:<48}{timing['milliseconds']:>11.4g} ms{timing['ratio']:>9.3g}")


def main() -> None:
    """Measure, print tables and write the numbers."""
    parser = argparse.ArgumentParser(description="Speed of actuator-opt beside other programs.")
    parser.add_argument("--json", metavar="FILE", help="write the numbers to this file")
    parser.add_argument("--rounds", type=int, default=9, help="rounds of every measurement")
    chosen = parser.parse_args()
    sys.path.insert(1, str(ROOT))  # the package of this checkout, as in the fresh processes
    rounds = chosen.rounds
    missing = [name for name in PEERS if not installed(name)]
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores. Processor time,")
    print(f"medians of {rounds} rounds. The last column is the ratio to the first row.")
    print(f"Not installed, left out: {', '.join(missing) or 'none'}")
    numbers: dict[str, Any] = {"rounds": rounds, "missing": missing}
    numbers["start"] = starts(rounds)
    table("1. Start of a process", numbers["start"])
    numbers["gradients"] = knee = gradients(rounds)
    size = f"{knee['rows']} x {knee['variables']}, {knee['instructions']} instructions"
    table(f"2. Value and all gradients of the knee: {size}", knee["run"])
    for name, timing in knee["build"].items():
        print(f"  building, {name:<38}{timing['milliseconds']:>11.4g} ms")
    if "compared_rows" in knee:
        print(f"  {knee['compared_rows']} rows agree to {SAME:g}; the others depend on roots of")
        print("  polynomials, which CasADi takes as given. CasADi starts from our program.")
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        numbers["cylinder"] = part = cylinders(rounds, Path(folder))  # OpenMDAO writes folders
    table("3. Lightest steel cylinder, fresh process: import and solve", part["cold"])
    table("   Once imported: state and solve", part["warm"])
    print(f"  all optima agree to {SAME_OPTIMUM:g}")
    if installed("pytest"):
        numbers["servo"] = servo(rounds)
        table("4. Servo with LuGre friction, 5 s", numbers["servo"]["run"])
        print(f"  Hopsan, recorded earlier, not run here: {HOPSAN[0]:g} to {HOPSAN[1]:g} ms a case")
    if chosen.json:
        text = json.dumps(numbers, indent=2)
        Path(chosen.json).write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
