"""Designs whose ends are bonded by a double lap or by tapered skirts."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design
from actuator_opt.evaluation import compute
from actuator_opt.joints.kinds import JOINTS

KNEE = (Path(__file__).parents[2] / "designs" / "knee_bonded.yaml").read_text("utf-8")
KNEE = KNEE[: KNEE.index("\nvariables:")] + "\n"
BOND = "  type: bond\n  material: epoxy_structural\n  length: 20 mm\n  wall: 1.5 mm\n"
assert BOND in KNEE
DOUBLE = BOND.replace("bond\n", "double_lap\n  inner_wall: 1 mm\n").replace("20 mm", "12 mm")
TAPERED = BOND.replace("bond\n", "tapered_lap\n  tip: 0.25\n  taper_length: 8 mm\n")


def text_of(block):
    """The knee with another joint."""
    return KNEE.replace(BOND, block)


def metrics(text):
    """All metrics of a design."""
    subject = ao.read(text).subject()
    return compute(subject, subject.values()).computed.metrics


def number(value):
    """A value of one design, the least of all load cases."""
    return float(np.min(np.real(value)))


def faults(text):
    """Path and message of each fault."""
    with pytest.raises(InputError) as error:
        read_design(text, materials=ao.load_library())
    return [(fault.path, fault.message) for fault in error.value.diagnostics]


# --- tapered --------------------------------------------------------------------------------


def test_a_taper_to_full_thickness_is_a_plain_bond():
    """Shear, peel, heat, mass and yield agree with the joint `bond`."""
    plain, tapered = metrics(KNEE), metrics(text_of(TAPERED.replace("0.25", "1")))
    first, second = (
        sorted(number(value) for value in one["retention_factor"].values())
        for one in (plain, tapered)
    )
    assert len(first) == 3
    assert second == pytest.approx(first, rel=1e-5)
    for metric in ("retention_burst_factor", "mass", "bond_thermal_factor"):
        for place, value in plain[metric].items():
            assert number(tapered[metric][place]) == pytest.approx(number(value), rel=1e-5)


def test_a_thin_tip_peels_less():
    """At the same shear, peel falls with the fourth root of the tip's thickness."""
    plain, tapered = (metrics(text_of(block))["retention_factor"] for block in (BOND, TAPERED))
    by_shear = number(tapered["tapered bond at the skirt's tip"]) / number(
        plain["bond at the skirt's edge"]
    )
    by_peel = number(tapered["peel of the plies at the skirt's tip"]) / number(
        plain["peel of the plies at the skirt's edge"]
    )
    assert by_shear > 1.1
    assert by_peel / by_shear == pytest.approx(0.25**-0.25, rel=1e-9)


def test_force_and_heat_together_need_an_end_of_full_wall():
    """With plastic strain the criterion of `bond` is a bound; a long taper is warned of."""
    ductile = "materials:\n  epoxy_structural:\n    plastic_shear_strain: 0.1\n"
    plain, tapered = (metrics(text_of(block) + ductile) for block in (BOND, TAPERED))
    for word in ("cold", "hot"):
        place = f"with temperature, {word}"
        first, second = (one["retention_burst_factor"][place] for one in (plain, tapered))
        assert number(second) == number(first)
    short, long = (
        [
            warning
            for warning in ao.evaluate(
                ao.read(text_of(TAPERED.replace("8 mm", taper)) + ductile)
            ).warnings
            if "together" in warning
        ]
        for taper in ("8 mm", "16 mm")
    )
    assert short == []
    assert len(long) == 1


def test_a_taper_longer_than_its_skirt_is_refused():
    """One line with place and remedy; a tip outside its range too."""
    ((path, message),) = faults(text_of(TAPERED.replace("8 mm", "21 mm")))
    assert path == "retention.taper_length"
    assert "longer than the skirt" in message
    for tip in ("0", "1.2"):
        ((path, message),) = faults(text_of(TAPERED.replace("0.25", tip)))
        assert path == "retention.tip"


# --- double ---------------------------------------------------------------------------------


def test_the_mass_of_a_double_lap_by_hand():
    """Both skirts, the barrel beside the cap's, and the head's plug within its skirt."""
    plain = ao.evaluate(ao.read(text_of(BOND.replace("20 mm", "12 mm")))).mass_parts
    double = ao.evaluate(ao.read(text_of(DOUBLE))).mass_parts
    density, length, bore = 2810.0, 12e-3, 11.5e-3
    skirt = density * pi * (bore**2 - (bore - 1e-3) ** 2) * length
    assert double["caps"] - plain["caps"] == pytest.approx(2 * skirt, rel=1e-9)
    cut = density * pi * (bore**2 - (bore - 2e-3) ** 2) * 14e-3
    assert plain["glands"] - double["glands"] == pytest.approx(cut, rel=1e-9)
    longer = 1 + length / (110e-3 + 14e-3 + 14e-3)
    assert double["barrel"] == pytest.approx(longer * plain["barrel"], rel=1e-9)


def test_the_actuator_grows_by_the_caps_inner_skirt():
    """Closed length and barrel are longer by the skirt, which lies beyond the chamber."""
    plain, double = (metrics(text_of(block)) for block in (BOND.replace("20 mm", "12 mm"), DOUBLE))
    for metric in ("closed_length", "barrel_length"):
        (first,), (second,) = plain[metric].values(), double[metric].values()
        assert number(second) - number(first) == pytest.approx(12e-3, rel=1e-9)


def test_both_skirts_carry_the_force():
    """The forces in both skirts, by their yield factors, add up to that of one skirt."""
    factors = metrics(text_of(DOUBLE))["yield_factor"]
    walls = {"outer skirt": (14.1e-3, 1.5e-3), "inner skirt": (10.5e-3, 1e-3)}
    force = sum(  # divided by the yield strength
        pi * wall * (2 * radius + wall) / number(factors[place])
        for place, (radius, wall) in walls.items()
    )
    plain = number(metrics(KNEE)["yield_factor"]["cap skirt"])
    assert force == pytest.approx(2 * pi * 14.1e-3 * 1.5e-3 / plain, rel=1e-9)


def test_one_end_alone():
    """A double lap at the cap alone leaves the head's plug as it is."""
    indented = "".join(f"  {line}\n" for line in DOUBLE.splitlines())
    other = "".join(f"  {line}\n" for line in BOND.splitlines())
    text = text_of(f"  cap:\n{indented}  head:\n{other}")
    parts, plain = (ao.evaluate(ao.read(one)).mass_parts for one in (text, KNEE))
    assert parts["glands"] == plain["glands"]
    assert "geometry_inner_skirt" not in metrics(text)
    assert faults(text_of(f"  cap:\n{other}  head:\n{indented}".replace("12 mm", "15 mm"))) == [
        (
            "retention.head.length",
            "15 mm: the inner skirt is longer than the head's plug, of 14 mm, so the piston would "
            "meet it",
        )
    ]


def test_an_inner_skirt_that_does_not_fit_is_refused():
    """Between bore and rod there must be skirt, slot and plug; the piston must not meet it."""
    ((path, message),) = faults(text_of(DOUBLE.replace("1 mm", "3.5 mm")))
    assert path == "retention.inner_wall"
    assert "do not fit" in message
    ((path, message),) = faults(text_of(DOUBLE.replace("12 mm", "15 mm")))
    assert path == "retention.length"


def test_pressure_opens_the_bond_of_a_thick_inner_skirt():
    """Skirt alone: p r^2/(E t). Barrel of aluminium: p r_i R (1 - nu^2)/(E s (1 - nu^2)).

    Bore radius 11.5 mm, barrel of 2 mm, R 12.5 mm: the limit is r^2/t = r_i R/s, or t 1.57 mm.
    """
    start = KNEE.index("    - material: al_7075_t6")
    metal = KNEE[:start] + "    - material: al_7075_t6\n      thickness: 2 mm\n"
    metal += KNEE[KNEE.index("\nrod:\n") :]
    warned = []
    for wall in ("1.5 mm", "1.65 mm"):
        block = DOUBLE.replace("inner_wall: 1 mm", f"inner_wall: {wall}")
        evaluation = ao.evaluate(ao.read(metal.replace(BOND, block)))
        warned.append(any("pressure opens" in warning for warning in evaluation.warnings))
    assert warned == [False, True]


def test_oil_in_the_bore_of_the_inner_skirt():
    """Pi 10.5 mm^2 x 12 mm = 4.16 ml must be within the dead volume of chamber A."""
    text = text_of(DOUBLE)
    small, large = (
        [line for line in ao.evaluate(ao.read(one)).warnings if "encloses" in line]
        for one in (text, text.replace("dead_volume_a: 3 ml", "dead_volume_a: 4.2 ml"))
    )
    assert len(small) == 1
    assert "4.2 ml" in small[0]
    assert large == []


@pytest.mark.parametrize("form", ["bond", "double_lap", "tapered_lap"])
def test_a_choice_among_the_forms(form):
    """`choices: retention.type` lists all forms, whose keys stand together; a PATH picks one."""
    keys = "  inner_wall: 1 mm\n  tip: 0.3\n  taper_length: 6 mm\n"
    block = BOND.replace("20 mm", "12 mm") + keys
    choices = "choices:\n  retention.type: [bond, double_lap, tapered_lap]\n"
    chosen = ao.read(text_of(block) + choices).changed({"retention.type": form})
    subject = chosen.subject()
    places = compute(subject, subject.values()).computed.metrics["retention_factor"]
    assert all(("retention_factor", place) in JOINTS[form].models for place in places)
