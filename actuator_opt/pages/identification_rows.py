"""What a page says of an Identification in numbers and sentences, for paper and terminal alike."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..base import quantities
from ..base.fitting import Parameter
from ..base.quantities import Quantity
from ..design.material_fits import Fit
from ..identification.coefficient import Coefficient
from ..identification.record import CHANNELS, Record
from ..identification.result import Identification
from ..metrics import METRICS
from ..rendering.blocks import State, Verdict
from ..rendering.text import (
    DASH,
    decimals,
    fixed,
    number,
    pretty,
    sentence,
    trimmed,
    unit_text,
    value_text,
    with_unit,
)

FORCE, PRESSURE = METRICS["friction_running"], quantities.INPUTS["pressure"]
SPEED, LENGTH = quantities.INPUTS["stribeck_speed"], quantities.INPUTS["position"]
DAMPING = METRICS["damping_seal"]
STIFFNESS, GROWTH = METRICS["stiffness_min"], METRICS["growth_at_seal"]
MASS = METRICS["mass"]
_VISCOUS = quantities.INPUTS["viscous_friction"]
VERDICTS = {"identifiable": "yes", "weakly identifiable": "weakly", "not identifiable": "no"}
"""Verdicts in the column "identifiable"."""
STATES: dict[str, State] = {"yes": "met", "weakly": "not_checked", "no": "missed"}
"""State of the sign before it."""
FITS = {"power_law": "power law", "double_exponential": "double exponential"}
LAWS = {"power_law": "a v^b", "double_exponential": "a₁ exp(b₁ v) + a₂ exp(b₂ v)"}


class Shown(NamedTuple):
    """How a parameter is printed: display value = SI value x scale."""

    label: str
    symbol: str
    unit: str
    scale: float


def _by(quantity: Quantity, label: str, symbol: str) -> Shown:
    return Shown(label, symbol, unit_text(quantity.unit), quantity.to_display(1.0))


PARAMETERS = {
    "coulomb": _by(FORCE, "Coulomb", "F_C"),
    "static": _by(FORCE, "static", "F_S"),
    "stribeck_speed": _by(SPEED, "Stribeck speed", "v_s"),
    "exponent": Shown("exponent", "δ", "", 1.0),
    "viscous": _by(_VISCOUS, "viscous", "σ₂"),
    "pressure_slope": Shown("with pressure", "dF_C/dp", "N/bar", 1e5),
    "offset": _by(FORCE, "offset", "F_0"),
    "bristle_stiffness": _by(STIFFNESS, "bristle stiffness", "σ₀"),
    "bristle_damping": _by(_VISCOUS, "bristle damping", "σ₁"),
    "lag": Shown("lag left", "τ", "ms", 1e3),
}
"""Parameters of the Stribeck curve and the LuGre model."""
_NOTHING = {
    "viscous": "no viscous friction",
    "pressure_slope": "no effect of pressure",
    "bristle_damping": "σ₁ not parted from a lag",
}
COEFFICIENTS = {
    ("power_law", "coefficient"): _by(DAMPING, "power law", "a"),
    ("power_law", "exponent"): Shown("exponent", "b", "", 1.0),
    ("double_exponential", "coefficient_1"): _by(DAMPING, "1st exponential", "a₁"),
    ("double_exponential", "rate_1"): Shown("its rate", "b₁", "s/m", 1.0),
    ("double_exponential", "coefficient_2"): _by(DAMPING, "2nd exponential", "a₂"),
    ("double_exponential", "rate_2"): Shown("its rate", "b₂", "s/m", 1.0),
}
"""Parameters of the fits of the secant damping."""


NOTHING = 2e-3
"""A value below this share of its bounds' half width is as good as 0 (a choice: 3 digits)."""


class Row(NamedTuple):
    """A parameter as printed: value with unit, bounds without, and its verdict."""

    label: str
    symbol: str
    value: str
    lower: str
    upper: str
    verdict: str


def _row(shown: Shown, one: Parameter) -> Row:
    value, low, high = rounded(*(x * shown.scale for x in one[:3]))
    words = VERDICTS[one.verdict]
    return Row(shown.label, shown.symbol, with_unit(value, shown.unit), low, high, words)


def rounded(value: float, lower: float, upper: float) -> tuple[str, str, str]:
    """A value and its bounds, no finer than the bounds tell, four digits at most.

    A value keeps three digits unless it is nothing beside its bounds.

    >>> rounded(4.904e-4, -0.4223, 0.4233), rounded(148.23, 146.21, 150.25)
    (('0.000', '−0.422', '0.423'), ('148.2', '146.2', '150.2'))
    >>> rounded(4.604, -329.2, 338.6)
    ('4.60', '−329', '339')
    """
    half, largest = (upper - lower) / 2, max(abs(value), abs(lower), abs(upper))
    if not 0 < half < math.inf:
        return number(value), number(lower), number(upper)
    if not 1e-3 <= largest < 1e6:
        return number(value, 2), number(lower, 2), number(upper, 2)
    places = min(decimals(half, 3), decimals(largest, 4))
    own = places if abs(value) < NOTHING * half else max(places, min(decimals(value, 3), 4))
    return fixed(value, own), fixed(lower, places), fixed(upper, places)


def parameter_rows(parameters: Mapping[str, Parameter]) -> list[Row]:
    """Parameters of a friction model in the order of `PARAMETERS`."""
    known = [name for name in PARAMETERS if name in parameters]
    return [_row(PARAMETERS[name], parameters[name]) for name in known]


def fit_rows(fits: Mapping[str, Fit | str]) -> list[Row]:
    """Parameters of the damping's fits that have a value."""
    found = []
    for name, fit in fits.items():
        if isinstance(fit, str):
            continue
        for key, one in fit.parameters.items():
            shown = COEFFICIENTS.get((name, key)) or Shown(key.replace("_", " "), "", "", 1.0)
            found.append(_row(shown, one))
    return found


def every_parameter(found: Identification) -> list[Parameter]:
    """All parameters of the friction models."""
    models = [one for one in (found.stribeck, found.lugre) if not isinstance(one, str)]
    return [one for model in models for one in model.parameters.values()]


def held(values: Mapping[str, float]) -> str:
    """Values that were not asked for, in words; empty for none."""
    left = {name: value for name, value in values.items() if name != "lag"}
    found = []
    if "stribeck_speed" in left:
        for name in ("static", "stribeck_speed", "exponent"):
            left.pop(name, None)
        found.append("no rise towards rest")
    for name, value in left.items():
        shown = PARAMETERS[name]
        if value == 0:
            found.append(_NOTHING.get(name, f"no {shown.label}"))
            continue
        found.append(f"{shown.label} {with_unit(trimmed(value * shown.scale), shown.unit)}")
    return f"Held: {', '.join(found)}." if found else ""


# ---- friction summary ----


def force(value: float) -> str:
    """A force in N.

    >>> force(119.93)
    '119.9 N'
    """
    return value_text(FORCE, value)


def pressure(value: float) -> str:
    """A pressure in bar.

    >>> pressure(5.1019e5)
    '5.10 bar'
    """
    return value_text(PRESSURE, value, 3)


def bounds(lower: float, upper: float, quantity: Quantity) -> str:
    """Both bounds with one unit.

    >>> bounds(149.6, 150.4, FORCE)
    '149.6 to 150.4 N'
    """
    low, high = (number(quantity.to_display(x)) for x in (lower, upper))
    return with_unit(f"{low} to {high}", unit_text(quantity.unit))


def coefficient_words(one: Coefficient | str) -> str:
    """The friction coefficient with what it rests on."""
    if isinstance(one, str):
        return sentence(f"Friction coefficient: {one}")
    low, high = (number(1e3 * v, 3) for v in one.speeds)
    return (
        f"Friction coefficient {number(one.value, 3)} (95 %: {number(one.lower, 3)} to"
        f" {number(one.upper, 3)}), median of {one.windows} windows of sliding at {low} to"
        f" {high} mm/s; contact pressure {number(one.contact_pressure / 1e6, 3)} MPa, contact"
        f" force {force(one.contact_force)}, by {one.law}; rise towards rest and viscous part are"
        " in it."
    )


def what(found: Identification) -> str:
    """What was looked at, in one line."""
    count = len(found.points)
    kind = {"plateau": "plateaus", "sweep": "sweeps"}
    if not count:
        seen = "no point of steady sliding"
    else:
        speeds = [one.speed for one in found.points]
        low, high = (trimmed(1e3 * v, 3) for v in (min(speeds), max(speeds)))
        range_ = f"{low} to {high} mm/s" if low != high else f"{low} mm/s"
        ways = {one.velocity > 0 for one in found.points}
        way = "both ways" if len(ways) == 2 else "outwards alone" if True in ways else "inwards"
        points = "1 point" if count == 1 else f"{count} points"
        seen = f"{points} of steady sliding by {kind[found.points[0].kind]}, {range_}, {way}"
    if not isinstance(found.lugre, str):
        windows = "1 window" if found.lugre.count == 1 else f"{found.lugre.count} windows"
        seen += f"; {windows} about reversals"
    return f"Record {found.record.file_name}: {seen}."


# ---- record and how it was conditioned ----


def samples_hash(record: Record) -> str:
    """SHA-256 of the samples: name and little-endian doubles (SI) of time and every channel."""
    digest = hashlib.sha256()
    for name, values in (("t", record.time), *sorted(record.channels.items())):
        digest.update(name.encode() + b"\0")
        digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
    return digest.hexdigest()


def record_words(found: Identification) -> str:
    """The record's name, length, rate, channels and the hash of its samples."""
    record, motion = found.record, found.motion
    channels = ", ".join(("t", *record.channels))
    span = float(record.time[-1] - record.time[0])
    return (
        f"{record.file_name}: {trimmed(record.time.size, 9)} samples, {number(span)} s,"
        f" {trimmed(1 / motion.sample_time)} samples per second; channels {channels}; SHA-256 of"
        f" the samples (SI, doubles) {samples_hash(record)}."
    )


ROUNDING = 1e-12
"""Steps and noise below this are rounding of the numbers, SI."""
CHANNEL_HEADS = ("channel", "missing", "spikes", "clipped", "step", "noise (1σ)")
_CHANNELS = {
    "p1": PRESSURE,
    "p2": PRESSURE,
    "x": METRICS["bore_growth"],
    "v": SPEED,
    "F_L": FORCE,
}
"""Quantity of each channel: micrometres for the step of a position sensor."""


def channel_rows(found: Identification) -> list[list[str]]:
    """Samples missing, spikes, clipped; least step and noise of every channel."""
    rows = []
    for name, one in found.motion.quality.items():
        counts = [trimmed(x, 9) for x in (one.missing, one.spikes, one.clipped)]
        rows.append([name, *counts, *(_small(name, x) for x in (one.resolution, one.noise))])
    return rows


def _small(name: str, value: float) -> str:
    if name == "T":
        return f"{number(value, 2)} K"
    quantity = _CHANNELS.get(name)
    return DASH if quantity is None else value_text(quantity, value if value > ROUNDING else 0, 2)


def conditioning(found: Identification) -> str:
    """Filter, mass and lag in sentences."""
    motion = found.motion
    gain = "both passes −3 dB" if motion.compensated else "each pass −3 dB"
    load = found.settings.load_force
    known = load is not None and "F_L" not in found.record
    against = f" against the stated load of {force(load)}" if known and load is not None else ""
    return (
        f"Zero-phase Butterworth filter of order {motion.order} at {trimmed(motion.cutoff)} Hz"
        f" ({gain}), which keeps {number(100 * found.spectrum.kept, 3)} % of the velocity's power:"
        f" {found.spectrum.says(motion.cutoff)}. Force balance with"
        f" {value_text(MASS, found.mass)} moving inside the force sensor{against}; {_lag(found)}."
        f" {_bounds_by(found)}"
    )


def _lag(found: Identification) -> str:
    """What was taken off the pressures, or why nothing was."""
    taken, seen = found.pressure_lag, found.lag_seen
    if found.settings.pressure_lag is not None:
        return f"{number(1e3 * taken, 3)} ms of lag taken off the pressures, as stated"
    if taken:
        return f"{number(1e3 * taken, 3)} ms taken off the pressures"
    if seen is None or not math.isfinite(seen.upper - seen.lower):
        return "whether the pressures come late the record cannot show, none is taken off"
    low, high = (number(1e3 * x, 2) for x in (seen.lower, seen.upper))
    return f"lag of the pressures {low} to {high} ms by the record, none taken off"


def mean_label(found: Identification) -> str:
    """What the mean friction is the mean of."""
    return "mean in sliding" if found.slides else "mean, without sliding"


def _bounds_by(found: Identification) -> str:
    """Where the bounds of the parameters come from."""
    if found.settings.bootstrap:
        return f"Bounds by {found.settings.bootstrap} resampled records."
    return "Bounds of the linearised models."


def doubts(found: Identification) -> list[str]:
    """Why something has no value, and doubts, in full sentences."""
    models: dict[str, Any] = {"Stribeck curve": found.stribeck, "LuGre model": found.lugre}
    for name, fit in found.fits.items():
        models[FITS.get(name, name.replace("_", " "))] = fit
    said = []
    for label, one in models.items():
        if isinstance(one, str):
            said.append(sentence(f"no {label}: {one}"))
        elif one.doubts:
            said.append(sentence(f"{label}: {'; '.join(one.doubts)}"))
    return said


def remarks(found: Identification) -> list[str]:
    """Notes in full sentences, those left out that the table of channels holds."""
    counted = _counted(found)
    return [_note(pretty(note)) for note in found.notes if note not in counted]


def _note(words: str) -> str:
    """A sentence; the name of a channel keeps its letter."""
    said = sentence(words)
    return words[0] + said[1:] if re.match(rf"({'|'.join(CHANNELS)})\b", words) else said


def _counted(found: Identification) -> set[str]:
    """Notes that the table of channels holds."""
    total = found.record.time.size
    quality = found.motion.quality.items()
    return {note for name, one in quality for note in one.told(name, total)}


def fit_note(fits: Mapping[str, Fit | str]) -> str:
    """Laws and R² of the fits."""
    parts = []
    for name, fit in fits.items():
        if isinstance(fit, str):
            continue
        share = DASH if fit.r_squared is None else trimmed(fit.r_squared, 4)
        parts.append(f"{FITS.get(name, name)} B = {LAWS.get(name, '')}, R² {share}")
    if not parts:
        return ""
    return sentence("; ".join(parts) + "; relative errors weighted, v in m/s")


def verdict(found: Identification) -> Verdict:
    """Whether friction models were found and how many of their parameters are identifiable."""
    models = {"Stribeck curve": found.stribeck, "LuGre model": found.lugre}
    names = [name for name, one in models.items() if not isinstance(one, str)]
    known = every_parameter(found)
    sure = sum(one.identifiable for one in known)
    if not names:
        return Verdict("missed", "NO MODEL", ["friction over time alone"])
    state: State
    state, words = "checks", "FOUND IN PART"
    if not sure:
        state, words = "missed", "NOT IDENTIFIABLE"
    elif len(names) == len(models) and sure == len(known):
        state, words = "met", "MODELS FOUND"
    lines = [" and ".join(names), f"{sure} of {len(known)} parameters identifiable"]
    return Verdict(state, words, lines)
