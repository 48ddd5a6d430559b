"""Side branches of a line: Helmholtz resonator, accumulator on a neck, plugged T-pipe.

Impedances and admittances are complex functions of frequency, e^(+i omega t), flow positive
into the branch. Of a plugged branch: at odd quarter waves its mouth takes flow without pressure
(the junction is held, only the plugged end swings), at even ones it takes no flow. A junction
is amplified above an odd quarter wave, where the branch reacts as an inertance and meets the
compliance beside it.
"""

from __future__ import annotations

import math

from ..geometry import geometry
from ..numeric import Array, namespace, sqrt, where
from .transmission_line import input_impedance, line_matrix


def branch_impedance(
    *, frequency: Array, inertance: Array, capacitance: Array, resistance: Array = 0.0
) -> Array:
    """Impedance of a neck before a volume, R + i omega L + 1/(i omega C).

    A Helmholtz resonator (C = V/K) or an accumulator (C of its gas): resonance at
    `elements.resonance_frequency`, where only R is left.

    Parameters
    ----------
    frequency : [Hz], not 0
    inertance : of the neck [kg/m^4]
    capacitance : of the volume [m^3/Pa], > 0
    resistance : of the neck [Pa s/m^3]

    Returns
    -------
    complex impedance [Pa s/m^3]; NaN where frequency or capacitance is 0

    Notes
    -----
    Valid: wavelength much longer than neck and volume.

    References
    ----------
    [AaltoThesis] section 2.1.3; [derived] lumped elements in series

    Examples
    --------
    >>> z = branch_impedance(frequency=100.0, inertance=5e6, capacitance=7e-14)
    >>> print(f"{z.imag:.3e}")
    -1.959e+10
    """
    omega = _omega(frequency, inertance, capacitance, resistance)
    swelling = omega * capacitance
    reactance = omega * inertance - 1 / where(swelling != 0, swelling, math.nan)
    return resistance + 1j * reactance


@geometry
def helmholtz_frequency(
    *, neck_diameter: Array, neck_length: Array, volume: Array, sound_speed: Array
) -> Array:
    """Resonance of a Helmholtz resonator, f = a/(2 pi) sqrt(A/(l V)).

    Parameters
    ----------
    neck_diameter : [m]
    neck_length : effective, ends included [m]
    volume : of the cavity [m^3]
    sound_speed : in the oil [m/s]

    Returns
    -------
    frequency [Hz]

    Notes
    -----
    Valid: wavelength much longer than neck and cavity; neck volume much below the cavity's.

    References
    ----------
    [AaltoThesis] section 2.1.3; [derived] inertance of the neck on the volume's capacitance

    Examples
    --------
    >>> f = helmholtz_frequency(neck_diameter=8e-3, neck_length=0.3, volume=1e-4,
    ...                         sound_speed=1272.2)
    >>> print(f"{f:.2f}")
    262.09
    """
    area = (0.25 * math.pi) * neck_diameter * neck_diameter
    return (0.5 / math.pi) * sound_speed * sqrt(area / (neck_length * volume))


def quarter_wave_length(
    *, frequency: Array, sound_speed: Array, quarter_waves: Array = 1.0
) -> Array:
    """Length of a plugged branch of n quarter waves, l = n a/(4 f).

    Parameters
    ----------
    frequency : [Hz]
    sound_speed : wave speed in the branch [m/s]
    quarter_waves : n = 1, 3, ... resonant, 2, 4, ... without effect on the junction [-]

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: low friction.

    References
    ----------
    [AaltoThesis] eq. 17, 18

    Examples
    --------
    >>> quarter_wave_length(frequency=20.0, sound_speed=1300.0)
    16.25
    """
    return 0.25 * quarter_waves * sound_speed / frequency


@geometry
def plugged_branch_impedance(
    *,
    frequency: Array,
    length: Array,
    inner_diameter: Array,
    density: Array,
    sound_speed: Array,
    dynamic_viscosity: Array,
    friction: str = "distributed",
) -> Array:
    """Impedance at the mouth of a plugged T-pipe, Z_c coth Gamma; -i Z_c cot(omega l/a) lossless.

    Small at odd quarter waves, large at even ones.

    Parameters
    ----------
    frequency : [Hz], not 0
    length, inner_diameter : [m]
    density : [kg/m^3]
    sound_speed : wave speed in the branch [m/s]
    dynamic_viscosity : [Pa s]
    friction : `lossless`, `steady` or `distributed` [-]

    Returns
    -------
    complex impedance [Pa s/m^3]; infinite at zero frequency

    Notes
    -----
    Valid: as `line_friction.series_impedance`.

    References
    ----------
    [AaltoThesis] section 2.1.3; [derived] `transmission_line.input_impedance` of a closed end

    Examples
    --------
    >>> pipe = dict(length=16.25, inner_diameter=8e-3, density=865.0, sound_speed=1300.0,
    ...             dynamic_viscosity=0.0, friction="lossless")
    >>> print(f"{abs(plugged_branch_impedance(frequency=10.0, **pipe)):.4e}")
    2.2371e+10
    """
    matrix = line_matrix(
        frequency=frequency,
        length=length,
        inner_diameter=inner_diameter,
        density=density,
        sound_speed=sound_speed,
        dynamic_viscosity=dynamic_viscosity,
        friction=friction,
    )
    return input_impedance(matrix=matrix, end_impedance=math.inf)


@geometry
def plugged_end_pressure_ratio(
    *,
    frequency: Array,
    length: Array,
    inner_diameter: Array,
    density: Array,
    sound_speed: Array,
    dynamic_viscosity: Array,
    friction: str = "distributed",
) -> Array:
    """Pressure at the plugged end over that at the mouth, 1/cosh Gamma.

    Amplified at odd quarter waves, the same amplitude at even ones.

    Parameters
    ----------
    frequency : [Hz]
    length, inner_diameter : [m]
    density : [kg/m^3]
    sound_speed : wave speed in the branch [m/s]
    dynamic_viscosity : [Pa s]
    friction : `lossless`, `steady` or `distributed` [-]

    Returns
    -------
    complex pressure ratio [-]

    Notes
    -----
    Valid: as `line_friction.series_impedance`.

    References
    ----------
    [AaltoThesis] eq. 17, 18; [derived] no flow at the far end of the line's matrix

    Examples
    --------
    >>> pipe = dict(length=16.25, inner_diameter=8e-3, density=865.0, sound_speed=1300.0,
    ...             dynamic_viscosity=0.0, friction="lossless")
    >>> print(f"{plugged_end_pressure_ratio(frequency=40.0, **pipe).real:.3f}")
    -1.000
    """
    matrix = line_matrix(
        frequency=frequency,
        length=length,
        inner_diameter=inner_diameter,
        density=density,
        sound_speed=sound_speed,
        dynamic_viscosity=dynamic_viscosity,
        friction=friction,
    )
    return 1 / matrix.A


def junction_pressure_ratio(*, admittance: Array, branch_impedance: Array) -> Array:
    """Pressure at a junction with a branch over that without, 1/(1 + 1/(Y Z_b)).

    A flow into the junction meets the admittance Y of all that was there before.

    Parameters
    ----------
    admittance : Y of the junction without the branch [m^3/s/Pa]
    branch_impedance : Z_b at the branch's mouth [Pa s/m^3]; infinite for none

    Returns
    -------
    complex pressure ratio [-]: below 1 attenuated, above 1 amplified

    Notes
    -----
    Valid: the same flow amplitude with and without the branch.

    References
    ----------
    [derived] continuity of flow at the junction

    Examples
    --------
    >>> ratio = junction_pressure_ratio(admittance=1e-12j, branch_impedance=4e12j)
    >>> print(f"{ratio.real:.3f}")
    1.333
    """
    xp = namespace(admittance, branch_impedance)
    there = xp.isfinite(branch_impedance)
    product = where(there, admittance * where(there, branch_impedance, 1.0), 1.0)
    vanishes = there & (1 + product == 0)
    ratio = product / where(vanishes, 1.0, where(there, 1 + product, 1.0))
    return where(vanishes, math.inf, ratio)


def _omega(frequency: Array, *others: Array) -> Array:
    """Angular frequency as a complex number, so that 1j may multiply it in any namespace."""
    xp = namespace(frequency, *others)
    return 2 * math.pi * xp.asarray(frequency, dtype=xp.complex128)
