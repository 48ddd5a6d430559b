"""Claims about the supply of a duty cycle: worked numbers, closed forms, simulated gas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import accumulator, supply_sizing

TIME = [0.0, 0.2, 0.5, 0.7, 1.0]
FLOW = [1e-5, 6e-5, 3e-5, 0.5e-5, 1e-5]
PRESSURES = {"low_pressure": 190e5, "high_pressure": 210e5, "precharge_pressure": 171e5}
SIX_DIGITS = 5e-6
flows = st.lists(st.floats(0.0, 1e-4), min_size=3, max_size=12)


def test_worked_example():
    """Ripple volume with its samples, and gas volume."""
    ripple = supply_sizing.ripple_volume(time=TIME, flow=FLOW)
    assert ripple.volume == pytest.approx(7.375e-6, rel=SIX_DIGITS)
    assert (ripple.largest, ripple.smallest) == (2, 0)
    gas = accumulator.gas_volume_needed(oil_volume=ripple.volume, **PRESSURES)
    assert gas == pytest.approx(1.22726e-4, rel=SIX_DIGITS)


def test_worked_tank():
    """Heat and temperature of the tank, and back to the cooler."""
    heat = supply_sizing.oil_heat(hydraulic_power=1043.0, pump_efficiency=0.85, net_work_rate=-8.3)
    assert heat == pytest.approx(1235.36, rel=SIX_DIGITS)
    tank = supply_sizing.tank_temperature(
        heat=heat, cooler_conductance=30.0, ambient_temperature=293.15
    )
    assert tank - 273.15 == pytest.approx(61.1786, rel=SIX_DIGITS)
    assert supply_sizing.cooler_conductance_needed(
        heat=heat, temperature=tank, ambient_temperature=293.15
    ) == pytest.approx(30.0)


def test_energy_from_battery_to_heat():
    """Electric power less motor losses less work to the load is the heat of the oil."""
    power = supply_sizing.electric_power(
        hydraulic_power=1043.0, pump_efficiency=0.85, motor_efficiency=0.9
    )
    heat = supply_sizing.oil_heat(hydraulic_power=1043.0, pump_efficiency=0.85, net_work_rate=50.0)
    assert power * 0.9 - 50.0 == pytest.approx(heat)


def test_impossible_numbers_are_nan():
    """No efficiency, no cooler, a cold tank, equal pressures."""
    assert np.isnan(supply_sizing.electric_power(
        hydraulic_power=1.0, pump_efficiency=0.0, motor_efficiency=0.9
    ))  # fmt: skip
    assert np.isnan(supply_sizing.tank_temperature(
        heat=1.0, cooler_conductance=0.0, ambient_temperature=293.0
    ))  # fmt: skip
    assert np.isnan(supply_sizing.cooler_conductance_needed(
        heat=1.0, temperature=290.0, ambient_temperature=293.0
    ))  # fmt: skip
    assert np.isnan(accumulator.gas_volume_needed(
        oil_volume=1e-6, low_pressure=2e7, high_pressure=2e7, precharge_pressure=1e7
    ))  # fmt: skip


def test_ripple_of_a_sine():
    """A flow q (1 + sin wt) needs q T/pi."""
    period, level = 1.7, 3e-5
    t = np.linspace(0.0, period, 401)
    flow = level * (1 + np.sin(2 * np.pi * t / period))
    ripple = supply_sizing.ripple_volume(time=t, flow=flow)
    assert ripple.volume == pytest.approx(level * period / np.pi, rel=1e-4)
    assert t[[ripple.largest, ripple.smallest]] == pytest.approx([period / 2, 0.0])


@pytest.mark.parametrize("samples", [20, 50])
def test_coarse_samples_leave_out_little(samples):
    """At the worst phase of a sine the volume is too small by 8/n^2, and never too large."""
    t = np.linspace(0.0, 1.0, samples + 1)
    shares = [
        np.pi * supply_sizing.ripple_volume(time=t, flow=np.sin(2 * np.pi * (t + late))).volume
        for late in np.linspace(0.0, 1 / samples, 21)
    ]
    assert 1 - min(shares) == pytest.approx(8 / samples**2, rel=0.05)
    assert max(shares) < 1


@given(flows, st.data())
def test_ripple_does_not_depend_on_the_beginning(flow, data):
    """A closed cycle that begins at another sample needs the same accumulator."""
    shift = data.draw(st.integers(0, len(flow) - 1))
    t = np.arange(len(flow) + 1) / len(flow)
    rotated = [*flow[shift:], *flow[:shift]]
    found = [
        supply_sizing.ripple_volume(time=t, flow=[*samples, samples[0]]).volume
        for samples in (flow, rotated)
    ]
    assert found[1] == pytest.approx(found[0], rel=1e-9, abs=1e-18)


def test_slopes_of_the_ripple():
    """Complex steps against central differences."""

    def volume(flow):
        return supply_sizing.ripple_volume(time=np.array(TIME), flow=flow).volume

    base = np.array(FLOW)[:, None]
    slopes = np.imag(volume(base + 1e-30j * np.eye(5))) / 1e-30
    step = 1e-8 * np.eye(5)
    differences = (volume(base + step) - volume(base - step)) / 2e-8
    np.testing.assert_allclose(slopes, differences, atol=1e-8)


def test_simulated_accumulator_keeps_its_pressures():
    """With pump and gas volume so sized the pressure falls from the high to the low limit."""
    t = np.linspace(0.0, 1.0, 201)
    flow = 4e-5 * np.maximum(0.0, np.sin(2 * np.pi * t)) + 1e-5 * np.sin(np.pi * t) ** 2
    ripple = supply_sizing.ripple_volume(time=t, flow=flow)
    mean = np.trapezoid(flow, t)
    gas = {"precharge_pressure": 171e5}
    shell = accumulator.gas_volume_needed(oil_volume=ripple.volume, **PRESSURES)
    volume = accumulator.gas_volume_at(pressure=210e5, gas_volume=shell, **gas)
    pressures, filled = [], volume
    for k in range(2 * 200):  # from the fullest state, two periods
        i = (ripple.smallest + k) % 200
        pressures.append((210e5 + 101325.0) * (filled / volume) ** 1.4 - 101325.0)
        volume += ((flow[i] + flow[i + 1]) / 2 - mean) * (t[i + 1] - t[i])
    assert max(pressures) == pytest.approx(210e5, rel=1e-6)
    assert min(pressures) == pytest.approx(190e5, rel=1e-6)


@given(
    st.floats(60e5, 180e5), st.floats(1.05, 3.0), st.floats(0.3, 0.95), st.floats(1.0, 1.6),
)  # fmt: skip
def test_gas_volume_inverts_the_usable_volume(low, ratio, precharge, index):
    """Also where the gas fills the shell before the low pressure is reached."""
    law = {
        "low_pressure": low, "high_pressure": ratio * low, "precharge_pressure": precharge * low,
        "polytropic_index": index,
    }  # fmt: skip
    shell = accumulator.gas_volume_needed(oil_volume=2e-5, **law)
    assert accumulator.usable_volume(gas_volume=shell, **law) == pytest.approx(2e-5, rel=1e-9)
    absolute = {name: law[name] + 101325.0 for name in list(law)[:3]}
    filled = absolute["precharge_pressure"] / absolute["high_pressure"]
    growth = (absolute["high_pressure"] / absolute["low_pressure"]) ** (1 / index)
    if filled * growth < 1:
        assert shell == pytest.approx(2e-5 / (filled * (growth - 1)), rel=1e-9)
    else:
        assert shell == pytest.approx(2e-5 / (1 - filled), rel=1e-9)


def test_system_mass_is_a_sum_or_nothing():
    """A part without specific mass is named, and there is no total."""
    sizes = {
        "gas_volume": 1.2e-4, "pump_power": 1043.0, "cooler_conductance": 30.0, "energy": 7.2e6,
    }  # fmt: skip
    specific = {
        "accumulator_density": 1500.0, "pump_specific_mass": 1e-3, "cooler_specific_mass": 0.03,
        "specific_energy": 0.6e6,
    }  # fmt: skip
    masses = supply_sizing.supply_masses(**sizes, **specific)
    assert masses == pytest.approx(
        {"accumulator": 0.18, "pump": 1.043, "cooler": 0.9, "source": 12.0}
    )
    whole = supply_sizing.system_mass(parts={"actuators": 0.7, **masses})
    assert whole.total == pytest.approx(0.7 + 0.18 + 1.043 + 0.9 + 12.0)
    assert whole.missing == ()
    for name, part in zip(specific, masses, strict=True):
        partial = supply_sizing.supply_masses(**sizes, **{**specific, name: None})
        found = supply_sizing.system_mass(parts={"actuators": 0.7, **partial})
        assert (found.total, found.missing) == (None, (part,))
