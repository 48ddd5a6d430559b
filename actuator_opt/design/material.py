"""Material data: properties with source, scatter, confidence and basis; fits of secant damping.

All values are SI. A property may be a table over temperature or pressure; its `value` is then
the value at the reference point, and scaling it scales the table.

Fits of the secant damping B (friction divided by speed) versus speed minimise sum w (B - B_fit)^2
over the measured points. The weights w are equal unless given; w = 1/B^2 fits relative errors.
Linear parameters are eliminated, so only exponents are searched [GolubPereyra1973], from every
start of a grid. Confidence bounds follow from the linearised model and Student's t [SeberWild1989].
They assume independent points: if the points are read from a smooth curve, the bounds show how
badly the law fits, not scatter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Any, Final

import numpy as np

from ..base import fitting as least_squares
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, Fault, InputError
from ..base.fitting import WEAK, Parameter, known
from ..base.kinds import Kinds
from ..base.numeric import STEP, Array, maximum, real, where
from ..base.quantities import MATERIAL_PROPERTIES, Quantity
from ..models import damping as laws
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from .structure import FileView, MaterialLookup, Properties, child_at

KINDS: Final = ("metal", "ply", "polymer", "fluid", "seal", "adhesive")
CONFIDENCES: Final = ("verified", "secondary", "unverified", "derived")
BASES: Final = ("typical", "mean", "A", "B", "S", "minimum", "maximum", "limit", "nominal")
FAMILIES: Final = ("mineral", "ester", "phosphate_ester", "water_glycol")
"""Fluid families; a seal compound's `suits` lists the families that it withstands."""
ROLES: Final[Mapping[str, tuple[str, ...]]] = {
    "structural": ("metal", "ply", "polymer"),
    "isotropic": ("metal", "polymer"),
    "fluid": ("fluid",),
    "seal": ("seal",),
    "fastening": ("metal", "adhesive"),
    "adhesive": ("adhesive",),
}
"""Kinds of material that each role in a design accepts."""

REQUIRED: Final[Mapping[str, tuple[str, ...]]] = {
    "metal": ("density", "youngs_modulus", "poissons_ratio"),
    "polymer": ("density", "youngs_modulus", "poissons_ratio"),
    "ply": ("density",),
    "fluid": ("density", "kinematic_viscosity", "bulk_modulus", "volume_expansion"),
    "seal": ("density", "hardness", "friction_coefficient"),
    "adhesive": ("bond_strength", "shear_modulus"),
}
PLY_REQUIRED: Final = (
    "youngs_modulus_1", "youngs_modulus_2", "shear_modulus_12", "poissons_ratio_12",
)  # fmt: skip
PLY_CONSTANTS: Final = (
    "youngs_modulus_1", "youngs_modulus_2", "youngs_modulus_3",
    "shear_modulus_12", "shear_modulus_13", "shear_modulus_23",
    "poissons_ratio_12", "poissons_ratio_13", "poissons_ratio_23",
)  # fmt: skip

HEAT: Final = ("thermal_conductivity", "thermal_conductivity_through", "specific_heat")
"""Properties of heat flow, which no model of strength, stiffness or friction reads."""

_ROOM_TEMPERATURE = 296.15
_MATRIX = ("strength_2_tension", "strength_2_compression", "strength_12", "strength_23")
_FIBRE = ("strength_1_tension", "strength_1_compression")


@dataclass(frozen=True, slots=True)
class Spread:
    """Scatter of a value.

    Parameters
    ----------
    kind : ``cv`` (standard deviation divided by mean), ``tolerance`` (half width divided by value)
        or ``factor`` (largest divided by nominal value, equal to nominal divided by smallest value)
    size : for ``cv`` and ``tolerance`` this quotient, else the factor
    """

    kind: str
    size: float


@dataclass(frozen=True, slots=True)
class Property:
    """A property of a material; `points` is its table versus temperature or pressure, if any."""

    quantity: Quantity
    value: float
    source: str
    scatter: str
    confidence: str
    basis: str
    note: str = ""
    spread: Spread | None = None
    argument: str | None = None
    points: tuple[tuple[float, float], ...] = ()

    @property
    def unit(self) -> str:
        """SI unit of `value`."""
        return self.quantity.si_unit

    @property
    def text(self) -> str:
        """Value in its display unit."""
        return self.quantity.text(self.value)

    @property
    def arguments(self) -> tuple[float, ...]:
        """Temperatures (K) or pressures (Pa) of the table."""
        return tuple(argument for argument, _ in self.points)

    @property
    def values(self) -> tuple[float, ...]:
        """Values of the table, SI."""
        return tuple(value for _, value in self.points)

    def at(self, argument: Array, *, value: Array | None = None) -> Array:
        """Interpolate the table linearly, constant beyond its ends; `value` if there is no table.

        Parameters
        ----------
        argument : temperature (K) or pressure (Pa, gauge), depending on the table
        value : value at the reference point, to use instead of the stated value; the table is
            scaled with it
        """
        reference = self.value if value is None else value
        if not self.points:
            return reference
        scale = reference / self.value
        result: Array = self.points[0][1] + 0 * argument
        for (x0, y0), (x1, y1) in zip(self.points, self.points[1:], strict=False):
            result = where(
                real(argument) > x0, y0 + (y1 - y0) / (x1 - x0) * (argument - x0), result
            )
        last, end = self.points[-1]
        return scale * where(real(argument) > last, end + 0 * argument, result)

    def to_dict(self) -> dict[str, object]:
        """JSON form, SI."""
        entry: dict[str, object] = {
            "value": self.value, "unit": self.unit, "label": self.quantity.label,
            "source": self.source, "scatter": self.scatter, "confidence": self.confidence,
            "basis": self.basis, "note": self.note,
        }  # fmt: skip
        if self.argument:
            entry["points"] = [{self.argument: x, "value": y} for x, y in self.points]
        return entry


@dataclass(frozen=True, slots=True)
class Material:
    """A named library entry with its properties."""

    name: str
    kind: str
    label: str
    properties: Mapping[str, Property]
    notes: str = ""
    warning: str = ""
    family: str = ""
    suits: tuple[str, ...] = ()
    file: str = ""
    line: int = 0
    numbers: Mapping[str, float] = field(init=False)
    """Value of every stated property, SI."""

    def __post_init__(self) -> None:
        numbers = {name: entry.value for name, entry in self.properties.items()}
        object.__setattr__(self, "numbers", numbers)

    @property
    def isotropic(self) -> bool:
        """Whether a single modulus describes the material, as for metals and polymers."""
        return "youngs_modulus" in self.properties and "youngs_modulus_1" not in self.properties

    @property
    def through_wall(self) -> tuple[str, ...]:
        """Properties that give the thermal conductivity through a wall; the first stated counts.

        A ply conducts far better along its fibres than through its thickness, so that only its own
        value through the ply counts.
        """
        along, through, _ = HEAT
        return (through, along) if self.isotropic or self.kind == "fluid" else (through,)

    @property
    def unverified(self) -> tuple[str, ...]:
        """Names of the properties that nobody has checked against their source.

        Nominal values (a test temperature, a cycle count) are omitted, because they are stated
        conditions, not measurements.
        """
        return tuple(
            name
            for name, entry in self.properties.items()
            if entry.confidence == "unverified" and entry.basis != "nominal"
        )

    @property
    def viscosity_points(self) -> tuple[tuple[float, float], ...]:
        """Temperature (K) and kinematic viscosity (m^2/s) of a fluid's table."""
        return self.properties["kinematic_viscosity"].points

    def stating(self, stated: Mapping[str, float]) -> Material:
        """Copy the material with the properties (SI) that a design adds or replaces."""
        new = {name: value for name, value in stated.items() if name not in self.properties}
        if not new:
            return self
        properties = dict(self.properties)
        for name, value in new.items():
            properties[name] = Property(
                MATERIAL_PROPERTIES[name], value, "the design file", "not stated", "secondary",
                "nominal", "stated in the design",
            )  # fmt: skip
        return replace(self, properties=properties)

    def completed(self) -> dict[str, Property]:
        """Stated properties, and ply constants derived from them (marked ``derived``)."""
        properties = dict(self.properties)
        if self.kind not in ROLES["structural"]:
            return properties
        how = "isotropic" if self.isotropic else "transversely isotropic"
        for name, value in ply_constants(self.numbers).items():
            if name not in properties:
                properties[name] = Property(
                    MATERIAL_PROPERTIES[name], value, "[derived] from the stated constants",
                    "not stated", "derived", "typical", f"assumed {how}",
                )  # fmt: skip
        return properties

    def to_dict(self) -> dict[str, object]:
        """JSON form, SI."""
        return {
            "name": self.name, "kind": self.kind, "label": self.label, "notes": self.notes,
            "warning": self.warning, "family": self.family, "suits": list(self.suits),
            "properties": {n: p.to_dict() for n, p in self.completed().items()},
        }  # fmt: skip


def compatible(fluid: Material, seal: Material) -> bool | None:
    """Whether a seal compound withstands a fluid; None if the library does not state it."""
    if not fluid.family or not seal.suits:
        return None
    return fluid.family in seal.suits


def ply_constants(numbers: Mapping[str, Array]) -> dict[str, Array]:
    """Complete the elastic constants of a ply, and the strengths of an isotropic material.

    Missing ply constants follow transverse isotropy: E3 = E2, nu13 = nu12, G13 = G12, G23 = E2/(2(1
    + nu23)), nu23 = 0.40. A material with one modulus becomes a ply with the same constants in
    every direction, with G = E/(2(1 + nu)) unless G is given. Its strength in tension and
    compression is the yield strength or, if that is missing, the ultimate strength; its shear
    strength is this value divided by sqrt(3) (von Mises). All formulas work elementwise and under a
    complex step.

    Parameters
    ----------
    numbers : stated properties, SI
    """
    get = numbers.get
    if "youngs_modulus_1" not in numbers:
        if "youngs_modulus" not in numbers or "poissons_ratio" not in numbers:
            return {}
        return _isotropic_ply(numbers)
    e2, g12, nu12 = (numbers[n] for n in PLY_REQUIRED[1:])
    nu23 = get("poissons_ratio_23", 0.40)
    g23 = get("shear_modulus_23")
    result = {
        "youngs_modulus_1": numbers["youngs_modulus_1"],
        "youngs_modulus_2": e2,
        "youngs_modulus_3": get("youngs_modulus_3", e2),
        "shear_modulus_12": g12,
        "shear_modulus_13": get("shear_modulus_13", g12),
        "shear_modulus_23": e2 / (2 * (1 + nu23)) if g23 is None else g23,
        "poissons_ratio_12": nu12,
        "poissons_ratio_13": get("poissons_ratio_13", nu12),
        "poissons_ratio_23": nu23,
    }
    for name in ("thermal_expansion_1", "thermal_expansion_2"):
        if name in numbers:
            result[name] = numbers[name]
    return result


def _isotropic_ply(numbers: Mapping[str, Array]) -> dict[str, Array]:
    modulus, ratio = numbers["youngs_modulus"], numbers["poissons_ratio"]
    shear = numbers.get("shear_modulus")
    shear = modulus / (2 * (1 + ratio)) if shear is None else shear
    by_letter = {"youngs": modulus, "shear_": shear, "poisso": ratio}
    result = {name: by_letter[name[:6]] for name in PLY_CONSTANTS}
    if "thermal_expansion" in numbers:
        result["thermal_expansion_1"] = result["thermal_expansion_2"] = numbers["thermal_expansion"]
    strength = numbers.get("yield_strength", numbers.get("ultimate_strength"))
    if strength is not None:
        result |= dict.fromkeys((*_FIBRE, *_MATRIX[:2]), strength)
        result["strength_12"] = strength / math.sqrt(3)
    return result


def compliance_determinant(constants: Mapping[str, float]) -> float:
    """A number that is positive if the compliance matrix of a ply is positive definite.

    It is the smallest of 1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 [Lempriere1968]
    and the three factors 1 - nu_ij nu_ji.
    """
    e1, e2, e3 = (constants[f"youngs_modulus_{i}"] for i in (1, 2, 3))
    nu12, nu13, nu23 = (constants[f"poissons_ratio_{i}"] for i in (12, 13, 23))
    a, b, c = nu12 * nu12 * e2 / e1, nu13 * nu13 * e3 / e1, nu23 * nu23 * e3 / e2
    return min(1 - a, 1 - b, 1 - c, 1 - a - b - c - 2 * nu12 * nu23 * nu13 * e3 / e1)


def allowable_factor(
    numbers: Mapping[str, Array], name: str, *, basis: str, temperature: Array, wet: bool = False
) -> Array:
    """Share of a strength that remains: the product of all its knock-down factors.

    The factors are for temperature, moisture, basis and process; a missing factor is 1. The
    temperature factor is 1 up to 23 degC, then falls linearly through the stated knock-down at
    `knockdown_temperature`, but not below 0.05.

    Parameters
    ----------
    numbers : properties of the material, SI
    name : the strength (``yield_strength``, ``strength_2_tension``, ``bond_strength``, ...)
    basis : basis of its value; ``typical`` and ``mean`` are reduced to the allowable basis
    temperature : K
    wet : whether the material is saturated with moisture
    """
    prefix = "matrix_" if name in _MATRIX else ""
    factor: Array = 1.0
    hot = numbers.get(f"{prefix}temperature_knockdown")
    if hot is not None and "knockdown_temperature" in numbers:
        span = numbers["knockdown_temperature"] - _ROOM_TEMPERATURE
        share = maximum((temperature - _ROOM_TEMPERATURE) / span, 0.0 * temperature)
        factor = maximum(1 - (1 - hot) * share, 0.05 + 0.0 * share)
    if wet:
        factor = factor * numbers.get(f"{prefix}moisture_knockdown", 1.0)
    if basis in ("typical", "mean"):
        factor = factor * numbers.get("basis_knockdown", 1.0)
    if name == "strength_1_tension":
        factor = factor * numbers.get("process_knockdown", 1.0)
    return factor


_EXAMPLES = {
    "bulk_modulus_slope": "6", "pressure_viscosity": "18 1/GPa", "tait_modulus": "8.4 GPa",
    "tait_decay": "0.0058 1/K", "tait_coefficient": "11.9",
}  # fmt: skip
"""An example value of each property of mineral oil, for messages."""


def bulk_modulus_law(stated: str | None, properties: Container[str]) -> str:
    """Law of bulk modulus: as stated; else linear if its slope is known, else constant."""
    return stated or ("linear" if "bulk_modulus_slope" in properties else "constant")


def viscosity_law(stated: str | None, properties: Container[str]) -> str:
    """Law of how viscosity rises with pressure: as stated; else Roelands if its data are known."""
    return stated or ("roelands" if "pressure_viscosity" in properties else "none")


def of_fluid(tree: Any, materials: MaterialLookup) -> Iterator[Fault]:
    """Faults of stated oil laws that need data which neither library nor design has."""
    view = FileView(tree)
    name = view.text("fluid", "material")
    if name is None or not isinstance(materials, Properties) or materials.kind(name) != "fluid":
        return
    changes = child_at(tree, ("materials", name))
    try:
        properties = {*materials.numbers(name), *(changes if isinstance(changes, Mapping) else ())}
    except InputError:  # a faulty entry is reported elsewhere
        return
    for key, all_laws, instead in (
        ("bulk_modulus_law", BULK_MODULUS_LAWS, bulk_modulus_law(None, properties)),
        ("viscosity_pressure", VISCOSITY_LAWS, viscosity_law(None, properties)),
    ):
        law = view.text("fluid", key)
        missing = [needed for needed in _needs(all_laws, law) if needed not in properties]
        if missing:
            stated = f'"{missing[0]}: {_EXAMPLES[missing[0]]}"'
            yield Fault(
                ("fluid", key),
                f"{law}: {name} has no {', '.join(missing)}",
                f"write {instead}, or add e.g. {stated} under materials.{name}",
            )


def _needs(laws: Kinds[Any], law: str | None) -> tuple[str, ...]:
    """Properties that a stated law needs."""
    return laws[law].needs if law is not None and law in laws else ()


FASTEST = 10.0
"""Largest decay exponent between neighbouring points; above it, a single point would determine the
exponential."""

LARGEST_POWER = 300.0
"""Largest exponent when an amplitude is extrapolated to zero speed; it avoids overflow."""


@dataclass(frozen=True, slots=True, eq=False)
class LawFit:
    """A fitted law B(v), SI.

    `r_squared` is 1 - sum w (B - B_fit)^2/sum w (B - mean)^2; None if all points are equal.
    """

    name: str
    law: Callable[..., Array]
    parameters: Mapping[str, Parameter]
    covariance: Array
    """Covariance of the parameters, in their order; infinite for undetermined parameters."""
    speed: Array
    damping: Array
    residuals: Array
    """Measured minus fitted damping [N s/m]."""
    r_squared: float | None
    quantile: float
    """Student's t for the confidence bounds; infinite without degrees of freedom."""
    doubts: tuple[str, ...]
    """Reasons for undetermined parameters; empty if all are determined."""

    @property
    def values(self) -> dict[str, float]:
        """Parameter values by name."""
        return {name: parameter.value for name, parameter in self.parameters.items()}

    @property
    def determined(self) -> bool:
        """Whether the points determine every parameter."""
        return not self.doubts

    @property
    def largest_error(self) -> float:
        """Largest relative error |B_fit/B - 1| of all points."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.max(np.abs(self.residuals / self.damping)))

    def predict(self, speed: Array) -> Array:
        """The fitted damping at speeds [m/s]."""
        return self.law(speed=speed, **self.values)

    def bounds(self, speed: Array) -> tuple[Array, Array]:
        """Confidence bounds of the fitted curve at speeds; single measurements scatter more widely.

        They are infinite where the points leave a parameter unbounded.
        """
        slopes = _slopes(self.law, self.values, speed)
        with np.errstate(invalid="ignore"):
            variance = np.einsum("...i,ij,...j->...", slopes, self.covariance, slopes)
        half = self.quantile * np.sqrt(np.maximum(variance, 0.0))
        half = np.where(np.isfinite(half), half, np.inf)
        middle = self.predict(speed)
        return middle - half, middle + half


def fit_power_law(speed: Array, damping: Array, weights: Array | None = None) -> LawFit:
    """Fit B = a v^b [Huang2017].

    Parameters
    ----------
    speed : > 0 [m/s], (points)
    damping : secant viscous damping coefficient [N s/m], (points)
    weights : weights of the squared errors, > 0 (points); None: equal weights

    Returns
    -------
    the fit, parameters `coefficient` (a, at 1 m/s) and `exponent` (b)

    Examples
    --------
    >>> fit = fit_power_law([1e-3, 2e-3, 4e-3], [8e5, 4e5, 2e5])
    >>> print(f"{fit.parameters['exponent'].value:.6f}")
    -1.000000
    """
    v, b, w = _points(speed, damping, weights, parameters=2)
    logarithm = np.log(v / v[-1])
    steepest = LARGEST_POWER / max(-logarithm[0], *np.abs(np.log(v[[0, -1]])))
    grid = _both_signs(0.05, min(20.0, steepest), 30)
    (exponent,), (amplitude,) = _projected(
        b, w, [(start,) for start in grid], lambda rate: _shifted(rate, logarithm), steepest
    )
    reference = v[0] if exponent < 0 else v[-1]
    values = {"coefficient": float(amplitude * reference**-exponent), "exponent": float(exponent)}
    return assess("power law", laws.power_law, values, v, b, w, least={"exponent": 1.0})


def fit_double_exponential(speed: Array, damping: Array, weights: Array | None = None) -> LawFit:
    """Fit B = a1 e^(b1 v) + a2 e^(b2 v) [Huang2017]; the steeper exponential first.

    Parameters
    ----------
    speed : > 0 [m/s], (points)
    damping : secant viscous damping coefficient [N s/m], (points)
    weights : weights of the squared errors, > 0 (points); None: equal weights

    Returns
    -------
    the fit, parameters `coefficient_1`, `rate_1`, `coefficient_2`, `rate_2`

    Examples
    --------
    >>> v = np.array([1e-3, 2e-3, 4e-3, 6e-3, 9e-3])
    >>> fit = fit_double_exponential(v, 3e5 * np.exp(-900 * v) + 1e5 * np.exp(-50 * v))
    >>> print(f"{fit.parameters['rate_1'].value:.3f}")
    -900.000
    """
    v, b, w = _points(speed, damping, weights, parameters=4)
    gap = float(np.min(np.diff(np.unique(v))))
    steepest = min(FASTEST / gap, LARGEST_POWER / float(v[-1]))
    grid = _both_signs(0.03 / float(v[-1]), steepest, 26)
    pairs = [(first, second) for k, first in enumerate(grid) for second in grid[k + 1 :]]
    rates, amplitudes = _projected(b, w, pairs, lambda rate: _shifted(rate, v), steepest)
    order = np.argsort(rates)
    terms = [(amplitudes[k] * np.exp(-rates[k] * _reference(rates[k], v)), rates[k]) for k in order]
    values = {
        "coefficient_1": float(terms[0][0]),
        "rate_1": float(terms[0][1]),
        "coefficient_2": float(terms[1][0]),
        "rate_2": float(terms[1][1]),
    }
    at_limit = [rate for rate in rates if abs(rate) > 0.999 * steepest]
    doubts = (
        ("one exponential falls so steeply that only a single point determines it",)
        if at_limit
        else ()
    )
    least = dict.fromkeys(("rate_1", "rate_2"), 1 / float(v[-1]))
    law = laws.double_exponential
    return assess("double exponential", law, values, v, b, w, least=least, doubts=doubts)


def assess(
    name: str,
    law: Callable[..., Array],
    values: Mapping[str, float],
    speed: Array,
    damping: Array,
    weights: Array,
    *,
    least: Mapping[str, float] | None = None,
    doubts: tuple[str, ...] = (),
) -> LawFit:
    """Rate a least-squares fit: confidence bounds, R-squared, undetermined parameters.

    Parameters
    ----------
    name : name of the law
    law : function B(speed, values), safe under a complex step
    values : least-squares parameters by name, SI
    speed, damping, weights : the points
    least : for parameters that may be near 0, the smallest value of their scale. A parameter is
        undetermined if a change by its scale does not visibly change the curve; the scale is the
        parameter's absolute value, but at least the value given here
    doubts : reasons for parameters that the search already left undetermined

    Returns
    -------
    the fit
    """
    fitted = law(speed=speed, **values)
    residuals = damping - fitted
    sizes = np.array([max(abs(x), (least or {}).get(key, 0.0)) or 1.0 for key, x in values.items()])
    slopes = np.sqrt(weights)[:, None] * _slopes(law, values, speed)
    estimate = known(values, slopes, np.sqrt(weights) * residuals, sizes)
    freedom = speed.size - len(values)
    reasons = list(doubts)
    if freedom == 0:
        reasons.append(
            f"{speed.size} points for {len(values)} parameters leave no degree of freedom, so "
            "errors are unknown"
        )
    elif estimate.rank < len(values):
        reasons.append(f"the points determine only {estimate.rank} of {len(values)} parameters")
    else:
        weak = [key for key, parameter in estimate.parameters.items() if not parameter.identifiable]
        if weak:
            reasons.append(
                f"confidence interval of {', '.join(weak)} is wider than {100 * WEAK:.0f} % of the "
                "value"
            )
    return LawFit(
        name=name,
        law=law,
        parameters=estimate.parameters,
        covariance=estimate.covariance,
        speed=speed,
        damping=damping,
        residuals=residuals,
        r_squared=_r_squared(damping, fitted, weights),
        quantile=estimate.quantile,
        doubts=tuple(reasons),
    )


def _slopes(law: Callable[..., Array], values: Mapping[str, float], speed: Array) -> Array:
    """Derivatives of the law for each of its parameters, (..., parameters), by complex steps."""
    speed = np.asarray(speed, dtype=float)
    columns = []
    for name, value in values.items():
        stepped = law(speed=speed, **{**values, name: value + 1j * STEP})
        columns.append(np.broadcast_to(np.imag(stepped) / STEP, speed.shape))
    return np.stack(columns, axis=-1)


def _r_squared(damping: Array, fitted: Array, weights: Array) -> float | None:
    mean = np.sum(weights * damping) / np.sum(weights)
    spread = float(np.sum(weights * (damping - mean) ** 2))
    if spread <= (1e-14 * float(np.max(np.abs(damping)))) ** 2 * float(np.sum(weights)):
        return None
    return 1 - float(np.sum(weights * (damping - fitted) ** 2)) / spread


def _reference(rate: float, abscissa: Array) -> float:
    """Abscissa of the point at which an exponential is largest."""
    return float(abscissa[0] if rate < 0 else abscissa[-1])


def _shifted(rate: float, abscissa: Array) -> Array:
    """e^(rate x), divided by its largest value at the points so that it never overflows."""
    return np.exp(rate * (abscissa - _reference(rate, abscissa)))


def _both_signs(least: float, most: float, count: int) -> list[float]:
    """Grid of rates, geometrically spaced, of both signs."""
    half = np.geomspace(least, most, count)
    return [float(rate) for rate in (*-half[::-1], *half)]


def _projected(
    damping: Array,
    weights: Array,
    starts: Sequence[tuple[float, ...]],
    basis: Callable[[float], Array],
    steepest: float,
) -> tuple[Array, Array]:
    """Search the rates with the least sum of squares; linear fits give the amplitudes.

    The best distinct starting points are refined, with rates limited to +-steepest.
    """
    root = np.sqrt(weights / np.sum(weights))
    scale = float(np.max(np.abs(damping))) or 1.0
    target = root * damping / scale

    def linear(rates: Array) -> tuple[Array, Array]:
        columns = np.stack([root * basis(float(rate)) for rate in rates], axis=-1)
        amplitudes = np.linalg.lstsq(columns, target, rcond=None)[0]
        return amplitudes, columns @ amplitudes - target

    def misfit(rates: Array) -> Array:
        return linear(rates)[1]

    costs = [float(np.sum(misfit(np.array(start)) ** 2)) for start in starts]
    best, least = np.array(starts[int(np.argmin(costs))]), np.inf
    for start in _distinct_starts(starts, costs):
        limit = np.full(start.shape, steepest)
        solution = least_squares.solve(
            misfit,
            np.clip(start, -0.99 * limit, 0.99 * limit),
            (-limit, limit),
            slopes="3-point",
            sizes=np.abs(start),
            cost_tolerance=1e-15,
            step_tolerance=1e-15,
            slope_tolerance=1e-15,
        )
        if solution.cost < least:
            best, least = solution.x, solution.cost
    return best, linear(best)[0] * scale


def _distinct_starts(
    starts: Sequence[tuple[float, ...]], costs: list[float], count: int = 6
) -> Array:
    """Starting points of least cost that differ by more than a third in some rate."""
    chosen: list[tuple[float, ...]] = []
    for k in np.argsort(costs):
        start = np.array(starts[k])
        if all(np.max(np.abs(start / np.array(other) - 1)) > 1 / 3 for other in chosen):
            chosen.append(starts[k])
        if len(chosen) == count:
            break
    return np.array(chosen)


def _points(
    speed: Array, damping: Array, weights: Array | None, *, parameters: int
) -> tuple[Array, Array, Array]:
    """Sort the points by speed, as arrays; raise a one-line error if they are unusable."""
    v, b = (np.atleast_1d(np.asarray(values, dtype=float)) for values in (speed, damping))
    w = np.ones(v.shape) if weights is None else np.atleast_1d(np.asarray(weights, dtype=float))
    if v.ndim != 1 or v.shape != b.shape or v.shape != w.shape:
        sizes = ", ".join(str(values.shape) for values in (v, b, w))
        raise _fault(
            f"speed, damping and weights have shapes {sizes}",
            "give one value of speed, damping and weight for each point",
        )
    for name, values in (("speed", v), ("damping", b), ("weight", w)):
        not_finite = np.flatnonzero(~np.isfinite(values))
        if not_finite.size:
            raise _fault(
                f"{name} of point {not_finite[0]} is {values[not_finite[0]]}", "leave the point out"
            )
    for name, values in (("speed", v), ("weight", w)):
        not_positive = np.flatnonzero(values <= 0)
        if not_positive.size:
            reason = "secant damping is undefined at rest and " if name == "speed" else ""
            index = not_positive[0]
            fault = f"{name} of point {index} is {values[index]:g}; {reason}must be above 0"
            raise _fault(fault, "leave the point out")
    different = np.unique(v).size
    if different < parameters:
        fault = f"{different} different speeds for a law with {parameters} parameters"
        raise _fault(fault, f"give at least {parameters}, and one more to get confidence intervals")
    order = np.argsort(v, kind="stable")
    return v[order], b[order], w[order]


def _fault(message: str, remedy: str) -> InputError:
    return InputError(Diagnostic(f"fit of the damping: {message}", remedy))
