"""Table of all quantities: name, symbol, dimension, display unit, range, label.

Parser, help, tables, JSON, reports and JSON Schema all read this table. `INPUTS` are the
quantities of design and material files. Computed quantities are in `metrics.table`.
"""

from __future__ import annotations

from typing import Literal

from . import units
from .dataclass import dataclass

Sense = Literal["min", "max"]
"""For a limit: at least ("min") or at most ("max"). For a worst value: the smallest or the
largest."""

INFINITY = float("inf")


def short(value: float, digits: int = 4, *, full: bool = False) -> str:
    """Text of a number with this many digits; with `full`, trailing zeros are kept.

    >>> short(20000.0), short(7.9, 3), short(7.9, 3, full=True)
    ('20000', '7.9', '7.90')
    """
    text = f"{value:{'#' if full else ''}.{digits}g}".removesuffix(".")
    if "e" in text and 1 <= abs(float(text)) < 1e7:  # 20000, not 2e+04
        return f"{float(text):.0f}"
    return text


@dataclass(frozen=True, slots=True)
class Quantity:
    """A named physical quantity, with the lowest and highest permitted value in SI.

    `worst` states which value of a metric is the worst among load cases and locations: the smallest
    or the largest.
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
        """SI value in the display unit."""
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


INPUTS = _table("""
 bore                 | D      | length      | mm   | 2     | 1000  | bore diameter
 piston_area          | A      | area        | cm^2 | 0.001 | 100000| area of the piston
 stroke               | s      | length      | mm   | 1     | 10000 | stroke
 wall_thickness       | t      | length      | mm   | 0.01  | 200   | thickness
 thickness_ratio      | t/t_0  | ratio       | -    | 0.01  | 1     | thickness, as a share of another
 winding_angle        | theta  | angle       | deg  | -90   | 90    | winding angle from the tube axis
 rod_diameter         | d      | length      | mm   | 1     | 900   | rod outer diameter
 rod_inner_diameter   | d_i    | length      | mm   | 0     | 890   | rod inner diameter
 length               | L      | length      | mm   | 0     | 20000 | length
 stop_travel          | s_e    | length      | mm   | 0.001 | 1000  | deflection of an end stop
 part_length          | L      | length      | mm   | 0.1   | 20000 | length of a part
 radial_clearance     | c      | length      | mm   | 0.001 | 2     | radial clearance
 tolerance            | tol    | length      | mm   | 0     | 2     | tolerance
 cross_section        | W      | length      | mm   | 0.5   | 30    | free seal cross-section
 squeeze              | C      | ratio       | %    | 0     | 45    | seal squeeze, as a share of the free cross-section
 stretch              | e      | ratio       | %    | 0     | 25    | seal stretch
 groove_width         | g      | length      | mm   | 0.5   | 60    | groove width
 groove_depth         | h      | length      | mm   | 0.05  | 30    | radial depth of a groove
 flank_angle          | psi    | angle       | deg  | 5     | 85    | angle of a flank to the axis
 ring_thickness       | s      | length      | mm   | 0.2   | 100   | axial thickness of a ring
 ring_width           | b      | length      | mm   | 0.2   | 200   | radial width of a ring
 seal_count           | n      | count       | -    | 0     | 8     | number of seals
 bolt_count           | n      | count       | -    | 2     | 48    | number of bolts or tie rods
 pin_rows             | m      | count       | -    | 1     | 2     | number of rows of pins
 interference         | delta  | length      | um   | 0.1   | 1000  | interference of radii
 relaxation           | c      | ratio       | -    | 0.05  | 1     | share that remains in service
 tightening_factor    | alpha_A| ratio      | -    | 1     | 4     | greatest divided by least preload after tightening
 piece_count          | n      | count       | -    | 1     | 100   | number of equal components
 loss_coefficient     | zeta   | ratio       | -    | 0     | 1000  | sum of the loss coefficients of bends and fittings
 thread_diameter      | d_t    | length      | mm   | 1     | 500   | nominal thread diameter
 thread_pitch         | P      | length      | mm   | 0.2   | 12    | thread pitch
 diameter             | d      | length      | mm   | 0.5   | 1000  | diameter
 line_diameter        | d      | length      | mm   | 0.5   | 1000  | inner diameter of a line
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
 component_mass       | m      | mass        | g    | 0     | 1e6   | mass of a component
 load_mass            | m      | mass        | kg   | 0     | 1e6   | load mass reflected to the rod
 position             | x      | length      | mm   | 0     | 10000 | piston position from the cap end
 fraction             | x/s    | ratio       | %    | 0     | 100   | position as a fraction of the stroke
 friction_coefficient | mu     | ratio       | -    | 0.001 | 2     | dry friction coefficient of the seal on its counterface
 breakaway_ratio      | F_S/F_C| ratio       | -    | 1     | 5     | ratio of breakaway to running friction
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
 allowed_angle        | theta  | angle       | deg  | 0     | 90    | winding angle that can be made
 ply_thickness        | t_p    | length      | mm   | 0.01  | 50    | cured thickness of one ply
 autofrettage_pressure| p_af   | pressure    | bar  | 1     | 5000  | autofrettage pressure
 frequency            | f      | frequency   | Hz   | 0.001 | 100000| frequency
 rated_flow           | q_r    | flow        | l/min| 0.001 | 100000| rated flow
 leakage_flow         | q_l    | flow        | l/min| 0     | 1000  | leakage flow
 edge_coefficient     | K      | flow_coefficient | l/min/sqrt(bar) | 0.0001 | 100000 | flow coefficient of a metering edge
 hysteresis           | H      | ratio       | %    | 0     | 50    | hysteresis of a valve
 threshold            | T      | ratio       | %    | 0     | 50    | threshold of a valve
 pressure_drop        | dp     | pressure    | bar  | 0.01  | 1500  | pressure drop
 spool_stroke         | x_s    | length      | mm   | 0.01  | 100   | stroke of a spool from its centre
 spool_overlap        | o      | length      | um   | -5000 | 5000  | overlap of an edge; negative: open at the centre
 spool_clearance      | c      | length      | um   | 0.1   | 500   | radial clearance of a spool
 edge_rounding        | r      | length      | um   | 0     | 500   | corner radius of an edge
 area_gradient        | w      | length      | mm   | 0.01  | 1000  | width of a spool's ports around its circumference
 flow_share           | f      | ratio       | %    | 1     | 1000  | flow of an edge, as a share of the rated flow
 signal               | U      | voltage     | V    | 0.001 | 1000  | signal at full opening
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
 repeats              | N      | ratio       | -    | 0     | 1e12  | number of repeats
 scale_factor         | k      | ratio       | -    | 0.001 | 1000  | factor
 cycle_phase          | phi    | ratio       | %    | 0     | 100   | delay, as a share of the period
 sample_count         | n      | count       | -    | 4     | 20000 | number of samples
 opening_limit        | y_lim  | ratio       | %    | 1     | 100   | largest opening of the valve
 service_time         | t      | time        | h    | 0     | 1e6   | time in service
 thermal_conductance  | G      | thermal_conductance | W/K | 0 | 1e6  | heat flow per temperature difference
 emissivity           | eps    | ratio       | -    | 0     | 1     | emissivity
 wear_rate            | k      | wear_rate   | m^2/N| 0     | 1e-9  | worn volume per force and distance
 wear_depth           | delta  | length      | mm   | 0.0001| 10    | wear depth
 machine_efficiency   | eta    | ratio       | %    | 1     | 100   | efficiency
 precharge_ratio      | p_0/p  | ratio       | -    | 0.1   | 1     | precharge, as a share of the lowest pressure, both absolute
 specific_energy      | e      | specific_energy | MJ/kg | 0.001 | 1000 | energy per mass
 mass_per_power       | m/P    | mass_per_power | kg/kW | 0  | 1000  | mass per power
 mass_per_conductance | m/G    | mass_per_conductance | kg*K/W | 0 | 100 | mass per thermal conductance
 shell_density        | m/V    | density     | kg/l | 0     | 100   | mass per volume of gas
 system_part_mass     | m      | mass        | kg   | 0     | 1e6   | mass of other parts
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
 fatigue_strength     | sigma_w| pressure    | MPa    | 0.5   | 3000  | fatigue strength (stress amplitude)
 strength_1_tension   | X_t    | pressure    | MPa    | 1     | 8000  | fibre tension strength
 strength_1_compression| X_c   | pressure    | MPa    | 1     | 8000  | fibre compression strength
 strength_2_tension   | Y_t    | pressure    | MPa    | 1     | 3000  | transverse tension strength
 strength_2_compression| Y_c   | pressure    | MPa    | 1     | 3000  | transverse compression strength
 strength_12          | S      | pressure    | MPa    | 1     | 1000  | in-plane shear strength
 strength_23          | S_23   | pressure    | MPa    | 1     | 1000  | transverse shear strength
 thermal_expansion    | alpha  | per_temperature | ppm/K | -20 | 500  | thermal expansion
 thermal_expansion_1  | alpha_1| per_temperature | ppm/K | -20 | 500  | thermal expansion along the fibre
 thermal_expansion_2  | alpha_2| per_temperature | ppm/K | -20 | 500  | thermal expansion across the fibre
 thermal_conductivity | lambda | thermal_conductivity | W/(m*K) | 0.01 | 2500 | thermal conductivity; of a ply along the fibre (warp)
 thermal_conductivity_through | lambda_t | thermal_conductivity | W/(m*K) | 0.01 | 2500 | thermal conductivity through the ply
 specific_heat        | c_p    | specific_heat | J/(kg*K) | 50 | 10000 | specific heat
 minimum_thickness    | t_min  | length      | mm     | 0     | 50    | minimum thickness that can be made
 minimum_angle        | theta_min | angle    | deg    | 0     | 90    | smallest winding angle that can be made
 temperature_knockdown| k_T    | ratio       | -      | 0.05  | 1     | strength at the knock-down temperature, as a share of that at 23 degC
 moisture_knockdown   | k_w    | ratio       | -      | 0.05  | 1     | strength after moisture saturation, as a share of the dry strength
 basis_knockdown      | k_b    | ratio       | -      | 0.05  | 1     | allowable strength, as a share of the stated value
 temperature_min      | T_min  | temperature | degC   | -200  | 300   | lowest service temperature
 temperature_max      | T_max  | temperature | degC   | -100  | 1000  | highest service temperature
 bulk_modulus         | K      | pressure    | MPa    | 100   | 5000  | isothermal tangent bulk modulus
 bulk_modulus_slope   | K'     | ratio       | -      | 0     | 20    | pressure slope of the bulk modulus
 kinematic_viscosity  | nu     | kinematic_viscosity | mm^2/s | 0.2 | 100000 | kinematic viscosity
 pressure_viscosity   | alpha  | per_pressure| 1/GPa  | 0     | 60    | pressure-viscosity coefficient
 volume_expansion     | alpha_V| per_temperature | 1/K | 0     | 0.005 | volumetric thermal expansion
 vapour_pressure      | p_v    | pressure    | Pa     | 0     | 1e6   | vapour pressure, absolute
 hardness             | S      | hardness    | ShoreA | 20    | 99    | Shore A hardness
 hardness_modulus_factor | f_E | ratio       | -      | 0.1   | 10    | Young's modulus, divided by that estimated from hardness
 friction_coefficient | mu     | ratio       | -      | 0.001 | 2     | dry friction coefficient on the stated counterface
 breakaway_ratio      | F_S/F_C| ratio       | -      | 1     | 5     | ratio of breakaway to running friction
 stribeck_speed       | v_s    | speed       | mm/s   | 0.01  | 500   | Stribeck speed
 extrusion_gap_max    | g_max  | length      | mm     | 0.001 | 2     | largest extrusion gap at the stated pressure
 pressure_max         | p_max  | pressure    | bar    | 1     | 2000  | highest pressure without back-up ring
 bond_strength        | tau    | pressure    | MPa    | 0.5   | 200   | adhesive shear strength
 bearing_strength     | p_b    | pressure    | MPa    | 0.5   | 500   | allowable bearing pressure
 pin_bearing_strength | sigma_b| pressure    | MPa    | 1     | 2000  | strength of a laminate against the pins in its holes
 fatigue_cycles       | N_w    | ratio       | -      | 1      | 1e12 | number of cycles to which the fatigue strength applies
 fatigue_stress_ratio | R      | ratio       | -      | -1     | 0.99 | stress ratio of the fatigue strength: lowest stress divided by highest
 shear_strength       | tau_m  | pressure    | MPa    | 0.5    | 3000 | ultimate shear strength
 matrix_temperature_knockdown | k_Tm | ratio | -      | 0.05   | 1    | matrix strength at the knock-down temperature, as a share of that at 23 degC
 matrix_moisture_knockdown | k_wm | ratio    | -      | 0.05   | 1    | matrix strength after moisture saturation, as a share of the dry strength
 process_knockdown    | k_p    | ratio       | -      | 0.05   | 1    | fibre tensile strength of the made part, as a share of that of a flat coupon
 knockdown_temperature| T_k    | temperature | degC   | 30     | 1000 | temperature at which the temperature knock-downs apply
 fibre_volume_fraction| V_f    | ratio       | -      | 0.1    | 0.8  | fibre volume fraction
 density_temperature  | T_rho  | temperature | degC   | -60    | 100  | temperature at which the density is stated
 bulk_modulus_temperature | T_K | temperature | degC  | -60    | 200  | temperature at which the bulk modulus is stated
 bulk_modulus_pressure| p_K    | pressure    | bar    | 0      | 1000 | gauge pressure at which the bulk modulus is stated
 bulk_modulus_decay   | b_K    | per_temperature | 1/K | 0     | 0.02 | relative fall of the bulk modulus per kelvin
 tait_modulus         | K_00   | pressure    | GPa    | 0.5    | 200  | zero-pressure bulk modulus of the Tait law, extrapolated to 0 K
 tait_decay           | c_K    | per_temperature | 1/K | 0     | 0.02 | relative fall of the Tait modulus per kelvin
 tait_coefficient     | B      | ratio       | -      | 1.5    | 30   | coefficient of the Tait law: K' at zero pressure plus 1
plastic_shear_strain | gamma_p| ratio       | %    | 0      | 300  | plastic shear strain of the adhesive at failure
 bond_thickness       | t_a    | length      | mm     | 0.005  | 5    | bond line thickness
 speed_max            | v_max  | speed       | m/s    | 0.001  | 50   | highest sliding speed
 softening            | b_E    | per_temperature | 1/K | -0.01 | 0.05 | relative fall of the elastomer's modulus per kelvin
 stiffening_temperature | T_10 | temperature | degC   | -150   | 150  | low temperature at which the modulus is ten times its plateau value (torsion test)
 asperity_friction    | f      | ratio       | -      | 0.001  | 1    | dry friction of the asperities in the film model
 seal_roughness       | sigma  | length      | um     | 0.01   | 20   | RMS roughness of the sliding face in the film model
 asperity_radius      | R_a    | length      | um     | 0.01   | 1000 | radius of the asperity tips
 asperity_density     | n_a    | per_area    | 1/m^2  | 1e9    | 1e17 | number of asperities per unit area
""")

RECORDS = _table("""
 cutoff               | f_c    | frequency   | Hz     | 0.01  | 100000 | cut-off frequency of the filter
 moving_mass          | m      | mass        | kg     | 0     | 1e6    | mass moving between piston and force sensor
 load_force           | F_L    | force       | N      | -2e7  | 2e7    | force of the load, positive against extension
 pressure_lag         | tau    | time        | ms     | -100  | 100    | delay of the pressure signals
 span                 | L      | length      | mm     | 1     | 20000  | span between the supports
""")
"""Quantities of the settings with which a test record is evaluated; only forces and times may be
negative."""

SCENARIOS = _table("""
 duration             | T      | time        | s      | 1e-5  | 100000 | simulated time
 sample_time          | dt     | time        | ms     | 1e-6  | 1e6    | time between two samples
 instant              | t      | time        | s      | 0     | 100000 | instant
 time_constant        | tau    | time        | ms     | 1e-3  | 1e6    | time constant
 signal_value         | U      | voltage     | V      | -1000 | 1000   | signal of the valve
 position_value       | x      | length      | mm     | -10000| 10000  | position
 speed_value          | v      | speed       | m/s    | -20   | 20     | speed
 force_value          | F_L    | force       | N      | -2e7  | 2e7    | force of the load, positive against extension
 torque_value         | M_L    | torque      | N*m    | -1e7  | 1e7    | torque of the load, positive if it opposes positive motion
 flow_value           | q      | flow        | l/min  | -1e6  | 1e6    | flow
 shaft_speed_value    | n      | angular_speed | rpm  | -20000| 20000  | speed of the shaft
 shaft_angle_value    | phi    | angle       | deg    | -1e6  | 1e6    | angle of the shaft
 phase                | phi    | angle       | deg    | -360  | 360    | phase
 factor               | k      | ratio       | -      | -1e6  | 1e6    | factor
 part_factor          | k      | ratio       | -      | 0     | 1e6    | factor on one part of the controller (gain, integral or derivative)
 signal_rate          | dU/dt  | signal_rate | V/s    | 0.001 | 1e9    | largest rate of change of the signal
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
 displacement_setting | eps    | ratio       | -      | 0.01  | 1      | displacement setting, as a share of the largest displacement
 slip_coefficient     | C_s    | ratio       | -      | 0     | 1e-3   | laminar slip coefficient of the Wilson model
 coulomb_coefficient  | C_f    | ratio       | -      | 0     | 1      | Coulomb friction coefficient of the Wilson model
 viscous_coefficient  | C_v    | ratio       | -      | 0     | 1e9    | viscous friction coefficient of the Wilson model
 constant_torque      | T_c    | torque      | N*m    | 0     | 1e6    | constant torque loss of the Wilson model
 drive_speed          | n      | angular_speed | rpm  | 0.1   | 50000  | speed of the pump's shaft
 pump_gain            | K_p    | conductance | l/min/bar | 1e-6 | 1e6  | flow per pressure of the pump's controller
 coulomb_force        | F_C    | force       | N      | 0     | 1e7    | Coulomb friction
 static_force         | F_S    | force       | N      | 0     | 1e7    | breakaway friction
 stribeck_exponent    | delta  | ratio       | -      | 0.3   | 4      | exponent of the Stribeck curve
 bristle_damping      | sigma_1| damping     | N*s/m  | 0     | 1e8    | bristle damping
 damping_factor       | -      | ratio       | -      | 0     | 10     | damping of a stop, divided by the square root of stiffness times moving mass
 cycles_per_window    | n      | count       | -      | 1     | 1000   | cycles in a window
""")
"""Inputs of a scenario, in addition to its design. Only values, angles and factors of its signals
may be negative."""

RESULTS = _table("""
 rise_time            | t_r    | time        | ms     | | | time from 10 to 90 % of the step
 settling_time        | t_s    | time        | ms     | | | time until the response stays within 2 % of the step
 overshoot            | M_p    | ratio       | %      | | | overshoot, as a share of the step
 steady_state_ratio   | e_ss   | ratio       | %      | | | steady-state error, as a share of the step
 following_error      | e      | length      | mm     | | | largest position error, after the first period of a sine reference
 hold_drift           | v_d    | speed       | mm/s   | | | creep speed in the last tenth of the simulated time
 peak_pressure        | p_max  | pressure    | bar    | | | highest chamber pressure
 lowest_pressure      | p_min  | pressure    | bar    | | | lowest chamber pressure, gauge
 cavitation_margin    | p-p_v  | pressure    | bar    | | | lowest absolute chamber pressure minus the vapour pressure of the oil
 stop_speed           | v_e    | speed       | m/s    | | | highest speed at which the piston meets a stop
 efficiency           | eta    | ratio       | %      | | | work done on the load, as a share of the supply's work
 supply_energy        | W_P    | energy      | J      | | | work of the supply
 dynamic_stiffness    | k_dyn  | stiffness   | kN/mm  | | | dynamic stiffness at the frequency of the load
 dynamic_phase        | phi    | angle       | deg    | -180 | 180 | phase by which the force leads the motion
""")
"""Results of a simulation, which the requirements of a scenario can name."""

BASIS = _table("""
 load_mass            | m_L    | mass        | kg        | | | mass of the load
 part_mass            | m_p    | mass        | kg        | | | mass of rod, piston and fastening
 joint_mass           | m_J    | mass        | kg        | | | inertia of the joint, reflected to the rod at the start
 moving_mass          | m      | mass        | kg        | | | moving mass at the start
 stroke               | s      | length      | mm        | | | stroke
 start_position       | x_0    | length      | mm        | | | position at the start
 area_a               | A_A    | area        | mm^2      | | | area of chamber A
 area_b               | A_B    | area        | mm^2      | | | area of chamber B
 dead_volume_a        | V_0A   | volume      | ml        | | | dead volume of chamber A, with the line lumped into it
 dead_volume_b        | V_0B   | volume      | ml        | | | dead volume of chamber B, with the line lumped into it
 volume_a             | V_A    | volume      | ml        | | | oil volume of chamber A at the start
 volume_b             | V_B    | volume      | ml        | | | oil volume of chamber B at the start
 wall_compliance_a    | C_A    | compliance  | mm^3/MPa  | | | expansion of the walls of chamber A at the start
 wall_compliance_b    | C_B    | compliance  | mm^3/MPa  | | | expansion of the walls of chamber B at the start
 wall_coupling        | C_AB   | compliance  | mm^3/MPa  | | | expansion of the walls of one chamber by the pressure in the other
 rod_stiffness        | k_r    | stiffness   | kN/mm     | | | stiffness of rod and mount in series
 start_pressure_a     | p_A    | pressure    | bar       | | | pressure in chamber A at the start, gauge
 start_pressure_b     | p_B    | pressure    | bar       | | | pressure in chamber B at the start, gauge
 supply_pressure      | p_S    | pressure    | bar       | | | supply pressure, gauge
 return_pressure      | p_T    | pressure    | bar       | | | return pressure, gauge
 oil_temperature      | T      | temperature | degC      | | | temperature of the oil
 oil_modulus          | K_0    | pressure    | MPa       | | | bulk modulus of the oil without air at zero gauge pressure
 modulus_a            | K_A    | pressure    | MPa       | | | bulk modulus of oil with air at the start pressure of A
 modulus_b            | K_B    | pressure    | MPa       | | | bulk modulus of oil with air at the start pressure of B
 air_content          | alpha  | ratio       | %         | | | free air, as a share of the oil at zero gauge pressure
 air_share_a          | phi_A  | ratio       | %         | | | air at the start pressure of A, as a share of the volume
 air_share_b          | phi_B  | ratio       | %         | | | air at the start pressure of B, as a share of the volume
 oil_density          | rho    | density     | kg/m^3    | | | density of the oil
 oil_viscosity        | nu     | kinematic_viscosity | mm^2/s | | | kinematic viscosity of the oil
 piston_leakage       | G_l    | conductance | ml/min/bar| | | leakage across the piston
 oil_damping          | b_o    | damping     | N*s/m     | | | damping by shear of the oil
 coulomb_friction     | F_C    | force       | N         | | | Coulomb friction at the start pressures
 static_friction      | F_S    | force       | N         | | | breakaway friction at the start pressures
 stribeck_speed       | v_s    | speed       | mm/s      | | | Stribeck speed
 viscous_friction     | sigma_2| damping     | N*s/m     | | | viscous friction of the seals
 bristle_stiffness    | sigma_0| stiffness   | kN/mm     | | | stiffness of the bristles
 bristle_damping      | sigma_1| damping     | N*s/m     | | | damping of the bristles at rest
 taper_speed          | v_d    | speed       | mm/s      | | | speed at which the damping of the bristles has fallen to 37 %
 edge_flow            | q_e    | flow        | l/min     | | | flow through an open edge of the valve at 1 bar
 supply_leakage       | q_ls   | flow        | l/min     | | | leakage of a supply edge at 1 bar, spool centred
 tank_leakage         | q_lt   | flow        | l/min     | | | leakage of a tank edge at 1 bar, spool centred
 edge_flow_pa         | q_pa   | flow        | l/min     | | | flow through the open edge P to A at 1 bar
 edge_flow_pb         | q_pb   | flow        | l/min     | | | flow through the open edge P to B at 1 bar
 edge_flow_at         | q_at   | flow        | l/min     | | | flow through the open edge A to T at 1 bar
 edge_flow_bt         | q_bt   | flow        | l/min     | | | flow through the open edge B to T at 1 bar
 valve_hysteresis     | H      | voltage     | V         | | | hysteresis of the valve
 valve_threshold      | T      | voltage     | V         | | | threshold of the valve
 full_signal          | U      | voltage     | V         | | | signal at full opening
 spool_offset         | U_0    | voltage     | mV        | | | signal that centres the spool
 edge_width           | w      | length      | mm        | | | width of the valve edge P to A
 edge_overlap         | o      | length      | um        | | | overlap of the valve edge P to A
 edge_clearance       | c      | length      | um        | | | radial clearance of the valve edge P to A
 edge_stroke          | x_s    | length      | mm        | | | stroke of the spool at full signal
 spool_slew_rate      | dU/dt  | signal_rate | V/s       | | | largest speed of the spool
 spool_frequency      | f_v    | frequency   | Hz        | | | natural frequency of the spool
 spool_damping        | zeta   | ratio       | -         | | | damping ratio of the spool
 stop_stiffness       | k_e    | stiffness   | kN/mm     | | | stiffness of a stop
 stop_damping         | b_e    | damping     | N*s/m     | | | damping of a stop
 displacement         | V_g    | volume      | ml        | | | displacement of the motor per revolution
 motor_inertia        | I      | inertia     | kg*m^2    | | | inertia of motor and load
 pipe_volume          | V_p    | volume      | ml        | | | oil volume of each pipe of the motor
""")
"""Values on which a simulation is based, computed from the design and the scenario."""


def length_text(value: float) -> str:
    """A length for display."""
    return INPUTS["length"].text(value)
