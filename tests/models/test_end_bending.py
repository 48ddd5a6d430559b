"""Bending of walls at clamps and steps: worked numbers, and axisymmetric finite elements."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import shell_oracle
from scipy.integrate import solve_bvp

from actuator_opt.models import end_bending
from actuator_opt.models.end_bending import Shell, ShellLayer

FORCE = 7273.57


def near(value, rel=1e-5):
    """Equal to six digits."""
    return pytest.approx(value, rel=rel)


def metal(thickness, modulus=71.7e9, ratio=0.33):
    """A metal layer."""
    stiff = modulus / (1 - ratio**2)
    return ShellLayer(thickness, stiff, stiff, ratio * stiff, modulus / (2 * (1 + ratio)))


def hoop(thickness):
    """Plies wound around the axis: 125 GPa around, 9 GPa along, 3.2 GPa in transverse shear."""
    factor = 1 - 0.3**2 * 9 / 125
    return ShellLayer(thickness, 9e9 / factor, 125e9 / factor, 0.3 * 9e9 / factor, 3.2e9)


def test_clamp_by_the_worked_numbers_of_aluminium():
    """D 22.63, k 383.337, M_0 215.135 thin and 197.867 with shear, 28 MPa on 1.5 mm."""
    wall = end_bending.shell(layers=[metal(1.5e-3)], inner_radius=16e-3)
    assert wall.bending == near(22.6300)
    assert wall.foundation == near(383.337e9)
    assert wall.shear == near(5 / 6 * 71.7e9 / 2.66 * 1.5e-3)  # 5/6 G t of a homogeneous wall
    growth = end_bending.free_growth(wall=wall, pressure=28e6, bore_radius=16e-3, line_force=0.0)
    assert growth == near(28e6 * 16e-3 * 16.75e-3 / (71.7e9 * 1.5e-3))
    stated = replace(wall, shear=33.75e6)
    assert end_bending.clamped(wall=stated, growth=73.0428e-6).moment == near(197.867)
    thin = end_bending.clamped(wall=replace(wall, shear=1e15), growth=73.0428e-6)
    assert thin.moment == near(215.135)
    assert thin.force == near(109.761e3)


def test_step_by_the_worked_numbers():
    """D 20/160, k 400/800, w 10/5 um, N e 82.5: |M| 16.9043 and 65.5957 on both sides."""
    left = Shell(20.0, 400e9, 1e15, 0.0, 1e-2, 1e8, 3e7)
    right = Shell(160.0, 800e9, 1e15, 0.0, 1e-2, 2e8, 6e7)
    edge = end_bending.stepped(
        left=left, right=right, left_growth=10e-6, right_growth=5e-6, offset_moment=82.5
    )
    assert edge.growth == near(9.02837e-6)
    assert edge.moment == near(65.5957)
    mirrored = end_bending.stepped(
        left=right, right=left, left_growth=5e-6, right_growth=10e-6, offset_moment=-82.5
    )
    assert abs(mirrored.moment) == near(16.9043)


def test_clamp_against_the_equation_of_the_shell():
    """Q = S (w' + psi), Q' = k (w - w_0), D psi'' = Q, solved as a boundary value problem."""
    wall = end_bending.shell(layers=[metal(0.9e-3), hoop(2.9e-3)], inner_radius=10.5e-3)
    free = 6e-3  # in N and mm from here on
    bending, shear, foundation = 1e3 * wall.bending, 1e-3 * wall.shear, 1e-9 * wall.foundation

    def slopes(x, y):
        w, force, turn, curve = y
        strain = force / shear
        return np.stack([strain - turn, foundation * (w - free), curve, force / bending])

    ends = np.linspace(0, 60, 400)
    guess = np.zeros((4, 400))
    guess[0] = free * (1 - np.exp(-ends / 5))
    answer = solve_bvp(
        slopes, lambda a, b: [a[0], a[2], b[0] - free, b[2]], ends, guess, tol=1e-7,
        max_nodes=100_000,
    )  # fmt: skip
    assert answer.success
    edge = end_bending.clamped(wall=wall, growth=1e-3 * free)
    w, force, _, curve = answer.sol(0.0)
    assert abs(curve) * bending == near(edge.moment, 1e-4)
    assert abs(force) * 1e3 == near(edge.force, 1e-4)
    assert w == near(1e3 * edge.growth)


@pytest.mark.parametrize("soft", [1e15, 20e6])
def test_step_against_the_equations_of_both_shells(soft):
    """Both walls as in the test of the clamp, joined with w, psi and Q equal and M apart by N e."""
    left = Shell(20.0, 400e9, soft, 0.0, 1e-2, 1e8, 3e7)
    right = Shell(160.0, 800e9, 2 * soft, 0.0, 1e-2, 2e8, 6e7)
    far, offset = (10e-3, 5e-3), 82.5  # growths in mm, moment in N
    walls = [(1e3 * w.bending, 1e-3 * w.shear, 1e-9 * w.foundation) for w in (left, right)]

    def slopes(x, y):
        out = []
        for (bending, shear, foundation), free, part in zip(
            walls, far, np.split(y, 2), strict=True
        ):
            w, force, turn, curve = part
            out += [force / shear - turn, foundation * (w - free), curve, force / bending]
        return np.stack(out)

    def ends(a, b):
        (w1, q1, t1, c1), (w2, q2, t2, c2) = a[:4], a[4:]
        jump = walls[1][0] * c2 - walls[0][0] * c1
        rest = [b[0] - far[0], b[2], b[4] - far[1], b[6]]
        return np.array([w1 - w2, t1 + t2, q1 + q2, jump + offset, *rest])

    x, guess = np.linspace(0, 60, 400), np.zeros((8, 400))
    guess[0], guess[4] = far
    answer = solve_bvp(slopes, ends, x, guess, tol=1e-6, max_nodes=100_000)
    assert answer.success
    edge = end_bending.stepped(
        left=left, right=right, left_growth=1e-3 * far[0], right_growth=1e-3 * far[1],
        offset_moment=offset,
    )  # fmt: skip
    w, force, _, curve = answer.sol(0.0)[4:]
    assert w == near(1e3 * edge.growth, 1e-4)
    assert abs(curve) * walls[1][0] == near(abs(edge.moment), 1e-4)
    assert abs(force) * 1e3 == near(abs(edge.force), 1e-4)


def grid(*parts):
    """Points of several intervals (start, stop, cells)."""
    points = [np.linspace(start, stop, cells + 1) for start, stop, cells in parts]
    return np.unique(np.round(np.concatenate(points), 9))


HOOP = shell_oracle.orthotropic((9000, 125000, 9000), (0.3, 0.4, 0.3), 3200)
METAL = shell_oracle.isotropic(71700, 0.33)


@pytest.mark.parametrize(
    ("inner", "liner", "winding"),
    [
        (16.0, 1.5, 0.0),
        pytest.param(10.5, 0.6, 1.2, marks=pytest.mark.long),
        (10.5, 1.56, 2.48),
    ],
)
def test_clamp_against_finite_elements(inner, liner, winding):
    """Moment of a rigidly clamped wall, 0.2 mm from the clamp, within -20 and +25 %."""
    pressure, outer = 21.0, inner + liner + winding
    layers = [
        (lambda r, z: 1.0 * (r < inner + liner), METAL),
        (lambda r, z: 1.0 * (r > inner + liner), HOOP),
    ]
    radii = [(inner, inner + liner, 10)]
    if winding:
        radii.append((inner + liner, outer, 14))
    wall = shell_oracle.solved(
        radii=grid(*radii),
        stations=grid((0, 1, 25), (1, 8, 50), (8, 45, 40)),
        layers=layers,
        loads=[(lambda r, z: abs(r - inner) < 1e-6, lambda r, z: (0 * r + pressure, 0 * r))],
        fixed_r=lambda r, z: abs(z) < 1e-6,
        fixed_z=lambda r, z: abs(z) < 1e-6,
    )
    own = [metal(1e-3 * liner), *([hoop(1e-3 * winding)] if winding else [])]
    shell = end_bending.shell(layers=own, inner_radius=1e-3 * inner)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    moment = 0.0
    for low, high in [(inner, inner + liner), (inner + liner, outer)]:
        r = (low + high) / 2 + (high - low) / 2 * nodes
        if high > low:
            axial = wall.stress(r, np.full_like(r, 0.2))[2]
            lever = inner + 1e3 * shell.centre - r
            moment += np.sum(weights * axial * lever * r) * (high - low) / 2
    moment /= 1e3 * shell.radius
    far = wall.moved(np.array([(inner + outer) / 2]), np.array([25.0]))[0, 0]
    edge = end_bending.clamped(wall=shell, growth=1e-3 * far)
    assert 0.8 <= edge.moment / moment <= 1.25
    growth = end_bending.free_growth(
        wall=shell, pressure=21e6, bore_radius=1e-3 * inner, line_force=0.0
    )
    assert growth == near(1e-3 * far, 0.15)


def test_step_at_a_skirt_against_finite_elements():
    """A barrel under a skirt: axial stress of the bore beside it, offset included, within 25 %."""
    inner, thick, skirt, length = 10.5, 1.8, 1.2, 14.0
    pressure, outer = 21.0, inner + 1.8 + 1.2
    line = FORCE / (pi * (outer**2 - inner**2))
    wall = shell_oracle.solved(
        radii=grid((inner, inner + thick, 14), (inner + thick, outer, 10)),
        stations=grid((0, 10, 40), (10, length, 40), (length, 20, 60), (20, 50, 40)),
        layers=[(lambda r, z: 1.0 + 0 * r, METAL)],
        absent=lambda r, z: (r > inner + thick) & (z > length),
        loads=[
            (lambda r, z: abs(r - inner) < 1e-6, lambda r, z: (0 * r + pressure, 0 * r)),
            (lambda r, z: abs(z) < 1e-6, lambda r, z: (0 * r, 0 * r - line)),
        ],
        fixed_z=lambda r, z: abs(z - 50) < 1e-6,
    )
    mean, bending = wall.through(length + 0.2, inner, inner + thick)
    own = metal(1e-3 * thick)
    right = end_bending.shell(layers=[own], inner_radius=1e-3 * inner)
    left = end_bending.shell(layers=[own, metal(1e-3 * skirt)], inner_radius=1e-3 * inner)
    along = FORCE / (2 * pi * right.radius)
    growths = [
        end_bending.free_growth(
            wall=shell, pressure=21e6, bore_radius=1e-3 * inner,
            line_force=FORCE / (2 * pi * shell.radius),
        )
        for shell in (left, right)
    ]  # fmt: skip
    edge = end_bending.stepped(
        left=left, right=right, left_growth=growths[0], right_growth=growths[1],
        offset_moment=along * (right.centre - left.centre),
    )  # fmt: skip
    (axial, _), (outside, _) = end_bending.edge_stresses(
        layer=own, start=0.0, wall=right, edge=edge, line_force=along
    )
    assert (axial - outside) / 2e6 == near(bending, 0.25)
    assert (axial + outside) / 2e6 == near(mean, 0.1)


def test_shear_through_the_thickness_by_quadrature():
    """Shear is Q int_z Q_zz (z - z_n) dz/D: 1.5 Q/t in one layer, largest at a ply's face."""
    layers = [metal(1.6e-3), hoop(2.7e-3)]
    wall = end_bending.shell(layers=layers, inner_radius=10.75e-3)
    z = np.linspace(0, 4.3e-3, 430_001)
    modulus = np.where(z < 1.6e-3, layers[0].axial, layers[1].axial)
    slope = modulus * (z - wall.centre)
    flow = np.concatenate([[0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(z))])
    shear = np.abs(flow) * 12e3 / wall.bending
    stresses = end_bending.interlaminar_shear(layers=layers, wall=wall, force=12e3)
    assert stresses[0] == near(shear[z < 1.6e-3].max(), 1e-4)
    assert stresses[1] == near(shear[z > 1.6e-3].max(), 1e-4)
    assert stresses[1] < stresses[0]  # the stiffness centre is in the metal
    one = [metal(1.5e-3)]
    single = end_bending.shell(layers=one, inner_radius=16e-3)
    (stress,) = end_bending.interlaminar_shear(layers=one, wall=single, force=-1e5)
    assert stress == near(1.5 * 1e5 / 1.5e-3)


def test_shear_at_a_groove_against_the_equation_of_the_shell():
    """Largest shear force of a pressure step, and of a moment at a free end, each alone."""
    wall = end_bending.shell(layers=[metal(1.6e-3), hoop(2.7e-3)], inner_radius=10.75e-3)
    bending, shear, foundation = 1e3 * wall.bending, 1e-3 * wall.shear, 1e-9 * wall.foundation
    ends = grid((-60, -0.1, 600), (-0.1, 0.1, 400), (0.1, 60, 600))

    def slopes(x, y, step):
        w, force, turn, curve = y
        free = 4e-3 * step / (1 + np.exp(np.clip(-x / 0.004, -700, 700)))
        return np.stack([force / shear - turn, foundation * (w - free), curve, force / bending])

    step = solve_bvp(
        lambda x, y: slopes(x, y, 1.0),
        lambda a, b: [a[0], a[2], b[0] - 4e-3, b[2]],
        ends, np.zeros((4, len(ends))), tol=1e-6, max_nodes=100_000,
    )  # fmt: skip
    assert step.success
    bound = end_bending.groove_shear(wall=wall, growth=4e-6, groove_moment=0.0)
    assert np.abs(step.sol(ends)[1]).max() * 1e3 == near(bound, 5e-3)
    half = np.linspace(0, 60, 601)
    turned = solve_bvp(
        lambda x, y: slopes(x, y, 0.0),
        lambda a, b: [a[1], bending * a[3] - 80.0, b[0], b[2]],
        half, np.zeros((4, len(half))), tol=1e-6, max_nodes=100_000,
    )  # fmt: skip
    assert turned.success
    bound = end_bending.groove_shear(wall=wall, growth=0.0, groove_moment=80.0)
    assert 0.8 * bound <= np.abs(turned.sol(half)[1]).max() * 1e3 <= bound


def test_strain_changes_by_the_stresses_of_the_edge():
    """Hooke's law with the changes of strain gives the changes of `edge_stresses`."""
    layers = [metal(0.9e-3), hoop(2.9e-3)]
    wall = end_bending.shell(layers=layers, inner_radius=10.5e-3)
    edge = end_bending.Edge(3e-6, 60.0, 0.0)
    at_edge, far = (
        end_bending.edge_stresses(
            layer=layers[1], start=0.9e-3, wall=wall, edge=state, line_force=9e4
        )
        for state in (edge, end_bending.Edge(7e-6, 0.0, 0.0))
    )
    for face, place in enumerate((0.9e-3, 3.8e-3)):
        axial, hoop_strain = end_bending.strain_changes(
            place=place, wall=wall, edge=edge, growth=7e-6
        )
        change = layers[1].coupling * axial + layers[1].hoop * hoop_strain
        assert change == near(at_edge[face][1] - far[face][1])
        change = layers[1].axial * axial + layers[1].coupling * hoop_strain
        assert change == near(at_edge[face][0] - far[face][0])


def test_sleeve_at_the_end_of_its_winding_against_finite_elements():
    """Aluminium of 2 mm, bare and under 3 mm of helical plies, pulled: bending is an upper bound.

    The step takes up the winding at once, but its force enters over several millimetres.
    """
    inner, thick, wound, end = 10.75, 2.0, 3.0, 15.0
    outer = inner + thick
    line = FORCE / (pi * (outer**2 - inner**2))
    plies = shell_oracle.orthotropic((9000, 40000, 75000), (0.1, 0.3, 0.4), 3800)
    wall = shell_oracle.solved(
        radii=grid((inner, outer, 8), (outer, outer + wound, 8)),
        stations=grid((0, 10, 10), (10, end, 25), (end, 22, 25), (22, 50, 15)),
        layers=[(lambda r, z: 1.0 * (r < outer), METAL), (lambda r, z: 1.0 * (r > outer), plies)],
        absent=lambda r, z: (r > outer) & (z < end),
        loads=[(lambda r, z: abs(z) < 1e-6, lambda r, z: (0 * r, 0 * r - line))],
        fixed_z=lambda r, z: abs(z - 50) < 1e-6,
    )
    mean, bending = wall.through(end - 0.3, inner, outer)
    factor = 1 - 0.4**2 * 40 / 75  # nu_zt = 0.4, from E_z = 75 GPa and E_t = 40 GPa
    coupled = 0.4 * 40e9 / factor
    own = metal(1e-3 * thick)
    around = ShellLayer(1e-3 * wound, 75e9 / factor, 40e9 / factor, coupled, 3.8e9)
    bare, whole = (
        end_bending.shell(layers=layers, inner_radius=1e-3 * inner)
        for layers in ([own], [own, around])
    )
    along = FORCE / (2 * pi * bare.radius)
    growths = [
        end_bending.free_growth(
            wall=one, pressure=0.0, bore_radius=1e-3 * inner,
            line_force=FORCE / (2 * pi * one.radius),
        )
        for one in (whole, bare)
    ]  # fmt: skip
    edge = end_bending.stepped(
        left=whole, right=bare, left_growth=growths[0], right_growth=growths[1],
        offset_moment=along * (bare.centre - whole.centre),
    )  # fmt: skip
    (axial, _), (outside, _) = end_bending.edge_stresses(
        layer=own, start=0.0, wall=bare, edge=edge, line_force=along
    )
    assert (axial + outside) / 2e6 == near(mean, 0.1)
    assert 1.0 <= (axial - outside) / 2e6 / bending <= 2.5
    assert 1.0 <= outside / 1e6 / (mean - bending) <= 1.5
