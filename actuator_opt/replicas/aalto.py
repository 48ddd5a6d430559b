"""The cylinder of [AaltoThesis] as its stiffness models see it: eq. 6, 37 and 38 along the stroke.

Every curve is the evaluation of the design itself with the oil, lines and load cell of the figure,
so the re-creation uses no formula of its own. SI throughout.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..base.numeric import Array
from ..design.circuit import Line
from ..design.model import Design
from ..evaluation import oil
from ..evaluation.allow import MaterialValues
from ..evaluation.build import prepare
from ..evaluation.kernel import ModelRun, compute
from ..evaluation.springs import Springs
from ..models import fluid

Topology = Literal["per_chamber", "aalto_as_published"]


@dataclass(frozen=True, slots=True)
class Paper:
    """What the thesis prints and the design does not hold, SI; the comment is its place."""

    bore: float = 0.040  # chapter 3
    rod: float = 0.025
    stroke: float = 0.220
    throttle: float = 0.22e-4  # section 3.3.5
    temperatures: tuple[float, float] = (298.15, 303.15)  # of the tests, 25 to 30 degC
    bulk_modulus: float = 1600e6  # section 3.3.1
    bulk_modulus_with_air: float = 1300e6  # section 3.3.3
    load_cell: float = 106e6  # section 3.2
    pressure_a: float = 20.5e5  # chapter 3
    pressure_b: float = 42e5
    load_up: tuple[float, float] = (3.4e3, 3.5e3)  # section 4.1, piston direction up and down
    load_down: tuple[float, float] = (4.6e3, 5.1e3)
    moved_up: tuple[float, float] = (0.11e-3, 0.21e-3)  # figure 42, both piston directions
    moved_down: tuple[float, float] = (0.31e-3, 0.48e-3)
    most_up: tuple[float, float] = (0.20e-3, 0.21e-3)  # the same, each direction's largest
    most_down: tuple[float, float] = (0.48e-3, 0.47e-3)
    place: float = 0.185  # figure 41
    loaded_up: tuple[float, float] = (12e5, 62e5)
    loaded_down: tuple[float, float] = (40.5e5, 18e5)  # + 20 bar; "17 to 19 bar"
    bubble_a: float = 0.4e-6  # figure 67
    bubble_b: float = 0.08e-6
    wave_speed: float = 1300.0  # section 2.1.3
    peak: float = 20.0  # section 4.2.2
    speed: float = 20e-3  # section 3.3.3, largest amplitude until the check valve opens
    reynolds: float = 100.8  # section 3.3.3
    flow_coefficient: float = 0.611
    cracking_pressure: float = 0.4e5  # section 3.3.5


PAPER = Paper()
MARGIN = 0.005
"""How near the ends of the stroke the thesis' test runs came (m)."""


def places(design: Design) -> Array:
    """Positions of the tables: both ends of the test runs and mid-stroke."""
    stroke = design.cylinder.stroke
    return np.array([MARGIN, stroke / 2, stroke - MARGIN])


def pipes(design: Design) -> tuple[Line, ...]:
    """The lines that stay on the cylinder while its ports are closed."""
    return tuple(line for line in design.lines if line.type == "pipe")


def variant(
    design: Design,
    *,
    lines: Sequence[Line],
    bulk_modulus: float,
    topology: Topology = "per_chamber",
    load_cell: bool = True,
) -> Springs:
    """Springs of the design with one bulk modulus, no air, chosen lines and topology."""
    chain = {"topology": topology, "seals": "sliding"}
    if not load_cell:
        chain["load_cell"] = None  # type: ignore[assignment]
    oil = design.fluid.material
    changed = design.model_copy(
        update={
            "fluid": design.fluid.model_copy(
                update={"air_content": 0.0, "bulk_modulus_law": "constant"}
            ),
            "lines": tuple(lines),
            "stiffness": design.stiffness.model_copy(update=chain),
            "materials": design.materials
            | {oil: design.materials.get(oil, {}) | {"bulk_modulus": bulk_modulus}},
        }
    )
    return evaluated(changed).springs


def evaluated(design: Design) -> ModelRun:
    """One pass over the models."""
    subject = prepare(design)
    return compute(subject, subject.values())


def temperature_of(design: Design, viscosity: float) -> float:
    """Temperature [K] between -20 and 120 degC at which the oil has a kinematic viscosity.

    NaN where it has it at none.
    """
    subject = prepare(design)
    v = subject.values()
    stock = MaterialValues(v, subject.materials, subject.factors, subject.constants)
    warm = np.linspace(253.15, 393.15, 1401)
    found = np.log(np.ravel(oil.kinematic_viscosity(v, design.fluid, stock, warm)))
    return float(np.interp(-np.log(viscosity), -found, warm, left=np.nan, right=np.nan))


def first(values: Array) -> Array:
    """The first load case of an array (cases, points)."""
    return np.atleast_2d(np.asarray(values))[0]


def unstretched(springs: Springs) -> Springs:
    """The same without the barrel's axial stretch, which the thesis does not have."""
    rest = {name: give for name, give in springs.chambers.items() if name != "stretch"}
    return replace(springs, chambers=rest)


@dataclass(frozen=True, slots=True)
class Theory:
    """One stiffness curve of the thesis [N/m] along `position` [m]: its own form and ours.

    `per_chamber` has the causes of the thesis, `stretched` the barrel's axial stretch too; the
    columns `at` hold the same at `places`.
    """

    position: Array
    published: Array
    per_chamber: Array
    published_at: Array
    per_chamber_at: Array
    stretched_at: Array

    @property
    def weakest(self) -> tuple[float, float]:
        """Position and stiffness of the softest place, by the thesis' form."""
        k = int(np.argmin(self.published))
        return float(self.position[k]), float(self.published[k])


def _along(design: Design) -> Array:
    stroke = design.cylinder.stroke
    return np.linspace(0.002 * stroke, 0.998 * stroke, 4981)


def oil_alone(design: Design, lines: Sequence[Line]) -> Theory:
    """Figure 5: eq. 6 with rigid walls, with the volume of some lines; both forms agree."""
    springs = variant(design, lines=lines, bulk_modulus=PAPER.bulk_modulus)
    position = _along(design)
    curve, at = (first(springs.hydraulic(x, springs.oil)) for x in (position, places(design)))
    return Theory(position, curve, curve, at, at, at)


def total(
    design: Design, lines: Sequence[Line], bulk_modulus: float, *, load_cell: bool = True
) -> Theory:
    """Figures 29 and 32: eq. 37 (pipes) or 38 (hoses too), as printed and per chamber."""
    printed = variant(
        design,
        lines=lines,
        bulk_modulus=bulk_modulus,
        topology="aalto_as_published",
        load_cell=load_cell,
    )
    ours = variant(design, lines=lines, bulk_modulus=bulk_modulus, load_cell=load_cell)
    plain, position, chosen = unstretched(ours), _along(design), places(design)
    with np.errstate(divide="ignore"):  # each oil gives way in one chamber only
        return Theory(
            position=position,
            published=first(printed.stiffness(position)),
            per_chamber=first(plain.stiffness(position)),
            published_at=first(printed.stiffness(chosen)),
            per_chamber_at=first(plain.stiffness(chosen)),
            stretched_at=first(ours.stiffness(chosen)),
        )


def air_behind(pressure: float) -> float:
    """Air content at which eq. 5 turns 1600 MPa into 1300 MPa at a pressure."""
    content = np.linspace(0.0, 0.05, 5001)
    modulus = fluid.effective_bulk_modulus(
        bulk_modulus=PAPER.bulk_modulus, pressure=pressure, air_content=content
    )
    return float(np.interp(-PAPER.bulk_modulus_with_air, -modulus, content))
