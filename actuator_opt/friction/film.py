"""Friction on an oil film between rough surfaces."""

from __future__ import annotations

from dataclasses import replace

from ..base.numeric import real, where
from ..models import friction, rough_surface
from ..seals.contact import SealContact
from ..seals.seal_type import SealSizes
from . import coefficient
from .law import Friction, MovingFilm


def _friction(seal: SealSizes, contact: SealContact, film: MovingFilm | None) -> Friction:
    """Friction on an oil film; at rest the oil is squeezed out, so the contact is dry."""
    asperity_friction = seal["asperity_friction"]
    dry = friction.seal_friction(
        line_load=contact.line_load,
        diameter=seal["diameter"],
        friction_coefficient=asperity_friction,
    )
    if film is None:
        return Friction(dry, dry, 0.0)
    sliding = film.viscous + asperity_friction * film.load
    slope = film.viscous_slope + asperity_friction * film.load_slope
    moving = real(seal["speed"]) > 0
    touching = real(seal["squeeze_left"]) > 0
    return Friction(
        where(touching, where(moving, sliding, dry), 0.0), dry, where(touching, slope, 0.0)
    )


LAW = replace(
    coefficient.LAW,
    name="film",
    help="oil film between rough surfaces, which also gives the leakage",
    compound=("seal_roughness", "asperity_radius", "asperity_density", "asperity_friction"),
    film=_friction,
    model=rough_surface.pressure_flow_factor,
)
