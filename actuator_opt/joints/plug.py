"""Plugs in the bore of the barrel: what the joints that hold them there share.

The end plate is the plug; its rim has the static seal. What holds the plug is outside the seal, so
that oil pressure does not act there, and the force crosses the rim behind the seal. A groove or
thread is cut into the innermost layer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..base.errors import Fault
from ..base.numeric import Array
from ..base.quantities import length_text
from ..models.end_plate import rim_tear_factor
from .joint import LEAST_METAL, ROUNDING, KnownMaterials, Loaded, StatedValues, judged_later

BEHIND_SEAL = "plug behind its static seal"
"""Location of the row of the rim between the groove of the seal and what holds the plug."""

NEEDED = ("yield_strength", "ultimate_strength", "poissons_ratio")
"""Material properties that the innermost layer needs."""


def behind_seal(loaded: Loaded, held_radius: Array) -> dict[str, Array]:
    """Plastic load of the rim behind the groove of the static seal, over the load.

    `held_radius` is the inner radius of what holds the plug. There is no row without a stated
    static seal, or without the ultimate strength of the plug.
    """
    end = loaded.end
    strength = loaded.materials.allowable(end.cap, "ultimate_strength")
    if strength is None or end.seal_lip is None:
        return {}
    factor = rim_tear_factor(
        force=loaded.force,
        groove_radius=end.inner_radius - end.seal_depth,
        skirt_radius=held_radius,
        lip_thickness=end.seal_lip,
        strength=strength,
    )
    return {BEHIND_SEAL: factor}


def innermost_faults(
    view: StatedValues,
    materials: KnownMaterials,
    cut: str,
    depth: float | None,
    varied: Iterable[str],
) -> Iterator[Fault]:
    """Report a cut into an innermost layer that is not of known metal, or is too thin.

    `cut` names what is cut, such as "the groove of the retaining ring", and `depth` is its depth.
    `varied` are the PATHs of the sizes that determine the metal left under it.
    """
    loc = ("barrel", "layup", 0)
    thickness, name = view.number(*loc, "thickness"), view.text(*loc, "material")
    kind = None if name is None else materials.kind(name)
    if name is None or kind is None:
        return
    otherwise = "or use another joint (retention.type)"
    if kind != "metal":
        description = "plies, whose fibres it would cut" if kind == "ply" else f"a {kind}"
        yield Fault(
            (*loc, "material"),
            f"{name}: {cut} is cut into the innermost layer, but this is of {description}; it "
            "needs metal",
            f"make barrel.layup[0] of metal, {otherwise}",
        )
        return
    properties = set(materials.properties(name))
    missing = [key for key in NEEDED if properties and key not in properties]
    if missing:
        yield Fault(
            (*loc, "material"),
            f"{name} has no {' nor '.join(missing)}: the strength of {cut} cannot be computed",
            f"state {missing[0]} under materials.{name}, {otherwise}",
        )
    if thickness is None or depth is None or judged_later(view, varied):
        return
    if thickness - depth < LEAST_METAL * (1 - ROUNDING):
        rest = length_text(thickness - depth) if thickness > depth else "nothing"
        yield Fault(
            (*loc, "thickness"),
            f"{length_text(thickness)} of {name}: {cut} leaves {rest} of it, but "
            f"{length_text(LEAST_METAL)} is needed",
            f"write a thickness of at least {length_text(depth + LEAST_METAL)}, {otherwise}",
        )
