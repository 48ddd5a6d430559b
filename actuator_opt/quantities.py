"""Every quantity of the project, declared once: name, symbol, dimension, display unit, label, range.

The parser, the help, tables, JSON, reports and the JSON Schema all read this table. `INPUTS` are
what a person writes in a design or a materials file; `METRICS` are what an evaluation computes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, cast, get_args

from . import units

Sense = Literal["min", "max"]
"""Of limits: at least, at most. Of several values of a metric: the smallest, the largest."""

INFINITY = float("inf")


def short(value: float, digits: int = 4, *, full: bool = False) -> str:
    """A number of so many digits; with `full` their zeros too.

    >>> short(20000.0), short(7.9, 3), short(7.9, 3, full=True)
    ('20000', '7.9', '7.90')
    """
    text = f"{value:{'#' if full else ''}.{digits}g}".removesuffix(".")
    if "e" in text and 1 <= abs(float(text)) < 1e7:  # 20000, not 2e+04
        return f"{float(text):.0f}"
    return text


@dataclass(frozen=True, slots=True)
class Quantity:
    """A named physical quantity; limits in SI, `lower` and `upper` included.

    `worst` says which of a metric's values over load cases and places is the worst.
    """

    name: str
    symbol: str
    dimension: str
    unit: str
    label: str
    lower: float = -INFINITY
    upper: float = INFINITY
    worst: Sense | None = None

    @property
    def si_unit(self) -> str:
        """Name of the SI unit."""
        return units.BASE[self.dimension]

    def to_display(self, value: float) -> float:
        """SI value in the unit people read."""
        return units.unit(self.unit, self.dimension).from_si(value) if self.unit else value

    def text(self, value: float, digits: int = 4) -> str:
        """SI value as text with its display unit, ``"25 mm"``."""
        return f"{short(self.to_display(value), digits)} {self.unit}".rstrip()

    def range_text(self) -> str:
        """The valid range as text with units, ``"0.5 mm to 2000 mm"``."""
        return f"{self.text(self.lower, 7)} to {self.text(self.upper, 7)}"


def _table(rows: str) -> dict[str, Quantity]:
    table = {}
    for line in rows.strip().splitlines():
        name, symbol, dimension, unit, lower, upper, label = (c.strip() for c in line.split("|"))
        unit = "" if unit == "-" else unit
        low, high = (
            units.parse(f"{text} {unit}" if unit else text, dimension) if text else sign * INFINITY
            for text, sign in ((lower, -1), (upper, 1))
        )
        table[name] = Quantity(name, symbol, dimension, unit, label, low, high)
    return table


def _metrics(rows: str) -> dict[str, Quantity]:
    """Metrics: a column after the unit states which value is the worst, and must not be empty."""
    plain, worst = [], {}
    for line in rows.strip().splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        name, sense = cells[0], cells.pop(4)
        if sense not in get_args(Sense):
            raise ValueError(f"metric {name}: state which value is the worst, min or max")
        worst[name] = cast("Sense", sense)
        plain.append(" | ".join(cells))
    table = _table("\n".join(plain))
    return {name: replace(table[name], worst=sense) for name, sense in worst.items()}


INPUTS = _table("""
 bore                 | D      | length      | mm   | 2     | 1000  | bore diameter
 stroke               | s      | length      | mm   | 1     | 10000 | stroke
 wall_thickness       | t      | length      | mm   | 0.01  | 200   | thickness
 winding_angle        | theta  | angle       | deg  | -90   | 90    | winding angle from the tube axis
 rod_diameter         | d      | length      | mm   | 1     | 900   | rod outer diameter
 rod_inner_diameter   | d_i    | length      | mm   | 0     | 890   | rod inner diameter
 length               | L      | length      | mm   | 0     | 20000 | length
 stop_travel          | s_e    | length      | mm   | 0.001 | 1000  | stop travel
 part_length          | L      | length      | mm   | 0.1   | 20000 | length of a part
 radial_clearance     | c      | length      | mm   | 0.001 | 2     | radial clearance
 tolerance            | tol    | length      | mm   | 0     | 2     | tolerance
 cross_section        | W      | length      | mm   | 0.5   | 30    | free seal cross-section
 squeeze              | C      | ratio       | %    | 0     | 45    | seal squeeze of the free section
 stretch              | e      | ratio       | %    | 0     | 25    | seal stretch
 groove_width         | g      | length      | mm   | 0.5   | 60    | groove width
 seal_count           | n      | count       | -    | 0     | 8     | number of seals
 bolt_count           | n      | count       | -    | 2     | 48    | number of bolts or tie rods
 thread_diameter      | d_t    | length      | mm   | 1     | 500   | nominal thread diameter
 thread_pitch         | P      | length      | mm   | 0.2   | 12    | thread pitch
 diameter             | d      | length      | mm   | 0.5   | 1000  | diameter
 volume               | V      | volume      | ml   | 0     | 100000| volume
 pressure             | p      | pressure    | bar  | 0     | 1500  | gauge pressure
 working_pressure     | p_s    | pressure    | bar  | 1     | 1500  | supply gauge pressure
 temperature          | T      | temperature | degC | -100  | 300   | temperature
 temperature_rise     | dT     | temperature_difference | K | 0 | 300   | temperature rise
 air_content          | alpha  | ratio       | %    | 0     | 20    | entrained air at atmospheric pressure, by volume
 force                | F      | force       | kN   | 0     | 20000 | force
 torque               | M      | torque      | N*m  | 0     | 1e7   | joint torque
 lever_arm            | a      | length      | mm   | 1     | 10000 | lever arm
 pivot_radius         | r      | length      | mm   | 1     | 10000 | distance of a pivot from the joint axis
 joint_angle          | theta  | angle       | deg  | -360  | 360   | joint angle
 joint_speed          | omega  | angular_speed | rad/s | 0   | 1000  | joint speed
 load_inertia         | J      | inertia     | kg*m^2 | 0   | 1e6   | moment of inertia about the joint
 speed                | v      | speed       | m/s  | 0     | 20    | piston speed
 load_mass            | m      | mass        | kg   | 0     | 1e6   | load mass reflected to the rod
 position             | x      | length      | mm   | 0     | 10000 | piston position from the cap end
 fraction             | x/s    | ratio       | %    | 0     | 100   | position as a fraction of the stroke
 friction_coefficient | mu     | ratio       | -    | 0.001 | 2     | dry friction coefficient seal on counterface
 breakaway_ratio      | F_S/F_C| ratio       | -    | 1     | 5     | breakaway over running friction
 stribeck_speed       | v_s    | speed       | mm/s | 0.01  | 500   | Stribeck speed
 breakaway_travel     | z_max  | length      | mm   | 0.001 | 10    | breakaway travel
 viscous_friction     | sigma_2| damping     | N*s/m| 0     | 1e7   | viscous friction coefficient of the seals
 safety_factor        | S      | ratio       | -    | 0.1   | 100   | safety factor
 cycles               | N      | ratio       | -    | 0     | 1e10  | pressure cycles
 stiffness            | k      | stiffness   | kN/mm| 0.0001| 1e6   | stiffness
 coefficient          | c      | ratio       | -    | 0     | 10    | coefficient
 surface_roughness    | Ra     | length      | um   | 0.01  | 20    | surface roughness Ra
 rms_roughness        | R_q    | length      | um   | 0     | 20    | RMS surface roughness
 taper                | alpha  | angle       | deg  | 0.5   | 60    | taper
 allowed_angle        | theta  | angle       | deg  | 0     | 90    | winding angle the shop can make
 ply_thickness        | t_p    | length      | mm   | 0.01  | 50    | cured thickness of one ply
 autofrettage_pressure| p_af   | pressure    | bar  | 1     | 5000  | autofrettage pressure
 frequency            | f      | frequency   | Hz   | 0.001 | 100000| frequency
 rated_flow           | q_r    | flow        | l/min| 0.001 | 100000| rated flow
 leakage_flow         | q_l    | flow        | l/min| 0     | 1000  | leakage flow
 pressure_drop        | dp     | pressure    | bar  | 0.01  | 1500  | pressure drop
 signal               | U      | voltage     | V    | 0.001 | 1000  | full signal
 signal_offset        | U_0    | voltage     | V    | -1000 | 1000  | signal offset
 gain                 | K_p    | signal_gain | V/m  | 0.001 | 1e9   | gain
 oil_viscosity        | nu     | kinematic_viscosity | mm^2/s | 0.2 | 100000 | kinematic viscosity of the oil
 damping_ratio        | zeta   | ratio       | -    | 0.001 | 10    | damping ratio
 orifice_area         | A_o    | area        | cm^2 | 0     | 1000  | orifice area
 opening              | y      | ratio       | %    | 0     | 100   | opening
 conductance          | G      | conductance | ml/min/bar | 0 | 1e9  | conductance, flow per pressure
 gas_volume           | V_g    | volume      | ml   | 0.1   | 1e6   | gas volume
 precharge            | p_0    | pressure    | bar  | 0.1   | 1000  | gas precharge, gauge
 polytropic_index     | n      | ratio       | -    | 1     | 3     | polytropic index of the gas
""")

MATERIAL_PROPERTIES = _table("""
 density              | rho    | density     | kg/m^3 | 100   | 25000 | density
 youngs_modulus       | E      | pressure    | GPa    | 0.001 | 1200  | Young's modulus
 youngs_modulus_1     | E_1    | pressure    | GPa    | 0.1   | 1200  | modulus along the fibre (warp)
 youngs_modulus_2     | E_2    | pressure    | GPa    | 0.1   | 1200  | modulus across the fibre (weft)
 youngs_modulus_3     | E_3    | pressure    | GPa    | 0.1   | 1200  | modulus through the ply
 shear_modulus        | G      | pressure    | GPa    | 0.0005| 500   | shear modulus
 shear_modulus_12     | G_12   | pressure    | GPa    | 0.05  | 500   | in-plane shear modulus
 shear_modulus_13     | G_13   | pressure    | GPa    | 0.05  | 500   | shear modulus 13
 shear_modulus_23     | G_23   | pressure    | GPa    | 0.05  | 500   | shear modulus 23
 poissons_ratio       | nu     | ratio       | -      | 0     | 0.4999| Poisson's ratio
 poissons_ratio_12    | nu_12  | ratio       | -      | 0     | 0.7   | Poisson's ratio 12
 poissons_ratio_13    | nu_13  | ratio       | -      | 0     | 0.7   | Poisson's ratio 13
 poissons_ratio_23    | nu_23  | ratio       | -      | 0     | 0.9   | Poisson's ratio 23
 yield_strength       | R_p02  | pressure    | MPa    | 1     | 4000  | yield strength
 ultimate_strength    | R_m    | pressure    | MPa    | 1     | 6000  | ultimate tensile strength
 fatigue_strength     | sigma_w| pressure    | MPa    | 0.5   | 3000  | fatigue strength (amplitude, basis stated)
 strength_1_tension   | X_t    | pressure    | MPa    | 1     | 8000  | fibre tension strength
 strength_1_compression| X_c   | pressure    | MPa    | 1     | 8000  | fibre compression strength
 strength_2_tension   | Y_t    | pressure    | MPa    | 1     | 3000  | transverse tension strength
 strength_2_compression| Y_c   | pressure    | MPa    | 1     | 3000  | transverse compression strength
 strength_12          | S      | pressure    | MPa    | 1     | 1000  | in-plane shear strength
 strength_23          | S_23   | pressure    | MPa    | 1     | 1000  | transverse shear strength
 thermal_expansion    | alpha  | per_temperature | ppm/K | -20 | 500  | thermal expansion
 thermal_expansion_1  | alpha_1| per_temperature | ppm/K | -20 | 500  | thermal expansion along the fibre
 thermal_expansion_2  | alpha_2| per_temperature | ppm/K | -20 | 500  | thermal expansion across the fibre
 minimum_thickness    | t_min  | length      | mm     | 0     | 50    | minimum thickness that can be made
 minimum_angle        | theta_min | angle    | deg    | 0     | 90    | smallest winding angle that can be made
 temperature_knockdown| k_T    | ratio       | -      | 0.05  | 1     | strength left at the stated temperature
 moisture_knockdown   | k_w    | ratio       | -      | 0.05  | 1     | strength left after moisture saturation
 basis_knockdown      | k_b    | ratio       | -      | 0.05  | 1     | allowable over the stated value
 temperature_min      | T_min  | temperature | degC   | -200  | 300   | lowest service temperature
 temperature_max      | T_max  | temperature | degC   | -100  | 1000  | highest service temperature
 bulk_modulus         | K      | pressure    | MPa    | 100   | 5000  | isothermal tangent bulk modulus
 bulk_modulus_slope   | K'     | ratio       | -      | 0     | 20    | pressure slope of the bulk modulus
 kinematic_viscosity  | nu     | kinematic_viscosity | mm^2/s | 0.2 | 100000 | kinematic viscosity
 pressure_viscosity   | alpha  | per_pressure| 1/GPa  | 0     | 60    | pressure-viscosity coefficient
 volume_expansion     | alpha_V| per_temperature | 1/K | 0     | 0.005 | volumetric thermal expansion
 vapour_pressure      | p_v    | pressure    | Pa     | 0     | 1e6   | vapour pressure, absolute
 hardness             | S      | hardness    | ShoreA | 20    | 99    | Shore A hardness
 hardness_modulus_factor | f_E | ratio       | -      | 0.1   | 10    | modulus over that by hardness
 friction_coefficient | mu     | ratio       | -      | 0.001 | 2     | dry friction coefficient on the stated counterface
 breakaway_ratio      | F_S/F_C| ratio       | -      | 1     | 5     | breakaway over running friction
 stribeck_speed       | v_s    | speed       | mm/s   | 0.01  | 500   | Stribeck speed
 extrusion_gap_max    | g_max  | length      | mm     | 0.001 | 2     | largest extrusion gap at the stated pressure
 pressure_max         | p_max  | pressure    | bar    | 1     | 2000  | highest pressure without back-up ring
 bond_strength        | tau    | pressure    | MPa    | 0.5   | 200   | adhesive shear strength
 bearing_strength     | p_b    | pressure    | MPa    | 0.5   | 500   | allowable bearing pressure
 fatigue_cycles       | N_w    | ratio       | -      | 1      | 1e12 | cycles of the fatigue strength
 fatigue_stress_ratio | R      | ratio       | -      | -1     | 0.99 | stress ratio (lowest over highest) of the fatigue strength
 shear_strength       | tau_m  | pressure    | MPa    | 0.5    | 3000 | ultimate shear strength
 matrix_temperature_knockdown | k_Tm | ratio | -      | 0.05   | 1    | matrix strength left at the knock-down temperature
 matrix_moisture_knockdown | k_wm | ratio    | -      | 0.05   | 1    | matrix strength left after moisture saturation
 process_knockdown    | k_p    | ratio       | -      | 0.05   | 1    | fibre tension strength of the made part over the coupon
 knockdown_temperature| T_k    | temperature | degC   | 30     | 1000 | temperature of the temperature knock-downs
 fibre_volume_fraction| V_f    | ratio       | -      | 0.1    | 0.8  | fibre volume fraction
 density_temperature  | T_rho  | temperature | degC   | -60    | 100  | temperature of the density
 bulk_modulus_temperature | T_K | temperature | degC  | -60    | 200  | temperature of the bulk modulus
 bulk_modulus_pressure| p_K    | pressure    | bar    | 0      | 1000 | gauge pressure of the bulk modulus
 bulk_modulus_decay   | b_K    | per_temperature | 1/K | 0     | 0.02 | relative fall of the bulk modulus per kelvin
 tait_modulus         | K_00   | pressure    | GPa    | 0.5    | 200  | zero-pressure bulk modulus of the Tait law, extended to 0 K
 tait_decay           | c_K    | per_temperature | 1/K | 0     | 0.02 | relative fall of the Tait modulus per kelvin
 tait_coefficient     | B      | ratio       | -      | 1.5    | 30   | coefficient of the Tait law, one more than K' at zero pressure
 bond_thickness       | t_a    | length      | mm     | 0.005  | 5    | bond line thickness
 speed_max            | v_max  | speed       | m/s    | 0.001  | 50   | highest sliding speed
 softening            | b_E    | per_temperature | 1/K | -0.01 | 0.05 | relative fall of the elastomer's modulus per kelvin
 stiffening_temperature | T_10 | temperature | degC   | -150   | 150  | where cold makes the modulus ten times its plateau (torsion test)
 asperity_friction    | f      | ratio       | -      | 0.001  | 1    | dry friction of the asperities in the film model
 seal_roughness       | sigma  | length      | um     | 0.01   | 20   | RMS roughness of the sliding face in the film model
 asperity_radius      | R_a    | length      | um     | 0.01   | 1000 | radius of the asperity tips
 asperity_density     | n_a    | per_area    | 1/m^2  | 1e9    | 1e17 | asperities per area
""")

METRICS = _metrics("""
 mass                 | m      | mass        | g    | max | | | mass of the dry actuator
 mass_oil             | m_oil  | mass        | g    | max | | | oil inside, piston at the cap end
 push_force           | F_+    | force       | kN   | min | | | push force, net of friction and back-pressure
 pull_force           | F_-    | force       | kN   | min | | | pull force, net of friction and back-pressure
 stiffness_min        | k_min  | stiffness   | kN/mm| min | | | axial stiffness at the weakest stroke position
 stiffness_oil        | k_oil  | stiffness   | kN/mm| min | | | stiffness of oil alone at the weakest position
 stiffness_rod        | k_rod  | stiffness   | kN/mm| min | | | axial stiffness of the rod
 stiffness_barrel     | k_bar  | stiffness   | kN/mm| min | | | stiffness of barrel swelling at the weakest position
 stiffness_seals      | k_s    | stiffness   | kN/mm| min | | | stiffness of sticking seals, beside the oil
 bore_growth          | u_i    | length      | um   | max | | | radial bore growth at supply pressure
 seal_gap             | g      | length      | um   | max | | | radial extrusion gap at the piston seal
 seal_squeeze         | C_min  | ratio       | %    | min | | | smallest seal squeeze after growth and tolerance
 seal_squeeze_max     | C_max  | ratio       | %    | max | | | largest seal squeeze at assembly
 seal_fill            | phi    | ratio       | %    | max | | | largest groove fill
 seal_stretch         | e      | ratio       | %    | max | | | seal stretch
 seal_section         | W      | length      | mm   | min | | | seal cross-section
 contact_width        | b      | length      | mm   | max | | | seal contact width
 contact_pressure     | p_0    | pressure    | MPa  | max | | | peak seal contact pressure
 film_thickness       | h      | length      | um   | min | | | mean oil film under the running seal
 seal_wear            | pL     | line_load   | N/mm | max | | | contact pressure times sliding distance, a double stroke
 rod_leakage          | V_l    | volume      | mm^3 | max | | | oil the rod leaves outside, a double stroke
 inter_seal_pressure  | p_i    | pressure    | bar  | max | | | pressure between the seals of a pair
 friction_running     | F_C    | force       | N    | max | | | running friction of seals, wipers and guides
 friction_breakaway   | F_S    | force       | N    | max | | | breakaway friction of seals, wipers and guides
 damping_pipe         | c      | damping     | N*s/m| max | | | viscous damping of the oil by pipe flow
 damping_annular      | c_a    | damping     | N*s/m| max | | | viscous damping of the annular gaps
 damping_seal         | B      | damping     | kN*s/m| max | | | secant damping of the seals at the stated speed
 damping_ratio        | zeta   | ratio       | -    | min | | | damping ratio of the load on the actuator
 natural_frequency    | f_0    | frequency   | Hz   | min | | | lowest natural frequency at the load mass over the stroke
 dynamic_stiffness    | k_dyn  | stiffness   | kN/mm| min | | | dynamic stiffness at the frequency of the load case
 dynamic_phase        | phi    | angle       | deg  | max | -180 | 180 | phase by which the force leads at that frequency
 ultimate_gain        | K_u    | signal_gain | V/m  | min | | | gain at which the position loop begins to swing
 position_gain        | K_p    | signal_gain | V/m  | min | | | gain of the position loop
 gain_margin          | K_u/K_p| ratio       | -    | min | | | ultimate over present gain of the position loop
 phase_margin         | phi_m  | angle       | deg  | min | -180 | 180 | phase margin of the position loop
 bandwidth            | f_b    | frequency   | Hz   | min | | | -3 dB bandwidth of the position loop
 efficiency           | eta    | ratio       | %    | min | | | force efficiency
 proof_factor         | S_p    | ratio       | -    | min | | | yield or first-ply pressure over proof pressure
 burst_factor         | S_b    | ratio       | -    | min | | | barrel burst pressure over working pressure
 first_ply_factor     | S_fpf  | ratio       | -    | min | | | first-ply pressure over working pressure
 yield_factor         | S_y    | ratio       | -    | min | | | yield over working stress of metal parts
 fatigue_factor       | S_f    | ratio       | -    | min | | | fatigue strength over stress amplitude
 ply_fatigue_factor   | S_pf   | ratio       | -    | min | | | fatigue strength of the wall's fibres over their stress amplitude
 cycle_life           | N      | ratio       | -    | min | | | pressure cycles to failure
 buckling_factor      | S_k    | ratio       | -    | min | | | buckling load over largest push load
 thread_factor        | S_t    | ratio       | -    | min | | | yield over stress at the rod thread root
 retention_factor     | S_r    | ratio       | -    | min | | | strength of cap retention over its load
 retention_burst_factor| S_rb  | ratio       | -    | min | | | ultimate strength of cap retention over its load
 cap_factor           | S_c    | ratio       | -    | min | | | yield over bending stress of the end caps
 pin_factor           | S_pin  | ratio       | -    | min | | | shear yield over shear stress of the clevis pins
 bearing_overlap      | L/d    | ratio       | -    | min | | | bearing span at full extension over rod diameter
 bearing_pressure     | p_g    | pressure    | MPa  | max | | | largest guide pressure under side load
 bearing_factor       | S_g    | ratio       | -    | min | | | allowable over largest guide pressure
 port_velocity        | v_p    | speed       | m/s  | max | | | oil speed in the port
 line_velocity        | v_l    | speed       | m/s  | max | | | oil speed in the line
 line_pressure_drop   | dp     | pressure    | bar  | max | | | pressure drop of the lines
 line_hammer          | dp_J   | pressure    | bar  | max | | | pressure rise when the line's flow is stopped at once
 line_resonance       | f_l    | frequency   | Hz   | min | | | quarter-wave resonance of the line
 flow                 | q      | flow        | l/min| max | | | largest flow
 piston_speed         | v      | speed       | m/s  | max | | | piston speed
 power                | P      | power       | W    | min | | | mechanical output power
 end_stop_energy      | E_end  | energy      | J    | max | | | energy to absorb at the end of stroke
 end_stop_pressure    | p_end  | pressure    | bar  | max | | | peak pressure at the end stop
 trapped_pressure     | p_tr   | pressure    | bar  | max | | | pressure rise of trapped oil over the temperature range
 liner_mismatch_factor| S_th   | ratio       | -    | min | | | liner yield over thermal mismatch stress
 liner_bond_factor    | S_bd   | ratio       | -    | min | | | strength over the pull of the liner on its plies after cool-down
 liner_range_factor   | S_dl   | ratio       | -    | min | | | twice yield over the liner's stress range
 reverse_yield_factor | S_rev  | ratio       | -    | min | | | yield over the liner's residual stress after autofrettage
 liner_strain_range   | d_eps  | ratio       | %    | max | | | equivalent elastic strain range of the liner under a pressure pulse
 joint_factor         | S_j    | ratio       | -    | min | | | tie-rod preload over its loss at proof pressure
 local_buckling_factor| S_w    | ratio       | -    | min | | | wall buckling load of the rod over largest push load
 rod_factor           | S_ro   | ratio       | -    | min | | | strength of the rod's plies over their stress
 fitting_factor       | S_ft   | ratio       | -    | min | | | strength of the bonded rod fittings over their load
 bond_thermal_factor  | S_bt   | ratio       | -    | min | | | bond strength over thermal edge shear without load
 winding_margin       | -      | angle       | deg  | min | | | winding angle less the smallest that can be wound
 ply_thickness_margin | -      | ratio       | %    | min | | | layer thickness over the least that can be laid, less one
 growth_at_seal       | u_s    | length      | um   | max | | | radial bore growth at the piston seal
 clearance_min        | c_min  | length      | um   | min | | | smallest radial clearance of piston and head over the temperature range
 blocked_port_factor  | S_bl   | ratio       | -    | min | | | proof pressure over rod-side pressure with its port blocked
 temperature_margin   | dT     | temperature_difference | K | min | | | distance to the service limits of every material
 oil_viscosity        | nu     | kinematic_viscosity | mm^2/s | max | | | oil viscosity at the case temperature
 cavitation_margin    | p-p_v  | pressure    | bar  | min | | | lowest absolute chamber pressure less the vapour pressure of the oil
 extrusion_factor     | g_max/g| ratio       | -    | min | | | allowed over present extrusion gap
 end_stop_factor      | S_end  | ratio       | -    | min | | | proof pressure over peak end-stop pressure
 trapped_factor       | S_tr   | ratio       | -    | min | | | proof pressure over trapped-oil pressure
 line_drop_ratio      | dp/p   | ratio       | %    | max | | | line pressure drop over supply pressure
 liner_yield_factor   | S_l    | ratio       | -    | min | | | liner yield pressure over working pressure
 leakage              | q_l    | flow        | ml/min | max | | | leakage across the piston
 barrel_length        | L_b    | length      | mm   | max | | | barrel length
 closed_length        | L_0    | length      | mm   | max | | | length pin to pin, retracted
 joint_torque_min     | M_min  | torque      | N*m  | min | | | least joint torque the actuator delivers over its stroke
 joint_range          | d_theta| angle       | deg  | min | | | angle the joint turns over the stroke
 geometry_rod_in_bore | -      | length      | mm   | min | | | radial room between rod and bore
 geometry_rod_wall    | -      | length      | mm   | min | | | rod wall thickness
 geometry_rod_bore    | -      | length      | mm   | min | | | bore left inside the layers of the rod
 geometry_piston_groove | -    | length      | mm   | min | | | wall left beside the grooves of the piston
 geometry_piston_core | -      | length      | mm   | min | | | wall left under the piston groove
 geometry_head_groove | -      | length      | mm   | min | | | wall left beside the grooves of the head
 geometry_head_wall   | -      | length      | mm   | min | | | wall left over the rod seal groove
 geometry_skirts      | -      | length      | mm   | min | | | barrel left between the skirts of both ends
 geometry_barrel_thread | -    | length      | mm   | min | | | metal left under the barrel's thread, in the layer it is cut into
 geometry_skirt_thread | -     | length      | mm   | min | | | metal left over the thread of the caps' skirts
 geometry_thread_crest | -     | ratio       | %    | min | | | overlap of the caps' threads over that of full crests
 geometry_dead_point  | -      | length      | mm   | min | | | actuator length left to the dead points of the linkage
 geometry_joint_angle | -      | ratio       | %    | min | | | stroke left beyond the joint angle of a load case
""")

RECORDS = _table("""
 cutoff               | f_c    | frequency   | Hz     | 0.01  | 100000 | cut-off frequency of the filter
 moving_mass          | m      | mass        | kg     | 0     | 1e6    | mass moving inside the force sensor
 load_force           | F_L    | force       | N      | -2e7  | 2e7    | force of the load, against extension
 pressure_lag         | tau    | time        | ms     | -100  | 100    | time by which the pressures come late
 span                 | L      | length      | mm     | 1     | 20000  | span between the supports
""")
"""What a command states about a test record; magnitudes but for a force and a time."""

SCENARIOS = _table("""
 duration             | T      | time        | s      | 1e-5  | 100000 | simulated time
 sample_time          | dt     | time        | ms     | 1e-6  | 1e6    | time between two samples
 instant              | t      | time        | s      | 0     | 100000 | instant
 time_constant        | tau    | time        | ms     | 1e-3  | 1e6    | time constant
 signal_value         | U      | voltage     | V      | -1000 | 1000   | signal of the valve
 position_value       | x      | length      | mm     | -10000| 10000  | position
 speed_value          | v      | speed       | m/s    | -20   | 20     | speed
 force_value          | F_L    | force       | N      | -2e7  | 2e7    | force of the load, against extension
 torque_value         | M_L    | torque      | N*m    | -1e7  | 1e7    | torque of the load, against the motion counted positive
 flow_value           | q      | flow        | l/min  | -1e6  | 1e6    | flow
 shaft_speed_value    | n      | angular_speed | rpm  | -20000| 20000  | speed of the shaft
 shaft_angle_value    | phi    | angle       | deg    | -1e6  | 1e6    | angle of the shaft
 phase                | phi    | angle       | deg    | -360  | 360    | phase
 factor               | k      | ratio       | -      | -1e6  | 1e6    | factor
 part_factor          | k      | ratio       | -      | 0     | 1e6    | factor on a part of the controller
 signal_rate          | dU/dt  | signal_rate | V/s    | 0.001 | 1e9    | largest rate of the signal
 position_gain        | K_p    | signal_gain | V/m    | 0     | 1e9    | gain on the position
 speed_gain           | K_v    | speed_gain  | V*s/m  | 0     | 1e9    | gain on the speed
 shaft_angle_gain     | K_p    | angle_gain  | V/rad  | 0     | 1e9    | gain on the angle of the shaft
 shaft_speed_gain     | K_p    | angular_speed_gain | V*s/rad | 0 | 1e9 | gain on the speed of the shaft
 pressure_gain        | K_d    | pressure_gain | V/bar | 0    | 1e6    | gain on the load pressure
 margin               | A_m    | ratio       | -      | 1.01  | 100    | gain margin
 inertia              | I      | inertia     | kg*m^2 | 1e-9  | 1e8    | moment of inertia
 oil_volume           | V      | volume      | ml     | 0.01  | 1e6    | oil volume
 load_damping         | b      | damping     | N*s/m  | 0     | 1e9    | damping of the load
 load_stiffness       | k      | stiffness   | N/mm   | 0     | 1e9    | stiffness of the load
 shaft_damping        | b      | angular_damping | N*m*s/rad | 0 | 1e6 | damping of the shaft's load
 displacement         | V_g    | volume      | ml     | 0.01  | 100000 | displacement per revolution
 displacement_setting | eps    | ratio       | -      | 0.01  | 1      | setting of the displacement
 slip_coefficient     | C_s    | ratio       | -      | 0     | 1e-3   | laminar slip of the Wilson model
 coulomb_coefficient  | C_f    | ratio       | -      | 0     | 1      | Coulomb friction of the Wilson model
 viscous_coefficient  | C_v    | ratio       | -      | 0     | 1e9    | viscous friction of the Wilson model
 constant_torque      | T_c    | torque      | N*m    | 0     | 1e6    | constant torque loss of the Wilson model
 drive_speed          | n      | angular_speed | rpm  | 0.1   | 50000  | speed of the pump's shaft
 pump_gain            | K_p    | conductance | l/min/bar | 1e-6 | 1e6  | flow per pressure of the pump's controller
 coulomb_force        | F_C    | force       | N      | 0     | 1e7    | Coulomb friction
 static_force         | F_S    | force       | N      | 0     | 1e7    | breakaway friction
 stribeck_exponent    | delta  | ratio       | -      | 0.3   | 4      | exponent of the Stribeck curve
 bristle_damping      | sigma_1| damping     | N*s/m  | 0     | 1e8    | bristle damping
 damping_factor       | -      | ratio       | -      | 0     | 10     | damping of a stop over sqrt(K m)
 cycles_per_window    | n      | count       | -      | 1     | 1000   | cycles in a window
""")
"""What a scenario states beside a design: coordinates of signals are signed, all else is not."""

RESULTS = _table("""
 rise_time            | t_r    | time        | ms     | | | time from 10 to 90 % of the step
 settling_time        | t_s    | time        | ms     | | | time until the response stays within 2 % of the step
 overshoot            | M_p    | ratio       | %      | | | overshoot over the step
 steady_state_ratio   | e_ss   | ratio       | %      | | | steady-state error over the step
 following_error      | e      | length      | mm     | | | largest position error after the first period
 hold_drift           | v_d    | speed       | mm/s   | | | creep in the last tenth of the time
 peak_pressure        | p_max  | pressure    | bar    | | | highest chamber pressure
 lowest_pressure      | p_min  | pressure    | bar    | | | lowest chamber pressure, gauge
 cavitation_margin    | p-p_v  | pressure    | bar    | | | lowest absolute chamber pressure less the vapour pressure of the oil
 stop_speed           | v_e    | speed       | m/s    | | | highest speed at which the piston meets a stop
 efficiency           | eta    | ratio       | %      | | | work at the load over work of the supply
 supply_energy        | W_P    | energy      | J      | | | work of the supply
 dynamic_stiffness    | k_dyn  | stiffness   | kN/mm  | | | dynamic stiffness at the frequency of the load
 dynamic_phase        | phi    | angle       | deg    | -180 | 180 | phase by which the force leads
""")
"""What a simulation tells; a scenario's requirements name them."""


def of_metric(name: str) -> Quantity:
    """The declared quantity of a metric; an undeclared one (a user's own) is a plain ratio."""
    return METRICS.get(name) or Quantity(name, "", "ratio", "", name.replace("_", " "))
