"""The page of an Identification: friction, models with their verdicts, figures, and the basis."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..base import quantities
from ..base.fitting import Parameter
from ..base.quantities import Quantity
from ..design.material import LawFit
from ..identification.balance import Coefficient
from ..identification.lugre import LuGreFit
from ..identification.record import CHANNELS, Record
from ..identification.result import Identification
from ..identification.stribeck_fit import StribeckFit
from ..metrics import METRICS
from ..rendering.blocks import (
    Block,
    Column,
    Notes,
    Page,
    Pair,
    Row,
    State,
    Status,
    Table,
    TerminalFigure,
    Tile,
    Verdict,
    tile,
)
from ..rendering.heights import HALF, SPARE, height
from ..rendering.series import Series
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
from .identification_figures import (
    FORCE,
    LEAST,
    MOST,
    PRESSURE,
    SPEED,
    STIFFNESS,
    identification_figure,
)

DAMPING = METRICS["damping_seal"]
MASS = METRICS["mass"]
_VISCOUS = quantities.INPUTS["viscous_friction"]
VERDICTS = {"identifiable": "yes", "weakly identifiable": "weakly", "not identifiable": "no"}
"""Words of the verdicts in the column "identifiable"."""
STATES: dict[str, tuple[State, str]] = {
    "yes": ("met", "✔"),
    "weakly": ("not_checked", "○"),
    "no": ("missed", "✘"),
}
"""State (colour) and sign of each verdict."""
FITS = {"power_law": "power law", "double_exponential": "double exponential"}
LAWS = {"power_law": "a v^b", "double_exponential": "a₁ exp(b₁ v) + a₂ exp(b₂ v)"}


def page(identification: Identification) -> Page:
    """The page of an identification."""
    return Page(
        name=identification.bench.design.name,
        kind="Friction and damping by a test record",
        verdict=verdict(identification),
        sentence=subject(identification),
        tiles=_tiles(identification),
        hero=lambda room: identification_figure(identification, min(room, MOST)),
        least=LEAST - SPARE,  # the estimated height of the blocks is too high by SPARE
        blocks=list(_blocks(identification)),
    )


COLUMNS = {
    "time": ("t [s]", 1.0, "6f"),
    "position": ("x [mm]", 1e3, "5f"),
    "velocity": ("v [mm/s]", 1e3, "5g"),
    "acceleration": ("acceleration [m/s^2]", 1.0, "5g"),
    "pressure_1": ("p1 [bar]", 1e-5, "5f"),
    "pressure_2": ("p2 [bar]", 1e-5, "5f"),
    "friction": ("friction [N]", 1.0, "5g"),
    "stiffness": ("k_eq [kN/mm]", 1e-6, "5g"),
    "growth": ("growth at seal [um]", 1e6, "5g"),
}
"""For each column: heading with unit, factor from SI to the displayed value, and number of digits.
"""


def series(identification: Identification) -> list[Series]:
    """Quantities over time, one row per sample; cells without a value are empty."""
    return [
        Series(COLUMNS[name][0], (COLUMNS[name][1] * values).tolist(), form=COLUMNS[name][2])
        for name, values in identification.series().items()
    ]


# ---- blocks ----


def _tiles(identification: Identification) -> list[Tile]:
    """Friction, the equivalent pressure loss, Coulomb friction and the friction coefficient."""
    mean, mu = identification.mean, identification.coefficient
    largest = f"{pressure(identification.largest / identification.area)} at the largest friction"
    tiles = [
        tile(
            mean_label(identification).replace("mean", "mean friction", 1),
            force(mean.value),
            f"95 %: {bounds(mean.lower, mean.upper, FORCE)}",
        ),
        tile("maximum friction", force(identification.largest), "of the filtered record"),
        tile("equivalent pressure loss", pressure(mean.value / identification.area), largest),
    ]
    models = (identification.stribeck, identification.lugre)
    model = next((model for model in models if not isinstance(model, str)), None)
    coulomb = None if model is None else model.parameters.get("coulomb")
    if coulomb is None:
        tiles.append(tile("Coulomb friction", DASH, "no model"))
    else:
        note = f"95 %: {bounds(coulomb.lower, coulomb.upper, FORCE)}"
        tiles.append(tile("Coulomb friction", force(coulomb.value), note))
    if isinstance(mu, str):
        tiles.append(tile("friction coefficient", DASH, "see below"))
    else:
        note = f"contact pressure {number(mu.contact_pressure / 1e6, 3)} MPa"
        tiles.append(tile("friction coefficient", number(mu.value, 3), note))
    return tiles


def _blocks(identification: Identification) -> Iterator[Block]:
    """Blocks: parameters with their verdicts, channels, and the basis of the results."""
    yield _friction(identification)
    sides = [[*_stribeck(identification), *_fits(identification)], _lugre(identification)]
    shorter = min(sides, key=lambda side: sum(height(block, HALF) for block in side))
    shorter.append(_channels(identification))
    yield Pair(sides)
    yield from _curve(identification)
    if said := doubts(identification):
        yield Notes("Doubts", said, headless=True, style="yellow", on="terminal")
    said = [" ".join(doubts(identification)), " ".join(remarks(identification))]
    said = [coefficient_words(identification.coefficient), conditioning(identification), *said]
    said = [words for words in (*said, record_words(identification)) if words]
    yield Notes("Basis of these results", said, on="paper")
    said = [coefficient_words(identification.coefficient), conditioning(identification)]
    said += [*remarks(identification), record_words(identification)]
    yield Notes("Basis of these results", said, headless=True, style="dim", on="terminal")


def _friction(identification: Identification) -> Table:
    """Mean, maximum, equivalent pressure and coefficient of friction."""
    mean, area, mu = identification.mean, identification.area, identification.coefficient
    loss = [number(PRESSURE.to_display(x / area), 3) for x in (mean.lower, mean.upper)]
    largest = identification.largest
    rows = [
        [mean_label(identification), force(mean.value), number(mean.lower), number(mean.upper)],
        ["maximum", force(largest), "", ""],
        ["equivalent pressure loss", pressure(mean.value / area), *loss],
        ["pressure loss at maximum", pressure(largest / area), "", ""],
    ]
    if isinstance(mu, str):
        rows.append(["friction coefficient", DASH, "", ""])
    else:
        numbers = [number(x, 3) for x in (mu.value, mu.lower, mu.upper)]
        rows.append(["friction coefficient", *numbers])
    columns = [
        Column("friction", width=1.0, least=24),
        Column("value", "right", strong=True),
        Column("lower", "right", drop=1, style="dim"),
        Column("upper", "right", drop=1, style="dim"),
    ]
    return Table("Friction", columns, rows, headless=True, on="terminal")


def _stribeck(identification: Identification) -> list[Block]:
    fit = identification.stribeck
    if isinstance(fit, str):
        return []
    said = held(fit.held)
    if "pressure_slope" in fit.parameters:
        said += f" F_C and F_S at {pressure(fit.reference_pressure)}."
    return [_parameters("Stribeck curve", parameter_rows(fit.parameters), said.strip())]


def _lugre(identification: Identification) -> list[Block]:
    fit = identification.lugre
    if isinstance(fit, str):
        return []
    said = f"Scatter of friction about the model {force(fit.misfit)}. {held(fit.held)}"
    return [_parameters("LuGre model", parameter_rows(fit.parameters), said.strip())]


def _fits(identification: Identification) -> list[Block]:
    rows = fit_rows(identification.fits)
    if not rows:
        return []
    return [_parameters("Secant damping", rows, fit_note(identification.fits))]


def _parameters(title: str, estimates: Sequence[Estimate], note: str) -> Block:
    """Parameters with confidence intervals; every verdict has a sign beside it."""
    columns = [
        Column("parameter", "left", 1.0, least=10),
        Column("", drop=3, style="dim"),
        Column("value", "right", strong=True),
        Column("lower", "right", drop=1, style="dim"),
        Column("upper", "right", drop=2, style="dim"),
        Column("identifiable", on="paper"),
        Column("identifiable", style="state", on="terminal"),
    ]
    rows = []
    for row in estimates:
        state, sign = STATES[row.verdict]
        verdict = (Status(state, row.verdict), f"{sign} {row.verdict}")
        cells = (row.label, row.symbol, row.value, row.lower, row.upper, *verdict)
        rows.append(Row(cells, "no_reserve" if state == "not_checked" else state))
    return Table(f"{title}, 95 % bounds", columns, rows, note=note)


def _channels(identification: Identification) -> Block:
    columns = [
        Column(
            head,
            "right" if k else "left",
            "auto" if k else 1.0,
            breaks=14,
            drop=max(0, k - 3),
        )
        for k, head in enumerate(CHANNEL_HEADS)
    ]
    return Table("Channels of the record", columns, channel_rows(identification))


def _curve(identification: Identification) -> list[Block]:
    """The Stribeck curve over the logarithm of speed: extension if recorded, else retraction."""
    fit, points = identification.stribeck, identification.points
    speeds = [point.speed for point in points]
    if not isinstance(fit, StribeckFit) or max(speeds) <= min(speeds):
        return []
    way = 1.0 if any(point.velocity > 0 for point in points) else -1.0
    along = np.geomspace(min(speeds), max(speeds), 120)
    friction = way * fit.predict(way * along, np.full(along.shape, fit.reference_pressure))
    shown = list(zip(np.log10(along).tolist(), np.asarray(friction).tolist(), strict=True))
    ends = (f"{number(1e3 * along[0], 3)} mm/s", f"{number(1e3 * along[-1], 3)} mm/s")
    side = "outwards" if way > 0 else "inwards"
    title = f"Stribeck curve {side}, N over the logarithm of speed"
    return [TerminalFigure(title, shown, ends=ends)]


# ---- parameters ----


class ParameterDisplay(NamedTuple):
    """Label, symbol and unit of a parameter; display value = SI value x scale."""

    label: str
    symbol: str
    unit: str
    scale: float


def _by(quantity: Quantity, label: str, symbol: str) -> ParameterDisplay:
    return ParameterDisplay(label, symbol, unit_text(quantity.unit), quantity.to_display(1.0))


PARAMETERS = {
    "coulomb": _by(FORCE, "Coulomb", "F_C"),
    "static": _by(FORCE, "static", "F_S"),
    "stribeck_speed": _by(SPEED, "Stribeck speed", "v_s"),
    "exponent": ParameterDisplay("exponent", "δ", "", 1.0),
    "viscous": _by(_VISCOUS, "viscous", "σ₂"),
    "pressure_slope": ParameterDisplay("with pressure", "dF_C/dp", "N/bar", 1e5),
    "offset": _by(FORCE, "offset", "F_0"),
    "bristle_stiffness": _by(STIFFNESS, "bristle stiffness", "σ₀"),
    "bristle_damping": _by(_VISCOUS, "bristle damping", "σ₁"),
    "lag": ParameterDisplay("remaining lag", "τ", "ms", 1e3),
}
"""Parameters of the Stribeck curve and the LuGre model."""
_NOTHING = {
    "viscous": "no viscous friction",
    "pressure_slope": "no effect of pressure",
    "bristle_damping": "σ₁ not separable from a lag",
}
COEFFICIENTS = {
    ("power_law", "coefficient"): _by(DAMPING, "power law", "a"),
    ("power_law", "exponent"): ParameterDisplay("exponent", "b", "", 1.0),
    ("double_exponential", "coefficient_1"): _by(DAMPING, "1st exponential", "a₁"),
    ("double_exponential", "rate_1"): ParameterDisplay("its rate", "b₁", "s/m", 1.0),
    ("double_exponential", "coefficient_2"): _by(DAMPING, "2nd exponential", "a₂"),
    ("double_exponential", "rate_2"): ParameterDisplay("its rate", "b₂", "s/m", 1.0),
}
"""Parameters of the laws fitted to the secant damping."""
NOTHING = 2e-3
"""A value smaller than this share of half its confidence interval is printed as 0 (our choice)."""


class Estimate(NamedTuple):
    """A parameter as printed: value with unit, confidence interval without unit, and verdict."""

    label: str
    symbol: str
    value: str
    lower: str
    upper: str
    verdict: str


def _row(shown: ParameterDisplay, parameter: Parameter) -> Estimate:
    value, low, high = rounded(*(x * shown.scale for x in parameter[:3]))
    words = VERDICTS[parameter.verdict]
    return Estimate(shown.label, shown.symbol, with_unit(value, shown.unit), low, high, words)


def rounded(value: float, lower: float, upper: float) -> tuple[str, str, str]:
    """A value and its confidence interval, rounded to the digits that the interval justifies.

    At most four digits are printed. A value keeps at least three, unless it is negligible beside
    its interval.

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


def parameter_rows(parameters: Mapping[str, Parameter]) -> list[Estimate]:
    """Parameters of a friction model in the order of `PARAMETERS`."""
    known = [name for name in PARAMETERS if name in parameters]
    return [_row(PARAMETERS[name], parameters[name]) for name in known]


def fit_rows(fits: Mapping[str, LawFit | str]) -> list[Estimate]:
    """Parameters of the damping laws that could be fitted."""
    rows = []
    for name, fit in fits.items():
        if isinstance(fit, str):
            continue
        for key, parameter in fit.parameters.items():
            shown = COEFFICIENTS.get((name, key)) or ParameterDisplay(
                key.replace("_", " "), "", "", 1.0
            )
            rows.append(_row(shown, parameter))
    return rows


def every_parameter(identification: Identification) -> list[Parameter]:
    """All parameters of the friction models."""
    models = (identification.stribeck, identification.lugre)
    known = [model for model in models if not isinstance(model, str)]
    return [parameter for model in known for parameter in model.parameters.values()]


def held(values: Mapping[str, float]) -> str:
    """Values that the fit kept fixed, in words; empty if there were none."""
    left = {name: value for name, value in values.items() if name != "lag"}
    said = []
    if "stribeck_speed" in left:
        for name in ("static", "stribeck_speed", "exponent"):
            left.pop(name, None)
        said.append("no rise towards rest")
    for name, value in left.items():
        shown = PARAMETERS[name]
        if value == 0:
            said.append(_NOTHING.get(name, f"no {shown.label}"))
            continue
        said.append(f"{shown.label} {with_unit(trimmed(value * shown.scale), shown.unit)}")
    return f"Held: {', '.join(said)}." if said else ""


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
    """Lower and upper bound with a common unit.

    >>> bounds(149.6, 150.4, FORCE)
    '149.6 to 150.4 N'
    """
    low, high = (number(quantity.to_display(x)) for x in (lower, upper))
    return with_unit(f"{low} to {high}", unit_text(quantity.unit))


def coefficient_words(coefficient: Coefficient | str) -> str:
    """The friction coefficient and how it was obtained."""
    if isinstance(coefficient, str):
        return sentence(f"Friction coefficient: {coefficient}")
    low, high = (number(1e3 * v, 3) for v in coefficient.speeds)
    return (
        f"Friction coefficient {number(coefficient.value, 3)} (95 %: "
        f"{number(coefficient.lower, 3)} to {number(coefficient.upper, 3)}), median of "
        f"{coefficient.windows} windows of sliding at {low} to {high} mm/s; contact "
        f"pressure {number(coefficient.contact_pressure / 1e6, 3)} MPa, contact force "
        f"{force(coefficient.contact_force)}, by {coefficient.law}; includes "
        "the Stribeck rise and viscous friction."
    )


def subject(identification: Identification) -> str:
    """The record and its points of steady sliding, in one sentence."""
    count = len(identification.points)
    kind = {"plateau": "plateaus", "sweep": "sweeps"}
    if not count:
        seen = "no point of steady sliding"
    else:
        speeds = [point.speed for point in identification.points]
        low, high = (trimmed(1e3 * v, 3) for v in (min(speeds), max(speeds)))
        range_ = f"{low} to {high} mm/s" if low != high else f"{low} mm/s"
        ways = {point.velocity > 0 for point in identification.points}
        way = (
            "in both directions"
            if len(ways) == 2
            else "outwards only"
            if True in ways
            else "inwards only"
        )
        points = "1 point" if count == 1 else f"{count} points"
        by = kind[identification.points[0].kind]
        seen = f"{points} of steady sliding from {by}, {range_}, {way}"
    if not isinstance(identification.lugre, str):
        total = identification.lugre.count
        windows = "1 window" if total == 1 else f"{total} windows"
        seen += f"; {windows} around reversals of motion"
    return f"Record {identification.record.file_name}: {seen}."


# ---- the record and its conditioning ----


def samples_hash(record: Record) -> str:
    """SHA-256 of the samples.

    It covers the name and the values (little-endian doubles, SI) of time and of every channel.
    """
    digest = hashlib.sha256()
    for name, values in (("t", record.time), *sorted(record.channels.items())):
        digest.update(name.encode() + b"\0")
        digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
    return digest.hexdigest()


def record_words(identification: Identification) -> str:
    """The record's name, length, rate, channels and the hash of its samples."""
    record, motion = identification.record, identification.motion
    channels = ", ".join(("t", *record.channels))
    span = float(record.time[-1] - record.time[0])
    return (
        f"{record.file_name}: {trimmed(record.time.size, 9)} samples, {number(span)} s,"
        f" {trimmed(1 / motion.sample_time)} samples per second; channels {channels}; SHA-256 of"
        f" the samples (SI, doubles) {samples_hash(record)}."
    )


ROUNDING = 1e-12
"""Resolution steps and noise below this value (SI) are only rounding errors."""
CHANNEL_HEADS = ("channel", "missing", "spikes", "clipped", "step", "noise (1σ)")
_CHANNELS = {
    "p1": PRESSURE,
    "p2": PRESSURE,
    "x": METRICS["bore_growth"],
    "v": SPEED,
    "F_L": FORCE,
}
"""Display quantity of each channel; a position sensor's resolution is shown in micrometres."""


def channel_rows(identification: Identification) -> list[list[str]]:
    """For every channel: counts of missing, spiked and clipped samples, smallest step, noise."""
    rows = []
    for name, channel in identification.motion.quality.items():
        counts = [trimmed(x, 9) for x in (channel.missing, channel.spikes, channel.clipped)]
        sizes = (channel.resolution, channel.noise)
        rows.append([name, *counts, *(_small(name, x) for x in sizes)])
    return rows


def _small(name: str, value: float) -> str:
    if name == "T":
        return f"{number(value, 2)} K"
    quantity = _CHANNELS.get(name)
    return DASH if quantity is None else value_text(quantity, value if value > ROUNDING else 0, 2)


def conditioning(identification: Identification) -> str:
    """Sentences on the filter, the moving mass and the sensor lag."""
    motion, spectrum = identification.motion, identification.spectrum
    gain = "both passes −3 dB" if motion.compensated else "each pass −3 dB"
    load = identification.settings.load_force
    known = load is not None and "F_L" not in identification.record
    against = f" against the stated load of {force(load)}" if known and load is not None else ""
    return (
        f"Zero-phase Butterworth filter of order {motion.order} at "
        f"{trimmed(motion.cutoff)} Hz ({gain}), which keeps "
        f"{number(100 * spectrum.kept, 3)} % of the power of the velocity signal: "
        f"{spectrum.says(motion.cutoff)}. Force balance with "
        f"{value_text(MASS, identification.mass)} moving on the actuator's side of the force "
        f"sensor{against}; "
        f"{_lag(identification)}. {_bounds_by(identification)}"
    )


def _lag(identification: Identification) -> str:
    """The lag removed from the pressure signals, or why none was removed."""
    taken, seen = identification.pressure_lag, identification.lag_seen
    if identification.settings.pressure_lag is not None:
        return f"{number(1e3 * taken, 3)} ms of lag in the pressures, as stated, is corrected"
    if taken:
        return f"{number(1e3 * taken, 3)} ms of lag in the pressures is corrected"
    if seen is None or not math.isfinite(seen.upper - seen.lower):
        return "the record cannot show whether the pressures lag, so no lag is corrected"
    low, high = (number(1e3 * x, 2) for x in (seen.lower, seen.upper))
    return f"according to the record, the pressures lag by {low} to {high} ms; no lag is corrected"


def mean_label(identification: Identification) -> str:
    """Label of the mean friction, which says whether only samples with a sliding rod count."""
    return "mean while sliding" if identification.slides else "mean, without sliding"


def _bounds_by(identification: Identification) -> str:
    """Sentence on how the parameters' confidence intervals were computed."""
    if identification.settings.bootstrap:
        return (
            f"95 % bounds are computed from {identification.settings.bootstrap} resampled records."
        )
    return "95 % bounds come from the linearised models."


def doubts(identification: Identification) -> list[str]:
    """Doubts, and reasons for missing values, in full sentences."""
    models: dict[str, StribeckFit | LuGreFit | LawFit | str] = {
        "Stribeck curve": identification.stribeck,
        "LuGre model": identification.lugre,
    }
    for name, fit in identification.fits.items():
        models[FITS.get(name, name.replace("_", " "))] = fit
    said = []
    for label, model in models.items():
        if isinstance(model, str):
            said.append(sentence(f"no {label}: {model}"))
        elif model.doubts:
            said.append(sentence(f"{label}: {'; '.join(model.doubts)}"))
    return said


def remarks(identification: Identification) -> list[str]:
    """Notes in full sentences, without those that the table of channels already shows."""
    counted = _counted(identification)
    return [_note(pretty(note)) for note in identification.notes if note not in counted]


def _note(words: str) -> str:
    """A note as a sentence; the name of a channel is not capitalised."""
    said = sentence(words)
    return words[0] + said[1:] if re.match(rf"({'|'.join(CHANNELS)})\b", words) else said


def _counted(identification: Identification) -> set[str]:
    """Notes that the table of channels already shows."""
    total = identification.record.time.size
    quality = identification.motion.quality.items()
    return {note for name, channel in quality for note in channel.told(name, total)}


def fit_note(fits: Mapping[str, LawFit | str]) -> str:
    """Formula and R² of each fitted damping law."""
    parts = []
    for name, fit in fits.items():
        if isinstance(fit, str):
            continue
        share = DASH if fit.r_squared is None else trimmed(fit.r_squared, 4)
        parts.append(f"{FITS.get(name, name)} B = {LAWS.get(name, '')}, R² {share}")
    if not parts:
        return ""
    return sentence("; ".join(parts) + "; fitted to relative errors, v in m/s")


def verdict(identification: Identification) -> Verdict:
    """Whether the record gives friction models, and how many parameters are identifiable."""
    models = {"Stribeck curve": identification.stribeck, "LuGre model": identification.lugre}
    names = [name for name, model in models.items() if not isinstance(model, str)]
    known = every_parameter(identification)
    sure = sum(parameter.identifiable for parameter in known)
    if not names:
        return Verdict("missed", "NO MODEL", ["only friction over time"])
    state: State
    state, words = "checks", "PARTLY IDENTIFIED"
    if not sure:
        state, words = "missed", "NOT IDENTIFIABLE"
    elif len(names) == len(models) and sure == len(known):
        state, words = "met", "IDENTIFIED"
    lines = [" and ".join(names), f"{sure} of {len(known)} parameters identifiable"]
    return Verdict(state, words, lines)
