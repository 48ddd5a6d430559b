"""Tie rods outside the barrel that clamp it between cap and head."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import asin, pi, sin, sqrt

import numpy as np

from ..base.errors import Fault
from ..base.numeric import Array, minimum
from ..base.quantities import Quantity, length_text
from ..models import endurance, mass, piston_nut, retention
from .joint import (
    NOT_BONDED,
    ON_METAL,
    BarrelOpening,
    Clamp,
    Clamping,
    DrawnPart,
    End,
    EndDimensions,
    EndSpan,
    Fatigue,
    Joint,
    JointField,
    Life,
    Loaded,
    MaterialProperties,
    StatedValues,
    Strength,
    WallPressures,
    nothing,
)


def _spacing(outer_radius: float, diameter: float, count: float) -> tuple[float, float]:
    """Distance of neighbouring tie rods, and width of their nuts over the corners [m].

    The pitch circle has the radius R + d. Nuts that are closer together than their width meet.
    """
    pitch_radius = outer_radius + diameter
    return 2 * pitch_radius * sin(pi / count), 2 * piston_nut.corner_radius(diameter=diameter)


def _faults(view: StatedValues) -> Iterator[Fault]:
    """Report tie rods without preload, and nuts that meet; for variables, a warning names these."""
    if view.number("retention", "preload") == 0 and not view.has("variables", "retention.preload"):
        yield Fault(
            ("retention", "preload"),
            "0: nothing closes the joint between barrel and caps",
            'write e.g. "preload: 20 kN", or remove the line, and a preload is assumed',
        )
    layers = range(len(view.items("barrel", "layup")))
    paths = [f"barrel.layup[{index}].thickness" for index in layers]
    paths += ["cylinder.bore", "retention.thread.diameter", "retention.count"]
    numbers = [view.number("barrel", "layup", index, "thickness") for index in layers]
    numbers += [view.number("cylinder", "bore"), view.number("retention", "thread", "diameter")]
    count, known = view.number("retention", "count"), [x for x in numbers if x is not None]
    if count is None or len(known) < len(numbers) or any(view.has("variables", x) for x in paths):
        return
    *thicknesses, bore, diameter = known
    radius = bore / 2 + sum(thicknesses)
    distance, nut = _spacing(radius, diameter, count)
    if distance < nut:
        most = int(pi / asin(nut / 2 / (radius + diameter)))
        yield Fault(
            ("retention", "count"),
            f"{count:.0f}: {_meeting(distance, nut)}",
            f"write at most {most}, or a smaller thread.diameter",
        )


def _meeting(distance: float, nut: float) -> str:
    return (
        f"the nuts of the tie rods meet: they are {length_text(nut)} wide over the corners, and "
        f"{length_text(distance)} apart"
    )


def _fit(end: End) -> EndDimensions:
    """Dimensions of the end plates, which exceed the barrel by two tie-rod diameters all round."""
    radius = end.outer_radius
    return EndDimensions(plate_radius=radius + 2 * end.sizes["thread.diameter"], radius=radius)


def _length(end: End) -> Array:
    """Length of the tie rods between the outer faces of the plates."""
    return end.barrel_length + 2 * end.plate


def _clamping(end: End, materials: MaterialProperties) -> Clamping:
    """Stiffness n E (pi d^2/4)/L of n tie rods of diameter d and length L; growth alpha L."""
    assert end.material is not None
    modulus = materials.get(end.material, "youngs_modulus")
    diameter = end.sizes["thread.diameter"]
    stiffness = end.sizes["count"] * modulus * pi * diameter * diameter / 4 / _length(end)
    expansion = materials.get(end.material, "thermal_expansion")
    growth = None if expansion is None else expansion * _length(end)
    factor = end.sizes.get("tightening_factor", piston_nut.TIGHTENING)
    return Clamping(stiffness, growth, factor)


def _mass(end: End, materials: MaterialProperties) -> dict[str, Array]:
    """Mass of this end's nuts, and half the mass of all tie rods, which end with their nuts."""
    assert end.material is not None
    diameter, count = end.sizes["thread.diameter"], end.sizes["count"]
    density = materials.get(end.material, "density")
    rods = mass.tie_rod_mass(
        density=density,
        diameter=diameter,
        length=_length(end) + 2 * piston_nut.HEIGHT * diameter,
        count=count,
    )
    nuts = count * density * piston_nut.nut_volume(diameter=diameter)
    return {"fastening": rods / 2 + nuts}


def _outline(end: End, fit: EndDimensions, span: EndSpan) -> Iterator[DrawnPart]:
    """Outline of one tie rod in the section plane, with a nut on the outer face of each plate.

    The nuts are drawn round, with the section of the hexagon.
    """
    if span.inwards < 0 or end.material is None:
        return
    diameter = (float(fit.plate_radius) - float(fit.radius)) / 2
    axis, height = float(fit.radius) + diameter, piston_nut.HEIGHT * diameter
    shank = diameter / 2
    nut = sqrt(shank * shank + piston_nut.nut_volume(diameter=diameter) / (pi * height))
    start, stop = sorted((span.outside, span.opposite))
    above = [(start - height, nut), (start, nut), (start, shank)]
    above += [(start + stop - x, radius) for x, radius in reversed(above)]
    shape = [(x, axis + radius) for x, radius in above]
    shape += [(x, axis - radius) for x, radius in reversed(above)]
    yield DrawnPart("tie rods", end.material, tuple(shape), round(float(end.sizes["count"])))


def _notes(end: End) -> Iterator[str]:
    yield (
        "Tie rods pass through the plates; their holes are not drawn, and their hexagon nuts are "
        "drawn round."
    )


def _stress(end: End, force: Array) -> Array:
    """Tensile stress in the tie-rod threads, given the total force of all tie rods."""
    return retention.tie_rod_stress(
        force=force,
        count=end.sizes["count"],
        diameter=end.sizes["thread.diameter"],
        pitch=end.sizes["thread.pitch"],
    )


def _clamp(loaded: Loaded) -> Clamp:
    assert loaded.clamp is not None
    return loaded.clamp


def _strength(loaded: Loaded) -> Strength | str:
    end, materials = loaded.end, loaded.materials
    assert end.material is not None
    strength = materials.allowable(end.material, "yield_strength")
    ultimate = materials.allowable(end.material, "ultimate_strength")
    if strength is None or ultimate is None:
        return "tie rods need a thread and a material with yield and ultimate strength"
    clamp, per_stress = _clamp(loaded), _stress(end, 1.0)
    preloads = {"": clamp.greatest}
    preloads |= {at: clamp.greatest + change for at, change in clamp.changes.items()}

    def factor(stress: Array, preload: Array) -> Array:
        """Force on the ends at this stress of the rods, over the force; also of an open joint."""
        borne = stress / per_stress
        return minimum((borne - preload) / clamp.added, borne / loaded.force)

    working = {
        f"tie rods, {at}" if at else "tie rods": factor(strength, preload)
        for at, preload in preloads.items()
    }
    burst = {
        f"with temperature, {at}" if at else "": factor(ultimate, preload)
        for at, preload in preloads.items()
    }
    return Strength(working, burst, NOT_BONDED)


def _fatigue(loaded: Loaded) -> Fatigue:
    """Fatigue of the tie-rod threads under pulsating pressure."""
    end, clamp = loaded.end, _clamp(loaded)
    diameter = end.sizes["thread.diameter"]
    amplitude = _stress(end, clamp.added / 2)
    life = Life(
        endurance.bolt_cycles(amplitude=amplitude, diameter=diameter),
        endurance.bolt_endurance_amplitude(diameter=diameter) / amplitude,
    )
    return Fatigue(lives={"tie rods": life})


def _own(loaded: Loaded) -> dict[str, Mapping[str, Array]]:
    """The joint stays closed; and the preload that tightening may cause, over the greatest."""
    end, clamp = loaded.end, _clamp(loaded)
    assert end.material is not None
    factors = dict(clamp.closed)
    strength = loaded.materials.allowable(end.material, "yield_strength")
    if strength is not None:
        twist = piston_nut.torsion_factor(
            diameter=end.sizes["thread.diameter"], pitch=end.sizes["thread.pitch"]
        )
        stress = twist * _stress(end, clamp.greatest)
        factors["while tightened"] = piston_nut.USED * strength / stress
    return {"joint_factor": factors}


def _warnings(loaded: Loaded, quantities: Mapping[str, Quantity]) -> Iterator[tuple[str, str]]:
    end = loaded.end
    sizes = (end.outer_radius, end.sizes["thread.diameter"], end.sizes["count"])
    distance, nut = _spacing(*(float(np.min(np.real(size))) for size in sizes))
    if distance < nut:
        yield "retention_factor", _meeting(distance, nut)
    if "preload" not in loaded.end.sizes:
        force = float(np.max(np.real(_clamp(loaded).preload)))
        yield (
            "joint_factor",
            f"no tie-rod preload is stated; {force / 1e3:.1f} kN is assumed, which keeps the joint "
            "closed at proof pressure, at every stated temperature",
        )
    if not _clamp(loaded).changes:
        yield (
            "joint_factor",
            "how temperature changes the preload of the tie rods is unknown: state environment, "
            "and the thermal expansion of barrel, caps and tie rods",
        )


JOINT = Joint(
    name="tie_rods",
    help="rods outside the barrel clamp it between cap and head",
    noun="tie rods",
    fields=(
        JointField("length"),
        JointField(
            "material",
            "missing: tie rods need a material",
            'add e.g. "material: steel_bolt_10_9"',
        ),
        JointField("count"),
        JointField(
            "thread",
            "missing: required by tie rods",
            'add a block "thread:" with diameter, pitch',
        ),
        JointField("thread.diameter", "missing: required by tie rods", 'add e.g. "diameter: 6 mm"'),
        JointField("thread.pitch"),
        JointField("preload"),
        JointField(
            "tightening_factor",
            quantity="tightening_factor",
            help="greatest divided by least preload after tightening; default 1.6",
        ),
    ),
    kinds=("metal",),
    without={},
    faults=_faults,
    material_faults=nothing,
    opening=lambda _: BarrelOpening("again", "Clamp the {end} on the barrel with the tie rods."),
    form="plates",
    fit=_fit,
    clamping=_clamping,
    give=None,
    mass=_mass,
    outline=_outline,
    notes=_notes,
    strength=_strength,
    yields=lambda loaded: {},
    wall=lambda loaded: WallPressures(),
    beside=None,
    fatigue=_fatigue,
    own=_own,
    envelope=None,
    metrics={"joint_factor": "no tie rods"},
    judged=ON_METAL,
    models={
        ("retention_factor", place): "retention.tie_rod_stress"
        for place in ("tie rods", "tie rods, cold", "tie rods, hot")
    },
    usual=(),
    warnings=_warnings,
)
