"""Products of plain atoms as rows of the linear programme: four planes each [McCormick1976]."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from ..problem import Vector
from .box import ROOM
from .relaxation import Product


class Products:
    """Rows -inf or low <= w + a x + b y <= high or inf of products w = k x y, from row `first` on.

    Two planes lie below and two above, through the corners of both factors' ranges.
    """

    def __init__(self, products: Sequence[Product], first: int, columns: int) -> None:
        self.first, self.rows = first, 4 * len(products)
        atoms = [(one.first, one.second, one.out) for one in products]
        self.atoms = np.array(atoms, dtype=np.int32).reshape(-1, 3)
        self.level = np.exp([one.level for one in products])
        self.columns = np.repeat(self.atoms, 4, axis=0)
        """Columns (rows, 3) of x, y and w."""
        starts, shape = 3 * np.arange(self.rows + 1), (self.rows, columns)
        ones = np.ones(3 * self.rows)
        self.matrix = sp.csr_matrix((ones, self.columns.ravel(), starts), shape=shape)

    def planes(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector, Vector]:
        """Coefficients (rows, 3) and ends of the rows, for ranges of all columns.

        w >= k (x_l y + y_l x - x_l y_l), w >= k (x_u y + y_u x - x_u y_u),
        w <= k (x_u y + y_l x - x_u y_l), w <= k (x_l y + y_u x - x_l y_u).
        """
        x, y, _ = self.atoms.T
        sides = (lower, lower), (upper, upper), (upper, lower), (lower, upper)
        corners = np.stack([(one[x], two[y]) for one, two in sides])  # (4, 2, products)
        scaled = -self.level * corners
        planes = np.ones((len(self.atoms), 4, 3))
        planes[:, :, 0], planes[:, :, 1] = scaled[:, 1].T, scaled[:, 0].T
        level = (scaled[:, 0] * corners[:, 1]).T
        low, high = level - ROOM, level + ROOM
        low[:, 2:], high[:, :2] = -np.inf, np.inf
        return planes.reshape(-1, 3), low.ravel(), high.ravel()

    def torn(self, x: Vector, dual: Vector) -> Vector:
        """Error of every product at a point, times its multipliers."""
        first, second, out = self.atoms.T
        price = np.abs(dual[self.first : self.first + self.rows]).reshape(-1, 4).sum(axis=1)
        found: Vector = np.abs(x[out] - self.level * x[first] * x[second]) * price
        return found
