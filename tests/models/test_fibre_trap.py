"""Fibres over a cone: worked numbers, equilibrium by other means, finite elements, a whole knee."""

from __future__ import annotations

import re
from itertools import pairwise
from math import atan, cos, degrees, pi, radians, sin, tan
from pathlib import Path

import numpy as np
import pytest
import shell_oracle
from scipy.integrate import quad
from step_reader import StepFile, volume

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import assembly
from actuator_opt.evaluation import compute
from actuator_opt.exports.step import bodies, step
from actuator_opt.models import fibre_trap, mass, winding_path

DESIGNS = Path(__file__).parents[2] / "designs"
FORCE = 7273.57
ANGLE, FRICTION = radians(30), 0.1
CREST, VALLEY = 16.5e-3, 14e-3
HOOPS = {"radius": 18e-3, "section": 20e-6, "modulus": 135e9}


def near(value, rel=1e-5):
    """Equal to six digits."""
    return pytest.approx(value, rel=rel)


def test_trap_by_the_worked_numbers():
    """Flank of 30 deg from radius 16.5 mm to 14 mm, friction 0.1, hoop plies of 20 mm^2."""
    assert degrees(atan(FRICTION)) == near(5.71059)
    flank = {"force": FORCE, "crest_radius": CREST, "valley_radius": VALLEY, "angle": ANGLE}
    assert fibre_trap.flank_pressure(**flank) == near(30.3639e6)
    assert fibre_trap.flank_pressure(**flank, friction_coefficient=FRICTION) == near(25.8812e6)
    tension = fibre_trap.hoop_force(force=FORCE, angle=ANGLE, friction_coefficient=FRICTION)
    assert tension == near(1610.38)
    assert fibre_trap.hoop_force(force=FORCE, angle=ANGLE) == near(2005.07)
    assert tension / HOOPS["section"] == near(80.5189e6)
    give = fibre_trap.radial_give(hoop_force=tension, **HOOPS)
    assert give == near(0.0107358e-3)
    assert give / tan(ANGLE) == near(0.0185950e-3)
    compliance = fibre_trap.compliance(**HOOPS, angle=ANGLE, friction_coefficient=FRICTION)
    assert compliance == near(2.55652e-9)
    assert compliance == near(give / tan(ANGLE) / FORCE, 1e-12)


def test_band_by_the_worked_numbers():
    """Clairaut from 14 mm to 16.5 mm at 25 deg, and netting of a band of 0.7 mm."""
    path = {"angle": radians(25), "start_radius": VALLEY, "radius": CREST}
    assert degrees(winding_path.geodesic_angle(**path)) == near(21.0133)
    assert winding_path.geodesic_thickness_ratio(**path) == near(0.823772)
    stress = fibre_trap.band_stress(
        line_force=FORCE / (2 * pi * VALLEY), thickness=0.7e-3, angle=radians(25)
    )
    assert stress == near(143.810e6)


def test_friction_by_the_forces_on_the_flank():
    """Pressure and friction of the flank, resolved along axis and radius, carry F and T."""
    for angle, friction in ((0.6, 0.0), (0.9, 0.2)):
        pressure = fibre_trap.flank_pressure(
            force=FORCE, crest_radius=CREST, valley_radius=VALLEY, angle=angle,
            friction_coefficient=friction,
        )  # fmt: skip
        area = pi * (CREST + VALLEY) * (CREST - VALLEY) / sin(angle)
        axial = pressure * area * (sin(angle) + friction * cos(angle))
        radial = pressure * area * (cos(angle) - friction * sin(angle))
        assert axial == near(FORCE, 1e-12)
        tension = fibre_trap.hoop_force(force=FORCE, angle=angle, friction_coefficient=friction)
        assert tension == near(radial / (2 * pi), 1e-12)


def test_hoop_plies_on_the_slope_by_their_equilibrium():
    """Normal and shear stress on the slope give no axial force, and the flank's radial force."""
    pressure, angle = 30e6, 0.8
    shear = fibre_trap.flank_shear(pressure=pressure, angle=angle)
    normal, radial = np.linalg.solve(
        [[sin(angle), 0.0], [cos(angle), -1.0]], [shear * cos(angle), -shear * sin(angle)]
    )
    assert radial == near(pressure * cos(angle), 1e-12)
    assert normal == near(pressure * cos(angle) ** 2, 1e-12)


@pytest.mark.parametrize("thickness", [1.2e-3, 2e-3, 3.1e-3])
def test_hoop_section_by_integration(thickness):
    """Area between the band, which rises 2 mm over 2.5 mm, and a flat top, up to the crest."""
    width, rise, run = 3e-3, 2e-3, 2.5e-3

    def height(x):
        return max(thickness - max(-x, 0.0) * rise / run, 0.0)

    area = quad(height, -run, width, points=[0.0, -thickness * run / rise], limit=200)[0]
    got = fibre_trap.hoop_section(
        thickness=thickness, width=width, flank_height=rise, flank_length=run
    )
    assert got == near(area, 1e-8)


def test_crest_factor_by_integration():
    """Fibres at radius R + z that stretch alike: largest over mean of c/(R + z)."""
    thickness, radius = 0.8e-3, 2.4e-3
    mean = quad(lambda z: 1 / (radius + z), 0, thickness)[0] / thickness
    got = fibre_trap.crest_factor(thickness=thickness, crest_radius=radius)
    assert got == near(1 / radius / mean, 1e-12)


def test_volume_of_a_band_by_the_length_of_its_slant():
    """A thin band whose ends obey Clairaut: 2 pi R t_R (cos(a_R)/cos(a)) ds within 1 %."""
    crest, valley, angle, thickness, wound = 15e-3, 13e-3, radians(45), 1e-5, radians(25)
    path = {"angle": wound, "start_radius": crest, "radius": valley}
    piled = thickness * winding_path.geodesic_thickness_ratio(**path)
    slant = (crest - valley) / sin(angle)
    low, high = thickness / cos(angle), piled / cos(angle)
    profile = [
        (0.0, crest), (crest - valley, valley), (crest - valley, valley + high), (0.0, crest + low),
    ]  # fmt: skip
    steps = np.linspace(crest, valley, 2001)
    ratio = cos(wound) / np.sqrt(1 - (crest * sin(wound) / steps) ** 2)
    expected = 2 * pi * crest * thickness * slant * np.trapezoid(ratio, dx=1 / 2000)
    assert mass.turned_volume(profile=profile) == near(expected, 1e-2)


PLUGS = {
    "as optimised": (10.6, 2.84, 2.57, 5.0, 60, 0.5, 14.6),
    "long crest": (10.5, 2.0, 6.0, 2.5, 45, 2.5, 13.5),
    "short crest": (10.5, 2.0, 1.5, 2.5, 60, 1.0, 13.5),
    "thin wall": (10.5, 1.5, 1.5, 4.0, 60, 1.0, 14.5),
    "thick wall": (10.5, 4.0, 3.0, 2.5, 45, 2.5, 13.5),
}
"""Bore, wall, crest, depth, angle, floor and crest radius of plugs under 21 MPa [mm, deg]."""


@pytest.mark.parametrize("name", PLUGS)
def test_plug_against_finite_elements(name):
    """Bending of the neck has the model's sign and at most its size; the sum of all bounds it."""
    outer, wall, crest, depth, flank, floor, top = PLUGS[name]
    angle, plate, pressure = radians(flank), 5.0, 21.0
    low, inner, run = top - depth, outer - wall, depth / tan(angle)
    force = pressure * pi * outer**2
    marks = sorted({0.0, inner, low, outer, top})
    radii = np.unique(
        [
            r
            for a, b in pairwise(marks)
            for r in np.linspace(a, b, 1 + max(2, round((b - a) / (0.25 if a >= inner else 1.5))))
        ]
    )
    edge = plate + crest
    stairs = [edge + (top - r) / tan(angle) for r in radii[radii >= low - 1e-9][::-1]]
    end = stairs[-1] + floor
    stations = np.unique(
        np.round(
            [
                *np.linspace(0, plate, 13), plate + 0.3, *np.linspace(plate, edge, 9),
                *stairs, *np.linspace(stairs[-1], end, 5),
            ],
            9,
        )
    )  # fmt: skip

    def absent(r, z):
        sloped = np.maximum(low, top - (z - edge) * tan(angle)) + 1e-6  # cells on it are there
        return (
            ((z < plate) & (r > outer)) | ((z > plate) & (r < inner)) | ((z > edge) & (r > sloped))
        )

    def on_flank(r, z):
        return (z > edge - 1e-6) & (r > low - 1e-6) & (z < edge + run + 1e-6)

    def at_station(r, z):
        return np.min(np.abs(stations[:, None] - z[None, :]), axis=0) < 1e-7

    on_band = force / (pi * (top**2 - low**2))
    wall_oracle = shell_oracle.solved(
        radii=radii,
        stations=stations,
        layers=[(lambda r, z: 0 * r + 1.0, shell_oracle.isotropic(71700, 0.33))],
        absent=absent,
        loads=[
            (lambda r, z: abs(z) < 1e-7, lambda r, z: (0 * r, 0 * r + pressure)),
            (lambda r, z: on_flank(r, z) & at_station(r, z), lambda r, z: (0 * r, 0 * r - on_band)),
            (
                lambda r, z: on_flank(r, z) & ~at_station(r, z),
                lambda r, z: (0 * r - on_band, 0 * r),
            ),
        ],
        fixed_r=lambda r, z: abs(r) < 1e-7,
        fixed_z=lambda r, z: (abs(r) < 1e-7) & (abs(z) < 1e-7),
    )
    axial, bending = (
        stress / 1e6
        for stress in fibre_trap.neck_stresses(
            force=force, outer_radius=outer / 1e3, wall_thickness=wall / 1e3,
            crest_radius=top / 1e3, valley_radius=low / 1e3,
            flank_distance=(crest + run / 2) / 1e3, angle=angle,
        )
    )  # fmt: skip
    mean, at_bore = wall_oracle.through(plate + 0.05, inner, outer)
    assert mean == pytest.approx(-axial, rel=0.2)
    if abs(bending) > 0.5 * axial:
        assert 0.0 < at_bore / bending < 0.7
    else:
        assert abs(at_bore) < 0.3 * axial
    ring = (low - inner) * (crest + run + floor) + depth * (crest + run / 2)
    hoop = fibre_trap.hoop_force(force=force, angle=angle) / ring
    r = np.array([inner + 0.02, (inner + outer) / 2, outer - 0.02])
    s = wall_oracle.stress(r, np.full(3, plate + 0.3))
    pairs = (s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2
    equivalent = np.sqrt(pairs / 2 + 3 * s[3] ** 2)
    assert max(equivalent) < axial + abs(bending) + hoop


# --- a whole knee ---------------------------------------------------------------------------

CONE = """\
retention:
  cap:
    type: cone
    length: 2.5 mm
    wall: 2.5 mm
    angle: 45 deg
    depth: 2 mm
    crest_radius: 2.4 mm
    hoop_thickness: 2 mm
    hoop_width: 2 mm
  head:
    type: bond
    material: epoxy_structural
    length: 20 mm
    wall: 1.5 mm
"""
BONDED = (DESIGNS / "knee_bonded.yaml").read_text("utf-8").partition("\nvariables:")[0]
KNEE = BONDED[: BONDED.index("retention:")] + CONE + "\n" + BONDED[BONDED.index("clevis:") :] + "\n"


def changed(*pairs):
    """The knee with some lines replaced, each of which stands in it."""
    text = KNEE
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def test_the_knee_by_hand():
    """Rows of the cap's cone, from its sizes: crest at 13.3 mm, valley at 11.3 mm, 45 deg."""
    subject = ao.read(KNEE).subject()
    computed = compute(subject, subject.values()).computed
    force = 21e6 * pi / 4 * 23e-3**2
    stock = compute(subject, subject.values()).joints[0].loaded.materials
    fibre, across = (
        stock.allowable("t700_epoxy", key)
        for key in ("strength_1_tension", "strength_2_compression")
    )
    crest, valley, line = 13.3e-3, 11.3e-3, force / (2 * pi * 13.7e-3)
    working, burst = (
        {place: float(np.squeeze(value)) for place, value in computed.metrics[name].items()}
        for name in ("retention_factor", "retention_burst_factor")
    )
    assert working["cap: plies on the flank"] == near(
        across * pi * (crest**2 - valley**2) / force, 1e-9
    )
    assert working["cap: plies on the crest"] == near(across * 2.4e-3 * cos(pi / 4) / line, 1e-9)
    winds = (1 / 3) / np.log(1 + 1 / 3)
    assert burst["cap: band over the crest"] == near(
        fibre * 0.8e-3 * cos(radians(25)) ** 2 / line / winds, 1e-9
    )
    # hoop plies: 2 mm high, 2 mm wide on the floor, and a wedge on the band's outside
    foot = 0.8e-3 * crest * cos(radians(25)) / np.sqrt(valley**2 - (crest * sin(radians(25))) ** 2)
    rise = 2e-3 + 0.8e-3 - foot
    run = 2e-3 + (foot - 0.8e-3) * tan(pi / 8)
    section = 2e-3 * 2e-3 + (2e-3 - rise / 2) * rise * run / rise
    tension = 1.3 * force / (2 * pi)
    assert burst["cap: hoop plies"] == near(fibre * section / tension, 1e-9)
    grip = float(np.squeeze(computed.metrics["geometry_trap_grip"]["cap"]))
    give = force / (2 * pi) * (valley + foot + 1e-3) / (section * 135e9)
    assert grip == near(2e-3 / give, 1e-9)
    lengths = {
        place: float(np.squeeze(value))
        for place, value in computed.metrics["geometry_trap"].items()
    }
    assert lengths["cap: crest"] == near(2.5e-3 - 2.4e-3 * tan(pi / 8), 1e-9)
    assert lengths["cap: flank"] == near(2e-3 / sin(pi / 4) - 4.8e-3 * tan(pi / 8), 1e-9)
    assert lengths["cap: metal under the valley"] == near(11.3e-3 - 9e-3, 1e-9)
    assert lengths["cap: neck under the groove of the seal"] == near(2.5e-3, 1e-9)


def test_the_neck_runs_under_the_groove_of_the_static_seal():
    """A groove of 1.78 mm section with 20 % squeeze is 1.424 mm deep; the neck's rest is 1.076."""
    static = "  static:\n    compound: nbr_90\n    section: 1.78 mm\n    squeeze: 20 %\n"
    subject = ao.read(changed(("\nload:\n", f"{static}\nload:\n"))).subject()
    lengths = compute(subject, subject.values()).computed.metrics["geometry_trap"]
    neck = float(np.squeeze(lengths["cap: neck under the groove of the seal"]))
    assert neck == near(2.5e-3 - 1.424e-3, 1e-9)


def test_solids_weigh_what_the_mass_model_says():
    """Plug, band with its layer, and hoop plies are closed solids; volumes read back from STEP."""
    actuator = ao.read(KNEE)
    evaluation, subject = ao.evaluate(actuator), actuator.subject()
    made = bodies(evaluation)
    solids = StepFile(step(made, name="knee", program="test")).solids()
    weights = {}
    for body in made:
        density = subject.materials[body.material].numbers["density"]
        weight = volume(solids[body.name]) * 1e-9 * density
        weights[body.name] = weights.get(body.name, 0.0) + weight
    wound = [name for name in weights if name.startswith("barrel") or "hoop plies" in name]
    assert len(wound) == 4
    assert sum(weights[name] for name in wound) == near(evaluation.mass_parts["barrel"], 1e-9)
    caps = sum(weight for name, weight in weights.items() if name.startswith("cap,"))
    assert caps == near(evaluation.mass_parts["caps"], 1e-9)


def test_the_cone_adds_compliance():
    """The trap's give is in series with the barrel's stretch: A_B^2 C at the rod-side chamber."""
    parts = []
    for sizes in ("hoop_thickness: 2 mm", "hoop_thickness: 1 mm"):
        subject = ao.read(changed(("hoop_thickness: 2 mm", sizes))).subject()
        run = compute(subject, subject.values())
        end = run.joints[0].loaded.end
        give = run.joints[0].joint.give(end, run.joints[0].loaded.materials)
        stretch = run.springs.chambers["stretch"].b0 - (
            run.geometry.area_b**2 * run.wall.swelling.stretch * run.geometry.wall_length
        )
        parts.append((float(np.squeeze(give)), float(np.squeeze(stretch))))
    (give_1, stretch_1), (give_2, stretch_2) = parts
    area = pi / 4 * (23e-3**2 - 13e-3**2)
    assert give_2 > 1.5 * give_1
    assert stretch_2 - stretch_1 == near(area**2 * (give_2 - give_1), 1e-6)


def test_slopes():
    """Complex-step slopes of all rows of the trap equal central differences."""
    subject = ao.read(KNEE).subject()

    def rows(path, value):
        computed = compute(subject, subject.values({path: np.array([value])})).computed
        names = ("mass", "retention_factor", "retention_burst_factor", "geometry_trap_grip")
        return np.array(
            [
                np.squeeze(row)
                for name in names
                for place, row in computed.metrics[name].items()
                if name == "mass" or place.startswith("cap")
            ]
        )

    for path in ("retention.cap.angle", "retention.cap.depth", "barrel.layup[2].angle"):
        value = subject.numbers[path]
        slope = rows(path, value + 1e-30j).imag / 1e-30
        step = 1e-5 * value
        central = (rows(path, value + step).real - rows(path, value - step).real) / (2 * step)
        assert np.any(slope)
        assert slope == pytest.approx(central, rel=1e-5, abs=1e-6 * np.abs(central).max())


BAD = [
    (("angle: 25 deg", "angle: 88 deg"), "barrel.layup", "no layer"),
    (("angle: 88 deg", "angle: 55 deg"), "barrel.layup", "2 layers"),
    (("angle: 45 deg", "angle: 30 deg"), "retention.cap.angle", "sticks"),
    (("crest_radius: 2.4 mm", "crest_radius: 2 mm"), "retention.cap.crest_radius", "too sharp"),
    (("depth: 2 mm", "depth: 4 mm"), "retention.cap.depth", "under it"),
    (("angle: 25 deg", "angle: 65 deg"), "retention.cap.depth", "turn back"),
    (("hoop_width: 2 mm", "hoop_width: 2 mm\n    material: steel_42crmo4"),
     "retention.cap.material", "hoop plies"),
]  # fmt: skip


@pytest.mark.parametrize(("pair", "path", "words"), BAD, ids=[case[2] for case in BAD])
def test_refused(pair, path, words):
    """A cone that cannot be wound, or does not hold, is one fault at its key with a remedy."""
    with pytest.raises(InputError) as error:
        ao.read(changed(pair))
    (fault,) = error.value.diagnostics
    assert fault.path == path
    assert re.search(words, fault.message)
    assert fault.remedy


def test_a_variable_angle_that_would_stick_is_refused():
    """The lower bound of the flank's angle, too, must be above twice the angle of friction."""
    bounds = "variables:\n  retention.cap.angle:\n    lower: {} deg\n    upper: 60 deg\n"
    text = KNEE + bounds + "objective:\n  minimise: mass\n"
    ao.read(text.format(34))
    with pytest.raises(InputError, match="sticks") as error:
        ao.read(text.format(30))
    assert [x.path for x in error.value.diagnostics] == ["variables.retention.cap.angle.lower"]


def test_warnings():
    """The play when cold by hand; both ends wound in; a flank without a straight part."""
    evaluation = ao.evaluate(ao.read(KNEE))
    play = (23.6e-6 + 0.5e-6) * 120 * 13.3e-3 / tan(pi / 4)
    (sentence,) = (text for text in evaluation.warnings if "loosens" in text)
    assert f"{1e3 * play:.3g}"[:4] in sentence
    assert any("(flank)" in text for text in evaluation.warnings)
    assert not any("both ends are wound" in text for text in evaluation.warnings)
    assert "The cap is made with the barrel." in assembly.order(evaluation.design)
    block = CONE[CONE.index("    type: cone") : CONE.index("  head:")]
    both = KNEE.replace(CONE, "retention:\n" + block.replace("    ", "  "))
    assert any("both ends are wound" in text for text in ao.evaluate(ao.read(both)).warnings)


def test_crest_and_play_by_equilibrium():
    """Pressure of a belt, shear of a root, play of a cone that shrinks, and reach of a shell."""
    angle = 0.7
    pressure = fibre_trap.crest_pressure(line_force=1e5, crest_radius=3e-3, angle=angle)
    assert pressure * 3e-3 * cos(angle) == near(1e5)
    shear = fibre_trap.crest_shear(force=7e3, valley_radius=14e-3, length=4e-3)
    assert shear * 2 * pi * 14e-3 * 4e-3 == near(7e3)
    play = fibre_trap.cooling_play(
        expansion_difference=24e-6, cooling=100.0, radius=16e-3, angle=angle
    )
    assert play * tan(angle) == near(24e-6 * 100 * 16e-3)  # radial shrinkage along the flank
    reach = fibre_trap.hoop_reach(radius=15e-3, thickness=2e-3, modulus=135e9, axial_modulus=8.5e9)
    bending, foundation = 8.5e9 * 2e-3**3 / 12, 135e9 * 2e-3 / 15e-3**2
    assert reach == near((4 * bending / foundation) ** 0.25)


def test_ring_with_a_conical_end_by_integration():
    """Rings up to the taper, then discs of falling radius."""
    inner, tip, outer, length, taper = 10e-3, 11e-3, 12e-3, 20e-3, 5e-3
    cone = quad(lambda x: (outer + (tip - outer) * x / taper) ** 2 - inner**2, 0, taper)[0]
    expected = pi * (cone + (outer**2 - inner**2) * (length - taper))
    found = mass.tapered_ring_volume(
        inner_radius=inner, tip_radius=tip, outer_radius=outer, length=length, taper_length=taper
    )
    assert found == near(expected, 1e-9)
