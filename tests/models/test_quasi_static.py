"""Quasi-static cylinder: worked numbers of an independent program, balances and limits."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.models import quasi_static

A, B = math.pi / 4 * 0.023**2, math.pi / 4 * (0.023**2 - 0.013**2)
K = 10 / 60000 / math.sqrt(35e5)
SIDES = {"supply_pressure": 210e5, "return_pressure": 5e5}


def driven(force: float, *, out: bool, matched: float = 1.0) -> tuple[float, float, float, float]:
    """Drop of the feeding edge, pressures A and B [MPa], and speed limit [m/s]."""
    areas = (A, B) if out else (B, A)
    edges = (K, matched * K) if out else (matched * K, K)
    ratio = quasi_static.edge_ratio(
        driven_area=areas[0], other_area=areas[1], feed_coefficient=edges[0],
        drain_coefficient=edges[1],
    )  # fmt: skip
    state = quasi_static.driven_pressures(
        load=force if out else -force, driven_area=areas[0], other_area=areas[1], ratio=ratio,
        **SIDES,
    )  # fmt: skip
    speed = quasi_static.speed_limit(
        edge_drop=state.edge_drop, driven_area=areas[0], feed_coefficient=edges[0]
    )
    a, b = (state.driven, state.other) if out else (state.other, state.driven)
    return state.edge_drop / 1e6, a / 1e6, b / 1e6, speed


@pytest.mark.parametrize(
    ("force", "out", "matched", "expected"),
    [
        (1000, True, 1.0, (13.8787, 7.12126, 6.92752, 0.798811)),
        (1000, False, 1.0, (5.70393, 12.8163, 15.2961, 0.752505)),
        (-1000, True, 1.0, (None, 3.46107, None, 0.897988)),
        (-1000, False, 1.0, (None, None, 16.9912, 0.630857)),
        (1000, True, B / A, (None, 10.1386, 11.3614, 0.706662)),
    ],
)
def test_pressures_and_speed_limit(
    force: float, out: bool, matched: float, expected: tuple[float | None, ...]
) -> None:
    """Worked numbers to six digits."""
    for value, known in zip(driven(force, out=out, matched=matched), expected, strict=True):
        assert known is None or value == pytest.approx(known, rel=5e-6)


@pytest.mark.parametrize(
    ("load", "speed", "areas", "pressure", "reserve"),
    [(1000, 0.38, (A, B), 7.84661e6, 5464.91), (500, -0.4, (B, A), 10.8060e6, 2882.28)],
)
def test_needed_supply_and_reserve(
    load: float, speed: float, areas: tuple[float, float], pressure: float, reserve: float
) -> None:
    """Worked numbers; the reserve is the spare pressure times the driven area."""
    ratio = (areas[1] / areas[0]) ** 2
    needed = quasi_static.needed_supply(
        load=load, speed=speed, return_pressure=5e5, driven_area=areas[0], other_area=areas[1],
        ratio=ratio, feed_coefficient=K, opening=0.9,
    )  # fmt: skip
    assert needed == pytest.approx(pressure, rel=5e-6)
    assert (210e5 - needed) * areas[0] == pytest.approx(reserve, rel=5e-6)


@given(
    st.floats(-3000, 3000), st.floats(1e-4, 1e-3), st.floats(0.3, 1.0), st.floats(0.3, 3.0),
)  # fmt: skip
def test_balance_and_continuity(load: float, area: float, share: float, edges: float) -> None:
    """Pressures carry the load, and both edges pass the flow of the same speed."""
    other, drain = share * area, K / edges
    ratio = quasi_static.edge_ratio(
        driven_area=area, other_area=other, feed_coefficient=K, drain_coefficient=drain
    )
    state = quasi_static.driven_pressures(
        load=load, driven_area=area, other_area=other, ratio=ratio, **SIDES
    )
    assert state.driven * area - state.other * other == pytest.approx(load, abs=1e-6)
    if state.edge_drop > 0:
        speed = quasi_static.speed_limit(
            edge_drop=state.edge_drop, driven_area=area, feed_coefficient=K
        )
        assert drain * math.sqrt(state.other - 5e5) == pytest.approx(speed * other, rel=1e-9)
        needed = quasi_static.needed_supply(
            load=load, speed=speed, return_pressure=5e5, driven_area=area, other_area=other,
            ratio=ratio, feed_coefficient=K,
        )  # fmt: skip
        assert needed == pytest.approx(210e5, rel=1e-9)
    else:
        assert np.isnan(
            quasi_static.speed_limit(
                edge_drop=state.edge_drop, driven_area=area, feed_coefficient=K
            )
        )
