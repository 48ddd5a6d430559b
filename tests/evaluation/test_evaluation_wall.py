"""The laminated wall in an evaluation: axes, climates, load paths, tie rods, autofrettage.

Numbers are recalculated layer by layer with the models' scalar calls; what the models themselves
are worth is shown in their own tests and by the second reader.
"""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.design import read_design
from actuator_opt.evaluation import compute, prepare
from actuator_opt.models import autofrettage as worked, barrel_ends
from actuator_opt.models.layered_tube import layered_tube, ply_stresses_at_faces, tube_state
from actuator_opt.models.strength import CRITERIA, yield_utilisation
from actuator_opt.models.strength_modes import load_multiplier

DESIGNS = Path(__file__).parents[2] / "designs"
KNEE = (DESIGNS / "knee_bonded.yaml").read_text("utf-8")
LAYERS = """  layup:
    - {material: al_7075_t6, thickness: 0.6 mm}
    - {material: t700_epoxy, angle: 88 deg, thickness: 0.7 mm}
    - {material: t700_epoxy, angle: 25 deg, thickness: 0.9 mm}
    - {material: im7_8552, angle: 60 deg, thickness: 0.5 mm}
"""


def _file(tmp_path, *edits):
    """The knee with four different layers in its wall, and other edits."""
    text = KNEE
    head, _, rest = text.partition("  layup:")
    text = head + LAYERS + "\nrod:\n" + rest.partition("\nrod:\n")[2]
    text = text.partition("\nvariables:")[0] + "\n"
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "wall.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def _done(path):
    subject = prepare(read_design(path).design)
    values = subject.values()
    return subject, values, compute(subject, values)


def _layers(subject, values):
    """Tube layers and strengths per climate, from the material's own numbers."""
    from actuator_opt.evaluation import plies
    from actuator_opt.evaluation.limits import MaterialValues

    stock = MaterialValues(values, subject.materials, subject.factors, subject.constants)
    states = plies.climates(values, subject.design)
    layup = subject.design.barrel.layup
    return plies.layers(values, stock, layup, "barrel.layup", states, []), states


@pytest.mark.parametrize("criterion", list(CRITERIA))
def test_every_layer_fails_where_the_scalar_models_say(tmp_path, criterion):
    """First ply of each layer, climate and load path: least over both faces and all its modes."""
    edit = ("barrel:\n", f"barrel:\n  criterion: {criterion}\n")
    subject, values, done = _done(_file(tmp_path, edit))
    layers, states = _layers(subject, values)
    radius = float(done.geometry.inner_radius)
    tube = layered_tube(layers=[layer.as_tube() for layer in layers], inner_radius=radius)
    least = {}
    for name, axial in (("no axial load", 0.0), ("piston at the end stop", pi * radius**2)):
        state = tube_state(tube=tube, inner_pressure=1.0, axial_force=axial)
        load = ply_stresses_at_faces(tube=tube, state=state)
        for t, climate in enumerate(states):
            cold = tube_state(tube=tube, temperature_change=float(climate.change))
            held = ply_stresses_at_faces(tube=tube, state=cold)
            for i, layer in enumerate(layers[1:], 1):
                worst = 0.0
                for face in (0, 1):
                    modes = CRITERIA[criterion].modes(
                        stress=tuple(float(s[face, i]) for s in load),
                        strength=layer.strengths[t],
                        residual=tuple(float(s[face, i]) for s in held),
                        elastic=_ratios(layer.constants),
                    )
                    worst = max(worst, *(float(u) for u in modes.values()))
                least[i, climate.name, name] = load_multiplier(worst)
    assert least
    for (i, climate, name), expected in least.items():
        found = [
            float(np.squeeze(pressure))
            for label, pressure in done.wall.first_ply_pressure.items()
            if label.startswith(f"layup[{i}]") and climate in label and label.endswith(name)
        ]
        assert min(found) == pytest.approx(expected, rel=1e-9)


def _ratios(constants):
    from actuator_opt.models.strength_modes import PlyRatios

    return PlyRatios(
        poissons_ratio_12=constants["poissons_ratio_12"],
        poissons_ratio_13=constants["poissons_ratio_13"],
        poissons_ratio_23=constants["poissons_ratio_23"],
        modulus_ratio=constants["youngs_modulus_2"] / constants["youngs_modulus_1"],
    )


def test_liner_yield_by_climate(tmp_path):
    """The liner yields at the worse face of cure stress plus pressure, in each climate."""
    subject, values, done = _done(_file(tmp_path))
    layers, states = _layers(subject, values)
    radius = float(done.geometry.inner_radius)
    tube = layered_tube(layers=[layer.as_tube() for layer in layers], inner_radius=radius)
    state = tube_state(tube=tube, inner_pressure=1.0)
    load = ply_stresses_at_faces(tube=tube, state=state)
    for t, climate in enumerate(states):
        cold = tube_state(tube=tube, temperature_change=float(climate.change))
        held = ply_stresses_at_faces(tube=tube, state=cold)
        used = max(
            float(
                yield_utilisation(
                    stress=tuple(float(s[face, 0]) for s in load),
                    yield_strength=layers[0].yields[t],
                    residual=tuple(float(s[face, 0]) for s in held),
                )
            )
            for face in (0, 1)
        )
        label = f"layup[0] al_7075_t6, {climate.name}, no axial load"
        assert np.squeeze(done.wall.yield_pressure[label]) == pytest.approx(1 / used, rel=1e-9)


def test_a_liner_pulls_on_its_plies_after_the_cure(tmp_path):
    """Bond factor: transverse strength over the radial tension at the liner's outer face."""
    subject, values, done = _done(_file(tmp_path))
    layers, states = _layers(subject, values)
    tube = layered_tube(
        layers=[layer.as_tube() for layer in layers], inner_radius=done.geometry.inner_radius
    )
    factors = []
    for t, climate in enumerate(states):
        cold = tube_state(tube=tube, temperature_change=float(climate.change))
        pull = float(cold.radial_stress[1, 0])
        assert pull > 0
        factors.append(layers[1].strengths[t].tension_2 / pull)
    (found,) = done.wall.bond.values()
    assert np.squeeze(found) == pytest.approx(min(factors), rel=1e-9)


TIED = (
    ("  type: bond\n  material: epoxy_structural\n  length: 20 mm\n  wall: 1.5 mm\n",
     "  type: tie_rods\n  material: steel_bolt_12_9\n  length: 8 mm\n  count: 4\n"
     "  preload: 15 kN\n  thread:\n    diameter: 5 mm\n    pitch: 0.8 mm\n"),
)  # fmt: skip


def test_tie_rods_share_the_force_with_the_barrel(tmp_path):
    """Barrel and rods are springs in parallel: forces, joint and share from the tube's own EA."""
    _, values, done = _done(_file(tmp_path, *TIED))
    wall, g = done.wall, done.geometry
    supply = values["supply.pressure"]
    barrel = 1 / (wall.swelling.stretch * g.barrel_length)
    rods = 4 * 206e9 * pi * 5e-3**2 / 4 / (g.barrel_length + 2 * g.plate)
    force, rod_force = barrel_ends.tie_rod_forces(
        axial_force=supply * pi * g.inner_radius**2,
        preload=15e3,
        barrel_stiffness=barrel,
        tie_rod_stiffness=rods,
        free_shortening=-wall.swelling.shortening * supply * g.barrel_length,
    )
    assert wall.path.clamp is not None
    per_pressure = wall.path.per_pressure["piston at the end stop"]
    assert np.squeeze(per_pressure * supply) - 15e3 == pytest.approx(float(np.squeeze(force)))
    most = float(np.squeeze(rod_force)) + 15e3 * (1.6 / 1.3 - 1)  # tightened with scatter
    assert np.squeeze(wall.path.clamp.largest) == pytest.approx(most)
    factor = float(np.squeeze(done.computed.metrics["joint_factor"]["at assembly"]))
    lost = float(np.squeeze(force)) + 15e3
    settled = 14e-6 * float(np.squeeze(barrel)) * rods / (float(np.squeeze(barrel)) + rods)
    assert factor == pytest.approx((15e3 / 1.3 - settled) / (values["supply.proof_ratio"] * lost))
    assert 0 < float(np.squeeze(wall.path.share)) < 1


def test_temperature_changes_the_preload_of_tie_rods(tmp_path):
    """Barrel and plates grow against the rods; each temperature has its own factor."""
    _, _, done = _done(_file(tmp_path, *TIED))
    wall, g = done.wall, done.geometry
    assert wall.path.clamp is not None
    barrel = 1 / (wall.swelling.stretch * g.barrel_length)
    rods = 4 * 206e9 * pi * 5e-3**2 / 4 / (g.barrel_length + 2 * g.plate)
    gap = wall.expansion[0] * g.barrel_length + 2 * 23.6e-6 * g.plate
    gap = gap - 11.5e-6 * (g.barrel_length + 2 * g.plate)
    gain = float(np.squeeze(gap * barrel * rods / (barrel + rods)))
    factors = {
        place: float(np.squeeze(value))
        for place, value in done.computed.metrics["joint_factor"].items()
    }
    settled = 14e-6 / (1 / float(np.squeeze(barrel)) + 1 / rods)
    for word, change in (("cold", -20.0), ("hot", 60.0)):
        ratio = factors[word] / factors["at assembly"]
        assert ratio == pytest.approx(1 + gain * change / (15e3 / 1.3 - settled), rel=1e-9)
    cold, hot = wall.path.held_in(2)
    assert np.squeeze(hot) == pytest.approx(-15e3 - 60 * gain, rel=1e-9)
    assert np.squeeze(cold) == pytest.approx(-15e3 + 20 * gain, rel=1e-9)


def test_a_joint_without_preload_is_closed_at_proof(tmp_path):
    """Default preload: what pressure takes from the joint at proof pressure; the report says so."""
    path = _file(tmp_path, *TIED, ("  preload: 15 kN\n", ""))
    result = ao.evaluate(ao.read(path))
    assert result.metrics["joint_factor"].value == pytest.approx(1.0)
    assert any("no tie-rod preload is stated" in text for text in result.warnings)


def test_tie_rods_carry_what_the_barrel_does_not(tmp_path):
    """The clamped barrel stretches less: stiffness is never below the barrel's alone."""
    alone, tied = (
        float(np.min(_done(path)[2].computed.metrics["stiffness_min"][""]))
        for path in (_file(tmp_path), _file(tmp_path, *TIED))
    )
    assert tied > alone * (1 - 1e-9)


def test_autofrettage_stands_as_residual_stress(tmp_path):
    """Its residuals move the liner's yield as adding them to the cure stress by hand does."""
    edit = ("barrel:\n", "barrel:\n  autofrettage_pressure: 900 bar\n")
    subject, values, done = _done(_file(tmp_path, edit))
    layers, states = _layers(subject, values)
    radius = float(done.geometry.inner_radius)
    tubes = [layer.as_tube() for layer in layers]
    own = worked.autofrettage(
        layers=tubes,
        yield_strength=layers[0].yield_strength,
        inner_radius=radius,
        pressure=90e6,
        axial_force_per_pressure=0.0,
        temperature_change=293.15 - 393.15,
    )
    tube = layered_tube(layers=tubes, inner_radius=radius)
    load = ply_stresses_at_faces(tube=tube, state=tube_state(tube=tube, inner_pressure=1.0))
    cold = tube_state(tube=tube, temperature_change=float(states[0].change))
    held = ply_stresses_at_faces(tube=tube, state=cold)
    used = max(
        float(
            yield_utilisation(
                stress=tuple(float(s[face, 0]) for s in load),
                yield_strength=layers[0].yields[0],
                residual=tuple(
                    float(a[face, 0]) + float(b[face, 0])
                    for a, b in zip(held, own.stresses, strict=True)
                ),
            )
        )
        for face in (0, 1)
    )
    label = "layup[0] al_7075_t6, cold, no axial load"
    assert np.squeeze(done.wall.yield_pressure[label]) == pytest.approx(1 / used, rel=1e-9)
    assert np.squeeze(done.wall.autofrettage.reverse_yield) < 1


def test_thin_mode_warns_and_differs(tmp_path):
    """The thin laminate stays selectable; on this wall it promises less growth, and says so."""
    thin = ao.evaluate(ao.read(_file(tmp_path, ("barrel:\n", "barrel:\n  model: thin_laminate\n"))))
    exact = ao.evaluate(ao.read(_file(tmp_path)))
    assert thin.metrics["bore_growth"].value < 0.95 * exact.metrics["bore_growth"].value
    assert not thin.metrics["bore_growth"].in_range
    assert exact.metrics["bore_growth"].in_range
    assert exact.metrics["bore_growth"].model == "layered_tube.tube_state"
    assert any("thin-laminate barrel" in text for text in thin.warnings)


def test_gradients_of_the_wall_are_those_of_differences(tmp_path):
    """Complex-step gradients of wall metrics through cure, ladder and criteria."""
    subject, values, _ = _done(_file(tmp_path))
    paths = ("cylinder.bore", "barrel.layup[1].thickness", "barrel.layup[2].angle")
    metrics = ("bore_growth", "first_ply_factor", "burst_factor", "yield_factor", "stiffness_min")

    def rows(points):
        varied = dict(zip(paths, points, strict=True))
        found = compute(subject, subject.values(varied)).computed.metrics
        flat = [np.atleast_2d(a) for name in metrics for a in found[name].values()]
        return np.concatenate([np.broadcast_to(a, (a.shape[0], points.shape[1])) for a in flat])

    start = np.array([values[path] for path in paths])
    step = 1e-30
    batch = np.repeat(start[:, None].astype(complex), 3, axis=1) + 1j * step * np.eye(3)
    exact = rows(batch).imag / step * start
    change = 1e-6 * np.diag(start)
    high, low = rows(start[:, None] + change), rows(start[:, None] - change)
    slope = (high - low) / 2e-6
    scale = np.max(np.abs(high), axis=1, keepdims=True)
    np.testing.assert_allclose(exact / scale, slope / scale, atol=2e-5)


@pytest.mark.parametrize("stop", ["internal", "external"])
@pytest.mark.parametrize("mount", ["cap_clevis", "head_flange"])
@pytest.mark.parametrize(
    "path",
    [
        "cylinder.bore",
        *(
            pytest.param(x, marks=pytest.mark.long)
            for x in ("rod.outer_diameter", "supply.pressure")
        ),
    ],
)
def test_many_designs_are_each_alone(stop, mount, path):
    """Whichever number varies, and whichever area the stall pressure acts on."""
    changes = {"cylinder.end_stop": stop, "cylinder.mount": mount}
    values = float(ao.evaluate(ao.read(KNEE, set=changes))[path]) * np.array([1.0, 1.02])
    names = ["burst_factor", "proof_factor", "mass"]
    many = ao.evaluate_many(ao.read(KNEE, set=changes), {path: values}, metrics=names)
    for k, value in enumerate(values):
        one = ao.evaluate(ao.read(KNEE, set=changes | {path: value}))
        for name in names:
            assert many[name][k] == pytest.approx(one[name].value, rel=1e-10), (name, value)
