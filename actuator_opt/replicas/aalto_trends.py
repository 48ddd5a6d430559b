"""Table 1 of [AaltoThesis], what raises the friction of O-rings, beside our two friction models.

Every verdict follows from the design's numbers, every explanation from factor and verdict.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..evaluation import Evaluation
from ..rendering import text
from ..rendering.blocks import ExtraTable
from . import trends
from .paper_text import listed
from .trends import FACTORS, Model, Trends, Verdict

TITLE = "Aalto thesis: what raises O-ring friction, its table 1"
COLUMNS = ("to increase friction, as printed", "ours by coefficient", "ours on the oil film")

PRINTED = {1: "increase", -1: "decrease"}
"""What the column "to increase friction" prints."""

Reasons = Mapping[tuple[str, Verdict], str]

COEFFICIENT: Reasons = {
    ("squeeze", "agrees"): "the preload grows with the squeeze",
    ("metal surface finish (RMS)", "no effect"): "a coefficient knows no roughness",
    ("seal material hardness", "agrees"): "the modulus grows with hardness",
    ("seal material hardness", "no effect"): "this contact law has no preload",
    ("relative motion speed", "agrees"): "{ratio} Stribeck speeds, where the curve falls",
    ("relative motion speed", "no effect"): "{ratio} Stribeck speeds, where its fall is over or "
    "none is stated",
    ("relative motion speed", "disagrees"): "the stated viscous friction outweighs the fall",
    ("cross section of seal", "agrees"): "load per length of circumference grows with the section",
    ("hydraulic pressure", "disagrees"): "the pressure presses the ring on",
    ("hydraulic pressure", "no effect"): "no ring holds pressure in this case",
    ("temperature", "agrees"): "rubber softens with heat",
    ("temperature", "disagrees"): "this rubber stiffens with heat",
    ("temperature", "no effect"): "the modulus does not enter, or not its temperature",
    ("groove width", "no effect"): "the load does not know the groove's walls",
    ("diameter of rod or bore", "agrees"): "friction follows the circumference, less what the "
    "grown barrel takes",
    ("O-ring surface finish", "no effect"): "a coefficient knows no roughness",
}
"""Why the friction by coefficients goes the way it does."""

STICKS = "that smooth rubber sticks is not in the model"
SPREADS = "rough faces stand further apart, so that speed raises friction less"
BEARS = "a rough face bears more of the load on its asperities"

FILM: Reasons = {
    ("squeeze", "agrees"): "the load grows with the squeeze, and by more than the oil bears under "
    "the wider contact",
    ("squeeze", "no effect"): "load and width of the contact grow with the squeeze, and the oil "
    "under the wider contact bears all that the load gains",
    ("squeeze", "disagrees"): "the contact widens faster than its load grows: the oil bears more",
    ("metal surface finish (RMS)", "agrees"): f"{BEARS}; weak, as the ring is {{roughness}} times "
    "as rough",
    ("metal surface finish (RMS)", "disagrees"): f"{SPREADS}; weak, as the ring is {{roughness}} "
    "times as rough",
    ("metal surface finish (RMS)", "no effect"): "the ring is {roughness} times as rough, and a "
    "polished metal that sticks to rubber is not in the model",
    ("seal material hardness", "agrees"): "a stiffer ring is pressed on harder",
    ("relative motion speed", "agrees"): "mixed lubrication: speed lifts the ring off",
    ("relative motion speed", "disagrees"): "running towards the pressure the faces part, the oil "
    "loses pressure and asperities take its load; the other way speed lifts the ring off",
    ("relative motion speed", "no effect"): "too slow to change the oil's pressure",
    ("cross section of seal", "agrees"): "load per length of circumference grows with the section",
    ("hydraulic pressure", "disagrees"): "the pressure presses the ring on, the oil carries "
    "a share of it",
    ("hydraulic pressure", "agrees"): "the oil under pressure carries more than the pressure "
    "presses on",
    ("hydraulic pressure", "no effect"): "no ring holds pressure, or the oil carries all of it",
    ("temperature", "agrees"): "softer rubber is pressed on less, {oil}",
    ("temperature", "disagrees"): "thin oil lifts less, which counts for more than softer rubber",
    ("temperature", "no effect"): "softer rubber and less lift of thin oil cancel",
    ("groove width", "no effect"): "it acts only where the contact is as wide as the groove: here "
    "{contact} of it; an overfull groove is a missed check, not friction",
    ("diameter of rod or bore", "agrees"): "friction follows the circumference, less what the "
    "grown barrel takes",
    ("O-ring surface finish", "agrees"): f"{SPREADS}; {STICKS}",
    ("O-ring surface finish", "disagrees"): f"{BEARS}; {STICKS}",
    ("O-ring surface finish", "no effect"): "what a rough face bears and what speed adds cancel; "
    f"{STICKS}",
}
"""Why the friction on the oil film goes the way it does."""

OTHERWISE: Mapping[Verdict, str] = {
    "agrees": "as printed",
    "disagrees": "we do not know why",
    "no effect": "it does not enter",
}
"""Where the numbers go another way than any explained above."""


def trends_table(evaluation: Evaluation) -> ExtraTable:
    """Table 1 beside the design's friction by coefficient and on the film."""
    found = trends.trends(evaluation.design)
    printed = [f"{PRINTED[one.direction]} {one.name}" for one in FACTORS]
    if found is None:
        note = "No load case moves: friction that runs needs a speed above zero."
        return ExtraTable(TITLE, COLUMNS, [(one, text.DASH, text.DASH) for one in printed], note)
    facts = {
        "ratio": text.trimmed(found.stribeck_ratio, 2),
        "roughness": text.trimmed(found.roughness_ratio, 2),
        "contact": f"{100 * found.contact_share:.0f} %",
        "oil": "and thin oil acts like less speed: less friction as well"
        if found.film.elasticities[_index("relative motion speed")] > 0
        else "which counts for more than the lift that thin oil loses",
    }
    rows = [
        (
            words,
            _cell(found.coefficient, COEFFICIENT, index).format(**facts),
            _cell(found.film, FILM, index).format(**facts),
        )
        for index, words in enumerate(printed)
    ]
    return ExtraTable(TITLE, COLUMNS, rows, _note(found))


def _cell(model: Model, known: Reasons, index: int) -> str:
    """Elasticity, verdict and reason."""
    said = model.verdict(index)
    if said == "no answer":
        return text.DASH
    value = model.elasticities[index]
    shown = "" if said == "no effect" else f"{text.number(value, 2, signed=True)} "
    return f"{shown}{said}: {known.get((FACTORS[index].name, said), OTHERWISE[said])}"


def _note(found: Trends) -> str:
    one, two = found.coefficient, found.film
    point = (
        f"Numbers: relative change of friction over that of the factor (no effect below "
        f"{text.trimmed(trends.NEGLIGIBLE)}), both rings together, in the case "
        f"{found.case}: {text.trimmed(one.running, 3)} N by coefficient, "
    )
    point += (
        f"no film ({two.why}). "
        if two.why
        else f"{text.trimmed(two.running, 3)} N on the film ({text.trimmed(two.breakaway, 3)} N "
        "with all oil squeezed out). "
    )
    return (
        point
        + "Temperature is absolute: 1 % is 3 K. All pressures move together, squeeze stays a share "
        "of the section. " + _rings(found) + _pressure(found) + _rest(found)
    )


def _rings(found: Trends) -> str:
    if not found.replaced:
        return ""
    return (
        f"The table is of O-rings: the design's {listed(found.replaced)} got one of "
        f"{trends.ELASTOMER} with section and squeeze as they are. "
    )


def _pressure(found: Trends) -> str:
    """The one row that the thesis prints against its own source."""
    odd = [one.name for one in FACTORS if one.direction != one.handbook]
    said = found.coefficient.verdict(_index("hydraulic pressure"))
    ours = {
        "agrees": "ours falls too here",
        "disagrees": "ours rises, as an energised ring must",
    }.get(said, "ours has no pressure to answer to here")
    return (
        f"One row is turned: less {listed(odd)} cannot press a ring on harder. In the "
        "scanned text all ten rows print opposite words left and right: no column is swapped. But "
        "the O-ring handbook's own table (ORingFriction, A6-1), which prints nine rows alike, "
        f"prints Increase there; {ours}. A fall with pressure was measured on other seals: Huang "
        "2017, table 2, a step ring with a lip seal. "
    )


def _rest(found: Trends) -> str:
    """What is ambiguous in print, and the order of significance."""
    model = found.coefficient if found.film.why else found.film
    order = found.order(model)
    significance = (
        f"The thesis lists the factors in order of significance, metal finish second; 1 % more "
        f"weighs most for {listed(order[:3])} here. "
        if order
        else ""
    )
    either = model.verdict(_index("O-ring surface finish"))
    turned = "and the verdict turns" if either in ("agrees", "disagrees") else "to the same effect"
    return (
        significance + "Surface finish of the O-ring is read as roughness like the metal's; read "
        f"as quality, a decrease means rougher rubber, {turned}."
    )


def _index(name: str) -> int:
    return next(i for i, one in enumerate(FACTORS) if one.name == name)
