"""Write the record of EXUDYN's lifted arm, ``actuator_opt/replicas/notes/exudyn_arm.csv``.

The model is that of EXUDYN's hydraulicActuatorSimpleTest.py, which stores one number of its end.
With steps of 1 ms, as there, this script prints that number again; the record has steps of 10 us.

    pip install exudyn==1.13.6
    python benchmarks/exudyn_arm.py > actuator_opt/replicas/notes/exudyn_arm.csv
"""

from __future__ import annotations

import sys
from math import cos, pi, sqrt
from typing import Any

import numpy as np

LENGTH, MASS = 1.0, 120.0
END, SAMPLE, FINE, COARSE = 0.4, 2e-3, 1e-5, 1e-3
CLOSED = 0.3
"""Length at which our piston is at zero [m]: that of designs/stated/exudyn_arm.yaml."""
HEAD = """\
# EXUDYN {version}, the model of hydraulicActuatorSimpleTest.py with steps of {step:g} s,
# written by benchmarks/exudyn_arm.py; x: distance of the pins less 300 mm.
# Steps of 1 ms, as shipped: at the end {distance:.8f} m, {a:.2f} and {b:.2f} Pa;
# number of the test suite {norm:.12f}, stored there 7.130440021870293, here {fine:.12f}
t [s],x [mm],p1 [bar],p2 [bar]"""


def model(exudyn: Any, items: Any) -> tuple[Any, Any, Any]:
    """Arm, cylinder and valve; the system and its sensors of distance and pressures."""
    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddObject(items.ObjectGround(referencePosition=[0, 0, 0]))
    node = system.AddNode(items.Rigid2D(referenceCoordinates=[LENGTH / 2, 0, 0]))
    arm = system.AddObject(
        items.RigidBody2D(mass=MASS, inertia=MASS * LENGTH**2 / 12, nodeNumber=node)
    )

    def marker(body: Any, x: float, y: float = 0.0) -> Any:
        return system.AddMarker(
            items.MarkerBodyPosition(bodyNumber=body, localPosition=[x, y, 0.0])
        )

    pivots = [marker(ground, 0.0), marker(arm, -LENGTH / 2)]
    system.AddObject(items.RevoluteJoint2D(markerNumbers=pivots))
    weight = [0, -MASS * 9.81, 0]
    system.AddLoad(items.Force(markerNumber=marker(arm, 0.0), loadVector=weight))
    start = sqrt(2) * LENGTH / 4
    pressures = system.AddNode(
        items.NodeGenericODE1(
            referenceCoordinates=[0, 0], initialCoordinates=[2e6, 2e6], numberOfODE1Coordinates=2
        )
    )
    cylinder = system.AddObject(
        items.HydraulicActuatorSimple(
            markerNumbers=[marker(ground, 0.0, -LENGTH / 4), marker(arm, -LENGTH / 4)],
            nodeNumbers=[pressures], offsetLength=start, strokeLength=start / 2,
            chamberCrossSection0=0.01, chamberCrossSection1=0.01, hoseVolume0=1.0, hoseVolume1=1.0,
            oilBulkModulus=1e11, actuatorDamping=2e5, nominalFlow=2e-5, systemPressure=2e7,
            tankPressure=0.0, useChamberVolumeChange=False,
        )
    )  # fmt: skip

    def valve(system: Any, time: float) -> bool:
        length = system.GetObjectOutput(cylinder, exudyn.OutputVariableType.Distance)
        wanted = (max(0.5, min(1.5, 1 - cos(pi * time))) - 0.5) * 0.1 + start
        for name, way in (("valveOpening0", 2), ("valveOpening1", -2)):
            system.SetObjectParameter(cylinder, name, way * (wanted - length))
        return True

    system.SetPreStepUserFunction(valve)
    kinds = exudyn.OutputVariableType
    distance = items.SensorObject(
        objectNumber=cylinder, storeInternal=True, outputVariableType=kinds.Distance
    )
    pressure = items.SensorNode(
        nodeNumber=pressures, storeInternal=True, outputVariableType=kinds.Coordinates
    )
    sensors = system.AddSensor(distance), system.AddSensor(pressure)
    system.Assemble()
    return system, *sensors


def run(step: float) -> tuple[Any, Any, float]:
    """Distance and pressures over time, and the number that the test suite stores."""
    import exudyn
    import exudyn.utilities as items

    system, distance, pressures = model(exudyn, items)
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(END / step)
    settings.timeIntegration.endTime = END
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
    return system.GetSensorStoredData(distance), system.GetSensorStoredData(pressures), float(norm)


def main() -> None:
    """Print the record."""
    import exudyn

    distance, pressures, norm = run(COARSE)
    _, a, b = pressures[-1]
    last = distance[-1][1]
    distance, pressures, fine = run(FINE)
    words = {"version": exudyn.__version__, "step": FINE, "norm": norm, "fine": fine}
    print(HEAD.format(**words, distance=last, a=a, b=b))
    each = round(SAMPLE / FINE)
    for (t, x), (_, a, b) in zip(distance[::each], pressures[::each], strict=True):
        print(f"{t:.3f},{1e3 * (x - CLOSED):.6f},{1e-5 * a:.6f},{1e-5 * b:.6f}")


if __name__ == "__main__":
    sys.exit(main())
