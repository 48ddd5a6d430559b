"""[AaltoThesis] Table 1 applied to a design's O-rings: sign of ten factors' effect on friction.

Table 1 lists what raises the friction of an O-ring, from an O-ring handbook. Here every factor of a
design is changed slightly, and the friction of its two rings is evaluated again: with coefficients
of friction, and on the oil film. The verdict follows from the elasticity: the relative change of
friction, divided by that of the factor. The film responds to first order by its exact slopes, as in
every evaluation. At a kink of a contact law, as at a squeeze of 15 %, the slope on one side counts.
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import InputError, Unsolvable
from ..design.model import Design
from ..design.seals import Seal
from ..evaluation import Evaluation
from ..evaluation.build import prepare
from ..evaluation.film import floats
from ..evaluation.kernel import PreparedDesign, base, compute
from ..evaluation.rings import Place, Ring, seal_contact
from ..evaluation.values import Values, of_case
from ..friction import coefficient, film
from ..rendering import text
from ..rendering.blocks import Table, text_table
from ..seals import o_ring
from ..seals.kinds import SIZES
from .papers import Reasons, listed, reasons

Verdict = Literal["agrees", "disagrees", "no effect", "no answer"]

PLACES: tuple[Place, ...] = ("piston", "rod")

STEP = 1e-3
"""Relative step of a factor, up and down (absolute temperature: 0.3 K)."""

NEGLIGIBLE = 1e-3
"""Elasticity below which a factor has no effect: doubling it moves friction by 0.1 % (a choice,
below the uncertainty from the nodes of the film)."""

ELASTOMER = "nbr_70"
"""Compound of O-rings that replace other seals of the design; the thesis names no compound."""


@dataclass(frozen=True, slots=True)
class Factor:
    """A row of Table 1.

    Parameters
    ----------
    name : as printed
    direction : +1 where the column "to increase friction" prints Increase, -1 where Decrease
    handbook : the direction in the handbook's table ([ORingFriction], table A6-1)
    paths : PATHs of a design that are changed together, with placeholders {place}, {compound} and
        {case}
    """

    name: str
    direction: int
    handbook: int
    paths: tuple[str, ...]


FACTORS = (
    Factor("squeeze", 1, 1, ("seals.{place}.squeeze",)),
    Factor("metal surface finish (RMS)", 1, 1, ("seals.{place}.counterface_roughness",)),
    Factor("seal material hardness", 1, 1, ("materials.{compound}.hardness",)),
    Factor(
        "relative motion speed",
        -1,
        -1,
        ("load_cases[{case}].speed", "load_cases[{case}].joint_speed"),
    ),
    Factor("cross section of seal", 1, 1, ("seals.{place}.section",)),
    Factor(
        "hydraulic pressure",
        -1,
        1,
        (
            "supply.pressure",
            "supply.return_pressure",
            "load_cases[{case}].pressure",
            "load_cases[{case}].pressure_a",
            "load_cases[{case}].pressure_b",
        ),
    ),
    Factor("temperature", -1, -1, ("fluid.temperature", "load_cases[{case}].temperature")),
    Factor("groove width", -1, -1, ("seals.{place}.groove_width",)),
    Factor("diameter of rod or bore", 1, 1, ("cylinder.bore", "rod.outer_diameter")),
    Factor("O-ring surface finish", -1, -1, ("materials.{compound}.seal_roughness",)),
)
"""Table 1 in its order, which the thesis calls the order of significance.

Both surface finishes are read as RMS roughness, as the metal's is printed.
"""

Elasticities: TypeAlias = tuple[float, ...]
"""Elasticity d ln(friction)/d ln(factor) of every factor, in the order of `FACTORS`."""


@dataclass(frozen=True, slots=True)
class FrictionTrend:
    """Results of one friction model for the design.

    Parameters
    ----------
    running, breakaway : friction of both rings [N]; NaN without an answer
    elasticities : d ln running/d ln factor
    why : reason for a missing answer
    """

    running: float
    breakaway: float
    elasticities: Elasticities
    why: str = ""

    def verdict(self, index: int) -> Verdict:
        """Whether a factor changes friction in the direction that Table 1 prints."""
        return verdict(self.elasticities[index], FACTORS[index].direction)


@dataclass(frozen=True, slots=True)
class Trends:
    """Table 1 applied to a design.

    Parameters
    ----------
    case : the moving load case with the highest friction
    replaced : places (piston, rod) at which an O-ring replaces a seal of another kind
    rings : the evaluated rings, with numbers of that case
    coefficient, film : the two models
    """

    case: str
    replaced: tuple[Place, ...]
    rings: tuple[Ring, ...]
    coefficient: FrictionTrend
    film: FrictionTrend

    @property
    def stribeck_ratio(self) -> float:
        """Ratio of speed to Stribeck speed, the lower value of both rings."""
        return min(float(ring["speed"] / ring["stribeck_speed"]) for ring in self.rings)

    @property
    def contact_share(self) -> float:
        """Ratio of contact width to groove width, larger value of both rings; 1: groove is full."""
        return max(float(seal_contact(ring).width / ring["groove_width"]) for ring in self.rings)

    @property
    def roughness_ratio(self) -> float:
        """Ratio of ring roughness to metal roughness, the smaller value of both rings."""
        return min(
            float(ring["seal_roughness"] / ring["counterface_roughness"]) for ring in self.rings
        )

    def order(self, model: FrictionTrend) -> tuple[str, ...]:
        """The factors with an effect in a model, the strongest first."""
        sizes = {
            factor.name: abs(value)
            for factor, value in zip(FACTORS, model.elasticities, strict=True)
            if abs(value) >= NEGLIGIBLE
        }
        return tuple(sorted(sizes, key=lambda name: -sizes[name]))


def verdict(elasticity: float, direction: int) -> Verdict:
    """Whether an elasticity has the published sign."""
    if math.isnan(elasticity):
        return "no answer"
    if abs(elasticity) < NEGLIGIBLE:
        return "no effect"
    return "agrees" if elasticity * direction > 0 else "disagrees"


def trends(design: Design) -> Trends | None:
    """Table 1 applied to a design; None if no load case has a speed.

    All other values are those of the design. The barrel grows with bore and pressure, and the gland
    is redesigned for every section and squeeze.
    """
    numbers = prepare(design).numbers
    replaced = tuple(place for place in PLACES if not _elastomer_o_ring(design, place, numbers))
    dry, wet = (_fitted(design, replaced, model) for model in (coefficient.LAW.name, film.LAW.name))
    subject = prepare(dry)
    v = subject.values()
    moving = [i for i, case in enumerate(design.load_cases) if case.moves]
    if not moving:
        return None
    (running,) = compute(subject, v).computed.metrics["friction_running"].values()
    index = max(moving, key=lambda i: np.nan_to_num(of_case(running, i)))
    case = design.load_cases[index]
    dry, wet = (fitted.model_copy(update={"load_cases": (case,)}) for fitted in (dry, wet))
    oiled = prepare(wet)
    return Trends(
        case=case.name,
        replaced=replaced,
        rings=tuple(floats(ring, 0) for ring in base(oiled, oiled.values()).rings),
        coefficient=_model(prepare(dry)),
        film=_model(oiled),
    )


def _elastomer_o_ring(design: Design, place: Place, numbers: Container[str]) -> bool:
    """Whether the seal of piston or rod is an O-ring whose modulus follows from its hardness."""
    seal: Seal = getattr(design.seals, place)
    stated = f"materials.{seal.compound}.youngs_modulus" in numbers
    return seal.type == o_ring.TYPE.name and not seal.contact and not stated


_OF_ANOTHER = (
    "friction_coefficient",
    "breakaway_ratio",
    "stribeck_speed",
    *(size.key for size in SIZES),
    "back_up_material",
    "back_up_thickness",
)
"""Fields of other seal types that do not apply to the O-ring that replaces them."""


def _fitted(design: Design, replaced: Sequence[Place], model: str) -> Design:
    """The design with a single O-ring at piston and at rod, without other sealing elements."""
    alone: dict[str, Any] = {"secondary": None, "wiper": None, "guide": None, "count": 1.0}
    other: dict[str, Any] = dict.fromkeys(_OF_ANOTHER)
    other |= {"type": o_ring.TYPE.name, "compound": ELASTOMER, "contact": (), "back_up": "none"}
    other |= {"viscous_friction": 0.0}
    seals: dict[str, Any] = {}
    for place in PLACES:
        update = {"friction": model} | alone | (other if place in replaced else {})
        seals[place] = getattr(design.seals, place).model_copy(update=update)
    return design.model_copy(
        update={"seals": design.seals.model_copy(update=seals), "variables": {}}
    )


def _model(subject: PreparedDesign) -> FrictionTrend:
    """Friction of a design with a single load case, and the effect of every factor on it."""
    nothing = (math.nan,) * len(FACTORS)
    try:
        metrics = compute(subject, subject.values(_moved(subject))).computed.metrics
    except (InputError, Unsolvable) as error:
        return FrictionTrend(math.nan, math.nan, nothing, error.diagnostics[0].message)
    columns = 2 * len(FACTORS) + 1
    (running,), (breakaway,) = (
        metrics[name].values() for name in ("friction_running", "friction_breakaway")
    )
    row = np.broadcast_to(np.asarray(running, dtype=float), (1, columns))[0]
    if not (row > 0).all():
        return FrictionTrend(
            math.nan, math.nan, nothing, "no friction: the rings have lost contact"
        )
    up, down = row[1::2], row[2::2]
    slopes = np.log(up / down) / math.log((1 + STEP) / (1 - STEP))
    return FrictionTrend(
        float(row[0]), of_case(breakaway, 0), tuple(float(slope) for slope in slopes)
    )


def _moved(subject: PreparedDesign) -> dict[str, np.ndarray]:
    """Values by PATH: a column for the design, and two for each factor (a step up, a step down)."""
    v = subject.values()
    widths = {f"seals.{r.name}.groove_width": r["groove_width"] for r in base(subject, v).rings}
    varied: dict[str, np.ndarray] = {}
    for i, factor in enumerate(FACTORS):
        for path in _paths(subject, factor, v):
            here = float(np.squeeze(widths[path] if path in widths else v[path]))
            column = np.full(2 * len(FACTORS) + 1, here)
            column[2 * i + 1 : 2 * i + 3] *= 1 + STEP, 1 - STEP
            varied[path] = column
    return varied


def _paths(subject: PreparedDesign, factor: Factor, v: Values) -> Sequence[str]:
    """PATHs of a factor in a design, without a groove width that is left to its default."""
    paths = [
        path.format(
            place=place,
            compound=getattr(subject.design.seals, place).compound,
            case=subject.cases[0],
        )
        for path in factor.paths
        for place in PLACES
    ]
    return [path for path in dict.fromkeys(paths) if path in v or path.endswith("groove_width")]


TITLE = "Aalto thesis: what raises O-ring friction (table 1)"

COLUMNS = (
    "to increase friction, as printed",
    "our friction by coefficient",
    "ours on the oil film",
)

PRINTED = {1: "increase", -1: "decrease"}
"""Words of the column "to increase friction"."""

COEFFICIENT, FILM = reasons("aalto", "coefficient"), reasons("aalto", "film")
"""Reasons for the signs: friction by coefficients, and friction on the oil film."""

OTHERWISE: Mapping[Verdict, str] = {
    "agrees": "as printed",
    "disagrees": "reason unknown",
    "no effect": "not in the model",
}
"""Words for a verdict for which the notes state no reason."""


def trends_table(evaluation: Evaluation) -> Table:
    """Table 1 beside the trends of the design's friction, by coefficient and on the oil film."""
    table_1 = trends(evaluation.design)
    printed = [f"{PRINTED[factor.direction]} {factor.name}" for factor in FACTORS]
    if table_1 is None:
        note = "No load case has a speed above zero, which running friction requires."
        return text_table(
            TITLE, COLUMNS, [(factor, text.DASH, text.DASH) for factor in printed], note
        )
    facts = {
        "ratio": text.trimmed(table_1.stribeck_ratio, 2),
        "roughness": text.trimmed(table_1.roughness_ratio, 2),
        "contact": f"{100 * table_1.contact_share:.0f} %",
        "oil": "and thin oil acts like less speed, which also reduces friction"
        if table_1.film.elasticities[_index("relative motion speed")] > 0
        else "which outweighs the lift lost by thin oil",
    }
    rows = [
        (
            words,
            _cell(table_1.coefficient, COEFFICIENT, index).format(**facts),
            _cell(table_1.film, FILM, index).format(**facts),
        )
        for index, words in enumerate(printed)
    ]
    return text_table(TITLE, COLUMNS, rows, _note(table_1))


def _cell(model: FrictionTrend, known: Reasons, index: int) -> str:
    """Elasticity, verdict and reason."""
    said = model.verdict(index)
    if said == "no answer":
        return text.DASH
    value = model.elasticities[index]
    shown = "" if said == "no effect" else f"{text.number(value, 2, signed=True)} "
    return f"{shown}{said}: {known.get(FACTORS[index].name, {}).get(said, OTHERWISE[said])}"


def _note(table_1: Trends) -> str:
    dry, two = table_1.coefficient, table_1.film
    point = (
        "Numbers: relative change of friction divided by that of the factor (no effect "
        f"below {text.trimmed(NEGLIGIBLE)}), for both rings together. Friction in load case "
        f'"{table_1.case}": {text.trimmed(dry.running, 3)} N by coefficient, '
    )
    point += (
        f"no film ({two.why}). "
        if two.why
        else f"{text.trimmed(two.running, 3)} N on the film ({text.trimmed(two.breakaway, 3)} N "
        "with all oil squeezed out). "
    )
    return (
        point + "Temperature is absolute: 1 % is 3 K. All pressures change together; squeeze "
        "remains the same share of the section. "
        + _rings(table_1)
        + _pressure(table_1)
        + _rest(table_1)
    )


def _rings(table_1: Trends) -> str:
    if not table_1.replaced:
        return ""
    return (
        f"The table applies to O-rings, so an O-ring of {ELASTOMER} with the same section "
        f"and squeeze replaces each of these seals of the design: {listed(table_1.replaced)}. "
    )


def _pressure(table_1: Trends) -> str:
    """Note on the row in which the thesis contradicts its source."""
    odd = [factor.name for factor in FACTORS if factor.direction != factor.handbook]
    said = table_1.coefficient.verdict(_index("hydraulic pressure"))
    ours = {
        "agrees": "our friction falls here too",
        "disagrees": "our friction rises, as it must for a ring whose contact the pressure loads",
    }.get(said, "our friction does not depend on pressure here")
    return (
        f"One row of the thesis is reversed: less {listed(odd)} cannot press a ring "
        "harder. In all ten rows of the scanned text the words in both columns are "
        "opposite, so no column is swapped. The table of the O-ring handbook "
        "(ORingFriction, A6-1) agrees in the nine other rows and prints Increase in this "
        f"row; {ours}. Friction that falls with pressure was measured on other seals "
        "(Huang 2017, table 2: a step ring with a lip seal). "
    )


def _rest(table_1: Trends) -> str:
    """Note on ambiguous words in the thesis, and on the order of significance."""
    model = table_1.coefficient if table_1.film.why else table_1.film
    order = table_1.order(model)
    significance = (
        "The thesis lists the factors in order of significance, metal finish second; "
        f"here, 1 % more has the largest effect for {listed(order[:3])}. "
        if order
        else ""
    )
    either = model.verdict(_index("O-ring surface finish"))
    turned = (
        "and the verdict is reversed"
        if either in ("agrees", "disagrees")
        else "with the same verdict"
    )
    return (
        significance + "Surface finish of the O-ring is read as roughness, like that of "
        "the metal; if read as quality, a decrease means rougher rubber, "
        f"{turned}."
    )


def _index(name: str) -> int:
    return next(i for i, factor in enumerate(FACTORS) if factor.name == name)
