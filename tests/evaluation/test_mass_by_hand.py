"""The mass model against a calculation by hand, part by part, and against the drawing.

The robot knee with the dimensions of `DIMENSIONS`, in mm, g and g/cm3 (aluminium 2.81, carbon ply
1.57, steel 7.85, NBR 1.25, PTFE 2.165, oil 0.87). Radii of the wall 11.5 | 12.1 | 13.3 | 14.1,
barrel 138 long (piston 14 + stroke 110 + head 14), rod 141 (138 - 14 + plate 5 + extension 12):

    part        what                                                    mm3        g
    barrel      liner, hoop and axial plies over 138       6139 13214  9503    52.92
    rod         tube 13/6 over 141                                    14729   115.62
    piston      disc 22.94 x 14 less a groove of 5.2            5786 - 526    14.78
    caps        two plates 31.2 x 5, one bored 13.06       3823       3153
                two skirts 31.2/28.2 x 20                        2 x 2799    35.33
    glands      plug 23/13.06 x 14 less a groove of 3.5         3941 - 240    10.40
    seals       two rings of section 1.78, three back-up rings    281 + 366     1.14
    fastening   stud M10 x 1.25 x 10, two plugs 6 x 10           663 + 565     9.64
    clevises    two eyes pi d^3 on a pin of 8                        2 x 1608   25.25
    dry                                                                       265.09
    oil         annulus 23/13 over 110, and 6 ml of ports     31102 + 6000    32.28

Nothing of the mass model is called to get these figures; `BY_HAND` writes them out.
"""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.design.materials import load_library
from actuator_opt.pages.report import masses

DESIGNS = Path(__file__).parents[2] / "designs"
DIMENSIONS = {
    "cylinder.bore": "23 mm",
    "cylinder.stroke": "110 mm",
    "cylinder.dead_volume_a": "3 ml",
    "cylinder.dead_volume_b": "3 ml",
    "barrel.layup[0].thickness": "0.6 mm",
    "barrel.layup[1].thickness": "1.2 mm",
    "barrel.layup[2].thickness": "0.8 mm",
    "rod.outer_diameter": "13 mm",
    "rod.inner_diameter": "6 mm",
    "rod.extension": "12 mm",
    "rod.thread.diameter": "10 mm",
    "rod.thread.pitch": "1.25 mm",
    "piston.length": "14 mm",
    "piston.clearance": "0.03 mm",
    "head.length": "14 mm",
    "head.clearance": "0.03 mm",
    "caps.thickness": "5 mm",
    "retention.length": "20 mm",
    "retention.wall": "1.5 mm",
    "clevis.pin_diameter": "8 mm",
    "seals.piston.section": "1.78 mm",
    "seals.piston.squeeze": "14 %",
    "seals.piston.groove_width": "5.2 mm",
    "seals.rod.section": "1.78 mm",
    "seals.rod.squeeze": "14 %",
    "seals.rod.groove_width": "3.5 mm",
}
DENSITIES = {
    "al_7075_t6": "2.81 g/cm^3",
    "t700_epoxy": "1.57 g/cm^3",
    "steel_42crmo4": "7.85 g/cm^3",
    "nbr_90": "1.25 g/cm^3",
    "back_up_ptfe": "2.165 g/cm^3",
    "iso_vg_32": "0.87 g/cm^3",
}

ALUMINIUM, CARBON, STEEL, RUBBER, PTFE = 2.81e-3, 1.57e-3, 7.85e-3, 1.25e-3, 2.165e-3  # g/mm3
DEPTH = 1.5308  # gland depth, 0.86 x 1.78 mm
BY_HAND = {
    "barrel": 138
    * pi
    * (
        ALUMINIUM * (12.1**2 - 11.5**2)
        + CARBON * (13.3**2 - 12.1**2)
        + CARBON * (14.1**2 - 13.3**2)
    ),
    "rod": STEEL * 141 * pi * (6.5**2 - 3.0**2),
    "piston": ALUMINIUM * pi * (14 * 11.47**2 - 5.2 * (11.47**2 - (11.5 - DEPTH) ** 2)),
    "caps": ALUMINIUM * pi * (5 * 15.6**2 + 5 * (15.6**2 - 6.53**2) + 2 * 20 * (15.6**2 - 14.1**2)),
    "glands": ALUMINIUM * pi * (14 * (11.5**2 - 6.53**2) - 3.5 * ((6.5 + DEPTH) ** 2 - 6.53**2)),
    # torus of section 1.78: pi (1.78/2)^2 times pi times the diameter of its centre line
    # and back-up rings as deep as the gland, two 1.4 wide on the piston, one 1.1 wide on the rod
    "seals": RUBBER * pi * 0.89**2 * pi * ((23 - DEPTH) + (13 + DEPTH))
    + PTFE * DEPTH * pi * (2 * 1.4 * (23 - DEPTH) + 1.1 * (13 + DEPTH)),
    # pitch diameter of M10 x 1.25 by ISO 724: 9.188 mm
    "fastening": STEEL * pi * (10 * 4.594**2 + 2 * 10 * 3.0**2),
    "clevises": STEEL * 2 * pi * 8**3,
}
TABLE = {
    "barrel": 52.92,
    "rod": 115.62,
    "piston": 14.78,
    "caps": 35.33,
    "glands": 10.40,
    "seals": 1.14,
    "fastening": 9.64,
    "clevises": 25.25,
}


@pytest.fixture(scope="module")
def knee() -> verbs.Evaluation:
    """The knee with the dimensions and densities of the hand calculation."""
    densities = {f"materials.{name}.density": value for name, value in DENSITIES.items()}
    return verbs.evaluate(verbs.read(DESIGNS / "knee_bonded.yaml", set=DIMENSIONS | densities))


@pytest.mark.parametrize("part", BY_HAND)
def test_every_part_weighs_what_the_hand_calculation_says(knee, part) -> None:
    """Every part equals the figures written out above; the docstring's table shows them."""
    assert 1e3 * knee.mass_parts[part] == pytest.approx(BY_HAND[part], rel=1e-4)
    assert round(BY_HAND[part], 2) == pytest.approx(TABLE[part], abs=1e-9)


def test_the_parts_add_up_to_the_mass_and_no_part_is_missing(knee) -> None:
    """Dry mass is the sum of the eight parts, 265.3 g by hand."""
    assert set(knee.mass_parts) == set(BY_HAND)
    assert 1e3 * knee.metrics["mass"].value == pytest.approx(sum(BY_HAND.values()), rel=1e-4)
    assert sum(BY_HAND.values()) == pytest.approx(265.09, abs=0.01)


def test_the_oil_weighs_what_the_hand_calculation_says(knee) -> None:
    """Oil fills the annulus over the stroke and the dead volumes: 37.1 ml of 0.87 g/ml."""
    annulus = pi * (11.5**2 - 6.5**2) * 110
    assert 1e3 * knee.metrics["mass_oil"].value == pytest.approx(0.87e-3 * (annulus + 6000), 1e-6)


def _revolved(polygon) -> float:
    """Volume of a polygon of (axial position, radius) turned about the axis (Pappus).

    V = 2 pi times the first moment of the area, the integral of r over the polygon, from its
    corners by Green's theorem; the sign of the walk is taken out.
    """
    moment = 0.0
    for (x0, r0), (x1, r1) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        moment += (x0 * r1 - x1 * r0) * (r0 + r1) / 6
    return 2 * pi * abs(moment)


def test_pappus_on_a_ring() -> None:
    """The helper gives pi (R^2 - r^2) L of a rectangle, the closed form."""
    ring = ((1.0, 2.0), (4.0, 2.0), (4.0, 3.0), (1.0, 3.0))
    assert _revolved(ring) == pytest.approx(pi * (3**2 - 2**2) * 3, rel=1e-12)


@pytest.mark.parametrize("name", ["knee_bonded", "steel_baseline", "elasswad_knee"])
def test_the_drawing_has_the_volumes_of_the_mass_model(name) -> None:
    """Barrel, rod, piston, caps and glands as drawn, turned about the axis, weigh the same.

    Eyes are no bodies of revolution and rings are drawn squeezed: they are not compared.
    """
    evaluation = verbs.evaluate(DESIGNS / f"{name}.yaml")
    library = load_library()
    drawn: dict[str, float] = {}
    for outline in evaluation.outlines:
        part = "barrel" if outline.part.startswith("layup[") else outline.part
        density = library.get(outline.material).numbers["density"]
        volume = sum(_revolved(polygon) for polygon in outline.polygons)
        drawn[part] = drawn.get(part, 0.0) + density * volume
    for part in ("barrel", "rod", "piston", "caps", "glands"):
        assert drawn[part] == pytest.approx(evaluation.mass_parts[part], rel=1e-9), part


EXTRA = """
extra_masses:
  - {kind: sensor, mass: 35 g, place: rod}
  - {kind: ports, mass: 12 g, place: barrel}
  - {kind: other, mass: 3 g, place: piston}
"""


def test_stated_components_count_and_those_on_the_rod_move():
    """The mass grows by what is stated; the rod's frequency falls by the moving part alone."""
    text = (DESIGNS / "knee_bonded.yaml").read_text("utf-8")
    plain, full = ao.evaluate(ao.read(text)), ao.evaluate(ao.read(text + EXTRA))
    assert full.metrics["mass"].value == pytest.approx(
        plain.metrics["mass"].value + 0.050, rel=1e-12
    )
    assert full.mass_parts["components"] == pytest.approx(0.012)
    assert full.mass_parts["moving components"] == pytest.approx(0.038)
    moving = sum(plain.mass_parts[part] for part in ("rod", "piston", "fastening"))
    load = ao.read(text).design.load.mass
    ratio = full.metrics["natural_frequency"].value / plain.metrics["natural_frequency"].value
    assert ratio == pytest.approx(((load + moving) / (load + moving + 0.038)) ** 0.5, rel=1e-9)


def test_reports_name_what_the_mass_leaves_out():
    """What a design states is no longer left out; a bond seals, so it needs no static seals."""
    text = (DESIGNS / "knee_bonded.yaml").read_text("utf-8")
    plain, full = ao.evaluate(ao.read(text)), ao.evaluate(ao.read(text + EXTRA))
    gone = set(plain.mass_leaves_out) - set(full.mass_leaves_out)
    assert gone == {"position sensor", "ports and fittings"}
    assert "static seals of the ends" not in plain.mass_leaves_out
    text = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
    sealed = text.index("  static:")
    screwed = ao.evaluate(ao.read(text[:sealed] + text[text.index("load:\n") :]))
    assert "static seals of the ends" in screwed.mass_leaves_out
    assert plain.to_dict()["mass_leaves_out"] == list(plain.mass_leaves_out)
    assert masses(plain).note.startswith("The dry mass leaves out: ports and fittings, fastening")
