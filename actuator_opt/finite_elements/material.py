"""Mooney-Rivlin rubber and plastics, with five components of the deformation gradient.

The order of components is 11, 12, 21, 22, 33. Component 33 is 1 in plane strain, and the hoop
stretch in axisymmetry. Direction 1 is axial, direction 2 radial. The finite-element library is
imported on first use, so the rest of the program works without it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from ..base.dataclass import dataclass
from ..base.errors import ActuatorError, Diagnostic

Floats = npt.NDArray[np.float64]
COMPONENTS = ((0, 0), (0, 1), (1, 0), (1, 1), (2, 2))
_ROWS = np.array([i for i, _ in COMPONENTS])
_COLUMNS = np.array([j for _, j in COMPONENTS])


@dataclass(frozen=True, slots=True)
class MooneyRivlin:
    """Strain energy c10 (I1 - 3) + c01 (I2 - 3) - 2 (c10 + 2 c01) ln J + q (J - 1) - q^2/(2 L).

    I1 and I2 are the first two invariants of the right Cauchy-Green tensor, and J is the volume
    ratio. The Lagrange multiplier q is an independent field that enforces J = 1 + q/L. L is the
    stiffness against volume change (Lame's first constant at small strain), infinite for an
    incompressible body.

    Parameters
    ----------
    c10, c01 : Mooney-Rivlin constants [Pa]; the shear modulus is 2 (c10 + c01)
    volume_stiffness : Lame's first constant L [Pa]
    """

    c10: float
    c01: float
    volume_stiffness: float = math.inf

    @classmethod
    def of_modulus(
        cls, youngs_modulus: float, *, second_share: float = 0.0, poissons_ratio: float = 0.5
    ) -> MooneyRivlin:
        """The material with a given Young's modulus at small strain.

        Parameters
        ----------
        youngs_modulus : at small strain [Pa]
        second_share : c01/(c10 + c01) [-]; 0 gives a neo-Hookean material
        poissons_ratio : at small strain [-]; 0.5 is incompressible
        """
        shear = youngs_modulus / (2 * (1 + poissons_ratio))
        stiffness = (
            math.inf
            if poissons_ratio >= 0.5
            else 2 * shear * poissons_ratio / (1 - 2 * poissons_ratio)
        )
        return cls((1 - second_share) * shear / 2, second_share * shear / 2, stiffness)

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus at small strain [Pa]."""
        shear = 2 * (self.c10 + self.c01)
        if math.isinf(self.volume_stiffness):
            return 3 * shear
        return shear * (3 * self.volume_stiffness + 2 * shear) / (self.volume_stiffness + shear)

    def over(self, stress: float) -> MooneyRivlin:
        """The same material, with its constants divided by a stress [Pa]."""
        return MooneyRivlin(self.c10 / stress, self.c01 / stress, self.volume_stiffness / stress)


def full(components: Floats) -> Floats:
    """3 x 3 tensors from the five components on the last axis."""
    tensor = np.zeros((*components.shape[:-1], 3, 3))
    tensor[..., _ROWS, _COLUMNS] = components
    return tensor


def inverse_transpose(gradient: Floats) -> tuple[Floats, Floats]:
    """Five components of F^-T, and J = det F."""
    a, b, c, d, hoop = np.moveaxis(gradient, -1, 0)
    plane = a * d - b * c
    inverse = np.stack((d / plane, -c / plane, -b / plane, a / plane, 1 / hoop), axis=-1)
    return inverse, plane * hoop


def stress(gradient: Floats, multiplier: Floats, c10: Floats, c01: Floats) -> Floats:
    """First Piola-Kirchhoff stress, five components [Pa].

    It is 2 c10 F + 2 c01 (I1 F - F C) + [q J - 2 (c10 + 2 c01)] F^-T with C = F^T F.

    Parameters
    ----------
    gradient : deformation gradient F, its five components on the last axis [-]
    multiplier : multiplier q [Pa]
    c10, c01 : constants of `MooneyRivlin`, in a shape that broadcasts with the multiplier [Pa]
    """
    inverse, volume = inverse_transpose(gradient)
    tensor = full(gradient)
    first = np.sum(gradient**2, axis=-1)[..., None]
    cubic = (tensor @ np.swapaxes(tensor, -1, -2) @ tensor)[..., _ROWS, _COLUMNS]
    c10, c01 = c10[..., None], c01[..., None]
    return np.asarray(
        2 * c10 * gradient
        + 2 * c01 * (first * gradient - cubic)
        + (multiplier * volume)[..., None] * inverse
        - 2 * (c10 + 2 * c01) * inverse
    )


def tangent(gradient: Floats, multiplier: Floats, c10: Floats, c01: Floats) -> Floats:
    """Derivative of `stress` with respect to F at fixed multiplier; last two axes 5 x 5 [Pa]."""
    inverse, volume = inverse_transpose(gradient)
    tensor, inverse_tensor = full(gradient), full(inverse)
    i, j = _ROWS[:, None], _COLUMNS[:, None]
    k, m = _ROWS[None, :], _COLUMNS[None, :]
    same_row, same_column = (i == k).astype(float), (j == m).astype(float)
    crossed = inverse_tensor[..., i, m] * inverse_tensor[..., k, j]
    right = np.swapaxes(tensor, -1, -2) @ tensor
    left = tensor @ np.swapaxes(tensor, -1, -2)
    first = np.sum(gradient**2, axis=-1)
    c10, c01 = c10[..., None, None], c01[..., None, None]
    volumetric = (multiplier * volume)[..., None, None]
    second = (
        2 * gradient[..., :, None] * gradient[..., None, :]
        + first[..., None, None] * same_row * same_column
        - same_row * right[..., m, j]
        - tensor[..., i, m] * tensor[..., k, j]
        - same_column * left[..., i, k]
    )
    return np.asarray(
        2 * c10 * same_row * same_column
        + 2 * c01 * second
        + (2 * (c10 + 2 * c01) - volumetric) * crossed
        + volumetric * inverse[..., :, None] * inverse[..., None, :]
    )


def von_mises(gradient: Floats, multiplier: Floats, c10: Floats, c01: Floats) -> Floats:
    """Von Mises value of the true stress P F^T/J, with the stress P of `stress` [Pa]."""
    _, volume = inverse_transpose(gradient)
    nominal = full(stress(gradient, multiplier, c10, c01))
    true = nominal @ np.swapaxes(full(gradient), -1, -2) / volume[..., None, None]
    mean = np.trace(true, axis1=-2, axis2=-1) / 3
    deviator = true - mean[..., None, None] * np.eye(3)
    return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=(-2, -1))))


def finite_element_library() -> Any:
    """Import the module ``skfem``; raise a one-line error if the extra is not installed.

    Raises
    ------
    ActuatorError
        scikit-fem is not installed
    """
    try:
        import skfem
    except ImportError as missing:
        raise ActuatorError(
            Diagnostic("finite elements need scikit-fem", "pip install 'actuator-opt[fem]'")
        ) from missing
    return skfem
