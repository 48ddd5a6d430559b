"""Closed forms beside the finite elements they stand for; designs that state their contact."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_runner import KNEE, run

import actuator_opt as ao
from actuator_opt.api import seal
from actuator_opt.evaluation.kernel import base
from actuator_opt.evaluation.rings import seal_contact
from actuator_opt.finite_elements.material import MooneyRivlin
from actuator_opt.finite_elements.o_ring import squeezed_ring
from actuator_opt.models.contact_profile import o_ring_profile

SECTION, MODULUS, GROOVE = 3.53e-3, 8e6, 4.82e-3


@pytest.mark.long
@pytest.mark.parametrize("squeeze", [0.10, 0.15, 0.20])
def test_the_closed_profile_follows_the_elements(squeeze):
    """1 - t^10 with the mounted ellipse: within 0.15 p everywhere, mean 0.88 to 0.94 p."""
    mounted, *pressed = squeezed_ring(
        section=SECTION,
        squeeze=squeeze,
        groove_width=GROOVE,
        rubber=MooneyRivlin.of_modulus(MODULUS),
        pressures=[0.5 * MODULUS, MODULUS],
        elements_around=64,
    ).contacts
    assert len(pressed) == 2
    for contact in pressed:
        share = contact.positions / contact.width
        closed = o_ring_profile(
            position=share,
            sealed_pressure=contact.pressure,
            outer_pressure=0.0,
            excess=mounted.peak_pressure,
        )
        apart = (contact.contact_pressure - closed) / contact.pressure
        assert np.max(np.abs(apart)) < 0.15
        ellipse = mounted.peak_pressure * np.sqrt(np.maximum(4 * share * (1 - share), 0.0))
        energised = (contact.contact_pressure - ellipse) / contact.pressure
        assert 0.88 < np.trapezoid(energised, share) < 0.94


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """The knee's rod seal by half as many elements from the command line: JSON, what it saved."""
    path = tmp_path_factory.mktemp("saved") / "knee_bonded.yaml"
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(squeezed_ring.__kwdefaults__, "elements_around", 64)
        result = run("seal", KNEE, "--seal", "rod", "--finite-elements", "--write", path, "--json")
    assert result.code == 0
    return json.loads(result.out), path


@pytest.mark.long
def test_friction_by_elements_is_near_that_of_the_closed_form(solved):
    """Film, coefficient and breakaway of the knee's rod O-ring agree within 30 %."""
    found, _ = solved
    closed = seal(KNEE, place="rod").to_dict()
    for stroke in ("out", "in"):
        for name in ("total", "by_coefficient", "breakaway"):
            assert found["friction"][stroke][name] == pytest.approx(
                closed["friction"][stroke][name], rel=0.3
            )
    assert "finite_elements" not in closed


def test_json_carries_the_elements(solved):
    """Five pressures up to the supply's; the last one's load and width are the contact's."""
    found, _ = solved
    rows = found["finite_elements"]
    assert [row["pressure"] for row in rows] == pytest.approx([0, 5.25e6, 10.5e6, 15.75e6, 21e6])
    (contact,) = found["contact"]
    assert contact["width"] == pytest.approx(rows[-1]["width"], abs=1e-8)  # to 10 nm
    assert contact["peak_pressure"] == pytest.approx(rows[-1]["peak_pressure"], rel=5e-3)
    assert contact["line_load"] == pytest.approx(rows[-1]["line_load"], rel=0.02)
    assert all(0 < row["von_mises"] < row["peak_pressure"] for row in rows)


def test_a_saved_contact_is_read_again(solved):
    """`check` accepts the saved design, `evaluate` reads its contact: same loads, same friction."""
    found, path = solved
    changes = {"seals.rod.friction": "coefficient"}  # the films of all load cases take longer
    assert ao.check(path, set=changes) == []
    actuator = ao.read(path, set=changes)
    assert ao.evaluate(actuator).metrics["friction_running"].value > 0
    subject = actuator.subject()
    rings = base(subject, subject.values()).rings
    ring = next(one for one in rings if one.name == "rod")
    at_supply = seal_contact(ring.at(pressure=21e6))
    (contact,) = found["contact"]
    assert float(np.max(at_supply.line_load)) == pytest.approx(contact["line_load"], rel=1e-12)
    profiles = actuator.design.seals.rod.contact
    assert [one.pressure for one in profiles] == [r["pressure"] for r in found["finite_elements"]]
    again = seal(path, place="rod").to_dict()
    assert again["contact"] == found["contact"]
    for stroke in ("out", "in"):
        assert again["friction"][stroke] == pytest.approx(found["friction"][stroke], rel=1e-9)


def test_a_seal_without_elements_says_so(tmp_path):
    """A U-cup has none: one clear line with its remedy."""
    text = KNEE.read_text(encoding="utf-8")
    head, tail = text.split("  rod:\n    type: o_ring\n", 1)
    end = tail.index("\nload:")
    cup = (
        "  rod:\n    type: u_cup\n    compound: pu_94_u_cup\n    section: 4 mm\n"
        "    squeeze: 10 %\n    thickness: 1.3 mm\n    width: 4 mm\n    groove_width: 6 mm\n"
    )
    path = tmp_path / "cup.yaml"
    path.write_text(head + cup + tail[end:], encoding="utf-8")
    with pytest.raises(ao.ActuatorError, match="finite elements are not available for a u_cup"):
        seal(path, place="rod", finite_elements=True)
