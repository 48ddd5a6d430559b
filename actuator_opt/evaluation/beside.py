"""First-ply failure of the barrel beside a joint, where the wall bends.

Beside a skirt, the stiffness of the wall changes. The change of the plies' strains there, from the
wall as a shell, is added to the stresses of the exact wall, with cure stresses and the criterion
of the design. Beside a plug's groove or thread, only shear through the thickness is checked: the
liner carries the axial force there.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from math import pi

import numpy as np

from ..base.numeric import Array, minimum
from ..joints.joint import EndDimensions, Loaded
from ..joints.overlap import EdgeBeside, edge_beside
from ..models import end_bending, ply
from ..models.strength_modes import Stress, load_multiplier
from .barrel import laminate
from .barrel.wall import Plies, Wall
from .geometry import EndJoint
from .plies import Layer, stress_of

SKIRT, GROOVE = "beside the skirt", "beside the plug's groove"
"""Ends of the names of locations. A plug's thread counts as a groove."""

INTERLAMINAR = "interlaminar shear"
"""Start of the names of locations of shear through the thickness."""


def first_ply(
    end_joint: EndJoint, loaded: Loaded, fit: EndDimensions, wall: Wall, supply: Array
) -> dict[str, Array]:
    """Pressures at which the first ply fails beside a joint, by layer.

    The result is empty for a wall without plies of known strength or with unbalanced plies, for
    caps that are plates, and if an elastic constant is unknown.
    """
    plies, form = wall.plies, end_joint.joint.form
    if plies is None or not loaded.shells or not all(ply.balanced for ply in plies.layers):
        return {}
    pressures: dict[str, Array] = {}
    if form == "skirts" and (beside := edge_beside(loaded)) is not None:
        rows = laminate.first_ply_changed(plies, _change(plies, beside, supply))
        pressures = {f"{name}, {SKIRT}": pressure for name, pressure in rows}
        shell, force, place = beside.wall, beside.edge.force, SKIRT
    elif form == "plugs" and fit.groove:
        shell, force = _groove(loaded, fit)
        place = GROOVE
    else:
        return {}
    shears = end_bending.interlaminar_shear(layers=loaded.shells, wall=shell, force=force)
    for i in plies.rows:
        layer = plies.layers[i]
        known = [
            strength
            for climate in layer.strengths
            for strength in (climate.shear_12, climate.shear_23)
            if strength is not None
        ]
        pressure = supply * load_multiplier(shears[i] / reduce(minimum, known))
        pressures[f"{INTERLAMINAR} of {layer.label}, {place}"] = pressure
    return pressures


def _groove(loaded: Loaded, fit: EndDimensions) -> tuple[end_bending.Shell, Array]:
    """The wall of the barrel, and its shear force beside a groove.

    The force of the plug acts at the middle of the groove's depth.
    """
    end = loaded.end
    wall = end_bending.shell(layers=loaded.shells, inner_radius=end.inner_radius)
    line_force = loaded.force / (2 * pi * wall.radius)
    growth = end_bending.free_growth(
        wall=wall, pressure=loaded.pressure, bore_radius=end.inner_radius, line_force=line_force
    )
    moment = line_force * (wall.centre - fit.groove[2] / 2)
    return wall, end_bending.groove_shear(wall=wall, growth=growth, groove_moment=moment)


def _change(plies: Plies, beside: EdgeBeside, supply: Array) -> Stress:
    """Change of the plies' stresses per unit pressure, (faces, plies, 1, 1, designs)."""
    faces: list[list[list[Array]]] = [[], []]
    place: Array = 0.0
    for i, layer in enumerate(plies.layers):
        if i in plies.rows:
            for k, start in enumerate((place, place + layer.thickness)):
                faces[k].append(list(_ply_change(layer, start, beside, supply)))
        place = place + layer.thickness
    parts = []
    for part in range(4):
        rows = [np.stack(np.broadcast_arrays(*[ply[part] for ply in face])) for face in faces]
        parts.append(np.stack(rows)[:, :, None, None])
    return stress_of(parts)


def _ply_change(layer: Layer, place: Array, beside: EdgeBeside, supply: Array) -> Iterator[Array]:
    """Change of sigma_1, sigma_2, sigma_3 and tau_12 of a ply per unit pressure."""
    c = layer.constants
    axial, hoop = end_bending.strain_changes(
        place=place, wall=beside.wall, edge=beside.edge, growth=beside.growth
    )
    first, second, shear = ply.ply_stresses(
        stiffness=ply.ply_stiffness(
            youngs_modulus_1=c["youngs_modulus_1"],
            youngs_modulus_2=c["youngs_modulus_2"],
            poissons_ratio_12=c["poissons_ratio_12"],
            shear_modulus_12=c["shear_modulus_12"],
        ),
        angle=layer.angle,
        axial_strain=axial / supply,
        hoop_strain=hoop / supply,
    )
    for part in (first, second, 0.0 * first, shear):
        yield np.atleast_1d(part)
