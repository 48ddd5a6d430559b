"""Caps screwed onto the barrel: what is refused, and the strength of what is not."""

from __future__ import annotations

from math import log, pi, sqrt, tan
from pathlib import Path

import numpy as np
import pytest
from cli_runner import refused

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.models import barrel, thread
from actuator_opt.optimisation.choices import possible

DESIGNS = Path(__file__).parents[2] / "designs"
KNEE = (DESIGNS / "knee_bonded.yaml").read_text("utf-8")
STEEL = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
STEEL = STEEL[: STEEL.index("  static:")] + STEEL[STEEL.index("load:\n") :]
SCREWED = KNEE.replace("  type: bond\n", "  type: thread\n  thread: {pitch: 1 mm}\n").replace(
    "  material: epoxy_structural\n", ""
)
"""The knee with its caps screwed onto the wound barrel."""

FORCE, PRESSURE = 7273.57, 21e6
PITCH, DIAMETER, LENGTH = 1e-3, 26e-3, 7.2e-3
HEIGHT = sqrt(3) / 2 * PITCH


def near(value, rel=1e-9):
    """As equal as two ways through the same numbers."""
    return pytest.approx(value, rel=rel)


def complaints(text, **changes):
    """Every (path, message, remedy) a design is refused with."""
    with pytest.raises(InputError) as error:
        ao.read(text, set={path: str(value) for path, value in changes.items()})
    return [(one.path, one.message, one.remedy) for one in error.value.diagnostics]


def of(text):
    """A design, ready to evaluate."""
    return ao.read(text).subject()


def sheared(width_at, radius, length=LENGTH):
    """Area of a cylinder that cuts metal over `width_at` its radius in every pitch."""
    return 2 * pi * radius * length * width_at(radius) / PITCH


def male_width(radius):
    """Axial width of the male thread, an equilateral tooth that is P/2 wide at the pitch line."""
    return PITCH / 2 + (DIAMETER / 2 - 3 / 8 * HEIGHT - radius) * 2 * tan(pi / 6)


def female_width(radius):
    """What the male thread leaves of the pitch."""
    return PITCH - male_width(radius)


def test_strip_areas_are_the_teeth_cut_by_the_other_crests():
    """The male tooth is cut at the female crests D_1, the female one at the male crests d."""
    size = {"diameter": DIAMETER, "pitch": PITCH, "engagement": LENGTH}
    minor = DIAMETER / 2 - 5 / 8 * HEIGHT
    assert 2 * minor == near(thread.minor_diameter(diameter=DIAMETER, pitch=PITCH))
    assert thread.male_strip_area(**size) == near(sheared(male_width, minor))
    for crest in (DIAMETER, DIAMETER - 0.3e-3):
        own = thread.female_strip_area(**size, crest_diameter=crest)
        assert own == near(sheared(female_width, crest / 2))
        flanks = thread.flank_area(**size, crest_diameter=crest)
        share = thread.crest_overlap(diameter=DIAMETER, pitch=PITCH, crest_diameter=crest)
        assert share == near((crest / 2 - minor) / (5 / 8 * HEIGHT))
        middle = DIAMETER - 2 * 3 / 8 * HEIGHT  # of the flanks, by the pitch diameter
        assert flanks == near(pi * middle * (crest / 2 - minor) * LENGTH / PITCH)


def test_threads_by_the_worked_numbers_of_m26():
    """M26 x 1, L_e 7.2 mm, R_m 580 and 515 MPa: factors at rupture, net wall by von Mises."""
    assert thread.engaged_length(length=8e-3, pitch=PITCH) == near(LENGTH)
    size = {"diameter": DIAMETER, "pitch": PITCH, "engagement": LENGTH}
    male = 580e6 / sqrt(3) * thread.male_strip_area(**size)
    female = 515e6 / sqrt(3) * thread.female_strip_area(**size, crest_diameter=DIAMETER)
    assert (male / FORCE, female / FORCE) == near((19.4611, 21.0360), 1e-5)
    reductions = thread.stripping_reductions(strength_ratio=female / male)
    assert female / male == near(1.08092, 1e-5)
    assert (reductions[0] * male / FORCE, reductions[1] * female / FORCE) == near(
        (17.7975, 18.8693), 1e-5
    )
    root = thread.root_diameter(diameter=DIAMETER, pitch=PITCH)
    stresses = barrel.bore_stresses(
        pressure=PRESSURE, inner_radius=10.5e-3, outer_radius=root / 2, axial_force=FORCE
    )
    hoop, radial, axial = stresses
    assert barrel.von_mises(hoop=hoop, radial=radial, axial=axial) == near(129.250e6, 1e-5)


def test_flanks_spread_a_ring_by_the_radial_share_of_their_force():
    """On a flank of 30 deg without friction the radial force is F tan 30 deg, all around."""
    wall = 2e-3
    around = FORCE * tan(pi / 6) / (2 * pi)  # radial force per radian
    hoop = around / (wall * LENGTH)  # T = p r of a ring, whatever its radius
    stress = thread.spread_stress(force=FORCE, thickness=wall, engagement=LENGTH)
    assert stress == near(hoop)


def test_reductions_join_and_stay_put_outside_their_range():
    """Alexander's polynomials meet 0.897 where the threads are alike, and end where he did."""
    male, female = thread.stripping_reductions(strength_ratio=np.array([0.2, 0.4, 1 - 1e-9, 1.0]))
    assert male == near(0.897)
    assert female[0] == female[1]
    assert female[2] == near(female[3], 1e-3)
    male, female = thread.stripping_reductions(strength_ratio=np.array([1 + 1e-9, 2.2, 9.0]))
    assert female == near(0.897)
    assert male[0] == near(0.897, 1e-3)
    assert male[1] == near(male[2])


# --- what is refused -----------------------------------------------------------------------


def test_a_thread_into_plies_is_refused_by_the_name_of_the_layer():
    """The knee's wound barrel takes no thread, in the file, by --set, in the library."""
    ((path, message, remedy),) = complaints(SCREWED)
    assert path == "barrel.layup[2].material"
    assert "t700_epoxy" in message
    assert "plies" in message
    assert all(word in remedy for word in ("metal", "bond", "tie_rods"))
    (fault,) = refused(SCREWED, command="check")
    assert (fault["path"], fault["line"]) == ("barrel.layup[2].material", 40)


@pytest.mark.parametrize(
    ("changes", "path", "said"),
    [
        ({"barrel.layup[0].material": "pa12_mjf"}, "barrel.layup[0].material", "a polymer"),
        ({"caps.material": "pa12_mjf"}, "caps.material", "a polymer"),
        ({"caps.material": "t700_epoxy"}, "caps.material", "plies"),
        ({"barrel.layup[0].thickness": "1.61 mm"}, "barrel.layup[0].thickness", "leaves 0.9966 mm"),
        ({"retention.thread.diameter": "25.9 mm"}, "barrel.layup[0].thickness", "leaves 0.8366 mm"),
        ({"retention.thread.diameter": "27.3 mm"}, "retention.thread.diameter", "barrel (27 mm)"),
        ({"retention.material": "steel_42crmo4"}, "retention.material", "has no effect"),
        ({"retention.thread.pitch": "6 mm"}, "retention.length", "less than one turn"),
    ],
)
def test_a_thread_that_cannot_be_cut_is_refused(changes, path, said):
    """Materials without strengths, too little metal under the root, values that contradict."""
    found = complaints(STEEL, **changes)
    assert any(one == path and said in message for one, message, _ in found), found


def test_a_metal_without_strengths_is_refused():
    """A factor needs yield and ultimate strength of both metals."""
    library = ao.load_library()
    bare = [
        name
        for name in library.names(kind="metal")
        if not {"yield_strength", "ultimate_strength"} <= set(library.get(name).numbers)
    ]
    for name in bare[:2]:
        ((path, message, _),) = complaints(STEEL, **{"caps.material": name})
        assert path == "caps.material"
        assert "cannot be judged" in message


def test_a_choice_that_cannot_be_cut_is_no_design():
    """Plies and plastic among the choices are left out, with the reason."""
    listed = STEEL.replace(
        "variables:\n",
        "choices:\n  barrel.layup[0].material: [pa12_mjf, t700_epoxy, steel_e355]\n\nvariables:\n",
    )
    looks = {look.values["barrel.layup[0].material"]: look for look in possible(of(listed))}
    assert not looks["steel_e355"].fault
    for name in ("pa12_mjf", "t700_epoxy"):
        assert looks[name].how == "not possible"
        assert "barrel.layup[0].material" in looks[name].fault
        assert "needs metal" in looks[name].fault


def test_a_chosen_type_leaves_the_adhesive_to_the_bond():
    """Of bond and thread on a steel barrel both are possible, though the adhesive is stated."""
    both = STEEL.replace(
        "  type: thread                  # caps screwed onto the barrel's outside\n",
        "  type: bond\n  material: epoxy_structural\n",
    ).replace("variables:\n", "choices:\n  retention.type: [bond, thread]\n\nvariables:\n")
    assert [look.fault for look in possible(of(both))] == ["", ""]


def test_a_chosen_pitch_waits_for_the_free_wall():
    """The file's wall is too thin for a pitch of 3 mm, but free: the search keeps the limit."""
    pitches = "choices:\n  retention.thread.pitch: [1 mm, 3 mm]\n\nvariables:\n"
    free = [look.fault for look in possible(of(STEEL.replace("variables:\n", pitches)))]
    assert free == ["", ""]
    held = pitches.replace("variables:\n", "")
    start, end = STEEL.index("variables:\n"), STEEL.index("# The same requirements")
    fixed = [look.fault for look in possible(of(STEEL[:start] + held + STEEL[end:]))]
    assert fixed[0] == ""
    assert "leaves 0.1597 mm" in fixed[1]


@pytest.mark.long
def test_a_search_leaves_the_least_metal_under_the_thread():
    """A wall free to go down to 0.5 mm ends with 1 mm under the root, at any factor asked."""
    soft = STEEL.replace("    lower: 1 mm                 # what", "    lower: 0.5 mm  # what")
    changes = {"supply.pressure": "30 bar", "requirements.stiffness_min.min": "1 kN/mm"}
    loads = {"load_cases[stance].force": "0.5 kN", "load_cases[swing].force": "0.2 kN"}
    best = ao.optimise(ao.read(soft, set=changes | loads), starts=1).best
    depth = 17 / 24 * HEIGHT
    assert best.barrel.layup[0].thickness >= 1e-3 + depth - 1e-8


# --- factors -------------------------------------------------------------------------------


def strengths(found, name):
    """Yield and ultimate strength of a metal at the hottest of the steel knee."""
    subject = found.subject()
    factor = subject.factors
    return [
        subject.numbers[f"materials.{name}.{key}"] * factor[name, key, False]
        for key in ("yield_strength", "ultimate_strength")
    ]


def test_each_place_of_a_screwed_joint_by_hand():
    """Steel knee, M27 x 1 by its outside: threads, flanks, both walls, by independent formulas."""
    read = ao.read(STEEL)
    found = ao.evaluation.compute(subject := read.subject(), subject.values()).computed.metrics
    (y_male, u_male), (y_female, u_female) = (
        strengths(read, name) for name in ("steel_e355", "steel_42crmo4")
    )
    area = pi / 4 * 23e-3**2
    force, length, outside = 21e6 * area, 10e-3 - 0.8e-3, 27e-3
    minor, middle, root = (outside - share * HEIGHT for share in (5 / 4, 3 / 4, 17 / 12))
    males, females = 0.75 * pi * minor * length, 0.875 * pi * outside * length
    factors = {place: float(np.ravel(x)[0]) for place, x in found["retention_factor"].items()}
    assert factors["barrel thread"] == near(y_male / sqrt(3) * males / force)
    assert factors["skirt thread"] == near(y_female / sqrt(3) * females / force)
    flanks = pi * middle * 5 / 8 * HEIGHT * length / PITCH
    assert factors["thread flanks"] == near(min(y_male, y_female) * flanks / force)
    assert len(factors) == 3
    skirt = pi / 4 * (31e-3**2 - outside**2)
    burst = {place: float(np.ravel(x)[0]) for place, x in found["retention_burst_factor"].items()}
    ratio = u_female * females / (u_male * males)
    c_male, c_female = thread.stripping_reductions(strength_ratio=ratio)
    assert burst["barrel thread"] == near(c_male * u_male / sqrt(3) * males / force)
    assert burst["skirt thread"] == near(c_female * u_female / sqrt(3) * females / force)
    assert burst["skirt under the thread"] == near(u_female * skirt / force)
    radial = force * tan(pi / 6) / (pi * middle * length)  # of the flanks on their pitch cylinder
    assert burst["skirt spread by the thread"] == near(y_female * 2 * 2e-3 / (radial * middle))
    yields = {place: float(np.ravel(x)[0]) for place, x in found["yield_factor"].items()}
    assert yields["skirt under the thread"] == near(y_female * skirt / force)
    inner, outer = 11.5e-3**2, (root / 2) ** 2
    hoop = 21e6 * (outer + inner) / (outer - inner)
    for place, along in (
        ("no axial load", 0.0),
        ("piston at the end stop", force / (pi * (outer - inner))),
    ):
        mises = sqrt(((hoop - along) ** 2 + (along + 21e6) ** 2 + (21e6 + hoop) ** 2) / 2)
        assert yields[f"barrel under the thread, {place}"] == near(y_male / mises)
        half = along * pi * (outer - inner) / (21e6 * pi * inner) / 2
        alone = y_male * (2 - y_male / u_male) * log(root / 23e-3) / sqrt(1 - half + half**2)
        held = y_female * (2 - y_female / u_female) * log(31e-3 / outside) * outside / root
        bursts = found["burst_factor"][f"barrel under the thread, {place}"]
        assert float(np.ravel(bursts)[0]) == near((alone + held) / 21e6)
        assert f"barrel under the thread, {place}" in found["proof_factor"]
    stress = force / (pi * (outer - inner))
    limit = subject.numbers["materials.steel_e355.fatigue_strength"]
    limit *= subject.factors["steel_e355", "fatigue_strength", False]
    used = 3.0 * stress / 2 / limit + stress / 2 / u_male
    life = float(np.ravel(found["fatigue_factor"]["barrel thread root"])[0])
    assert life == near(1 / used)


def test_a_barrel_turned_down_to_its_thread():
    """A thread below the outside takes its ring off the barrel, in mass and drawing alike."""
    thick = {"barrel.layup[0].thickness": "3 mm"}
    plain = ao.evaluate(ao.read(STEEL, set=thick))
    turned = ao.evaluate(ao.read(STEEL, set=thick | {"retention.thread.diameter": "28 mm"}))
    density = 7850.0
    ring = pi / 4 * (29e-3**2 - 28e-3**2) * 2 * 10e-3
    lost = plain.mass_parts["barrel"] - turned.mass_parts["barrel"]
    assert lost == near(density * ring, 2e-2)
    (outline,) = (one for one in turned.outlines if one.part == "layup[0]")
    (polygon,) = outline.polygons
    volume = 0.0
    for (x1, r1), (x2, r2) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        volume += pi * (x2 - x1) * (r1 * r1 + r1 * r2 + r2 * r2) / 3
    of_mass = turned.mass_parts["barrel"] / plain.mass_parts["barrel"]
    whole = pi / 4 * (29e-3**2 - 23e-3**2) * plain.lengths["barrel_length"]
    assert abs(volume) == near(of_mass * whole)
    assert turned.lengths["plate_outer"] == near(28e-3 + 2 * 2e-3)


def test_crests_that_the_barrel_has_not_carry_nothing():
    """A thread larger than the tube, as in a sweep, engages less and less, and then not at all."""
    subject = ao.read(STEEL, set={"retention.thread.diameter": "27 mm"}).subject()
    bores = np.array([23e-3, 22.6e-3, 22.0e-3, 21.0e-3])
    found = ao.evaluation.compute(subject, subject.values({"cylinder.bore": bores})).computed
    by_force = found.metrics["retention_factor"]["thread flanks"] * bores**2
    overlap = (np.minimum(bores + 4e-3, 27e-3) - 27e-3 + 5 / 4 * HEIGHT) / 2
    assert by_force / by_force[0] == near(overlap / overlap[0], 1e-9)
    assert by_force[-1] < 0
    share = found.metrics["geometry_thread_crest"][""]
    assert share == near(overlap / (5 / 8 * HEIGHT))


def test_a_search_keeps_the_crests_of_a_stated_thread():
    """A bore free to shrink below a stated thread stops where 6g would: 0.8 of the overlap."""
    thick = STEEL.replace("thickness: 2 mm", "thickness: 3 mm")
    start, end = thick.index("  barrel.layup[0].thickness:\n"), thick.index("# The same req")
    alone = thick[:start] + "\n" + thick[thick.index("objective:") :]
    assert end > start
    asked = {"retention.thread.diameter": "28 mm"}
    best = ao.optimise(ao.read(alone, set=asked), starts=1)
    outside = best.best.cylinder.bore + 6e-3
    assert best.evaluation.metrics["geometry_thread_crest"].value >= 0.8 * (1 - 1e-6)
    assert outside >= 28e-3 - 0.2 * 5 / 4 * HEIGHT - 1e-9
