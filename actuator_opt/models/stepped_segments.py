"""Buckling of a column with any number of segments and any ends, by transfer matrices.

Scalar and plain on purpose: the reference for `stepped`, and the tool for columns with more than
two sections or elastic ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry import geometry

_STATE = {"w": 0, "slope": 1, "moment": 2, "shear": 3}
_FREE = {
    "pinned": ("slope", "shear"),
    "fixed": ("moment", "shear"),
    "free": ("w", "slope"),
    "guided": ("w", "moment"),
    "elastic": ("moment", "shear"),
}
_HELD = {
    "pinned": ("w", "moment"),
    "fixed": ("w", "slope"),
    "free": ("moment", "shear"),
    "guided": ("slope", "shear"),
    "elastic": ("w", "slope"),
}
_SCAN = 1.01


def _transfer(load: NDArray[Any], stiffness: float, length: float) -> NDArray[Any]:
    """Transfer matrices of (w, slope, moment, shear) over one segment, one per load."""
    k = np.sqrt(load / stiffness)
    s, c = np.sin(k * length), np.cos(k * length)
    matrix = np.zeros((*load.shape, 4, 4))
    matrix[..., 0, 0] = matrix[..., 3, 3] = 1.0
    matrix[..., 0, 1] = s / k
    matrix[..., 0, 2] = matrix[..., 1, 3] = (1 - c) / load
    matrix[..., 0, 3] = (length - s / k) / load
    matrix[..., 1, 1] = matrix[..., 2, 2] = c
    matrix[..., 1, 2] = k * s / load
    matrix[..., 2, 1] = -load * s / k
    matrix[..., 2, 3] = s / k
    return matrix


def _determinant(
    load: NDArray[Any],
    segments: Sequence[tuple[float, float]],
    ends: tuple[str, str],
    springs: tuple[float, float],
) -> NDArray[Any]:
    """Evaluate the determinant of the two end conditions in the two free unknowns, one per load."""
    start = np.zeros((4, 2))
    for column, name in enumerate(_FREE[ends[0]]):
        start[_STATE[name], column] = 1.0
    if ends[0] == "elastic":
        start[_STATE["slope"], 0] = 1 / springs[0]
    state = np.broadcast_to(start, (*load.shape, 4, 2))
    for stiffness, length in segments:
        state = _transfer(load, stiffness, length) @ state
    rows = [state[..., _STATE[name], :] for name in _HELD[ends[1]]]
    if ends[1] == "elastic":
        rows[1] = rows[1] + state[..., _STATE["moment"], :] / springs[1]
    result: NDArray[Any] = rows[0][..., 0] * rows[1][..., 1] - rows[0][..., 1] * rows[1][..., 0]
    return result


@geometry
def stepped_column_load_segments(
    *,
    bending_stiffness: Sequence[float],
    length: Sequence[float],
    ends: tuple[str, str] = ("pinned", "pinned"),
    rotational_stiffness: tuple[float, float] = (np.inf, np.inf),
) -> float:
    """Critical load of a column of any number of segments.

    First zero of the determinant of the end conditions over the product of the segments' transfer
    matrices: scan upwards in steps of 1 %, then bisect.

    Parameters
    ----------
    bending_stiffness : EI of each segment [N m^2]
    length : length of each segment [m]
    ends : "pinned", "fixed", "free", "guided" or "elastic" (held, turning against a spring)
    rotational_stiffness : springs of elastic ends [N m/rad]

    Returns
    -------
    first critical load [N]

    Raises
    ------
    ValueError
        Where no load up to twice that of the stiffest fixed column makes it buckle.

    Notes
    -----
    Valid: elastic, straight, centrally loaded; real scalars.

    References
    ----------
    [TimoshenkoGere1961] bars with varying cross-section; [derived] transfer matrix of a
    segment under axial load

    Examples
    --------
    >>> p = stepped_column_load_segments(bending_stiffness=[5000.0, 1200.0], length=[0.20, 0.18],
    ...                                  ends=("fixed", "free"))
    >>> print(f"{p / 1e3:.4f} kN")
    54.1212 kN
    """
    total, scale = float(sum(length)), float(max(bending_stiffness))
    unit = scale / (total * total)
    segments = [
        (ei / scale, part / total) for ei, part in zip(bending_stiffness, length, strict=True)
    ]
    springs = (rotational_stiffness[0] * total / scale, rotational_stiffness[1] * total / scale)
    lowest = 0.2 * np.pi**2 * min(ei for ei, _ in segments)
    count = int(np.log(8 * np.pi**2 / lowest) / np.log(_SCAN)) + 2
    loads = lowest * _SCAN ** np.arange(count)
    values = _determinant(loads, segments, ends, springs)
    changes = np.nonzero(values[1:] * values[:-1] <= 0)[0]
    if len(changes) == 0:
        message = f"no buckling load found for ends {ends[0]}-{ends[1]}"
        raise ValueError(message)
    low, high = loads[changes[0]], loads[changes[0] + 1]
    sign = values[changes[0]]
    for _ in range(60):
        middle = (low + high) / 2
        value = _determinant(np.asarray(middle), segments, ends, springs)
        low, high = (middle, high) if value * sign > 0 else (low, middle)
    return float((low + high) / 2 * unit)
