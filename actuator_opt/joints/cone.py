"""Plugs under the winding, each held by fibres that run over a crest of metal into a valley.

The end plate is a plug in the bore of the barrel, and its rim has the static seal. All layers of
the barrel run over the rim. Outside the plate, the plug rises to the layer under the helical plies:
there is its crest. The helical plies run on over the crest and down a flank into a valley. Hoop
plies of the same material fill the valley, and hold the band on the flank. So the fibres bend only
once, and no other layer needs axial strength at the end. The barrel is wound onto the plug, so the
piston must enter from the other end.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import atan, degrees, pi, sqrt
from typing import NamedTuple

import numpy as np

from ..base.errors import Fault
from ..base.numeric import Array, maximum, minimum, namespace, tangent
from ..base.quantities import INPUTS, Quantity, length_text
from ..models import fibre_trap, liner_transfer, mass, retaining_ring, winding_path
from .joint import (
    HELICAL,
    LEAST_METAL,
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
    Loaded,
    MaterialProperties,
    Pulsed,
    StatedValues,
    Strength,
    Thermal,
    WallPressures,
    metal_strengths,
    notch_factor,
    too_thin,
)
from .plug import behind_seal
from .retaining_ring import NOTCH, NOTCH_HARD
from .winding import WindingEdge

FRICTION = 0.3
"""Largest friction coefficient between band and metal, our choice. A flank sticks, and ratchets
under cycles, below twice the angle of friction; above it, the flank releases the band."""

LEAST_ANGLE = 2 * atan(FRICTION)
"""Smallest permitted angle of the flank to the axis [rad]."""

PEAK = 1.3
"""Largest stress of the hoop plies over the flank divided by their mean stress. Our choice."""

LEAST_CREST = 3.0
"""Smallest radius of the crest divided by the thickness of the band. Our choice: a winder lays
tows over radii of three to five band thicknesses."""

LEAST_GRIP = 50.0
"""Smallest depth of the valley divided by the radial give of the hoop plies. Our choice: with more
give, the band climbs over the crest."""

LENGTHS, CREST, GRIP = "geometry_trap", "geometry_trap_crest", "geometry_trap_grip"
"""Metrics of the lengths and walls that remain at the trap, of its crest's radius, and its grip."""

LAYER_EDGE = "edge of the layers under the band"
"""Location of the shear where the inner layers end and only the band goes on."""

OTHERWISE = "or use another joint (retention.type)"


# --- faults of the file ---------------------------------------------------------------------


def _helical(view: StatedValues) -> list[int]:
    """Indices of the helical layers of the barrel."""
    angles = [
        view.number("barrel", "layup", index, "angle")
        for index in range(len(view.items("barrel", "layup")))
    ]
    return [i for i, angle in enumerate(angles) if angle and 0 < abs(angle) <= HELICAL]


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report a barrel without a helical layer, a flank that sticks, or a wrong shape."""
    helical = _helical(view)
    if len(helical) != 1:
        limit = INPUTS["winding_angle"].text(HELICAL)
        found = "no layer" if not helical else f"{len(helical)} layers"
        yield Fault(
            ("barrel", "layup"),
            f"a cone holds the end by one helical layer, but {found} of the barrel has an angle "
            f"up to {limit} (other than 0)",
            f"state one layer of plies with such an angle, {OTHERWISE}",
            at_key=True,
        )
    text = INPUTS["flank_angle"].text
    for loc in (("retention", "angle"), ("variables", "retention.angle", "lower")):
        angle = view.number(*loc)
        if angle is not None and angle < LEAST_ANGLE * (1 - ROUNDING):
            yield Fault(
                loc,
                f"{text(angle)}: the band sticks on the flank (friction coefficient {FRICTION:g}) "
                "and ratchets under load cycles",
                f"write at least {degrees(LEAST_ANGLE):.1f} deg, twice the angle of friction",
            )
    if len(helical) == 1:
        yield from _shape_faults(view, helical[0])


def _shape_faults(view: StatedValues, band: int) -> Iterator[Fault]:
    """Report a sharp crest, a valley that cuts the plug, and one below the turn of the fibres."""
    layers = ("barrel", "layup")
    thickness = view.number(*layers, band, "thickness")
    radius, depth = (view.number("retention", key) for key in ("crest_radius", "depth"))
    varied = [f"barrel.layup[{i}].thickness" for i in range(band + 1)]
    varied += ["retention.crest_radius", "retention.depth", "retention.wall", "cylinder.bore"]
    varied.append(f"barrel.layup[{band}].angle")
    if any(view.has("variables", path) or view.has("choices", path) for path in varied):
        return
    if radius is not None and thickness is not None:
        least = LEAST_CREST * thickness
        if radius < least * (1 - ROUNDING):
            yield Fault(
                ("retention", "crest_radius"),
                f"{length_text(radius)}: too sharp for a band of {length_text(thickness)}, which "
                f"can be wound over {LEAST_CREST:g} times its thickness",
                f"write at least {length_text(least)}",
            )
    inner = [view.number(*layers, i, "thickness") for i in range(band)]
    bore, wall = view.number("cylinder", "bore"), view.number("retention", "wall")
    angle = view.number(*layers, band, "angle")
    if depth is None or bore is None or wall is None or angle is None or None in inner:
        return
    under = sum(x for x in inner if x is not None)
    if under - depth + wall < LEAST_METAL * (1 - ROUNDING):
        yield Fault(
            ("retention", "depth"),
            f"{length_text(depth)}: the valley leaves less than {length_text(LEAST_METAL)} of the "
            "plug under it",
            f"write at most {length_text(max(under + wall - LEAST_METAL, 0.0))}, or increase "
            "retention.wall",
        )
        return
    crest = bore / 2 + under
    turn = crest * abs(float(namespace(angle).sin(angle)))
    if crest - depth < turn + LEAST_METAL * (1 - ROUNDING):
        yield Fault(
            ("retention", "depth"),
            f"{length_text(depth)}: fibres that cross the crest of {length_text(crest)} radius at "
            f"{INPUTS['winding_angle'].text(abs(angle))} turn back at {length_text(turn)}, before "
            "they are in the valley",
            f"write less than {length_text(max(crest - turn - LEAST_METAL, 0.0))}, or use a "
            "smaller winding angle",
        )


def _material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report a helical layer that is not of plies, and a plug that is not of metal."""
    helical = _helical(view)
    if len(helical) == 1:
        loc = ("barrel", "layup", helical[0], "material")
        name = view.text(*loc)
        kind = None if name is None else materials.kind(name)
        if kind not in ("ply", None):
            yield Fault(
                loc,
                f"{name}: a cone holds the end by a layer of plies, not by a {kind}",
                f"choose a ply material, {OTHERWISE}",
            )
    at = ("caps" if view.has("caps") else "piston", "material")
    name = view.text(*at)
    if name is not None and materials.kind(name) not in ("metal", None):
        yield Fault(at, f"{name}: the plug of a cone needs a metal", f"choose a metal, {OTHERWISE}")


# --- dimensions and mass --------------------------------------------------------------------


class _Trap(NamedTuple):
    """Corners of plug, band and hoop plies in the half-section [m].

    Axial positions are distances outwards from the plate. `bore` is the radius of the plug's bore.
    The band is `thick` on the crest and `piled` in the valley. Corners of its outside are above
    those of the metal, but further out. The hoop plies start at `pack` on the band over the flank,
    at radius `start`, and reach up to radius `top`.
    """

    bore: Array
    valley: Array
    crest: Array
    edge: Array
    foot: Array
    end: Array
    thick: Array
    piled: Array
    outer_edge: Array
    outer_foot: Array
    pack: Array
    start: Array
    top: Array

    @property
    def rise(self) -> Array:
        """Radial length of the band's outside over the flank."""
        return self.crest + self.thick - self.valley - self.piled

    def plug(self) -> list[tuple[Array, Array]]:
        """The plug outside its plate."""
        return [
            (0.0 * self.edge, self.bore),
            (self.end, self.bore),
            (self.end, self.valley),
            (self.foot, self.valley),
            (self.edge, self.crest),
            (0.0 * self.edge, self.crest),
        ]

    def band(self) -> list[tuple[Array, Array]]:
        """The helical plies outside the plate."""
        floor, outside = self.valley + self.piled, self.crest + self.thick
        return [
            (0.0 * self.edge, self.crest),
            (self.edge, self.crest),
            (self.foot, self.valley),
            (self.end, self.valley),
            (self.end, floor),
            (self.outer_foot, floor),
            (self.outer_edge, outside),
            (0.0 * self.edge, outside),
        ]

    def hoops(self) -> list[tuple[Array, Array]]:
        """The hoop plies in the valley."""
        floor = self.valley + self.piled
        return [
            (self.pack, self.start),
            (self.outer_foot, floor),
            (self.end, floor),
            (self.end, self.top),
            (self.pack, self.top),
        ]


def _band(end: End) -> int:
    """Index of the layer that runs over the crest."""
    return next(i for i, layer in enumerate(end.layers) if layer.helical)


def _trap(end: End) -> _Trap:
    """Dimensions of the trap; the result is cached."""
    if "trap" not in end.cache:
        end.cache["trap"] = _dimensions(end)
    trap: _Trap = end.cache["trap"]
    return trap


def _dimensions(end: End) -> _Trap:
    sizes, index = end.sizes, _band(end)
    layer = end.layers[index]
    crest = end.inner_radius + sum(inner.thickness for inner in end.layers[:index])
    depth = sizes["depth"]
    valley = crest - depth
    slope, mitre = tangent(sizes["angle"]), tangent(sizes["angle"] / 2)
    piled = layer.thickness * winding_path.geodesic_thickness_ratio(
        angle=layer.angle, start_radius=crest, radius=valley
    )
    edge = sizes["length"]
    foot = edge + depth / slope
    outer_edge, outer_foot = edge + layer.thickness * mitre, foot + piled * mitre
    floor, rise = valley + piled, depth + layer.thickness - piled
    on_flank = minimum(sizes["hoop_thickness"], rise)
    return _Trap(
        bore=end.inner_radius - sizes["wall"],
        valley=valley,
        crest=crest,
        edge=edge,
        foot=foot,
        end=outer_foot + sizes["hoop_width"],
        thick=layer.thickness,
        piled=piled,
        outer_edge=outer_edge,
        outer_foot=outer_foot,
        pack=outer_foot - on_flank * (outer_foot - outer_edge) / rise,
        start=floor + on_flank,
        top=floor + sizes["hoop_thickness"],
    )


def _fit(end: End) -> EndDimensions:
    trap = _trap(end)
    return EndDimensions(
        plate_radius=end.inner_radius,
        radius=end.inner_radius,
        lip=trap.end,
        beyond=end.plate,
        own=tuple(trap),
    )


def _mass(end: End, materials: MaterialProperties) -> Mapping[str, Array]:
    """Mass of the plug outside its plate, and of band and hoop plies around it."""
    trap, plies = _trap(end), end.layers[_band(end)].material
    wound = mass.turned_volume(profile=trap.band()) + mass.turned_volume(profile=trap.hoops())
    return {
        "caps": materials.get(end.cap, "density") * mass.turned_volume(profile=trap.plug()),
        "barrel": materials.get(plies, "density") * wound,
    }


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    trap, index = _Trap(*fit.own), _band(end)
    plies = end.layers[index].material
    for part, material, profile in (
        ("caps", end.cap, trap.plug()),
        (f"layup[{index}]", plies, trap.band()),
        ("hoop plies of the cone", plies, trap.hoops()),
    ):
        shape = tuple((span.outside - span.inwards * float(x), float(r)) for x, r in profile)
        yield DrawnPart(part, material, shape)


def _notes(end: End) -> Iterator[str]:
    sizes, trap, layer = end.sizes, _trap(end), end.layers[_band(end)]
    inside = winding_path.geodesic_angle(
        angle=layer.angle, start_radius=trap.crest, radius=trap.valley
    )
    yield (
        f"Cone: flank {degrees(sizes['angle']):.4g} deg to the axis, crest and foot rounded with "
        f"radius {1e3 * sizes['crest_radius']:.3g} mm; the fibres reach the valley at "
        f"{degrees(inside):.3g} deg."
    )
    yield (
        "Lay the hoop plies into the valley before cure. The static seal of the plug is in place "
        "during winding and cure, so choose a compound for the temperature of cure."
    )


# --- strength -------------------------------------------------------------------------------


def _ply_strengths(loaded: Loaded) -> tuple[Array, Array, Array] | str:
    """Strength of band and hoop plies: tension along, compression across the fibres, and shear."""
    name = loaded.end.layers[_band(loaded.end)].material
    keys = ("strength_1_tension", "strength_2_compression", "strength_12")
    first, second, third = (loaded.materials.allowable(name, key) for key in keys)
    if first is None or second is None or third is None:
        return f"{name} has no {' or '.join(keys)}"
    return first, second, third


def _hoops(end: End) -> tuple[Array, Array, Array]:
    """Radius, thickness and section of the hoop plies."""
    trap, thickness = _trap(end), end.sizes["hoop_thickness"]
    section = fibre_trap.hoop_section(
        thickness=thickness,
        width=end.sizes["hoop_width"],
        flank_height=trap.rise,
        flank_length=trap.outer_foot - trap.outer_edge,
    )
    return trap.top - thickness / 2, thickness, section


def _moduli(end: End, materials: MaterialProperties) -> tuple[Array, Array]:
    """Moduli of the hoop plies along and across the fibres."""
    name = end.layers[_band(end)].material
    return materials.get(name, "youngs_modulus_1"), materials.get(name, "youngs_modulus_2")


def _reached(end: End, materials: MaterialProperties) -> Array:
    """Section of hoop plies so wide that each of them still helps."""
    trap, (radius, thickness, _) = _trap(end), _hoops(end)
    along, across = _moduli(end, materials)
    return fibre_trap.hoop_section(
        thickness=thickness,
        width=fibre_trap.hoop_reach(
            radius=radius, thickness=thickness, modulus=along, axial_modulus=across
        ),
        flank_height=trap.rise,
        flank_length=trap.outer_foot - trap.outer_edge,
    )


def _give(end: End, materials: MaterialProperties) -> Array:
    """Axial compliance without the help of friction."""
    radius, _, section = _hoops(end)
    return fibre_trap.compliance(
        radius=radius,
        section=section,
        modulus=_moduli(end, materials)[0],
        angle=end.sizes["angle"],
    )


def _neck(loaded: Loaded) -> tuple[Array, Array]:
    """Axial and bending stress of the plug's neck."""
    trap, end = _trap(loaded.end), loaded.end
    stresses: tuple[Array, Array] = fibre_trap.neck_stresses(
        force=loaded.force,
        outer_radius=end.inner_radius,
        wall_thickness=end.sizes["wall"],
        crest_radius=trap.crest,
        valley_radius=trap.valley,
        flank_distance=(trap.edge + trap.foot) / 2,
        angle=end.sizes["angle"],
    )
    return stresses


UNDER = "plug under the trap"
"""Location of the metal that carries the trap."""


def _plug_stresses(loaded: Loaded) -> dict[str, Array]:
    """Stress at both faces of the plug: axial, bending and hoop stress, added without signs.

    At the face that bending relieves, at most half of the axial stress is taken off; this face
    never governs.
    """
    trap = _trap(loaded.end)
    axial, bending = _neck(loaded)
    height = trap.crest - trap.valley
    ring = (
        (trap.valley - trap.bore) * trap.end
        + height * trap.edge
        + height * (trap.foot - trap.edge) / 2
    )
    hoop = fibre_trap.hoop_force(force=loaded.force, angle=loaded.end.sizes["angle"]) / ring
    return {
        f"{UNDER}, outside": axial + maximum(bending, -axial / 2) + hoop,
        f"{UNDER}, bore": axial + maximum(-bending, -axial / 2) + hoop,
    }


def _layer_edge(loaded: Loaded) -> WindingEdge | str | None:
    """The end of the inner layers, whose force passes into the band there.

    None if the band is the innermost layer; or the reason why it is unknown. The band has the part
    of a liner in the model, as it carries the whole force at the end.
    """
    end, materials, index = loaded.end, loaded.materials, _band(loaded.end)
    if not index:
        return None
    if not loaded.shells:
        return "an elastic constant of a layer is unknown"
    plies = tuple(
        x.material for x in end.layers[: index + 1] if materials.kind(x.material) == "ply"
    )
    if any(materials.allowable(name, "strength_12") is None for name in plies):
        return f"{' or '.join(plies)} has no strength_12"
    start, expansions = end.inner_radius, []
    along: list[Array] = []
    for layer, shell in zip(end.layers, loaded.shells, strict=True):
        modulus = shell.axial - shell.coupling * shell.coupling / shell.hoop
        along.append(modulus * shell.thickness * (start + shell.thickness / 2))
        start = start + shell.thickness
        expansions.append(materials.get(layer.material, "thermal_expansion", "thermal_expansion_2"))
    interface = _trap(end).crest
    inner, band = sum(along[:index]) / interface, along[index] / interface
    mismatch: Array = None
    if loaded.expansion is not None and all(x is not None for x in expansions[:index]):
        pairs = zip(along[:index], expansions[:index], strict=True)
        of_inner = sum(stiffness * x for stiffness, x in pairs) / (inner * interface)
        mismatch = (loaded.expansion - of_inner) * (inner + band) / band
    thickness = sum(shell.thickness for shell in loaded.shells[:index])
    give = sum(shell.thickness / shell.shear for shell in loaded.shells[:index])
    return WindingEdge(
        materials=materials,
        plies=plies,
        line_force=loaded.force / (2 * pi * interface),
        mismatch=mismatch,
        stiffness={
            "interface_stiffness": liner_transfer.interface_stiffness(
                liner_thickness=loaded.shells[index].thickness,
                liner_shear_modulus=loaded.shells[index].shear,
                winding_thickness=thickness,
                winding_shear_modulus=thickness / give,
            ),
            "liner_stiffness": band,
            "winding_stiffness": inner,
        },
    )


def _strength(loaded: Loaded) -> Strength | str:
    end, force = loaded.end, loaded.force
    plies, metals = _ply_strengths(loaded), metal_strengths(loaded.materials, end.cap)
    edge = _layer_edge(loaded)
    for reason in (plies, metals, edge):
        if isinstance(reason, str):
            return reason
    assert not isinstance(plies, str)
    assert not isinstance(metals, str)
    (fibre, across, along), ((plug, plug_ultimate),) = plies, metals
    trap, angle, radius = _trap(end), end.sizes["angle"], end.sizes["crest_radius"]
    line_force = force / (2 * pi * (trap.crest + trap.thick / 2))
    shear = fibre_trap.crest_shear(force=force, valley_radius=trap.valley, length=trap.foot)
    tension = fibre_trap.hoop_force(force=force, angle=angle) * PEAK
    band = fibre_trap.band_stress(
        line_force=line_force, thickness=trap.thick, angle=end.layers[_band(end)].angle
    ) * fibre_trap.crest_factor(thickness=trap.thick, crest_radius=radius)
    axial, bending = _neck(loaded)
    flank = fibre_trap.flank_pressure(
        force=force, crest_radius=trap.crest, valley_radius=trap.valley, angle=angle
    )
    working = {
        "plies on the flank": across / flank,
        "plies on the crest": across
        / fibre_trap.crest_pressure(line_force=line_force, crest_radius=radius, angle=angle),
        "crest in shear": plug / sqrt(3) / shear,
    }
    burst = {
        "band over the crest": fibre / band,
        "hoop plies": fibre * _hoops(end)[2] / tension,
        "hoop plies within their reach": fibre * _reached(end, loaded.materials) / tension,
        "hoop plies sliding off the flank": along
        / fibre_trap.flank_shear(pressure=flank, angle=angle),
        "crest in shear": plug_ultimate / sqrt(3) / shear,
        f"{UNDER}, outside": retaining_ring.collapse_factor(
            axial=axial, bending=bending, strength=plug_ultimate
        ),
        f"{UNDER}, bore": retaining_ring.collapse_factor(
            axial=axial, bending=-bending, strength=plug_ultimate
        ),
        **behind_seal(loaded, trap.bore),
    }
    if edge is None:
        return Strength(working, burst, "the band is the innermost layer")
    assert not isinstance(edge, str)
    thermal = _since_cure(edge.thermal(), loaded.since_cure)
    return Strength({**working, LAYER_EDGE: edge.factor()}, burst, thermal)


def _since_cure(thermal: Thermal | str, changes: tuple[Array, ...]) -> Thermal | str:
    """The thermal strength of plies that are cured in place: free of stress at cure, if known."""
    if isinstance(thermal, str) or not changes:
        return thermal
    return lambda warming, cold: thermal(changes[0 if cold else -1], cold)


def _yields(loaded: Loaded) -> Mapping[str, Array]:
    strength = loaded.materials.allowable(loaded.end.cap, "yield_strength")
    if strength is None:
        return {}
    return {place: strength / stress for place, stress in _plug_stresses(loaded).items()}


def _fatigue(loaded: Loaded) -> Fatigue:
    """Stress of the plug under pulsating force; its fillet is taken as the root of a groove."""
    name = loaded.end.cap
    notch = notch_factor(loaded.materials, name, NOTCH, NOTCH_HARD)
    return Fatigue(
        tuple(
            Pulsed(place, name, notch * stress, stress / 2)
            for place, stress in _plug_stresses(loaded).items()
        )
    )


def _own(loaded: Loaded) -> dict[str, Array]:
    """Lengths and walls that remain [m], relative radius of the crest, and grip of the valley.

    The arcs of crest and foot take a part of crest and flank.
    """
    end, trap, sizes = loaded.end, _trap(loaded.end), loaded.end.sizes
    layer, angle = end.layers[_band(end)], sizes["angle"]
    arc, depth = sizes["crest_radius"] * tangent(angle / 2), trap.crest - trap.valley
    radius, _, section = _hoops(end)
    give = fibre_trap.radial_give(
        hoop_force=fibre_trap.hoop_force(force=loaded.force, angle=angle),
        radius=radius,
        section=section,
        modulus=_moduli(end, loaded.materials)[0],
    )
    turned = maximum(layer.angle, -layer.angle)
    return {
        LENGTHS: {
            "crest": trap.edge - arc,
            "flank": depth / namespace(angle).sin(angle) - 2 * arc,
            "metal under the valley": trap.valley - trap.bore,
            "neck under the groove of the seal": sizes["wall"] - end.seal_depth,
            "opening beside the rod": trap.bore - end.rod_radius,
            "valley above the turn of the fibres": trap.valley
            - trap.crest * namespace(turned).sin(turned),
        },
        CREST: sizes["crest_radius"] / trap.thick,
        GRIP: depth / give,
    }


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    """Warn of a trap that is too small or gives too much, and of its play when cold."""
    own = _own(loaded)
    for place, length in own[LENGTHS].items():
        for metric, sentence in too_thin({LENGTHS: length}, quantities):
            yield metric, f"{sentence} ({place})"
    for name, least in ((CREST, LEAST_CREST), (GRIP, LEAST_GRIP)):
        value = float(np.min(np.real(own[name])))
        if value < least * (1 - ROUNDING):
            yield (
                "retention_factor",
                f"{quantities[name].label}: {value:.3g}, but {least:g} is needed",
            )
    yield from _cooling(loaded)


def _cooling(loaded: Loaded) -> Iterator[tuple[str, str]]:
    """Warn of the axial play that cooling causes, as the hoop plies do not follow the metal."""
    end, materials = loaded.end, loaded.materials
    metal = materials.get(end.cap, "thermal_expansion")
    hoop = materials.get(end.layers[_band(end)].material, "thermal_expansion_1")
    if metal is None or hoop is None or not loaded.since_cure:
        return
    play = fibre_trap.cooling_play(
        expansion_difference=metal - hoop,
        cooling=-loaded.since_cure[0],
        radius=_trap(end).crest,
        angle=end.sizes["angle"],
    )
    most = float(np.max(np.real(play)))
    yield (
        "retention_factor",
        f"cooling from cure loosens the cone by {length_text(most)} axially: fill the valley with "
        "resin or preload it, and test it for fretting",
    )


_ABSENT = "no fibres over a cone"

JOINT = Joint(
    name="cone",
    help="plugs under the winding, each held by helical plies over a cone and hoop plies around it",
    noun="a cone",
    fields=(
        JointField("length"),
        JointField("wall"),
        JointField(
            "angle",
            "missing: required by a cone",
            'add e.g. "angle: 45 deg"',
            quantity="flank_angle",
            help="angle of the flank to the axis, on which the band holds the plug",
        ),
        JointField(
            "depth",
            "missing: required by a cone",
            'add e.g. "depth: 2 mm"',
            quantity="groove_depth",
            help="radial depth of the valley under the crest",
        ),
        JointField(
            "crest_radius",
            "missing: required by a cone",
            'add e.g. "crest_radius: 3 mm"',
            quantity="part_length",
            help="radius of the crest over which the band bends",
        ),
        JointField(
            "hoop_thickness",
            "missing: required by a cone",
            'add e.g. "hoop_thickness: 2 mm"',
            quantity="wall_thickness",
            help="radial thickness of the hoop plies on the floor of the valley",
        ),
        JointField(
            "hoop_width",
            "missing: required by a cone",
            'add e.g. "hoop_width: 3 mm"',
            quantity="ring_width",
            help="axial width of the hoop plies on the floor of the valley",
        ),
    ),
    kinds=(),
    without={
        "material": (
            "has no effect on a cone, whose hoop plies are of the material of the helical layer",
            "remove the line; change barrel.layup or caps.material",
        )
    },
    faults=_faults,
    material_faults=_material_faults,
    opening=lambda _: BarrelOpening("never", "Wind the barrel over the plug of the {end}."),
    form="wound",
    fit=_fit,
    clamping=None,
    give=_give,
    mass=_mass,
    outline=_outline,
    notes=_notes,
    strength=_strength,
    yields=_yields,
    wall=lambda loaded: WallPressures(),
    beside=None,
    fatigue=_fatigue,
    own=_own,
    envelope=None,
    metrics=dict.fromkeys((LENGTHS, CREST, GRIP), _ABSENT),
    judged=("first damage of plies", "rupture of plies"),
    models={
        ("retention_factor", "plies on the flank"): "fibre_trap.flank_pressure",
        ("retention_factor", "plies on the crest"): "fibre_trap.crest_pressure",
        ("retention_factor", "crest in shear"): "fibre_trap.crest_shear",
        ("retention_factor", LAYER_EDGE): "liner_transfer.edge_shear",
        ("retention_burst_factor", "band over the crest"): "fibre_trap.band_stress",
        ("retention_burst_factor", "hoop plies"): "fibre_trap.hoop_force",
        ("retention_burst_factor", "hoop plies within their reach"): "fibre_trap.hoop_reach",
        ("retention_burst_factor", "hoop plies sliding off the flank"): "fibre_trap.flank_shear",
        ("retention_burst_factor", "crest in shear"): "fibre_trap.crest_shear",
        ("retention_burst_factor", f"{UNDER}, bore"): "retaining_ring.collapse_factor",
        ("retention_burst_factor", f"{UNDER}, outside"): "retaining_ring.collapse_factor",
        ("yield_factor", f"{UNDER}, bore"): "fibre_trap.neck_stresses",
        ("yield_factor", f"{UNDER}, outside"): "fibre_trap.neck_stresses",
    },
    usual=(),
    warnings=_warnings,
)
