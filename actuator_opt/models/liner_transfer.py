"""Shear between a metal liner and the winding on it, near an end where the liner carries the force.

The liner takes the whole axial force at its end. Shear at the interface passes a share on to the
winding, within a few millimetres. Expansion differences cause the same kind of shear.
"""

from __future__ import annotations

from ..base.numeric import Array, geometry, sqrt


@geometry
def interface_stiffness(
    *,
    liner_thickness: Array,
    liner_shear_modulus: Array,
    winding_thickness: Array,
    winding_shear_modulus: Array,
) -> Array:
    """Shear stress per slip of the mid-surfaces, k = 1/(t_w/(3 G_w) + t_l/(3 G_l)).

    Parameters
    ----------
    liner_thickness, winding_thickness : t_l, t_w [m]
    liner_shear_modulus, winding_shear_modulus : G_l, G_w, in the plane of axis and radius [Pa]

    Returns
    -------
    stiffness [Pa/m]

    Notes
    -----
    Valid: plies cured onto the liner.

    A layer of resin between them is not counted; it would lower the shear.

    References
    ----------
    [derived] shear that falls linearly to zero at the free face of each wall

    Examples
    --------
    >>> k = interface_stiffness(liner_thickness=1.5e-3, liner_shear_modulus=27e9,
    ...                         winding_thickness=2.5e-3, winding_shear_modulus=4.3e9)
    >>> print(f"{k / 1e9:.2f}")
    4709.94
    """
    return 3 / (winding_thickness / winding_shear_modulus + liner_thickness / liner_shear_modulus)


@geometry
def edge_shear(
    *,
    line_force: Array,
    strain_difference: Array,
    interface_stiffness: Array,
    liner_stiffness: Array,
    winding_stiffness: Array,
) -> Array:
    """Shear stress at the end of the winding, tau_0 = (k/lambda) (N/K_l + e_l - e_w).

    lambda^2 = k (1/K_l + 1/K_w). The shear falls as exp(-lambda x); the winding takes the share
    K_w/(K_w + K_l) of the force.

    Parameters
    ----------
    line_force : axial force of the liner per circumference, N [N/m]
    strain_difference : free strain of the liner minus that of the winding, e_l - e_w [-]
    interface_stiffness : k [Pa/m]
    liner_stiffness, winding_stiffness : axial E t of both walls, K_l and K_w [N/m]

    Returns
    -------
    shear stress [Pa]

    Notes
    -----
    Valid: elastic; a winding longer than 6/lambda.

    A winding that tapers to its end over at least 3/lambda has no such peak.

    References
    ----------
    [Volkersen1938] shear lag of two bars; [derived] long overlap

    Examples
    --------
    >>> tau = edge_shear(line_force=96468.8, strain_difference=0.0, interface_stiffness=3937.26e9,
    ...                  liner_stiffness=107.55e6, winding_stiffness=21.5e6)
    >>> print(f"{tau / 1e6:.5f}")
    7.53388
    """
    strain = line_force / liner_stiffness + strain_difference
    return strain * sqrt(interface_stiffness / (1 / liner_stiffness + 1 / winding_stiffness))


@geometry
def fading_length(
    *, interface_stiffness: Array, liner_stiffness: Array, winding_stiffness: Array
) -> Array:
    """Overlap of liner and winding over which the shear of both edges fades, L = 6/lambda.

    Parameters
    ----------
    interface_stiffness : k [Pa/m]
    liner_stiffness, winding_stiffness : axial E t of both walls, K_l and K_w [N/m]

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: as `edge_shear`.

    Each edge passes 95 % of its load within ln(20)/lambda, which is 3/lambda.

    References
    ----------
    [Volkersen1938] shear lag of two bars; [derived] decay

    Examples
    --------
    >>> length = fading_length(interface_stiffness=3937.26e9, liner_stiffness=107.55e6,
    ...                        winding_stiffness=21.5e6)
    >>> print(f"{1e3 * length:.4f}")
    12.7997
    """
    return 6 / sqrt(interface_stiffness * (1 / liner_stiffness + 1 / winding_stiffness))
