"""Axial effects in the barrel: axial force, tie rods, growth beside a pressure step.

The barrel's axial force follows from how the cylinder is mounted, never from a fixed "open" or
"closed" end. At the piston seal, where the pressure steps, the wall grows by the far-field growth
times `pressure_step_factor`.
"""

from __future__ import annotations

from ..base.numeric import Array, absolute, geometry, namespace, positive, real, sqrt, where


@geometry
def pressure_shortening(
    *,
    pressure: Array,
    inner_radius: Array,
    outer_radius: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    length: Array,
) -> Array:
    """Free axial shortening of an open barrel by its internal pressure.

    delta_p = 2 nu p L/(E (k^2 - 1)), k = r_o/r_i: the Poisson contraction that unloads a tie-rod
    joint.

    Parameters
    ----------
    pressure : internal gauge pressure [Pa]
    inner_radius, outer_radius : radii of the wall [m]
    youngs_modulus : Young's modulus [Pa]
    poissons_ratio : Poisson's ratio [-]
    length : pressurised length [m]

    Returns
    -------
    shortening [m], positive; NaN where the wall has no thickness

    Notes
    -----
    Valid: linear elastic, no axial force.

    References
    ----------
    [derived] epsilon_z = -nu (sigma_r + sigma_theta)/E of Lamé's cylinder

    Examples
    --------
    >>> d = pressure_shortening(pressure=28e6, inner_radius=16e-3, outer_radius=20e-3,
    ...                         youngs_modulus=71.7e9, poissons_ratio=0.33, length=0.18)
    >>> print(f"{d * 1e6:.3f} um")
    82.477 um
    """
    inner, outer = inner_radius * inner_radius, outer_radius * outer_radius
    contraction = 2 * poissons_ratio * pressure * inner / positive(outer - inner)
    return contraction * length / youngs_modulus


@geometry
def shell_decay_length(*, radius: Array, hoop_stiffness: Array, bending_stiffness: Array) -> Array:
    """Axial length over which a shell's growth settles beside a pressure step.

    1/beta = (4 R^2 D_z/(E_theta t))^(1/4).

    Parameters
    ----------
    radius : mid-radius of the wall [m]
    hoop_stiffness : E_theta t at free axial force, from the laminate [N/m]
    bending_stiffness : axial bending stiffness D_z per circumference [N m]

    Returns
    -------
    decay length 1/beta [m]

    Notes
    -----
    Valid: thin shells, R/t above about 5; transverse shear neglected.

    References
    ----------
    [Timoshenko1959] axisymmetric bending of a circular cylindrical shell

    Examples
    --------
    >>> d = 71.7e9 * 1.5e-3**3 / (12 * (1 - 0.33**2))
    >>> x = shell_decay_length(radius=16.75e-3, hoop_stiffness=71.7e9 * 1.5e-3,
    ...                        bending_stiffness=d)
    >>> print(f"{x * 1e3:.5f} mm")
    3.92005 mm
    """
    return sqrt(sqrt(4 * radius * radius * bending_stiffness / hoop_stiffness))


@geometry
def pressure_step_factor(*, distance: Array, decay_length: Array) -> Array:
    """Share of the far-field growth at a distance from the pressure step at the piston seal.

    y >= 0 (pressurised side): 1 - exp(-beta y) cos(beta y)/2; y < 0: exp(beta y) cos(beta y)/2.

    Parameters
    ----------
    distance : y from the step, positive towards the pressure [m]
    decay_length : 1/beta [m]

    Returns
    -------
    w/w_inf [-]: one half at the step, overshoot at most 3.4 %

    Notes
    -----
    Valid: long thin shell, pressure on one side of the step only.

    References
    ----------
    [Timoshenko1959] shell under a band of pressure; [derived] by symmetry of the step

    Examples
    --------
    >>> print(f"{pressure_step_factor(distance=3e-3, decay_length=3.92005e-3):.6f}")
    0.832256
    """
    steps = absolute(distance) / decay_length
    xp = namespace(steps)
    half = xp.exp(-steps) * xp.cos(steps) / 2
    return where(real(distance) >= 0, 1 - half, half)


@geometry
def axial_force_cap_mounted(
    *, rod_side_pressure: Array, rod_side_area: Array, stop_force: Array = 0.0
) -> Array:
    """Axial force in the barrel wall of a cylinder held at its cap.

    N = p_B A_B + F_stop: the pressure force on the head, and the force of a piston at its stop.

    Parameters
    ----------
    rod_side_pressure : p_B, gauge [Pa]
    rod_side_area : A_B [m^2]
    stop_force : force of the piston on the head at its end stop [N]

    Returns
    -------
    tensile force [N]

    Notes
    -----
    Valid: seal friction on the wall neglected.

    References
    ----------
    [derived] free body of head and barrel

    Examples
    --------
    >>> print(round(axial_force_cap_mounted(rod_side_pressure=10e6, rod_side_area=3e-4), 6))
    3000.0
    """
    return rod_side_pressure * rod_side_area + stop_force


@geometry
def axial_force_head_mounted(*, cap_side_pressure: Array, cap_side_area: Array) -> Array:
    """Axial force in the barrel wall of a cylinder held at its head.

    N = p_A A_A: the pressure force on the cap.

    Parameters
    ----------
    cap_side_pressure : p_A, gauge [Pa]
    cap_side_area : A_A [m^2]

    Returns
    -------
    tensile force [N]

    Notes
    -----
    Valid: seal friction on the wall neglected, no load on the cap from outside.

    References
    ----------
    [derived] free body of cap and barrel

    Examples
    --------
    >>> print(round(axial_force_head_mounted(cap_side_pressure=10e6, cap_side_area=5e-4), 6))
    5000.0
    """
    return cap_side_pressure * cap_side_area


def tie_rod_forces(
    *,
    axial_force: Array,
    preload: Array,
    barrel_stiffness: Array,
    tie_rod_stiffness: Array,
    free_shortening: Array = 0.0,
) -> tuple[Array, Array]:
    """Share an axial force between a barrel and the tie rods that clamp it.

    N_b = -F_0 + N k_b/(k_b + k_t) + delta_p k_b k_t/(k_b + k_t), F_t = N - N_b.

    Parameters
    ----------
    axial_force : N, force that pulls the ends apart [N]
    preload : F_0, total tie-rod tension without pressure [N]
    barrel_stiffness, tie_rod_stiffness : axial stiffness of the barrel, and of all rods together
        [N/m]
    free_shortening : delta_p, free axial shortening of the barrel by pressure [m]

    Returns
    -------
    barrel force (tension positive) and total tie-rod force [N]; the joint opens where the barrel
    force is not negative

    Notes
    -----
    Valid: joint closed (barrel force negative). Once it opens, the rods alone carry N.

    References
    ----------
    [derived] two springs in parallel with preload

    Examples
    --------
    >>> barrel, rods = tie_rod_forces(axial_force=12e3, preload=9e3, barrel_stiffness=300e6,
    ...                               tie_rod_stiffness=90e6, free_shortening=3e-6)
    >>> print(f"{barrel:.1f} {rods:.1f}")
    438.5 11561.5
    """
    share = barrel_stiffness / (barrel_stiffness + tie_rod_stiffness)
    barrel = share * (axial_force + free_shortening * tie_rod_stiffness) - preload
    return barrel, axial_force - barrel


@geometry
def preload_change(
    *,
    temperature_change: Array,
    barrel_expansion: Array,
    barrel_length: Array,
    plate_expansion: Array,
    plate_thickness: Array,
    tie_rod_expansion: Array,
    tie_rod_length: Array,
    barrel_stiffness: Array,
    tie_rod_stiffness: Array,
) -> Array:
    """Change of the tie rods' preload by temperature.

    Delta F_0 = Delta T (alpha_b L_b + 2 alpha_p t_p - alpha_r L_r) k_b k_r/(k_b + k_r). A barrel
    that expands less than the rods, such as one of carbon, loses preload when it warms up.

    Parameters
    ----------
    temperature_change : Delta T since assembly [K]
    barrel_expansion : alpha_b, axial thermal expansion of the barrel [1/K]
    barrel_length : L_b [m]
    plate_expansion : alpha_p, thermal expansion of both end plates [1/K]
    plate_thickness : t_p of one plate [m]
    tie_rod_expansion : alpha_r, thermal expansion of the rods [1/K]
    tie_rod_length : L_r, between the outer faces of the plates [m]
    barrel_stiffness, tie_rod_stiffness : k_b and k_r, axial stiffness of the barrel, and of all
        rods together [N/m]

    Returns
    -------
    change of the total preload [N], positive where the clamping force grows

    Notes
    -----
    Valid: the same temperature in every part, rigid plates, linear elastic, joint closed.

    References
    ----------
    [derived] two springs whose free lengths change

    Examples
    --------
    >>> change = preload_change(temperature_change=40.0, barrel_expansion=20e-6,
    ...     barrel_length=126e-3, plate_expansion=23.6e-6, plate_thickness=7e-3,
    ...     tie_rod_expansion=11.5e-6, tie_rod_length=140e-3, barrel_stiffness=39.6825e6,
    ...     tie_rod_stiffness=115.566e6)
    >>> print(f"{change:.1f} N")
    1465.6 N
    """
    grown = barrel_expansion * barrel_length + 2 * plate_expansion * plate_thickness
    gap = temperature_change * (grown - tie_rod_expansion * tie_rod_length)
    return gap / (1 / barrel_stiffness + 1 / tie_rod_stiffness)
