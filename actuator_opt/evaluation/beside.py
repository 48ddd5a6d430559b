"""Strength of the barrel beside a joint, where the wall bends.

Beside a skirt or sleeve, the stiffness of the wall changes. The change of strain there, from the
wall as a shell, is added to the stresses of the exact wall, with cure stresses and the criterion
of the design. Beside a plug's groove or thread, only shear through the thickness of the plies is
checked: the liner carries the axial force there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import reduce
from math import pi
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array, maximum, minimum
from ..joints.joint import EdgeBeside, EndDimensions, Loaded
from ..models import end_bending, ply
from ..models.barrel import von_mises
from ..models.strength_modes import Stress, load_multiplier
from .barrel import laminate
from .barrel.wall import Cycle, Metal, MetalTube, Plies, Wall
from .geometry import EndJoint
from .plies import Layer, stress_of

GROOVE = "beside the plug's groove"
"""End of the names of locations. A plug's thread counts as a groove."""

INTERLAMINAR = "interlaminar shear"
"""Start of the names of locations of shear through the thickness."""


class RowsBeside(NamedTuple):
    """Pressures at first-ply failure and at yield [Pa], and pulses of metals, by location."""

    first_ply: Mapping[str, Array] = {}
    yields: Mapping[str, Array] = {}
    cycles: Mapping[str, Cycle] = {}


def rows(
    end_joint: EndJoint, loaded: Loaded, fit: EndDimensions, wall: Wall, supply: Array
) -> RowsBeside:
    """Strength of the barrel where it bends beside a joint.

    There are no rows for caps that are plates, for unbalanced plies, and if an elastic constant is
    unknown.
    """
    joint, plies = end_joint.joint, wall.plies
    if not loaded.shells or (plies and not all(ply.balanced for ply in plies.layers)):
        return RowsBeside()
    beside = None if joint.beside is None else joint.beside(loaded)
    if beside is None:
        if plies is None or joint.form != "plugs" or not fit.groove:
            return RowsBeside()
        return RowsBeside(_interlaminar(loaded, plies, *_groove(loaded, fit), GROOVE, supply))
    pressures: dict[str, Array] = {}
    if plies is not None:
        change = _change(plies, beside, supply)
        pressures = {
            f"{name}, {beside.place}": pressure
            for name, pressure in laminate.first_ply_changed(plies, change)
        }
        shear = (beside.wall, beside.edge.force, beside.place)
        pressures |= _interlaminar(loaded, plies, *shear, supply)
    yields: dict[str, Array] = {}
    cycles: dict[str, Cycle] = {}
    for metal in wall.metals:
        bent = replace(metal, load=_metal_load(metal, loaded, beside, supply))
        at_yield, pulses = laminate.metal_rows(bent, (beside.place,), supply)
        yields |= at_yield
        cycles |= pulses
    if wall.tube is not None:
        place, stress = f"barrel, {beside.place}", _tube_stress(wall.tube, loaded, beside, supply)
        yields[place] = supply * wall.tube.strength / stress
        cycles[place] = Cycle(wall.tube.material, stress, stress / 2)
    return RowsBeside(pressures, yields, cycles)


def _interlaminar(
    loaded: Loaded, plies: Plies, shell: end_bending.Shell, force: Array, place: str, supply: Array
) -> dict[str, Array]:
    """Pressures at which plies fail by shear through the thickness."""
    shears = end_bending.interlaminar_shear(layers=loaded.shells, wall=shell, force=force)
    pressures = {}
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


def _metal_load(metal: Metal, loaded: Loaded, beside: EdgeBeside, supply: Array) -> Stress:
    """Stress of a metal layer per unit pressure, where the wall bends; axes as `Metal.load`."""
    first, second, third, fourth = metal.load
    if beside.metal_peak is not None:
        return stress_of(beside.metal_peak * part for part in metal.load)
    along, around = (
        np.stack([np.atleast_1d(stress / supply) for stress in part])[:, None, None, None]
        for part in zip(*_metal_change(loaded, metal.layer, beside), strict=True)
    )
    return (first + along, second + around, third, fourth)


def _tube_stress(tube: MetalTube, loaded: Loaded, beside: EdgeBeside, supply: Array) -> Array:
    """Largest equivalent stress of a metal tube at supply pressure, where it bends."""
    equivalents = [
        von_mises(axial=supply * z + along, hoop=supply * t + around, radial=supply * r)
        for (z, t, r), (along, around) in zip(
            tube.faces, _metal_change(loaded, 0, beside), strict=True
        )
    ]
    return reduce(maximum, equivalents)


def _metal_change(
    loaded: Loaded, layer: int, beside: EdgeBeside
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Change of axial and hoop stress of a layer at its inner and outer face, at supply pressure.

    By Hooke's law from the changes of strain, without radial stress.
    """
    shell = loaded.shells[layer]
    start: Array = sum((inner.thickness for inner in loaded.shells[:layer]), 0.0)

    def change(place: Array) -> tuple[Array, Array]:
        axial, hoop = end_bending.strain_changes(
            place=place, wall=beside.wall, edge=beside.edge, growth=beside.growth
        )
        return (
            shell.axial * axial + shell.coupling * hoop,
            shell.coupling * axial + shell.hoop * hoop,
        )

    return change(start), change(start + shell.thickness)


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
    axial, hoop = end_bending.strain_changes(
        place=place, wall=beside.wall, edge=beside.edge, growth=beside.growth
    )
    first, second, shear = ply.ply_stresses(
        stiffness=layer.plane_stiffness,
        angle=layer.angle,
        axial_strain=axial / supply,
        hoop_strain=hoop / supply,
    )
    for part in (first, second, 0.0 * first, shear):
        yield np.atleast_1d(part)
