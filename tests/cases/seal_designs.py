"""A cylinder for the second reading of the seals; every number a test uses is stated here."""

from __future__ import annotations

from functools import cache

import actuator_opt as ao
from actuator_opt.evaluation import compute

TEXT = """
name: second reader's seals
fluid: {material: iso_vg_46, temperature: 45 degC, viscosity_pressure: none}
supply: {pressure: 120 bar, return_pressure: 6 bar}
environment:
  temperature_min: -10 degC
  temperature_max: 80 degC
  assembly_temperature: 18 degC
cylinder:
  bore: 32 mm
  stroke: 120 mm
  mount: cap_flange
  dead_volume_a: 4 ml
  dead_volume_b: 4 ml
barrel:
  layup: [{material: al_7075_t6, thickness: 2 mm}]
  model: isotropic
rod: {material: steel_42crmo4, outer_diameter: 18 mm, inner_diameter: 8 mm, extension: 12 mm}
piston: {material: al_7075_t6, length: 40 mm, clearance: 35 um}
head: {material: al_7075_t6, length: 60 mm, clearance: 28 um}
caps: {material: al_7075_t6, thickness: 8 mm}
seals:
  piston:
    counterface_roughness: 0.3 um
PISTON
  rod:
    counterface_roughness: 0.25 um
ROD
load: {mass: 25 kg}
load_cases:
  - {name: push, direction: push, force: 6 kN, speed: 0.1 m/s}
  - {name: pull, direction: pull, force: 4 kN, speed: 0.3 m/s, pressure: 90 bar}
MORE
materials:
  al_7075_t6: {density: 2810 kg/m^3, youngs_modulus: 71.7 GPa, poissons_ratio: 0.33,
    thermal_expansion: 23.6 ppm/K}
  nbr_90: {density: 1250 kg/m^3, hardness: 82 ShoreA, softening: 0.003 1/K,
    stiffening_temperature: -22 degC, volume_expansion: 0.0006 1/K, friction_coefficient: 0.1,
    breakaway_ratio: 3, stribeck_speed: 1.7 mm/s, asperity_friction: 0.25,
    seal_roughness: 0.8 um, asperity_radius: 1 um, asperity_density: 100000000000000 1/m^2}
  nbr_70: {density: 1200 kg/m^3, hardness: 72 ShoreA, softening: 0.002 1/K,
    stiffening_temperature: -25 degC, volume_expansion: 0.00066 1/K}
  pu_94_u_cup: {density: 1200 kg/m^3, youngs_modulus: 43 MPa, poissons_ratio: 0.48,
    softening: 0.003 1/K, stiffening_temperature: -35 degC, friction_coefficient: 0.25,
    asperity_friction: 0.22, seal_roughness: 0.7 um, asperity_radius: 1.2 um,
    asperity_density: 90000000000000 1/m^2}
  ptfe_bronze_nbr_70: {density: 2000 kg/m^3, hardness: 70 ShoreA, youngs_modulus: 320 MPa,
    poissons_ratio: 0.46, softening: 0.0106 1/K, stiffening_temperature: -100 degC,
    asperity_friction: 0.1, seal_roughness: 0.8 um, asperity_radius: 1 um,
    asperity_density: 100000000000000 1/m^2}
  nbr_80: {density: 1220 kg/m^3, hardness: 80 ShoreA, softening: 0.002 1/K,
    stiffening_temperature: -24 degC, asperity_friction: 0.25, seal_roughness: 0.8 um,
    asperity_radius: 1 um, asperity_density: 100000000000000 1/m^2}
  guide_acetal: {density: 1410 kg/m^3}
  back_up_ptfe: {density: 2165 kg/m^3}
"""

O_RING = "compound: nbr_90, section: 2.62 mm, squeeze: 15 %"
U_CUP = "type: u_cup, compound: pu_94_u_cup, section: 6 mm, squeeze: 9 %, thickness: 1.6 mm, \
width: 5 mm, groove_width: 9 mm"
STEP = "type: step_ring, compound: ptfe_bronze_nbr_70, section: 2.62 mm, squeeze: 15 %, \
thickness: 1.5 mm, width: 3.9 mm, groove_width: 4.2 mm, land: 1 mm, relief: 1.2 mm, taper: 5 deg"
COMPACT = "type: compact, compound: nbr_80, section: 5 mm, squeeze: 10 %, width: 8 mm, \
groove_width: 10 mm, land: 6 mm"
KINDS = {"o_ring": O_RING, "u_cup": U_CUP, "step_ring": STEP, "compact": COMPACT}


def text(piston=O_RING, rod=O_RING, more=""):
    """The cylinder with seals of the two places, as YAML text."""

    def inside(block):
        return "\n".join(f"    {part.strip()}" for part in _parts(block))

    filled = TEXT.replace("PISTON", inside(piston)).replace("ROD", inside(rod))
    return filled.replace("MORE", more)


def _parts(block):
    """Split `a: 1, b: {c: 2, d: 3}` at its outer commas."""
    depth, part = 0, ""
    for letter in block:
        depth += (letter in "{[") - (letter in "}]")
        if letter == "," and depth == 0:
            yield part
            part = ""
        else:
            part += letter
    yield part


@cache
def subject(piston=O_RING, rod=O_RING, sets=(), more=""):
    """The prepared design."""
    return ao.read(text(piston, rod, more), set=sets).subject()


@cache
def metrics(piston=O_RING, rod=O_RING, sets=(), more=""):
    """Everything computed of it: metric, place, (cases, designs)."""
    ready = subject(piston, rod, sets, more)
    return compute(ready, ready.values()).computed.metrics


@cache
def evaluated(piston=O_RING, rod=O_RING, sets=(), more=""):
    """The Evaluation of it."""
    return ao.evaluate(ao.read(text(piston, rod, more), set=sets))
