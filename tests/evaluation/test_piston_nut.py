"""The nut that clamps the piston on the rod: rows and masses by hand, refusals, drawing."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path

import pytest
from shipped import PLAIN_KNEE

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.models import piston_nut

DESIGNS = Path(__file__).parents[2] / "designs"
NUT = """  nut:                          # clamps the piston on a stud of the rod
    diameter: 8 mm
    pitch: 1 mm
    preload: 8 kN
"""
STEEL, ALUMINIUM = 210e9, 71.7e9
D, P, PRELOAD = 8e-3, 1e-3, 8e3


def near(value, rel=1e-6):
    """Equal up to rounding."""
    return pytest.approx(value, rel=rel)


def pair():
    """The shipped knee with its nut, and the same without it."""
    text = PLAIN_KNEE
    assert NUT in text
    return ao.evaluate(ao.read(text)), ao.evaluate(ao.read(text.replace(NUT, "")))


def test_two_springs_share_a_pull():
    """A stud and a sleeve of equal length, stretched together, share as their E A."""
    stud, sleeve = STEEL * D**2, ALUMINIUM * (11.5e-3**2 - D**2)
    share = piston_nut.stud_share(
        diameter=D, shoulder_diameter=11.5e-3, stud_modulus=STEEL, piston_modulus=ALUMINIUM
    )
    assert share == near(stud / (stud + sleeve))
    wide = piston_nut.stud_share(
        diameter=D, shoulder_diameter=30e-3, stud_modulus=STEEL, piston_modulus=ALUMINIUM
    )
    assert wide == near(stud / (stud + ALUMINIUM * (12e-3**2 - D**2)))  # no wider than the nut


def test_stud_and_piston_as_springs():
    """Least share and preload by two springs in parallel; shoulder, hexagon and corner by areas."""
    length, piston = 6e-3, 21.4e-3
    stud = pi / 4 * D**2 * STEEL / (length + 0.9 * D)
    clamped = pi / 4 * (piston**2 - D**2) * ALUMINIUM / length
    size = {
        "diameter": D, "piston_diameter": piston, "length": length,
        "stud_modulus": STEEL, "piston_modulus": ALUMINIUM,
    }  # fmt: skip
    assert piston_nut.least_stud_share(**size) == near(stud / (stud + clamped))
    grown = 6e-4 * length  # the stud stretches, the piston gives, and both forces are equal
    force = piston_nut.preload_change(**size, strain_difference=6e-4)
    assert force / stud + force / clamped == near(grown)
    assert piston_nut.shoulder_area(diameter=D, shoulder_diameter=12e-3) == near(
        pi * (6e-3**2 - 4e-3**2)
    )
    corner = piston_nut.corner_radius(diameter=D)
    assert corner * sqrt(3) / 2 == near(0.75 * D)  # half the width across flats
    hexagon = 6 * sqrt(3) / 4 * corner**2
    assert piston_nut.nut_volume(diameter=D) == near((hexagon - pi / 4 * D**2) * 0.8 * D)


def clamp_give(length, shoulder):
    """Give of stud and frusta: slices of the clamped part, whose pressure spreads at 30 degrees."""
    slices = 2000
    depths = [(k + 0.5) * length / 2 / slices for k in range(slices)]
    frusta = sum(
        length / 2 / slices / (ALUMINIUM * pi / 4 * ((seat + 2 * x / sqrt(3)) ** 2 - D**2))
        for x in depths
        for seat in (shoulder, 1.5 * D)
    )
    return frusta + 4 / pi * (length + 0.9 * D) / (STEEL * D**2)


def test_tightening_scatters_and_faces_settle():
    """The mean preload is stated; 8 um of settling; frusta by slices; torsion by its own stress."""
    least, greatest = piston_nut.preload_range(preload=13e3, tightening_factor=1.6)
    assert (least, greatest) == near((10e3, 16e3))
    size = {"diameter": D, "shoulder_diameter": 11.5e-3, "length": 6e-3}
    give = piston_nut.clamp_compliance(**size, stud_modulus=STEEL, piston_modulus=ALUMINIUM)
    assert give == near(clamp_give(6e-3, 11.5e-3))
    loss = piston_nut.settling_loss(threads=1, seats=2, joints=0, compliance=give)
    assert loss == near(8e-6 / give)
    flank, core = D - 0.6495 * P, D - 0.9382 * P
    torque = flank / 2 * (P / (pi * flank) + 2 / sqrt(3) * 0.12)  # per newton of preload
    twist, pull = 16 * torque / (pi * core**3), 4 / (pi * core**2)
    for share in (1.0, 0.5):
        factor = piston_nut.torsion_factor(diameter=D, pitch=P, share=share)
        assert factor * pull == near(sqrt(pull**2 + 3 * (share * twist) ** 2))


def test_rows_of_the_knee_by_hand():
    """Clamping force, stress of the stud, and pressure under the shoulder."""
    preload = 14e3
    found = ao.evaluate(ao.read(PLAIN_KNEE, set={"piston.nut.preload": preload}))
    bore, rod = 21.8e-3, 12e-3
    push, pull = 21e6 * pi / 4 * bore**2, 21e6 * pi / 4 * (bore**2 - rod**2)
    web, piston = 12.5e-3 - 0.8 * D, bore - 60e-6
    give = 4 / pi * (web + 0.9 * D) / (STEEL * D**2)  # thread and nut: half and 0.4 diameters
    clamped = 4 / pi * web / (ALUMINIUM * (piston**2 - D**2))
    share = clamped / (give + clamped)
    least, greatest = preload / 1.3, 1.6 * preload / 1.3
    cold = least - 8e-6 / clamp_give(web, rod)
    cold -= 20 * web * (23.6e-6 - 11.5e-6) / (give + clamped)
    hot = greatest + 60 * web * (23.6e-6 - 11.5e-6) / (give + clamped)
    factor = found.metrics["piston_nut_factor"]
    assert factor.place == "cold"
    assert factor.value == near(cold / ((1 - share) * 1.5 * pull))
    area = pi / 4 * (D - 0.9382 * P) ** 2
    endured = 0.85e6 * (0.150 / D + 45)
    stud, sleeve = STEEL * D**2, ALUMINIUM * (rod**2 - D**2)
    amplitude = stud / (stud + sleeve) * (pull + push) / 2 / area  # the push relieves the stud
    life = 2e6 * (endured / amplitude) ** 3
    alone = ao.evaluate(
        ao.read(
            PLAIN_KNEE,
            set={"barrel.layup[0].thickness": "5 mm", "retention.wall": "3 mm"},
        )
    )
    assert alone.metrics["cycle_life"].place == "piston nut"
    assert alone.metrics["cycle_life"].value == near(life)
    shoulder = pi / 4 * (rod**2 - D**2)
    row = found.metrics["yield_factor"]
    assert row.place == "piston under the rod's shoulder"
    strength = (row.value * push + hot) / shoulder
    assert 0.8 * 503e6 < strength < 503e6  # 7075-T6 after knock-downs
    row = found.metrics["thread_factor"]
    assert row.place == "piston nut"
    ratio = piston_nut.torsion_factor(diameter=D, pitch=P, share=0.5)
    borne = (row.value * stud / (stud + sleeve) * pull + hot) * ratio / area
    alone = ao.read(PLAIN_KNEE, set={"piston.nut.preload": "20 kN"})
    row = ao.evaluate(alone).metrics["piston_nut_factor"]
    assert row.place == "while tightened"
    tight = piston_nut.torsion_factor(diameter=D, pitch=P) * 20e3 * 1.6 / 1.3 / area
    assert 0.9 * borne / tight == near(row.value)  # one yield strength in both rows


def test_masses_by_hand():
    """Nut and stud weigh, the hole and the recess of the piston do not."""
    found, bare = pair()
    length, height, corner = 12.5e-3, 0.8 * D, 1.5 * D / sqrt(3)
    shank = pi / 4 * D**2
    nut = (sqrt(3) / 2 * (1.5 * D) ** 2 - shank) * height
    more = found.mass_parts["fastening"] - bare.mass_parts["fastening"]
    plug = pi / 4 * 8e-3**2 * (10e-3 - D)  # the bore's plug at the piston is as long as its thread
    assert more == near(7850 * (nut - plug))
    stud = found.mass_parts["rod"] - bare.mass_parts["rod"]
    assert stud == near(7850 * shank * length)
    less = bare.mass_parts["piston"] - found.mass_parts["piston"]
    assert less == near(2810 * (shank * (length - height) + pi * corner**2 * height))
    assert "fastening of the piston to the rod" in bare.mass_leaves_out
    assert "fastening of the piston to the rod" not in found.mass_leaves_out
    assert found.metrics["geometry_piston_web"].value == near(length - height)
    assert "piston nut" in {part.part for part in found.outlines}


def test_the_web_by_a_guided_beam():
    """A strip of the web, clamped at one end and guided at the other, by its end moment."""
    force, radius, reach, thickness = 5e3, 5.5e-3, 1.4e-3, 2e-3
    line = force / (2 * pi * radius)
    moment = line * reach / 2  # a guided end: no rotation at both ends
    bending, shear = 6 * moment / thickness**2, line / thickness
    found = piston_nut.web_stress(
        force=force, radius=radius, reach_length=reach, thickness=thickness
    )
    assert found == near(sqrt(bending**2 + 3 * shear**2))


def test_an_optimum_keeps_the_stud_long():
    """The optimiser shortens the steel piston until settling would open the joint, not further."""
    best = ao.optimise(ao.read(DESIGNS / "steel_baseline.yaml"), prices=False).evaluation
    assert best.metrics["piston_nut_factor"].value == near(1.0, 1e-6)
    assert best.metrics["geometry_piston_web"].value >= 1e-3 * (1 - 1e-6)


@pytest.mark.parametrize(
    ("changes", "path", "said"),
    [
        ({"piston.nut.diameter": "12 mm"}, "piston.nut.diameter", "no shoulder"),
        ({"piston.nut.pitch": "-1 mm"}, "piston.nut.pitch", ""),
        ({"piston.nut.pitch": "4 mm"}, "piston.nut.pitch", "no core of the thread"),
        (
            {"piston.length": "6.2 mm", "variables.piston.length.upper": "6.3 mm"},
            "piston.nut.diameter",
            "at most 6.3 mm long",
        ),
    ],
)
def test_a_nut_that_cannot_be_is_refused(changes, path, said):
    """Each with its place and what to do."""
    with pytest.raises(InputError) as error:
        ao.read(PLAIN_KNEE, set=changes)
    assert any(one.path == path and said in one.message for one in error.value.diagnostics)


def test_a_nut_without_preload_is_refused():
    """Nothing would clamp the piston; as a variable, the preload may start anywhere."""
    text = PLAIN_KNEE
    free = "  piston.nut.preload:\n    lower: 3 kN\n    upper: 20 kN\n"
    assert free in text
    with pytest.raises(InputError) as error:
        ao.read(text.replace(free, ""), set={"piston.nut.preload": "0 N"})
    (fault,) = error.value.diagnostics
    assert fault.path == "piston.nut.preload"
    assert "nothing clamps" in fault.message
    assert "8 kN" in fault.remedy
    ao.read(text.replace("lower: 3 kN", "lower: 0 N"), set={"piston.nut.preload": "0 N"})


def test_a_laminated_rod_has_no_nut():
    """Its shoulder would crush plies."""
    text = PLAIN_KNEE
    layered = "  material: steel_42crmo4\n  outer_diameter: 12 mm\n  inner_diameter: 8 mm\n"
    assert layered in text
    plies = (
        "  material: steel_42crmo4\n  outer_diameter: 12 mm\n  layup:\n"
        "    - {material: t700_epoxy, angle: 10 deg, thickness: 2 mm}\n"
        "  fitting: {adhesive: epoxy_structural, length: 20 mm}\n"
    )
    with pytest.raises(InputError, match="no shoulder"):
        ao.read(text.replace(layered, plies))
