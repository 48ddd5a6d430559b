"""Networks of oil, wall, rod and caps: worked numbers, balances, independent solvers, slopes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from actuator_opt.base.numeric import STEP
from actuator_opt.base.symbolic import program as programs
from actuator_opt.base.symbolic.recorded import RecordedFunction
from actuator_opt.models import heat_transfer, thermal_network
from actuator_opt.models.thermal_network import OilNode, Surroundings, ThermalLayer, ThermalPart

SIX_DIGITS = {"rel": 5e-6}
AMBIENT = 293.15
# the wall of the shipped design: 0.6 mm aluminium, 1.2 and 0.8 mm of laminate
WALL = (
    ThermalLayer(0.6e-3, 130.0, 2800.0 * 960.0, heat=6.0),
    ThermalLayer(1.2e-3, 0.6, 1570.0 * 950.0),
    ThermalLayer(0.8e-3, 0.6, 1570.0 * 950.0),
)
SIZES = {"bore": 23e-3, "length": 0.138, "wetted_length": 0.11}
FROZEN_AIR = Surroundings(AMBIENT, film_coefficient=6.82010 + 6.29418)


def worked(**oil):
    """Network of the worked example with 2 W in the oil and 6 W in layer 1."""
    return thermal_network.thermal_network(
        oil=OilNode(250.0, 66.12, heat=2.0, **oil), layers=WALL, **SIZES
    )


def rises(temperatures):
    """Rises over ambient of temperatures."""
    return [float(t) - AMBIENT for t in temperatures]


def test_steady_rises_of_the_worked_example():
    """53.2572, 52.2503, 51.5214 and 50.3453 K by air alone; C 16.5014, 19.7091 and 14.1740 J/K."""
    network = worked()
    steady = thermal_network.steady_temperatures(network=network, surroundings=FROZEN_AIR)
    expected = [53.2572, 52.2503, 51.5214, 50.3453]
    assert rises(steady.nodes) == pytest.approx(expected, **SIX_DIGITS)
    assert network.layer_capacities == pytest.approx([16.5014, 19.7091, 14.1740], **SIX_DIGITS)


def test_transient_of_the_worked_example():
    """After 600 s from cold 28.5759, 28.6342, 28.1442 and 27.4413 K; time constant 771.262 s."""
    network = worked()
    steady = thermal_network.steady_temperatures(network=network, surroundings=FROZEN_AIR)
    pair = {"network": network, "steady": steady}
    after = thermal_network.temperatures_after(start=[AMBIENT], time=600.0, **pair)
    assert rises(after) == pytest.approx([28.5759, 28.6342, 28.1442, 27.4413], **SIX_DIGITS)
    assert thermal_network.slowest_time_constant(**pair) == pytest.approx(771.262, **SIX_DIGITS)


def test_exchanged_oil_of_the_worked_example():
    """2e-5 m3/s at +30 K, heated 8 K by the throttle: 38.0653, 38.1457, 37.6136 and 36.7549 K."""
    conductance = heat_transfer.oil_exchange_conductance(
        exchange_flow=2e-5, density=870.0, specific_heat=1900.0
    )
    network = worked(exchange_conductance=conductance, inlet_temperature=AMBIENT + 38.0)
    steady = thermal_network.steady_temperatures(network=network, surroundings=FROZEN_AIR)
    expected = [38.0653, 38.1457, 37.6136, 36.7549]
    assert rises(steady.nodes) == pytest.approx(expected, **SIX_DIGITS)


def test_surface_that_gives_five_watts():
    """5 W by air and radiation of a 28.2 mm wall: the surface reaches 325.715 K."""
    network = thermal_network.thermal_network(
        oil=OilNode(250.0, 66.12, heat=5.0), layers=WALL[1:], **SIZES
    )
    network = replace(network, outer_diameter=28.2e-3, outer_area=math.pi * 28.2e-3 * 0.138)
    steady = thermal_network.steady_temperatures(
        network=network, surroundings=Surroundings(AMBIENT)
    )
    assert steady.surface == pytest.approx(325.715, **SIX_DIGITS)

    def balance(surface):
        state = {"surface_temperature": surface, "ambient_temperature": AMBIENT}
        film = heat_transfer.convection_coefficient(diameter=28.2e-3, **state)
        film += heat_transfer.radiation_coefficient(emissivity=0.9, **state)
        return film * network.outer_area * (surface - AMBIENT) - 5.0

    assert steady.surface == pytest.approx(brentq(balance, 294.0, 400.0, xtol=1e-12), rel=1e-12)


# ---- random actuators ----

POSITIVE = st.floats(0.0, 1.0)


def between(low, high):
    """Numbers between two limits, evenly over their logarithm."""
    return POSITIVE.map(lambda share: low * (high / low) ** share)


LAYERS = st.builds(
    ThermalLayer, between(2e-4, 5e-3), between(0.15, 200.0), between(1e6, 4e6), st.floats(0, 30)
)
PARTS = st.builds(
    ThermalPart, between(0.01, 20.0), between(5e-4, 0.1), between(5e-3, 0.1), between(5.0, 2e3),
    st.floats(0.0, 20.0),
)  # fmt: skip
OILS = st.builds(
    OilNode, between(15.0, 3e3), between(5.0, 2e3), st.floats(0.0, 100.0),
    st.sampled_from([0.0, 0.0, 1.0, 60.0]), st.floats(230.0, 360.0),
)  # fmt: skip
AIR = st.builds(
    Surroundings, st.floats(230.0, 330.0), st.sampled_from([0.0, 0.3, 5.0, 40.0]),
    st.floats(0.05, 1.0), between(2e4, 1.1e5),
)  # fmt: skip
NETWORKS = st.builds(
    lambda layers, parts, oil, bore, length: thermal_network.thermal_network(
        bore=bore, length=length, wetted_length=0.8 * length, oil=oil, layers=layers, parts=parts
    ),
    st.lists(LAYERS, min_size=1, max_size=4), st.lists(PARTS, max_size=3), OILS,
    between(8e-3, 0.2), between(0.05, 1.5),
)  # fmt: skip


@settings(max_examples=100, deadline=None)
@given(NETWORKS, AIR)
def test_all_heat_leaves_through_air_and_oil(network, air):
    """Sum of heat in = heat to air + heat of exchanged oil; written out, and at every node."""
    steady = thermal_network.steady_temperatures(network=network, surroundings=air)
    assert np.isfinite([*steady.nodes, steady.surface, *steady.faces]).all()
    to_air = [
        g * (t - air.temperature)
        for g, t in zip(steady.air_conductances, [steady.surface, *steady.parts], strict=True)
    ]
    carried = network.oil.exchange_conductance * (steady.oil - network.oil.inlet_temperature)
    flows = [abs(carried), *map(abs, to_air), *network.heats]
    assert sum(to_air) + carried == pytest.approx(sum(network.heats), abs=1e-9 * sum(flows) + 1e-9)
    chain = [steady.oil, *steady.layers, steady.surface]
    through = [g * (a - b) for g, a, b in zip(network.conductances, chain, chain[1:], strict=False)]
    for layer, inward, outward in zip(network.layers, through, through[1:], strict=False):
        assert inward + layer.heat == pytest.approx(outward, abs=1e-8 * sum(flows) + 1e-8)


def random_state(passes, count=2000):
    """Temperatures (nodes, designs) of random actuators, with their slope over the air's."""
    rng = np.random.default_rng(1)

    def spread(low, high):
        return low * (high / low) ** rng.uniform(0, 1, count)

    layers = [
        ThermalLayer(spread(2e-4, 5e-3), spread(0.15, 200.0), 2e6, rng.uniform(0, 30, count))
        for _ in range(3)
    ]
    parts = [
        ThermalPart(
            spread(0.01, 20.0),
            spread(5e-4, 0.1),
            spread(5e-3, 0.1),
            50.0,
            rng.uniform(0, 20, count),
        )
        for _ in range(2)
    ]
    exchange = rng.choice([0.0, 0.0, 1.0, 60.0], count)
    oil = OilNode(
        spread(15.0, 3e3), 50.0, rng.uniform(0, 100, count), exchange, rng.uniform(230, 360, count)
    )
    network = thermal_network.thermal_network(
        bore=spread(8e-3, 0.2), length=spread(0.05, 1.5), wetted_length=0.05, oil=oil,
        layers=layers, parts=parts,
    )  # fmt: skip
    air = Surroundings(
        rng.uniform(230, 330, count) + 1j * STEP, rng.choice([0.0, 0.3, 5.0, 40.0], count),
        rng.uniform(0.05, 1.0, count), spread(2e4, 1.1e5),
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        patch.setattr(thermal_network, "PASSES", passes)
        state = thermal_network.steady_temperatures(network=network, surroundings=air)
    return np.array([state.surface, *state.parts, state.oil])


def test_newton_is_done_in_its_passes():
    """Against 30 passes: 1e-12 of every temperature and 1e-8 of every slope, surfaces to 800 K."""
    exact, found = random_state(30), random_state(thermal_network.PASSES)
    valid = exact[:3].real.max(axis=0) < 800.0
    assert 0.9 < valid.mean() < 1.0
    np.testing.assert_allclose(found.real[:, valid], exact.real[:, valid], rtol=1e-12)
    slopes = (found.imag - exact.imag)[:, valid] / STEP
    assert np.abs(slopes).max() < 1e-8
    fewer, mild = random_state(5), exact[:3].real.max(axis=0) < 500.0
    np.testing.assert_allclose(fewer.real[:, mild], exact.real[:, mild], rtol=1e-9)


def rates(network, steady):
    """Heating rates of oil, layers and parts, by flows along every path of a frozen network."""
    layers, capacities = len(network.layers), network.capacities

    def rate(_, temperatures):
        oil, wall, parts = temperatures[0], temperatures[1 : layers + 1], temperatures[layers + 1 :]
        change = [0.0] * len(temperatures)
        change[0] -= network.oil.exchange_conductance * (oil - network.oil.inlet_temperature)
        for node in range(layers):
            flow = network.conductances[node] * (temperatures[node] - wall[node])
            change[node] -= flow
            change[node + 1] += flow
        outward = 1 / (1 / network.conductances[-1] + 1 / steady.air_conductances[0])
        change[layers] -= outward * (wall[-1] - AMBIENT)
        for k, part in enumerate(network.parts):
            flow = part.oil_conductance * (oil - parts[k])
            change[0] -= flow
            change[1 + layers + k] += flow - steady.air_conductances[1 + k] * (parts[k] - AMBIENT)
        pairs = zip(change, network.heats, capacities, strict=True)
        return [(flow + heat) / c for flow, heat, c in pairs]

    return rate


PARTIAL = (
    ThermalPart(0.35, 3.1e-3, 13e-3, 70.0, heat=1.5), ThermalPart(0.8, 2.5e-3, 30e-3, 110.0, 1.5),
)  # fmt: skip


def with_parts(**oil):
    """Network of the worked wall with a rod and a head."""
    node = OilNode(250.0, 66.12, heat=2.0, **oil)
    return thermal_network.thermal_network(oil=node, layers=WALL, parts=PARTIAL, **SIZES)


@pytest.mark.parametrize("exchange", [0.0, 4.0])
def test_transient_is_that_of_an_integrated_network(exchange):
    """An integrator of the same paths, written apart, gives every node at every time."""
    network = with_parts(exchange_conductance=exchange, inlet_temperature=325.0)
    steady = thermal_network.steady_temperatures(
        network=network, surroundings=Surroundings(AMBIENT)
    )
    start = [300.0, 295.0, 294.0, 293.15, 310.0, 280.0]
    times = [1.0, 30.0, 400.0, 6000.0]
    run = solve_ivp(
        rates(network, steady), (0, times[-1]), start, "LSODA", times, rtol=1e-10, atol=1e-10
    )
    for time, expected in zip(times, run.y.T, strict=True):
        found = thermal_network.temperatures_after(
            network=network, steady=steady, start=start, time=time
        )
        assert found == pytest.approx(expected, rel=1e-8)


def test_inner_faces_lie_where_the_heat_flow_puts_them():
    """By the film on the oil's side, and by half of each layer's own resistance between layers."""
    network = worked()
    oil, layers = 330.0, [320.0, 310.0, 305.0]
    first, *others = thermal_network.inner_faces(network=network, oil=oil, layers=layers)
    film = heat_transfer.film_resistance(
        film_coefficient=network.oil.film_coefficient,
        area=math.pi * SIZES["bore"] * SIZES["wetted_length"],
    )
    assert first == pytest.approx(oil - film * network.conductances[0] * (oil - layers[0]))
    radius, halves = SIZES["bore"] / 2, []
    for layer in WALL:
        outer = radius + layer.thickness
        halves.append(
            math.log(outer / radius) / (4 * math.pi * SIZES["length"] * layer.conductivity)
        )
        radius = outer
    for k, face in enumerate(others):
        flow = (layers[k] - layers[k + 1]) / (halves[k] + halves[k + 1])
        assert face == pytest.approx(layers[k] - flow * halves[k])


def test_many_times_at_once_are_those_one_by_one():
    """An array of times gives arrays; a number gives numbers."""
    network = with_parts()
    steady = thermal_network.steady_temperatures(
        network=network, surroundings=Surroundings(AMBIENT)
    )
    pair = {"network": network, "steady": steady, "start": [AMBIENT]}
    times = np.array([[0.0, 30.0], [400.0, 6000.0]])
    found = thermal_network.temperatures_after(time=times, **pair)
    for (i, k), time in np.ndenumerate(times):
        one = thermal_network.temperatures_after(time=float(time), **pair)
        assert [node[i, k] for node in found] == pytest.approx(one, rel=1e-12)


def test_slowest_time_constant_is_the_last_decay():
    """Late on, the distance to the steady state falls by e in one time constant."""
    network = with_parts()
    pair = {
        "network": network,
        "steady": thermal_network.steady_temperatures(
            network=network, surroundings=Surroundings(AMBIENT)
        ),
    }
    constant = thermal_network.slowest_time_constant(**pair)
    late, later = (
        pair["steady"].oil - thermal_network.temperatures_after(start=[AMBIENT], time=t, **pair)[0]
        for t in (6 * constant, 7 * constant)
    )
    assert late / later == pytest.approx(math.e, rel=1e-3)


def finite_volumes(widths, conductivities, bore_film, outer_film, flux):
    """Steady temperatures over ambient of a wall in fine rings: bore, interfaces and outer face.

    Heat `flux` [W per metre] enters oil at the bore film; every ring has its own balance.
    """
    rings, edges = 400, [11.5e-3]
    conductivity = []
    for width, k in zip(widths, conductivities, strict=True):
        edges += list(edges[-1] + width * np.arange(1, rings + 1) / rings)
        conductivity += [k] * rings
    edges, k = np.array(edges), np.array(conductivity)
    centres = 0.5 * (edges[1:] + edges[:-1])
    area = 2 * math.pi * edges
    width = np.diff(edges)
    inner = 1 / (1 / (bore_film * area[0]) + 0.5 * width[0] / (k[0] * area[0]))
    outer = 1 / (1 / (outer_film * area[-1]) + 0.5 * width[-1] / (k[-1] * area[-1]))
    between_rings = area[1:-1] / (0.5 * width[:-1] / k[:-1] + 0.5 * width[1:] / k[1:])
    matrix = np.zeros((len(k) + 1, len(k) + 1))  # oil first
    for i, g in enumerate([inner, *between_rings]):
        matrix[[i, i + 1], [i, i + 1]] += g
        matrix[[i, i + 1], [i + 1, i]] -= g
    matrix[-1, -1] += outer
    right = np.zeros(len(k) + 1)
    right[0] = flux
    found = np.linalg.solve(matrix, right)
    faces = [
        found[1 + rings * i] + flux * math.log(centres[rings * i] / edges[rings * i])
        / (2 * math.pi * k[rings * i])
        for i in range(len(widths))
    ]  # fmt: skip
    return found[0], faces, outer * found[-1] / (outer_film * area[-1])


def test_wall_is_that_of_radial_finite_volumes():
    """400 rings a layer give oil, inner faces and surface; the laminate holds 5 % of the rise."""
    layers = tuple(replace(layer, heat=0.0) for layer in WALL)
    network = thermal_network.thermal_network(
        bore=23e-3, length=0.138, wetted_length=0.138, oil=OilNode(250.0, 66.12, 8.0), layers=layers
    )
    steady = thermal_network.steady_temperatures(network=network, surroundings=FROZEN_AIR)
    oil, faces, surface = finite_volumes(
        (0.6e-3, 1.2e-3, 0.8e-3), (130.0, 0.6, 0.6), 250.0, 13.11428, 8.0 / 0.138
    )
    assert rises([steady.oil, *steady.faces, steady.surface]) == pytest.approx(
        [oil, *faces, surface], rel=1e-5
    )
    share = (steady.faces[1] - steady.surface) / (steady.oil - AMBIENT)
    assert 0.03 < share < 0.06


def test_cold_wall_rises_like_radial_finite_volumes():
    """One node a layer errs by less than 2 % of the rise against 40 rings, from 30 s on."""
    network = worked()
    steady = thermal_network.steady_temperatures(network=network, surroundings=FROZEN_AIR)
    split = [
        replace(layer, thickness=layer.thickness / 13, heat=layer.heat / 13)
        for layer in WALL
        for _ in range(13)
    ]
    fine = thermal_network.thermal_network(oil=network.oil, layers=split, **SIZES)
    settled = thermal_network.steady_temperatures(network=fine, surroundings=FROZEN_AIR)
    for time in (30.0, 200.0, 900.0):
        few = thermal_network.temperatures_after(
            network=network, steady=steady, start=[AMBIENT], time=time
        )
        many = thermal_network.temperatures_after(
            network=fine, steady=settled, start=[AMBIENT], time=time
        )
        assert few[0] - AMBIENT == pytest.approx(many[0] - AMBIENT, rel=0.02)
        assert few[2] - AMBIENT == pytest.approx(many[1 + 13 + 6] - AMBIENT, rel=0.02)


def test_frozen_coefficients_err_by_less_than_a_tenth():
    """Against films that follow the temperature, rises from cold differ by less than 10 %."""
    network, air = worked(), Surroundings(AMBIENT)
    steady = thermal_network.steady_temperatures(network=network, surroundings=air)

    def rate(_, temperatures):
        def loss(surface):
            state = {"surface_temperature": surface, "ambient_temperature": AMBIENT}
            film = heat_transfer.convection_coefficient(diameter=28.2e-3, **state)
            film += heat_transfer.radiation_coefficient(emissivity=0.9, **state)
            heat = film * network.outer_area * (surface - AMBIENT)
            return heat - network.conductances[-1] * (temperatures[-1] - surface)

        surface = brentq(loss, AMBIENT - 50, AMBIENT + 200, xtol=1e-10)
        now = replace(steady, air_conductances=(1e9,))
        change = rates(network, now)(0.0, temperatures)
        wrong = 1 / (1 / network.conductances[-1] + 1e-9) * (temperatures[-1] - AMBIENT)
        right = network.conductances[-1] * (temperatures[-1] - surface)
        change[-1] += (wrong - right) / network.capacities[-1]
        return change

    times = [100.0, 600.0, 2000.0]
    run = solve_ivp(rate, (0, 2000.0), [AMBIENT] * 4, "LSODA", times, rtol=1e-6)
    for time, exact in zip(times, run.y.T, strict=True):
        found = thermal_network.temperatures_after(
            network=network, steady=steady, start=[AMBIENT], time=time
        )
        assert rises(found) == pytest.approx(rises(exact), rel=0.10)


# ---- slopes ----

INPUTS = {
    "bore": 23e-3, "length": 0.138, "thickness": 1.2e-3, "conductivity": 0.6, "film": 250.0,
    "oil_heat": 2.0, "seal_heat": 6.0, "exchange": 3.0, "inlet": 320.0, "rod_film": 0.35,
    "rod_area": 3.1e-3, "ambient": AMBIENT, "wind": 0.0, "emissivity": 0.9,
}  # fmt: skip


def everything(values):
    """Temperatures of all nodes, faces and the surface (rows, k) from inputs (inputs, k)."""
    x = dict(zip(INPUTS, values, strict=True))
    oil = OilNode(x["film"], 66.0, x["oil_heat"], x["exchange"], x["inlet"])
    layers = (
        replace(WALL[0], heat=x["seal_heat"]),
        ThermalLayer(x["thickness"], x["conductivity"], 1.5e6),
        WALL[2],
    )
    parts = (ThermalPart(x["rod_film"], x["rod_area"], 13e-3, 70.0, 0.2 * x["seal_heat"]),)
    network = thermal_network.thermal_network(
        bore=x["bore"], length=x["length"], wetted_length=0.8 * x["length"], oil=oil,
        layers=layers, parts=parts,
    )  # fmt: skip
    air = Surroundings(x["ambient"], x["wind"], x["emissivity"])
    state = thermal_network.steady_temperatures(network=network, surroundings=air)
    rows = [*state.nodes, state.surface, *state.faces]
    return np.stack([row + 0 * values[0] for row in rows])


@pytest.mark.parametrize("wind", [0.05, 4.0])
def test_slopes_are_those_of_central_differences(wind):
    """The complex step of every temperature to every input, in still air and in wind."""
    point = np.array([wind if name == "wind" else value for name, value in INPUTS.items()])
    size = len(point)
    stepped = np.repeat(point[:, None].astype(complex), size, axis=1)
    stepped += 1j * STEP * np.eye(size)
    exact = everything(stepped).imag / STEP
    change = 1e-5 * point
    high = everything(point[:, None] + np.diag(change))
    low = everything(point[:, None] - np.diag(change))
    np.testing.assert_allclose(exact * point, (high - low) / 2e-5, rtol=1e-5, atol=1e-5)
    assert (exact[0, list(INPUTS).index("seal_heat")] > 0).all()


@pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
def test_recorded_network_is_the_network():
    """The machine gives values and slopes of the models, for designs far from the recorded one."""
    point = np.array(list(INPUTS.values()))
    recorded = RecordedFunction(everything, list(INPUTS), point)
    rng = np.random.default_rng(5)
    designs = point[:, None] * rng.uniform(0.85, 1.15, (len(point), 40))
    designs[list(INPUTS).index("wind")] = rng.choice([0.0, 0.02, 5.0], 40)
    np.testing.assert_allclose(recorded(designs), everything(designs), rtol=1e-12)
    assert not recorded.reason
    assert recorded.recording is not None
    stepped = np.repeat(point[:, None].astype(complex), len(point), axis=1)
    stepped += 1j * STEP * np.eye(len(point))
    np.testing.assert_allclose(
        recorded(stepped).imag / STEP, everything(stepped).imag / STEP, rtol=1e-9, atol=1e-12
    )
    assert recorded.outside == 0  # no branch depends on values


# ---- ripple, and input without an answer ----


def test_ripple_bound_of_a_square_and_a_sine():
    """Triangular energy of a square wave; a sine P sin(wt) has the bound 2P/(wC)."""
    edge = 1e-9
    square = thermal_network.ripple_bound(
        time=[0.0, 1.0 - edge, 1.0, 2.0], power=[8.0, 8.0, 0.0, 0.0], heat_capacity=5.0
    )
    assert square == pytest.approx(4.0 / 5.0, rel=1e-8)
    time = np.linspace(0, 2.0, 401)
    sine = thermal_network.ripple_bound(
        time=list(time), power=list(3.0 * np.sin(math.pi * time)), heat_capacity=10.0
    )
    assert sine == pytest.approx(2 * 3.0 / (math.pi * 10.0), rel=1e-4)
    assert thermal_network.ripple_bound(time=[0.0, 1.0], power=[7.0, 7.0], heat_capacity=5.0) == 0.0


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0.0, 200.0), min_size=3, max_size=6), between(0.02, 30.0))
def test_ripple_stays_within_its_bound(power, loss):
    """The exact steady cycle of a node that loses heat stays within the bound about its mean."""
    power = [*power, power[0]]
    time, capacity = np.arange(len(power), dtype=float), 40.0
    bound = thermal_network.ripple_bound(time=list(time), power=power, heat_capacity=capacity)
    fine = np.linspace(0, time[-1], 2000 * (len(power) - 1) + 1)
    step, heat = fine[1], np.interp(fine, time, power)
    decay = math.exp(-loss * step / capacity)
    gain = (1 - decay) / loss
    forced = np.zeros_like(fine)
    for i in range(1, len(fine)):  # heat constant over a step
        forced[i] = decay * forced[i - 1] + gain * 0.5 * (heat[i] + heat[i - 1])
    start = forced[-1] / (1 - math.exp(-loss * fine[-1] / capacity))  # closed cycle
    cycle = forced + start * np.exp(-loss * fine / capacity)
    deviation = cycle - np.trapezoid(cycle, fine) / fine[-1]
    assert np.max(np.abs(deviation)) <= bound * (1 + 1e-3) + 1e-6


def test_input_without_an_answer():
    """No layer, wrong numbers of temperatures and of samples are refused; the rest gives NaN."""
    with pytest.raises(ValueError, match="at least one layer"):
        thermal_network.thermal_network(oil=OilNode(250.0, 66.0), layers=[], **SIZES)
    network = worked()
    steady = thermal_network.steady_temperatures(network=network, surroundings=FROZEN_AIR)
    with pytest.raises(ValueError, match="state 1 or 4 temperatures"):
        thermal_network.temperatures_after(
            network=network, steady=steady, start=[1.0, 2.0], time=1.0
        )
    for samples in ({"time": [0.0], "power": [1.0]}, {"time": [0.0, 1.0], "power": [1.0]}):
        with pytest.raises(ValueError, match="one power for each time"):
            thermal_network.ripple_bound(heat_capacity=1.0, **samples)
    hollow = replace(network, oil=replace(network.oil, heat_capacity=0.0))
    assert math.isnan(thermal_network.slowest_time_constant(network=hollow, steady=steady))
    bores = np.array([23e-3, -1e-3])
    array = thermal_network.thermal_network(
        bore=bores, length=0.138, wetted_length=0.11, oil=OilNode(250.0, 66.0, 2.0), layers=WALL
    )
    found = thermal_network.steady_temperatures(network=array, surroundings=Surroundings(AMBIENT))
    assert np.isnan(found.oil).tolist() == [False, True]


def test_heat_beyond_any_actuator_is_nan_or_balanced():
    """No silent wrong number: from 1e-3 to 1e7 W, what is returned closes its balance."""
    heats = np.geomspace(1e-3, 1e7, 31)
    network = thermal_network.thermal_network(
        oil=OilNode(250.0, 66.0, heat=heats), layers=[replace(WALL[0], heat=0.0)], **SIZES
    )
    steady = thermal_network.steady_temperatures(
        network=network, surroundings=Surroundings(AMBIENT)
    )
    known = np.isfinite(steady.surface)
    assert known[heats < 500.0].all()
    assert not known.all()
    to_air = steady.air_conductances[0] * (steady.surface - AMBIENT)
    np.testing.assert_allclose(to_air[known], heats[known], rtol=1e-9)
