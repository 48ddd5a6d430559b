"""Claims about gland geometry and the registry of O-ring laws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import gland, seals

NAMES = list(seals.LAWS)
UNIT = {"section": 1.0, "youngs_modulus": 1.0}


def at(law, quantity, squeeze, pressure=0.0):
    """Evaluate a law at W = 1, E = 1."""
    return getattr(seals.LAWS[law], quantity)(squeeze=squeeze, pressure=pressure, **UNIT)


CHECKS = [  # law, quantity, value per W, E = 1 at C = 0.12, at 0.18
    ("chord", "contact_width", 0.474974, 0.572364),
    ("stadium", "contact_width", 0.201348, 0.313776),
    ("hertz_lindley", "contact_width", 0.315475, 0.430769),
    ("hertz_lindley", "peak_pressure", 0.210317, 0.287179),
    ("hertz_lindley", "line_load", 0.0521108, 0.0971600),
    ("plane_strain", "contact_width", 0.37, 0.49),
    ("plane_strain", "line_load", 0.0694811, 0.129547),
    ("plane_strain", "peak_pressure", 0.239098, 0.336620),
]


@pytest.mark.parametrize(("law", "quantity", "at_12", "at_18"), CHECKS)
def test_unpressurised_check_values(law, quantity, at_12, at_18):
    """Width, load and peak pressure per W with E = 1, computed independently."""
    assert at(law, quantity, 0.12) == pytest.approx(at_12, abs=6e-7)
    assert at(law, quantity, 0.18) == pytest.approx(at_18, abs=6e-7)


def test_pressure_terms():
    """Pressure adds k_p p W (0.72, 0.76, 0.80) or p b to the load, and widens plane_strain only.

    chord and stadium carry f = p b and nothing at zero pressure.
    """
    p = 0.5
    for squeeze, share in ((0.10, 0.72), (0.15, 0.72), (0.175, 0.76), (0.20, 0.80), (0.3, 0.80)):
        rise = at("plane_strain", "line_load", squeeze, p) - at(
            "plane_strain", "line_load", squeeze
        )
        assert rise == pytest.approx(share * p)
    widen = at("plane_strain", "contact_width", 0.15, p) - at("plane_strain", "contact_width", 0.15)
    assert widen == pytest.approx(0.32 * (1 - math.exp(-1.05)))
    width = at("hertz_lindley", "contact_width", 0.15)
    assert at("hertz_lindley", "contact_width", 0.15, p) == width
    rise = at("hertz_lindley", "line_load", 0.15, p) - at("hertz_lindley", "line_load", 0.15)
    assert rise == pytest.approx(p * width)
    for law in ("chord", "stadium"):
        assert at(law, "line_load", 0.15, p) == p * at(law, "contact_width", 0.15)
        assert at(law, "line_load", 0.15) == 0.0


def test_plane_strain_width_reaches_the_finite_element_value():
    """b/W grows from 0.43 to 0.71 as p -> E at C = 0.15; finite elements 0.42 to 0.74 (6 %)."""
    assert at("plane_strain", "contact_width", 0.15) == pytest.approx(0.42, rel=0.06)
    assert at("plane_strain", "contact_width", 0.15, 1.0) == pytest.approx(0.74, rel=0.06)


def test_laws_differ_by_a_third_and_more_under_pressure():
    """Default over hertz_lindley: 4/3 at p = 0; the peak under pressure is named by law."""
    ratio = at("plane_strain", "line_load", 0.15) / at("hertz_lindley", "line_load", 0.15)
    assert ratio == pytest.approx(4 / 3)
    ratio = at("plane_strain", "line_load", 0.15, 1.0) / at("hertz_lindley", "line_load", 0.15, 1.0)
    assert ratio == pytest.approx(1.8, abs=0.1)


@pytest.mark.parametrize("law", NAMES)
@given(st.floats(1e-3, 0.4), st.floats(1e-4, 0.04), st.floats(0, 2))
def test_every_law_grows_with_squeeze_and_pressure(law, squeeze, more, pressure):
    """More squeeze or pressure never means less width, load or peak pressure; all positive."""
    for quantity in ("line_load", "contact_width", "peak_pressure"):
        value = at(law, quantity, squeeze, pressure)
        assert value >= 0
        assert at(law, quantity, squeeze, pressure + 0.1) >= value
        if quantity != "peak_pressure":
            assert at(law, quantity, squeeze + more, pressure) >= value * (1 - 1e-12)


@pytest.mark.parametrize("law", NAMES)
def test_every_law_scales_with_section_and_modulus(law):
    """Load scales with W, E; width with W; peak with E, at equal p/E (similarity)."""
    entry = seals.LAWS[law]
    one = {"squeeze": 0.14, "section": 2e-3, "youngs_modulus": 6e6, "pressure": 3e6}
    big = {"squeeze": 0.14, "section": 6e-3, "youngs_modulus": 12e6, "pressure": 6e6}
    assert entry.line_load(**big) == pytest.approx(6 * entry.line_load(**one))
    assert entry.contact_width(**big) == pytest.approx(3 * entry.contact_width(**one))
    assert entry.peak_pressure(**big) == pytest.approx(2 * entry.peak_pressure(**one))


@pytest.mark.parametrize("law", NAMES)
@pytest.mark.parametrize("kind", [float, complex])
def test_every_law_without_squeeze_has_no_contact(law, kind):
    """C <= 0 gives zero width, load and peak, never NaN, also with pressure and a complex step."""
    squeeze = np.array([-0.2, -1e-9, 0.0], dtype=kind)
    for quantity in ("line_load", "contact_width", "peak_pressure"):
        np.testing.assert_array_equal(at(law, quantity, squeeze, 0.7), 0.0)


@pytest.mark.parametrize("law", NAMES)
def test_every_law_is_named_with_source_and_range(law):
    """The registry key is the law's name; source and squeeze range are stated and usable."""
    entry = seals.LAWS[law]
    assert entry.name == law
    assert entry.reference.startswith("[")
    low, high = entry.squeeze_range
    inside = entry.in_range(
        squeeze=np.array([low - 0.01, low, high, high + 0.01]), youngs_modulus=6e6, pressure=1e6
    )
    np.testing.assert_array_equal(inside, [False, True, True, False])
    assert not entry.in_range(squeeze=low, youngs_modulus=6e6, pressure=1e9)


def test_published_width_is_the_chord_law_and_ends_at_2r():
    """[ElAsswad2018] eq. 19 equals `chord`; h >= 2R gives zero, not NaN."""
    widths = seals.width_as_published(section=2e-3, gland_height=np.array([1.7e-3, 2e-3, 2.2e-3]))
    law = seals.LAWS["chord"].contact_width(
        squeeze=0.15, section=2e-3, youngs_modulus=1.0, pressure=0.0
    )
    np.testing.assert_allclose(widths, [law, 0.0, 0.0], rtol=1e-12)


def test_published_width_is_too_wide():
    """The chord is 38 % wider than 2C + 0.13 ... 0.33 at C = 0.10, about 15 % at 0.20."""
    over = [at("chord", "contact_width", c) / (2 * c + 0.13) - 1 for c in (0.10, 0.20)]
    assert over[0] == pytest.approx(0.38, abs=0.07)  # the source compares with its own FEM (5 %)
    assert over[1] == pytest.approx(0.15, abs=0.06)


def test_groove_width_of_an_eighth_inch_ring():
    """3.531 mm: within the tabulated 4.750 to 4.877 mm of a reciprocating gland; NaN without W."""
    assert 4.750e-3 <= gland.groove_width(section=3.531e-3) <= 4.877e-3
    assert math.isnan(gland.groove_width(section=0.0))


def test_squeeze_loses_growth_and_tolerance():
    """C = C0 - (u + tol)/W."""
    arguments = {"squeeze": 0.15, "section": 2e-3, "growth": 40e-6, "tolerance": 50e-6}
    assert gland.squeeze_after(**arguments) == pytest.approx(0.105)


@given(st.floats(0, 0.25))
def test_stretch_thins_the_ring(stretch):
    """Stretch keeps the ring's volume."""
    thin = gland.stretched_section(section=2e-3, stretch=stretch)
    assert thin**2 * (1 + stretch) == pytest.approx(4e-6)


@pytest.mark.parametrize(
    ("section", "width", "depth", "squeeze", "fill"),
    [(1.78, 2.3, 1.5, 15.7, 72.1), (2.62, 3.1, 2.3, 12.2, 75.6), (3.53, 4.2, 3.1, 12.2, 75.2)],
)
def test_metric_gland_table(section, width, depth, squeeze, fill):
    """Squeeze and fill of published dynamic glands (mm, %)."""
    value = gland.gland_fill(
        section=section * 1e-3, groove_width=width * 1e-3, gland_depth=depth * 1e-3
    )
    assert value * 100 == pytest.approx(fill, abs=0.06)
    assert gland.gland_depth(squeeze=squeeze / 100, section=section) == pytest.approx(
        depth, abs=1e-3 * section
    )


def test_limits_of_gap_and_width():
    """The gap is clearance plus growth; the contact is no wider than the groove."""
    assert gland.extrusion_gap(clearance=3e-5, growth=1.9e-5) == pytest.approx(4.9e-5)
    np.testing.assert_array_equal(
        gland.limited_width(contact_width=np.array([1e-3, 5e-3]), groove_width=2e-3), [1e-3, 2e-3]
    )
