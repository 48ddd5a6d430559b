"""Range of the oil in an evaluation: boiling, laws over pressure, temperatures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..base.numeric import minimum, real
from ..design.material import Material, bulk_modulus_law, viscosity_law
from ..design.model import FluidSection
from ..metrics.table import OIL_FED
from ..models import fluid
from ..models.oil_laws import BULK_MODULUS_LAWS, VISCOSITY_LAWS
from . import oil as oil_laws
from .limits import MaterialValues, MetricArrays
from .state import LoadState


def compute(
    section: FluidSection, stock: MaterialValues, state: LoadState, out: MetricArrays
) -> None:
    """Margin of the chambers to boiling of the oil, in every case."""
    limit = oil_laws.vapour_pressure(stock, section.material, state.temperature)
    if limit is None:
        why = f"{section.material} has no vapour_pressure: add it under materials"
        out.skip("cavitation_margin", why)
        return
    lowest = minimum(
        minimum(state.moving_a, state.moving_b), minimum(state.holding_a, state.holding_b)
    )
    out.put("cavitation_margin", lowest + fluid.ATMOSPHERIC_PRESSURE - limit)


def warnings(
    section: FluidSection, oil: Material, cases: Sequence[str], state: LoadState
) -> Iterable[tuple[str, str]]:
    """(metric, sentence) for each use of the oil outside the range of its data or laws."""
    yield from _temperatures(oil, cases, state)
    law = bulk_modulus_law(section.bulk_modulus_law, oil.numbers)
    chambers = [state.moving_a, state.moving_b, state.holding_a, state.holding_b]
    highest = max(float(np.max(np.real(pressure))) for pressure in chambers)
    limit = BULK_MODULUS_LAWS[law].largest_pressure
    if highest > limit:
        text = (
            f"bulk modulus: {highest / 1e5:.0f} bar exceeds the limit of {limit / 1e5:.0f} bar of "
            f"the {law} law of the oil"
        )
        yield from ((metric, text) for metric in OIL_FED)
    law = viscosity_law(section.viscosity_pressure, oil.numbers)
    limit = VISCOSITY_LAWS[law].largest_pressure
    if highest > limit:
        yield (
            "oil_viscosity",
            f"viscosity: {highest / 1e5:.0f} bar exceeds the limit of {limit / 1e5:.0f} bar of the "
            f"{law.capitalize()} law",
        )


def _temperatures(
    oil: Material, cases: Sequence[str], state: LoadState
) -> Iterable[tuple[str, str]]:
    """Load cases outside the temperatures and viscosities of the oil's data or service range."""
    low = oil.numbers.get("temperature_min", -np.inf)
    high = oil.numbers.get("temperature_max", np.inf)
    for case, temperature, viscosity in zip(
        cases,
        np.broadcast_to(np.ravel(real(state.temperature)), len(cases)),
        np.broadcast_to(np.ravel(real(state.kinematic_viscosity)), len(cases)),
        strict=True,
    ):
        if not low <= temperature <= high:
            yield (
                "oil_viscosity",
                f"{case}: {temperature - 273.15:.0f} degC is outside the service range of "
                f"{oil.name}, {low - 273.15:.0f} to {high - 273.15:.0f} degC",
            )
        if viscosity < fluid.LEAST_VISCOSITY:
            yield (
                "oil_viscosity",
                f"{case}: {1e6 * viscosity:.2g} mm^2/s is below the "
                f"lower limit of ASTM D341, {1e6 * fluid.LEAST_VISCOSITY:.0f} mm^2/s",
            )
