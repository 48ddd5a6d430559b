"""Claims about accumulators, water hammer, transmission lines, resonators and line-end valves."""

from __future__ import annotations

import math

import array_api_strict as strict
import numpy as np
import pytest
from hypothesis import given, strategies as st
from model_samples import leaves, public_functions, rebuilt
from samples_lines import FREQUENCY_RESPONSES
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import jv, jve

from actuator_opt.models import accumulator, elements, line_ends, lines, transmission_line

PIPE = {"inner_diameter": 8e-3, "length": 1.2}
SECTION = {"inner_diameter": 8e-3, "density": 865.0, "dynamic_viscosity": 0.04}
SPEED = math.sqrt(1.4e9 / 865.0)
LINE = {**SECTION, "length": 1.2, "sound_speed": SPEED}
AREA = math.pi * 4e-3**2
SURGE = 865.0 * SPEED / AREA  # characteristic impedance without loss
FRICTION = st.sampled_from(lines.FRICTION)
FREQUENCIES = st.floats(-1, 4).map(lambda x: 10**x)


# Laws of complex-valued functions: they stand beside those of `test_models_laws`.

CASES = [
    pytest.param(*(case if isinstance(case, tuple) else (public_functions()[name], case)), id=name)
    for name, samples in FREQUENCY_RESPONSES.items()
    for case in samples
]


def parts(result):
    """Complex numbers of a result: one, or the entries of a matrix."""
    return list(result) if isinstance(result, tuple) else [result]


@pytest.mark.parametrize(("function", "sample"), CASES)
def test_response_of_arrays_is_that_of_scalars(function, sample):
    """Columns and rows broadcast; each element is the scalar call's."""
    numbers = leaves(sample)
    rows, columns = np.array([[1.0], [1.01]]), np.array([[1.0, 0.98, 1.02]])
    arrays = [v * (columns if i % 2 else rows) for i, v in enumerate(numbers)]
    together = parts(function(**rebuilt(sample, iter(arrays))))
    scaled = [v * (1.02 if i % 2 else 1.01) for i, v in enumerate(numbers)]
    one = parts(function(**rebuilt(sample, iter(scaled))))
    for array, scalar in zip(together, one, strict=True):
        assert np.ndim(scalar) == 0
        assert np.broadcast_to(array, (2, 3))[1, 2] == pytest.approx(scalar, rel=1e-12)


@pytest.mark.parametrize(("function", "sample"), CASES)
def test_response_in_any_array_namespace(function, sample):
    """Strict array-API arrays give the scalar numbers: only standard functions are used."""
    numbers = leaves(sample)
    arrays = [strict.asarray([v]) for v in numbers]
    ours = parts(function(**rebuilt(sample, iter(arrays))))
    for array, scalar in zip(ours, parts(function(**sample)), strict=True):
        assert complex(array[0]) == pytest.approx(complex(scalar), rel=1e-9)


@pytest.mark.parametrize(("function", "sample"), [c for c in CASES if "frequency" in c.values[1]])
def test_response_at_negative_frequency_is_the_conjugate(function, sample):
    """Real signals stay real: F(-f) is the conjugate of F(f)."""
    mirrored = function(**{**sample, "frequency": -sample["frequency"]})
    for one, other in zip(parts(function(**sample)), parts(mirrored), strict=True):
        assert other == pytest.approx(np.conj(one), rel=1e-12)


# Accumulators


def test_gas_halves_when_the_absolute_pressure_doubles():
    """Isothermal: 60 -> 120 bar absolute halves 1 l; below the precharge the shell is full."""
    gas = {"precharge_pressure": 59e5, "gas_volume": 1e-3, "atmospheric_pressure": 1e5}
    volume = accumulator.gas_volume_at(pressure=np.array([119e5, 59e5, 0.0]), **gas)
    np.testing.assert_allclose(volume, [0.5e-3, 1e-3, 1e-3], rtol=1e-14)
    adiabatic = accumulator.gas_volume_at(pressure=119e5, polytropic_index=1.4, **gas)
    assert adiabatic == pytest.approx(1e-3 * 0.5 ** (1 / 1.4))


@given(st.floats(61e5, 3e7), st.floats(1.0, 1.7))
def test_capacitance_is_the_slope_of_the_gas_volume(pressure, index):
    """-dV/dp with one index for filling and vibration; slow filling, fast vibration: V/(n p)."""
    gas = {"precharge_pressure": 60e5, "gas_volume": 1e-3}
    both = {"polytropic_index": index, **gas}
    capacitance = accumulator.gas_capacitance(pressure=pressure, filling_index=index, **both)
    above = accumulator.gas_volume_at(pressure=pressure + 100.0, **both)
    below = accumulator.gas_volume_at(pressure=pressure - 100.0, **both)
    assert capacitance == pytest.approx((below - above) / 200.0, rel=1e-6)
    volume = accumulator.gas_volume_at(pressure=pressure, **gas)
    fast = accumulator.gas_capacitance(pressure=pressure, polytropic_index=1.4, **gas)
    assert fast == pytest.approx(volume / (1.4 * (pressure + 101325.0)))


def test_accumulator_below_its_precharge_is_not_there():
    """No capacitance, and no usable volume below the precharge pressure."""
    gas = {"precharge_pressure": 60e5, "gas_volume": 1e-3}
    assert accumulator.gas_capacitance(pressure=50e5, **gas) == 0.0
    assert accumulator.usable_volume(low_pressure=20e5, high_pressure=50e5, **gas) == 0.0


def test_usable_volume_by_hand():
    """Filled slowly to 1/2 l at 120 bar abs, let out fast to 80: 0.5 (1.5^(1/1.4) - 1) l."""
    gas = {"precharge_pressure": 59e5, "gas_volume": 1e-3, "atmospheric_pressure": 1e5}
    given_oil = accumulator.usable_volume(low_pressure=79e5, high_pressure=119e5, **gas)
    assert given_oil == pytest.approx(0.5e-3 * (1.5 ** (1 / 1.4) - 1))
    emptied = accumulator.usable_volume(low_pressure=10e5, high_pressure=119e5, **gas)
    assert emptied == pytest.approx(0.5e-3)


# Water hammer


def test_wave_speed_in_a_rigid_line():
    """K 1.4 GPa, 865 kg/m3: 1272.20 m/s; the lumped line agrees, a = l/sqrt(L C)."""
    volume = lines.line_volume(**PIPE)
    speed = transmission_line.wave_speed(bulk_modulus=1.4e9, density=865.0, volume=volume)
    assert speed == pytest.approx(1272.20, rel=3e-6)
    inertance = elements.inertance(**PIPE, density=865.0)
    capacitance = elements.capacitance(volume=volume, bulk_modulus=1.4e9)
    assert speed == pytest.approx(1.2 / math.sqrt(inertance * capacitance))


def test_wave_speed_in_an_elastic_line():
    """Thin wall: Korteweg's K/rho/(1 + K D/(E e)); thick wall: lumped with `line_compliance`."""
    wall = {"youngs_modulus": 2e11, "poissons_ratio": 0.3}
    for outer, expected in ((8.008e-3, 1 + 1.4e9 * 8e-3 / (2e11 * 4e-6)), (12e-3, None)):
        compliance = lines.line_compliance(outer_diameter=outer, **PIPE, **wall)
        volume = lines.line_volume(**PIPE)
        speed = transmission_line.wave_speed(
            bulk_modulus=1.4e9, density=865.0, volume=volume, wall_compliance=compliance
        )
        if expected:
            assert speed == pytest.approx(SPEED / math.sqrt(expected), rel=1e-3)
        both = elements.capacitance(volume=volume, bulk_modulus=1.4e9) + compliance
        inertance = elements.inertance(**PIPE, density=865.0)
        assert speed == pytest.approx(1.2 / math.sqrt(inertance * both))


def test_joukowsky_is_the_momentum_of_the_stopped_oil():
    """Oil of l = a t is stopped in t: dp A t = rho A l dv; the wave sees rho a/A per flow."""
    rise = transmission_line.joukowsky_pressure(
        density=865.0, sound_speed=SPEED, velocity_change=4.0
    )
    assert rise * AREA * 1e-3 == pytest.approx(865.0 * AREA * (SPEED * 1e-3) * 4.0)
    assert rise == pytest.approx(SURGE * AREA * 4.0)


# Transmission lines


def test_series_impedance_is_the_bessel_solution():
    """Z' A/(i omega rho) = 1/(1 - 2 J1(z)/(z J0(z))), z = i^(3/2) r sqrt(omega/nu), by SciPy."""
    frequency = np.logspace(-3, 4.5, 200)
    omega = 2 * np.pi * frequency
    for viscosity in (0.04, 1e-3):
        z = np.exp(0.75j * np.pi) * 4e-3 * np.sqrt(omega * 865.0 / viscosity)
        bessel = (1j * omega * 865.0 / AREA) / (1 - 2 * jve(1, z) / (z * jve(0, z)))
        ours = lines.series_impedance(
            frequency=frequency, **{**SECTION, "dynamic_viscosity": viscosity}
        )
        np.testing.assert_allclose(ours, bessel, rtol=1e-9)


def test_distributed_friction_at_low_frequency():
    """Z' l -> R + i omega (4/3) L with the lumped R 4.77465e8, L 2.06504e7 of the line."""
    z = 1.2 * lines.series_impedance(frequency=1e-4, **SECTION)
    assert z.real == pytest.approx(4.77465e8, rel=2e-6)
    assert z.imag / (2 * math.pi * 1e-4) == pytest.approx(4 / 3 * 2.06504e7, rel=3e-6)
    still = lines.series_impedance(frequency=0.0, **SECTION)
    assert 1.2 * still == pytest.approx(4.77465e8, rel=2e-6)


def test_distributed_friction_at_high_frequency():
    """Z'/(i omega rho/A) -> 1 + 2/w + 3/w^2, w = r sqrt(i omega/nu): resistance ~ sqrt(omega)."""
    for frequency in (1e6, 1e8):
        omega = 2 * math.pi * frequency
        w = 4e-3 * np.sqrt(1j * omega * 865.0 / 0.04)
        z = lines.series_impedance(frequency=frequency, **SECTION)
        ratio = z / (1j * omega * 865.0 / AREA)
        assert abs(ratio - (1 + 2 / w + 3 / w**2)) < 10 / abs(w) ** 3
        resistance = z.real / math.sqrt(frequency)
    limit = 2 * math.sqrt(math.pi * 865.0 * 0.04) / (AREA * 4e-3)
    assert resistance == pytest.approx(limit, rel=1e-2)


@pytest.mark.parametrize("frequency", [1.0, 30.0, 1000.0])
def test_distributed_resistance_is_the_dissipation_of_the_profile(frequency):
    """Re(Z') |q|^2 = integral of eta |du/dr|^2 over the section, of the oscillating profile."""
    omega, radius = 2 * math.pi * frequency, 4e-3
    wave = np.exp(0.75j * np.pi) * math.sqrt(omega * 865.0 / 0.04)  # u = 1 - J0(k r)/J0(k R)
    centre = jv(0, wave * radius)

    def total(function):
        return quad(
            lambda r: 2 * math.pi * r * function(r), 0, radius, epsrel=1e-10, complex_func=True
        )[0]

    flow = total(lambda r: 1 - jv(0, wave * r) / centre)
    loss = total(lambda r: 0.04 * abs(wave * jv(1, wave * r) / centre) ** 2).real
    impedance = lines.series_impedance(frequency=frequency, **SECTION)
    assert impedance.real == pytest.approx(loss / abs(flow) ** 2, rel=1e-8)


def test_steady_friction_is_the_lumped_line():
    """Z' l = R + i omega L at every frequency; lossless: R = 0. An unknown name is refused."""
    for frequency in (0.0, 5.0, 3e3):
        along = {"frequency": frequency, **SECTION}
        z = 1.2 * lines.series_impedance(**along, friction="steady")
        inertia = 2 * math.pi * frequency * elements.inertance(**PIPE, density=865.0)
        friction = elements.resistance(**PIPE, dynamic_viscosity=0.04)
        assert z == pytest.approx(friction + 1j * inertia)
        lossless = lines.series_impedance(**along, friction="lossless")
        assert 1.2 * lossless == pytest.approx(1j * inertia)
    with pytest.raises(ValueError, match="friction: dry; choose one of lossless, steady"):
        lines.series_impedance(frequency=1.0, **SECTION, friction="dry")


def test_lossless_line_closed_forms():
    """A = cos(omega l/a), B = i Z_c sin, C = i sin/Z_c with Z_c = rho a/A."""
    for frequency in (3.0, 100.0, 700.0):
        at = {"frequency": frequency, "friction": "lossless"}
        angle = 2 * math.pi * frequency * 1.2 / SPEED
        matrix = transmission_line.line_matrix(**at, **LINE)
        cosine, sine = math.cos(angle), 1j * math.sin(angle)
        np.testing.assert_allclose(matrix, [cosine, SURGE * sine, sine / SURGE, cosine], 1e-9)


@given(FREQUENCIES, FRICTION)
def test_line_is_reciprocal_and_symmetric(frequency, friction):
    """A D - B C = 1, A = D; cosh Gamma and Z_c sinh Gamma from the line's two wave constants."""
    at = {"frequency": frequency, "friction": friction}
    matrix = transmission_line.line_matrix(**at, **LINE)
    assert matrix.A == matrix.D
    scale = max(1.0, abs(matrix.A) ** 2)
    assert abs(matrix.A * matrix.D - matrix.B * matrix.C - 1) < 1e-9 * scale
    along = lines.series_impedance(**at, **SECTION)
    across = 2j * math.pi * frequency * AREA / (865.0 * SPEED**2)
    gamma, surge = 1.2 * np.sqrt(along * across), np.sqrt(along / across)
    tolerance = 1e-9 * abs(np.cosh(gamma.real))
    assert abs(matrix.A - np.cosh(gamma)) < tolerance
    assert abs(matrix.B - surge * np.sinh(gamma)) < tolerance * abs(surge)


@given(FREQUENCIES, FRICTION, st.floats(0.05, 0.95))
def test_two_pieces_make_the_line(frequency, friction, share):
    """The product of the matrices of two pieces is the matrix of the whole."""
    whole = transmission_line.line_matrix(frequency=frequency, friction=friction, **LINE)
    pieces = [
        transmission_line.line_matrix(
            frequency=frequency, friction=friction, **{**LINE, "length": 1.2 * part}
        )
        for part in (share, 1 - share)
    ]
    near, far = (np.array(piece).reshape(2, 2) for piece in pieces)
    joined = (near @ far).ravel()
    scale = np.array([1.0, SURGE, 1 / SURGE, 1.0]) * abs(whole.A) + 1e-300
    size = np.array([1.0, SURGE, 1 / SURGE, 1.0]) * max(1.0, abs(pieces[0].A * pieces[1].A))
    assert np.all(np.abs(joined - np.array(whole)) < 1e-8 * np.maximum(scale, size))


@given(st.floats(1e7, 1e12), st.floats(-1e12, 1e12))
def test_quarter_and_half_wave_transformers(resistance, reactance):
    """Without loss a quarter wave turns Z into Z_c^2/Z, a half wave leaves it, Z_c is matched."""
    end = complex(resistance, reactance)
    quarter, half = (
        transmission_line.line_matrix(frequency=n * SPEED / 4.8, friction="lossless", **LINE)
        for n in (1, 2)
    )
    turned = transmission_line.input_impedance(matrix=quarter, end_impedance=end)
    assert turned == pytest.approx(SURGE**2 / end, rel=1e-9)
    same = transmission_line.input_impedance(matrix=half, end_impedance=end)
    assert same == pytest.approx(end, rel=1e-9)
    matched = transmission_line.input_impedance(matrix=quarter, end_impedance=SURGE)
    assert matched == pytest.approx(SURGE, rel=1e-9)


@given(FREQUENCIES, FRICTION)
def test_open_and_closed_ends(frequency, friction):
    """Z of 0 is Y of infinity, B/D; Z of infinity is Y of 0, A/C."""
    matrix = transmission_line.line_matrix(frequency=frequency, friction=friction, **LINE)
    for impedance, admittance, value in (
        (0.0, math.inf, matrix.B / matrix.D),
        (math.inf, 0.0, matrix.A / matrix.C),
    ):
        z = transmission_line.input_impedance(matrix=matrix, end_impedance=impedance)
        y = transmission_line.input_admittance(matrix=matrix, end_admittance=admittance)
        assert z == pytest.approx(value, rel=1e-12)
        assert y == pytest.approx(1 / value, rel=1e-12)


def test_slow_limits_of_a_line():
    """Closed: the volume's i omega C with C 4.30847e-14; open: R; at rest a closed end blocks."""
    matrix = transmission_line.line_matrix(frequency=1e-3, **LINE)
    closed = transmission_line.input_admittance(matrix=matrix, end_admittance=0.0)
    assert closed == pytest.approx(2j * math.pi * 1e-3 * 4.30847e-14, rel=3e-6)
    still = transmission_line.line_matrix(frequency=0.0, **LINE)
    assert transmission_line.input_impedance(matrix=still, end_impedance=0.0) == pytest.approx(
        4.77465e8, rel=2e-6
    )
    assert transmission_line.input_admittance(matrix=still, end_admittance=0.0) == 0
    assert transmission_line.input_impedance(matrix=still, end_impedance=math.inf) == math.inf


@given(FREQUENCIES, st.floats(0, 1e12), st.floats(-1e12, 1e12))
def test_passive_line_stays_passive(frequency, resistance, reactance):
    """An end that takes power makes a line that takes power: Re Z and Re Y are not negative."""
    matrix = transmission_line.line_matrix(frequency=frequency, **LINE)
    end = complex(resistance, reactance)
    near = transmission_line.input_impedance(matrix=matrix, end_impedance=end)
    assert near.real >= 0


@pytest.mark.parametrize("friction", ["steady", "distributed"])
def test_energy_balance_along_a_line(friction):
    """Power in less power out is the integral of Re(Z') |q|^2/2 over the length."""
    at = {"frequency": 200.0, "friction": friction}
    end = 3e9 + 2e9j  # p2 = Z, q2 = 1
    resistance = lines.series_impedance(**at, **SECTION).real

    def state(distance):
        """Pressure and flow at a distance from the far end."""
        m = transmission_line.line_matrix(**at, **{**LINE, "length": distance})
        return m.A * end + m.B, m.C * end + m.D

    pressure, flow = state(1.2)
    lost, _ = quad(lambda x: resistance * abs(state(x)[1]) ** 2 / 2, 0, 1.2, epsrel=1e-10)
    power = (pressure * np.conj(flow)).real / 2 - end.real / 2
    assert power == pytest.approx(lost, rel=1e-8)


# Resonators


@given(FREQUENCIES, st.floats(0, 1e10))
def test_accumulator_end_is_the_inverse_of_its_branch(frequency, resistance):
    """Y = 1/(R + i omega L + 1/(i omega C)); an empty accumulator takes no flow."""
    neck = {"inertance": 5e6, "resistance": resistance}
    at = {"frequency": frequency}
    y = line_ends.end_admittance(end=line_ends.accumulator_end(**neck, capacitance=7e-13), **at)
    omega = 2 * math.pi * frequency
    z = resistance + 1j * omega * 5e6 + 1 / (1j * omega * 7e-13)
    assert y * z == pytest.approx(1.0)
    empty = line_ends.accumulator_end(**neck, capacitance=0.0)
    assert line_ends.end_admittance(end=empty, **at) == 0


def test_accumulator_branch_resonates_with_its_neck():
    """1 l gas at 60 bar behind 10 x 100 mm, at 100 bar: lowest impedance at 1/(2 pi sqrt(L C))."""
    neck = {
        "inertance": elements.inertance(inner_diameter=0.01, length=0.1, density=865.0),
        "capacitance": accumulator.gas_capacitance(
            pressure=100e5, precharge_pressure=60e5, gas_volume=1e-3
        ),
        "resistance": elements.resistance(inner_diameter=0.01, length=0.1, dynamic_viscosity=0.04),
    }
    resonance = elements.resonance_frequency(**{k: neck[k] for k in ("inertance", "capacitance")})
    frequencies = resonance * np.linspace(0.5, 2, 3001)
    end = line_ends.accumulator_end(**neck)
    response = np.abs(line_ends.end_admittance(end=end, frequency=frequencies))
    assert frequencies[np.argmax(response)] == pytest.approx(resonance, rel=1e-3)
    assert response.max() == pytest.approx(1 / neck["resistance"], rel=1e-3)


def test_quarter_wave_length_of_the_thesis():
    """[AaltoThesis] eq. 18: 20 Hz at 1300 m/s is 16.25 m; the inverse of the frequency."""
    length = transmission_line.quarter_wave_length(frequency=20.0, sound_speed=1300.0)
    assert length == 16.25
    assert elements.quarter_wave_frequency(length=length, sound_speed=1300.0) == 20.0
    assert transmission_line.quarter_wave_length(
        frequency=20.0, sound_speed=1300.0, quarter_waves=2.0
    ) == pytest.approx(32.5)


T_PIPE = {**SECTION, "length": 16.25, "sound_speed": 1300.0}


@given(st.floats(0.5, 200).filter(lambda f: abs(math.sin(math.pi * f / 40)) > 0.01))
def test_plugged_branch_without_loss(frequency):
    """Z = -i Z_c cot(omega l/a)."""
    angle = 2 * math.pi * frequency * 16.25 / 1300.0
    at = {"frequency": frequency, "friction": "lossless", **T_PIPE}
    surge = 865.0 * 1300.0 / AREA
    impedance = transmission_line.plugged_branch_impedance(**at)
    assert impedance / surge == pytest.approx(-1j / math.tan(angle), rel=1e-6, abs=1e-9)


def test_plugged_branch_odd_and_even_quarter_waves():
    """Odd quarter waves: small impedance. Even: large impedance."""
    frequency = np.array([20.0, 40.0, 60.0, 80.0])
    pipe = {**T_PIPE, "dynamic_viscosity": 0.004}
    impedance = np.abs(transmission_line.plugged_branch_impedance(frequency=frequency, **pipe))
    surge = 865.0 * 1300.0 / AREA
    assert np.all(impedance[::2] < 0.2 * surge)
    assert np.all(impedance[1::2] > 4 * surge)


# Reducing valve

VALVE = {"conductance": 2e-10, "natural_frequency": 10.0, "damping_ratio": 0.5}


def admittance(frequency, **valve):
    """Admittance of a reducing valve."""
    end = line_ends.reducing_valve_end(**valve)
    return line_ends.end_admittance(end=end, frequency=frequency)


def test_reducing_valve_holds_slowly_and_stands_fast():
    """G + g at rest, -i G/(2 zeta) + g at its own frequency, g far above."""
    y = admittance(np.array([0.0, 10.0, 1e8]), passive_conductance=1e-11, **VALVE)
    np.testing.assert_allclose(y, [2.1e-10, 1e-11 - 2e-10j, 1e-11], rtol=1e-9)


@given(st.floats(1, 50), st.floats(0.05, 0.95), st.floats(0.5, 30))
def test_antiresonance_frequency_is_where_chamber_and_valve_ring(natural, damping, strength):
    """No reactive flow there; with g = -Re(Y) the poles of chamber and valve lie on the axis."""
    compliance = 1e-12
    omega_0 = 2 * math.pi * natural
    conductance = (strength + 2 * damping) * compliance * omega_0  # above the weakest, 2 zeta
    valve = {
        "conductance": conductance, "natural_frequency": natural, "damping_ratio": damping,
    }  # fmt: skip
    frequency = line_ends.antiresonance_frequency(**valve, compliance=compliance)
    omega = 2 * math.pi * frequency
    y = admittance(frequency, **valve)
    assert y.imag / omega == pytest.approx(-compliance, rel=1e-8)
    passive = -y.real
    assert passive > 0
    poles = np.roots(
        np.polyadd(
            np.polymul([compliance, passive], [1, 2 * damping * omega_0, omega_0**2]),
            [conductance * omega_0**2],
        )
    )
    ringing = poles[np.argmax(poles.imag)]
    assert ringing == pytest.approx(1j * omega, rel=1e-6)


def test_weak_valve_never_outweighs_the_compliance():
    """Far too small a conductance: no such frequency."""
    value = line_ends.antiresonance_frequency(**{**VALVE, "conductance": 1e-14}, compliance=1e-12)
    assert math.isnan(value)


def test_twenty_hertz_peak_traced_to_a_valve():
    """A stiffness peak at 20 Hz [AaltoThesis] over a chamber of 1e-12 m3/Pa means this valve.

    A valve of 1 l/min per bar, damping ratio 0.5, that leaves the chamber near its limit of
    stability: its own frequency follows from the peak, and the stiffness |1/(C + Y/(i omega))|
    of the whole range is then largest at 20 Hz, above that of the closed chamber.
    """
    compliance, conductance = 1e-12, 1 / 60000 / 1e5
    valve = {"conductance": conductance, "damping_ratio": 0.5}

    def mismatch(natural):
        peak = line_ends.antiresonance_frequency(
            natural_frequency=natural, compliance=compliance, **valve
        )
        return peak - 20.0

    natural = brentq(mismatch, 5.0, 19.0)
    limit = -admittance(20.0, natural_frequency=natural, **valve).real
    frequency = np.linspace(1, 60, 2000)
    y = admittance(frequency, natural_frequency=natural, passive_conductance=1.1 * limit, **valve)
    stiffness = np.abs(1 / (compliance + y / (2j * math.pi * frequency)))
    assert frequency[np.argmax(stiffness)] == pytest.approx(20.0, rel=0.05)
    assert stiffness.max() > 3 / compliance
    assert np.all(stiffness[frequency < 10] < 1 / compliance)
