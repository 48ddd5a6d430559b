"""Tables of the values printed in [ElAsswad2018] beside ours, with the paper's contradictions.

One table per subject. Its columns are the printed value, the result of the paper's formula with the
paper's numbers, and the result of this project's models for the design.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from ..base import units
from ..base.numeric import Array
from ..design.materials import load_library
from ..evaluation import Evaluation
from ..models import (
    barrel,
    damping,
    elastomer,
    fluid,
    forces,
    friction,
    rod,
    seals,
    stiffness_published as published,
)
from ..rendering import text
from ..rendering.blocks import Block, Drawing, text_table
from . import papers
from .elasswad_figures import record_figure
from .elasswad_models import (
    FORCE,
    PAPER,
    POISSONS_RATIO,
    ROLLER_RADIUS,
    SPANS,
    STIFF_END,
    Tube,
    along,
    chord,
    own_record,
    properties,
    root,
    tube_of,
    value,
    wall_thickness,
)


def _over_spans(written: Callable[[float], str]) -> str:
    return "; ".join(f"{written(span)} over {in_mm(span)}" for span in SPANS)


def _per_kn(compliance: float) -> str:
    return f"{in_um(1e3 * compliance)}/kN"


def _hidden(tube: Tube, span: float) -> str:
    rest, share = tube.hidden(span)
    return f"{_per_kn(rest)} ({percent(share)})"


def bending_table(evaluation: Evaluation) -> list[Block]:
    """Bending modulus corrected for shear, dents and section, and the bore growth of eq. 12."""
    tube = tube_of(evaluation)
    supply, growth = evaluation.design.supply.pressure, value(evaluation, "bore_growth")
    thickness = wall_thickness(evaluation)
    wall = PAPER.wall(thickness)
    printed = float(barrel.bore_growth_as_published(pressure=supply, **wall))
    hoop = PAPER.hoop_modulus(growth=growth, pressure=supply, thickness=thickness)
    even = tube.second_moment()
    measured = in_gpa(PAPER.bending_modulus)
    rows = (
        (
            "bending modulus",
            measured,
            _over_spans(lambda x: in_n_per_mm(PAPER.bending_slope(span=x, second_moment=even)))
            + " (k₀ of eq. 13)",
            f"{in_gpa(tube.warp_modulus)} (woven carbon, warp)",
        ),
        *(
            (name, text.DASH, text.DASH, _over_spans(written))
            for name, written in (
                ("shear subtracted", lambda x: in_gpa(tube.modulus(x, shear=True))),
                ("dents at the rollers subtracted", lambda x: in_gpa(tube.modulus(x, local=True))),
                (
                    f"stiff caps of {in_mm(STIFF_END)} included",
                    lambda x: in_gpa(tube.modulus_between_caps(x)),
                ),
            )
        ),
        (
            "I of a solid bar, if used in eq. 13, corrected",
            text.DASH,
            text.DASH,
            in_gpa(tube.modulus(SPANS[0], solid=True)),
        ),
        (
            "solid bar corrected, shear and dents subtracted",
            text.DASH,
            text.DASH,
            _over_spans(lambda x: in_gpa(tube.modulus(x, solid=True, shear=True, local=True))),
        ),
        (
            "extra compliance if the tube is woven carbon",
            text.DASH,
            text.DASH,
            _over_spans(lambda x: _hidden(tube, x)),
        ),
        (
            f"bore growth at {in_mpa(supply)}",
            text.DASH,
            f"{in_um(printed)} (eq. 12 with {measured})",
            f"{in_um(growth)} (hoop modulus {in_gpa(hoop)})",
        ),
    )
    return [
        text_table(
            "El Asswad 2018: bending modulus", COLUMNS, rows, _bending_note(tube, printed / growth)
        )
    ]


def _bending_note(tube: Tube, times: float) -> str:
    """Note on bending; `times` is the ratio of bore growth by eq. 12 to that of the design."""
    wound = load_library().get("t700_epoxy").numbers
    wide = wound["youngs_modulus_1"] / wound["youngs_modulus_2"]
    least = min(tube.modulus_between_caps(span) for span in SPANS)
    most = max(tube.modulus(span, solid=True, shear=True, local=True) for span in SPANS)
    upper = f"to {in_gpa(most)}" if math.isfinite(most) else "without an upper limit"
    return (
        "The paper states neither span, section, k₀ nor rollers, and neglects the change "
        "of section at the ends. Assumed: the spans (its two strokes), a tube "
        f"{in_mm(tube.outer_diameter)}/{in_mm(tube.inner_diameter)} of woven carbon with G "
        f"= {in_gpa(tube.shear_modulus)}, rollers of {in_mm(ROLLER_RADIUS)} radius at "
        f"{in_n(FORCE)} (Hertz; a thin tube flattens as well). The modulus may then be "
        f"anything from {in_gpa(least)} {upper}, and a soft wall cannot be distinguished "
        "from a soft test rig. The test gives the modulus along the axis, but eq. 12 "
        "needs the modulus around the bore. The two are equal only where warp and weft "
        "are equal: in a hoop-wound wall they differ by a factor of "
        f"{text.trimmed(wide, 2)}. Eq. 12 with {in_gpa(PAPER.bending_modulus)} gives "
        f"{text.trimmed(times, 3)} times the bore growth of the design's wall."
    )


COLUMNS = ("quantity", "published", "paper's formulas", "ours")


def _text(value: float, unit: str, dimension: str) -> str:
    return text.with_unit(
        text.trimmed(float(units.unit(unit, dimension).from_si(value))), text.unit_text(unit)
    )


in_mm = partial(_text, unit="mm", dimension="length")

in_um = partial(_text, unit="um", dimension="length")

in_mm2 = partial(_text, unit="mm^2", dimension="area")

in_ml = partial(_text, unit="ml", dimension="volume")

in_n = partial(_text, unit="N", dimension="force")

in_n_per_mm = partial(_text, unit="N/mm", dimension="stiffness")

in_mpa = partial(_text, unit="MPa", dimension="pressure")

in_gpa = partial(_text, unit="GPa", dimension="pressure")

in_ns_per_m = partial(_text, unit="N*s/m", dimension="damping")

in_mpas = partial(_text, unit="mPa*s", dimension="dynamic_viscosity")

percent = partial(papers.percent, digits=3)


def _by_case(evaluation: Evaluation, metric: str) -> str:
    """The friction of every load case, the largest first."""
    cases = sorted(evaluation.metrics[metric].by_case.items(), key=lambda case: -case[1])
    return "; ".join(f"{in_n(force)} ({name})" for name, force in cases) or text.DASH


def force_table(evaluation: Evaluation) -> list[Block]:
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
        f"Force divided by pressure loss gives a piston area of {in_mm2(first)} or "
        f"{in_mm2(second)}, {text.number(first / PAPER.area, 2)} and "
        f"{text.number(second / PAPER.area, 2)} times the {in_mm2(PAPER.area)} of the "
        "bore, so forces and pressure losses cannot both belong to this cylinder. Our "
        "friction forces cannot be compared with the paper's. They apply, both for sliding and "
        f"for breakaway, at the {in_mpa(evaluation.design.supply.pressure)} that the design "
        "assumes, and this pressure loads the rod seal on the instroke only."
    )
    return [text_table("El Asswad 2018: friction force", COLUMNS, rows, note)]


def coefficient_table(evaluation: Evaluation) -> list[Block]:
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
            "eq. 19 relative to ours, by squeeze",
            text.DASH,
            f"+{percent(wider(0.10))} at 10 %; +{percent(wider(0.20))} at 20 %",
            text.DASH,
        ),
    )
    note = (
        "µ alone cannot be identified: for rings with preload that pressure energises, "
        f"{average} agrees with µ = {text.number(coefficient(2e6), 3)} at 2 MPa as well as "
        f"with {text.number(coefficient(7e6), 3)} at 7 MPa, and eq. 16 gives no friction "
        "at all without pressure. Eq. 19 is the chord of the unsqueezed circle. It is "
        "wider than the contact by plane-strain finite elements, which our formula "
        "follows within 3 %. Ring section, squeeze and both rings under the full pressure "
        "are assumed."
    )
    return [text_table("El Asswad 2018: friction coefficient", COLUMNS, rows, note)]


def _sizes(evaluation: Evaluation) -> list[Block]:
    cylinder, piston = evaluation.design.cylinder, evaluation.design.piston
    middle = PAPER.stroke / 2
    spring = PAPER.total(float("inf")) * middle
    gap = (PAPER.bore - PAPER.piston_diameter) / 2
    rows = (
        (
            "piston diameter",
            in_mm(PAPER.piston_diameter),
            text.DASH,
            in_mm(cylinder.bore - 2 * piston.clearance),
        ),
        (
            "stroke",
            f"{in_mm(PAPER.stroke)}; {in_mm(PAPER.damping_stroke)}",
            text.DASH,
            in_mm(cylinder.stroke),
        ),
        (
            "force at mid-stroke",
            text.DASH,
            f"{in_n(spring)} (eq. 1, k_eq x)",
            f"{in_n(value(evaluation, 'push_force'))} (net push)",
        ),
    )
    note = (
        f"Table 1 lists a {in_mm(PAPER.piston_diameter)} piston in a {in_mm(PAPER.bore)} "
        f"cylinder, which leaves a radial gap of {in_mm(gap)} that no ring of this size "
        f"can close. The stroke is {in_mm(PAPER.stroke)} in table 1 and "
        f"{in_mm(PAPER.damping_stroke)} in the text on damping. Eq. 1 treats the cylinder "
        "as a spring to ground with the force k_eq x, although this force is that of an "
        "external load."
    )
    return [text_table("El Asswad 2018: dimensions", COLUMNS, rows, note)]


def _oil(evaluation: Evaluation) -> list[Block]:
    design = evaluation.design
    oil = load_library().get("iso_vg_32").numbers
    state = {"pressure": design.supply.pressure}
    pure = fluid.bulk_modulus_linear(
        bulk_modulus=oil["bulk_modulus"], slope=oil["bulk_modulus_slope"], **state
    )

    def aerated(air: float) -> float:
        return float(fluid.effective_bulk_modulus(bulk_modulus=pure, air_content=air, **state))

    usual = 0.005
    air = root(lambda content: aerated(content) - PAPER.bulk_modulus, 0.0, 0.2)
    volume = PAPER.line_volume(bore=PAPER.bore)
    narrow = PAPER.line_volume(bore=PAPER.piston_diameter)
    dead = (design.cylinder.dead_volume_a, design.cylinder.dead_volume_b)
    bare = PAPER.oil(line_volume=0.0, bore=PAPER.bore)
    rows = (
        (
            "bulk modulus",
            in_mpa(PAPER.bulk_modulus),
            text.DASH,
            f"{in_mpa(aerated(usual))} (VG 32, {percent(usual)} air)",
        ),
        ("entrained air for that value", text.DASH, text.DASH, percent(air)),
        (
            "oil stiffness k_oil",
            in_n_per_mm(PAPER.oil_stiffness),
            f"{in_n_per_mm(bare)} (eq. 9, no lines)",
            f"{in_n_per_mm(value(evaluation, 'stiffness_oil'))} (weakest position)",
        ),
        (
            "line volume per side",
            text.DASH,
            f"{in_ml(volume)}; {in_ml(narrow)} if the bore is {in_mm(PAPER.piston_diameter)}",
            f"{in_ml(dead[0])}; {in_ml(dead[1])}",
        ),
    )
    note = (
        f"Eq. 9 at mid-stroke gives {text.trimmed(bare / PAPER.oil_stiffness, 2)} times "
        f"the published k_oil unless each side has {in_ml(volume)} of line volume, which "
        "the paper does not mention. The published bulk modulus is that of a mineral oil with "
        f"{percent(air)} of entrained air at {in_mpa(design.supply.pressure)}, the supply "
        "pressure of this design."
    )
    return [text_table("El Asswad 2018: oil stiffness", COLUMNS, rows, note)]


def _rod(evaluation: Evaluation) -> list[Block]:
    design = evaluation.design
    per_length = PAPER.rod_modulus_per_length
    short, long = per_length * PAPER.stroke, per_length * PAPER.damping_stroke
    bent = rod.axial_stiffness_as_published(
        youngs_modulus=PAPER.bending_modulus,
        outer_diameter=PAPER.rod_diameter,
        length=PAPER.stroke,
    )
    fabric = load_library().get("woven_cfrp").numbers["youngs_modulus_1"]
    known = {} if design.rod.layup else properties(evaluation, design.rod.material)
    ours = known.get("youngs_modulus", float("nan"))
    stiff = value(evaluation, "stiffness_rod")
    length = ours * rod.section_area(
        outer_diameter=design.rod.outer_diameter, inner_diameter=design.rod.inner_diameter
    )
    rows = (
        (
            "rod stiffness k_rod",
            in_n_per_mm(PAPER.rod_stiffness),
            f"{in_n_per_mm(float(bent))} (eq. 8 with {in_gpa(PAPER.bending_modulus)})",
            f"{in_n_per_mm(stiff)} (rod of {in_mm(float(length) / stiff)})",
        ),
        (
            "E/L for this stiffness",
            text.DASH,
            f"{text.number(per_length * 1e-9, 5)} N/mm³",
            text.DASH,
        ),
        (
            "Young's modulus of the rod",
            text.DASH,
            f"{in_gpa(short)} over {in_mm(PAPER.stroke)}; "
            f"{in_gpa(long)} over {in_mm(PAPER.damping_stroke)}",
            f"{in_gpa(ours)}; woven carbon {in_gpa(fabric)}",
        ),
    )
    note = (
        f"k_rod implies {in_gpa(short)} or {in_gpa(long)}, depending on which stroke the paper "
        f"used; neither is the measured {in_gpa(PAPER.bending_modulus)} nor what woven carbon "
        "has along its warp."
    )
    return [text_table("El Asswad 2018: rod stiffness", COLUMNS, rows, note)]


def _eq_10(pressure: float, *, growth_per_pressure: float) -> float:
    """The printed k_cyl at a pressure, with the bore enlarged by eq. 12."""
    wide = forces.piston_area(bore=PAPER.bore + 2 * growth_per_pressure * pressure)
    return float(
        published.cylinder_expansion_as_published(pressure=pressure, area=wide, stroke=PAPER.stroke)
    )


def _stretch(evaluation: Evaluation) -> str:
    """Axial stretch of the barrel as a stiffness at the weakest position."""
    curve = evaluation.curve
    place = min(range(len(curve.stiffness)), key=lambda k: float(curve.stiffness[k]))
    share = curve.contributions.get("stretch")
    if share is None or not float(share[place]) > 0:
        return text.DASH
    return in_n_per_mm(1 / float(share[place]))


def _barrel(evaluation: Evaluation) -> list[Block]:
    supply, ours = evaluation.design.supply.pressure, value(evaluation, "bore_growth")
    thickness = wall_thickness(evaluation)
    wall = PAPER.wall(thickness)
    printed = float(barrel.bore_growth_as_published(pressure=supply, **wall))
    correct = float(barrel.bore_growth(pressure=supply, **wall))
    hoop = PAPER.hoop_modulus(growth=ours, pressure=supply, thickness=thickness)
    give = barrel.chamber_compliance(
        inner_radius=PAPER.bore / 2, growth_per_pressure=correct / supply, length=PAPER.stroke
    )
    spring = float(barrel.barrel_stiffness(area=PAPER.area, compliance=give))
    eq_10 = partial(_eq_10, growth_per_pressure=printed / supply)
    rows = (
        (
            "modulus of the barrel",
            f"{in_gpa(PAPER.bending_modulus)} (bending)",
            text.DASH,
            f"{in_gpa(hoop)} (hoop, from our bore growth)",
        ),
        (
            f"bore growth at {in_mpa(supply)}",
            text.DASH,
            f"{in_um(printed)} (eq. 12); {in_um(correct)} with the inner radius",
            in_um(ours),
        ),
        (
            "barrel stiffness k_cyl",
            text.DASH,
            f"{in_n_per_mm(eq_10(1e6))} at 1 MPa; "
            f"{in_n_per_mm(eq_10(supply))} at {in_mpa(supply)} (eq. 10)",
            f"{in_n_per_mm(spring)} (cap side, whole stroke, {in_gpa(PAPER.bending_modulus)}); "
            f"{in_n_per_mm(value(evaluation, 'stiffness_barrel'))} (as designed, both chambers)",
        ),
        ("stretch of the barrel", text.DASH, "not in eq. 7", _stretch(evaluation)),
        (
            "total stiffness k_eq",
            text.DASH,
            f"{in_n_per_mm(PAPER.total(eq_10(1e6)))} at 1 MPa (eq. 7)",
            f"{in_n_per_mm(value(evaluation, 'stiffness_min'))} (weakest position)",
        ),
    )
    note = (
        "Eq. 10, k_cyl = ΔP A/L_p, has the unit of a stiffness but is not a stiffness: it "
        "grows with pressure and is zero without pressure; A²/(dV/dp) is the correct "
        "form. Eq. 11 lacks its divisor 4, which is restored here. Eq. 12 applies to an "
        "isotropic open-ended tube. With R as the outer radius it overstates the growth "
        f"by the ratio of the radii, {text.trimmed(printed / correct, 3)} times; the inner "
        "radius is correct, and with it the bore growth of our design gives the hoop "
        f"modulus in the table. Wall thickness (and ν = {text.trimmed(POISSONS_RATIO)} of "
        "the formula) are assumed."
    )
    return [text_table("El Asswad 2018: barrel", COLUMNS, rows, note)]


def _viscous(evaluation: Evaluation) -> list[Block]:
    case = evaluation.design.load_cases[0]
    by_table = damping.pipe_flow(dynamic_viscosity=PAPER.viscosity, length=PAPER.stroke)
    seal = evaluation.metrics["damping_seal"].by_case.get(case.name, float("nan"))
    rows = (
        (
            "oil damping c",
            in_ns_per_m(PAPER.damping),
            f"{in_ns_per_m(float(by_table))} over {in_mm(PAPER.stroke)} (eq. 6)",
            f"{in_ns_per_m(value(evaluation, 'damping_pipe'))} (pipe form); "
            f"{in_ns_per_m(value(evaluation, 'damping_annular'))} (annular gaps)",
        ),
        (
            "dynamic viscosity",
            text.DASH,
            f"{in_mpas(PAPER.viscosity)} (eq. 6, stroke {in_mm(PAPER.damping_stroke)})",
            text.DASH,
        ),
        (
            f"seal damping F/v, {text.trimmed(case.speed)} m/s",
            text.DASH,
            text.DASH,
            f"{in_ns_per_m(seal)} ({case.name})",
        ),
    )
    note = (
        f"c was computed with a stroke of {in_mm(PAPER.damping_stroke)}; that of table 1 gives "
        f"{in_ns_per_m(float(by_table))}. Eq. 6 is the wall shear on the barrel, not on "
        "the piston, and the seals' secant damping is "
        f"{text.number(seal / PAPER.damping, 2)} times as large, so these are two "
        "different quantities."
    )
    return [text_table("El Asswad 2018: viscous damping", COLUMNS, rows, note)]


def _range(values: Array, unit: str) -> str:
    scale = units.unit(unit, "stiffness")
    least, most = (text.number(float(scale.from_si(f(values))), 3) for f in (min, max))
    return f"{least} to {most} {unit}"


def _record(evaluation: Evaluation) -> list[Block]:
    record = own_record(evaluation)
    curves = along(evaluation, record)
    average, largest = (
        f"{in_mpa(pressure)} ({in_n(force)} by eq. 15–20)"
        for pressure, force in (
            (float(record.pressure[:-1].mean()), PAPER.friction_average),
            (float(max(record.pressure)), PAPER.friction_largest),
        )
    )
    rows = (
        ("pressure difference, average", text.DASH, average, text.DASH),
        ("pressure difference, largest", text.DASH, largest, text.DASH),
        (
            "radial expansion, largest",
            text.DASH,
            f"{in_um(float(max(curves.growth_published)))} (eq. 12)",
            f"{in_um(float(max(curves.growth_inner)))} with the inner radius; "
            f"{in_um(float(max(curves.growth_designed)))} as designed",
        ),
        (
            "equivalent stiffness k_eq",
            text.DASH,
            f"{_range(curves.stiffness_published, 'N/mm')} (eq. 7, 10–12)",
            f"{_range(curves.stiffness_chambers, 'kN/mm')} per chamber with the paper's "
            f"values; {_range(curves.stiffness_designed, 'kN/mm')} as designed",
        ),
    )
    note = (
        "The text of the paper gives neither pressures nor values for its figure 10. This "
        "record is our own: an outstroke and an instroke, with the pressure differences "
        f"at which eq. 15–20, µ = {text.trimmed(PAPER.friction_coefficient)} and the "
        "assumed rings give the published average and largest friction."
    )
    drawn = Drawing(
        "El Asswad 2018: k_eq and radial expansion along a record, as in figure 10",
        record_figure(record, curves),
        "A record of our own, with the pressures that give the paper's friction, not its "
        "measured record. The stiffness by eq. 7 with eq. 10 follows the pressure and is "
        "zero without pressure. Stiffness per chamber follows the position of the piston: "
        f"with the paper's values ({in_gpa(PAPER.bending_modulus)}, k_rod, its constant K "
        "and the line volume that gives its k_oil), and as designed (load case "
        f'"{evaluation.curve.case}", ports closed).',
    )
    return [text_table("El Asswad 2018: pressure record", COLUMNS, rows, note), drawn]


TABLES: tuple[Callable[[Evaluation], list[Block]], ...] = (
    _sizes,
    _oil,
    _rod,
    _barrel,
    bending_table,
    _viscous,
    force_table,
    coefficient_table,
    _record,
)
"""Every table in the order of the paper; the record comes last, as it needs all others."""


def blocks(evaluation: Evaluation) -> list[Block]:
    """Every table and drawing."""
    return [block for table in TABLES for block in table(evaluation)]
