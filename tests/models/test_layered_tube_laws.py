"""Laws that any elastic layered tube obeys, for lay-ups and loads drawn at random."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import tube_oracle as oracle
from hypothesis import HealthCheck, given, settings, strategies as st
from numpy.polynomial import legendre

from actuator_opt.base.numeric import STEP
from actuator_opt.models import laminate, ply
from actuator_opt.models.layered_tube import tube_state, tube_stresses

TRIALS = settings(max_examples=40, suppress_health_check=list(HealthCheck))
ORDER = 8
"""Gauss-Lobatto order of the integrals through a layer: exact to degree 15."""
LAST = [0] * ORDER + [1]
"""Legendre coefficients of P_8, whose derivative's roots are the points."""
POINTS = np.array([-1.0, *legendre.legroots(legendre.legder(LAST)), 1.0])
WEIGHTS = 2 / (ORDER * (ORDER + 1) * legendre.legval(POINTS, LAST) ** 2)


def solve(layers, radius, **loads):
    """State and stresses (kind, face, layer) of a tube."""
    tube = oracle.model_tube(layers, radius)
    state = tube_state(tube=tube, **loads)
    return state, np.array(tube_stresses(tube=tube, state=state))


def everything(layers, radius, loads):
    """Every output in two vectors: strains and what else has no dimension, stresses."""
    fields = oracle.model_fields(layers, radius, loads)
    strains = [fields.pop(name) for name in ("scalars", "strains")]
    return [np.concatenate([v.ravel() for v in part]) for part in (strains, fields.values())]


def same(found, expected, share=1e-7):
    """Two results of `everything` agree to a share of their largest strain and stress."""
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=share * np.max(np.abs(other)))


@given(st.data())
@TRIALS
def test_identical_layers_are_one_layer(data):
    """Cutting layers into thinner ones of the same ply changes nothing at the outer faces."""
    layers, radius = data.draw(oracle.tubes(most=3))
    loads = data.draw(oracle.loads(radius))
    parts = data.draw(st.lists(st.floats(0.1, 1.0), min_size=2, max_size=4))
    shares = [part / sum(parts) for part in parts]
    whole, whole_stresses = solve(layers, radius, **loads)
    cut, cut_stresses = solve(oracle.split(layers, shares), radius, **loads)
    size = 1e-7 * max(np.max(np.abs(whole.hoop_strain)), abs(whole.axial_strain))
    assert cut.bore_displacement == pytest.approx(whole.bore_displacement, abs=size * radius)
    assert cut.axial_strain == pytest.approx(whole.axial_strain, abs=size)
    assert cut.twist == pytest.approx(whole.twist, abs=size / radius)
    size = 1e-7 * np.max(np.abs(whole_stresses))
    n = len(shares)
    np.testing.assert_allclose(cut_stresses[:, 0, ::n], whole_stresses[:, 0], rtol=0, atol=size)
    np.testing.assert_allclose(
        cut_stresses[:, 1, n - 1 :: n], whole_stresses[:, 1], rtol=0, atol=size
    )


@given(st.data())
@TRIALS
def test_sign_of_the_winding_angle(data):
    """Pairs do not know the sign of their angle; mirrored single plies twist the other way."""
    layers, radius = data.draw(oracle.tubes(most=4))
    loads = data.draw(oracle.loads(radius))
    mirrored = [replace(layer, angle=-layer.angle) for layer in layers]
    state, stresses = solve(layers, radius, **loads)
    turned, turned_stresses = solve(mirrored, radius, **{**loads, "torque": -loads["torque"]})
    sign = np.array([1, 1, 1, -1])[:, None, None]
    size = np.max(np.abs(stresses))
    np.testing.assert_allclose(turned_stresses * sign, stresses, rtol=0, atol=1e-9 * size)
    assert turned.twist == pytest.approx(-state.twist, rel=1e-9, abs=1e-12 / radius)
    pairs = [replace(layer, balanced=True) for layer in layers]
    mirrored = [replace(layer, angle=-layer.angle) for layer in pairs]
    state, stresses = solve(pairs, radius, **loads)
    turned, turned_stresses = solve(mirrored, radius, **loads)
    assert turned.bore_displacement == state.bore_displacement
    np.testing.assert_array_equal(turned_stresses, stresses)


@given(st.data())
@TRIALS
def test_global_equilibrium(data):
    """Hoop stress carries p_i r_i - p_o r_o; axial stress carries N; shear carries T.

    Integrals by Gauss-Lobatto points, reached by cutting each layer there. The radial stress is
    minus the pressure at both surfaces and the same on both sides of an interface.
    """
    layers, radius = data.draw(oracle.tubes(most=3))
    loads = data.draw(oracle.loads(radius))
    cut = oracle.split(layers, np.diff(POINTS) / 2)
    _, stresses = solve(cut, radius, **loads)
    radial = stresses[2]
    pressures = [loads["inner_pressure"], loads["outer_pressure"]]
    size = np.max(np.abs(stresses))
    close = {"rtol": 0, "atol": 1e-8 * size}
    np.testing.assert_allclose([-radial[0, 0], -radial[1, -1]], pressures, **close)
    np.testing.assert_allclose(radial[1, :-1], radial[0, 1:], **close)
    hoop = axial = torque = 0.0
    inner = radius
    for k, layer in enumerate(layers):
        mine = stresses[:, :, k * ORDER : (k + 1) * ORDER]
        values = np.concatenate([mine[:, 0], mine[:, 1, -1:]], axis=1)
        r = inner + layer.thickness * (POINTS + 1) / 2
        weight = WEIGHTS * layer.thickness / 2
        hoop += np.sum(values[1] * weight)
        axial += 2 * pi * np.sum(values[0] * r * weight)
        torque += 2 * pi * np.sum(values[3] * r**2 * weight)
        inner += layer.thickness
    wall = inner - radius
    assert hoop == pytest.approx(
        pressures[0] * radius - pressures[1] * inner, abs=1e-8 * size * wall
    )
    assert axial == pytest.approx(loads["axial_force"], abs=1e-8 * size * 2 * pi * inner * wall)
    assert torque == pytest.approx(loads["torque"], abs=1e-8 * size * 2 * pi * inner**2 * wall)


@given(st.data())
@TRIALS
def test_superposition(data):
    """The response to all loads is the sum of the responses to each; no load, no response."""
    layers, radius = data.draw(oracle.tubes(most=4))
    loads = data.draw(oracle.loads(radius))
    alone = [everything(layers, radius, {name: value}) for name, value in loads.items()]
    total = everything(layers, radius, loads)
    for i in (0, 1):
        size = sum(np.max(np.abs(one[i])) for one in alone)
        np.testing.assert_allclose(sum(one[i] for one in alone), total[i], rtol=0, atol=1e-9 * size)
    assert not any(np.any(part) for part in everything(layers, radius, {"inner_pressure": 0.0}))


@given(st.data())
@TRIALS
def test_work_is_positive_and_reciprocal(data):
    """Growth rises with pressure, length with force, twist with torque; loads act reciprocally.

    With displacements conjugate to the loads (2 pi r u at each surface, e_z, gamma_0) the matrix
    of responses is symmetric (Betti) and positive definite (Clapeyron).
    """
    layers, radius = data.draw(oracle.tubes(most=4))
    outer = radius + sum(layer.thickness for layer in layers)
    unit = 1e6 * radius**2
    columns = []
    for name, value in [
        ("inner_pressure", 1e6),
        ("outer_pressure", 1e6),
        ("axial_force", unit),
        ("torque", unit * radius),
    ]:
        state, _ = solve(layers, radius, **{name: value})
        columns.append(
            [
                2 * pi * state.bore_displacement / radius,
                -2 * pi * state.hoop_strain[1, -1] * (outer / radius) ** 2,
                state.axial_strain,
                state.twist * radius,
            ]
        )
    matrix = np.array(columns)
    size = np.sqrt(np.diag(matrix))
    assert np.all(np.diag(matrix) > 0)
    scaled = matrix / np.outer(size, size)
    np.testing.assert_allclose(scaled, scaled.T, rtol=0, atol=1e-8)
    assert np.min(np.linalg.eigvalsh(scaled)) > 0


@given(st.data(), st.floats(0.1, 1.0), st.floats(1.01, 3.0))
@TRIALS
def test_growth_rises_with_pressure(data, low, factor):
    """More pressure in an open tube opens the bore further; outside it closes it."""
    layers, radius = data.draw(oracle.tubes(most=4))
    for name, sign in (("inner_pressure", 1), ("outer_pressure", -1)):
        growths = [
            solve(layers, radius, **{name: p * 1e6})[0].bore_displacement
            for p in (0.0, low, low * factor)
        ]
        assert np.all(sign * np.diff(growths) > 0)


@given(st.data())
@TRIALS
def test_thin_wall_is_the_thin_laminate(data):
    """As t/r falls to 1e-4 the growth tends to the thin laminate's, with an error that follows."""
    drawn = data.draw(st.lists(oracle.layers(), min_size=1, max_size=4))
    layers = [replace(layer, balanced=True) for layer in drawn]
    share = data.draw(st.floats(0.0, 1.0))
    radius, pressure = 20e-3, 10e6
    force = share * pressure * pi * radius**2
    plies = [
        ply.rotated(
            stiffness=ply.ply_stiffness(
                youngs_modulus_1=one.ply.youngs[0],
                youngs_modulus_2=one.ply.youngs[1],
                poissons_ratio_12=one.ply.poisson[0],
                shear_modulus_12=one.ply.shear,
            ),
            angle=one.angle,
        )
        for one in layers
    ]
    errors = []
    for ratio in (1e-3, 1e-4):
        size = ratio * radius / sum(layer.thickness for layer in layers)
        thin = [replace(layer, thickness=layer.thickness * size) for layer in layers]
        sheet = laminate.membrane(plies=plies, thicknesses=[one.thickness for one in thin])
        growth = laminate.bore_growth_thin(
            pressure=pressure, inner_radius=radius, axial_force=force, membrane=sheet
        )
        strain = max(
            abs(v)
            for v in laminate.strains(
                membrane=sheet,
                axial_line_force=force / (2 * pi * radius),
                hoop_line_force=pressure * radius,
            )
        )
        state, _ = solve(thin, radius, inner_pressure=pressure, axial_force=force)
        errors.append(abs(state.bore_displacement - growth) / (radius * strain))
    assert errors[0] < 20e-3
    assert errors[1] < max(0.12 * errors[0], 1e-6)


@given(st.data(), st.floats(1e-3, 1e3))
@TRIALS
def test_scale_invariance(data, scale):
    """All lengths times s, N times s^2, T times s^3: the same strains and stresses."""
    layers, radius = data.draw(oracle.tubes(most=4))
    loads = data.draw(oracle.loads(radius))
    larger = [replace(layer, thickness=layer.thickness * scale) for layer in layers]
    larger_loads = {
        **loads,
        "axial_force": loads["axial_force"] * scale**2,
        "torque": loads["torque"] * scale**3,
    }
    same(
        everything(larger, radius * scale, larger_loads),
        everything(layers, radius, loads),
        share=1e-8,
    )


@given(st.data(), st.floats(-150, 150), st.floats(0, 40e-6))
@TRIALS
def test_uniform_expansion_makes_no_stress(data, heating, alpha):
    """Layers that all expand by one alpha in every direction stay free of stress."""
    layers, radius = data.draw(oracle.tubes(most=4))
    layers = [replace(layer, ply=replace(layer.ply, expansion=(alpha,) * 3)) for layer in layers]
    state, stresses = solve(layers, radius, temperature_change=heating)
    free = alpha * heating
    stiff = max(np.linalg.inv(layer.ply.compliance()).max() for layer in layers)
    assert np.max(np.abs(stresses)) <= 1e-9 * stiff * abs(free) + 1e-9
    assert state.bore_displacement == pytest.approx(free * radius, rel=1e-7, abs=1e-16)
    assert state.axial_strain == pytest.approx(free, rel=1e-7, abs=1e-16)


@given(st.data(), st.floats(1e6, 100e6))
@TRIALS
def test_all_round_pressure_in_isotropic_layers(data, pressure):
    """One isotropic metal under pressure from every side is stressed by -p everywhere."""
    youngs, poisson = data.draw(st.floats(1e9, 210e9)), data.draw(st.floats(0.0, 0.49))
    shares = data.draw(st.lists(st.floats(0.02, 0.5), min_size=1, max_size=4))
    radius = 15e-3
    metal = oracle.Ply.isotropic(youngs, poisson)
    layers = [oracle.Layer(ply=metal, thickness=share * radius) for share in shares]
    outer = radius * (1 + sum(shares))
    _, stresses = solve(
        layers,
        radius,
        inner_pressure=pressure,
        outer_pressure=pressure,
        axial_force=-pressure * pi * (outer**2 - radius**2),
    )
    np.testing.assert_allclose(stresses[:3], -pressure, rtol=1e-8)
    np.testing.assert_allclose(stresses[3], 0.0, atol=1e-8 * pressure)


@given(st.data(), st.floats(-0.45, 0.45), st.floats(1e6, 50e6))
@TRIALS
def test_twist_of_an_isotropic_tube(data, size, torque_stress):
    """Twist per length is T/(G J), whatever the other loads."""
    poisson, ratio = data.draw(st.floats(0.0, 0.49)), data.draw(st.floats(1.01, 3.0))
    radius, youngs = 12e-3, 70e9
    layer = oracle.Layer(ply=oracle.Ply.isotropic(youngs, poisson), thickness=(ratio - 1) * radius)
    polar = pi / 2 * radius**4 * (ratio**4 - 1)
    torque = torque_stress * polar / radius
    state, _ = solve(
        [layer], radius, torque=torque, inner_pressure=size * 1e8, axial_force=size * 1e4
    )
    expected = torque / (youngs / (2 * (1 + poisson)) * polar)
    assert state.twist == pytest.approx(expected, rel=1e-9)


NAMES = ("angle", "thickness", "youngs", "poisson", "shear", "expansion", "radius", "loads")


@pytest.mark.parametrize("name", NAMES)
def test_complex_step_is_the_central_difference(name):
    """Derivatives of every output to each kind of input equal differences of the real model."""
    wrap = oracle.Ply(
        youngs=(138e9, 9e9, 8e9),
        poisson=(0.28, 0.3, 0.42),
        shear=5e9,
        expansion=(-0.5e-6, 28e-6, 35e-6),
    )
    metal = oracle.Ply.isotropic(71.7e9, 0.33, 23e-6)
    layers = [
        oracle.Layer(ply=metal, thickness=0.6e-3),
        oracle.Layer(ply=wrap, thickness=1.2e-3, angle=1.4),
        oracle.Layer(ply=wrap, thickness=0.8e-3, angle=-0.6, balanced=False),
        oracle.Layer(ply=wrap, thickness=0.5e-3),
    ]
    loads = {
        "inner_pressure": 28e6,
        "outer_pressure": 3e6,
        "axial_force": 9e3,
        "torque": 60.0,
        "temperature_change": -90.0,
    }

    def outputs(step):
        """Outputs with the inputs of one kind changed by a share; angles by radians."""
        grown = 1 + step
        radius = 16e-3 * (grown if name == "radius" else 1)
        changed = []
        for layer in layers:
            if name in {"youngs", "poisson", "expansion"}:
                values = tuple(v * grown for v in getattr(layer.ply, name))
                changed.append(replace(layer, ply=replace(layer.ply, **{name: values})))
            elif name == "shear":
                changed.append(
                    replace(layer, ply=replace(layer.ply, shear=layer.ply.shear * grown))
                )
            elif name == "thickness":
                changed.append(replace(layer, thickness=layer.thickness * grown))
            elif name == "angle":
                changed.append(replace(layer, angle=layer.angle + step))
            else:
                changed.append(layer)
        now = {k: v * (grown if name == "loads" else 1) for k, v in loads.items()}
        return everything(changed, radius, now)

    step = 1e-4
    near = [outputs(k * step) for k in (-2, -1, 1, 2)]
    for i, exact in enumerate(outputs(1j * STEP)):
        a, b, c, d = (values[i] for values in near)
        difference = (a - 8 * b + 8 * c - d) / (12 * step)
        slope = np.imag(exact) / STEP
        np.testing.assert_allclose(slope, difference, rtol=0, atol=1e-7 * np.max(np.abs(slope)))


@given(st.data())
@TRIALS
def test_frozen_stress_acts_as_a_temperature_does(data):
    """Stresses -K dT frozen into the layers deform and load the tube as the change dT does."""
    layers, radius = data.draw(oracle.tubes(most=4))
    layers = [replace(layer, balanced=True) for layer in layers]
    loads = data.draw(oracle.loads(radius))
    change = loads.pop("temperature_change")
    heat = np.array([oracle.layer_stiffness(layer)[1][:3] for layer in layers]).T
    tube = oracle.model_tube(layers, radius)
    heated = tube_state(tube=tube, temperature_change=change, **loads)
    frozen = tube_state(tube=tube, frozen=tuple(-heat * change), **loads)
    size = np.max(np.abs(heated.hoop_strain)) + abs(heated.axial_strain)
    assert frozen.axial_strain == pytest.approx(heated.axial_strain, abs=1e-9 * size)
    np.testing.assert_allclose(frozen.hoop_strain, heated.hoop_strain, rtol=0, atol=1e-9 * size)
    stresses = np.array(tube_stresses(tube=tube, state=heated))
    np.testing.assert_allclose(
        np.array(tube_stresses(tube=tube, state=frozen)),
        stresses,
        rtol=0,
        atol=1e-8 * np.max(np.abs(stresses)),
    )
