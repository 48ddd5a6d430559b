"""Tables of the numbers that [ElAsswad2018] prints beside ours, contradictions named.

One table per subject; the columns are what the paper prints, what its own formula gives with the
paper's numbers, and what this project's models give for the design as it stands.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ..base import units
from ..base.numeric import Array
from ..design.materials import load_library
from ..evaluation import Evaluation
from ..models import barrel, damping, fluid, forces, rod, stiffness_published as published
from ..rendering import text
from ..rendering.blocks import Drawing, ExtraTable
from . import elasswad_bending, elasswad_friction, elasswad_record
from .elasswad_figures import record_figure
from .elasswad_paper import PAPER, POISSONS_RATIO, root
from .elasswad_text import (
    COLUMNS,
    in_gpa,
    in_ml,
    in_mm,
    in_mpa,
    in_mpas,
    in_n,
    in_n_per_mm,
    in_ns_per_m,
    in_um,
    percent,
    properties,
    value,
    wall_thickness,
)


def _sizes(evaluation: Evaluation) -> ExtraTable:
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
        f"cylinder: a radial gap of {in_mm(gap)} that no ring of this size closes. "
        f"The stroke is {in_mm(PAPER.stroke)} in table 1 and {in_mm(PAPER.damping_stroke)} in "
        "the damping text. "
        "Eq. 1 takes k_eq x as a spring to ground, which no cylinder is: an external load belongs "
        "there."
    )
    return ExtraTable("El Asswad 2018: dimensions", COLUMNS, rows, note)


def _oil(evaluation: Evaluation) -> ExtraTable:
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
        ("entrained air behind it", text.DASH, text.DASH, percent(air)),
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
        f"Eq. 9 at mid-stroke gives {text.trimmed(bare / PAPER.oil_stiffness, 2)} times the "
        f"published k_oil unless {in_ml(volume)} of line stand on each side, of which the paper "
        f"says nothing. The bulk modulus is that of a mineral oil with {percent(air)} of entrained"
        f" air at the {in_mpa(design.supply.pressure)} of this design."
    )
    return ExtraTable("El Asswad 2018: oil stiffness", COLUMNS, rows, note)


def _rod(evaluation: Evaluation) -> ExtraTable:
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
            "E/L behind it",
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
        f"k_rod means {in_gpa(short)} or {in_gpa(long)}, by which of its two strokes the paper "
        f"divided; neither is the measured {in_gpa(PAPER.bending_modulus)} nor what woven carbon "
        "has along its warp."
    )
    return ExtraTable("El Asswad 2018: rod stiffness", COLUMNS, rows, note)


def _eq_10(pressure: float, *, growth_per_pressure: float) -> float:
    """The printed k_cyl at a pressure, the bore grown by eq. 12."""
    wide = forces.piston_area(bore=PAPER.bore + 2 * growth_per_pressure * pressure)
    return float(
        published.cylinder_expansion_as_published(pressure=pressure, area=wide, stroke=PAPER.stroke)
    )


def _stretch(evaluation: Evaluation) -> str:
    """What the barrel's axial stretch adds, as a stiffness at the weakest position."""
    curve = evaluation.curve
    place = min(range(len(curve.stiffness)), key=lambda k: float(curve.stiffness[k]))
    share = curve.contributions.get("stretch")
    if share is None or not float(share[place]) > 0:
        return text.DASH
    return in_n_per_mm(1 / float(share[place]))


def _barrel(evaluation: Evaluation) -> ExtraTable:
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
            f"{in_gpa(hoop)} (hoop, behind our growth)",
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
        "Eq. 10, k_cyl = ΔP A/L_p, has the unit of a stiffness but is none: it grows with pressure "
        "and at zero pressure the cylinder would have no stiffness at all; A²/(dV/dp) has. "
        "Eq. 11 lost its divisor 4, which is restored here. "
        "Eq. 12 is the isotropic open-ended tube, but with R as the outer radius it over-states "
        f"the growth by the wall ratio, {text.trimmed(printed / correct, 3)} times; the inner "
        "radius is right, and turns our growth into the hoop modulus beside it. Wall thickness "
        f"(and ν = {text.trimmed(POISSONS_RATIO)} of the formula) are assumed."
    )
    return ExtraTable("El Asswad 2018: barrel", COLUMNS, rows, note)


def _viscous(evaluation: Evaluation) -> ExtraTable:
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
            f"{in_mpas(PAPER.viscosity)} (eq. 6, {in_mm(PAPER.damping_stroke)})",
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
        f"c was computed with {in_mm(PAPER.damping_stroke)}; the stroke of table 1 gives "
        f"{in_ns_per_m(float(by_table))}. Eq. 6 is the wall shear on the barrel, not on the "
        f"piston, and the seals' secant damping is {text.number(seal / PAPER.damping, 2)} times as "
        "large: two quantities, never one."
    )
    return ExtraTable("El Asswad 2018: viscous damping", COLUMNS, rows, note)


def _range(values: Array, unit: str) -> str:
    scale = units.unit(unit, "stiffness")
    least, most = (text.number(float(scale.from_si(f(values))), 3) for f in (min, max))
    return f"{least} to {most} {unit}"


def _record(evaluation: Evaluation) -> ExtraTable:
    record = elasswad_record.own_record(evaluation)
    found = elasswad_record.along(evaluation, record)
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
            f"{in_um(float(max(found.growth_published)))} (eq. 12)",
            f"{in_um(float(max(found.growth_inner)))} with the inner radius; "
            f"{in_um(float(max(found.growth_designed)))} as designed",
        ),
        (
            "equivalent stiffness k_eq",
            text.DASH,
            f"{_range(found.stiffness_published, 'N/mm')} (eq. 7, 10–12)",
            f"{_range(found.stiffness_chambers, 'kN/mm')} per chamber with the paper's numbers; "
            f"{_range(found.stiffness_designed, 'kN/mm')} as designed",
        ),
    )
    note = (
        "The text of the paper gives no pressure and no value of its figure 10. This record is our "
        "own: one stroke out and back, with the pressure differences at which eq. 15–20, "
        f"µ = {text.trimmed(PAPER.friction_coefficient)} and the assumed rings give the published "
        "average and largest friction."
    )
    drawn = Drawing(
        "El Asswad 2018: k_eq and radial expansion along a record, as its figure 10",
        record_figure(record, found),
        "A record of our own with the pressures behind the paper's friction, not its measured "
        "one. Eq. 7 with eq. 10 follows the pressure and leaves no stiffness where there is none. "
        "Per chamber it follows the place of the piston: with the paper's numbers "
        f"({in_gpa(PAPER.bending_modulus)}, k_rod, its constant K and the line volume behind its "
        f"k_oil), and as designed (case {evaluation.curve.case}, ports closed).",
    )
    return ExtraTable("El Asswad 2018: pressure record", COLUMNS, rows, note, drawn)


TABLES: tuple[Callable[[Evaluation], ExtraTable], ...] = (
    _sizes,
    _oil,
    _rod,
    _barrel,
    elasswad_bending.table,
    _viscous,
    elasswad_friction.force_table,
    elasswad_friction.coefficient_table,
    _record,
)
"""Every table, in the order of the paper but for the record, which needs them all."""
