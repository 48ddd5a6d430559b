"""Rows of first-ply failure where the barrel bends beside a joint."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from shipped import PLAIN_KNEE

import actuator_opt as ao
from actuator_opt.evaluation import kernel
from actuator_opt.joints.overlap import edge_beside

DESIGNS = Path(__file__).parents[2] / "designs"


def ran(name, **changes):
    """All rows of a shipped design, and the wall and joint behind them."""
    subject = ao.read(DESIGNS / f"{name}.yaml", set=changes).subject()
    return kernel.compute(subject, subject.values())


def rows(run, metric="first_ply_factor"):
    """Values of a metric by location."""
    return {at: float(np.ravel(np.real(x))[0]) for at, x in run.computed.metrics[metric].items()}


def number(value):
    """The number of a value of one design."""
    return float(np.ravel(np.real(value))[0])


def test_plies_beside_a_skirt_by_hand():
    """Matrix rotation of the strain change, plus the exact wall and cure, by maximum stress."""
    run = ran("knee_bonded")
    (end,), plies = run.joints, run.wall.plies
    beside = edge_beside(end.loaded)
    wall, edge = beside.wall, beside.edge
    supply = number(end.loaded.pressure)
    shift = number(edge.growth - beside.growth) / number(wall.radius)
    start = np.cumsum([0.0, *(number(layer.thickness) for layer in plies.layers)])
    names = ("tension_1", "compression_1", "tension_2", "compression_2", "shear_12")
    for k, i in enumerate(plies.rows):
        layer = plies.layers[i]
        cosine, sine = np.cos(number(layer.angle)), np.sin(number(layer.angle))
        c = {key: number(value) for key, value in layer.constants.items()}
        compliance = np.array(
            [
                [1 / c["youngs_modulus_1"], -c["poissons_ratio_12"] / c["youngs_modulus_1"], 0],
                [-c["poissons_ratio_12"] / c["youngs_modulus_1"], 1 / c["youngs_modulus_2"], 0],
                [0, 0, 1 / c["shear_modulus_12"]],
            ]
        )
        for t, climate in enumerate(plies.climates):
            strengths = [number(getattr(layer.strengths[t], name)) for name in names]
            factors = []
            for face in (0, 1):
                lever = number(wall.centre) - start[i + face]
                axial = number(edge.moment) * lever / number(wall.bending)
                axial -= number(wall.coupling) / number(wall.axial) * shift
                strain = np.array(
                    [
                        cosine**2 * axial + sine**2 * shift,
                        sine**2 * axial + cosine**2 * shift,
                        2 * sine * cosine * (shift - axial),
                    ]
                )
                change = np.linalg.solve(compliance, strain)
                load = [supply * number(plies.load[p][face, k]) for p in (0, 1, 3)]
                held = [number(plies.residual[p][face, k, t]) for p in (0, 1, 3)]
                for part in range(3):
                    stress = load[part] + change[part]
                    strength = strengths[min(2 * part + (part < 2 and stress < 0), 4)]
                    factors.append((strength - np.sign(stress) * held[part]) / abs(stress))
            place = f"{layer.label}, {climate.name}, beside the skirt"
            assert rows(run)[place] == pytest.approx(min(factors), rel=1e-9)


def test_a_thin_skirt_changes_nothing():
    """Beside a skirt of 10 um, the plies have the stress of the undisturbed wall."""
    run = ran(
        "knee_bonded", **{"retention.wall": "0.01 mm", "variables.retention.wall.lower": "0.01 mm"}
    )
    found = rows(run)
    for i in run.wall.plies.rows:
        label = run.wall.plies.layers[i].label
        far = min(
            value
            for at, value in found.items()
            if at.startswith(label) and at.endswith("hot, piston at the end stop")
            and "radial" not in at
        )  # fmt: skip
        assert found[f"{label}, hot, beside the skirt"] == pytest.approx(far, rel=5e-3)


def lame(run):
    """Principal stresses of a metal tube at supply pressure and its pull, by face: z, t, r."""
    (end, *_), geometry = run.joints, run.geometry
    p, inner, outer = (
        number(x) for x in (end.loaded.pressure, geometry.inner_radius, geometry.outer_radius)
    )
    along = number(end.loaded.force) / (np.pi * (outer**2 - inner**2))
    share = p * inner**2 / (outer**2 - inner**2)
    return [(along, share * (1 + (outer / r) ** 2), share * (1 - (outer / r) ** 2))
            for r in (inner, outer)]  # fmt: skip


def test_metal_beside_a_skirt_by_hand():
    """Lame's stresses plus those of the changed strains, by Hooke's law; pulse from zero."""
    run = ran("steel_baseline")
    (end,) = run.joints
    beside = edge_beside(end.loaded)
    wall, edge = beside.wall, beside.edge
    modulus, ratio = 206e9, 0.3
    thickness = number(end.loaded.shells[0].thickness)
    around = number(edge.growth - beside.growth) / number(wall.radius)
    worst = 0.0
    for (z, t, r), place in zip(lame(run), (0.0, thickness), strict=True):
        along = number(edge.moment) * (thickness / 2 - place) / number(wall.bending)
        along -= ratio * around
        z += modulus / (1 - ratio**2) * (along + ratio * around)
        t += modulus / (1 - ratio**2) * (around + ratio * along)
        worst = max(worst, np.sqrt(((z - t) ** 2 + (t - r) ** 2 + (r - z) ** 2) / 2))
    strength = number(end.loaded.materials.allowable("steel_e355", "yield_strength"))
    place = "barrel, beside the skirt"
    assert rows(run, "yield_factor")[place] == pytest.approx(strength / worst, rel=1e-9)
    proof = rows(run, "yield_factor")[place] / 1.5
    assert rows(run, "proof_factor")[place] == pytest.approx(proof, rel=1e-9)
    cycle = end.beside.cycles[place]
    assert (number(cycle.span), number(cycle.mean)) == pytest.approx((worst, worst / 2), rel=1e-9)


def test_liner_beside_a_skirt_counts_cure():
    """Residual stress of the exact wall, plus load and change of strain: equivalent at yield."""
    run = ran("knee_bonded")
    (end,), (metal,) = run.joints, run.wall.metals
    beside, shell = edge_beside(end.loaded), run.joints[0].loaded.shells[0]
    supply = number(end.loaded.pressure)
    around = number(beside.edge.growth - beside.growth) / number(beside.wall.radius)
    for k, climate in enumerate(metal.climates):
        place = f"{metal.label}, {climate.name}, beside the skirt"
        factor = rows(run, "yield_factor")[place]
        highest = 0.0
        for face, start in ((0, 0.0), (1, number(shell.thickness))):
            lever = (number(beside.wall.centre) - start) / number(beside.wall.bending)
            along = number(beside.edge.moment) * lever
            along -= number(beside.wall.coupling) / number(beside.wall.axial) * around
            stiff = [number(x) for x in (shell.axial, shell.coupling, shell.hoop)]
            change = (stiff[0] * along + stiff[1] * around, stiff[1] * along + stiff[2] * around, 0)
            z, t, r = (
                factor * (supply * number(metal.load[p][face]) + change[p])
                + number(metal.residual[p][face, 0, k])
                for p in range(3)
            )
            highest = max(highest, np.sqrt(((z - t) ** 2 + (t - r) ** 2 + (r - z) ** 2) / 2))
        assert highest == pytest.approx(number(metal.yields[k]), rel=1e-9)


def test_shear_beside_a_groove():
    """The moment is that of the ring's force at half the groove's depth; weakest shear strength."""
    subject = ao.read(PLAIN_KNEE).subject()
    run = kernel.compute(subject, subject.values())
    (end,), layer = run.joints, run.wall.plies.layers[1]
    (place,) = [at for at in rows(run) if at.startswith("interlaminar")]
    assert place == "interlaminar shear of layup[1] t700_epoxy, beside the plug's groove"
    liner, winding = end.loaded.shells
    t0, t1 = number(liner.thickness), number(winding.thickness)
    q0, q1 = number(liner.axial), number(winding.axial)
    centre = (q0 * t0**2 / 2 + q1 * t1 * (t0 + t1 / 2)) / (q0 * t0 + q1 * t1)
    bending = q0 * ((t0 - centre) ** 3 + centre**3) / 3
    bending += q1 * ((t0 + t1 - centre) ** 3 - (t0 - centre) ** 3) / 3
    radius = number(end.loaded.end.inner_radius) + (t0 + t1) / 2
    coupling = number(liner.coupling) * t0 + number(winding.coupling) * t1
    around = number(liner.hoop) * t0 + number(winding.hoop) * t1
    stiff = (around - coupling**2 / (q0 * t0 + q1 * t1)) / radius**2
    line = number(end.loaded.force) / (2 * np.pi * radius)
    growth = number(end.loaded.pressure) * number(end.loaded.end.inner_radius)
    growth = (growth - line * coupling / (q0 * t0 + q1 * t1)) / (stiff * radius)
    beta = (stiff / (4 * bending)) ** 0.25
    depth = 0.25 * 3**0.5 / 2 * 0.75e-3  # thread at its pitch diameter, above the minor one
    depth += 0.2 * 1.78e-3  # which the static rings pass
    thin = stiff * growth / (4 * beta) + 0.644794 * beta * line * (centre - depth / 2)
    flow = q0 * t0 * (centre - t0 / 2)
    strength = min(number(s.shear_12) for s in layer.strengths)
    across = [number(s.shear_23) for s in layer.strengths if s.shear_23 is not None]
    strength = min([strength, *across])
    # shear compliance lowers the part of the pressure step
    assert rows(run)[place] >= strength * bending / (thin * flow)
    assert rows(run)[place] == pytest.approx(strength * bending / (thin * flow), rel=0.2)


def test_metal_walls_and_plates_have_no_such_rows():
    """A steel barrel has no plies, and tie rods do not bend the barrel."""
    assert "first_ply_factor" not in ran("steel_baseline").computed.metrics
    assert not [at for at in rows(ran("aerospace")) if "beside" in at]
