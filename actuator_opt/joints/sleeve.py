"""Metal sleeves under the ends of the winding; a joint in metal is cut into them.

The winding runs over the sleeve and ends outside the plug, or at the skirt of a screwed cap. There,
the sleeve alone carries the force. At its tip, it is conical, which lifts the winding.

- A sleeve of another metal than the innermost layer needs a barrel of plies. They pass the whole
  force to the sleeve by shear, which has a peak at both edges.
- A sleeve of the metal of the innermost layer is one piece with it: a liner thickened at its end.
  The end of the winding then has the same shear as on a plain liner.

A sleeve is a block `sleeve` of the joints in metal, and not a joint with a second joint in a block
`then`. Keys, choices, faults, form and rows of those joints hold without change: `in_sleeve`
replaces the layers that a joint sees by the sleeve, and adds the rows of sleeve and winding. A
second joint of its own would need another level in the design file, in its choices and faults, and
each place that asks for the form of a joint would have to ask two.

The row of bending at the end of the winding leaves out residual stresses of cure and autofrettage.
The plug in the sleeve, which would stiffen it, is ignored.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from math import pi

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Fault
from ..base.numeric import Array, absolute, maximum
from ..base.quantities import Quantity, length_text
from ..models import end_bending, lap_joint, liner_transfer, mass
from ..models.barrel import von_mises
from ..models.retaining_ring import collapse_factor
from ..models.strength_modes import load_multiplier
from .joint import (
    ROUNDING,
    BarrelLayer,
    DrawnPart,
    EdgeBeside,
    End,
    EndDimensions,
    EndSpan,
    Fatigue,
    Joint,
    KnownMaterials,
    Loaded,
    MaterialProperties,
    Pulsed,
    SleeveFit,
    StatedValues,
    Strength,
    judged_later,
)
from .overlap import metal_shell
from .winding import WINDING_EDGE, WindingEdge, winding_edge

KEY = "sleeve"
"""Block of `retention` with the keys of the sleeve."""

RAMP = 5.0
"""Length of the conical tip of a sleeve, divided by the lift of the winding. Our choice: a slope of
11 degrees, which hoop plies do not slide down."""

HOOP = 1.309
"""Winding angle from which plies carry no axial force to a sleeve, 75 degrees [rad]. Our choice:
beyond it, the axial modulus of carbon plies is below 1.1 times that across the fibres."""

INNER = f"{WINDING_EDGE}, inside"
OUTER = f"{WINDING_EDGE}, outside"
BARE = "sleeve at the end of the winding"
BESIDE = "beside the sleeve"
"""End of the names of rows where the barrel leaves a sleeve and bends."""


# --- faults of the file ---------------------------------------------------------------------


_WALL, _INNER = ("retention", KEY, "wall"), ("retention", KEY, "inner_length")
_LINER = ("barrel", "layup", 0)


def _one_piece(view: StatedValues) -> bool:
    """Whether the sleeve is of the metal of the innermost layer."""
    return view.text("retention", KEY, "material") == view.text(*_LINER, "material")


def faults(view: StatedValues) -> Iterator[Fault]:
    """Report a sleeve that is thinner than the liner, or whose conical tip is too long."""
    wall, inner = view.number(*_WALL), view.number(*_INNER)
    liner = view.number(*_LINER, "thickness") if _one_piece(view) else 0.0
    varied = ("retention.sleeve.wall", "retention.sleeve.inner_length", "barrel.layup[0].thickness")
    if wall is None or inner is None or liner is None or judged_later(view, varied):
        return
    ramp = RAMP * (wall - liner)
    if ramp < 0:
        yield Fault(
            _WALL,
            f"{length_text(wall)}: thinner than the liner of {length_text(liner)} that it thickens",
            f"write at least {length_text(liner)}, or remove the block {KEY}",
        )
    elif ramp > inner * (1 + ROUNDING):
        yield Fault(
            _WALL,
            f"{length_text(wall)}: the conical tip, {length_text(ramp)} long, does not fit under "
            f"the winding, which covers {length_text(inner)} (inner_length)",
            f"write at most {length_text(liner + inner / RAMP)}, or a larger inner_length",
        )


def material_faults(view: StatedValues, materials: KnownMaterials) -> Iterator[Fault]:
    """Report a sleeve without a winding that could hold it."""
    loc = ("retention", KEY, "material")
    name, liner = view.text(*loc), view.text(*_LINER, "material")
    kind, inside = (None if one is None else materials.kind(one) for one in (name, liner))
    if name is None or kind is None or inside is None:
        return
    names = (
        view.text("barrel", "layup", layer, "material")
        for layer in range(len(view.items("barrel", "layup")))
    )
    plies = [i for i, one in enumerate(names) if one and materials.kind(one) == "ply"]
    if kind != "metal":
        return  # the joint in the sleeve reports it
    if not plies:
        yield Fault(
            ("retention", KEY),
            "without effect: no winding runs over the sleeve, as the barrel has no plies",
            "remove the block, or add plies to barrel.layup",
            at_key=True,
        )
    elif name == liner:
        return
    elif inside != "ply":
        yield Fault(
            loc,
            f"{name}: the innermost layer is of {liner}, to which this sleeve cannot be one piece",
            f"write {liner}, or remove barrel.layup[0] if the plies are tight without it",
        )
    elif all(_only_hoop(view, layer) for layer in plies):
        yield Fault(
            loc,
            f"{name}: all plies are hoop plies, which pass no axial force to the sleeve",
            "add a layer at a smaller angle to barrel.layup, or a liner of the sleeve's metal",
        )


def _only_hoop(view: StatedValues, layer: int) -> bool:
    angle = view.number("barrel", "layup", layer, "angle")
    free = view.has("variables", f"barrel.layup[{layer}].angle")
    return angle is not None and not free and abs(angle) >= HOOP


# --- dimensions and mass --------------------------------------------------------------------


def _merged(end: End) -> bool:
    """Whether liner and sleeve are one piece."""
    return end.sleeve == end.layers[0].material


def _layer(end: End) -> BarrelLayer:
    assert end.sleeve is not None
    return BarrelLayer(end.sleeve, end.sizes[f"{KEY}.wall"])


def _tip(end: End) -> Array:
    """Thickness of the tip of the sleeve: that of the liner, or a feather edge."""
    return end.layers[0].thickness if _merged(end) else 0.0


def inside(end: End) -> End:
    """The end as the joint in the sleeve has it: the sleeve is its only layer."""
    if "inside" not in end.cache:
        layer = _layer(end)
        end.cache["inside"] = replace(
            end, layers=(layer,), outer_radius=end.inner_radius + layer.thickness, sleeve=None
        )
    result: End = end.cache["inside"]
    return result


def _fit(joint: Joint, end: End) -> EndDimensions:
    fit = joint.fit(inside(end))
    lift = end.sizes[f"{KEY}.wall"] - _tip(end)
    return replace(
        fit,
        sleeve=SleeveFit(
            bare=fit.lip if joint.form == "plugs" else fit.length,
            inner=end.sizes[f"{KEY}.inner_length"],
            ramp=RAMP * lift,
            lift=lift,
            liner=_merged(end),
        ),
    )


def _mass(joint: Joint, end: End, materials: MaterialProperties) -> Mapping[str, Array]:
    """Mass of the sleeve, and of the lifted winding, less that of what the barrel lacks there."""
    fit = _fit(joint, end).sleeve
    assert fit is not None
    assert end.sleeve is not None
    length, tip = fit.bare + fit.inner, end.inner_radius + _tip(end)
    added = materials.get(end.sleeve, "density") * mass.tapered_ring_volume(
        inner_radius=end.inner_radius,
        tip_radius=tip,
        outer_radius=tip + fit.lift,
        length=length,
        taper_length=fit.ramp,
    )
    radius = end.inner_radius
    for index, layer in enumerate(end.layers):
        density = materials.get(layer.material, "density")
        area = mass.layer_area(inner_radius=radius, thickness=layer.thickness)
        if index == 0 and fit.liner:
            added = added - density * area * length
        else:
            lifted = 2 * pi * layer.thickness * fit.lift * (fit.inner - fit.ramp / 2)
            added = added + density * (lifted - area * fit.bare)
        radius = radius + layer.thickness
    masses = dict(joint.mass(inside(end), materials))
    return masses | {"barrel": masses.get("barrel", 0.0) + added}


def _outline(joint: Joint, end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    yield from joint.outline(inside(end), fit, span)
    assert fit.sleeve is not None
    assert end.sleeve is not None
    bore, last = float(end.inner_radius), float(fit.beyond)
    tip = last - float(fit.sleeve.bare + fit.sleeve.inner)
    low = bore + float(_tip(end))
    high = low + float(fit.sleeve.lift)
    edge = [(tip, bore), (tip, low), (tip + float(fit.sleeve.ramp), high)]
    turned, step = float(fit.radius), last - float(fit.length)
    if float(fit.length) > 0 and turned < high:
        edge += [(step, high), (step, turned), (last, turned)]
    else:
        edge += [(last, high)]
    edge += [(last, bore)]
    if fit.groove:
        near, width, depth = (float(size) for size in fit.groove)
        far, floor = near + width, bore + depth
        edge += [(far, bore), (far, floor), (near, floor), (near, bore)]
    corners = (corner for index, corner in enumerate(edge) if corner not in edge[:index])
    shape = tuple((span.face - span.inwards * place, radius) for place, radius in corners)
    yield DrawnPart("sleeves", end.sleeve, shape)


def _notes(joint: Joint, end: End) -> Iterator[str]:
    yield from joint.notes(inside(end))
    wall, inner = (1e3 * end.sizes[f"{KEY}.{key}"] for key in ("wall", "inner_length"))
    piece = (
        "one piece with the liner"
        if _merged(end)
        else "roughened before winding, the bore finished after it: the tip leaves a seam"
    )
    yield (
        f"Sleeve of {end.sleeve}, {wall:.3g} mm thick, {inner:.4g} mm of it under the winding, "
        f"{piece}; conical tip 1:{RAMP:g}."
    )


# --- strength -------------------------------------------------------------------------------


def _inside(loaded: Loaded) -> Loaded:
    """The load as the joint in the sleeve has it."""
    end = inside(loaded.end)
    layer = _shell(loaded)
    return replace(loaded, end=end, shells=() if layer is None else (layer,))


def _shell(loaded: Loaded) -> end_bending.ShellLayer | None:
    """Stiffness of the sleeve against bending; None if an elastic constant is unknown."""
    layer = _layer(loaded.end)
    return metal_shell(loaded.materials, layer.material, layer.thickness)


def _edge(loaded: Loaded) -> WindingEdge | str | None:
    """The end of the winding on the sleeve; the result is cached."""
    if "winding" not in loaded.end.cache:
        liners = 1 if _merged(loaded.end) else 0
        loaded.end.cache["winding"] = winding_edge(loaded, _layer(loaded.end), liners=liners)
    edge: WindingEdge | str | None = loaded.end.cache["winding"]
    return edge


@dataclass(frozen=True, slots=True)
class _Overlap:
    """Overlap of a winding and a sleeve that is not one piece with the liner.

    `length` is the overlap without the conical tip, which lowers the shear at the inner edge and is
    ignored.
    """

    edge: WindingEdge
    length: Array

    def _common(self) -> dict[str, Array]:
        return {
            "length": self.length,
            "shear_modulus": self.edge.stiffness["interface_stiffness"],
            "bond_thickness": 1.0,  # [m]; only the ratio of both counts
        }

    def factors(self) -> dict[str, Array]:
        """Shear strength of the plies divided by the shear that the force causes, at both edges."""
        sleeve, winding = (
            self.edge.stiffness[f"{wall}_stiffness"] for wall in ("liner", "winding")
        )
        return {
            place: self.edge.strength()
            / lap_joint.bond_edge_shear(
                force=self.edge.line_force,
                diameter=1 / pi,  # [m]: the force is per circumference
                membrane_stiffness_loaded=carrying,
                membrane_stiffness_free=ending,
                **self._common(),
            )
            for place, carrying, ending in ((OUTER, sleeve, winding), (INNER, winding, sleeve))
        }

    def thermal_factor(self, warming: Array, cold: bool) -> Array:
        """Shear strength of the plies divided by the shear of a temperature change [K]."""
        shear = lap_joint.bond_thermal_shear(
            strain_difference=self.edge.mismatch * warming,
            membrane_stiffness_1=self.edge.stiffness["liner_stiffness"],
            membrane_stiffness_2=self.edge.stiffness["winding_stiffness"],
            **self._common(),
        )
        return load_multiplier(absolute(shear) / self.edge.strength(cold=cold))


def _overlap(end: End, edge: WindingEdge) -> _Overlap:
    lift = end.sizes[f"{KEY}.wall"] - _tip(end)
    return _Overlap(edge, end.sizes[f"{KEY}.inner_length"] - RAMP * lift)


def _strength(joint: Joint, loaded: Loaded) -> Strength | str:
    strength, edge = joint.strength(_inside(loaded)), _edge(loaded)
    if isinstance(strength, str) or edge is None:
        return strength
    if isinstance(edge, str):
        return edge
    bends = _bends(joint, loaded)
    if isinstance(bends, str):
        return bends
    if _merged(loaded.end):
        factors, thermal = {OUTER: edge.factor()}, edge.thermal()
    else:
        overlap = _overlap(loaded.end, edge)
        factors, thermal = overlap.factors(), edge.thermal()
        if not isinstance(thermal, str):
            thermal = overlap.thermal_factor
    ultimate = loaded.materials.allowable(_layer(loaded.end).material, "ultimate_strength")
    collapse = collapse_factor(
        axial=bends.axial, bending=absolute(bends.bending), strength=ultimate
    )
    return Strength(
        {**strength.working, **factors},
        {**strength.burst, BARE: collapse},
        thermal,
        cured=True,
    )


@dataclass(frozen=True, slots=True)
class _Bends:
    """Stresses of the sleeve at the end of the winding [Pa].

    `axial` and `bending` are along the sleeve, `equivalent` is the equivalent stress.
    """

    axial: Array
    bending: Array
    equivalent: Array


def _bends(joint: Joint, loaded: Loaded) -> _Bends | str:
    """The stresses, or the reason why they are unknown; the result is cached."""
    if "bends" not in loaded.end.cache:
        loaded.end.cache["bends"] = _bent(joint, loaded)
    bends: _Bends | str = loaded.end.cache["bends"]
    return bends


def _wound(loaded: Loaded) -> end_bending.Shell | None:
    """The sleeve under the winding, as a shell; None if an elastic constant is unknown."""
    sleeve = _shell(loaded)
    if not loaded.shells or sleeve is None:
        return None
    liners = 1 if _merged(loaded.end) else 0
    return end_bending.shell(
        layers=(sleeve, *loaded.shells[liners:]), inner_radius=loaded.end.inner_radius
    )


def _bent(joint: Joint, loaded: Loaded) -> _Bends | str:
    wound, sleeve = _wound(loaded), _shell(loaded)
    if wound is None or sleeve is None:
        return "an elastic constant of barrel or sleeve is unknown"
    bare = end_bending.shell(layers=(sleeve,), inner_radius=loaded.end.inner_radius)
    pressure = 0.0 if joint.form == "plugs" else loaded.pressure  # a plug's seal is further inside
    edge, _ = _step(loaded, wound, bare, pressure)
    inner, outer = end_bending.edge_stresses(
        layer=sleeve, start=0.0, wall=bare, edge=edge, line_force=_line(loaded, bare)
    )
    return _Bends(
        axial=(inner[0] + outer[0]) / 2,
        bending=(inner[0] - outer[0]) / 2,
        equivalent=maximum(
            von_mises(hoop=inner[1], radial=-pressure, axial=inner[0]),
            von_mises(hoop=outer[1], radial=0.0, axial=outer[0]),
        ),
    )


def edge_beside(loaded: Loaded) -> EdgeBeside | None:
    """The edge of the barrel beside a sleeve; None if an elastic constant is unknown.

    The conical tip counts with the full wall of the sleeve, as a sharp step. The metal of a
    thickened liner has the stress of the wall far from it, times `thickened_end_peak`.
    """
    if "edge beside" not in loaded.end.cache:
        loaded.end.cache["edge beside"] = _edge_beside(loaded)
    edge: EdgeBeside | None = loaded.end.cache["edge beside"]
    return edge


def _edge_beside(loaded: Loaded) -> EdgeBeside | None:
    wound = _wound(loaded)
    if wound is None:
        return None
    barrel = end_bending.shell(layers=loaded.shells, inner_radius=loaded.end.inner_radius)
    edge, growth = _step(loaded, wound, barrel, loaded.pressure)
    end, peak = loaded.end, None
    if _merged(end):
        peak = end_bending.thickened_end_peak(
            length=end.sizes["length"] + end.sizes[f"{KEY}.inner_length"],
            radius=end.inner_radius,
            thickness=end.sizes[f"{KEY}.wall"] + sum(layer.thickness for layer in end.layers[1:]),
        )
    return EdgeBeside(BESIDE, barrel, edge, growth, peak)


def _line(loaded: Loaded, wall: end_bending.Shell) -> Array:
    """The force per circumference of a wall [N/m]."""
    return loaded.force / (2 * pi * wall.radius)


def _step(
    loaded: Loaded, wound: end_bending.Shell, beside: end_bending.Shell, pressure: Array
) -> tuple[end_bending.Edge, Array]:
    """The edge of the wall beside the wound sleeve, and its growth far from there."""
    left, right = (
        end_bending.free_growth(
            wall=wall,
            pressure=pressure,
            bore_radius=loaded.end.inner_radius,
            line_force=_line(loaded, wall),
        )
        for wall in (wound, beside)
    )
    edge = end_bending.stepped(
        left=wound,
        right=beside,
        left_growth=left,
        right_growth=right,
        offset_moment=_line(loaded, beside) * (beside.centre - wound.centre),
    )
    return edge, right


def _yields(joint: Joint, loaded: Loaded) -> Mapping[str, Array]:
    rows, bends = dict(joint.yields(_inside(loaded))), _bends(joint, loaded)
    strength = loaded.materials.allowable(_layer(loaded.end).material, "yield_strength")
    if isinstance(bends, str) or strength is None:
        return rows
    return rows | {BARE: strength / bends.equivalent}


def _fatigue(joint: Joint, loaded: Loaded) -> Fatigue:
    fatigue, bends = joint.fatigue(_inside(loaded)), _bends(joint, loaded)
    if isinstance(bends, str):
        return fatigue
    stress = bends.equivalent
    row = Pulsed(BARE, _layer(loaded.end).material, stress, stress / 2)
    return Fatigue((*fatigue.pulsed, row), fatigue.lives)


def _warnings(
    joint: Joint, loaded: Loaded, quantities: Mapping[str, Quantity]
) -> Iterator[tuple[str, str]]:
    """Warn of a winding too thick for its liner, and of a short overlap, where both shears meet."""
    yield from joint.warnings(_inside(loaded), quantities)
    liner, *winding = (layer.thickness for layer in loaded.end.layers)
    most = float(np.max(np.real(sum(winding) / liner)))
    if _merged(loaded.end) and most > end_bending.MOST_WINDING:
        yield (
            "yield_factor",
            f"the winding is {most:.3g} times as thick as the liner: the stress of the liner "
            f"{BESIDE} is known up to {end_bending.MOST_WINDING:g} times",
        )
    edge = _edge(loaded)
    if _merged(loaded.end) or not isinstance(edge, WindingEdge):
        return
    needed = liner_transfer.fading_length(**edge.stiffness)
    least = float(np.max(np.real(needed)))
    length = float(np.min(np.real(loaded.end.sizes[f"{KEY}.inner_length"])))
    if length < least * (1 - ROUNDING):
        yield (
            "retention_factor",
            f"the winding covers {length_text(length)} of the sleeve (inner_length), but the shear "
            f"of both edges needs {length_text(least)} to fade (6/lambda): it has no middle part "
            "of low stress, which keeps a bond from creeping",
        )


@cache
def in_sleeve(joint: Joint) -> Joint:
    """A joint that is cut into a sleeve, with the rows of sleeve and winding."""
    return replace(
        joint,
        fit=partial(_fit, joint),
        mass=partial(_mass, joint),
        outline=partial(_outline, joint),
        notes=partial(_notes, joint),
        strength=partial(_strength, joint),
        yields=partial(_yields, joint),
        wall=lambda loaded: joint.wall(_inside(loaded)),
        beside=edge_beside,
        fatigue=partial(_fatigue, joint),
        own=lambda loaded: joint.own(_inside(loaded)),
        models={**joint.models, **MODELS},
        warnings=partial(_warnings, joint),
    )


MODELS = {
    ("retention_factor", OUTER): "lap_joint.bond_edge_shear",
    ("retention_factor", INNER): "lap_joint.bond_edge_shear",
    ("retention_burst_factor", BARE): "retaining_ring.collapse_factor",
    ("yield_factor", BARE): "end_bending.stepped",
}
"""Main models of the rows, as in `Joint.models`."""
