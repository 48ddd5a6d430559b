"""Tables of the numbers that [ElAsswad2018] prints beside ours, contradictions named.

One table per subject; the columns are what the paper prints, what its own formula gives with the
paper's numbers, and what this project's models give for the design as it stands.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from .. import units
from ..design.materials import load_library
from ..evaluation import Evaluation
from ..models import barrel, damping, fluid, forces, friction, laminate, ply, rod, seals
from ..models import stiffness_published as published
from . import text
from .blocks import ExtraTable
from .elasswad_paper import PAPER, root

COLUMNS = ("quantity", "published", "its own formula", "ours")


def _text(value: float, unit: str, dimension: str) -> str:
    return text.with_unit(
        text.trimmed(float(units.unit(unit, dimension).from_si(value))), text.unit_text(unit)
    )


_length = partial(_text, unit="mm", dimension="length")
_growth = partial(_text, unit="um", dimension="length")
_area = partial(_text, unit="mm^2", dimension="area")
_volume = partial(_text, unit="ml", dimension="volume")
_force = partial(_text, unit="N", dimension="force")
_stiffness = partial(_text, unit="N/mm", dimension="stiffness")
_pressure = partial(_text, unit="MPa", dimension="pressure")
_modulus = partial(_text, unit="GPa", dimension="pressure")
_damping = partial(_text, unit="N*s/m", dimension="damping")
_viscosity = partial(_text, unit="mPa*s", dimension="dynamic_viscosity")


def _percent(share: float) -> str:
    return f"{text.trimmed(100 * share, 3)} %"


def _value(evaluation: Evaluation, name: str) -> float:
    value = evaluation.metrics[name].value
    return float("nan") if value is None else value


def _sizes(evaluation: Evaluation) -> ExtraTable:
    cylinder, piston = evaluation.design.cylinder, evaluation.design.piston
    middle = PAPER.stroke / 2
    spring = PAPER.total(float("inf")) * middle
    gap = (PAPER.bore - PAPER.piston_diameter) / 2
    rows = (
        (
            "piston diameter",
            _length(PAPER.piston_diameter),
            text.DASH,
            _length(cylinder.bore - 2 * piston.clearance),
        ),
        (
            "stroke",
            f"{_length(PAPER.stroke)}; {_length(PAPER.damping_stroke)}",
            text.DASH,
            _length(cylinder.stroke),
        ),
        (
            "force at mid-stroke",
            text.DASH,
            f"{_force(spring)} (eq. 1, k_eq x)",
            f"{_force(_value(evaluation, 'push_force'))} (net push)",
        ),
    )
    note = (
        f"Table 1 lists a {_length(PAPER.piston_diameter)} piston in a {_length(PAPER.bore)} "
        f"cylinder: a radial gap of {_length(gap)} that no ring of this size closes. "
        f"The stroke is {_length(PAPER.stroke)} in table 1 and {_length(PAPER.damping_stroke)} in "
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
            _pressure(PAPER.bulk_modulus),
            text.DASH,
            f"{_pressure(aerated(usual))} (VG 32, {_percent(usual)} air)",
        ),
        ("entrained air behind it", text.DASH, text.DASH, _percent(air)),
        (
            "oil stiffness k_oil",
            _stiffness(PAPER.oil_stiffness),
            f"{_stiffness(bare)} (eq. 9, no lines)",
            _stiffness(_value(evaluation, "stiffness_oil")),
        ),
        (
            "line volume per side",
            text.DASH,
            f"{_volume(volume)}; {_volume(narrow)} if the bore is {_length(PAPER.piston_diameter)}",
            f"{_volume(dead[0])}; {_volume(dead[1])}",
        ),
    )
    note = (
        f"Eq. 9 at mid-stroke gives {text.trimmed(bare / PAPER.oil_stiffness, 2)} times the "
        f"published k_oil unless {_volume(volume)} of line stand on each side, of which the paper "
        f"says nothing. The bulk modulus is that of a mineral oil with {_percent(air)} of entrained"
        f" air at the {_pressure(design.supply.pressure)} of this design."
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
    known = load_library().get(design.rod.material).numbers
    ours = known.get("youngs_modulus", known.get("youngs_modulus_1", float("nan")))
    stiff = _value(evaluation, "stiffness_rod")
    length = ours * rod.section_area(
        outer_diameter=design.rod.outer_diameter, inner_diameter=design.rod.inner_diameter
    )
    rows = (
        (
            "rod stiffness k_rod",
            _stiffness(PAPER.rod_stiffness),
            f"{_stiffness(float(bent))} (eq. 8 with {_modulus(PAPER.bending_modulus)})",
            f"{_stiffness(stiff)} (rod of {_length(float(length) / stiff)})",
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
            f"{_modulus(short)} over {_length(PAPER.stroke)}; "
            f"{_modulus(long)} over {_length(PAPER.damping_stroke)}",
            f"{_modulus(ours)}; woven carbon {_modulus(fabric)}",
        ),
    )
    note = (
        f"k_rod means {_modulus(short)} or {_modulus(long)}, by which of its two strokes the paper "
        f"divided; neither is the measured {_modulus(PAPER.bending_modulus)} nor what woven carbon "
        "has along its warp."
    )
    return ExtraTable("El Asswad 2018: rod stiffness", COLUMNS, rows, note)


def _hoop_modulus(evaluation: Evaluation) -> float:
    """Hoop modulus of the design's wall."""
    plies, thicknesses = [], []
    for layer in evaluation.design.barrel.layup:
        known = load_library().get(layer.material).numbers
        constants = ply.ply_stiffness(
            youngs_modulus_1=known["youngs_modulus_1"],
            youngs_modulus_2=known["youngs_modulus_2"],
            poissons_ratio_12=known["poissons_ratio_12"],
            shear_modulus_12=known["shear_modulus_12"],
        )
        plies.append(ply.rotated(stiffness=constants, angle=layer.angle))
        thicknesses.append(layer.thickness)
    membrane = laminate.membrane(plies=plies, thicknesses=thicknesses)
    return float(laminate.effective_moduli(membrane=membrane, thickness=sum(thicknesses))[1])


def _eq_10(pressure: float, *, growth_per_pressure: float) -> float:
    """The printed k_cyl at a pressure, the bore grown by eq. 12."""
    wide = forces.piston_area(bore=PAPER.bore + 2 * growth_per_pressure * pressure)
    return float(
        published.cylinder_expansion_as_published(pressure=pressure, area=wide, stroke=PAPER.stroke)
    )


def _barrel(evaluation: Evaluation) -> ExtraTable:
    design = evaluation.design
    supply = design.supply.pressure
    inner = design.cylinder.bore / 2
    outer = inner + sum(layer.thickness for layer in design.barrel.layup)
    wall = {
        "inner_radius": inner,
        "outer_radius": outer,
        "youngs_modulus": PAPER.bending_modulus,
        "poissons_ratio": 0.3,
    }
    printed = float(barrel.bore_growth_as_published(pressure=supply, **wall))
    correct = float(barrel.bore_growth(pressure=supply, **wall))
    area = forces.piston_area(bore=design.cylinder.bore)
    give = barrel.chamber_compliance(
        inner_radius=inner, growth_per_pressure=correct / supply, length=PAPER.stroke
    )
    spring = float(barrel.barrel_stiffness(area=area, compliance=give))
    eq_10 = partial(_eq_10, growth_per_pressure=printed / supply)
    rows = (
        (
            "modulus of the barrel",
            f"{_modulus(PAPER.bending_modulus)} (bending)",
            text.DASH,
            f"{_modulus(_hoop_modulus(evaluation))} (hoop)",
        ),
        (
            f"bore growth at {_pressure(supply)}",
            text.DASH,
            f"{_growth(printed)} (eq. 12); {_growth(correct)} with the inner radius",
            _growth(_value(evaluation, "bore_growth")),
        ),
        (
            "barrel stiffness k_cyl",
            text.DASH,
            f"{_stiffness(eq_10(1e6))} at 1 MPa; "
            f"{_stiffness(eq_10(supply))} at {_pressure(supply)} (eq. 10)",
            f"{_stiffness(spring)} with {_modulus(PAPER.bending_modulus)}; "
            f"{_stiffness(_value(evaluation, 'stiffness_barrel'))} as designed",
        ),
        (
            "total stiffness k_eq",
            text.DASH,
            f"{_stiffness(PAPER.total(eq_10(1e6)))} at 1 MPa (eq. 7)",
            _stiffness(_value(evaluation, "stiffness_min")),
        ),
    )
    note = (
        "Eq. 10, k_cyl = ΔP A/L_p, has the unit of a stiffness but is none: it grows with pressure "
        "and at zero pressure the cylinder would have no stiffness at all; A²/(dV/dp) has. "
        "Eq. 11 lost its divisor 4, which is restored here. "
        "Eq. 12 is the isotropic open-ended tube, but with R as the outer radius it over-states "
        f"the growth by the wall ratio, {text.trimmed(printed / correct, 3)} times; the inner "
        "radius is right. "
        "Eq. 13 yields a bending modulus, uncorrected for shear and section, where eq. 12 needs "
        "the hoop modulus. Wall thickness (and ν = 0.3 of its formula) are assumed."
    )
    return ExtraTable("El Asswad 2018: barrel", COLUMNS, rows, note)


def _viscous(evaluation: Evaluation) -> ExtraTable:
    case = evaluation.design.load_cases[0]
    by_table = damping.pipe_flow(dynamic_viscosity=PAPER.viscosity, length=PAPER.stroke)
    seal = evaluation.metrics["damping_seal"].by_case.get(case.name, float("nan"))
    rows = (
        (
            "oil damping c",
            _damping(PAPER.damping),
            f"{_damping(float(by_table))} over {_length(PAPER.stroke)} (eq. 6)",
            f"{_damping(_value(evaluation, 'damping_pipe'))} (pipe form); "
            f"{_damping(_value(evaluation, 'damping_annular'))} (annular gaps)",
        ),
        (
            "dynamic viscosity",
            text.DASH,
            f"{_viscosity(PAPER.viscosity)} (eq. 6, {_length(PAPER.damping_stroke)})",
            text.DASH,
        ),
        (
            f"seal damping F/v, {text.trimmed(case.speed)} m/s",
            text.DASH,
            text.DASH,
            _damping(seal),
        ),
    )
    note = (
        f"c was computed with {_length(PAPER.damping_stroke)}; the stroke of table 1 gives "
        f"{_damping(float(by_table))}. Eq. 6 is the wall shear on the barrel, not on the piston, "
        f"and the seals' secant damping is {text.number(seal / PAPER.damping, 2)} times as large: "
        "two quantities, never one."
    )
    return ExtraTable("El Asswad 2018: viscous damping", COLUMNS, rows, note)


def _friction(evaluation: Evaluation) -> ExtraTable:
    rows = []
    for name, force, loss, metric in (
        ("average", PAPER.friction_average, PAPER.loss_average, "friction_running"),
        ("largest", PAPER.friction_largest, PAPER.loss_largest, "friction_breakaway"),
    ):
        own = float(forces.pressure_loss(friction=force, area=PAPER.area))
        rows += [
            (f"{name} friction", _force(force), text.DASH, _force(_value(evaluation, metric))),
            (f"{name} pressure loss", _pressure(loss), f"{_pressure(own)} (F/A)", text.DASH),
            (f"{name}: area F/Δp", text.DASH, _area(force / loss), f"{_area(PAPER.area)} (bore)"),
        ]
    first = PAPER.friction_average / PAPER.loss_average
    second = PAPER.friction_largest / PAPER.loss_largest
    note = (
        f"Force and pressure loss together mean a piston of {_area(first)} or {_area(second)}, "
        f"{text.number(first / PAPER.area, 2)} and {text.number(second / PAPER.area, 2)} times the "
        f"{_area(PAPER.area)} of the bore: forces and pressure losses cannot both be of this "
        f"cylinder. Our forces are no check of the paper's: they hold at the "
        f"{_pressure(evaluation.design.supply.pressure)} assumed in the design."
    )
    return ExtraTable("El Asswad 2018: friction force", COLUMNS, rows, note)


def _coefficient(evaluation: Evaluation) -> ExtraTable:
    ring = evaluation.design.seals.piston
    hardness = load_library().get(ring.compound).numbers["hardness"]
    modulus = seals.MODULUS_LAWS[ring.hardness_model].modulus(hardness=hardness)
    ours = seals.LAWS["plane_strain"]
    size = {"section": ring.section, "youngs_modulus": modulus}
    height = ring.section * (1 - ring.squeeze)
    chord = float(seals.width_as_published(section=ring.section, gland_height=height))
    width = float(ours.contact_width(squeeze=ring.squeeze, pressure=0.0, **size))
    unit = friction.coulomb_as_published(
        pressure=1.0,
        friction_coefficient=PAPER.friction_coefficient,
        piston_contact_width=chord,
        rod_contact_width=chord,
        bore=PAPER.bore,
        rod_diameter=PAPER.rod_diameter,
    )

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

    average = _force(PAPER.friction_average)
    rows = (
        (
            "friction coefficient µ",
            text.trimmed(PAPER.friction_coefficient),
            f"{average} at {_pressure(PAPER.friction_average / float(unit))} (eq. 15–20)",
            f"{text.number(coefficient(2e6), 3)} at 2 MPa; "
            f"{text.number(coefficient(7e6), 3)} at 7 MPa",
        ),
        (
            f"contact width at {_percent(ring.squeeze)} squeeze",
            text.DASH,
            f"{_length(chord)} (eq. 19)",
            _length(width),
        ),
        (
            "eq. 19 over ours",
            text.DASH,
            f"+{_percent(wider(0.10))} at 10 %; +{_percent(wider(0.20))} at 20 %",
            text.DASH,
        ),
    )
    note = (
        f"µ cannot be identified alone: with preload and energised rings {average} fits "
        f"{text.number(coefficient(2e6), 3)} at 2 MPa as well as {text.number(coefficient(7e6), 3)}"
        " at 7 MPa, and eq. 16 has no friction at all without pressure. "
        "Eq. 19 is the chord of the unsqueezed circle: at 10 % squeeze 38 %, at 20 % 15 % wider "
        "than the plane-strain finite elements that ours follows within 5 %. "
        "Ring section, squeeze and both rings under the full pressure are assumed."
    )
    return ExtraTable("El Asswad 2018: friction coefficient", COLUMNS, rows, note)


TABLES: tuple[Callable[[Evaluation], ExtraTable], ...] = (
    _sizes,
    _oil,
    _rod,
    _barrel,
    _viscous,
    _friction,
    _coefficient,
)
"""Every table, in the order of the paper."""
