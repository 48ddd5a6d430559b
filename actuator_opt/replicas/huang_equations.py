"""Where every numbered equation of [Huang2017] lives in this project, and how it has to be read."""

from __future__ import annotations

from ..rendering import text
from ..rendering.blocks import ExtraTable
from .huang_published import PAPER
from .huang_readings import Readings
from .paper_text import TRACE_COLUMNS, Trace, listed, percent, trace_rows

TRACES: tuple[Trace, ...] = (
    Trace(1, 1, "force balance of the rod", ("models.damping.secant",), "gives the measured B"),
    Trace(
        2,
        2,
        "viscosity over pressure",
        ("models.fluid.roelands",),
        "our copy lost the leading minus of the exponent",
    ),
    Trace(3, 3, "density over pressure", ("lubrication.inputs.Lubricant",)),
    Trace(
        4,
        4,
        "Reynolds equation",
        ("lubrication.reynolds.flux", "models.flow_factors.shear_flow_factor"),
        'the text calls "a" the seal, but u_a = U is the rod: rough seal on a smooth rod, '
        "phi_s below 0",
    ),
    Trace(5, 5, "composite roughness", ("models.rough_surface.composite_roughness",)),
    Trace(6, 6, "mean gap", ("models.rough_surface.mean_gap_ratio",)),
    Trace(
        7,
        7,
        "shear stress of the oil",
        (
            "models.flow_factors.shear_stress_factor",
            "models.flow_factors.shear_stress_correction",
            "models.flow_factors.pressure_stress_factor",
        ),
    ),
    Trace(8, 9, "asperity contact", ("models.rough_surface.asperity_pressure",)),
    Trace(
        10,
        10,
        "shear stress of asperities",
        ("evaluation.film.FilmRow",),
        f"{listed([text.trimmed(x) for x in PAPER.dry_friction])} times the contact load, in its "
        "frictions",
    ),
    Trace(
        11,
        15,
        "deformation and film",
        ("lubrication.newton.residual",),
        "eq. 14 and 15 lack the rigid shift that eq. 12 needs",
    ),
    Trace(16, 16, "flow", ("lubrication.reynolds.flux",), "negative pressure gradient drives it"),
    Trace(17, 17, "equal flow of both seals", ("lubrication.tandem.solve_tandem",)),
    Trace(
        18,
        18,
        "friction of the seals",
        ("lubrication.film.outputs", "evaluation.film.FilmRow"),
        "pi d times drag and contact, in its frictions",
    ),
    Trace(
        19,
        22,
        "back-up ring",
        ("lubrication.smooth.solve_gap",),
        "eq. 19 prints q and g: density and viscosity",
    ),
    Trace(
        23,
        25,
        "chamber",
        ("models.damping.flat_gap",),
        f"its {PAPER.chamber_shear} N s/m has no inputs",
    ),
    Trace(26, 26, "total damping", ("replicas.huang_parts.total",)),
    Trace(
        27,
        28,
        "dimensionless forms",
        (),
        "out of scope: the solver scales by itself; q of eq. 28 is the density",
    ),
    Trace(29, 30, "stopping", ("lubrication.newton.newton",), "on residuals instead of steps"),
    Trace(
        31,
        31,
        "Stribeck curve",
        ("models.friction.stribeck", "models.damping.secant"),
        "v_s of table 2 in mm/s",
    ),
)
"""All of eq. 1 to 31, in order."""


def table(found: Readings) -> ExtraTable:
    """Every equation of the paper with its function."""
    note = (
        "Functions stand in actuator_opt. Beside the numbered ones the paper fits B = a v^b and "
        "B = a1 e^(b1 v) + a2 e^(b2 v), here fits.fit_power_law and fits.fit_double_exponential. "
    )
    if found.shift == found.shift:
        thinner = "thinner" if found.shift > 0 else "thicker"
        note += (
            f"What the letters would do to the first seal alone at 6 MPa and 5 mm/s: without the "
            f"rigid shift its film of {text.trimmed(1e6 * found.mean, 3)} µm would be "
            f"{text.trimmed(1e6 * abs(found.shift), 2)} µm {thinner} and carry "
            f"{percent(abs(found.excess))} {'more' if found.excess > 0 else 'less'} than presses "
            "it down, so no film meets eq. 12; with the rough side on the rod it passes "
            f"{percent(found.swapped / found.flow - 1)} more."
        )
    return ExtraTable(
        "Huang 2017: where its equations are", TRACE_COLUMNS, trace_rows(TRACES), note
    )
