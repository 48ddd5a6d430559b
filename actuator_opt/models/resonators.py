"""Plugged side branch (T-pipe) of a line.

Impedances are complex functions of frequency, e^(+i omega t), flow positive into the branch. At
odd quarter waves the mouth takes flow without pressure (the junction is held, only the plugged
end swings), at even ones it takes no flow.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry
from .transmission_line import input_impedance, line_matrix


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
