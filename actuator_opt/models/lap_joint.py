"""Shear in the adhesive of a bonded overlap: from axial force, and from differential expansion."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

from ..base.numeric import (
    Array,
    absolute,
    geometry,
    maximum,
    minimum,
    namespace,
    positive,
    real,
    sqrt,
    where,
)


def _edge_ratio(*, loaded: Array, free: Array, reach: Array) -> Array:
    """Ratio of edge shear to mean shear, as in `bond_edge_shear`.

    `loaded` is K_l, `free` is K_f, and `reach` is G L^2/t_a.
    """
    half = sqrt(positive(reach * (1 / loaded + 1 / free))) / 2
    wave = namespace(half).tanh(half)
    return half * ((1 / wave - wave) + 2 * free / (free + loaded) * wave)  # no term below zero


@geometry
def least_bond_peak_ratio(
    *,
    shear_modulus: Array,
    bond_thickness: Array,
    length: Array,
    membrane_stiffness: Array,
) -> Array:
    """Lower bound on the ratio of peak to mean shear in a bonded overlap, from one wall's data.

    (w/2) coth(w/2), w^2 = 2 G L^2/(t_a K). This is the exact ratio for two walls of equal
    stiffness K; if the second wall is stiffer or softer, the ratio is higher.

    Parameters
    ----------
    shear_modulus : G of the adhesive [Pa]
    bond_thickness : t_a of the adhesive [m]
    length : L, overlap [m]
    membrane_stiffness : K, axial E t of either wall [N/m]

    Returns
    -------
    lower bound on the ratio of peak to mean [-]

    Notes
    -----
    Valid: as `bond_edge_shear`; exact for equal walls.

    At the edge where wall 2 ends and wall 1 carries the whole force,
    tau ~ (coth(w)/K_1 + csch(w)/K_2)/w with w^2 = (G L^2/t_a)(1/K_1 + 1/K_2). This falls as 1/K_2
    rises, because 2 sinh w <= w + sinh w cosh w and sinh w <= w cosh w.

    References
    ----------
    [derived] from [Volkersen1938]

    Examples
    --------
    >>> r = least_bond_peak_ratio(shear_modulus=1e9, bond_thickness=0.2e-3, length=20e-3,
    ...                           membrane_stiffness=50e6)
    >>> print(f"{r:.4f}")
    4.4733
    """
    half = length * sqrt(shear_modulus / (2 * bond_thickness * membrane_stiffness))
    return half / namespace(half).tanh(half)


@geometry
def bond_edge_shear(
    *,
    force: Array,
    diameter: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_loaded: Array,
    membrane_stiffness_free: Array,
) -> Array:
    """Shear stress at one edge of a bonded cap.

    Call it for each edge: the stress at one edge is a smooth function, but the larger of both has a
    kink where they are equal.

    tau = F/(pi D L) (w/2) [coth(w/2) + ((K_f - K_l)/(K_f + K_l)) tanh(w/2)],
    w^2 = (G L^2/t_a)(1/K_l + 1/K_f); K_l belongs to the wall that carries the whole force at this
    edge, K_f to the wall that ends here.

    Parameters
    ----------
    force : axial force through the bond [N]
    diameter : diameter of the bond surface [m]
    length : overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_loaded, membrane_stiffness_free : K_l and K_f, axial E t of the walls [N/m]

    Returns
    -------
    shear stress at the edge [Pa]

    Notes
    -----
    Valid: linear adhesive, walls thin compared with the radius, no peel.

    A ductile adhesive levels the peak, so the result is conservative. Length beyond w of about 5
    does not lower the peak. For a plug or a thick sleeve take K = E A/(pi D), with D of the bond.

    References
    ----------
    [Volkersen1938] shear lag of a lap joint

    Examples
    --------
    >>> common = dict(force=10e3, diameter=30e-3, length=20e-3, shear_modulus=1e9,
    ...               bond_thickness=0.2e-3)
    >>> tau = bond_edge_shear(**common, membrane_stiffness_loaded=50e6,
    ...                       membrane_stiffness_free=100e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    27.41 MPa
    """
    ratio = _edge_ratio(
        loaded=membrane_stiffness_loaded,
        free=membrane_stiffness_free,
        reach=shear_modulus / bond_thickness * length * length,
    )
    return force / (pi * diameter * length) * ratio


@geometry
def bond_thermal_shear(
    *,
    strain_difference: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_1: Array,
    membrane_stiffness_2: Array,
) -> Array:
    """Shear stress at an edge of a bonded overlap whose walls change length unequally.

    tau = (G L/t_a) (e_l - e_f) tanh(w/2)/w, w as in `bond_edge_shear`; the other edge has -tau.
    It adds to the shear of a tensile force from `bond_edge_shear`; l is the wall that carries that
    force at this edge, f the wall that ends here.

    Parameters
    ----------
    strain_difference : e_l - e_f, free axial strains alpha dT (and swelling) of both walls [-]
    length : L, overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_1, membrane_stiffness_2 : axial E t of both walls, either order [N/m]

    Returns
    -------
    shear stress at the edge [Pa]

    Notes
    -----
    Valid: as `bond_edge_shear`; stress-free at the reference temperature (cure).

    `layered_tube` gives the radial stress from unequal hoop expansion.

    References
    ----------
    [derived] Volkersen's tau'' = (w/L)^2 tau with tau' = (G/t_a)(e_f - e_l) at both edges

    Examples
    --------
    >>> tau = bond_thermal_shear(strain_difference=22e-6 * 100, length=20e-3, shear_modulus=1e9,
    ...                          bond_thickness=0.2e-3, membrane_stiffness_1=100e6,
    ...                          membrane_stiffness_2=50e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    28.38 MPa
    """
    lag = shear_modulus / bond_thickness
    flex = 1 / membrane_stiffness_1 + 1 / membrane_stiffness_2
    decay = sqrt(positive(lag * flex))
    return lag * strain_difference / decay * namespace(decay).tanh(decay * length / 2)


STEPS, NONE, FAR = 12, 1e-12, 300.0
"""Newton steps for the elastic length of a bond; their least plastic strain and slope, and the
largest length in their hyperbolic cosine."""


@geometry
def ultimate_line_force(
    *,
    strain_difference: Array,
    length: Array,
    strength: Array,
    shear_modulus: Array,
    plastic_shear_strain: Array,
    bond_thickness: Array,
    membrane_stiffness_loaded: Array,
    membrane_stiffness_free: Array,
) -> Array:
    """Force per circumference at which one edge of a ductile bond breaks, with unequal expansion.

    N = K_l (sqrt(2 t_a U (1/K_l + 1/K_f)) - (e_l - e_f)), at most tau_p L, with
    U = tau_p (gamma_p + gamma_e/2 tanh^2 y), gamma_e = tau_p/G. Between the plastic zones of both
    edges, a length 2 y/lambda stays elastic, lambda = sqrt(G (1/K_l + 1/K_f)/t_a). It is what the
    zones leave of L; in a long overlap, U is the area under the adhesive's shear curve. In a
    ductile adhesive, the stresses of force and temperature do not add; their strains do.

    Parameters
    ----------
    strain_difference : e_l - e_f, free axial strains of both walls [-]
    length : L, overlap [m]
    strength : tau_p, shear strength of the adhesive [Pa]
    shear_modulus : G of the adhesive [Pa]
    plastic_shear_strain : gamma_p, shear strain at failure less the elastic one [-]
    bond_thickness : t_a of the adhesive [m]
    membrane_stiffness_loaded, membrane_stiffness_free : K_l of the wall that carries the whole
        force at this edge, and K_f of the wall that ends here [N/m]

    Returns
    -------
    force per circumference [N/m]; 0 where the expansion alone breaks the edge

    Notes
    -----
    Valid: any overlap, elastic walls, adhesive elastic, then plastic at tau_p.

    In the elastic middle, the shear strain is gamma_e cosh(lambda x)/cosh(y). Its slope at both
    ends is g = lambda gamma_e tanh(y). From there it rises by z = tau_p (1/K_l + 1/K_f)/t_a per
    length, to s = sqrt(g^2 + 2 z gamma_p) at this edge and to r = (N/K_f - e_l + e_f)/t_a at the
    other: L = (s - g)/z + max(r - g, 0)/z + 2 y/lambda, solved by `STEPS` Newton steps. If the
    other edge stays elastic (r < g), the middle ends there earlier, and N is a lower bound.

    References
    ----------
    [Rice1968] J integral; [HartSmith1973] elastic-plastic adhesive; [derived] J of the shear lag

    Examples
    --------
    >>> line_force = ultimate_line_force(strain_difference=6e-4, length=60e-3, strength=28e6,
    ...     shear_modulus=1.2e9, plastic_shear_strain=0.1, bond_thickness=0.15e-3,
    ...     membrane_stiffness_loaded=120e6, membrane_stiffness_free=140e6)
    >>> print(f"{line_force / 1e3:.3f} N/mm")
    385.209 N/mm
    """
    flex = 1 / membrane_stiffness_loaded + 1 / membrane_stiffness_free
    lag = sqrt(shear_modulus * flex / bond_thickness)
    size = strength * flex / lag  # slip per length that is z/lambda: the unit of all slopes below
    brittle = 2 * maximum(plastic_shear_strain, NONE) * shear_modulus / strength
    ratio = membrane_stiffness_loaded / membrane_stiffness_free
    y = lag * length / 2
    xp = namespace(y)
    for _ in range(STEPS):
        wave = xp.tanh(y)
        edge = sqrt(wave**2 + brittle)
        other = ratio * edge - (1 + ratio) * strain_difference / size
        bent = wave * (1 - wave**2) / edge
        grown = xp.exp(minimum(y, FAR))
        cosine = (grown + 1 / grown) / 2
        slip, turn = other * cosine, (ratio * bent + other * wave) * cosine
        short = xp.log(absolute(slip) + sqrt(slip**2 + 1))
        yields = real(other) > real(wave)
        beyond = where(yields, other - wave + y, where(real(slip) > 0, short, -short))
        growth = where(yields, ratio * bent + wave**2, turn / sqrt(slip**2 + 1))
        excess = edge - wave + y + beyond - lag * length
        change = bent + wave**2 + growth
        y = maximum(y - excess / maximum(change, NONE), 0.0)
    reach = size * sqrt(xp.tanh(y) ** 2 + brittle) - strain_difference
    return minimum(maximum(membrane_stiffness_loaded * reach, 0.0), strength * length)


@geometry
def edge_peel(
    *,
    shear: Array,
    adhesive_modulus: Array,
    bond_thickness: Array,
    skirt_modulus: Array,
    skirt_poissons_ratio: Array,
    skirt_thickness: Array,
) -> Array:
    """Peel stress at the free edge of an outer skirt, from the shear stress there.

    sigma = tau (3 E_a (1 - nu^2) t_s/(E_s t_a))^(1/4): the skirt is a beam on the adhesive, bent by
    the shear on its inner face.

    Parameters
    ----------
    shear : tau at the edge [Pa]
    adhesive_modulus : E_a, Young's modulus of the adhesive [Pa]
    bond_thickness : t_a of the adhesive [m]
    skirt_modulus, skirt_poissons_ratio : E_s and nu of the skirt [Pa], [-]
    skirt_thickness : t_s [m]

    Returns
    -------
    stress across the bond [Pa]

    Notes
    -----
    Valid: long overlap, a wall that is thicker than the skirt, shear constant near the edge.

    Shear that falls off from the edge gives less. The skirt's hoop stiffness, which is left out,
    lowers the result by 2 to 4 %.

    References
    ----------
    [HartSmith1973]; [derived] beam on an elastic foundation

    Examples
    --------
    >>> sigma = edge_peel(shear=28e6, adhesive_modulus=3e9, bond_thickness=0.15e-3,
    ...                   skirt_modulus=71.7e9, skirt_poissons_ratio=0.33, skirt_thickness=2e-3)
    >>> print(f"{sigma / 1e6:.4f} MPa")
    30.9425 MPa
    """
    plate = skirt_modulus / (1 - skirt_poissons_ratio * skirt_poissons_ratio)
    ratio = 3 * adhesive_modulus * skirt_thickness / (plate * bond_thickness)
    return shear * sqrt(sqrt(ratio))


class DoubleLap(NamedTuple):
    """Shear of the outer and the inner bond at both edges [Pa], and forces in both skirts [N].

    `at_skirts` is the edge where the skirts end and the tube is loaded, `at_tube` the edge where
    the tube ends. The forces are those at the tube's edge, where the cap holds the skirts.
    """

    outer_at_skirts: Array
    inner_at_skirts: Array
    outer_at_tube: Array
    inner_at_tube: Array
    outer_force: Array
    inner_force: Array


@geometry
def double_lap(
    *,
    force: Array,
    strain_difference: Array,
    length: Array,
    outer_bond_diameter: Array,
    inner_bond_diameter: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    tube_stiffness: Array,
    outer_stiffness: Array,
    inner_stiffness: Array,
) -> DoubleLap:
    """Edge shear of a tube that is bonded between two skirts, from force and unequal expansion.

    F_j'' = c_j [F_j/A_j - (F - F_o - F_i)/A_b - d], c_j = pi D_j G/t_a, for j = o, i, with
    F_j = 0 at the skirts' edge; at the tube's edge F_o + F_i = F, and both skirts move alike.
    tau_j = F_j'/(pi D_j).

    Parameters
    ----------
    force : F, tension through the joint [N]
    strain_difference : d, free axial strain of the tube minus that of the skirts [-]
    length : L, overlap of both skirts [m]
    outer_bond_diameter, inner_bond_diameter : D_o and D_i of both bond surfaces [m]
    shear_modulus, bond_thickness : G and t_a of the adhesive [Pa], [m]
    tube_stiffness, outer_stiffness, inner_stiffness : A_b, A_o, A_i, each E A of a wall [N]

    Returns
    -------
    shear at the four edges [Pa], positive as tension causes it, and forces in the skirts [N]

    Notes
    -----
    Valid: as `bond_edge_shear`; a rigid cap. The tube strains evenly through its thickness.

    With F' = M F - c (F/A_b + d), the solution is F = p - sinh(R (L - x)) sinh(R L)^-1 p +
    sinh(R x) sinh(R L)^-1 (F(L) - p), where R^2 = M and p has equal strain in every wall. A
    function f of the matrix M with eigenvalues a and b is (f(a) + f(b))/2 + (f(a) - f(b))/(a - b)
    (M - (a + b)/2).

    References
    ----------
    [Volkersen1938] shear lag; [derived] three bars

    Examples
    --------
    >>> around = 3.141592653589793 * 28e-3
    >>> edges = double_lap(force=7273.57, strain_difference=0.0, length=16e-3,
    ...     outer_bond_diameter=28e-3, inner_bond_diameter=28e-3, shear_modulus=1.2e9,
    ...     bond_thickness=0.15e-3, tube_stiffness=120e6 * around,
    ...     outer_stiffness=140e6 * around, inner_stiffness=140e6 * around)
    >>> print(f"{edges.outer_at_skirts / 1e6:.4f} {edges.inner_at_tube / 1e6:.5f}")
    12.6408 5.43661
    """
    lag = pi * shear_modulus / bond_thickness
    outer, inner = lag * outer_bond_diameter, lag * inner_bond_diameter
    strain = (force + strain_difference * tube_stiffness) / (
        tube_stiffness + outer_stiffness + inner_stiffness
    )
    even = (outer_stiffness * strain, inner_stiffness * strain)  # p
    matrix = (
        (outer * (1 / outer_stiffness + 1 / tube_stiffness), outer / tube_stiffness),
        (inner / tube_stiffness, inner * (1 / inner_stiffness + 1 / tube_stiffness)),
    )
    middle, half = (matrix[0][0] + matrix[1][1]) / 2, (matrix[0][0] - matrix[1][1]) / 2
    spread = sqrt(positive(half * half + matrix[0][1] * matrix[1][0]))
    high = middle + spread
    low = (matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]) / high
    near, far = zip(*(_decays(sqrt(positive(value)), length) for value in (high, low)), strict=True)

    def applied(values: tuple[Array, Array], at: tuple[Array, Array]) -> tuple[Array, Array]:
        mean, slope = (values[0] + values[1]) / 2, (values[0] - values[1]) / (2 * spread)
        return (
            (mean + slope * half) * at[0] + slope * matrix[0][1] * at[1],
            slope * matrix[1][0] * at[0] + (mean - slope * half) * at[1],
        )

    kept = applied(far, even)
    unshared = applied(near, (-even[0], force - even[1]))
    moved = applied(near, (1.0, -1.0))
    start = (kept[0] + unshared[0]) / outer - (kept[1] + unshared[1]) / inner
    outer_force = start / (moved[1] / inner - moved[0] / outer)
    rest = (outer_force - even[0], force - outer_force - even[1])
    first, across = applied(near, even), applied(far, rest)
    last = applied(near, rest)
    surfaces = (pi * outer_bond_diameter, pi * inner_bond_diameter)
    return DoubleLap(
        (first[0] + across[0]) / surfaces[0],
        (first[1] + across[1]) / surfaces[1],
        (kept[0] + last[0]) / surfaces[0],
        (kept[1] + last[1]) / surfaces[1],
        outer_force,
        force - outer_force,
    )


def _decays(rate: Array, length: Array) -> tuple[Array, Array]:
    """Return rate coth(rate length) and rate / sinh(rate length)."""
    fall = namespace(rate).exp(-rate * length)
    rest = 1 - fall * fall
    return rate * (1 + fall * fall) / rest, 2 * rate * fall / rest


CELLS = 40
"""Number of cells over a taper, our choice. Edge shears are then within 0.1 % for a taper of up to
14 decay lengths, and within 0.002 % for up to 5.6."""


class TaperedLap(NamedTuple):
    """Shear at both edges of a tapered lap [Pa], positive as tension causes it.

    `at_tip` is the edge where the skirt ends, `at_tube` the edge where the tube ends.
    """

    at_tip: Array
    at_tube: Array


@geometry
def tapered_lap(
    *,
    line_force: Array,
    strain_difference: Array,
    length: Array,
    taper_length: Array,
    tip: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    skirt_stiffness: Array,
    tube_stiffness: Array,
) -> TaperedLap:
    """Edge shear of a tube bonded to a skirt that tapers to its free end.

    N_s'' = k [N_s (1/K_s(x) + 1/K_b) - N/K_b - d], k = G/t_a, N_s(0) = 0, N_s(L) = N; tau = N_s'.
    K_s rises linearly from the tip over the taper, and is then constant.

    Parameters
    ----------
    line_force : N, force per circumference of the bond [N/m]
    strain_difference : d, free axial strain of the tube minus that of the skirt [-]
    length : L, overlap [m]
    taper_length : length of the taper, at most L [m]
    tip : thickness of the skirt's tip / thickness of its wall, above 0, at most 1 [-]
    shear_modulus, bond_thickness : G and t_a of the adhesive [Pa], [m]
    skirt_stiffness, tube_stiffness : K of the untapered skirt and K_b, axial E t [N/m]

    Returns
    -------
    shear at the skirt's tip and at the tube's edge [Pa]

    Notes
    -----
    Valid: as `bond_edge_shear`; tip at least 0.05, taper up to 14 sqrt(K t_a/G).

    With 1/K = 1/K_s + 1/K_b, the error is then below 0.1 %. Shear is largest at an edge. The
    taper has `CELLS` cells whose lengths grow with the square root of the thickness, as the
    decay length does. With N_s = sqrt(x_t) phi, phi'' = (x_t^2 g + 3/4 (x_tt/x_t)^2) phi - f is
    solved by Numerov's method, of fourth order. Beyond the taper, the solution is exact.

    References
    ----------
    [Volkersen1938] shear lag; [HartSmith1973] tapered joints; [derived] Liouville's transformation

    Examples
    --------
    >>> edges = tapered_lap(line_force=82.6875e3, strain_difference=0.0, length=16e-3,
    ...     taper_length=16e-3, tip=0.2, shear_modulus=1.2e9, bond_thickness=0.15e-3,
    ...     skirt_stiffness=140e6, tube_stiffness=120e6)
    >>> print(f"{edges.at_tip / 1e6:.3f} {edges.at_tube / 1e6:.3f}")
    11.361 14.907
    """
    lag = shear_modulus / bond_thickness
    supply = lag * (line_force / tube_stiffness + strain_difference)
    root = sqrt(positive(tip))
    rise, scale = 1 - root, 2 * taper_length / (1 + root)  # x_t = scale * kappa
    square = scale * scale
    curve, load = [], []
    for kappa in (root + rise * (i * _STEP) for i in range(CELLS + 1)):
        turn = rise / kappa
        curve.append(
            square * (lag / skirt_stiffness + lag * kappa * kappa / tube_stiffness)
            + 0.75 * turn * turn
        )
        load.append(square * supply * kappa * sqrt(kappa))
    cells = _Numerov.of(curve, load)
    (gradient, end), (offset, rest) = cells.end_slopes()
    gradient, offset = (gradient + rise * end / 2) / scale, (offset + rise * rest / 2) / scale
    flex = 1 / skirt_stiffness + 1 / tube_stiffness
    rate, even = sqrt(positive(lag * flex)), supply / (lag * flex)
    fall = namespace(rate).exp(-rate * (length - taper_length))
    both = 1 + fall * fall
    tangent, cut = (1 - fall * fall) / both, 2 * fall / both
    lead = tangent / rate
    reached = (line_force - even) * cut
    value = (reached + even - lead * offset - rest) / (lead * gradient + end)
    at_end = gradient * value + offset
    at_tube = rate * (line_force - even) * tangent + at_end * cut
    return TaperedLap(cells.start_slope(value) / (scale * sqrt(root)), at_tube)


_STEP = 1 / CELLS
_PART = _STEP * _STEP / 12


class _Numerov(NamedTuple):
    """Numerov's equations of phi'' = curve phi - load over the unit length, with phi = 0 at 0.

    With y_i = (1 - curve_i step^2/12) phi_i + load_i step^2/12, elimination from the start leaves
    y_i = shares_i y_(i+1) + sums_i; `scales` are phi per y.
    """

    curve: Sequence[Array]
    load: Sequence[Array]
    scales: Sequence[Array]
    shares: Sequence[Array]
    sums: Sequence[Array]

    @classmethod
    def of(cls, curve: Sequence[Array], load: Sequence[Array]) -> _Numerov:
        """Eliminate from the start."""
        scales = [1 / (1 - _PART * value) for value in curve]
        shares, sums = [0.0], [_PART * load[0]]
        for i in range(1, CELLS):
            share = 1 / (12 * scales[i] - 10 - shares[-1])
            sums.append(share * (sums[-1] + 12 * _PART * load[i] * scales[i]))
            shares.append(share)
        return cls(curve, load, scales, shares, sums)

    def end_slopes(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Slope and value at the end, as factors of y there and as constants."""
        curve, load = self.curve, self.load
        chain: list[tuple[Array, Array]] = [(1.0, 0.0)]
        for i in range(CELLS - 1, CELLS - 4, -1):
            slope, constant = chain[-1]
            chain.append((self.shares[i] * slope, self.shares[i] * constant + self.sums[i]))
        nodes = range(CELLS, CELLS - 4, -1)
        grown = [
            (slope * self.scales[i], (constant - _PART * load[i]) * self.scales[i])
            for i, (slope, constant) in zip(nodes, chain, strict=True)
        ]
        bent = [
            (curve[i] * a, curve[i] * b - load[i]) for i, (a, b) in zip(nodes, grown, strict=True)
        ]
        gradient, offset = (
            (grown[0][j] - grown[1][j]) / _STEP + _STEP * _end_slope([one[j] for one in bent])
            for j in (0, 1)
        )
        return (gradient, grown[0][0]), (offset, grown[0][1])

    def start_slope(self, value: Array) -> Array:
        """Slope at the start, from y at the end."""
        first: list[Array] = [0.0] * 4
        for i in range(CELLS - 1, 0, -1):
            value = self.shares[i] * value + self.sums[i]
            if i < 4:
                first[i] = (value - _PART * self.load[i]) * self.scales[i]
        slopes = [self.curve[i] * phi - self.load[i] for i, phi in enumerate(first)]
        return first[1] / _STEP - _STEP * _end_slope(slopes)


def _end_slope(second: Sequence[Array]) -> Array:
    """Correction of the one-sided slope at an end by four second derivatives, from the end inwards.

    It is exact for polynomials of fifth order.
    """
    return (97 * second[0] + 114 * second[1] - 39 * second[2] + 8 * second[3]) / 360
