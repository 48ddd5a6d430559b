"""Write EXUDYN's records in ``actuator_opt/replicas/notes``: exudyn_arm.csv and exudyn_press.csv.

The arm is the model of EXUDYN's hydraulicActuatorSimpleTest.py, which stores one number of its end.
With steps of 1 ms, as there, this script prints that number again; the record has steps of 10 us.
The press is our circuit, for EXUDYN ships none with unequal areas and volumes that change.

    pip install exudyn==1.13.6
    python benchmarks/exudyn_records.py arm > actuator_opt/replicas/notes/exudyn_arm.csv
    python benchmarks/exudyn_records.py press > actuator_opt/replicas/notes/exudyn_press.csv
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import cos, pi, sqrt
from typing import Any, NamedTuple

import exudyn
import exudyn.utilities as items
import numpy as np

LENGTH, MASS = 1.0, 120.0
FINE, COARSE = 1e-5, 1e-3
ARM_HEAD = """\
# EXUDYN {version}, the model of hydraulicActuatorSimpleTest.py with steps of {step:g} s,
# written by benchmarks/exudyn_records.py; x: distance of the pins less 300 mm.
# Steps of 1 ms, as shipped: at the end {distance:.8f} m, {a:.2f} and {b:.2f} Pa;
# number of the test suite {norm:.12f}, stored there 7.130440021870293, here {fine:.12f}
"""
PRESS_HEAD = """\
# EXUDYN {version}, the press of designs/stated/exudyn_press.yaml with steps of {step:g} s,
# written by benchmarks/exudyn_records.py.
"""
KINDS = exudyn.OutputVariableType


class Circuit(NamedTuple):
    """A system with its cylinder, the sensors of distance and pressures, and its times."""

    system: Any
    cylinder: Any
    pressures: Any
    end: float
    sample: float


class Run(NamedTuple):
    """Distance and pressures over time, and the number that EXUDYN's test suite stores."""

    distance: Any
    pressures: Any
    norm: float


def ramp(time: float, start: float, end: float) -> float:
    """From 0 at `start` to 1 at `end`."""
    return min(max((time - start) / (end - start), 0.0), 1.0)


def _cylinder(system: Any, markers: list[Any], start: tuple[float, float], **numbers: Any) -> Any:
    """A cylinder between two markers, with its pressures at the start."""
    pressures = system.AddNode(
        items.NodeGenericODE1(
            referenceCoordinates=[0, 0], initialCoordinates=[*start], numberOfODE1Coordinates=2
        )
    )
    cylinder = system.AddObject(
        items.HydraulicActuatorSimple(
            markerNumbers=markers, nodeNumbers=[pressures], systemPressure=2e7, **numbers
        )
    )
    return cylinder, pressures


def _open(system: Any, cylinder: Any, opening: float) -> None:
    for name, way in (("valveOpening0", 1), ("valveOpening1", -1)):
        system.SetObjectParameter(cylinder, name, way * opening)


def arm() -> Circuit:
    """EXUDYN's lifted arm."""
    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddObject(items.ObjectGround(referencePosition=[0, 0, 0]))
    node = system.AddNode(items.Rigid2D(referenceCoordinates=[LENGTH / 2, 0, 0]))
    inertia = MASS * LENGTH**2 / 12
    body = system.AddObject(items.RigidBody2D(mass=MASS, inertia=inertia, nodeNumber=node))

    def marker(body: Any, x: float, y: float = 0.0) -> Any:
        return system.AddMarker(
            items.MarkerBodyPosition(bodyNumber=body, localPosition=[x, y, 0.0])
        )

    pivots = [marker(ground, 0.0), marker(body, -LENGTH / 2)]
    system.AddObject(items.RevoluteJoint2D(markerNumbers=pivots))
    weight = [0, -MASS * 9.81, 0]
    system.AddLoad(items.Force(markerNumber=marker(body, 0.0), loadVector=weight))
    start = sqrt(2) * LENGTH / 4
    cylinder, pressures = _cylinder(
        system, [marker(ground, 0.0, -LENGTH / 4), marker(body, -LENGTH / 4)], (2e6, 2e6),
        offsetLength=start, strokeLength=start / 2, chamberCrossSection0=0.01,
        chamberCrossSection1=0.01, hoseVolume0=1.0, hoseVolume1=1.0, oilBulkModulus=1e11,
        actuatorDamping=2e5, nominalFlow=2e-5, tankPressure=0.0, useChamberVolumeChange=False,
    )  # fmt: skip

    def step(system: Any, time: float) -> bool:
        length = system.GetObjectOutput(cylinder, KINDS.Distance)
        wanted = (max(0.5, min(1.5, 1 - cos(pi * time))) - 0.5) * 0.1 + start
        _open(system, cylinder, 2 * (wanted - length))
        return True

    system.SetPreStepUserFunction(step)
    return Circuit(system, cylinder, pressures, 0.4, 2e-3)


def press() -> Circuit:
    """A press ram: 50 mm down, 60 kN, and back; unequal areas, volumes that change."""
    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddObject(items.ObjectGround(referencePosition=[0, 0, 0]))
    node = system.AddNode(items.NodePoint(referenceCoordinates=[0.6, 0, 0]))
    system.AddObject(items.MassPoint(mass=500.0, nodeNumber=node))
    ram = system.AddMarker(items.MarkerNodePosition(nodeNumber=node))
    base = system.AddMarker(
        items.MarkerBodyPosition(bodyNumber=ground, localPosition=[0.0, 0.0, 0.0])
    )
    load = system.AddLoad(items.Force(markerNumber=ram, loadVector=[0, 0, 0]))
    cylinder, pressures = _cylinder(
        system, [base, ram], (50e5, 100e5), offsetLength=0.5, strokeLength=0.3,
        chamberCrossSection0=50e-4, chamberCrossSection1=25e-4, hoseVolume0=0.5e-3,
        hoseVolume1=0.5e-3, oilBulkModulus=1.4e9, actuatorDamping=2e4,
        nominalFlow=60 / 60000 / sqrt(35e5), tankPressure=5e5, useChamberVolumeChange=True,
    )  # fmt: skip

    def step(system: Any, time: float) -> bool:
        length = system.GetObjectOutput(cylinder, KINDS.Distance)
        wanted = 0.6 + 0.05 * (ramp(time, 0.1, 0.5) - ramp(time, 1.0, 1.3))
        _open(system, cylinder, max(-1.0, min(1.0, 20 * (wanted - length))))
        force = 6e4 * (ramp(time, 0.6, 0.65) - ramp(time, 0.8, 0.85))
        system.SetLoadParameter(load, "loadVector", [-force, 0, 0])
        return True

    system.SetPreStepUserFunction(step)
    return Circuit(system, cylinder, pressures, 1.5, 5e-3)


def run(circuit: Circuit, step: float) -> Run:
    """Integrate a circuit with a step."""
    system = circuit.system
    distance = system.AddSensor(
        items.SensorObject(
            objectNumber=circuit.cylinder, storeInternal=True, outputVariableType=KINDS.Distance
        )
    )
    pressures = system.AddSensor(
        items.SensorNode(
            nodeNumber=circuit.pressures, storeInternal=True, outputVariableType=KINDS.Coordinates
        )
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(circuit.end / step)
    settings.timeIntegration.endTime = circuit.end
    settings.timeIntegration.newton.relativeTolerance = 1e-6
    settings.timeIntegration.newton.absoluteTolerance = 1e-10
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.newton.numericalDifferentiation.minimumCoordinateSize = 1
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.5
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = step
    system.SolveDynamic(settings, showHints=False)
    norm = np.linalg.norm(system.systemData.GetODE2Coordinates())
    norm += 1e-6 * np.linalg.norm(system.systemData.GetODE1Coordinates())
    return Run(
        system.GetSensorStoredData(distance), system.GetSensorStoredData(pressures), float(norm)
    )


def table(made: Callable[[], Circuit], zero: float, head: Callable[[Run], str]) -> None:
    """Print a record; our piston is at zero where the distance of the pins is `zero`."""
    circuit = made()
    fine = run(circuit, FINE)
    print(head(fine), end="")
    print("t [s],x [mm],p1 [bar],p2 [bar]")
    each = round(circuit.sample / FINE)
    for (t, x), (_, a, b) in zip(fine.distance[::each], fine.pressures[::each], strict=True):
        print(f"{t:.3f},{1e3 * (x - zero):.6f},{1e-5 * a:.6f},{1e-5 * b:.6f}")


def arm_head(fine: Run) -> str:
    """Comment of the arm's record, with the end of a run with EXUDYN's own steps."""
    shipped = run(arm(), COARSE)
    _, a, b = shipped.pressures[-1]
    return ARM_HEAD.format(
        version=exudyn.__version__, step=FINE, distance=shipped.distance[-1][1], a=a, b=b,
        norm=shipped.norm, fine=fine.norm,
    )  # fmt: skip


if __name__ == "__main__":
    if sys.argv[1:] == ["arm"]:
        table(arm, 0.3, arm_head)
    elif sys.argv[1:] == ["press"]:
        table(press, 0.5, lambda fine: PRESS_HEAD.format(version=exudyn.__version__, step=FINE))
    else:
        sys.exit("state arm or press")
