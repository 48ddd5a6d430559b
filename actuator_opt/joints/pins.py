"""Plugs in the barrel's end, each held by radial pins through the laminate.

The end plate is a plug in the bore, whose rim has the static seal. The innermost layer of the
barrel is a liner and ends at the plate. Outside it, a skirt of the plug fills the other layers,
which must be plies. Pins in one row or two go through the plies into this skirt, so that neither
liner nor chamber is pierced. The plies carry the whole force there. They must be close to
quasi-isotropic, as only such laminates hold pins.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import floor, pi, sqrt

import numpy as np

from ..base.errors import Fault
from ..base.numeric import Array, absolute, minimum, real, where
from ..base.quantities import Quantity, length_text
from ..models import laminate_pins as model, mass, ply
from .joint import (
    LEAST_METAL,
    NOT_BONDED,
    ON_METAL,
    ROUNDING,
    BarrelOpening,
    DrawnPart,
    End,
    EndDimensions,
    EndSpan,
    Fatigue,
    Joint,
    JointField,
    KnownMaterials,
    Life,
    Loaded,
    MaterialProperties,
    Pulsed,
    StatedValues,
    Strength,
    WallPressures,
    chosen,
    metal_strengths,
    too_thin,
)
from .plug import behind_seal
from .winding import winding_edge

PATTERN, SKIRT = "geometry_pins", "geometry_pin_skirt"
"""Metrics of the pattern's valid range, and of the metal of the plug's skirt."""

LINER_END = "edge of the liner"
"""Location of the shear where the plies take over the force of the liner."""

BEARING = "pin_bearing_strength"
"""Property of a ply: strength of a laminate of it against pins."""

LEAST_EDGE = LEAST_PITCH = 3.0
"""Least distance of a hole from the laminate's end and least pitch, in pin diameters
[HartSmith1978]. The pitch also holds between two rows: our choice."""

LEAST_SHARES = {"+-45 deg plies": 0.4, "axial plies": 0.1, "hoop plies": 0.1}
"""Least shares of the laminate's thickness for which the formulas are valid [HartSmith1978]."""

AXIAL, DIAGONAL, HOOP = 15.0, 30.0, 75.0
"""Angles that separate axial, +-45 and hoop plies [deg]: up to 15, 30 to 60, from 75. Our choice,
as a wound ply cannot lie at exactly 0 or 90 degrees."""

SIZES = ("diameter", "count", "rows", "spacing", "edge", "length", "wall")


# --- the pattern ----------------------------------------------------------------------------


def _plies(share: Array, angle: Array) -> dict[str, Array]:
    """Share of a layer in the laminate, under the direction of its plies; elsewhere 0."""
    size, none = absolute(real(angle)) * (180 / pi), 0 * share
    return {
        "+-45 deg plies": where((size >= DIAGONAL) & (size <= 90 - DIAGONAL), share, none),
        "axial plies": where(size <= AXIAL, share, none),
        "hoop plies": where(size >= HOOP, share, none),
    }


def _pattern(
    sizes: Mapping[str, Array],
    radius: Array,
    layers: Sequence[tuple[Array, Array]],
    *,
    spaced: bool,
) -> dict[str, Array]:
    """Each ratio of a pattern divided by its limit; the formulas are valid from 1 on.

    `radius` is the middle radius of the laminate, and `layers` are thickness and angle of its
    plies. With `spaced`, the design states the distance of two rows.
    """
    diameter, thickness = sizes["diameter"], sum(layer[0] for layer in layers)
    inboard = sizes["length"] - sizes["edge"] - (sizes["rows"] - 1) * sizes["spacing"]
    ratios = {
        "edge distance": sizes["edge"] / (LEAST_EDGE * diameter),
        "pitch": 2 * pi * radius / (sizes["count"] * LEAST_PITCH * diameter),
        "thin laminate": 2 * thickness / diameter,
        "thick laminate": diameter / thickness,
        "distance from the plate": inboard / diameter,
    }
    if spaced:
        ratios["distance of the rows"] = where(
            real(sizes["rows"]) > 1.5,
            sizes["spacing"] / (LEAST_PITCH * diameter),
            1.0 + 0 * sizes["spacing"],
        )
    for direction, least in LEAST_SHARES.items():
        ratios[direction] = (
            sum(_plies(part / thickness, angle)[direction] for part, angle in layers) / least
        )
    return ratios


def _sizes(end: End) -> dict[str, Array]:
    """Sizes of the pattern; one row has no spacing."""
    return {key: end.sizes.get(key, {"rows": 1.0}.get(key, 0.0)) for key in SIZES}


# --- faults of the file ---------------------------------------------------------------------


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report two rows without spacing, or a spacing of one row."""
    rows = view.number("retention", "rows")
    if _varied(view, "retention.rows") or (rows is None and view.has("retention", "rows")):
        return
    spacing = view.number("retention", "spacing")
    if rows == 2.0 and spacing is None:
        yield Fault(
            ("retention", "spacing"),
            "missing: two rows of pins need a distance",
            'add e.g. "spacing: 12 mm", at least three pin diameters',
        )
    if rows in (None, 1.0) and spacing is not None:
        yield Fault(
            ("retention", "spacing"),
            "without effect: there is one row of pins",
            "remove the line, or write rows: 2",
            at_key=True,
        )


def _varied(view: StatedValues, *paths: str) -> bool:
    """Whether the search, or a choice, changes one of these numbers."""
    return any(view.has("variables", path) or chosen(view, path) for path in paths)


def _layer_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report layers that are not a liner with plies around it."""
    count = len(view.items("barrel", "layup"))
    for index in range(count):
        loc = ("barrel", "layup", index, "material")
        name = view.text(*loc)
        kind = None if name is None else materials.kind(name)
        if kind is None or (kind == "ply") == (index > 0):
            continue
        part = "around the liner, need plies" if index else "end outside a liner, not plies"
        yield Fault(
            loc,
            f"{name} is a {kind}: pins {part}",
            "make barrel.layup[0] a liner and all other layers plies, or use another joint "
            "(retention.type)",
        )
    if count == 1:
        yield Fault(
            ("barrel", "layup"),
            "a single layer: pins need plies around a liner",
            "add plies, or use another joint (retention.type)",
        )


def _material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report layers that are no laminate, and a pattern outside its valid range.

    A pattern that a search varies is limited by a metric instead.
    """
    wrong = list(_layer_faults(view, materials))
    yield from wrong
    if wrong:
        return
    layup = [("barrel", "layup", i) for i in range(len(view.items("barrel", "layup")))]
    thicknesses = [view.number(*at, "thickness") for at in layup]
    sizes = {key: view.number("retention", key) for key in SIZES}
    sizes["rows"] = 1.0 if sizes["rows"] is None else sizes["rows"]
    sizes["spacing"] = 0.0 if sizes["spacing"] is None else sizes["spacing"]
    bore = view.number("cylinder", "bore")
    angles = [view.number(*at, "angle") or 0.0 for at in layup]
    numbers = {key: value for key, value in sizes.items() if value is not None}
    known = [thickness for thickness in thicknesses if thickness is not None]
    if bore is None or len(known) < len(layup) or len(numbers) < len(SIZES):
        return
    if numbers["rows"] not in (1.0, 2.0) or (numbers["rows"] == 2.0 and not numbers["spacing"]):
        return
    yield from _pattern_faults(view, numbers, bore, list(zip(known, angles, strict=True)))


def _pattern_faults(
    view: StatedValues,
    sizes: dict[str, float],
    bore: float,
    layers: Sequence[tuple[float, float]],
) -> Iterator[Fault]:
    d, thickness, liner = sizes["diameter"], sum(layer[0] for layer in layers[1:]), layers[0][0]
    radius = bore / 2 + liner + thickness / 2
    around = 2 * pi * radius / sizes["count"] / d
    inboard = sizes["edge"] + (sizes["rows"] - 1) * sizes["spacing"] + d
    plies = [f"barrel.layup[{i}].thickness" for i in range(len(layers))]
    places = {
        "edge distance": ("edge", f"{sizes['edge'] / d:.3g} pin diameters from hole to end, but "
                          "plies need 3 not to shear out", length_text(3 * d), ()),
        "pitch": ("count", f"{around:.3g} pin diameters of circumference for each pin, but plies "
                  "need 3 between holes", str(floor(2 * pi * radius / (3 * d))),
                  ("cylinder.bore", *plies)),
        "distance of the rows": ("spacing", f"{sizes['spacing'] / d:.3g} pin diameters between the "
                                 "rows, but plies need 3", length_text(3 * d), ("retention.rows",)),
        "thin laminate": ("diameter", f"the laminate is {thickness / d:.3g} pin diameters thick, "
                          "but pins need half of one", length_text(2 * thickness), plies[1:]),
        "thick laminate": ("diameter", f"a pin must be no thinner than the laminate, of "
                           f"{length_text(thickness)}", length_text(thickness), plies[1:]),
        "distance from the plate": ("length", "rows and edge leave less than a pin diameter to the "
                                    "plate", length_text(inboard),
                                    ("retention.edge", "retention.rows", "retention.spacing")),
    }  # fmt: skip
    spaced = view.has("retention", "spacing")
    ratios = _pattern(sizes, radius, layers[1:], spaced=spaced)
    for place, (key, message, number, others) in places.items():
        if ratios.get(place, 1.0) >= 1 - ROUNDING or _varied(
            view, f"retention.{key}", "retention.diameter", *others
        ):
            continue
        word = "at most" if place in ("pitch", "thin laminate") else "at least"
        value = f"{sizes[key]:g}" if key == "count" else length_text(sizes[key])
        yield Fault(("retention", key), f"{value}: {message}", f"write {word} {number}")
    angles = [f"barrel.layup[{i}].angle" for i in range(1, len(layers))]
    for direction, least in LEAST_SHARES.items():
        if ratios[direction] < 1 - ROUNDING and not _varied(view, *plies[1:], *angles):
            yield Fault(
                ("barrel", "layup"),
                f"{100 * least * ratios[direction]:.3g} % of the laminate are {direction}, but "
                f"pins need {100 * least:g} %",
                "thicken these plies, or use another joint (retention.type)",
            )
    if sizes["wall"] - liner < LEAST_METAL * (1 - ROUNDING) and not _varied(
        view, "retention.wall", plies[0]
    ):
        yield Fault(
            ("retention", "wall"),
            f"{length_text(sizes['wall'])}: the plug's skirt does not reach inside the liner, of "
            f"{length_text(liner)}",
            f"write at least {length_text(liner + LEAST_METAL)}",
        )


# --- dimensions and mass --------------------------------------------------------------------


def _skirt(end: End) -> tuple[Array, Array]:
    """Inner and outer radius of the plug's skirt."""
    outer = end.inner_radius + end.layers[0].thickness
    return outer - end.sizes["wall"], outer


def _fit(end: End) -> EndDimensions:
    length = end.sizes["length"]
    return EndDimensions(
        plate_radius=end.inner_radius,
        radius=end.inner_radius,
        lip=length,
        beyond=end.plate + length,
        short=length,
    )


def _mass(end: End, materials: MaterialProperties) -> Mapping[str, Array]:
    """Mass of skirt and pins, less that of the liner that the skirt replaces.

    The holes are not deducted, as in the drawing.
    """
    assert end.material is not None
    sizes, length = _sizes(end), end.sizes["length"]
    inner, outer = _skirt(end)
    skirt = mass.tube_mass(
        density=materials.get(end.cap, "density"),
        inner_diameter=2 * inner,
        outer_diameter=2 * outer,
        length=length,
    )
    pin = mass.disc_mass(
        density=materials.get(end.material, "density"),
        diameter=sizes["diameter"],
        thickness=end.outer_radius - inner,
    )
    liner = end.layers[0]
    area = mass.layer_area(inner_radius=end.inner_radius, thickness=liner.thickness)
    return {
        "caps": skirt,
        "fastening": sizes["count"] * sizes["rows"] * pin,
        "barrel": -materials.get(liner.material, "density") * area * length,
    }


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    assert end.material is not None
    plate, length = float(end.plate), float(fit.lip)
    inner, outer = (float(radius) for radius in _skirt(end))
    yield DrawnPart("caps", end.cap, span.beyond(plate, plate + length, inner, outer))
    sizes = {key: float(value) for key, value in _sizes(end).items()}
    for row in range(round(sizes["rows"])):
        centre = plate + length - sizes["edge"] - row * sizes["spacing"]
        half = sizes["diameter"] / 2
        shape = span.beyond(centre - half, centre + half, inner, float(end.outer_radius))
        yield DrawnPart("pins", end.material, shape, round(sizes["count"]), radial=True)


def _notes(end: End) -> Iterator[str]:
    sizes = _sizes(end)
    rows = "two rows of" if float(sizes["rows"]) > 1.5 else "one row of"
    yield (
        f"Pins at each end: {rows} {round(float(sizes['count']))}, "
        f"{1e3 * sizes['diameter']:.4g} mm diameter, pressed into the plug; their holes in plies "
        "and plug are not drawn. Chamfer the liner's end, which the seals pass at assembly."
    )


# --- strength -------------------------------------------------------------------------------


def _laminate(loaded: Loaded) -> tuple[model.FibreLayer, ...] | str:
    """The layers around the pins, or the reason why their strength is unknown."""
    if "laminate" not in loaded.end.cache:
        loaded.end.cache["laminate"] = _fibre_layers(loaded)
    layers: tuple[model.FibreLayer, ...] | str = loaded.end.cache["laminate"]
    return layers


def _fibre_layers(loaded: Loaded) -> tuple[model.FibreLayer, ...] | str:
    end, materials = loaded.end, loaded.materials
    layers = []
    if len(end.layers) == 1:
        return "pins need plies around a liner"
    for layer in end.layers[1:]:
        keys = ("youngs_modulus_1", "youngs_modulus_2", "poissons_ratio_12", "shear_modulus_12")
        elastic = {key: materials.get(layer.material, key) for key in keys}
        strengths = [
            materials.allowable(layer.material, key)
            for key in ("strength_1_tension", "strength_1_compression", BEARING)
        ]
        for key, value in zip((*keys, "strength_1_tension", "strength_1_compression", BEARING),
                              (*elastic.values(), *strengths), strict=True):  # fmt: skip
            if value is None:
                return f"{layer.material} has no {key}: state it under materials.{layer.material}"
        layers.append(
            model.FibreLayer(
                layer.thickness,
                layer.angle,
                ply.ply_stiffness(**elastic),
                strengths[0],
                strengths[1],
            )
        )
    return tuple(layers)


def _row_force(loaded: Loaded, layers: Sequence[model.FibreLayer]) -> Array:
    """Force of the most loaded row of pins; the result is cached.

    Tube and plug both leave the joint at the inner row, which therefore takes more than half.
    """
    end, materials = loaded.end, loaded.materials
    if "row_force" in end.cache:
        return end.cache["row_force"]
    assert end.material is not None
    sizes, (inner, outer) = _sizes(end), _skirt(end)
    thickness, modulus = end.outer_radius - outer, model.axial_modulus(layers=layers)
    plug, pin = (materials.get(name, "youngs_modulus") for name in (end.cap, end.material))
    flexibility = model.pin_flexibility(
        diameter=sizes["diameter"],
        thickness=thickness,
        modulus=modulus,
        depth=sizes["wall"],
        plug_modulus=plug,
        pin_modulus=pin,
    )
    tube, sleeve = (
        mass.layer_area(inner_radius=low, thickness=high - low) * stiff
        for low, high, stiff in ((outer, end.outer_radius, modulus), (inner, outer, plug))
    )
    share = model.first_row_share(
        row_stiffness=sizes["count"] / flexibility,
        tube_give=sizes["spacing"] / tube,
        sleeve_give=sizes["spacing"] / sleeve,
        loaded_together=True,
    )
    force = loaded.force * where(real(sizes["rows"]) > 1.5, share, 1.0 + 0 * share)
    end.cache["row_force"] = force
    return force


def _stresses(loaded: Loaded, layers: Sequence[model.FibreLayer]) -> dict[str, Array]:
    """Stresses of laminate, pins and plug under the separating force, by part and kind."""
    end, sizes = loaded.end, _sizes(loaded.end)
    outer, force = _skirt(end)[1], _row_force(loaded, layers)
    thickness, radius = end.outer_radius - outer, (end.outer_radius + outer) / 2
    count, diameter, edge = sizes["count"], sizes["diameter"], sizes["edge"]
    row = {"force": force, "count": count}
    lever = thickness / 2
    hole = model.elastic_hole_factor(
        diameter=diameter, pitch=2 * pi * radius / count, edge_distance=edge
    )
    net = model.net_section_stress(
        force=loaded.force, count=count, diameter=diameter, thickness=thickness, radius=radius
    )
    return {
        "bearing": model.bearing_stress(**row, diameter=diameter, thickness=thickness),
        "shear-out": model.shear_out_stress(**row, thickness=thickness, edge_distance=edge),
        "net": model.laminate_hole_factor(elastic_factor=hole) * net,
        "pin shear": model.pin_shear(**row, diameter=diameter),
        "pin bending": model.pin_bending(**row, diameter=diameter, lever_length=lever),
        "plastic bending": model.plastic_pin_bending(**row, diameter=diameter, lever_length=lever),
        "plug": model.bearing_stress(**row, diameter=diameter, thickness=sizes["wall"]),
        "held": model.bearing_stress(
            **row,
            diameter=diameter,
            thickness=model.holding_depth(depth=sizes["wall"], lever_length=lever),
        ),
    }


def _metals(loaded: Loaded) -> tuple[tuple[Array, Array], ...] | str:
    """Yield and ultimate strength of pins and plug; or the reason why one is unknown."""
    end = loaded.end
    if end.material is None:
        return "pins need a metal: add retention.material"
    if any(
        loaded.materials.get(name, "youngs_modulus") is None for name in (end.material, end.cap)
    ):
        return "pins or caps have no Young's modulus"
    return metal_strengths(loaded.materials, end.material, end.cap)


def _bearing_strength(loaded: Loaded) -> Array:
    """Least strength of the plies against pins."""
    end = loaded.end
    least: Array = None
    for layer in end.layers[1:]:
        value = loaded.materials.allowable(layer.material, BEARING)
        least = value if least is None else minimum(least, value)
    return least


def _strength(loaded: Loaded) -> Strength | str:
    layers, metals = _laminate(loaded), _metals(loaded)
    if isinstance(layers, str):
        return layers
    if isinstance(metals, str):
        return metals
    (pin, pin_ultimate), (plug, plug_ultimate) = metals
    stress = _stresses(loaded, layers)
    pulled, sheared = model.fibre_strengths(layers=layers)
    laminate = {
        "bearing of the plies": _bearing_strength(loaded) / stress["bearing"],
        "shear-out of the plies": sheared / stress["shear-out"],
        "plies between the holes": pulled / stress["net"],
    }
    working = {
        **laminate,
        "pins in shear": pin / sqrt(3) / stress["pin shear"],
        "pins in bending": pin / stress["pin bending"],
        "plug at the pins": plug / stress["plug"],
    }
    burst = {
        **laminate,
        "pins in shear": pin_ultimate / sqrt(3) / stress["pin shear"],
        "pins in bending": pin_ultimate / stress["plastic bending"],
        "plug that holds the pins": plug_ultimate / stress["held"],
        **behind_seal(loaded, _skirt(loaded.end)[0]),
    }
    return _with_liner(loaded, working, burst)


def _with_liner(
    loaded: Loaded, working: Mapping[str, Array], burst: Mapping[str, Array]
) -> Strength | str:
    """Strength of the end with the shear at the liner's end, where the laminate takes over.

    This is the end of a winding with the parts of liner and laminate exchanged.
    """
    edge = winding_edge(loaded)
    if edge is None:
        return Strength(working, burst, NOT_BONDED)
    if isinstance(edge, str):
        return edge
    stiffness = edge.stiffness
    edge = replace(
        edge,
        stiffness={
            **stiffness,
            "liner_stiffness": stiffness["winding_stiffness"],
            "winding_stiffness": stiffness["liner_stiffness"],
        },
    )
    return Strength({**working, LINER_END: edge.factor()}, burst, edge.thermal())


def _yields(loaded: Loaded) -> Mapping[str, Array]:
    """Yield strength of the plug's skirt between the pins, divided by its stress."""
    strength = loaded.materials.allowable(loaded.end.cap, "yield_strength")
    if strength is None:
        return {}
    sizes, (inner, outer) = _sizes(loaded.end), _skirt(loaded.end)
    stress = model.net_section_stress(
        force=loaded.force,
        count=sizes["count"],
        diameter=sizes["diameter"],
        thickness=outer - inner,
        radius=(outer + inner) / 2,
    )
    return {"plug between its pins": strength / stress}


def _fatigue(loaded: Loaded) -> Fatigue:
    """Bending of the pins and bearing of the plies under pulsating force."""
    layers, metals = _laminate(loaded), _metals(loaded)
    if isinstance(layers, str) or isinstance(metals, str):
        return Fatigue()
    stress = _stresses(loaded, layers)
    assert loaded.end.material is not None
    bent = stress["pin bending"]
    share = stress["bearing"] / _bearing_strength(loaded)
    life = Life(model.bearing_cycles(share=share), model.FATIGUE_SHARE / share)
    return Fatigue(
        (Pulsed("pins", loaded.end.material, bent, bent / 2),), {"plies at the pins": life}
    )


def _own(loaded: Loaded) -> Mapping[str, Mapping[str, Array]]:
    """The pattern within its valid range, and metal of the plug's skirt [m]; both are limited."""
    end = loaded.end
    inner, outer = _skirt(end)
    skirt = {"inside the liner": end.inner_radius - inner, "around the rod": inner - end.rod_radius}
    layers = [(layer.thickness, layer.angle) for layer in end.layers[1:]]
    if not layers:
        return {SKIRT: skirt}
    radius, spaced = (end.outer_radius + outer) / 2, "spacing" in end.sizes
    return {PATTERN: _pattern(_sizes(end), radius, layers, spaced=spaced), SKIRT: skirt}


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn of a pattern outside its valid range, too little metal, and unknown fatigue."""
    name = loaded.end.material
    if name is not None and loaded.materials.get(name, "fatigue_strength") is None:
        yield "fatigue_factor", f"fatigue of the pins is not assessed: {name} has no such strength"
    own = _own(loaded)
    for place, ratio in own.get(PATTERN, {}).items():
        least = float(np.min(np.real(ratio)))
        if least < 1 - ROUNDING:
            yield (
                "retention_factor",
                f"{place}: {100 * least:.0f} % of the least for which pins can be calculated, so "
                "their safety factors have no meaning",
            )
    for place, land in own[SKIRT].items():
        for metric, sentence in too_thin({SKIRT: land}, quantities):
            yield metric, f"{sentence} {place}"


_ABSENT = "no pins"

JOINT = Joint(
    name="pins",
    help="plugs held by radial pins through the plies",
    noun="pins",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "material", "missing: pins need a metal", 'add e.g. "material: steel_bolt_12_9"'
        ),
        JointField("count", "missing: required by pins", 'add e.g. "count: 8", pins per row'),
        JointField(
            "diameter",
            "missing: required by pins",
            'add e.g. "diameter: 4 mm"',
            quantity="diameter",
            help="diameter of the pins",
        ),
        JointField(
            "edge",
            "missing: required by pins",
            'add e.g. "edge: 12 mm", at least three pin diameters',
            quantity="part_length",
            help="distance of the outer row of pins from the end of the laminate",
        ),
        JointField("rows", quantity="pin_rows", help="rows of pins, 1 or 2; default 1"),
        JointField("spacing", quantity="part_length", help="distance of two rows of pins"),
    ),
    kinds=("metal",),
    without={},
    faults=_faults,
    material_faults=_material_faults,
    opening=lambda _: BarrelOpening("again", "Push the {end} into the barrel and set its pins."),
    form="plugs",
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
    metrics={PATTERN: _ABSENT, SKIRT: _ABSENT},
    judged=ON_METAL,
    models={
        ("retention_factor", "bearing of the plies"): "laminate_pins.bearing_stress",
        ("retention_factor", "shear-out of the plies"): "laminate_pins.shear_out_stress",
        ("retention_factor", "plies between the holes"): "laminate_pins.elastic_hole_factor",
        ("retention_factor", "pins in shear"): "laminate_pins.pin_shear",
        ("retention_factor", "pins in bending"): "laminate_pins.pin_bending",
        ("retention_factor", "plug at the pins"): "laminate_pins.bearing_stress",
        ("retention_factor", LINER_END): "liner_transfer.edge_shear",
        ("retention_burst_factor", "bearing of the plies"): "laminate_pins.bearing_stress",
        ("retention_burst_factor", "shear-out of the plies"): "laminate_pins.shear_out_stress",
        ("retention_burst_factor", "plies between the holes"): "laminate_pins.elastic_hole_factor",
        ("retention_burst_factor", "pins in shear"): "laminate_pins.pin_shear",
        ("retention_burst_factor", "pins in bending"): "laminate_pins.plastic_pin_bending",
        ("retention_burst_factor", "plug that holds the pins"): "laminate_pins.holding_depth",
        ("yield_factor", "plug between its pins"): "laminate_pins.net_section_stress",
    },
    usual=(),
    warnings=_warnings,
)
