"""A second reader's calculation of a whole actuator, in plain numbers, against `evaluate`.

Nothing here comes from the package's models: every formula is written out from its source or a
short derivation. The design and all material numbers it uses are fixed in this file. Where a
package model is simpler than the part deserves, only the safe side is tested.
"""

from math import cos, exp, log, log10, pi, radians, sin, sqrt, tanh

import numpy as np
import pytest

from actuator_opt import verbs

TEXT = """
name: second reader's knee
fluid: {material: iso_vg_32, temperature: 40 degC, air_content: 0.6 %}
supply: {pressure: 200 bar, return_pressure: 6 bar}
environment:
  temperature_min: -5 degC
  temperature_max: 75 degC
  trapped_rise: 8 K
  cure_temperature: 120 degC
  wet: false
cylinder:
  bore: 24 mm
  stroke: 105 mm
  mount: cap_clevis
  dead_volume_a: 3 ml
  dead_volume_b: 2 ml
  port_diameter: 6.5 mm
  stop_travel: 0.9 mm
barrel:
  model: thin_laminate
  layup:
    - {material: al_7075_t6, thickness: 0.7 mm}
    - {material: t700_epoxy, angle: 87 deg, thickness: 1.1 mm}
    - {material: t700_epoxy, angle: 28 deg, thickness: 0.9 mm}
rod:
  material: steel_42crmo4
  outer_diameter: 13.5 mm
  inner_diameter: 7 mm
  extension: 11 mm
  thread: {diameter: 10 mm, pitch: 1.25 mm}
piston: {material: al_7075_t6, length: 15 mm, clearance: 35 um}
head: {material: al_7075_t6, length: 13 mm, clearance: 25 um}
caps: {material: al_7075_t6, thickness: 7 mm}
retention: {type: bond, material: epoxy_structural, length: 18 mm, wall: 2 mm}
clevis: {material: steel_42crmo4, pin_diameter: 9 mm}
seals:
  piston:
    {compound: nbr_90, section: 1.78 mm, squeeze: 15.5 %, tolerance: 0.04 mm, stretch: 3 %,
     friction_coefficient: 0.10, breakaway_ratio: 2.5, stribeck_speed: 2 mm/s}
  rod:
    {compound: nbr_90, section: 1.78 mm, squeeze: 13 %, tolerance: 0.03 mm, stretch: 1 %,
     friction_coefficient: 0.12, breakaway_ratio: 2, stribeck_speed: 3 mm/s}
load: {mass: 22 kg}
load_cases:
  - {name: stance, direction: push, force: 6 kN, speed: 0.1 m/s, side_load: 40 N}
  - {name: swing, direction: pull, force: 4 kN, speed: 0.35 m/s}
  - {name: creep, direction: push, force: 2 kN, speed: 1.5 mm/s, temperature: 60 degC}
materials:
  al_7075_t6: {density: 2810 kg/m^3, youngs_modulus: 71.7 GPa, poissons_ratio: 0.33,
    yield_strength: 503 MPa, ultimate_strength: 572 MPa, fatigue_strength: 159 MPa,
    thermal_expansion: 23.6 ppm/K, bearing_strength: 10 MPa}
  t700_epoxy: {density: 1570 kg/m^3, youngs_modulus_1: 135 GPa, youngs_modulus_2: 8.5 GPa,
    shear_modulus_12: 4.3 GPa, poissons_ratio_12: 0.3, strength_1_tension: 2550 MPa,
    strength_1_compression: 1470 MPa, strength_2_tension: 69 MPa,
    strength_2_compression: 170 MPa, strength_12: 80 MPa}
  steel_42crmo4: {density: 7850 kg/m^3, youngs_modulus: 210 GPa, yield_strength: 750 MPa,
    ultimate_strength: 1000 MPa, fatigue_strength: 450 MPa}
  epoxy_structural: {shear_modulus: 1.2 GPa, bond_strength: 28.2 MPa}
  nbr_90: {density: 1250 kg/m^3, hardness: 90 ShoreA}
  iso_vg_32: {density: 870 kg/m^3, bulk_modulus: 1367 MPa, volume_expansion: 0.00077 1/K}
"""

# Dimensions in m, pressures in Pa.
D, S, ROD, HOLE = 24e-3, 105e-3, 13.5e-3, 7e-3
PISTON, HEAD, PLATE, EXTENSION = 15e-3, 13e-3, 7e-3, 11e-3
PLIES = ((0.7e-3, 0.0), (1.1e-3, radians(87)), (0.9e-3, radians(28)))
SUPPLY, DRAIN, P_AIR = 20e6, 0.6e6, 101325.0
A_A, A_B = pi / 4 * D**2, pi / 4 * (D**2 - ROD**2)
R_I, R_O = D / 2, D / 2 + 2.7e-3
R_M = (R_I + R_O) / 2
BARREL = PISTON + S + HEAD
PIN, W = 9e-3, 1.78e-3
EYE = 2 * PIN  # lug radius d and neck length d
AL, FIBRE, STEEL = 2810.0, 1570.0, 7850.0
E_AL, NU_AL, E_STEEL = 71.7e9, 0.33, 210e9
CASES = {  # direction, force, speed, temperature
    "stance": (1, 6000.0, 0.1, 313.15),
    "swing": (-1, 4000.0, 0.35, 313.15),
    "creep": (1, 2000.0, 1.5e-3, 333.15),
}

# Allowable = stated x temperature x basis x process. The temperature share falls linearly from 1
# at 23 degC; the hottest state is 75 degC. Library: 0.9 at 100 degC and basis 0.9 (aluminium),
# 0.95 at 150 degC, minimum values (steel); T700 at 80 degC 0.95 fibre, 0.75 matrix, basis 0.88,
# process 0.75 on fibre tension; adhesive 0.855 at 80 degC, basis 0.8.
YIELD_AL = 503e6 * 0.9 * (1 - 0.1 * 52 / 77)
YIELD_STEEL = 750e6 * (1 - 0.05 * 52 / 127)
HOT_F, HOT_M = 1 - 0.05 * 52 / 57, 1 - 0.25 * 52 / 57
X_T, X_C = 2550e6 * HOT_F * 0.88 * 0.75, 1470e6 * HOT_F * 0.88
Y_T, Y_C, S_12 = (x * HOT_M * 0.88 for x in (69e6, 170e6, 80e6))
BOND = 28.2e6 * (1 - 0.145 * 52 / 57) * 0.8


@pytest.fixture(scope="module")
def evaluation():
    """The package's own evaluation of the fixed design."""
    return verbs.evaluate(TEXT)


@pytest.fixture(scope="module")
def value(evaluation):
    """Value of a metric, or its value in one load case."""

    def get(name, case=None):
        metric = evaluation.metrics[name]
        return metric.value if case is None else metric.by_case[case]

    return get


def near(expected, rel=1e-6):
    """Plain agreement of two calculations of the same formula."""
    return pytest.approx(expected, rel=rel)


# --- laminate, by matrices -----------------------------------------------------------------------


def reduced(e1, e2, nu12, g12):
    """Plane-stress stiffness Q of a ply [Jones1999]."""
    k = 1 - nu12**2 * e2 / e1
    return np.array([[e1 / k, nu12 * e2 / k, 0], [nu12 * e2 / k, e2 / k, 0], [0, 0, g12]])


def turn(a):
    """Engineering strain (z, theta, z-theta) to (1, 2, 12); angle from the tube axis."""
    c, s = cos(a), sin(a)
    return np.array(
        [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
    )


def pair(q, a):
    """Stiffness of a balanced +-pair in tube axes."""
    return (turn(a).T @ q @ turn(a) + turn(-a).T @ q @ turn(-a)) / 2


Q_AL = reduced(E_AL, E_AL, NU_AL, E_AL / 2 / (1 + NU_AL))
Q_PLY = reduced(135e9, 8.5e9, 0.3, 4.3e9)
QS = (Q_AL, Q_PLY, Q_PLY)
MEMBRANE = sum(pair(q, a) * t for q, (t, a) in zip(QS, PLIES, strict=True))
FLEX = np.linalg.inv(MEMBRANE)
# The cap-mounted barrel carries p_B A_B or, pushing, nearly nothing; tension shrinks the bore, so
# zero axial load governs: u = r_i (A^-1)_tt p r_i (hoop force p r_i at the bore, a stated choice).
GROWTH = FLEX[1, 1] * SUPPLY * R_I**2
AT_SEAL = GROWTH / 2  # pressure step at the ring: half the far growth (shell on both sides)


def expansion():
    """Free thermal strain of the wall per kelvin, axial and hoop."""
    force = Q_AL @ np.array([23.6e-6, 23.6e-6, 0]) * PLIES[0][0]
    for t, a in PLIES[1:]:
        for sign in (1, -1):
            force += turn(sign * a).T @ Q_PLY @ np.array([-0.5e-6, 30e-6, 0]) * t / 2
    return FLEX @ force


# --- fluid ---------------------------------------------------------------------------------------


def oil_modulus(p, temperature):
    """K = 1367 MPa e^(-0.0058 dT) + 10.8 p, with air: oil and polytropic gas side by side."""
    k = 1367e6 * exp(-0.0058 * (temperature - 313.15)) + 10.8 * p
    r = (P_AIR / (P_AIR + p)) ** (1 / 1.4)
    return k * (1 + 0.006 * r) / (1 + 0.006 * r * k / (1.4 * (P_AIR + p)))


def viscosity(temperature):
    """ISO VG 32, viscosity index 100: log10 log10(nu + 0.7) = 9.58029 - 3.76640 log10 T."""
    return (10 ** (10 ** (9.58029 - 3.76640 * log10(temperature))) - 0.7) * 1e-6


def oil_density(temperature):
    """870 kg/m3 at 15 degC, volume expansion 7.7e-4 per kelvin."""
    return 870 / (1 + 7.7e-4 * (temperature - 288.15))


# --- seals: plane-strain law, Gent's modulus -----------------------------------------------------

E_RING = 0.0981e6 * (56 + 7.62336 * 90) / (0.137505 * (254 - 2.54 * 90))


def line_load(c, p):
    """Line load (4/3) E W (1.25 C^1.5 + 50 C^6) + k_p p W, k_p 0.72 at 15 % to 0.80 at 20 %."""
    k_p = 0.72 + 0.08 * min(max((c - 0.15) / 0.05, 0), 1)
    return 4 / 3 * E_RING * W * (1.25 * c**1.5 + 50 * c**6) + k_p * p * W


def friction(case):
    """Running and breakaway friction of both seals and dF/dv, at the case's speed."""
    direction, _, v, _ = CASES[case]
    p_b = DRAIN if direction > 0 else SUPPLY
    running = breakaway = slope = 0.0
    for dia, c, p, mu, ratio, v_s in (
        (D, 0.155 - AT_SEAL / W, SUPPLY - DRAIN, 0.10, 2.5, 2e-3),
        (ROD, 0.13, p_b, 0.12, 2.0, 3e-3),
    ):
        dry = mu * pi * dia * line_load(c, p)
        decay = exp(-((v / v_s) ** 2))
        running += dry * (1 + (ratio - 1) * decay)
        breakaway += dry * ratio
        slope += -dry * (ratio - 1) * decay * 2 * v / v_s**2
    return running, breakaway, slope


def net_force(case):
    """Force left after back-pressure and running friction."""
    if CASES[case][0] > 0:
        return SUPPLY * A_A - DRAIN * A_B - friction(case)[0]
    return SUPPLY * A_B - DRAIN * A_A - friction(case)[0]


# --- mass ----------------------------------------------------------------------------------------


def tube(density, outer, inner, length):
    """Mass of a tube from its diameters."""
    return density * pi / 4 * (outer**2 - inner**2) * length


def mass_parts():
    """Every dry part: turned shapes less their grooves."""
    radii = [R_I + x for x in (0, 0.7e-3, 1.8e-3, 2.7e-3)]
    density = (AL, FIBRE, FIBRE)
    wall = sum(tube(density[i], 2 * radii[i + 1], 2 * radii[i], BARREL) for i in range(3))
    groove = 1.3655 * W  # width over section of the tabulated reciprocating glands
    depth_p, depth_r = W * (1 - 0.155), W * (1 - 0.13)
    piston = tube(AL, D - 70e-6, 0, PISTON) - tube(AL, D - 70e-6, D - 2 * depth_p, groove)
    bush = tube(AL, D, ROD + 50e-6, HEAD) - tube(AL, ROD + 2 * depth_r, ROD + 50e-6, groove)
    skirt_outer = 2 * (R_O + 2e-3)
    skirts = 2 * tube(AL, skirt_outer, 2 * R_O, 18e-3)
    plates = tube(AL, skirt_outer, 0, PLATE) + tube(AL, skirt_outer, ROD + 50e-6, PLATE)
    pitch_diameter = 10e-3 - 0.649519 * 1.25e-3
    stud = tube(STEEL, pitch_diameter, 0, 10e-3) + 2 * tube(STEEL, HOLE, 0, 10e-3)
    rings = 1250 * pi**2 * W**2 / 4 * ((D - depth_p) + (ROD + depth_r))
    return {
        "barrel": wall,
        "rod": tube(STEEL, ROD, HOLE, S + HEAD + PLATE + EXTENSION),
        "piston": piston,
        "caps": skirts + plates,
        "glands": bush,
        "seals": rings,
        "fastening": stud,
        "clevises": 2 * STEEL * pi * PIN**3,  # lug 3/4 pi d3, neck 1/4 pi d3
    }


MOVING = 22.0 + sum(mass_parts()[k] for k in ("rod", "piston", "fastening"))


def test_mass(evaluation, value):
    """Every part weighs what its turned shape weighs; the sum is the mass."""
    for part, expected in mass_parts().items():
        assert evaluation.mass_parts[part] == near(expected), part
    assert value("mass") == near(sum(mass_parts().values()))
    oil = 870 * (5e-6 + A_B * S)  # piston at the cap end, density of the data sheet
    assert value("mass_oil") == near(oil)
    assert value("closed_length") == near(BARREL + 2 * PLATE + EXTENSION + 2 * EYE)


def test_forces(value):
    """Push and pull are pressure on areas less back-pressure and friction; efficiency of p A."""
    for case in CASES:
        push = CASES[case][0] > 0
        assert value("push_force" if push else "pull_force", case) == near(net_force(case))
        area = A_A if push else A_B
        assert value("efficiency", case) == near(net_force(case) / (SUPPLY * area))
    # Power is what the load takes.
    assert value("power") == near(4000 * 0.35)
    assert value("flow") == near(A_A * 0.35)
    assert value("port_velocity") == near(A_A * 0.35 / (pi / 4 * 6.5e-3**2))


def test_friction_and_damping(value):
    """Friction, secant damping, and the damping ratio from the slope: negative while creeping."""
    for case, (_, _, v, temperature) in CASES.items():
        running, breakaway, slope = friction(case)
        assert value("friction_running", case) == near(running)
        assert value("friction_breakaway", case) == near(breakaway)
        assert value("damping_seal", case) == near(running / v)
        eta = viscosity(temperature) * oil_density(temperature)
        assert value("oil_viscosity", case) == near(viscosity(temperature), 1e-4)
        pipe = 8 * pi * eta * S
        gap = 2 * pi * eta * PISTON / log(R_I / (R_I - 35e-6))
        gap += 2 * pi * eta * HEAD / log((ROD / 2 + 25e-6) / (ROD / 2))
        assert value("damping_pipe", case) == near(pipe, 1e-4)
        assert value("damping_annular", case) == near(gap, 1e-4)
        ratio = (slope + pipe + gap) / (2 * sqrt(value("stiffness_min", case) * MOVING))
        assert value("damping_ratio", case) == near(ratio, 1e-4)
    assert value("damping_ratio") < 0  # stick-slip is named by its worst case
    assert value("damping_ratio") == value("damping_ratio", "creep")


def test_seal_geometry_and_contact(value):
    """Growth eats squeeze and opens the gap; width and peak pressure follow the pressure."""
    assert value("bore_growth") == near(GROWTH)
    # Concentric gap at the piston ring; half the growth acts there.
    assert value("seal_gap") == near(35e-6 + AT_SEAL)
    thin_p, thin_r = W / sqrt(1.03), W / sqrt(1.01)  # constant ring volume
    worst_p = 1 - (W * 0.845 + AT_SEAL + 0.04e-3) / thin_p
    worst_r = 1 - (W * 0.87 + 0.03e-3) / thin_r
    assert value("seal_squeeze") == near(min(worst_p, worst_r))
    assert value("seal_squeeze_max") == near(0.155 + 0.04 / 1.78)
    fill = pi / 4 * thin_p**2 / (1.3655 * W * (W * 0.845 - 0.04e-3))
    fill_r = pi / 4 * thin_r**2 / (1.3655 * W * (W * 0.87 - 0.03e-3))
    assert value("seal_fill") == near(max(fill, fill_r))
    for case in CASES:
        p_rod = DRAIN if CASES[case][0] > 0 else SUPPLY
        widths, peaks = [], []
        for c, p in ((0.155 - AT_SEAL / W, SUPPLY - DRAIN), (0.13, p_rod)):
            widths.append(W * (2 * c + 0.13 + 0.32 * (1 - exp(-2.1 * p / E_RING))))
            at_rest = 4 / 3 * E_RING * W * (1.25 * c**1.5 + 50 * c**6)
            peaks.append(4 * at_rest / (pi * W * (2 * c + 0.13)) + p)
        assert value("contact_width", case) == near(max(widths))
        assert value("contact_pressure", case) == near(max(peaks))


def test_stiffness_and_frequency(value):
    """Closed ports at holding pressures: the weakest position by brute force, never stiffer."""
    x = np.linspace(0, S, 100001)
    swell = 2 * pi * R_I * GROWTH / SUPPLY  # dV/dp per length
    rod = E_STEEL * pi / 4 * (ROD**2 - HOLE**2) / (S + HEAD + PLATE + EXTENSION)
    assert value("stiffness_rod") == near(rod)
    for case, (direction, force, _, temperature) in CASES.items():
        # Critical centre: p_A + p_B = p_s + p_r, p_A A_A - p_B A_B = F [Merritt1967].
        p_a = (direction * force + (SUPPLY + DRAIN) * A_B) / (A_A + A_B)
        p_b = SUPPLY + DRAIN - p_a
        assert DRAIN < p_a < SUPPLY
        oil_a = (3e-6 + A_A * x) / oil_modulus(p_a, temperature)
        oil_b = (2e-6 + A_B * (S - x)) / oil_modulus(p_b, temperature)
        hydraulic = A_A**2 / (oil_a + swell * x) + A_B**2 / (oil_b + swell * (S - x))
        i = int(np.argmin(hydraulic))
        oil = A_A**2 / oil_a[i] + A_B**2 / oil_b[i]
        assert value("stiffness_oil", case) == near(oil, 1e-4)
        assert value("stiffness_barrel", case) == near(1 / (1 / hydraulic[i] - 1 / oil), 1e-4)
        # Parts added to the load path later (ends, barrel stretch) may only soften it.
        bound = 1 / (1 / hydraulic[i] + 1 / rod)
        assert 0.85 * bound < value("stiffness_min", case) < bound * (1 + 1e-6)
        frequency = sqrt(value("stiffness_min", case) / MOVING) / (2 * pi)
        assert value("natural_frequency", case) == near(frequency)


def wall_stress(layer, axial_per_pressure):
    """Stress in layer axes per unit pressure, thin laminate at mid-radius."""
    strain = FLEX @ np.array([axial_per_pressure / (2 * pi * R_M), R_M, 0])
    t = turn(PLIES[layer][1])
    return QS[layer] @ t @ strain


def wall_pressures():
    """Elastic liner yield and first matrix, shear or fibre failure: no load and p A_A axially."""
    yields, plies = [], []
    for axial in (0.0, A_A):
        z, h, _ = wall_stress(0, axial)
        yields.append(YIELD_AL / sqrt(z * z - z * h + h * h))
        for layer in (1, 2):
            one, two, shear = wall_stress(layer, axial)
            plies.append((X_T if one > 0 else X_C) / abs(one))
            plies.append((Y_T if two > 0 else Y_C) / abs(two))
            plies.append(S_12 / abs(shear))
    return yields, plies


def burst_pressure(axial):
    """Ply discount by hand: yielded liner keeps its line force, a cracked pair its fibres."""
    soft = [False, False, False]
    held, highest = np.zeros(3), 0.0
    for _ in range(4):
        cracked = reduced(135e9, 8.5e6, 0.3e-3, 4.3e6)
        q = [
            1e-3 * Q_AL if soft[0] else Q_AL,
            *(cracked if soft[k] else Q_PLY for k in (1, 2)),
        ]
        a = sum(pair(m, ang) * t for m, (t, ang) in zip(q, PLIES, strict=True))
        rate = np.linalg.solve(a, [axial / (2 * pi * R_M), R_M, 0])
        base = np.linalg.solve(a, -held)
        reached = []
        if not soft[0]:
            z, h, _ = Q_AL @ rate
            reached.append((YIELD_AL / sqrt(z * z - z * h + h * h), 0, "yield"))
        for k in (1, 2):
            now, at = q[k] @ turn(PLIES[k][1]) @ rate, q[k] @ turn(PLIES[k][1]) @ base
            limits = [("fibre", 0, X_T, X_C)]
            if not soft[k]:
                limits += [("matrix", 1, Y_T, Y_C), ("matrix", 2, S_12, S_12)]
            for mode, i, tension, compression in limits:
                sign = 1 if now[i] > 0 else -1
                strength = tension if sign > 0 else compression
                reached.append(((strength - sign * at[i]) / abs(now[i]), k, mode))
        p, k, mode = min(reached)
        highest = max(highest, p)
        if mode == "fibre":
            return highest
        soft[k] = True
        if mode == "yield":
            held = Q_AL @ rate * p * PLIES[0][0] * 0.999
    raise AssertionError("the ladder has no end")


def test_wall_strength(value):
    """Burst equals the hand ladder; yield and first ply are never above the stress-free wall."""
    burst = min(burst_pressure(0.0), burst_pressure(A_A)) / SUPPLY
    assert value("burst_factor") == near(burst, 1e-4)
    yields, plies = wall_pressures()
    assert min(plies) > min(yields)  # so the liner governs proof here
    # Cure stress, moisture or the exact tube may only lower these (thin laminate: no sigma_r).
    assert 0.4 < value("liner_yield_factor") * SUPPLY / min(yields) < 1 + 1e-6
    assert 0.4 < value("first_ply_factor") * SUPPLY / min(plies) < 1 + 1e-6
    lower = min(value("liner_yield_factor"), value("first_ply_factor"))
    assert value("proof_factor") == near(lower / 1.5)
    area = pi / 4 * (ROD**2 - HOLE**2)
    bending = 40 * (S + EXTENSION + EYE + (HEAD + PLATE) / 2) * ROD / 2
    bending /= pi / 64 * (ROD**4 - HOLE**4)
    rod = YIELD_STEEL / (SUPPLY * A_A / area + bending)
    skirt = YIELD_AL * 2 * pi * R_O * 2e-3 / (SUPPLY * A_A)
    assert value("yield_factor") == near(min(value("liner_yield_factor"), rod, skirt))


def test_liner_mismatch(value):
    """Cool-down from cure to the coldest state stretches the aluminium liner."""
    z, h, _ = Q_AL @ (expansion() - np.array([23.6e-6, 23.6e-6, 0])) * (268.15 - 393.15)
    assert z > 0
    assert h > 0
    assert value("liner_mismatch_factor") == near(YIELD_AL / sqrt(z * z - z * h + h * h))


def test_buckling(value):
    """Stepped pinned column: first root of tan(k1 L1)/k1 + tan(k2 L2)/k2 = 0, pole-free form."""
    radii = [R_I, R_I + 0.7e-3, R_I + 1.8e-3, R_O]
    ei_1 = 0.0
    for k in range(3):
        e_z = 1 / np.linalg.inv(pair(QS[k], PLIES[k][1]))[0, 0]
        ei_1 += e_z * pi / 4 * (radii[k + 1] ** 4 - radii[k] ** 4)
    ei_2 = E_STEEL * pi / 64 * (ROD**4 - HOLE**4)
    l_1, l_2 = EYE + 2 * PLATE + BARREL, S + EXTENSION + EYE

    def mismatch(p):
        k_1, k_2 = sqrt(p / ei_1), sqrt(p / ei_2)
        return sin(k_1 * l_1) * cos(k_2 * l_2) / k_1 + sin(k_2 * l_2) * cos(k_1 * l_1) / k_2

    low = high = 100.0
    while mismatch(high) > 0:
        low, high = high, 1.01 * high
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if mismatch(middle) > 0 else (low, middle)
    assert value("buckling_factor") == near(low / (SUPPLY * A_A))


def test_rod_end_pins_and_guides(value):
    """Thread root under pull, pin in double shear, lever of the side load at full extension."""
    root = pi / 4 * (10e-3 - 0.9382 * 1.25e-3) ** 2
    assert value("thread_factor") == near(YIELD_STEEL * root / (SUPPLY * A_B))
    shear = SUPPLY * A_A / (2 * pi / 4 * PIN**2)
    assert value("pin_factor") == near(YIELD_STEEL / sqrt(3) / shear)
    span = (PISTON + HEAD + PLATE) / 2
    reach = S + EXTENSION + EYE + (HEAD + PLATE) / 2
    groove = 1.3655 * W
    head = 40 * (reach + span) / span / (ROD * (HEAD + PLATE - groove))
    piston = 40 * reach / span / (D * (PISTON - groove))
    assert value("bearing_overlap") == near(span / ROD)
    assert value("bearing_pressure") == near(max(head, piston))
    allowed = 10e6  # a limit of the guide pair, no knock-down stated for it but temperature
    assert value("bearing_factor") <= allowed / max(head, piston) * (1 + 1e-6)


def test_retention_and_cap_stay_on_the_safe_side(value):
    """Bond: not above dry Volkersen; cap: not above the plate simply supported at the bore."""
    skirt, barrel = E_AL * 2e-3, MEMBRANE[0, 0] - MEMBRANE[0, 1] ** 2 / MEMBRANE[1, 1]
    length, stiffer = 18e-3, max(skirt, barrel)
    psi = stiffer / min(skirt, barrel)
    w = sqrt(1.2e9 * length**2 / 0.15e-3 * (1 / skirt + 1 / barrel))
    mean = SUPPLY * A_A / (2 * pi * R_O * length)  # piston at the end stop
    peak = mean * w / 2 * (1 / tanh(w / 2) + (psi - 1) / (psi + 1) * tanh(w / 2))
    assert 0.2 < value("retention_factor") * peak / BOND < 1 + 1e-6
    plate = 3 * (3 + NU_AL) / 8 * SUPPLY * (R_I / PLATE) ** 2
    assert 0.2 < value("cap_factor") * plate / YIELD_AL < 1 + 1e-6


def test_fatigue(value):
    """Goodman at the liner, the rod (push to pull) and the thread root with notch factor 3."""
    yields, _ = wall_pressures()
    root = pi / 4 * (10e-3 - 0.9382 * 1.25e-3) ** 2
    area = pi / 4 * (ROD**2 - HOLE**2)
    stresses = [(YIELD_AL * SUPPLY / p, 0.0, 159e6, 572e6) for p in yields]
    stresses.append((SUPPLY * A_B / area, -SUPPLY * A_A / area, 450e6, 1000e6))
    stresses.append((3 * SUPPLY * A_B / root, 0.0, 450e6, 1000e6))
    used = [(a - b) / 2 / s + (a + b) / 2 / u for a, b, s, u in stresses]
    # More parts, or a lower limit, may only lower it.
    assert 0.4 < value("fatigue_factor") * max(used) < 1 + 1e-6
    assert value("cycle_life") > 20000


def test_end_stop(value):
    """Bumper of stiffness p_s A_A over its travel takes kinetic energy and the surplus force."""
    k = SUPPLY * A_A / 0.9e-3
    for case, (direction, force, v, _) in CASES.items():
        surplus = net_force(case) - force
        travel = (surplus + sqrt(surplus**2 + k * MOVING * v**2)) / k
        energy = MOVING * v**2 / 2 + surplus * travel
        assert k * travel**2 / 2 == near(energy)  # the balance closes
        # The case's load still acts; dropping it may only raise the peak.
        assert value("end_stop_energy", case) >= energy * (1 - 1e-6)
        peak = DRAIN + k * travel / (A_B if direction > 0 else A_A)
        assert value("end_stop_pressure", case) >= peak * (1 - 1e-6)
    assert value("end_stop_factor") == near(1.5 * SUPPLY / value("end_stop_pressure"))


def test_trapped_oil(value):
    """Oil locked in and warmed: between the holding modulus and a rigid chamber at proof."""
    z, h, _ = expansion()
    jumps = []
    for direction, force, _, temperature in CASES.values():
        p_a = (direction * force + (SUPPLY + DRAIN) * A_B) / (A_A + A_B)
        k = max(oil_modulus(p, temperature) for p in (p_a, SUPPLY + DRAIN - p_a))
        jumps.append(8 * (7.7e-4 - z - 2 * h) / (1 / k + 2 * GROWTH / (SUPPLY * R_I)))
    rigid = 8 * 7.7e-4 * oil_modulus(1.5 * SUPPLY, 313.15)
    assert max(jumps) * (1 - 1e-6) < value("trapped_pressure") < rigid
    assert value("trapped_factor") == near(1.5 * SUPPLY / (SUPPLY + value("trapped_pressure")))


def test_extrusion_and_walls(value):
    """The largest allowed gap of 90 Shore A is 0.127 mm; walls beside grooves are what is left."""
    assert value("extrusion_factor") <= 0.127e-3 / (35e-6 + AT_SEAL) * (1 + 1e-6)
    groove = 1.3655 * W
    assert value("geometry_piston_groove") == near((PISTON - groove) / 2)
    assert value("geometry_head_groove") == near((HEAD - groove) / 2)
    assert value("geometry_piston_core") == near(R_I - W * 0.845 - 5e-3)
    assert value("geometry_head_wall") == near((D - ROD) / 2 - W * 0.87)
    assert value("geometry_rod_wall") == near((ROD - HOLE) / 2)
    # Service limits: oil and T700 to 80 degC; nothing colder than the oil's -20 degC matters.
    assert value("temperature_margin") == near(5.0)


# --- how far the thin laminate is from the exact tube --------------------------------------------


def solid(q_constants, a):
    """3-D stiffness over (z, theta, r) of a pair; the shear couplings cancel in the pair."""
    e1, e2, nu12, nu23, g12 = q_constants
    s = np.array(
        [
            [1 / e1, -nu12 / e1, -nu12 / e1],
            [-nu12 / e1, 1 / e2, -nu23 / e2],
            [-nu12 / e1, -nu23 / e2, 1 / e2],
        ]
    )
    c = np.linalg.inv(s)
    m, n = cos(a) ** 2, sin(a) ** 2
    mix = m * n
    zz = m * m * c[0, 0] + n * n * c[1, 1] + 2 * mix * (c[0, 1] + 2 * g12)
    tt = n * n * c[0, 0] + m * m * c[1, 1] + 2 * mix * (c[0, 1] + 2 * g12)
    zt = mix * (c[0, 0] + c[1, 1] - 4 * g12) + (m * m + n * n) * c[0, 1]
    zr, tr = m * c[0, 2] + n * c[1, 2], n * c[0, 2] + m * c[1, 2]
    return np.array([[zz, zt, zr], [zt, tt, tr], [zr, tr, c[2, 2]]])


def exact_growth(n=400):
    """Bore growth of the layered tube at zero axial force, by shooting u and sigma_r outwards.

    u' = (s_r - C_zr e_z - C_tr u/r)/C_rr and s_r' = (s_t - s_r)/r through every layer (Runge
    and Kutta), for (u_0, e_z) one and none; s_r(r_o) = 0 and the axial force zero give both.
    """
    metal = (E_AL, E_AL, NU_AL, NU_AL, E_AL / 2 / (1 + NU_AL))
    ply = (135e9, 8.5e9, 0.3, 0.45, 4.3e9)

    def end(u, strain, pressure):
        state, r = np.array([u, -pressure, 0.0]), R_I
        for constants, (t, a) in zip((metal, ply, ply), PLIES, strict=True):
            c, h = solid(constants, a), t / n

            def rate(r, y, c=c):
                slope = (y[1] - c[0, 2] * strain - c[1, 2] * y[0] / r) / c[2, 2]
                z, hoop, _ = c @ np.array([strain, y[0] / r, slope])
                return np.array([slope, (hoop - y[1]) / r, 2 * pi * r * z])

            for _ in range(n):
                k1 = rate(r, state)
                k2 = rate(r + h / 2, state + h / 2 * k1)
                k3 = rate(r + h / 2, state + h / 2 * k2)
                k4 = rate(r + h, state + h * k3)
                state, r = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), r + h
        return state[1:]

    columns = np.column_stack([end(1e-5, 0.0, 0.0), end(0.0, 1e-4, 0.0)])
    share = np.linalg.solve(columns, -end(0.0, 0.0, SUPPLY))
    return 1e-5 * share[0]


def test_thin_laminate_is_on_the_unsafe_side_at_the_bore(evaluation, value):
    """At t/r of 0.2 the membrane shows 80 to 90 % of the exact bore growth, and says so."""
    assert 0.80 < value("bore_growth") / exact_growth(40) < 0.90
    assert not evaluation.metrics["bore_growth"].in_range
