"""Claims about the axial stiffness, with the thesis' 40/25-220 cylinder rebuilt."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import forces, lines, stiffness, stiffness_published

# [AaltoThesis] test cylinder; barrel OD 50, rod 320 mm assumed (the thesis prints neither).
BORE, ROD, STROKE = 0.040, 0.025, 0.220
AREA_A = forces.piston_area(bore=BORE)
AREA_B = forces.annulus_area(bore=BORE, rod_diameter=ROD)
STEEL = {"youngs_modulus": 210e9, "poissons_ratio": 0.3}
HOSE = {
    "inner_diameter": 9.5e-3,
    "outer_diameter": 12e-3,
    "youngs_modulus": 17.8e9,
    "poissons_ratio": 0.3,
}
ROD_STIFFNESS = 210e9 * math.pi * ROD**2 / 4 / 0.320
CELL = 106e6
PIPE = lines.line_volume(inner_diameter=9.5e-3, length=0.1)
POSITIONS = np.array([0.005, 0.110, 0.215])


def volumes(x, line_a, line_b):
    """Chamber volumes with lines."""
    return AREA_A * x + line_a, AREA_B * (STROKE - x) + line_b


def barrel_as_published(x):
    """Eq. 22 and 23."""
    wall = {"bore": BORE, "outer_diameter": 0.050, **STEEL}
    head = stiffness_published.barrel_stiffness_as_published(area=AREA_A, chamber_length=x, **wall)
    rod = stiffness_published.barrel_stiffness_as_published(
        area=AREA_B, chamber_length=STROKE - x, **wall
    )
    return head, rod


def oil(x, modulus, line_a, line_b):
    """Eq. 6 with one bulk modulus."""
    v_a, v_b = volumes(x, line_a, line_b)
    return stiffness_published.oil_stiffness_as_published(
        bulk_modulus_a=modulus,
        bulk_modulus_b=modulus,
        area_a=AREA_A,
        area_b=AREA_B,
        volume_a=v_a,
        volume_b=v_b,
    )


def test_aalto_minimum_without_lines():
    """40/25-220, K 1600 MPa, rigid walls: minimum 28.98 MN/m at x = 123.6 mm."""
    per_a, per_b = AREA_A / 1.6e9, AREA_B / 1.6e9
    x = stiffness.weakest_position(
        area_a=AREA_A,
        area_b=AREA_B,
        compliance_a0=0.0,
        compliance_a_per_length=per_a,
        compliance_b0=0.0,
        compliance_b_per_length=per_b,
        stroke=STROKE,
    )
    k = stiffness.hydraulic_stiffness(
        area_a=AREA_A,
        compliance_a=per_a * x,
        area_b=AREA_B,
        compliance_b=per_b * (STROKE - x),
    )
    assert x * 1e3 == pytest.approx(123.6, abs=0.05)
    assert k / 1e6 == pytest.approx(28.98, abs=0.005)


def test_aalto_oil_with_pipes():
    """With 0.1 m x 9.5 mm pipes: 194.4/27.7/95.1 MN/m at 5/110/215 mm."""
    k = oil(POSITIONS, 1.6e9, PIPE, PIPE) / 1e6
    np.testing.assert_allclose(k, [194.4, 27.7, 95.1], atol=0.05)


def test_aalto_literal_eq_37():
    """Literal eq. 37 with load cell: 56.0/19.5/42.8 MN/m."""
    k = stiffness_published.series_of_totals_as_published(
        oil=oil(POSITIONS, 1.6e9, PIPE, PIPE),
        barrel=sum(barrel_as_published(POSITIONS)),
        rod=ROD_STIFFNESS,
        other=CELL,
    )
    np.testing.assert_allclose(k / 1e6, [56.0, 19.5, 42.8], atol=0.05)


def hose_circuit():
    """Hoses H7, H8 beside the pipes; K 1300 MPa, air compensated."""
    line_a = PIPE + lines.line_volume(inner_diameter=9.5e-3, length=0.6)
    line_b = PIPE + lines.line_volume(inner_diameter=9.5e-3, length=0.8)
    hose_a = lines.line_compliance(length=0.6, **HOSE)
    hose_b = lines.line_compliance(length=0.8, **HOSE)
    return line_a, line_b, hose_a, hose_b


def test_aalto_literal_eq_38():
    """Literal eq. 38: 20.5/11.33/12.4 MN/m with the cell, 25.46/12.68/14.10 without."""
    line_a, line_b, _, _ = hose_circuit()
    hoses = stiffness_published.line_stiffness_as_published(
        area=AREA_A, length=0.6, **HOSE
    ) + stiffness_published.line_stiffness_as_published(area=AREA_B, length=0.8, **HOSE)
    arguments = {
        "oil": oil(POSITIONS, 1.3e9, line_a, line_b),
        "barrel": sum(barrel_as_published(POSITIONS)),
        "rod": ROD_STIFFNESS,
        "lines": hoses,
    }
    with_cell = stiffness_published.series_of_totals_as_published(**arguments, other=CELL)
    without = stiffness_published.series_of_totals_as_published(**arguments)
    np.testing.assert_allclose(with_cell / 1e6, [20.5, 11.33, 12.4], atol=0.05)
    np.testing.assert_allclose(without / 1e6, [25.46, 12.68, 14.10], atol=0.005)


@pytest.mark.parametrize(
    ("rod_side", "expected"),
    [("eq. 23", [24.78, 12.59, 12.30]), ("derived", [24.73, 12.52, 12.29])],
)
def test_aalto_per_chamber_with_hoses(rod_side, expected):
    """Per chamber without the cell, barrel by eq. 23 as printed and as A_B^2/(dV/dp).

    The overview's row with the cell, 20.1/11.20/11.0, belongs to the derived form (11.20 at
    mid-stroke; eq. 23 gives 11.25).
    """
    line_a, line_b, hose_a, hose_b = hose_circuit()
    v_a, v_b = volumes(POSITIONS, line_a, line_b)
    wall = {"inner_diameter": BORE, "outer_diameter": 0.050, **STEEL}
    barrel_a = lines.line_compliance(length=POSITIONS, **wall)
    barrel_b = lines.line_compliance(length=STROKE - POSITIONS, **wall)
    if rod_side == "eq. 23":
        barrel_b = AREA_B**2 / barrel_as_published(POSITIONS)[1]
    k_h = stiffness.hydraulic_stiffness(
        area_a=AREA_A,
        compliance_a=stiffness.chamber_compliance(
            volume=v_a, bulk_modulus=1.3e9, wall_compliance=barrel_a + hose_a
        ),
        area_b=AREA_B,
        compliance_b=stiffness.chamber_compliance(
            volume=v_b, bulk_modulus=1.3e9, wall_compliance=barrel_b + hose_b
        ),
    )
    np.testing.assert_allclose(stiffness.series(k_h, ROD_STIFFNESS) / 1e6, expected, atol=0.0051)
    if rod_side == "derived":
        np.testing.assert_allclose(
            stiffness.series(k_h, ROD_STIFFNESS, CELL) / 1e6, [20.1, 11.20, 11.0], atol=0.051
        )


def test_eq_23_is_too_stiff_by_the_area_ratio():
    """[AaltoThesis] eq. 23 over A_B^2/(dV/dp) is A_A/A_B = 1.64; eq. 22 is exact."""
    head, rod = barrel_as_published(0.110)
    compliance = lines.line_compliance(
        inner_diameter=BORE, outer_diameter=0.050, length=0.110, **STEEL
    )
    assert head == pytest.approx(AREA_A**2 / compliance, rel=1e-12)
    assert rod / (AREA_B**2 / compliance) == pytest.approx(AREA_A / AREA_B, rel=1e-12)
    ratio = AREA_A / AREA_B
    assert ratio == pytest.approx(1.64, abs=0.005)


# The 32/18-160 cylinder of the check values: V_0 8 ml each side, K 1.4 GPa.
D2, d2, S2, V2, K2 = 0.032, 0.018, 0.160, 8e-6, 1.4e9
A2, B2 = forces.piston_area(bore=D2), forces.annulus_area(bore=D2, rod_diameter=d2)


def chambers(x, wall_a=0.0, wall_b=0.0, extra=0.0):
    """Compliances of both chambers."""
    c_a = stiffness.chamber_compliance(
        volume=V2 + extra + A2 * x, bulk_modulus=K2, wall_compliance=wall_a
    )
    c_b = stiffness.chamber_compliance(
        volume=V2 + extra + B2 * (S2 - x), bulk_modulus=K2, wall_compliance=wall_b
    )
    return c_a, c_b


def rigid_weakest():
    """Weakest position of the 32/18-160 cylinder with rigid walls."""
    return stiffness.weakest_position(
        area_a=A2,
        area_b=B2,
        compliance_a0=V2 / K2,
        compliance_a_per_length=A2 / K2,
        compliance_b0=V2 / K2,
        compliance_b_per_length=B2 / K2,
        stroke=S2,
    )


def test_rigid_check_cylinder():
    """32/18-160: 42.5779/20.6583/29.7857 MN/m at 20/80/140 mm, minimum 20.3660 at 91.048 mm."""
    x = np.array([0.020, 0.080, 0.140])
    c_a, c_b = chambers(x)
    k = stiffness.hydraulic_stiffness(area_a=A2, compliance_a=c_a, area_b=B2, compliance_b=c_b)
    np.testing.assert_allclose(k / 1e6, [42.5779, 20.6583, 29.7857], rtol=3e-6)
    weak = rigid_weakest()
    assert weak * 1e3 == pytest.approx(91.048, abs=6e-4)
    c_a, c_b = chambers(weak)
    k = stiffness.hydraulic_stiffness(area_a=A2, compliance_a=c_a, area_b=B2, compliance_b=c_b)
    assert k / 1e6 == pytest.approx(20.3660, rel=3e-6)


def test_elastic_check_cylinder_and_its_published_form():
    """With barrel and hoses: 12.746/9.5686/9.5194 per chamber, 13.137/9.5877/10.126 as totals."""
    x = np.array([0.020, 0.080, 0.140])
    wall = {
        "inner_diameter": 0.032,
        "outer_diameter": 0.040,
        "youngs_modulus": 71.7e9,
        "poissons_ratio": 0.33,
    }
    barrel_a = lines.line_compliance(length=x, **wall)
    barrel_b = lines.line_compliance(length=S2 - x, **wall)
    hose = lines.line_compliance(length=0.5, **HOSE)
    extra = lines.line_volume(inner_diameter=9.5e-3, length=0.5)
    c_a, c_b = chambers(x, barrel_a + hose, barrel_b + hose, extra)
    k = stiffness.hydraulic_stiffness(area_a=A2, compliance_a=c_a, area_b=B2, compliance_b=c_b)
    np.testing.assert_allclose(k / 1e6, [12.746, 9.5686, 9.5194], rtol=5e-5)
    totals = stiffness_published.series_of_totals_as_published(
        oil=stiffness_published.oil_stiffness_as_published(
            bulk_modulus_a=K2,
            bulk_modulus_b=K2,
            area_a=A2,
            area_b=B2,
            volume_a=V2 + extra + A2 * x,
            volume_b=V2 + extra + B2 * (S2 - x),
        ),
        barrel=A2**2 / barrel_a + B2**2 / barrel_b,
        rod=math.inf,
        lines=(A2**2 + B2**2) / hose,
    )
    np.testing.assert_allclose(totals / 1e6, [13.137, 9.5877, 10.126], rtol=5e-5)


def test_chamber_stiffnesses_add_up():
    """k_h is the sum of the two chamber stiffnesses."""
    c_a, c_b = chambers(0.08)
    parts = [
        stiffness.chamber_stiffness(area=a, volume=c * K2, bulk_modulus=K2, wall_compliance=0.0)
        for a, c in ((A2, c_a), (B2, c_b))
    ]
    total = stiffness.hydraulic_stiffness(area_a=A2, compliance_a=c_a, area_b=B2, compliance_b=c_b)
    assert sum(parts) == pytest.approx(total)


positive = st.floats(0.05, 20)


@given(positive, positive, positive, positive, st.floats(0, 5), st.floats(0, 5))
def test_weakest_position_beats_a_grid(area_a, area_b, slope_a, slope_b, start_a, start_b):
    """No point of the stroke is softer than the closed-form position, clipped or not."""
    start_a, start_b = start_a + 1e-3, start_b + 1e-3
    weak = stiffness.weakest_position(
        area_a=area_a,
        area_b=area_b,
        compliance_a0=start_a,
        compliance_a_per_length=slope_a,
        compliance_b0=start_b,
        compliance_b_per_length=slope_b,
        stroke=1.0,
    )
    x = np.append(np.linspace(0, 1, 101), weak)
    k = stiffness.hydraulic_stiffness(
        area_a=area_a,
        compliance_a=start_a + slope_a * x,
        area_b=area_b,
        compliance_b=start_b + slope_b * (1 - x),
    )
    assert 0 <= weak <= 1
    assert k[-1] <= k.min() * (1 + 1e-12)


def test_weakest_position_matches_the_rigid_rule():
    """Without walls the minimum is where (a + x)/(b + s - x) = sqrt(A_A/A_B)."""
    weak = rigid_weakest()
    ratio = (V2 / A2 + weak) / (V2 / B2 + S2 - weak)
    assert ratio == pytest.approx(math.sqrt(A2 / B2), rel=1e-12)


@given(st.lists(st.floats(1e3, 1e9), min_size=1, max_size=5))
def test_series_is_never_stiffer_than_its_softest_part(parts):
    """Series stiffness <= the softest spring; a rigid part changes nothing."""
    total = stiffness.series(*parts)
    assert total <= min(parts) * (1 + 1e-12)
    assert stiffness.series(*parts, math.inf) == pytest.approx(total)


def test_totals_in_series_overstate_hosed_cylinders():
    """With hoses the published series of totals is up to 13 % off the per-chamber form."""
    line_a, line_b, hose_a, hose_b = hose_circuit()
    v_a, v_b = volumes(POSITIONS, line_a, line_b)
    wall = {"inner_diameter": BORE, "outer_diameter": 0.050, **STEEL}
    swell_a = lines.line_compliance(length=POSITIONS, **wall) + hose_a
    swell_b = lines.line_compliance(length=STROKE - POSITIONS, **wall) + hose_b
    chambers_in_parallel = stiffness.chamber_stiffness(
        area=AREA_A, volume=v_a, bulk_modulus=1.3e9, wall_compliance=swell_a
    ) + stiffness.chamber_stiffness(
        area=AREA_B, volume=v_b, bulk_modulus=1.3e9, wall_compliance=swell_b
    )
    totals = stiffness_published.series_of_totals_as_published(
        oil=oil(POSITIONS, 1.3e9, line_a, line_b),
        barrel=sum(barrel_as_published(POSITIONS)),
        rod=ROD_STIFFNESS,
        lines=AREA_A**2 / hose_a + AREA_B**2 / hose_b,
        other=CELL,
    )
    excess = totals / stiffness.series(chambers_in_parallel, ROD_STIFFNESS, CELL) - 1
    assert np.max(excess) == pytest.approx(0.13, abs=0.005)
    assert np.all(excess > 0)


def test_holding_pressures_balance_the_load():
    """p_A A_A - p_B A_B = F and p_A + p_B = p_s + p_r for a load within reach."""
    for force in (-3000.0, 0.0, 4000.0):
        p_a, p_b = stiffness.holding_pressures(
            force=force, supply_pressure=1.4e7, return_pressure=2e5, area_a=A2, area_b=B2
        )
        assert p_a * A2 - p_b * B2 == pytest.approx(force, abs=1e-6)
        assert p_a + p_b == pytest.approx(1.42e7)


@given(st.floats(-1e6, 1e6))
def test_holding_pressures_stay_between_return_and_supply(force):
    """Beyond stall the chambers stop at the supply and return pressures."""
    for pressure in stiffness.holding_pressures(
        force=force, supply_pressure=1.4e7, return_pressure=2e5, area_a=A2, area_b=B2
    ):
        assert 2e5 - 1e-6 <= pressure <= 1.4e7 + 1e-6
