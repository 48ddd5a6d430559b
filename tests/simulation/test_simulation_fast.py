"""CVODES through CasADi: the equations and the results of every method, one line if missing."""

from __future__ import annotations

import math
import signal
import sys
from dataclasses import replace

import numpy as np
import pytest
import simulation_case as case
from hypothesis import given, strategies as st

from actuator_opt.base.errors import InputError, Unsolvable
from actuator_opt.base.symbolic import Graph, Namespace, jacobian
from actuator_opt.models.loop import ControllerGains
from actuator_opt.simulation.integrate import integrate, interruptible, translate
from actuator_opt.simulation.run import COMPARED
from actuator_opt.simulation.system import System

pytestmark = pytest.mark.filterwarnings("ignore:builtin type:DeprecationWarning")
GAINS = ControllerGains(300.0, math.inf, 0.0)
RUBBED = {"model": "lugre", "coulomb": 80.0, "static": 120.0, "stribeck_speed": 5e-3}


@pytest.fixture
def casadi():
    """The library, or the test is left out."""
    return pytest.importorskip("casadi")


def law(xp, x, y):
    """Every operation that a model may use, of two numbers."""
    return [
        x + y, x - y, 3.0 * x * y, x / (2.0 + y * y), -x, xp.exp(x), xp.expm1(x), xp.tanh(x * y),
        xp.sin(x), xp.cos(y), xp.log(1.0 + x * x), xp.log1p(y * y), xp.atan2(x, y + 4.0),
        xp.sqrt(x * x + y * y), (1.0 + x * x) ** 0.3, (2.0 + y * y) ** -1.7,
        xp.where(x < y, x * x, xp.exp(y)), xp.where((x <= y) & ~(y < 0.0), x, y),
        xp.where((x < 0.0) | (y < 0.0), -x, y * y),
    ]  # fmt: skip


def evaluated(casadi, outputs, values):
    """Values of expressions by CasADi."""
    free, found = translate(outputs)
    names = list(free)
    run = casadi.Function("run", [free[name] for name in names], [casadi.vertcat(*found)])
    return run(*(values[name] for name in names)).full()[:, 0]


reals = st.floats(-3.0, 3.0)


@given(x=reals, y=reals)
def test_every_operation_has_its_value(x, y):
    """An expression in CasADi's symbols has the value that NumPy gives its formula."""
    casadi = pytest.importorskip("casadi")
    graph = Graph()
    outputs = law(Namespace, graph.variable("x"), graph.variable("y"))
    found = evaluated(casadi, outputs, {"x": x, "y": y})
    assert found == pytest.approx([float(v) for v in law(np, np.float64(x), np.float64(y))])


@given(x=reals, y=reals)
def test_slopes_are_those_of_the_graph(x, y):
    """CasADi's derivative of the translation is the translation of the graph's derivative."""
    casadi = pytest.importorskip("casadi")
    graph = Graph()
    a, b = graph.variable("x"), graph.variable("y")
    outputs = law(Namespace, a, b)
    own = [slope for row in jacobian(outputs, [a, b]) for slope in row]
    free, found = translate(outputs)
    theirs = casadi.jacobian(casadi.vertcat(*found), casadi.vertcat(free["x"], free["y"]))
    run = casadi.Function("run", [free["x"], free["y"]], [theirs])
    expected = evaluated(casadi, own, {"x": x, "y": y}).reshape(-1, 2)
    assert run(x, y).full() == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_a_root_has_no_slope_at_zero(casadi):
    """No endless number stops the integration where a flow turns."""
    graph = Graph()
    free, roots = translate([Namespace.sqrt(graph.variable("x")), graph.variable("x") ** 0.6])
    slopes = casadi.Function(
        "run", [free["x"]], [casadi.jacobian(casadi.vertcat(*roots), free["x"])]
    )
    assert slopes(0.0).full().tolist() == [[0.0], [0.0]]
    assert slopes(4.0).full()[:, 0] == pytest.approx([0.25, 0.6 * 4.0**-0.4])


def cvodes(system, *, duration=1.0, sample_time=1e-3):
    """Times, states and all of a run."""
    found = integrate(
        system.compiled(), duration=duration, sample_time=sample_time, method="cvodes"
    )
    return found.time, found.states, found


def test_a_swing_that_time_drives(casadi):
    """Of x'' = -w^2 x + 3 w^2 sin(2 w t) from rest: 2 sin(w t) - sin(2 w t), 5.2 m wide."""
    system, w = System(), 2 * math.pi * 7.0
    x = system.state("x", 0.0, tolerance=1e-10)
    v = system.state("v", 0.0, tolerance=1e-8)
    system.rate(x, v)
    system.rate(v, -(w**2) * x + 3 * w**2 * Namespace.sin(2 * w * system.time))
    t, (found, _), trajectory = cvodes(system)
    assert found == pytest.approx(2 * np.sin(w * t) - np.sin(2 * w * t), abs=5.2e-5)
    assert trajectory.evaluations > 100


def test_jumps_and_switches(casadi):
    """A ramp of slope 1 from 0.2505 s on, of slope 3 above 0.25: closed form, event located."""
    system = System()
    x = system.state("x", 0.0, tolerance=1e-10)
    on, steep = system.after(0.2505), system.switch("steep", x - 0.25)
    system.rate(x, Namespace.where(on, Namespace.where(steep, 3.0, 1.0), 0.0))
    t, (found,), trajectory = cvodes(system)
    (event,) = trajectory.events
    assert (event.name, event.on) == ("steep", True)
    assert event.time == pytest.approx(0.5005, abs=1e-9)
    slow = np.clip(t - 0.2505, 0.0, 0.25)
    assert found == pytest.approx(slow + 3 * np.clip(t - 0.5005, 0.0, None), abs=1e-8)


def test_a_long_run_is_cut_into_pieces(casadi):
    """5001 samples of a decay."""
    system = System()
    x = system.state("x", 1.0, tolerance=1e-10)
    system.rate(x, -x)
    t, (found,), _ = cvodes(system, duration=5.0)
    assert len(t) == 5001
    assert np.all(np.diff(t) > 0)
    assert found == pytest.approx(np.exp(-t), abs=1e-6)


def servo(method, **stated):
    """The cylinder with LuGre friction in a position loop; LSODA at a thousandth of its error."""
    control = {"position": [{"shape": "step", "start": 0.05, "value": 0.02}]}
    scene = case.scenario(
        duration=0.4, initial=case.MIDDLE, friction=RUBBED, load={"force": case.BALANCED},
        **({"control": control} | stated),
    )  # fmt: skip
    sharp = {"relative": 1e-9, "sharp": 10.0} if method == "lsoda" else {}
    own = case.plant(oil=replace(case.OIL, air_content=0.01))
    return case.run(scene, own, GAINS, method=method, **sharp)


def test_a_servo_with_friction_is_as_lsoda_has_it(casadi):
    """Position, speed, pressures and flows within 1e-5 of their range; the same samples."""
    own, other = servo("cvodes"), servo("lsoda")
    assert np.array_equal(own.time, other.time)
    for name in set(COMPARED) & set(own.signals):
        apart = np.abs(own.signals[name] - other.signals[name]).max()
        assert apart < 1e-5 * np.ptp(other.signals[name]), name


def test_stops_turn_at_the_same_time(casadi):
    """A piston that runs into its end and stays: the same events, to a microsecond."""
    hard = {"control": {"position": [{"shape": "step", "start": 0.05, "value": 0.1}]}}
    own, other = servo("cvodes", **hard).found.events, servo("lsoda", **hard).found.events
    assert [one.name for one in own] == [one.name for one in other]
    assert len(own) >= 1
    assert [one.time for one in own] == pytest.approx([one.time for one in other], abs=1e-6)


def test_where_it_ends_is_said_as_ever(casadi, capfd):
    """The rate x^2 from 1 has no value at 1 s; nothing else is printed."""
    system = System()
    x = system.state("x", 1.0, tolerance=1e-10)
    system.rate(x, x * x)
    with pytest.raises(Unsolvable, match=r"^at (0\.9999\d*|1) s: .*; a gain, a volume or"):
        cvodes(system, duration=2.0)
    assert capfd.readouterr() == ("", "")


def test_a_record_is_refused_in_a_line(casadi):
    """What is looked up has no formula."""
    force = [{"shape": "record", "file": "f.csv", "column": "F", "scale": 1.0}]
    scene = case.scenario(initial=case.MIDDLE, load={"force": force}, signal=[])
    record = {("f.csv", "F"): (np.linspace(0, 1, 50), np.zeros(50))}
    with pytest.raises(InputError, match="cannot read values from a record; integrate by lsoda"):
        case.run(scene, case.plant(), method="cvodes", records=record)


def test_without_casadi_one_line_says_so(monkeypatch):
    """What to install."""
    monkeypatch.setitem(sys.modules, "casadi", None)
    system = System()
    system.rate(system.state("x", 1.0, tolerance=1e-9), 1.0)
    with pytest.raises(InputError, match=r'needs CasADi; pip install "actuator-opt\[fast\]"'):
        cvodes(system)


def test_ctrl_c_in_the_library_stays_one():
    """CasADi tells of Ctrl-C as a failure; it is an interruption, any other failure is not."""
    before = signal.getsignal(signal.SIGINT)

    def fail(*, pressed):
        with interruptible():
            try:
                if pressed:
                    signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt:
                pass
            raise RuntimeError("CV_RHSFUNC_FAIL")

    with pytest.raises(KeyboardInterrupt):
        fail(pressed=True)
    with pytest.raises(RuntimeError, match="CV_RHSFUNC_FAIL"):
        fail(pressed=False)
    assert signal.getsignal(signal.SIGINT) is before
