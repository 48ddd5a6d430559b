"""Metal rings shrunk over the ends of the barrel, each with the plate of its cap in its rim.

The ring grips the outside of the barrel by friction alone. Interference, bore pressure, axial force
and temperature change the contact pressure, which the exact layered tube gives. Over a length of
1/beta from each of its edges, the ring does not press fully; this length does not count.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.numeric import Array, maximum, minimum, sqrt
from ..base.quantities import Quantity, length_text
from ..models import end_bending, mass, shrink_fit as model
from ..models.layered_tube import LayeredTube, TubeLayer, layered_tube
from ..models.solid_ply import solid_stiffness
from .joint import (
    NOT_BONDED,
    BarrelOpening,
    DrawnPart,
    End,
    EndDimensions,
    EndSpan,
    Fatigue,
    Joint,
    JointField,
    KnownMaterials,
    Loaded,
    MaterialProperties,
    Pulsed,
    StatedValues,
    Strength,
    WallPressures,
    chosen,
    nothing,
    too_thin,
)

FRICTION = 0.12
"""Friction coefficient of dry metal on carbon plies, unless stated. Published values are 0.1 to
0.2; the choice in this range is ours."""

RELAXATION = 0.6
"""Share of the grip that remains in service, unless stated: the matrix creeps across the plies. Our
choice, without data."""

CONTACT, LENGTH = "shrink_contact", "geometry_shrink"
"""Metrics of the contact pressure, and of the length of ring that grips."""

SOLID = ("youngs_modulus_1", "youngs_modulus_2", "youngs_modulus_3", "poissons_ratio_12",
         "poissons_ratio_13", "poissons_ratio_23", "shear_modulus_12")  # fmt: skip
"""Elastic constants of a layer that the exact tube needs."""


# --- faults of the file ---------------------------------------------------------------------


def _stated_tube(view: StatedValues, materials: KnownMaterials) -> LayeredTube | None:
    """The barrel as stated in the design file; None if a value is missing or wrong."""
    bore, layers = view.number("cylinder", "bore"), []
    for index in range(len(view.items("barrel", "layup"))):
        at = ("barrel", "layup", index)
        thickness, name = view.number(*at, "thickness"), view.text(*at, "material")
        numbers = {} if name is None else materials.numbers(name)
        if thickness is None or not thickness > 0 or not set(SOLID) <= set(numbers):
            return None
        layers.append(
            TubeLayer(
                stiffness=solid_stiffness(**{key: numbers[key] for key in SOLID}),
                thickness=thickness,
                angle=view.number(*at, "angle") or 0.0,
            )
        )
    if bore is None or not bore > 0 or not layers:
        return None
    return layered_tube(layers=layers, inner_radius=bore / 2)


def _material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report an interference at which the ring or the liner yields at assembly."""
    interference, wall = (view.number("retention", key) for key in ("interference", "wall"))
    name, layup = view.text("retention", "material"), view.items("barrel", "layup")
    varied = ["cylinder.bore", "retention.interference", "retention.wall"]
    varied += [f"barrel.layup[{i}].{key}" for i in range(len(layup))
               for key in ("thickness", "angle")]  # fmt: skip
    if any(view.has("variables", path) or chosen(view, path) for path in varied):
        return
    tube = _stated_tube(view, materials)
    ring = {} if name is None else materials.numbers(name)
    if tube is None or interference is None or wall is None or not wall > 0:
        return
    if not {"youngs_modulus", "poissons_ratio", "yield_strength"} <= set(ring):
        return
    radius = float(tube.outer[-1])
    give = model.ring_give(
        inner_radius=radius,
        wall_thickness=wall,
        youngs_modulus=ring["youngs_modulus"],
        poissons_ratio=ring["poissons_ratio"],
    )
    per_pressure = -model.outer_growth(tube=tube, outer_pressure=1.0) + give
    stresses = [
        (
            "ring",
            ring["yield_strength"],
            model.ring_stress(inner_radius=radius, wall_thickness=wall),
        )
    ]
    innermost = view.text("barrel", "layup", 0, "material")
    liner = {} if innermost is None else materials.numbers(innermost)
    if innermost is not None and materials.kind(innermost) == "metal" and "yield_strength" in liner:
        stresses.append(("liner", liner["yield_strength"], model.bore_stress(tube=tube)))
    part, strength, stress = min(stresses, key=lambda one: float(one[1] / one[2]))
    most = float(strength / stress * per_pressure)
    if interference > most:
        pressure = interference / float(per_pressure)
        other = "a thicker ring (retention.wall)" if part == "ring" else "a thicker liner"
        yield Fault(
            ("retention", "interference"),
            f"{_microns(interference)}: beyond yield, as the {part} would be stressed by "
            f"{1e-6 * pressure * float(stress):.0f} MPa at assembly",
            f"write at most {_microns(most)}, or {other}",
        )


def _microns(length: float) -> str:
    return f"{1e6 * length:.3g} um"


# --- dimensions and mass --------------------------------------------------------------------


def _fit(end: End) -> EndDimensions:
    return EndDimensions(
        plate_radius=end.outer_radius,
        radius=end.outer_radius,
        length=end.sizes["length"],
        wall=end.sizes["wall"],
    )


def _mass(end: End, materials: MaterialProperties) -> Mapping[str, Array]:
    """Mass of the ring, over the barrel and over the rim of the plate."""
    assert end.material is not None
    ring = mass.tube_mass(
        density=materials.get(end.material, "density"),
        inner_diameter=2 * end.outer_radius,
        outer_diameter=2 * (end.outer_radius + end.sizes["wall"]),
        length=end.sizes["length"] + end.plate,
    )
    return {"fastening": ring}


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    assert end.material is not None
    inner, wall = float(fit.radius), float(fit.wall)
    shape = span.beyond(-float(fit.length), float(end.plate), inner, inner + wall)
    yield DrawnPart("shrink rings", end.material, shape)


def _notes(end: End) -> Iterator[str]:
    yield (
        f"Rings shrunk on: radial interference {_microns(float(end.sizes['interference']))} at "
        f"{length_text(float(2 * end.outer_radius))} diameter; dry, free of grease. The ring is "
        "welded or rolled to the rim of the plate, which is not drawn."
    )


# --- strength -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class RingContact:
    """Contact of ring and barrel.

    `pressures` are the contact pressures [Pa]: "at assembly", "cold" and "hot", each without and
    with supply pressure. `grips` are the forces that friction holds under supply pressure [N], by
    temperature, `length` is the length that grips [m], and `rise` the contact pressure that supply
    pressure adds [Pa]. `idle` and `most` are the largest contact pressures without and with supply
    pressure [Pa].
    """

    tube: LayeredTube
    pressures: Mapping[str, Array]
    grips: Mapping[str, Array]
    length: Array
    rise: Array
    idle: Array
    most: Array


def _contact(loaded: Loaded) -> RingContact | str:
    """Contact of an end, or the reason why it is unknown; the result is cached."""
    if "contact" not in loaded.end.cache:
        loaded.end.cache["contact"] = _contact_of(loaded)
    contact: RingContact | str = loaded.end.cache["contact"]
    return contact


def _contact_of(loaded: Loaded) -> RingContact | str:
    end, materials, tube = loaded.end, loaded.materials, loaded.tube()
    if end.material is None:
        return "a shrunk ring needs a metal: add retention.material"
    ring = {key: materials.get(end.material, key) for key in ("youngs_modulus", "poissons_ratio")}
    if tube is None or any(value is None for value in ring.values()):
        return "the elastic constants of barrel or ring are unknown"
    give = {
        "tube_give": -model.outer_growth(tube=tube, outer_pressure=1.0),
        "give": model.ring_give(
            inner_radius=end.outer_radius, wall_thickness=end.sizes["wall"], **ring
        ),
    }
    pressed = model.outer_growth(tube=tube, inner_pressure=loaded.pressure)
    pulled = model.outer_growth(tube=tube, axial_force=loaded.force)
    pressures, grips = {}, {}
    shell = end_bending.shell(layers=loaded.shells, inner_radius=end.inner_radius)
    decay = sqrt(sqrt(4 * shell.bending / shell.foundation))
    length = end.sizes["length"] - 2 * decay
    friction = end.sizes.get("friction_coefficient", FRICTION)
    friction = friction * end.sizes.get("relaxation", RELAXATION)
    for word, ring_growth, warmed in _warmed(loaded, tube):
        idle, held, free = (
            model.contact_pressure(
                interference=end.sizes["interference"],
                tube_growth=warmed + growth,
                ring_growth=ring_growth,
                **give,
            )
            for growth in (0.0 * pressed, pressed + pulled, pressed)
        )
        pressures[word] = idle
        pressures[f"{word}, under pressure"] = held
        pressures[f"{word}, under pressure without axial force"] = free
        grips[word] = model.grip(
            friction_coefficient=friction,
            radius=end.outer_radius,
            pressure=maximum(minimum(held, free), 0.0 * held),
            length=maximum(length, 0.0 * length),
        )
    idle, most = None, None
    for word, pressure in pressures.items():
        most = pressure if most is None else maximum(most, pressure)
        if word in grips:
            idle = pressure if idle is None else maximum(idle, pressure)
    rise = maximum(pressed, pressed + pulled) / (give["tube_give"] + give["give"])
    return RingContact(tube, pressures, grips, length, rise, idle, most)


def _warmed(loaded: Loaded, tube: LayeredTube) -> Iterator[tuple[str, Array, Array]]:
    """Free growth of the ring's bore and of the barrel's outside at each temperature [m]."""
    end = loaded.end
    yield "at assembly", 0.0, 0.0
    assert end.material is not None
    expansion = loaded.materials.get(end.material, "thermal_expansion")
    if expansion is None or loaded.expansion is None:
        return
    per_kelvin = model.outer_growth(tube=tube, temperature_change=1.0)
    for word, warming in loaded.warmings.items():
        yield word, expansion * warming * end.outer_radius, per_kelvin * warming


def _collapse(loaded: Loaded) -> Array:
    """Contact pressure at which the wall buckles inwards, from its hoop bending stiffness [Pa]."""
    end, place = loaded.end, 0.0
    first, second, total = 0.0, 0.0, 0.0
    for layer in loaded.shells:
        line, middle = layer.hoop * layer.thickness, place + layer.thickness / 2
        total, first = total + line, first + line * middle
        second = second + line * (middle * middle + layer.thickness * layer.thickness / 12)
        place = place + layer.thickness
    return model.collapse_pressure(
        hoop_bending_stiffness=second - first * first / total,
        radius=(end.inner_radius + end.outer_radius) / 2,
    )


def _strength(loaded: Loaded) -> Strength | str:
    contact, end, materials = _contact(loaded), loaded.end, loaded.materials
    if isinstance(contact, str):
        return contact
    assert end.material is not None
    strength = materials.allowable(end.material, "yield_strength")
    if strength is None:
        return f"{end.material} has no yield strength"
    grips = {f"grip, {word}": grip / loaded.force for word, grip in contact.grips.items()}
    plastic = model.plastic_pressure(
        inner_radius=end.outer_radius, wall_thickness=end.sizes["wall"], yield_strength=strength
    )
    working = {**grips, "wall buckled by the ring": _collapse(loaded) / contact.idle}
    outermost = end.layers[-1].material
    crushed = materials.allowable(outermost, "strength_2_compression")
    if materials.kind(outermost) == "ply" and crushed is not None:
        working["plies crushed by the ring"] = crushed / contact.most
    burst = {**grips, "ring at its plastic limit": (plastic - contact.idle) / contact.rise}
    return Strength(working, burst, NOT_BONDED)


def _yields(loaded: Loaded) -> Mapping[str, Array]:
    """Yield strength divided by stress: of the ring, and of a metal liner without pressure."""
    contact, end, materials = _contact(loaded), loaded.end, loaded.materials
    if isinstance(contact, str) or end.material is None:
        return {}
    ring = model.ring_stress(inner_radius=end.outer_radius, wall_thickness=end.sizes["wall"])
    stresses = {"shrink ring": (end.material, ring * contact.most)}
    if materials.kind(end.layers[0].material) == "metal":
        squeezed = model.bore_stress(tube=contact.tube) * contact.idle
        stresses["liner under the ring"] = (end.layers[0].material, squeezed)
    factors = {}
    for place, (name, stress) in stresses.items():
        strength = materials.allowable(name, "yield_strength")
        if strength is not None:
            factors[place] = strength / stress
    return factors


def _fatigue(loaded: Loaded) -> Fatigue:
    """Stress of the ring between no pressure and supply pressure."""
    contact, end = _contact(loaded), loaded.end
    if isinstance(contact, str) or end.material is None:
        return Fatigue()
    stress = model.ring_stress(inner_radius=end.outer_radius, wall_thickness=end.sizes["wall"])
    span = stress * contact.rise
    return Fatigue((Pulsed("shrink ring", end.material, span, stress * contact.idle + span / 2),))


def _own(loaded: Loaded) -> Mapping[str, Mapping[str, Array] | Array]:
    contact = _contact(loaded)
    if isinstance(contact, str):
        return {}
    return {CONTACT: contact.pressures, LENGTH: contact.length}


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn that friction alone holds the end, of lost contact, and of a ring that is too short."""
    contact = _contact(loaded)
    if isinstance(contact, str):
        return
    yield (
        "retention_burst_factor",
        "friction alone holds the ends: a slip loses them, and how the grip relaxes is not known "
        "from tests",
    )
    for place, pressure in contact.pressures.items():
        if float(np.min(np.real(pressure))) <= 0:
            yield ("retention_factor", f"{place}: the ring loses its contact with the barrel")
    yield from too_thin({LENGTH: contact.length}, quantities)
    if len(contact.grips) == 1:
        yield (
            "retention_factor",
            "how temperature changes the grip is unknown: state environment, and the thermal "
            "expansion of barrel and ring",
        )


_ABSENT = "no shrunk ring"

JOINT = Joint(
    name="shrink",
    help="metal rings shrunk over the barrel, held by friction",
    noun="a shrunk ring",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "material",
            "missing: a shrunk ring needs a metal",
            'add e.g. "material: steel_42crmo4"',
        ),
        JointField(
            "interference",
            "missing: required by a shrunk ring",
            'add e.g. "interference: 20 um"',
            quantity="interference",
            help="radius of the barrel less that of the ring's bore, before assembly",
        ),
        JointField(
            "friction_coefficient",
            quantity="friction_coefficient",
            help=f"dry friction coefficient of ring and barrel; default {FRICTION:g}",
        ),
        JointField(
            "relaxation",
            quantity="relaxation",
            help=f"share of the grip that remains in service; default {RELAXATION:g}",
        ),
    ),
    kinds=("metal",),
    without={},
    faults=nothing,
    material_faults=_material_faults,
    opening=lambda _: BarrelOpening(
        "once", "Heat the ring of the {end} and shrink it over the barrel."
    ),
    form="skirts",
    fit=_fit,
    clamping=None,
    mass=_mass,
    outline=_outline,
    notes=_notes,
    give=None,
    strength=_strength,
    yields=_yields,
    wall=lambda loaded: WallPressures(),
    beside=None,
    fatigue=_fatigue,
    own=_own,
    envelope=None,
    metrics={CONTACT: _ABSENT, LENGTH: _ABSENT},
    judged=("grip of a ring", "grip of a ring"),
    models={
        ("retention_factor", "grip, at assembly"): "shrink_fit.grip",
        ("retention_factor", "grip, cold"): "shrink_fit.grip",
        ("retention_factor", "grip, hot"): "shrink_fit.grip",
        ("retention_factor", "wall buckled by the ring"): "shrink_fit.collapse_pressure",
        ("retention_factor", "plies crushed by the ring"): "shrink_fit.contact_pressure",
        ("retention_burst_factor", "grip, at assembly"): "shrink_fit.grip",
        ("retention_burst_factor", "grip, cold"): "shrink_fit.grip",
        ("retention_burst_factor", "grip, hot"): "shrink_fit.grip",
        ("retention_burst_factor", "ring at its plastic limit"): "shrink_fit.plastic_pressure",
        ("yield_factor", "shrink ring"): "shrink_fit.ring_stress",
        ("yield_factor", "liner under the ring"): "shrink_fit.bore_stress",
    },
    usual=(),
    warnings=_warnings,
)
