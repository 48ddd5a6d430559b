"""The layered tube against an independent solution: finite elements of degree 10 in the radius."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import tube_oracle as oracle
from hypothesis import HealthCheck, given, settings, strategies as st

from actuator_opt.base.numeric import STEP
from actuator_opt.models.solid_ply import (
    solid_expansion_load,
    solid_ply_stresses,
    solid_rotated,
    solid_stiffness,
)

AGREEMENT = 1e-8
"""Largest difference, as a share of the largest value of the same kind in the wall."""
SLOW = settings(max_examples=40, suppress_health_check=list(HealthCheck))


def oracle_fields(whole, layers, radius, loads):
    """The same from the oracle: solved on the layers `whole`, read at the faces of `layers`."""
    solution = oracle.solve(whole, radius, **loads)
    parts = len(layers) // len(whole)
    faces = []
    inner = radius
    for k, layer in enumerate(layers):
        outer = inner + layer.thickness
        faces.append((k // parts, inner, outer))
        inner = outer

    def read(function):
        values = [[function(k, (a, b)[face]) for k, a, b in faces] for face in (0, 1)]
        return np.moveaxis(np.array(values), 2, 0)  # kind, face, layer

    stresses = read(solution.stresses)
    return {
        "scalars": np.array(
            [solution.u(0, radius) / radius, solution.axial_strain, solution.twist * radius]
        ),
        "strains": read(solution.strains)[1:],
        "radial_stress": stresses[2:3],
        "stresses": stresses,
        "ply_stresses": read(solution.ply_stresses),
        "opposite_ply_stresses": read(
            lambda k, r: solution.ply_stresses(k, r, -1 if whole[k].balanced else 1)
        ),
    }


def compare(found, expected, agreement=AGREEMENT, part=np.real):
    """Every field agrees to a share of the largest value of its kind in the wall."""
    strain = max(np.max(np.abs(part(expected[k]))) for k in ("scalars", "strains"))
    stress = np.max(np.abs(part(expected["stresses"])))
    for name, values in expected.items():
        size = strain if name in {"scalars", "strains"} else stress
        assert found[name].shape == values.shape
        np.testing.assert_allclose(
            part(found[name]), part(values), rtol=0, atol=agreement * size, err_msg=name
        )


def test_oracle_is_lame_to_rounding():
    """The oracle gives Lamé's tube of ratio 3 to 1e-11, so it may judge to 1e-8."""
    youngs, poisson, inner, outer, pressure = 70e9, 0.3, 10e-3, 30e-3, 40e6
    layer = oracle.Layer(ply=oracle.Ply.isotropic(youngs, poisson), thickness=outer - inner)
    solution = oracle.solve([layer], inner, inner_pressure=pressure)
    ratio = (outer**2 + inner**2) / (outer**2 - inner**2)
    growth = pressure * inner / youngs * (ratio + poisson)
    assert solution.u(0, inner) == pytest.approx(growth, rel=1e-12)
    assert solution.stresses(0, inner)[1] == pytest.approx(pressure * ratio, rel=1e-11)
    assert solution.stresses(0, outer)[2] == pytest.approx(0, abs=1e-11 * pressure)


@given(st.data())
@SLOW
@pytest.mark.long
def test_oracle_is_converged(data):
    """Elements half as long change no stress of the oracle by more than 1e-10 of the largest."""
    layers, radius = data.draw(oracle.tubes(most=3))
    loads = data.draw(oracle.loads(radius))
    halves = oracle.split(layers, (0.5, 0.5))
    compare(
        oracle_fields(halves, halves, radius, loads),
        oracle_fields(layers, halves, radius, loads),
        agreement=1e-10,
    )


@given(st.data())
@SLOW
def test_any_lay_up_under_any_load(data):
    """1 to 6 layers of any kind and angle, all loads at once, read at faces and inside: 1e-8."""
    layers, radius = data.draw(oracle.tubes())
    loads = data.draw(oracle.loads(radius))
    cut = oracle.split(layers, (0.3, 0.3, 0.4))
    compare(oracle.model_fields(cut, radius, loads), oracle_fields(layers, cut, radius, loads))


@given(st.data())
@SLOW
def test_at_and_near_the_resonances(data):
    """Plies tuned to l = 1 and l = 2, exactly and within 1e-14 to 1e-5 of them: 1e-8."""
    layers, radius = data.draw(oracle.tubes(resonances=(1, 2), most=3))
    loads = data.draw(oracle.loads(radius))
    compare(
        oracle.model_fields(layers, radius, loads), oracle_fields(layers, layers, radius, loads)
    )


@pytest.mark.parametrize("exponent", [1, 2])
@pytest.mark.parametrize("balanced", [True, False])
@pytest.mark.parametrize("angle", [0.0, 0.5, pi / 2])
def test_smooth_across_the_resonances(exponent, balanced, angle):
    """Across l = 1 and l = 2 every output is a straight line in E3, down to changes of 1e-13."""
    base = oracle.Ply(
        youngs=(20e9, 18e9, 18e9),
        poisson=(0.2, 0.32, 0.11),
        shear=4e9,
        expansion=(0.0, 3e-5, 5e-5),
    )
    tuned = oracle.resonant(base, angle, exponent, balanced)
    assert oracle.sound(tuned)
    radius = 15e-3
    loads = {
        "inner_pressure": 20e6,
        "axial_force": 8e3,
        "torque": 40.0,
        "temperature_change": -80.0,
    }

    def outputs(change):
        changed = replace(tuned, youngs=(*tuned.youngs[:2], tuned.youngs[2] * (1 + change)))
        layers = [
            oracle.Layer(ply=changed, thickness=2e-3, angle=angle, balanced=balanced),
            oracle.Layer(ply=changed, thickness=3e-3, angle=angle, balanced=balanced),
        ]
        return oracle.model_fields(layers, radius, loads)

    at = outputs(0.0)
    slope = {name: np.imag(values) / STEP for name, values in outputs(1j * STEP).items()}
    for change in (1e-13, 1e-11, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4):
        for sign in (-1, 1):
            moved = outputs(sign * change)
            for name, here in at.items():
                size = np.max(np.abs(here))
                rate = slope[name]
                assert np.max(np.abs(rate)) < 10 * size
                np.testing.assert_allclose(
                    moved[name],
                    here + sign * change * rate,
                    rtol=0,
                    atol=(1e-11 + 30 * change**2) * size,
                )


@given(st.data())
@SLOW
def test_derivatives_with_respect_to_everything(data):
    """Complex-step derivatives along a random change of every input at once: 1e-8.

    The oracle is differentiated the same way, through its own stiffness tensor, mesh and solver.
    """
    resonances = data.draw(st.sampled_from([(None,), (1, 2)]))
    layers, radius = data.draw(oracle.tubes(resonances=resonances, most=4))
    loads = data.draw(oracle.loads(radius))
    weights = iter(np.random.default_rng(data.draw(st.integers(0, 99))).uniform(-1, 1, 200))

    def moved(value, size=None):
        return value + 1j * STEP * next(weights) * (abs(value) if size is None else size)

    changed = [
        replace(
            layer,
            ply=oracle.Ply(
                youngs=tuple(moved(v) for v in layer.ply.youngs),
                poisson=tuple(moved(v, 0.3) for v in layer.ply.poisson),
                shear=moved(layer.ply.shear),
                expansion=tuple(moved(v, 10e-6) for v in layer.ply.expansion),
            ),
            thickness=moved(layer.thickness),
            angle=moved(layer.angle, 1.0),
        )
        for layer in layers
    ]
    changed_radius = moved(radius)
    changed_loads = {name: moved(value) for name, value in loads.items()}
    compare(
        oracle.model_fields(changed, changed_radius, changed_loads),
        oracle_fields(changed, changed, changed_radius, changed_loads),
        part=lambda value: np.imag(value) / STEP,
    )


@given(oracle.layers())
def test_ply_as_a_solid_by_the_tensor_law(layer):
    """Stiffness, rotation and thermal loads of a ply are those of the turned tensor."""
    ply, angle = layer.ply, layer.angle
    e, nu = ply.youngs, ply.poisson
    stiffness = solid_stiffness(
        youngs_modulus_1=e[0],
        youngs_modulus_2=e[1],
        youngs_modulus_3=e[2],
        poissons_ratio_12=nu[0],
        poissons_ratio_13=nu[1],
        poissons_ratio_23=nu[2],
        shear_modulus_12=ply.shear,
    )
    full = np.linalg.inv(ply.compliance())
    own = [full[i, j] for i, j in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2), (5, 5)]]
    tiny = 1e-10 * np.max(np.abs(full))
    np.testing.assert_allclose(stiffness, own, rtol=0, atol=tiny)
    matrix, heat = oracle.turned(ply, angle)
    places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2), (0, 5), (1, 5), (2, 5), (5, 5)]
    expected = [matrix[i, j] for i, j in places]
    np.testing.assert_allclose(
        solid_rotated(stiffness=stiffness, angle=angle), expected, rtol=0, atol=tiny
    )
    found = solid_expansion_load(
        stiffness=stiffness,
        angle=angle,
        expansion_1=ply.expansion[0],
        expansion_2=ply.expansion[1],
        expansion_3=ply.expansion[2],
    )
    np.testing.assert_allclose(found, heat[[0, 1, 2, 5]], rtol=0, atol=tiny * 60e-6)


@given(oracle.layers(), st.lists(st.floats(-0.01, 0.01), min_size=4, max_size=4))
def test_ply_stresses_by_the_tensor_law(layer, strains):
    """Ply stresses of a strain state, free strains off, are C (e - e_free) in the ply's axes."""
    ply, angle = layer.ply, layer.angle
    free = np.array([3e-4, -1e-3, 2e-3])
    full = np.linalg.inv(ply.compliance())
    tensor = np.zeros((3, 3))
    tensor[0, 0], tensor[1, 1], tensor[2, 2] = strains[:3]
    tensor[0, 1] = tensor[1, 0] = strains[3] / 2
    e = oracle.basis(angle)
    own = e @ tensor @ e.T
    expected = full @ [*(np.diag(own) - free), 0.0, 0.0, 2 * own[0, 1]]
    found = solid_ply_stresses(
        stiffness=(*full[0, :3], full[1, 1], full[1, 2], full[2, 2], full[5, 5]),
        angle=angle,
        axial_strain=strains[0],
        hoop_strain=strains[1],
        radial_strain=strains[2],
        shear_strain=strains[3],
        free_strain_1=free[0],
        free_strain_2=free[1],
        free_strain_3=free[2],
    )
    np.testing.assert_allclose(
        found, expected[[0, 1, 2, 5]], rtol=0, atol=1e-12 * np.max(np.abs(full))
    )


@given(st.lists(st.integers(0, 10**6), min_size=3, max_size=3), st.floats(-pi / 2, pi / 2))
@settings(max_examples=20)
def test_batch_follows_each_design(seeds, angle):
    """Arrays of radii, thicknesses, angles, moduli and loads give what each design gives alone."""
    draws = [np.random.default_rng(seed).uniform(0.5, 1.0, 8) for seed in seeds]

    def design(x):
        liner = oracle.Layer(ply=oracle.Ply.isotropic(70e9 * x[0], 0.33, 2e-5), thickness=1e-3)
        wrap = oracle.Ply(
            youngs=(140e9 * x[1], 9e9, 8e9),
            poisson=(0.28, 0.3, 0.42),
            shear=5e9 * x[2],
            expansion=(0.0, 3e-5, 4e-5),
        )
        layers = [
            liner,
            oracle.Layer(ply=wrap, thickness=2e-3 * x[3], angle=angle * x[4]),
            oracle.Layer(ply=wrap, thickness=1e-3, angle=pi / 2 * x[4], balanced=False),
        ]
        loads = {"inner_pressure": 30e6 * x[6], "axial_force": 5e3, "torque": 20.0 * x[7]}
        return layers, 20e-3 * x[5], {**loads, "temperature_change": -80.0}

    together = oracle.model_fields(*design(np.array(draws).T))
    for i, x in enumerate(draws):
        alone = oracle.model_fields(*design(x))
        for name, values in alone.items():
            np.testing.assert_allclose(
                together[name][..., i], values, rtol=1e-9, atol=1e-12 * np.max(np.abs(values))
            )


@given(st.data(), st.integers(1, 3))
@settings(max_examples=20, suppress_health_check=list(HealthCheck))
def test_loads_may_be_arrays(data, cases):
    """Load cases as an array, alone or as a leading axis over a batch of tubes, are each case."""
    layers, radius = data.draw(oracle.tubes(most=3))
    drawn = [data.draw(oracle.loads(radius)) for _ in range(cases)]
    together = {name: np.array([one[name] for one in drawn]) for name in drawn[0]}
    sizes = np.array([1.0, 1.3])
    batch = [replace(layer, thickness=layer.thickness * sizes) for layer in layers]
    one_tube = oracle.model_fields(layers, radius, together)
    two_tubes = oracle.model_fields(
        batch, radius, {name: v[:, None] for name, v in together.items()}
    )
    for i, loads in enumerate(drawn):
        for j, size in enumerate(sizes):
            grown = [replace(layer, thickness=layer.thickness * size) for layer in layers]
            for name, values in oracle.model_fields(grown, radius, loads).items():
                close = {"rtol": 1e-9, "atol": 1e-10 * np.max(np.abs(values))}
                np.testing.assert_allclose(two_tubes[name][..., i, j], values, **close)
                if j == 0:
                    np.testing.assert_allclose(one_tube[name][..., i], values, **close)
