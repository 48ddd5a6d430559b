"""Plugs screwed into the bore: stress of the barrel there, refusals, masses, a whole knee."""

from __future__ import annotations

from math import pi, radians, sqrt, tan
from pathlib import Path

import numpy as np
import pytest
import shell_oracle
from scipy.sparse import diags, lil_matrix
from scipy.sparse.linalg import spsolve
from shipped import KNEE, PLAIN_KNEE

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.evaluation import compute
from actuator_opt.models import thread

DESIGNS = Path(__file__).parents[2] / "designs"
FORCE = 7273.57


def near(value, rel=1e-9):
    """As equal as two ways through the same numbers."""
    return pytest.approx(value, rel=rel)


def complaints(**changes):
    """Every (path, message) with which the knee is refused."""
    with pytest.raises(InputError) as error:
        ao.read(PLAIN_KNEE, set={path: str(value) for path, value in changes.items()})
    return [(one.path, one.message) for one in error.value.diagnostics]


@pytest.mark.parametrize(
    ("thick", "depth", "length", "winding"),
    [
        pytest.param(2.2, 0.55, 4.0, 0.0, marks=pytest.mark.long),
        pytest.param(2.2, 0.55, 9.0, 0.0, marks=pytest.mark.long),
        (2.2, 0.55, 6.0, 3.0),
        pytest.param(1.694, 0.406, 6.4, 0.0, marks=pytest.mark.long),  # the knee at its optimum
        (1.694, 0.406, 6.4, 2.76),
    ],
)
def test_barrel_at_the_thread_against_finite_elements(thick, depth, length, winding):
    """The force enters along the roots: at most 7 % above on bare metal."""
    inner = 10.5
    outer = inner + thick
    metal = shell_oracle.isotropic(71700, 0.33)
    hoop = shell_oracle.orthotropic((9000, 125000, 9000), (0.3, 0.4, 0.3), 3200)
    radii = [*np.linspace(inner, inner + depth, 5), *np.linspace(inner + depth, outer, 13)[1:]]
    if winding:
        radii += [*np.linspace(outer, outer + winding, 8)[1:]]
    stations = [
        *np.linspace(0, length, 50),
        *np.linspace(length, length + 6, 40)[1:],
        *np.linspace(length + 6, 45, 35)[1:],
    ]
    shear = FORCE / (2 * pi * (inner + depth) * length)
    wall = shell_oracle.solved(
        radii=radii,
        stations=stations,
        layers=[
            (lambda r, z: 1.0 * (r < outer), metal),
            (lambda r, z: 1.0 * (r > outer), hoop),
        ],
        absent=lambda r, z: (r < inner + depth) & (z < length),
        loads=[
            (
                lambda r, z: (abs(r - inner - depth) < 1e-6) & (z < length),
                lambda r, z: (0 * r, 0 * r - shear),
            )
        ],
        fixed_z=lambda r, z: abs(z - 45) < 1e-6,
    )
    found = sum(wall.through(length - 0.03, inner + depth, outer))
    axial, bending = thread.internal_wall_stresses(
        force=FORCE,
        diameter=2e-3 * (inner + depth),
        pitch=1e-9,  # the flanks of such a thread are at its roots
        engagement=1e-3 * length,
        bore_diameter=2e-3 * inner,
        outer_diameter=2e-3 * outer,
        poissons_ratio=0.33,
    )
    assert axial == near(FORCE / (pi * (outer**2 - (inner + depth) ** 2)) * 1e6)
    ratio = (axial + bending) / 1e6 / found
    assert 0.99 <= ratio <= (1.4 if winding else 1.07)


def test_couples_along_the_thread_by_quadrature():
    """F of the docstring against the bending of a long beam with a free end, cell by cell."""
    size = {"diameter": 22e-3, "outer_diameter": 25e-3, "bore_diameter": 22e-3}
    radius, thick, length = 11.75e-3, 1.5e-3, 5e-3
    beta = (3 * (1 - 0.09)) ** 0.25 / sqrt(radius * thick)
    cells, cell = 4000, 40e-3 / 4000  # finite differences of D w'''' + k w = -m'
    place = (np.arange(cells + 1)) * cell
    curve = lil_matrix((cells + 1, cells + 1))
    for i in range(1, cells):
        curve[i, i - 1], curve[i, i], curve[i, i + 1] = 1, -2, 1
    curve = curve.tocsr() / cell**2
    weight = np.full(cells + 1, cell)
    weight[[0, -1]] = cell / 2
    stiff = curve.T @ diags(weight) @ curve + 4 * beta**4 * diags(weight)
    couple = np.where(place < length, 1.0, 0.0)  # m per length does work on the slope
    load = np.zeros(cells + 1)
    middle = (couple[:-1] + couple[1:]) / 2
    load[:-1] -= middle
    load[1:] += middle
    deflection = spsolve(stiff.tocsc(), load)
    moment = (curve @ deflection)[round(length / cell)]
    expected = abs(moment) / length
    axial, bending = thread.internal_wall_stresses(
        force=FORCE, pitch=1e-9, engagement=length, poissons_ratio=0.3, **size
    )
    line = FORCE / (2 * pi * radius)
    assert axial == near(line / thick, 1e-6)
    assert bending * thick**2 / 6 / (line * thick / 2) == near(expected, 0.01)


@pytest.mark.parametrize(
    ("changes", "path", "said"),
    [
        ({"barrel.layup[0].material": "t700_epoxy"}, "barrel.layup[0].material", "plies"),
        ({"barrel.layup[0].thickness": "1.2 mm"}, "barrel.layup[0].thickness", "leaves 0.3881"),
        ({"caps.material": "pa12_mjf"}, "caps.material", "needs a metal"),
        ({"retention.length": "1 mm"}, "retention.length", "less than one turn"),
        ({"retention.material": "steel_42crmo4"}, "retention.material", "has no effect"),
    ],
)
def test_a_thread_that_cannot_be_cut_is_refused(changes, path, said):
    """Plies, a thin liner, a polymer plug, no engaged turn: each by its place."""
    found = complaints(**changes)
    assert any(one == path and said in message for one, message in found), found


def test_masses_by_hand():
    """The barrel encloses plate and thread, which counts at its pitch diameter."""
    static = KNEE[KNEE.index("  static:") : KNEE.index("load:\n")]
    parts = ao.evaluate(ao.read(PLAIN_KNEE.replace(static, ""))).mass_parts
    inner, plate, length, pitch = 10.9e-3, 4.7e-3, 7e-3, 0.75e-3
    height = sqrt(3) / 2 * pitch
    minor = inner + 0.14 * 1.78e-3 + 0.05e-3  # the ring of the piston passes, in a shallow gland
    middle = minor + (5 / 8 - 3 / 8) * height
    root = minor + (5 / 8 - 17 / 24) * height
    radii = np.array([inner, inner + 1.85e-3, inner + 4.5e-3])
    wall = pi * np.sum(np.array([2810.0, 1570.0]) * np.diff(radii**2))
    barrel = wall * (110e-3 + 12.5e-3 + 8e-3 + 2 * (plate + length))
    cut = 2810.0 * 2 * pi * (middle**2 - inner**2) * length
    assert parts["barrel"] == near(barrel - cut)
    plates = 2810.0 * pi * plate * (2 * inner**2 - (6e-3 + 30e-6) ** 2)
    skirts = 2810.0 * 2 * pi * (middle**2 - (root - 1.1e-3) ** 2) * length
    assert parts["caps"] == near(plates + skirts)


def burst_rows(text):
    """Rows of the breaking load of a knee, and its joint under load."""
    subject = ao.read(text).subject()
    run = compute(subject, subject.values())
    found = run.computed.metrics["retention_burst_factor"]
    return {place: float(np.ravel(x)[0]) for place, x in found.items()}, run.joints[0].loaded


def test_rim_and_skirt_of_the_plug_by_hand():
    """The force crosses the lip behind the seal's groove; the skirt is pressed and squeezed."""
    for wall in (1.1, 3.0):
        rows, loaded = burst_rows(PLAIN_KNEE.replace("wall: 1.1 mm", f"wall: {wall} mm"))
        strength = float(loaded.materials.allowable("al_7075_t6", "ultimate_strength"))
        force = 21.0 * pi / 4 * 21.8**2  # N, mm, MPa from here on
        height = sqrt(3) / 2 * 0.75
        minor = 10.9 + 0.2 * 1.78 + 0.05
        root = minor + (5 / 8 - 17 / 24) * height
        bottom, lip = 10.9 - 0.8 * 1.78, (4.7 - 1.3655 * 1.78) / 2
        shear = strength * 1e-6 / sqrt(3) * 2 * pi * bottom * lip / force
        inner = root - wall
        if inner > bottom:  # a fully plastic lip, M_p = sigma b^2/4
            bend = strength * 1e-6 * lip**2 / 4 / (force / (2 * pi * bottom) * (inner - bottom) / 2)
            expected = 1 / sqrt(1 / shear**2 + 1 / bend**2)
        else:
            expected = shear + strength * 1e-6 * pi * (bottom**2 - inner**2) / force
        assert rows["plug behind its static seal"] == near(expected)
        axial = force / (pi * (root**2 - inner**2))
        hoop = force * tan(radians(30)) / (2 * pi * wall * (7.0 - 0.8 * 0.75))
        assert rows["plug under its thread"] == near(strength * 1e-6 / max(axial, hoop), 1e-6)


@pytest.mark.parametrize(
    ("wall", "length", "plate", "share"),
    [(1.1, 7.0, 4.7, 0.92), (1.1, 7.0, 12.0, 0.74), (2.2, 5.0, 4.7, 0.43)],
)
def test_skirt_of_the_plug_by_finite_elements(wall, length, plate, share):
    """Plate and thread press the skirt; it bends less at the plate than at a rigid clamp."""
    root, pressure, engaged = 11.0, 21.0, length - 0.8 * 0.75
    inner, end = root - wall, plate + engaged
    force = pressure * pi * root**2
    pull = force / (2 * pi * root * engaged)
    whole = shell_oracle.solved(
        radii=np.concatenate([np.linspace(0.5, inner, 15), np.linspace(inner, root, 7)[1:]]),
        stations=np.concatenate([np.linspace(0, plate, 12), np.linspace(plate, end, 21)[1:]]),
        layers=[(lambda r, z: 1 + 0 * r, shell_oracle.isotropic(71_700, 0.33))],
        absent=lambda r, z: (z > plate) & (r < inner),
        loads=[
            (lambda r, z: z < 1e-6, lambda r, z: (0 * r, 0 * r + pressure)),
            (
                lambda r, z: (abs(r - root) < 1e-6) & (z > plate),
                lambda r, z: (0 * r - pull * tan(radians(30)), 0 * r - pull),
            ),
        ],
        fixed_z=lambda r, z: (z < 1e-6) & (r < 0.6),
    )
    mean, bending = whole.through(plate + 0.05 * wall, inner, root)
    axial, hoop, clamped = thread.skirt_stresses(
        force=force, root_diameter=2 * root, thickness=wall, engagement=engaged, poissons_ratio=0.33
    )
    assert hoop == near(pull * tan(radians(30)) * root / wall)
    assert mean == near(-axial, 0.05)  # compression
    assert (abs(mean) + abs(bending)) / (axial + clamped) == near(share, 0.06)
    assert abs(bending) + mean < axial  # tension


@pytest.mark.long
def test_the_screwed_knee_beats_the_bonded_knee():
    """Without the nut, which the bonded knee does not have, by at least 15 %."""
    bonded = ao.optimise(ao.read(DESIGNS / "knee_bonded.yaml"), prices=False)
    nut = KNEE[KNEE.index("  nut:") : KNEE.index("\nhead:")]
    free = KNEE[KNEE.index("  piston.nut.preload:") : KNEE.index("  cylinder.bore:\n")]
    screwed = ao.optimise(ao.read(KNEE.replace(nut, "").replace(free, "")), prices=False)
    assert screwed.status == "optimal"
    assert screwed.kkt.residual < 1e-6
    masses = [one.evaluation.metrics["mass"].value for one in (screwed, bonded)]
    assert masses[0] < 0.85 * masses[1]
