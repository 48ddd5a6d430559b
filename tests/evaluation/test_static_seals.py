"""Static seals of the ends: lengths, masses, gland rows and refusals, by hand."""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest
from shipped import PLAIN_KNEE

import actuator_opt as ao
from actuator_opt.base.errors import InputError

DESIGNS = Path(__file__).parents[2] / "designs"
STATIC = """  static:                       # in cap and head, against the bore
    compound: nbr_90
    section: 1.78 mm
    squeeze: 20 %
    tolerance: 0.05 mm
"""
W, DEPTH = 1.78e-3, 0.8 * 1.78e-3
WIDTH = 1.3655 * W
SPIGOT = WIDTH + 2e-3


KNEE = PLAIN_KNEE.replace("    pitch: 0.75", "    diameter: 23 mm\n    pitch: 0.75")
"""The knee with a thread of its own size, whatever rings pass it."""


def text_of(name):
    """The text of a shipped design."""
    return KNEE if name == "knee" else (DESIGNS / f"{name}.yaml").read_text("utf-8")


def pair(name):
    """A shipped design with its static seals, and the same without them."""
    text = text_of(name)
    assert STATIC in text
    return ao.evaluate(ao.read(text)), ao.evaluate(ao.read(text.replace(STATIC, "")))


def near(value, rel=1e-9):
    """Equal up to rounding."""
    return pytest.approx(value, rel=rel)


def rings(bore):
    """Mass of both O-rings on the diameter of their groove's middle."""
    return 2 * 1250.0 * pi / 4 * W**2 * pi * (bore - DEPTH)


def test_a_screwed_cap_has_a_spigot():
    """Barrel, actuator and cap are longer by it; cap and head lose the metal of the grooves."""
    sealed, bare = pair("steel_baseline")
    bore, outer = 23e-3, 27e-3
    assert sealed.metrics["closed_length"].value - bare.metrics["closed_length"].value == near(
        SPIGOT, 1e-6
    )
    cut = pi * WIDTH * DEPTH * (bore - DEPTH)
    wall = DEPTH + 1e-3
    ring = pi * wall * (bore - wall) * SPIGOT
    grown = {part: sealed.mass_parts[part] - bare.mass_parts[part] for part in sealed.mass_parts}
    assert grown["barrel"] == near(7850 * pi / 4 * (outer**2 - bore**2) * SPIGOT, 1e-6)
    assert grown["caps"] == near(7850 * (ring - cut), 1e-6)
    assert grown["glands"] == near(-7850 * cut, 1e-6)
    assert grown["seals"] == near(rings(bore), 1e-6)
    assert sealed.metrics["geometry_static_seal"].value == near(
        min(bore / 2 - 6.5e-3 - 0.86 * 1.78e-3 - DEPTH, (14e-3 - WIDTH) / 2), 1e-6
    )


def test_a_plug_has_the_seal_in_its_rim():
    """Nothing gets longer; both plugs lose the metal of their groove."""
    sealed, bare = pair("knee")
    assert sealed.metrics["closed_length"].value == bare.metrics["closed_length"].value
    cut = pi * WIDTH * DEPTH * (21.8e-3 - DEPTH)
    assert bare.mass_parts["caps"] - sealed.mass_parts["caps"] == near(2 * 2810 * cut, 1e-6)
    assert sealed.metrics["geometry_plug"].value == near((4.7e-3 - WIDTH) / 2, 1e-6)


@pytest.mark.parametrize("name", ["steel_baseline", "knee"])
def test_gland_rows_of_the_static_seal(name):
    """Most squeeze and fill, by the table's tolerances; gap with the whole growth of the bore."""
    sealed, _ = pair(name)
    rows = sealed.metrics["seal_squeeze_max"]
    assert rows.place == "static seal"
    assert rows.value > (W - DEPTH + 0.05e-3) / W * 0.99
    names = {part.part for part in sealed.outlines}
    assert "static seal" in names


@pytest.mark.parametrize(("pressure", "warned"), [("206 bar", False), ("210 bar", True)])
def test_a_static_seal_beyond_its_pressure_is_a_warning(pressure, warned):
    """NBR 90 bears 206.8 bar without a back-up ring; sliding rings of the knee have one."""
    found = ao.evaluate(ao.read(KNEE, set={"supply.pressure": pressure}))
    said = [text for text in found.warnings if "without a back-up ring" in text]
    assert [text.startswith("static seal: the pressure is 210 bar") for text in said] == [
        True
    ] * warned
    gaps = [text for text in found.warnings if "limits of the extrusion gap" in text]
    assert [text.startswith("static seal:") for text in gaps] == [True] * warned
    assert not any(text.startswith("static seal: the speed") for text in found.warnings)


def test_nothing_is_left_out_of_the_mass():
    """The report no longer lists static seals among the parts that the mass leaves out."""
    sealed, bare = pair("steel_baseline")
    assert "static seals of the ends" in bare.mass_leaves_out
    assert "static seals of the ends" not in sealed.mass_leaves_out


@pytest.mark.parametrize(
    ("name", "changes", "path", "said"),
    [
        ("steel_baseline", {"seals.static.clearance": "1.5 mm"}, "seals.static.clearance", "depth"),
        ("steel_baseline", {"seals.static.compound": "al_7075_t6"}, "seals.static.compound", ""),
        ("knee_bonded", {}, "seals.static", "the adhesive seals them"),
        ("knee fixed", {"seals.static.section": "3.53 mm"}, "seals.static.section", "4.82 mm does"),
        ("knee fixed", {"caps.thickness": "2.4 mm"}, "seals.static.section", "2.4 mm thick"),
        (
            "knee",
            {"seals.static.section": "7 mm", "variables.caps.thickness.upper": "9 mm"},
            "seals.static.section",
            "at most 9 mm thick",
        ),
        (  # a groove of 5.6 mm between a bore of 21.8 mm, and a hole of 12.06 mm for the rod
            "knee fixed",
            {"seals.static.section": "7 mm", "caps.thickness": "12 mm"},
            "seals.static.section",
            "5.6 mm is deeper than the plug, which has 4.87 mm",
        ),
    ],
)
def test_a_static_seal_that_cannot_be_is_refused(name, changes, path, said):
    """Each with its place and what to do."""
    text = text_of(name.split()[0])
    if "fixed" in name:
        start, end = text.index("variables:"), text.index("# The same requirements")
        text = text[:start] + text[end:]
    if STATIC not in text:
        text = text.replace("\nload:\n", f"{STATIC}\nload:\n", 1)
    with pytest.raises(InputError) as error:
        ao.read(text, set=changes)
    assert any(one.path == path and said in one.message for one in error.value.diagnostics)


def test_an_optimum_keeps_metal_between_groove_and_rod():
    """A ring of 5.33 mm has a groove of 4.264 mm, which would leave 0.6 mm beside the rod."""
    changes = {"seals.static.section": "5.33 mm", "barrel.layup[0].thickness": "2.6 mm"}
    nut = PLAIN_KNEE[PLAIN_KNEE.index("  nut:") : PLAIN_KNEE.index("\nhead:")]
    start, end = (
        PLAIN_KNEE.index(f"  {path}:\n") for path in ("piston.nut.preload", "cylinder.bore")
    )
    knee = ao.read((PLAIN_KNEE[:start] + PLAIN_KNEE[end:]).replace(nut, ""), set=changes)
    best = ao.optimise(knee, prices=False)
    sizes = {variable.path: variable.value for variable in best.variables}
    rest = (sizes["cylinder.bore"] - sizes["rod.outer_diameter"]) / 2 - 30e-6 - 4.264e-3
    assert best.status == "optimal"
    assert rest >= 1e-3 * (1 - 1e-6)
    assert best.evaluation.metrics["geometry_plug"].value == near(
        min(rest, (sizes["caps.thickness"] - 1.3655 * 5.33e-3) / 2), 1e-5
    )
