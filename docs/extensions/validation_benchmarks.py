"""Closed forms, benchmarks and published optima beside ours."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from math import log, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from .validation_rows import Case

ROOT = Path(__file__).resolve().parents[2]


def _lame(poisson: float) -> float:
    """Bore growth of a thick cylinder in plane strain: E 1000, radii 3 and 9, pressure 1."""
    from actuator_opt.models.barrel import bore_growth

    # e_z = 0 asks for sigma_z = nu (sigma_r + sigma_t) = 2 nu p r_i^2/(r_o^2 - r_i^2)
    return float(
        bore_growth(
            pressure=1.0, inner_radius=3.0, outer_radius=9.0, youngs_modulus=1000.0,
            poissons_ratio=poisson, axial_force=2 * poisson * pi * 3.0**2,
        )
    )  # fmt: skip


def _solid(e1: float, e2: float, nu12: float, nu23: float, g12: float) -> Any:
    from actuator_opt.models.solid_ply import solid_stiffness

    return solid_stiffness(
        youngs_modulus_1=e1, youngs_modulus_2=e2, youngs_modulus_3=e2, poissons_ratio_12=nu12,
        poissons_ratio_13=nu12, poissons_ratio_23=nu23, shear_modulus_12=g12,
    )  # fmt: skip


@cache
def _nafems(heating: float) -> tuple[float, ...]:
    """Hoop stresses of NAFEMS R0031/2 [MPa]: inner and outer face of steel, then of the wrap."""
    from actuator_opt.models.layered_tube import tube_state, tube_stresses
    from actuator_opt.models.tube_elements import TubeLayer, layered_tube

    steel = TubeLayer(
        stiffness=_solid(210e9, 210e9, 0.3, 0.3, 210e9 / 2.6), thickness=2e-3,
        expansion_1=2e-5, expansion_2=2e-5, expansion_3=2e-5,
    )  # fmt: skip
    wrap = TubeLayer(
        stiffness=_solid(130e9, 5e9, 0.25, 0.25, 10e9), thickness=2e-3, angle=pi / 2,
        expansion_1=3e-6, expansion_2=2e-5, expansion_3=2e-5,
    )  # fmt: skip
    tube = layered_tube(layers=[steel, wrap], inner_radius=23e-3)
    state = tube_state(tube=tube, inner_pressure=200e6, temperature_change=heating)
    hoop = tube_stresses(tube=tube, state=state)[1]
    return tuple(float(x) / 1e6 for x in np.asarray(hoop).T.ravel())


def _kaw(index: int) -> float:
    """Membrane stiffness of [0/30/-45], 5 mm T300 each [MN/m]."""
    from actuator_opt.models.laminate import membrane
    from actuator_opt.models.ply import ply_stiffness, rotated

    q = ply_stiffness(
        youngs_modulus_1=181e9, youngs_modulus_2=10.3e9, poissons_ratio_12=0.28,
        shear_modulus_12=7.17e9,
    )  # fmt: skip
    plies = [rotated(stiffness=q, angle=a * pi / 180) for a in (0, 30, -45)]
    return float(membrane(plies=plies, thicknesses=[5e-3] * 3)[index]) / 1e6


def _column(ratio: float, share: float) -> float:
    """Factor m of P = m E I2/l^2 of a symmetric bar, stiff over the middle share."""
    from actuator_opt.models.stepped import stepped_column_load

    return float(
        stepped_column_load(
            bending_stiffness_1=1.0, length_1=share / 2, bending_stiffness_2=ratio,
            length_2=(1 - share) / 2, ends=("fixed", "free"),
        )
    )  # fmt: skip


def _slider() -> float:
    """Load of a plane slider [N/m]: 6 mm, 5 to 2 um, 0.5 m/s, 0.03 Pa s."""
    from actuator_opt.lubrication.reynolds import Lubricant
    from actuator_opt.lubrication.smooth import Gap, solve_gap

    gap = Gap(6e-3, np.linspace(5e-6, 2e-6, 121), Lubricant(0.03), 0.5, 0.0, 0.0)
    return float(solve_gap(gap, 481).line_load)


def _slider_by_hand() -> float:
    a = 2.5
    return 6 * 0.03 * 0.5 * (6e-3 / (2e-6 * (a - 1))) ** 2 * (log(a) - 2 * (a - 1) / (a + 1))


def _sampson() -> float:
    """Creeping flow through a round hole of 1 mm radius at 100 Pa, over r^3 dp/(3 eta)."""
    from actuator_opt.models.orifice import orifice_flow

    r, eta, dp = 1e-3, 10.0, 100.0
    q = orifice_flow(
        area=pi * r**2, pressure_difference=dp, density=870.0, dynamic_viscosity=eta,
        laminar_coefficient=sqrt(1 / (12 * pi)),
    )  # fmt: skip
    return float(q) / (r**3 * dp / (3 * eta))


def _air(name: str) -> float:
    from actuator_opt.models.heat_transfer import air_properties

    return float(getattr(air_properties(temperature=288.15), name))


def _water() -> float:
    from actuator_opt.models.fluid import vapour_pressure

    table = {
        "points_temperature": (273.15, 293.15, 313.15, 333.15, 353.15),
        "points_pressure": (611.2, 2339.3, 7384.9, 19947.0, 47414.0),
    }
    return float(vapour_pressure(temperature=323.15, **table)) / 1e3


def _rainflow() -> float:
    """Sum of the ranges that E1049-85 counts in its own example of a repeating history."""
    from actuator_opt.models.rainflow import repeating_cycles

    history = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    cycles = repeating_cycles(history=history)
    return float(np.sum(cycles.count * (history[cycles.largest] - history[cycles.smallest])))


def _ishigami() -> float:
    """First-order index of the first input of Ishigami's function."""
    from actuator_opt.uncertainties import estimate

    def function(points: Any) -> Any:
        x, y, z = 2 * pi * (points - 0.5)
        return (np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x))[None]

    return float(estimate.indices(function, 3, rows=4096, seed=0).first[0, 0])


_PUBLISHED = "tests/models/test_layered_tube_published.py::"
_COLUMN = "tests/models/test_models_structure_column.py::test_table_of_timoshenko_and_gere"
_NAFEMS = "NAFEMS R0031/2, as printed in verification manuals"


def benchmarks() -> Iterator[Case]:
    """Closed forms of mechanics and printed examples."""
    for nu, growth in ((0.49, 5.0399e-3), (0.499, 5.0602e-3), (0.4999, 5.0623e-3)):
        yield Case(
            f"thick cylinder in plane strain, Poisson's ratio {nu}: bore growth",
            "MacNeal and Harder 1985", growth, lambda nu=nu: _lame(nu),
            f"{_PUBLISHED}test_nearly_incompressible_cylinder_of_macneal_and_harder",
            within=2e-5,
        )  # fmt: skip
    places = ("steel, bore", "steel, outside", "wrap, inside", "wrap, outside")
    for heating, targets in (
        (0.0, (1565.3, 1429.7, 874.7, 759.1)),
        (130.0, (1381.0, 1259.6, 1056.0, 936.1)),
    ):
        for k, target in enumerate(targets):
            warm = ", 130 K warmer" if heating else ""
            yield Case(
                f"steel tube with a hoop wrap at 200 MPa{warm}: hoop stress in {places[k]}",
                _NAFEMS, target, lambda h=heating, k=k: _nafems(h)[k],
                f"{_PUBLISHED}test_wrapped_thick_cylinder_of_nafems", "MPa", 1e-3,
            )  # fmt: skip
    for k, (name, value) in enumerate((("11", 1739.0), ("12", 388.4), ("22", 453.3))):
        yield Case(
            f"laminate [0/30/−45] of T300: A{name}", "Kaw, Mechanics of Composite Materials",
            value, lambda k=k: _kaw(k),
            "tests/models/test_models_structure_laminate.py::test_membrane_of_kaw", "MN/m", 1e-3,
        )  # fmt: skip
    for ratio, share, value in ((0.1, 0.2, 1.47), (0.2, 0.4, 4.22), (0.4, 0.6, 8.51)):
        yield Case(
            f"stepped column, stiffness ratio {ratio}, stiff over {share:.0%}: factor m",
            "{source}`TimoshenkoGere1961` table 2-10", value,
            lambda r=ratio, s=share: _column(r, s), _COLUMN,
        )  # fmt: skip
    yield Case(
        "plane slider, film ratio 2.5: load", "closed form of the Reynolds equation",
        _slider_by_hand(), _slider, "tests/lubrication/test_lubrication_smooth.py::test_slider",
        "N/m", 1e-4,
    )  # fmt: skip
    yield Case(
        "creeping flow through a round hole, over Sampson's", "Sampson's exact solution", 1.0,
        _sampson, "tests/models/test_models_orifice.py::test_creeping_flow_through_a_thin_plate",
        within=2e-3,
    )  # fmt: skip
    yield Case(
        "asperity integral F at 0, order 3/2", "{source}`GreenwoodWilliamson1966`", 0.43,
        _asperity, "tests/models/test_models_rough_surface.py::test_asperity_integral_check_values",
    )  # fmt: skip
    standard = "{source}`USStandardAtmosphere1976`"
    air = "tests/models/test_heat_transfer.py::test_air_of_the_standard_atmosphere"
    yield Case("air at 15 °C: density", standard, 1.2250, lambda: _air("density"), air, "kg/m³")
    yield Case(
        "air at 15 °C: viscosity", standard, 1.7894e-5, lambda: _air("dynamic_viscosity"), air,
        "Pa s",
    )  # fmt: skip
    yield Case(
        "vapour pressure of water at 50 °C, between points of 40 and 60 °C", "steam tables",
        12.352, _water,
        "tests/models/test_models_hydraulics_fluid.py"
        "::test_vapour_pressure_lies_between_its_points_as_in_steam_tables",
        "kPa",
    )  # fmt: skip
    yield Case(
        "rainflow example of the standard: sum of the ranges 9, 7, 4 and 3",
        "{source}`ASTM-E1049` section 5.4.5", 23.0, _rainflow,
        "tests/models/test_models_rainflow.py::test_example_of_the_standard",
    )  # fmt: skip
    variance = (1 + 0.1 * pi**4 / 5) ** 2 / 2
    whole = variance + 49 / 8 + 8 * 0.01 * pi**8 / 225
    yield Case(
        "Ishigami's function: first-order index of input 1", "{source}`Ishigami1990`, closed form",
        variance / whole, _ishigami,
        "tests/uncertainties/test_uncertainty.py::test_indices_of_ishigami", within=0.03,
    )  # fmt: skip


def _asperity() -> float:
    from actuator_opt.models.rough_surface import asperity_integral

    return float(asperity_integral(film_ratio=0.0))


# ---- optimisation ----


@cache
def _optimum(name: str) -> Any:
    sys.path.insert(0, str(ROOT / "tests" / "cases"))
    import problems

    from actuator_opt.optimisation.solver import solve

    problem = getattr(problems, name)()
    return solve(getattr(problem, "problem", problem))


def later(key: str) -> str:
    """Source of a problem whose best known value is from later literature."""
    return f"problem of {{source}}`{key}`; value of later literature"


def optima() -> Iterator[Case]:
    """Best known optima of the optimiser's test problems."""
    bench = "tests/optimisation/test_optimise_benchmarks.py::"
    hock = "{source}`HockSchittkowski1981`"
    rows = (
        ("Rosen–Suzuki (HS43)", hock, -44.0, "rosen_suzuki", "test_rosen_suzuki"),
        ("HS71", hock, 17.0140173, "hs71", "test_hs71"),
        ("stepped cantilever", "{source}`Svanberg1987`", 1.33995636, "stepped_cantilever",
         "test_stepped_cantilever"),
        ("pressure vessel, L ≤ 200", later("Sandgren1990"), 5885.332774, "pressure_vessel",
         "test_pressure_vessel"),
        ("piston lever (local optimum at 167.47)", later("Vanderplaats1984"), 8.412698323,
         "piston_lever", "test_piston_lever"),
        ("hydrostatic thrust bearing", later("Siddall1982"), 1625.442759, "thrust_bearing",
         "test_thrust_bearing"),
    )  # fmt: skip
    for subject, source, value, name, test in rows:
        yield Case(
            f"{subject}: optimum", source, value, lambda n=name: _optimum(n).objective,
            bench + test, within=1e-8,
        )  # fmt: skip
    yield Case(
        "HS43: multiplier of the third limit", hock, 2.0,
        lambda: _optimum("rosen_suzuki").kkt.multipliers[-1], bench + "test_rosen_suzuki",
        within=1e-8,
    )  # fmt: skip
    yield Case(
        "HS71: multiplier of the product", hock, 0.552294,
        lambda: _optimum("hs71").kkt.multipliers[0], bench + "test_hs71", within=1e-6,
    )  # fmt: skip
