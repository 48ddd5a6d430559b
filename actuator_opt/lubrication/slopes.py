"""Exact derivatives of a solved film by its inputs, from the implicit-function theorem."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.numeric import STEP
from .film import Film, outputs, scaled
from .newton import FilmState, Linear, Residual, residual
from .reynolds import Contact, Vector


def sensitivities(film: Film, stepped: Sequence[Contact]) -> Vector:
    """Derivatives of viscous drag, contact load, flow and mean film, one row per direction.

    Each direction is the contact of the film with a complex step on any number, such as
    ``width * (1 + 1j * STEP)``. The change of the state is -J^-1 times the step of the residual at
    the solved state; one factorisation serves all directions.

    Parameters
    ----------
    film : a converged film
    stepped : its contact with a complex step of size `numeric.STEP`, per direction

    Returns
    -------
    (directions, 4): derivatives of the four outputs along each step [SI]

    Raises
    ------
    ValueError
        The film did not converge.
    """
    if not film.converged:
        raise ValueError(f"no slopes for a film that did not converge: {film.reason}")
    problems = [scaled(contact, film.contact) for contact in stepped]
    steps = [_imaginary(residual(flow, bed, film.state)) for flow, bed in problems]
    changes = Linear(*scaled(film.contact), film.state).solve(steps)
    slopes = []
    for (flow, bed), change in zip(problems, changes, strict=True):
        values = outputs(flow, bed, _moved(film.state, change))
        slopes.append([np.imag(value) / STEP for value in values])
    return np.array(slopes).reshape(len(slopes), 4)


def _imaginary(found: Residual) -> Residual:
    """Derivatives of residuals along a step."""
    flow, complementarity, bent = (
        np.imag(part) / STEP for part in (found.flow, found.complementarity, found.film)
    )
    ends = (float(np.imag(found.ends[0])) / STEP, float(np.imag(found.ends[1])) / STEP)
    return Residual(flow, complementarity, bent, float(np.imag(found.load)) / STEP, ends)


def _moved(state: FilmState, change: FilmState) -> FilmState:
    """A state with its change as a complex step."""
    return FilmState(
        state.pressure + 1j * STEP * change.pressure,
        state.cavitation + 1j * STEP * change.cavitation,
        state.film + 1j * STEP * change.film,
        state.shift + 1j * STEP * change.shift,
    )
