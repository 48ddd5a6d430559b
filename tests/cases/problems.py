"""Optimisation problems with known optima, written in the form of `optimise.problem`.

Each returns a `BoxProblem`; sources and known results are in the docstrings. Inputs are
(n, k) arrays, real or complex.
"""

from __future__ import annotations

import numpy as np

from actuator_opt.optimisation.problem import BoxProblem, ParametricProblem, PointValues


def rosen_suzuki() -> BoxProblem:
    """HS43 [HockSchittkowski1981]: f* = -44 at (0, 1, 2, -1), multipliers (1, 0, 2)."""

    def evaluate(x):
        a, b, c, d = x
        f = a**2 + b**2 + 2 * c**2 + d**2 - 5 * a - 5 * b - 21 * c + 7 * d
        g = [
            8 - a**2 - b**2 - c**2 - d**2 - a + b - c + d,
            10 - a**2 - 2 * b**2 - c**2 - 2 * d**2 + a + d,
            5 - 2 * a**2 - b**2 - c**2 - 2 * a + b + d,
        ]
        return PointValues(f, np.stack(g))

    bound = np.full(4, 10.0)
    return BoxProblem(("x1", "x2", "x3", "x4"), -bound, bound, evaluate, ("g1", "g2", "g3"))


def hs71() -> BoxProblem:
    """HS71 [HockSchittkowski1981]: f* = 17.0140173, multiplier of the product 0.552294."""

    def evaluate(x):
        a, b, c, d = x
        f = a * d * (a + b + c) + c
        return PointValues(f, (a * b * c * d - 25)[None], (a**2 + b**2 + c**2 + d**2 - 40)[None])

    names = ("x1", "x2", "x3", "x4")
    return BoxProblem(
        names,
        np.ones(4),
        5 * np.ones(4),
        evaluate,
        ("product",),
        ("sphere",),
        start=np.array([1.0, 5, 5, 1]),
    )


CANTILEVER_COEFFICIENTS = np.array([61.0, 37.0, 19.0, 7.0, 1.0])


def stepped_cantilever() -> ParametricProblem:
    """Five-segment cantilever [Svanberg1987]: f* = 1.33995636, proportional to limit**(-1/3)."""

    def evaluate(x, p):
        deflection = (CANTILEVER_COEFFICIENTS[:, None] / x**3).sum(axis=0)
        return PointValues(p[1] * x.sum(axis=0), (1 - deflection / p[0])[None])

    p = np.array([1.0, 0.0624])
    n = 5
    problem = BoxProblem(
        tuple(f"x{i + 1}" for i in range(n)),
        np.full(n, 0.1),
        np.full(n, 100.0),
        lambda x: evaluate(x, p[:, None]),
        ("deflection",),
    )
    return ParametricProblem(problem, ("limit", "density"), p, evaluate)


def pressure_vessel() -> ParametricProblem:
    """Pressure vessel with continuous gauges [Sandgren1990], L <= 200: f* = 5885.332774."""

    def evaluate(x, p):
        shell, head, radius, length = x
        f = (
            0.6224 * shell * radius * length
            + 1.7781 * head * radius**2
            + 3.1661 * shell**2 * length
            + 19.84 * shell**2 * radius
        )
        volume = np.pi * radius**2 * length + 4 / 3 * np.pi * radius**3
        g = [
            shell / (p[0] * radius) - 1,
            head / (p[1] * radius) - 1,
            volume / p[2] - 1,
            1 - length / 240,
        ]
        return PointValues(f, np.stack(np.broadcast_arrays(*g)))

    p = np.array([0.0193, 0.00954, 1296000.0])
    problem = BoxProblem(
        ("shell", "head", "radius", "length"),
        np.array([0.0625, 0.0625, 10, 10]),
        np.array([6.1875, 6.1875, 200, 200]),
        lambda x: evaluate(x, p[:, None]),
        ("shell stress", "head stress", "volume", "length limit"),
    )
    return ParametricProblem(problem, ("shell ratio", "head ratio", "volume"), p, evaluate)


def piston_lever() -> BoxProblem:
    """Hydraulic lift [Vanderplaats1984]: f* = 8.412698323, a bad local optimum at 167.47.

    Oil volume needed to raise a load of 10 000 on a lever by 45 degrees; published at
    (0.05, 2.04151359, 4.08302718, 120).
    """
    angle, load, lever, most_moment, pressure = np.pi / 4, 1e4, 240.0, 1.8e6, 1500.0

    def evaluate(x):
        h, b, d, xx = x
        s, c = np.sin(angle), np.cos(angle)
        first = np.sqrt((xx - b) ** 2 + h**2)
        second = np.sqrt((xx * s + h) ** 2 + (b - xx * c) ** 2)
        arm = -xx * (xx * s + h) + h * (b - xx * c)
        arm = np.where(arm.real < 0, -arm, arm) / first
        force = np.pi * pressure * d**2 / 4
        travel = second - first
        g = [
            arm * force / (load * lever * c) - 1,
            1 - load * (lever - xx) / most_moment,
            1 - 1.2 * travel / first,
            b / (d / 2) - 1,
        ]
        return PointValues(np.pi * d**2 * travel / 4, np.stack(g))

    return BoxProblem(
        ("H", "B", "D", "X"),
        np.full(4, 0.05),
        np.array([500.0, 500, 500, 120]),
        evaluate,
        ("force", "moment", "travel", "room"),
    )


def thrust_bearing() -> BoxProblem:
    """Hydrostatic thrust bearing [Siddall1982]: f* = 1625.442759 (power loss / 12).

    Published at R 5.95578050, R0 5.38901305, mu 5.35869727e-6, Q 2.26965596.
    """
    gamma, heat, n, c1, speed = 0.0307, 0.5, -3.55, 10.04, 750.0

    def evaluate(x):
        r, r0, mu, q = x
        exponent = (np.log10(np.log10(8.122e6 * mu + 0.8)) - c1) / n
        rise = 2 * (10**exponent - 560)
        loss = 9336 * q * gamma * heat * rise
        film = (2 * np.pi * speed / 60) ** 2 * 2 * np.pi * mu / loss * (r**4 - r0**4) / 4
        pressure = 6 * mu * q / (np.pi * film**3) * np.log(r / r0)
        capacity = np.pi * pressure / 2 * (r**2 - r0**2) / np.log(r / r0)
        g = [
            capacity / 101000 - 1,
            1 - pressure / 1000,
            1 - rise / 50,
            film / 0.001 - 1,
            r / r0 - 1,
            1 - gamma / (386.4 * pressure) * (q / (2 * np.pi * r * film)) / 0.001,
            1 - capacity / (np.pi * (r**2 - r0**2)) / 5000,
        ]
        return PointValues((q * pressure / 0.7 + loss) / 12, np.stack(g))

    return BoxProblem(
        ("R", "R0", "mu", "Q"),
        np.array([1, 1, 1e-6, 1.0]),
        np.array([16, 16, 16e-6, 16.0]),
        evaluate,
        ("load", "inlet", "temperature", "film", "radii", "inertia", "contact"),
    )


def two_pieces() -> BoxProblem:
    """Two discs apart: f* = 4 - 0.3 sqrt(2) in the smaller, at (2 - 0.3/sqrt(2)) twice.

    Minimise x + y inside the disc about (7, 7) of radius 2.5 or that about (2, 2) of radius 0.3:
    f is least at the centre minus the radius along (1, 1)/sqrt(2), so 10.4645 in the larger one.
    """

    def evaluate(x):
        large, small = (
            (x[0] - c) ** 2 / r**2 + (x[1] - c) ** 2 / r**2 - 1 for c, r in ((7, 2.5), (2, 0.3))
        )
        return PointValues(x[0] + x[1], (-large * small)[None])

    return BoxProblem(("x", "y"), np.full(2, 0.5), np.full(2, 10.0), evaluate, ("in a disc",))


def geometric_programme(seed: int, n: int = 12, m: int = 24, q: int = 15) -> ParametricProblem:
    """Return a random posynomial programme in n variables with q limits of m constraints."""
    generator = np.random.default_rng(seed)
    cost = generator.uniform(0.5, 2, n)
    powers = np.where(generator.random((n, n)) < 0.3, generator.normal(size=(n, n)), 0.0)
    np.fill_diagonal(powers, 1.0)
    exponents = generator.normal(size=(m, 4, n)) * (generator.random((m, 4, n)) < 0.35)
    factors = generator.uniform(0.05, 0.35, (m, 4))
    rows = generator.choice(m, q, replace=False)
    p = np.ones(q)

    def evaluate(x, p):
        logs = np.log(x)
        f = (cost[:, None] * np.exp(powers @ logs)).sum(axis=0)
        used = (factors[:, :, None] * np.exp(exponents @ logs)).sum(axis=1)
        limits = np.ones((m, p.shape[1]), dtype=p.dtype)
        limits[rows] = p
        return PointValues(f, 1 - used / limits)

    problem = BoxProblem(
        tuple(f"x{i}" for i in range(n)),
        np.full(n, 0.05),
        np.full(n, 20.0),
        lambda x: evaluate(x, p[:, None]),
        tuple(f"g{i}" for i in range(m)),
    )
    return ParametricProblem(problem, tuple(f"limit {k}" for k in rows), p, evaluate)
