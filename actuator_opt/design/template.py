"""The start file of `init`: a complete, commented design, every value with its unit."""

from __future__ import annotations

from ..joints.kinds import JOINTS
from ..seals import o_ring
from ..seals.kinds import TYPES
from .kinds import Text
from .model import Design
from .reader import LoadedDesign
from .writer import scalar, to_yaml

_TEXT = """\
# A hydraulic actuator: its design, duties, variables and requirements.
#
# Every physical value has a unit (25 mm, 100 bar, 40 degC, 0.5 %); only 0, ratios and counts
# may be bare. Every value has a PATH, e.g. cylinder.bore or barrel.layup[1].thickness, for --set
# and the block `variables` below.
#
#   actuator-opt check FILE       all faults of this file
#   actuator-opt evaluate FILE    all metrics and checks of this design
#   actuator-opt optimise FILE    the lightest design that meets the requirements
name: @NAME@

fluid:
  material: iso_vg_32          # actuator-opt materials list
  temperature: 40 degC
  air_content: 0.5 %           # entrained air: lowers the stiffness of the oil

supply:
  pressure: 100 bar            # gauge, at the actuator's port
  return_pressure: 2 bar
  proof_ratio: 1.5             # proof pressure over supply pressure

environment:
  temperature_min: -20 degC
  temperature_max: 80 degC
  assembly_temperature: 20 degC
  cure_temperature: 120 degC   # stress-free temperature of the laminate
  trapped_rise: 5 K            # temperature rise of trapped oil

cylinder:
  bore: 25 mm
  stroke: 110 mm
  mount: cap_clevis            # or head_flange, head_trunnion, cap_flange
  port_diameter: 6 mm

barrel:
  model: auto                  # isotropic for one metal layer, else layered
  layup:                       # from the bore outwards; one isotropic layer = a metal barrel
    - material: al_6061_t6     # liner: leak-tight, wear surface of the piston seal
      thickness: 0.8 mm
    - material: t700_epoxy     # hoop layer: carries the pressure
      angle: 88 deg            # from the tube axis; a balanced +- pair
      thickness: 1.2 mm
                               # or both composite layers: plies: "+-88_3 / +-20_2" and
                               # ply_thickness: 0.2 mm instead of angle and thickness
    - material: t700_epoxy     # axial layer: carries the end forces
      angle: 20 deg
      thickness: 0.8 mm

rod:
  material: steel_42crmo4
  outer_diameter: 12 mm
  inner_diameter: 4 mm         # 0 = solid
  extension: 25 mm             # length outside the head when retracted
  thread:
    diameter: 10 mm
    pitch: 1.5 mm

piston:
  material: al_7075_t6
  length: 18 mm
  clearance: 0.02 mm           # radial

head:
  material: al_7075_t6
  length: 22 mm
  clearance: 0.02 mm

caps:
  material: ti_6al4v           # low thermal expansion, suits carbon fibre
  thickness: 6 mm

retention:                     # joint of caps and head to the barrel
  type: bond                   # or @JOINTS@
  material: epoxy_structural
  length: 20 mm
  wall: 1.5 mm

clevis:
  material: al_7075_t6
  pin_diameter: 10 mm

seals:
  piston:
    type: o_ring               # or @SEALS@
    compound: nbr_70
    section: 3.53 mm
    squeeze: 12 %
    tolerance: 0.05 mm
  rod:
    type: o_ring
    compound: nbr_70
    section: 3.53 mm
    squeeze: 12 %
    tolerance: 0.05 mm
    # friction: film           # oil film instead of a friction coefficient
    # back_up: one             # needs back_up_material and back_up_thickness

lines:                         # between valve and chambers; optional
  - chamber: a                 # a: cap side, b: rod side
    length: 0.2 m
    inner_diameter: 6 mm
    outer_diameter: 8 mm
    material: steel_e235
  - chamber: b
    length: 0.2 m
    inner_diameter: 6 mm
    outer_diameter: 8 mm
    material: steel_e235

# valve:                       # optional: position loop, bandwidth and margins
#   rated_flow: 10 l/min       # through one edge, fully open, at rated_drop
#   rated_drop: 35 bar
#   leakage_flow: 0.2 l/min    # through one edge, spool centred, at leakage_drop (50 bar)
#   natural_frequency: 120 Hz
# ports:
#   end: valve                 # end of the lines under load excitation; or closed (default),
#                              # constant_pressure, reducing_valve
# control:
#   gain: 500 V/m              # signal per position error; default: half the ultimate gain

load:
  mass: 20 kg                  # moving mass, reflected to the rod
# linkage:                     # two pivots about a joint: allows joint_torque without lever_arm,
#   base_radius: 280 mm        # joint_angle, joint_speed and load.inertia
#   crank_radius: 70 mm        # joint axis to the crank pin
#   angle_offset: 10 deg       # between both radii at joint angle 0; grows as it extends

load_cases:                    # every requirement holds in the worst case
  - name: stance
    direction: push
    force: 3 kN                # or joint_torque: 120 N*m with lever_arm: 40 mm (or linkage)
    speed: 0.1 m/s
    position: worst            # or a length, or a share of the stroke (50 %)
    side_load: 20 N
#   frequency: 20 Hz           # load excitation, for dynamic_stiffness
  - name: swing
    direction: pull
    force: 1 kN
    speed: 0.15 m/s

variables:                     # dimensions that the optimiser varies; all others are fixed
  cylinder.bore:
    lower: 18 mm
    upper: 40 mm
  barrel.layup[1].thickness:
    lower: 0.2 mm
    upper: 4 mm
  barrel.layup[2].thickness:
    lower: 0.2 mm
    upper: 4 mm
  rod.outer_diameter:
    lower: 10 mm
    upper: 20 mm
  rod.inner_diameter:
    lower: 0 mm
    upper: 16 mm
  caps.thickness:
    lower: 3 mm
    upper: 12 mm

# choices:                     # PATH with the values to choose from; every
#   seals.rod.compound: [nbr_70, hnbr_75]      # combination is optimised, the best is kept
#   seals.rod.section: [2.62 mm, 3.53 mm]

requirements:                  # METRIC with min and/or max; every metric: actuator-opt schema
  stiffness_min:
    min: 4 kN/mm
  buckling_factor:
    min: 3.5
  seal_gap:
    max: 80 um
  friction_running:
    max: 350 N

objective:
  minimise: mass
"""


def init_text(name: str = "my actuator", from_design: LoadedDesign | Design | None = None) -> str:
    """A start file: the commented template, or an existing design under a new name.

    Raises
    ------
    ValueFault
        an invalid name
    """
    title = Text().validate(name)
    if from_design is None:
        joints = ", ".join(name for name in JOINTS if name != "bond")
        seals = ", ".join(name for name in TYPES if name != o_ring.TYPE.name)
        text = _TEXT.replace("@JOINTS@", joints).replace("@SEALS@", seals)
        return text.replace("@NAME@", scalar(title))
    if isinstance(from_design, Design):
        return to_yaml(from_design.model_copy(update={"name": title}))
    design = from_design.design.model_copy(update={"name": title})
    return to_yaml(design, from_design.source)
