"""Lengths of the actuator, for the checks of a design file and for its geometry."""

from __future__ import annotations

from ..base.numeric import Array
from ..joints.joint import LEAST_METAL, StaticPlace
from ..models import gland


def closed_length(
    *,
    barrel_length: Array,
    plate: Array,
    spigot: Array,
    further: Array,
    extension: Array,
    eyes: Array,
) -> Array:
    """Pin-to-pin length of the retracted actuator [m]; the total length with a second rod.

    `spigot` is the length of the cap's spigot, `eyes` that of all eyes. `further` is that of
    cushions' bushes, the additional neck of the cap's eye, the components between cap or rod and
    eye, and a second rod outside the cap.
    """
    return barrel_length + 2 * plate + spigot + further + extension + eyes


def spigot_length(*, place: StaticPlace, section: Array) -> Array:
    """Length of the cap's spigot, with the groove of the static seal and metal beside it [m].

    It is 0 unless the static seal of the cap has the place "bore".
    """
    return gland.groove_width(section=section) + 2 * LEAST_METAL if place == "bore" else 0.0
