"""Published friction force and friction coefficient beside ours."""

from __future__ import annotations

from ..design.seals import Seal
from ..evaluation import Evaluation
from ..models import elastomer, forces, friction, seals
from ..rendering import text
from ..rendering.blocks import ExtraTable
from .elasswad_paper import PAPER
from .elasswad_text import COLUMNS, in_mm, in_mm2, in_mpa, in_n, percent, properties


def chord(ring: Seal) -> float:
    """Contact width of a ring by eq. 19, before the bore grows."""
    height = ring.section * (1 - ring.squeeze)
    return float(seals.width_as_published(section=ring.section, gland_height=height))


def _by_case(evaluation: Evaluation, metric: str) -> str:
    """The friction of every load case, the largest first."""
    cases = sorted(evaluation.metrics[metric].by_case.items(), key=lambda one: -one[1])
    return "; ".join(f"{in_n(force)} ({name})" for name, force in cases) or text.DASH


def force_table(evaluation: Evaluation) -> ExtraTable:
    """Friction force and pressure loss."""
    rows = []
    for name, force, loss, metric in (
        ("average", PAPER.friction_average, PAPER.loss_average, "friction_running"),
        ("largest", PAPER.friction_largest, PAPER.loss_largest, "friction_breakaway"),
    ):
        own = float(forces.pressure_loss(friction=force, area=PAPER.area))
        rows += [
            (f"{name} friction", in_n(force), text.DASH, _by_case(evaluation, metric)),
            (f"{name} pressure loss", in_mpa(loss), f"{in_mpa(own)} (F/A)", text.DASH),
            (f"{name}: area F/Δp", text.DASH, in_mm2(force / loss), f"{in_mm2(PAPER.area)} (bore)"),
        ]
    first = PAPER.friction_average / PAPER.loss_average
    second = PAPER.friction_largest / PAPER.loss_largest
    note = (
        f"Force and pressure loss together mean a piston of {in_mm2(first)} or {in_mm2(second)}, "
        f"{text.number(first / PAPER.area, 2)} and {text.number(second / PAPER.area, 2)} times the "
        f"{in_mm2(PAPER.area)} of the bore: forces and pressure losses cannot both be of this "
        f"cylinder. Our forces are no check of the paper's: they hold at the "
        f"{in_mpa(evaluation.design.supply.pressure)} assumed in the design, running and at "
        "breakaway; the rod's ring sees it on the way in only."
    )
    return ExtraTable("El Asswad 2018: friction force", COLUMNS, rows, note)


def coefficient_table(evaluation: Evaluation) -> ExtraTable:
    """Friction coefficient and contact width."""
    ring = evaluation.design.seals.piston
    hardness = properties(evaluation, ring.compound).get("hardness", float("nan"))
    modulus = elastomer.MODULUS_LAWS[ring.hardness_model].modulus(hardness=hardness)
    ours = seals.LAWS["energised"]
    size = {"section": ring.section, "youngs_modulus": modulus}
    printed_width = chord(ring)
    width = float(ours.contact_width(squeeze=ring.squeeze, pressure=0.0, **size))
    pressure = PAPER.pressure(force=PAPER.friction_average, contact_width=printed_width)

    def coefficient(pressure: float) -> float:
        load = ours.line_load(squeeze=ring.squeeze, pressure=pressure, **size)
        force = friction.seal_friction(
            line_load=load, diameter=PAPER.bore + PAPER.rod_diameter, friction_coefficient=1.0
        )
        return PAPER.friction_average / float(force)

    def wider(squeeze: float) -> float:
        at = {"squeeze": squeeze, "pressure": 0.0} | size
        printed = seals.LAWS["chord"].contact_width(**at)
        return float(printed / ours.contact_width(**at)) - 1

    average = in_n(PAPER.friction_average)
    rows = (
        (
            "friction coefficient µ",
            text.trimmed(PAPER.friction_coefficient),
            f"{average} at {in_mpa(pressure)} (eq. 15–20)",
            f"{text.number(coefficient(2e6), 3)} at 2 MPa; "
            f"{text.number(coefficient(7e6), 3)} at 7 MPa",
        ),
        (
            f"contact width at {percent(ring.squeeze)} squeeze",
            text.DASH,
            f"{in_mm(printed_width)} (eq. 19)",
            in_mm(width),
        ),
        (
            "eq. 19 over ours",
            text.DASH,
            f"+{percent(wider(0.10))} at 10 %; +{percent(wider(0.20))} at 20 %",
            text.DASH,
        ),
    )
    note = (
        f"µ cannot be identified alone: with preload and energised rings {average} fits "
        f"{text.number(coefficient(2e6), 3)} at 2 MPa as well as {text.number(coefficient(7e6), 3)}"
        " at 7 MPa, and eq. 16 has no friction at all without pressure. "
        "Eq. 19 is the chord of the unsqueezed circle, wider than the plane-strain finite "
        "elements that ours follows within 3 %. "
        "Ring section, squeeze and both rings under the full pressure are assumed."
    )
    return ExtraTable("El Asswad 2018: friction coefficient", COLUMNS, rows, note)
