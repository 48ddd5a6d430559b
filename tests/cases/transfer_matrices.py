"""Buckling of a column with any number of segments and any ends, by transfer matrices.

The reference for `stepped`, scalar and plain on purpose.
"""

from __future__ import annotations

import numpy as np

_STATE = {"w": 0, "slope": 1, "moment": 2, "shear": 3}
_FREE = {
    "pinned": ("slope", "shear"),
    "fixed": ("moment", "shear"),
    "free": ("w", "slope"),
    "guided": ("w", "moment"),
}
_HELD = {
    "pinned": ("w", "moment"),
    "fixed": ("w", "slope"),
    "free": ("moment", "shear"),
    "guided": ("slope", "shear"),
}
_SCAN = 1.01


def _transfer(load, stiffness, length):
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


def _determinant(load, segments, ends):
    """Evaluate the determinant of the two end conditions in the two free unknowns, one per load."""
    start = np.zeros((4, 2))
    for column, name in enumerate(_FREE[ends[0]]):
        start[_STATE[name], column] = 1.0
    state = np.broadcast_to(start, (*load.shape, 4, 2))
    for stiffness, length in segments:
        state = _transfer(load, stiffness, length) @ state
    rows = [state[..., _STATE[name], :] for name in _HELD[ends[1]]]
    return rows[0][..., 0] * rows[1][..., 1] - rows[0][..., 1] * rows[1][..., 0]


def column_load(*, bending_stiffness, length, ends=("pinned", "pinned")):
    """First critical load [N] of a column of segments of EI [N m^2] and length [m].

    First zero of the determinant of the end conditions over the product of the segments' transfer
    matrices: scan upwards in steps of 1 %, then bisect. Ends are "pinned", "fixed", "free" or
    "guided" [TimoshenkoGere1961].
    """
    total, scale = float(sum(length)), float(max(bending_stiffness))
    unit = scale / (total * total)
    segments = [
        (ei / scale, part / total) for ei, part in zip(bending_stiffness, length, strict=True)
    ]
    lowest = 0.2 * np.pi**2 * min(ei for ei, _ in segments)
    count = int(np.log(8 * np.pi**2 / lowest) / np.log(_SCAN)) + 2
    loads = lowest * _SCAN ** np.arange(count)
    values = _determinant(loads, segments, ends)
    changes = np.nonzero(values[1:] * values[:-1] <= 0)[0]
    if len(changes) == 0:
        message = f"no buckling load found for ends {ends[0]}-{ends[1]}"
        raise ValueError(message)
    low, high = loads[changes[0]], loads[changes[0] + 1]
    sign = values[changes[0]]
    for _ in range(60):
        middle = (low + high) / 2
        value = _determinant(np.asarray(middle), segments, ends)
        low, high = (middle, high) if value * sign > 0 else (low, middle)
    return float((low + high) / 2 * unit)
