"""Response of the exact layered tube to loads: strains and stresses at every face.

Hoop strain and radial stress are carried through the layers of `tube_elements` once for each
unknown (bore strain, axial strain, twist) and once for the loads. The conditions on outer pressure,
axial force and torque then give 2 or 3 equations for the unknowns. Stresses are given at both faces
of each layer; for a point inside a layer, split the layer there: identical sublayers act as one
layer.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

from ..base.dataclass import dataclass
from ..base.numeric import Array, lifted, namespace, together
from .solid_ply import solid_ply_stresses
from .tube_elements import LayeredTube, TubeLayer, layered_tube

__all__ = [
    "LayeredTube",
    "TubeLayer",
    "TubeState",
    "layered_tube",
    "ply_stresses_at_faces",
    "tube_state",
    "tube_stresses",
]


@dataclass(frozen=True, slots=True)
class TubeState:
    """Strains and radial stress of a loaded tube.

    Parameters
    ----------
    bore_displacement : radial growth of the bore [m]
    axial_strain : of the tube [-]
    twist : gamma_0, angle per length [rad/m]
    radius : of both faces of each layer, (2, layers, ...) [m]
    hoop_strain, radial_strain, shear_strain : at those faces [-]
    radial_stress : at those faces [Pa]
    held : thermal and frozen stresses z, t, r, s [Pa] (`tube_state` explains "frozen"; s is shear).
        They are subtracted from the stresses that the strains cause; None if there are none
    temperature_change : from the stress-free state [K]
    """

    bore_displacement: Array
    axial_strain: Array
    twist: Array
    radius: Array
    hoop_strain: Array
    radial_strain: Array
    shear_strain: Array
    radial_stress: Array
    held: tuple[Array, ...] | None
    temperature_change: Array


@dataclass(frozen=True, slots=True)
class Faces:
    """Hoop strain and radial stress at both faces of every layer, (2, layers, ...), from `closed`.

    `axial_strain` and `twist` belong to the whole tube.
    """

    hoop_strain: Array
    radial_stress: Array
    axial_strain: Array
    twist: Array


def closed(
    xp: Any,
    transfer: Array,
    driven: Array | None,
    *,
    inner_pressure: Array,
    outer_pressure: Array,
    axial_force: Array,
    torque: Array,
) -> Faces:
    """Solve for bore strain, axial strain and twist by a march through all layers.

    The march goes outwards and carries these columns together: unit bore hoop strain, unit axial
    strain, (unit twist,) and the loads. `transfer` is that of a `LayeredTube`; `driven`, with axes
    (outputs of `transfer`, layers, ...), is from `forcing`, or None. All arrays have the same
    number of batch axes.

    References
    ----------
    [Lekhnitskii1963] generalised plane strain; [derived] transfer of displacement and stress
    """
    outputs, count, dims = transfer.shape[1], transfer.shape[2], transfer.ndim - 3
    ones = (1,) * dims
    columns = outputs  # one per unknown (outputs less the outer hoop strain), and the loads
    unit = [
        xp.reshape(xp.asarray([float(i == k) for i in range(columns)]), (columns, *ones))
        for k in range(columns)
    ]
    last = unit[-1]
    hoop, radial = unit[0], -inner_pressure * last
    rows, total = [], 0.0
    for i in range(count):
        t = transfer[:, :, i, ...][:, :, None, ...]
        out = t[0, ...] * hoop + t[1, ...] * radial + t[2, ...] * unit[1]
        if outputs == 4:
            out = out + t[4, ...] * unit[2]
        if driven is not None:
            out = out + driven[:, None, i, ...] * last
        hoop, radial = out[0, ...], out[1, ...]
        rows.append(out[:2, ...])
        total = total + out[2:, ...]
    amounts = _unknowns(rows[-1][1, ...], total, outer_pressure, axial_force, torque)
    weights = together([*amounts, 0 * amounts[0] + 1])
    states = xp.sum(xp.stack(rows, axis=2) * weights[:, None, ...], axis=1)
    first = together([amounts[0], 0 * amounts[0] - inner_pressure])
    inner = xp.concat([first[:, None, ...], states[:, :-1, ...]], axis=1)
    faces = together([inner, states])
    twist = amounts[2] if outputs == 4 else 0.0
    return Faces(faces[:, 0, ...], faces[:, 1, ...], amounts[1], twist)


def _unknowns(
    face: Array, total: Array, outer_pressure: Array, force: Array, torque: Array
) -> tuple[Array, ...]:
    """Bore hoop strain, axial strain (and twist) from outer pressure, axial force (and torque)."""
    s_e, s_z, n_e, n_z = face[0, ...], face[1, ...], total[0, 0, ...], total[0, 1, ...]
    press, pull = -outer_pressure - face[-1, ...], force / (2 * pi) - total[0, -1, ...]
    if total.shape[0] == 1:
        inverse = 1 / (s_e * n_z - s_z * n_e)
        return (press * n_z - pull * s_z) * inverse, (s_e * pull - n_e * press) * inverse
    s_w, n_w = face[2, ...], total[0, 2, ...]
    t_e, t_z, t_w = total[1, 0, ...], total[1, 1, ...], total[1, 2, ...]
    turn = torque / (2 * pi) - total[1, -1, ...]
    minor_e, minor_z, minor_w = n_z * t_w - n_w * t_z, n_w * t_e - n_e * t_w, n_e * t_z - n_z * t_e
    inverse = 1 / (s_e * minor_e + s_z * minor_z + s_w * minor_w)
    pull_w, pull_z = pull * t_w - turn * n_w, pull * t_z - turn * n_z
    pull_e = pull * t_e - turn * n_e
    return (
        (press * minor_e - s_z * pull_w + s_w * pull_z) * inverse,
        (s_e * pull_w + press * minor_z - s_w * pull_e) * inverse,
        (s_z * pull_e - s_e * pull_z + press * minor_w) * inverse,
    )


def forcing(xp: Any, transfer: Array, inner: Array, outer: Array, held: tuple[Array, ...]) -> Array:
    """Effect of thermal and frozen stresses on the outputs of `LayeredTube.transfer`, per layer.

    `held` contains these stresses: z, t, r (and s). Frozen stresses are those that yielded metal
    keeps at zero strain.

    References
    ----------
    [derived] radial equilibrium of a layer under stresses frozen in it
    """
    square_a, square_b = inner * inner, outer * outer
    own = [0 * held[2], held[2], held[0] * ((square_b - square_a) / 2)]
    if transfer.shape[1] == 4:
        own.append(held[3] * ((square_b * outer - square_a * inner) / 3))
    driven = transfer[1, ...] * held[2] + transfer[3, ...] * (held[2] - held[1])
    return driven - together(own)


def tube_state(
    *,
    tube: LayeredTube,
    inner_pressure: Array = 0.0,
    outer_pressure: Array = 0.0,
    axial_force: Array = 0.0,
    torque: Array = 0.0,
    temperature_change: Array = 0.0,
    frozen: tuple[Array, Array, Array] | None = None,
) -> TubeState:
    """Strains and radial stress of a layered tube under any axisymmetric load.

    u and sigma_r continuous; sigma_r = -p_i, -p_o at the faces; 2 pi int sigma_z r dr = N;
    2 pi int tau_zt r^2 dr = T.

    Parameters
    ----------
    tube : from `layered_tube`
    inner_pressure, outer_pressure : gauge pressures inside and outside [Pa]
    axial_force : N in the wall, tension positive [N]; closed ends have p_i pi r_i^2
    torque : T [N m]
    temperature_change : uniform, from the stress-free state [K]
    frozen : stresses z, t, r of each layer at zero strain (yielded metal), (layers, ...) [Pa]

    Returns
    -------
    the state (see `TubeState` for units, [m], [Pa], [-]); arrays of loads may have
    additional axes in front of the batch axes

    Notes
    -----
    Valid: linear elastic, perfect bond, far from the ends; any wall ratio.

    References
    ----------
    [Lekhnitskii1963] generalised plane strain; [derived] closed integrals, see `tube_elements`

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=4e-3)],
    ...                     inner_radius=16e-3)
    >>> print(f"{tube_state(tube=tube, inner_pressure=28e6).bore_displacement * 1e6:.2f} um")
    10.36 um
    """
    loads = (inner_pressure, outer_pressure, axial_force, torque, temperature_change)
    sizes = [getattr(load, "ndim", 0) for load in loads]
    dims = max(tube.inner.ndim - 1, *sizes, 0 if frozen is None else frozen[0].ndim - 1)
    tube = tube.lifted(dims)
    held = _held(tube, temperature_change, frozen)
    xp = namespace(tube.inner)
    faces = closed(
        xp,
        tube.transfer,
        None if held is None else forcing(xp, tube.transfer, tube.inner, tube.outer, held),
        inner_pressure=inner_pressure,
        outer_pressure=outer_pressure,
        axial_force=axial_force,
        torque=torque,
    )
    if not tube.twisting:
        faces = replace(faces, twist=torque / (2 * pi * _polar(xp, tube)))
    return _state(xp, tube, held, faces, temperature_change)


def _polar(xp: Any, tube: LayeredTube) -> Array:
    """Torsional stiffness divided by 2 pi, if no layer couples twist with tension."""
    square_a, square_b = tube.inner * tube.inner, tube.outer * tube.outer
    return xp.sum(tube.wall[9] * (square_b * square_b - square_a * square_a) / 4, axis=0)


def _held(
    tube: LayeredTube, change: Array, frozen: tuple[Array, Array, Array] | None
) -> tuple[Array, ...] | None:
    """Thermal and frozen stresses z, t, r, s; None if there are none."""
    still = tube.hold is None or (isinstance(change, (float, int)) and change == 0.0)
    if still and frozen is None:
        return None
    zero = 0 * tube.inner
    held = [zero] * 4
    if tube.hold is not None and not still:
        held = [value * change for value in tube.hold]
    if frozen is not None:
        dims = tube.inner.ndim - 1
        held[:3] = [a - lifted(b, dims) for a, b in zip(held[:3], frozen, strict=True)]
    return tuple(held)


def _state(
    xp: Any, tube: LayeredTube, held: tuple[Array, ...] | None, faces: Faces, change: Array
) -> TubeState:
    """Collect the state of the tube from the solved unknowns, and add the radial strains."""
    radius = together([tube.inner, tube.outer])
    shear = radius * faces.twist
    _, _, zr, _, tr, rr, _, _, rs, _ = tube.wall
    strain = faces.radial_stress - zr * faces.axial_strain - tr * faces.hoop_strain
    if tube.twisting:
        strain = strain - rs * shear
    if held is not None:
        strain = strain + held[2]
    return TubeState(
        bore_displacement=faces.hoop_strain[0, 0, ...] * tube.inner[0, ...],
        axial_strain=faces.axial_strain,
        twist=faces.twist,
        radius=radius,
        hoop_strain=faces.hoop_strain,
        radial_strain=strain / rr,
        shear_strain=shear,
        radial_stress=faces.radial_stress,
        held=held,
        temperature_change=change,
    )


def tube_stresses(*, tube: LayeredTube, state: TubeState) -> tuple[Array, Array, Array, Array]:
    """Stresses of every layer in tube axes, at both faces of the layer.

    sigma_i = C_ij eps_j - K_i dT, with the thermal stress K_i per kelvin; for a balanced pair, the
    result is the mean of both plies.

    Parameters
    ----------
    tube : from `layered_tube`
    state : from `tube_state`

    Returns
    -------
    sigma_z, sigma_t, sigma_r, tau_zt, each (2, layers, ...) [Pa]

    Notes
    -----
    Valid: as `tube_state`.

    References
    ----------
    [derived] Hooke's law of the layer

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=4e-3)],
    ...                     inner_radius=16e-3)
    >>> _, hoop, _, _ = tube_stresses(tube=tube, state=tube_state(tube=tube, inner_pressure=28e6))
    >>> print(f"{hoop[0, 0] / 1e6:.3f} {hoop[1, 0] / 1e6:.3f}")
    127.556 99.556
    """
    tube = tube.lifted(state.radius.ndim - 2)
    zz, zt, zr, tt, tr, _, zs, ts, rs, ss = tube.wall
    hoop, radial, shear = state.hoop_strain, state.radial_strain, state.shear_strain
    axial = zz * state.axial_strain + zt * hoop + zr * radial
    around = zt * state.axial_strain + tt * hoop + tr * radial
    slip = ss * shear
    if tube.twisting:
        axial, around = axial + zs * shear, around + ts * shear
        slip = slip + zs * state.axial_strain + ts * hoop + rs * radial
    if state.held is not None:
        held = state.held
        axial, around, slip = axial - held[0], around - held[1], slip - held[3]
    return axial, around, state.radial_stress, slip


def ply_stresses_at_faces(
    *, tube: LayeredTube, state: TubeState, opposite: bool = False
) -> tuple[Array, Array, Array, Array]:
    """Stresses of every ply in its own axes, at both faces of its layer.

    The stress is the ply's stiffness times the strains of the wall minus the free strains of the
    ply. Without torque, the two plies of a pair differ only in the sign of their shear stress.

    Parameters
    ----------
    tube : from `layered_tube`
    state : from `tube_state`
    opposite : True for the -angle ply of each pair (no change for a single ply)

    Returns
    -------
    sigma_1, sigma_2, sigma_3, tau_12, each (2, layers, ...) [Pa]

    Notes
    -----
    Valid: as `tube_state`; frozen stresses of yielded metals are in `tube_stresses` only.

    References
    ----------
    [derived] Hooke's law of the ply

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=4e-3)],
    ...                     inner_radius=16e-3)
    >>> state = tube_state(tube=tube, inner_pressure=28e6)
    >>> print(f"{ply_stresses_at_faces(tube=tube, state=state)[1][0, 0] / 1e6:.3f}")
    127.556
    """
    tube = tube.lifted(state.radius.ndim - 2)
    first, second, third = tube.free
    change = state.temperature_change
    return solid_ply_stresses(
        stiffness=tube.ply,
        angle=tube.angle * (1 - 2 * tube.balanced) if opposite else tube.angle,
        axial_strain=state.axial_strain,
        hoop_strain=state.hoop_strain,
        radial_strain=state.radial_strain,
        shear_strain=state.shear_strain,
        free_strain_1=first * change,
        free_strain_2=second * change,
        free_strain_3=third * change,
    )
