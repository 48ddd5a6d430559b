"""Joints in metal that are cut into a sleeve under the winding."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
import shell_oracle
from scipy.linalg import solve_banded
from step_reader import StepFile, volume

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design
from actuator_opt.evaluation import compute
from actuator_opt.exports.step import bodies, step
from actuator_opt.joints import sleeve
from actuator_opt.models.end_bending import thickened_end_peak
from actuator_opt.optimisation.choices import possible

DESIGNS = Path(__file__).parents[2] / "designs"
BONDED = (DESIGNS / "knee_bonded.yaml").read_text("utf-8").partition("\nvariables:")[0] + "\n"
STATIC = "  static:\n    compound: nbr_90\n    section: 1.78 mm\n    squeeze: 20 %\n"
BONDED = BONDED.replace("load:\n  mass", f"{STATIC}\nload:\n  mass").replace(
    "length: 14", "length: 13"
)
RETENTION = BONDED[BONDED.index("retention:\n") : BONDED.index("clevis:\n")]
LINER = BONDED[
    BONDED.index("    - material: al_7075_t6      # liner") : BONDED.index("    - material: t700")
]
HELICAL = BONDED[
    BONDED.index("    - material: t700_epoxy      # carries the axial") : BONDED.index("rod:\n")
]
BLOCKS = {
    "plug_thread": "  length: 7 mm\n  wall: 1.5 mm\n  thread:\n    pitch: 0.75 mm\n",
    "retaining_ring": "  material: steel_bolt_12_9\n  length: 5 mm\n  groove_depth: 0.5 mm\n"
    "  ring_thickness: 1.5 mm\n  ring_width: 3.5 mm\n",
    "thread": "  length: 9 mm\n  wall: 1.6 mm\n"
    "  thread:\n    diameter: 27 mm\n    pitch: 0.75 mm\n",
}
SLEEVE = "  sleeve:\n    material: al_7075_t6\n    wall: 2.2 mm\n    inner_length: 25 mm\n"

each = pytest.mark.parametrize("kind", BLOCKS)
both = pytest.mark.parametrize("liner", [True, False], ids=["liner", "plies"])


def text_of(kind="plug_thread", block=SLEEVE, *, liner=False):
    """The knee with a joint in a sleeve, with its liner or without."""
    text = BONDED.replace(RETENTION, f"retention:\n  type: {kind}\n{BLOCKS[kind]}{block}\n")
    return text if liner else text.replace(LINER, "")


def run_of(text):
    """All intermediate results of a design, and its metrics by name and place."""
    subject = ao.read(text).subject()
    run = compute(subject, subject.values())
    return run, run.computed.metrics


def fault(text):
    """The only fault of a file."""
    with pytest.raises(InputError) as error:
        ao.read(text)
    (one,) = error.value.diagnostics
    return one


# --- rows -----------------------------------------------------------------------------------


def metal_tube(kind):
    """The same joint on a tube of the sleeve's metal, as thick as the sleeve."""
    start, end = BONDED.index("  layup:"), BONDED.index("rod:\n")
    tube = "  layup:\n    - material: al_7075_t6\n      thickness: 2.2 mm\n\n"
    text = BONDED[:start] + tube + BONDED[end:]
    return text.replace(RETENTION, f"retention:\n  type: {kind}\n{BLOCKS[kind]}\n")


@each
@both
def test_rows_of_the_joint_are_those_in_a_metal_tube(kind, liner):
    """Threads, grooves and the metal under them carry as in a tube of the sleeve's section."""
    _, sleeved = run_of(text_of(kind, liner=liner))
    _, plain = run_of(metal_tube(kind))
    own = {sleeve.INNER, sleeve.OUTER, sleeve.BARE}
    for metric in ("retention_factor", "retention_burst_factor"):
        rows = {place: x for place, x in sleeved[metric].items() if place not in own}
        assert rows.keys() == plain[metric].keys()
        for place, factor in rows.items():
            assert factor == pytest.approx(plain[metric][place], rel=1e-12)
    assert sleeved["cycle_life"].keys() > {sleeve.BARE}


def shear_at_edges(length, sleeve_stiffness, winding_stiffness, k, line, mismatch):
    """Shear at the winding's end, where the sleeve carries `line`, and at the sleeve's tip.

    Slip s between bars: s'' = k (1/K_s + 1/K_w) s; s' = N/K_s + e at the outer end and
    s' = -N/K_w + e at the tip, solved on a grid.
    """
    cells = 40_000
    h, give = length / cells, 1 / sleeve_stiffness + 1 / winding_stiffness
    band = np.zeros((3, cells + 1))
    band[0, 2:], band[2, :-2] = 1 / h**2, 1 / h**2
    band[0, 1], band[2, -2] = 2 / h**2, 2 / h**2
    band[1] = -2 / h**2 - k * give
    load = np.zeros(cells + 1)
    load[0] = 2 / h * (line / sleeve_stiffness + mismatch)
    load[-1] = -2 / h * (-line / winding_stiffness + mismatch)
    slip = solve_banded((1, 1), band, load)
    return k * slip[[0, -1]]


def test_shear_of_both_edges_by_a_boundary_value_problem():
    """Without a liner, the plies pass the whole force; and the sleeve shrinks more than they."""
    run, metrics = run_of(text_of())
    (joint,) = run.joints
    loaded = joint.loaded
    wall, interface, helical = 2.2e-3, 2 * pi * (11.5e-3 + 2.2e-3), 2e-3
    metal, poisson = 71.7e9, 0.33
    area = pi * wall * (23e-3 + wall)
    assert loaded.materials.get("al_7075_t6", "youngs_modulus") == metal
    plies = float(loaded.line_stiffness[0]) * pi * (2 * 11.5e-3 + helical) / interface
    shear = [
        loaded.materials.get("t700_epoxy", k) for k in ("shear_modulus_13", "shear_modulus_12")
    ]
    ply_shear = next(x for x in shear if x is not None)
    k = 3 / (helical / ply_shear + wall / (metal / (2 * (1 + poisson))))
    strengths = [loaded.materials.allowable("t700_epoxy", f"strength_{a}") for a in ("12", "23")]
    strength = min(x for x in strengths if x is not None)
    length = 25e-3 - 5 * wall  # without the conical tip
    of = (length, metal * area / interface, plies, k)
    outside, inside = shear_at_edges(*of, loaded.force / interface, 0.0)
    factors = metrics["retention_factor"]
    assert factors[sleeve.OUTER] == pytest.approx(strength / abs(outside), rel=1e-5)
    assert factors[sleeve.INNER] == pytest.approx(strength / abs(inside), rel=1e-5)
    expansion = loaded.materials.get("al_7075_t6", "thermal_expansion")
    for word, change in (("cold", -120.0), ("hot", -40.0)):  # from the cure at 120 degC
        outside, _ = shear_at_edges(*of, 0.0, float(expansion - loaded.expansion[0]) * change)
        allowed = [
            loaded.materials.allowable("t700_epoxy", f"strength_{a}", cold=word == "cold")
            for a in ("12", "23")
        ]
        allowed = min(x for x in allowed if x is not None)
        factor = metrics["bond_thermal_factor"][f"caps, {word}"]
        assert factor == pytest.approx(allowed / abs(outside), rel=1e-5)


def equivalent(stress):
    """Von Mises stress of r, t, z, rz."""
    r, t, z, rz = stress
    return np.sqrt(((r - t) ** 2 + (t - z) ** 2 + (z - r) ** 2) / 2 + 3 * rz**2)


@pytest.mark.parametrize(
    ("bore", "liner", "winding", "lift", "covered", "sealed", "ratio"),
    [
        (21.8, 0.906, 3.33, 0.836, 4.18, 0.55, 1.16),  # as in the knee
        pytest.param(40.0, 0.98, 4.62, 1.92, 9.6, 0.85, 1.31, marks=pytest.mark.long),
        # so short that it turns as a whole
        pytest.param(80.0, 2.0, 9.0, 1.0, 5.0, 0.7, 2.28, marks=pytest.mark.long),
    ],
)
def test_thickened_end_of_a_liner_by_finite_elements(
    bore, liner, winding, lift, covered, sealed, ratio
):
    """Cone 1:5 under hoop plies, pressure from a share of the cover on, thread of 0.75 mm pitch.

    The liner beside the tip has `ratio` times its stress far away, at most the factor of the rows.
    """
    inner, bare, pressure = bore / 2, 6.66, 21.0
    tip, ramp = bare + covered, 5 * lift
    force = 0.98 * pressure * pi * inner**2

    def interface(z):
        return inner + liner + lift * (1 - np.clip((z - tip + ramp) / ramp, 0, 1))

    def shaped(s, z):  # s: 0 to 1 across the metal, 1 to 2 across the plies
        low = inner + s * (interface(z) - inner)
        return np.where(s <= 1, low, interface(z) + (s - 1) * winding)

    first, last = 0.375, bare - 0.375  # engaged turns
    pull = force / (2 * pi * inner * (last - first))
    metal = shell_oracle.isotropic(71_700, 0.33)
    hoop = shell_oracle.orthotropic((8500, 135_000, 8500), (0.3, 0.4, 0.3), 8500 / 2.8)
    parts = [(0, bare, 50), (bare, tip - ramp, 6), (max(bare, tip - ramp), tip, 24)]
    stations = [np.linspace(*part) for part in parts if part[1] > part[0]]
    after = tip + 4.0 + 26 * np.linspace(0, 1, 31) ** 1.5
    wall = shell_oracle.solved(
        radii=np.concatenate([np.linspace(0, 1, 12), 1 + np.linspace(0, 1, 13)[1:] ** 1.5]),
        stations=np.unique(
            np.round(np.concatenate([*stations, np.linspace(tip, tip + 4, 32), after]), 6)
        ),
        layers=[
            (lambda r, z: 1.0 * (r < interface(z)), metal),
            (lambda r, z: 1.0 * (r >= interface(z)), hoop),
        ],
        absent=lambda s, z: (s > 1) & (z < bare),
        shaped=shaped,
        loads=[
            (
                lambda r, z: (abs(r - inner) < 1e-6) & (z > bare + sealed * covered),
                lambda r, z: (0 * r + pressure, 0 * r),
            ),
            (
                lambda r, z: (abs(r - inner) < 1e-6) & (z > first) & (z < last),
                lambda r, z: (0 * r + pull * np.tan(np.radians(30)), 0 * r - pull),
            ),
        ],
        fixed_z=lambda r, z: abs(z - after[-1]) < 1e-6,
    )
    near, far = np.linspace(tip + 0.1 * liner, tip + 8, 80), np.array([tip + 20.0])
    faces = [lambda z: 0 * z + inner + 1e-3, lambda z: interface(z) - 1e-3]
    undisturbed = max(equivalent(wall.stress(face(far), far))[0] for face in faces)
    highest = max(equivalent(wall.stress(face(near), near)).max() for face in faces)
    assert highest / undisturbed == pytest.approx(ratio, abs=0.04)
    factor = thickened_end_peak(
        length=bare + covered, radius=inner, thickness=liner + lift + winding
    )
    assert highest < factor * undisturbed


# --- mass, section, STEP --------------------------------------------------------------------


@each
@both
def test_mass_section_and_step_agree(kind, liner):
    """The barrel with its sleeves weighs what the solids of the STEP file weigh."""
    actuator = ao.read(text_of(kind, liner=liner))
    evaluation, numbers = ao.evaluate(actuator), actuator.subject().numbers
    solids = bodies(evaluation)
    read = StepFile(step(solids, name="knee", program="test"))
    count: dict[str, int] = {}
    for name, _ in read.occurrences():
        count[name] = count.get(name, 0) + 1
    found = {}
    for body in solids:
        density = numbers[f"materials.{body.material}.density"]
        mass = count[body.name] * volume(read.solids()[body.name]) * 1e-9 * density
        found[body.part] = found.get(body.part, 0.0) + mass
    barrel = sum(x for part, x in found.items() if part.startswith("layup") or part == "sleeves")
    assert barrel == pytest.approx(evaluation.mass_parts["barrel"], rel=1e-9)
    assert found["caps"] == pytest.approx(evaluation.mass_parts["caps"], rel=1e-9)


def test_mass_by_hand():
    """Two sleeves of 2.2 mm over 32 mm, tips of 11 mm, plies lifted over 25 mm and bare over 7."""
    light, heavy = (
        ao.evaluate(ao.read(text_of(block=SLEEVE.replace("2.2 mm", f"{wall} mm"))))
        for wall in (2.2, 2.4)
    )
    r, rho = 11.5, 2810e-9  # mm, kg/mm^3
    plies = 1600e-9 if light is None else ao.read(text_of()).subject().numbers[
        "materials.t700_epoxy.density"
    ] * 1e-9  # fmt: skip

    def added(wall):
        tip = 5 * wall
        ring = pi * ((r + wall) ** 2 - r**2) * (32 - tip)
        xs = np.linspace(0, tip, 20_001)
        cone = np.trapezoid(pi * ((r + wall * xs / tip) ** 2 - r**2), xs)
        lifted = 2 * pi * 2.0 * wall * (25 - tip / 2)
        return 2 * (rho * (ring + cone) + plies * lifted)

    gained = heavy.mass_parts["barrel"] - light.mass_parts["barrel"]
    assert gained == pytest.approx(added(2.4) - added(2.2), rel=1e-6)


# --- the design file ------------------------------------------------------------------------


HOOP = HELICAL.replace("25 deg", "85 deg")
CASES = {
    "no metal": (
        text_of(block=SLEEVE.replace("al_7075_t6", "pa12_mjf")),
        "retention.sleeve.material", "cut into the sleeve, but this is of a polymer",
    ),
    "other metal than the liner": (
        text_of(block=SLEEVE.replace("al_7075_t6", "steel_42crmo4"), liner=True),
        "retention.sleeve.material", "cannot be one piece",
    ),
    "hoop plies only": (
        text_of().replace(HELICAL, HOOP), "retention.sleeve.material", "no axial force",
    ),
    "no plies": (
        metal_tube("plug_thread").replace("    pitch: 0.75 mm\n", f"    pitch: 0.75 mm\n{SLEEVE}"),
        "retention.sleeve", "no winding",
    ),
    "thinner than the liner": (
        text_of(block=SLEEVE.replace("2.2", "1.9"), liner=True).replace("0.6 mm", "2 mm"),
        "retention.sleeve.wall", "thinner than the liner",
    ),
    "thicker than it fits": (
        text_of(block=SLEEVE.replace("25 mm", "8 mm")), "retention.sleeve.wall", "does not fit",
    ),
    "too thin for its thread": (
        text_of(block=SLEEVE.replace("2.2", "1.2")), "retention.sleeve.wall", "the thread of the",
    ),
    "sleeve of a bond": (
        BONDED.replace(RETENTION, f"{RETENTION.rstrip()}\n{SLEEVE}\n").replace(STATIC, ""),
        "retention.sleeve", "a bond has no sleeve",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_faults(case):
    """One line at the key of the sleeve, with what to do."""
    text, path, words = CASES[case]
    one = fault(text)
    assert one.path == path
    assert words in one.message
    assert one.remedy


def test_each_end_variables_and_choices():
    """A sleeve at the cap, a bond at the head; PATHs of the sleeve vary and are chosen."""
    sleeved = (BLOCKS["plug_thread"] + SLEEVE).replace("\n  ", "\n    ")
    bond = RETENTION.partition("\n")[2].rstrip().replace("\n  ", "\n    ")
    ends = f"retention:\n  cap:\n    type: plug_thread\n  {sleeved.rstrip()}\n  head:\n  {bond}\n\n"
    text = text_of().replace(text_of()[text_of().index("retention:\n") :], "")
    rest = BONDED[BONDED.index("clevis:\n") :]
    text = text + ends + rest + (
        "variables:\n  retention.cap.sleeve.wall:\n    lower: 2 mm\n    upper: 4 mm\n"
        "choices:\n  retention.cap.sleeve.material: [none, al_7075_t6, steel_42crmo4]\n"
        "  retention.cap.type: [plug_thread, bond]\n"
    )  # fmt: skip
    text = text.replace(
        "    type: plug_thread\n", "    type: plug_thread\n    material: epoxy_structural\n"
    )
    actuator = ao.read(text)
    looks = possible(actuator.subject())
    assert "of plies, whose fibres it would cut" in looks[0].fault
    found = [
        (design.retention.cap.type, design.retention.cap.sleeve, len(design.variables))
        for design in (look.subject.design for look in looks if not look.fault)
    ]
    assert [(kind, one and one.material, count) for kind, one, count in found] == [
        ("bond", None, 0),
        ("plug_thread", "al_7075_t6", 1),
        ("plug_thread", "steel_42crmo4", 1),
    ]
    assert actuator.design.retention.cap.sleeve.wall == pytest.approx(2.2e-3)
    subject = actuator.subject()
    rows = compute(subject, subject.values()).computed.metrics["retention_factor"]
    assert f"cap: {sleeve.OUTER}" in rows
    assert not any(place.startswith("head: edge") for place in rows)
    wider = read_design(text, overrides=[("retention.cap.sleeve.inner_length", "30 mm")])
    assert wider.design.retention.cap.sleeve.inner_length == pytest.approx(30e-3)


def test_short_overlap_is_a_warning():
    """Below 6/lambda, both numbers are named; a long overlap has no such warning."""
    short = ao.evaluate(ao.read(text_of(block=SLEEVE.replace("25 mm", "15 mm"))))
    (warning,) = [one for one in short.warnings if "6/lambda" in one]
    assert "covers 15 mm" in warning
    long = ao.evaluate(ao.read(text_of(block=SLEEVE.replace("25 mm", "40 mm"))))
    assert not any("6/lambda" in one for one in long.warnings)


def test_gradients_are_exact():
    """Rows of the sleeve under a complex step, against differences of the numbers."""
    for liner in (True, False):
        subject = ao.read(text_of(liner=liner)).subject()
        for path in ("retention.sleeve.wall", "retention.sleeve.inner_length", "cylinder.bore"):
            start = subject.numbers[path]

            def rows(value, path=path, subject=subject):
                changed = replace(subject, numbers={**subject.numbers, path: value})
                metrics = compute(changed, changed.values()).computed.metrics
                return np.array(
                    [
                        np.ravel(metrics[metric][place])[0]
                        for metric in ("retention_factor", "retention_burst_factor", "yield_factor")
                        for place in metrics[metric]
                        if place in (sleeve.OUTER, sleeve.INNER, sleeve.BARE)
                    ]
                )

            slope = rows(np.array([start + 1e-20j])).imag / 1e-20
            step_size = 1e-5 * start
            other = (rows(np.array([start + step_size])) - rows(np.array([start - step_size]))) / (
                2 * step_size
            )
            assert slope == pytest.approx(np.real(other), rel=1e-4, abs=1e-3)
