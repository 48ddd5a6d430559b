"""Identification of friction, damping and friction models from a test record.

If the record shows that the pressures lag the position, the lag is reported and, if possible,
corrected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

import numpy as np

from ..base.errors import InputError
from ..base.fitting import Parameter, quantile
from ..design.material import LawFit, fit_double_exponential, fit_power_law
from ..studies.bench import Bench
from .balance import Sliding, check_signs, coefficient, slide, velocity_noise
from .bootstrap import resampled
from .conditioning import ConditionedRecord, condition
from .doubtful import unbounded
from .lugre import BENDS, LuGreFit, fit_lugre, settling_distance
from .points import (
    BLURRED,
    LASTING,
    SETTLED,
    SETTLING,
    FrictionPoint,
    independent,
    settled,
    steady_points,
)
from .record import Record
from .result import Identification, Mean, Settings
from .straight import spectrum
from .stribeck_fit import StribeckFit, different, fit_stribeck
from .windows import LAG

LEAST_LAG = 3e-4
"""Smallest lag of the pressures that is corrected [s]."""
EARLIEST = 6e-3
"""Largest plausible time by which the pressures may be ahead of the position [s] (our choice). They
are ahead if the position sensor's filter delays the position; damping of the LuGre bristles can
look the same."""
STATE = "state --pressure-lag if it is known"
CANNOT = (
    "the record cannot show whether the pressures lag: raise --cutoff, reverse the rod more "
    f"slowly, or {STATE}"
)


def lag_of(lugre: LuGreFit | str) -> Parameter | None:
    """The pressure lag that the LuGre model fitted; None if it fitted no lag."""
    return None if isinstance(lugre, str) else lugre.parameters.get("lag")


def lag_to_correct(parameter: Parameter | None) -> tuple[float, str]:
    """The pressure lag to correct [s], 0 for none, and a note, which may be empty.

    A lag is corrected if its 95 % confidence interval lies above zero. A negative lag is not
    corrected, because damping of the bristles looks like early pressures. Their force is sigma_0 z
    + sigma_1 dz/dt, with deflection z, stiffness sigma_0 and damping sigma_1; it is nearly equal to
    the value of sigma_0 z at a time sigma_1/sigma_0 later. The record only gives the difference
    between the lag and this time.

    Parameters
    ----------
    parameter : lag that was fitted with sigma_1 = 0
    """
    if parameter is None:
        return 0.0, ""
    value, lower, upper = (1e3 * x for x in parameter[:3])
    if not isfinite(upper - lower):
        return 0.0, CANNOT
    if not -EARLIEST <= parameter.value <= 0.99 * LAG:
        beyond = f"outside {-1e3 * EARLIEST:g} to {1e3 * LAG:g} ms, which no sensor has"
        return 0.0, f"the reversals suggest a lag {beyond}, so none is corrected; {STATE}"
    bounds = f"{lower:.2f} to {upper:.2f}"
    if upper < 0:
        return 0.0, (
            f"friction leads the motion by {-value:.2f} ms ({-upper:.2f} to {-lower:.2f}), because "
            "of bristle damping (σ₁/σ₀) or a lagging position; the record cannot show which. No "
            f"lag is corrected; {STATE}"
        )
    if lower > 0 and parameter.value > LEAST_LAG:
        return parameter.value, (
            f"the pressures lag by {value:.2f} ms ({bounds}), according to the reversals; this lag "
            "was corrected"
        )
    return 0.0, ""


def rejected_correction(parameter: Parameter, remaining: Parameter | None) -> str:
    """Reason to reject the correction of a lag; empty if the correction is accepted.

    It is rejected if the corrected record still shows a lag. `parameter` is the lag that was
    corrected, `remaining` the lag that was fitted afterwards.
    """
    if remaining is None or remaining.lower <= 0 <= remaining.upper:
        return ""
    return (
        f"correcting the pressures by {1e3 * parameter.value:.2f} ms leaves a lag of "
        f"{1e3 * remaining.value:.2f} ms, so some other effect looks like a lag; no lag is "
        f"corrected; {STATE}"
    )


def with_uncertain_damping(lugre: LuGreFit | str) -> LuGreFit | str:
    """Remove the confidence limits of bristle damping sigma_1, as the pressure lag is unknown."""
    if isinstance(lugre, str):
        return lugre
    doubt = "σ₁ is valid only if the pressures do not lag; a lag τ would add σ₀ τ to it"
    parameters = unbounded(lugre.parameters, ("bristle_damping",))
    return replace(lugre, parameters=parameters, doubts=(*lugre.doubts, doubt))


LAWS = {"power_law": fit_power_law, "double_exponential": fit_double_exponential}
"""Laws for the secant damping F/v as a function of speed, with the function that fits each."""
LEAST_SPEEDS = 3
"""Number of different speeds needed to fit a law: two for its parameters, plus one degree of
freedom."""
WARMER = 10.0
"""Temperature difference between record and design above which a note reports it [K] (our choice:
it changes the stiffness of rubber by a few per cent)."""
OUTSIDE = 0.02
"""Share of the stroke by which positions of the record may lie beyond the ends of the stroke."""
STEPS, NOISES = 2.0, 10.0
"""Largest measured travel at which the rod still counts as at rest: in sensor steps, and in
standard deviations of the filtered position (our choice: 10 000 samples of normal noise span 8
standard deviations)."""
PACE = 0.05
"""Permitted relative difference between the channel v and the time derivative of x (our choice)."""


def identify(record: Record, bench: Bench, settings: Settings | None = None) -> Identification:
    """Identify friction and damping from a test record.

    Parameters
    ----------
    record : record with p1, x and F_L (or `load_force`), and p2 unless the rod is a plunger
    bench : the tested design
    settings : settings of the identification; None for the defaults

    Returns
    -------
    the identification

    Raises
    ------
    InputError
        a channel is missing; the record is too short or too slow; signs are wrong; the rod does not
        move or travels beyond the stroke; or a mass or lag is invalid
    """
    settings = settings or Settings()
    _check_channels(record, bench, settings)
    mass = _mass(record, bench, settings)
    lag, known = settings.pressure_lag or 0.0, settings.pressure_lag is not None
    motion, slidings = _conditioned(record, bench, settings, mass, lag, None)
    _check_motion(record, motion, slidings, bench, mass)
    area = float(bench.areas(np.float64(0.0))[0])
    points, stribeck, lugre = _models(slidings, motion, area, known)
    settling, fitted_lag = settling_distance(lugre), None if known else lag_of(lugre)
    correction, note = lag_to_correct(fitted_lag)
    if correction and fitted_lag is not None:
        uncorrected = motion, slidings
        motion, slidings = _conditioned(record, bench, settings, mass, correction, motion)
        points, stribeck, lugre = _models(slidings, motion, area, False, settling)
        if reason := rejected_correction(fitted_lag, lag_of(lugre)):
            correction, note, (motion, slidings) = 0.0, reason, uncorrected
    unknown = bool(note) and not correction and note != CANNOT
    if unknown or (not correction and settling > SETTLED):
        points, stribeck, lugre = _models(slidings, motion, area, known or unknown, settling)
    if unknown:
        lugre = with_uncertain_damping(lugre)
    notes = [note] if note else []
    if settings.bootstrap:
        count, seed = settings.bootstrap, settings.seed
        stribeck, lugre = resampled(
            slidings, motion, points, stribeck, lugre, count=count, seed=seed, settling=settling
        )
    mean, largest, slides = _sizes(slidings, motion, settling)
    return Identification(
        record=record,
        bench=bench,
        settings=settings,
        motion=motion,
        slidings=tuple(slidings),
        mass=mass,
        pressure_lag=correction or lag,
        lag_seen=fitted_lag,
        spectrum=spectrum(record, motion),
        mean=mean,
        largest=largest,
        slides=slides,
        area=area,
        points=points,
        coefficient=coefficient(slidings, motion, bench),
        stribeck=stribeck,
        lugre=lugre,
        fits=_fits(points),
        notes=(
            *motion.notes,
            *notes,
            *_outside(slidings, bench),
            *_warmth(record, bench),
            *_blurred(points, motion),
            *_pace(motion),
        ),
    )


def _check_motion(
    record: Record,
    motion: ConditionedRecord,
    slidings: Sequence[Sliding],
    bench: Bench,
    mass: float,
) -> None:
    """Reject a record if the rod is at rest, moves beyond its stroke, or a sign is wrong."""
    travel = max(float(np.ptp(piece["x"][piece.sound])) for piece in motion.pieces)
    quality = motion.quality["x"]
    noise = quality.noise * np.sqrt(motion.band)
    if travel <= max(STEPS * quality.resolution, NOISES * noise):
        raise record.fault(
            f"the rod never moves: x changes by {1e3 * travel:.2g} mm, within its resolution "
            "and noise",
            "give a record of a moving rod, and x with more digits",
        )
    if travel > (1 + OUTSIDE) * bench.stroke:
        raise record.fault(
            f"x travels {1e3 * travel:.4g} mm, but the stroke is {1e3 * bench.stroke:.4g} mm",
            "check the unit of x, and cylinder.stroke of the design",
        )
    if any(sliding.moving.any() for sliding in slidings):
        check_signs(slidings, bench, mass=mass, name=record.name)


def _outside(slidings: Sequence[Sliding], bench: Bench) -> list[str]:
    """A note if the position leaves the stroke."""
    place = np.concatenate([sliding.piece["x"] for sliding in slidings])
    beyond = OUTSIDE * bench.stroke
    if place.min() >= -beyond and place.max() <= bench.stroke + beyond:
        return []
    return [
        f"x ranges from {1e3 * place.min():.1f} to {1e3 * place.max():.1f} mm, but the "
        f"stroke is {1e3 * bench.stroke:.1f} mm: the zero of x is not at the cap end, and "
        "no stiffness is computed outside the stroke"
    ]


def _blurred(points: Sequence[FrictionPoint], motion: ConditionedRecord) -> list[str]:
    """A note if the cut-off is so low that no points of steady sliding remain."""
    shortest = 2 * BLURRED / motion.cutoff + LASTING / 2
    if points or shortest <= 2 * LASTING:
        return []
    return [
        f"a cut-off of {motion.cutoff:.3g} Hz blurs plateaus shorter than {shortest:.2g} s, so "
        "there are no points of steady sliding"
    ]


def _warmth(record: Record, bench: Bench) -> list[str]:
    """A note if the oil temperature differs from the design's first load case."""
    if "T" not in record:
        return []
    mean = float(np.nanmean(record["T"]))
    if abs(mean - bench.temperature) <= WARMER:
        return []
    kelvin = 273.15
    return [
        f"the record has {mean - kelvin:.0f} degC (T), but contact forces and stiffness are "
        f"computed for {bench.temperature - kelvin:.0f} degC, as in the design's first load case"
    ]


def _pace(motion: ConditionedRecord) -> list[str]:
    """A note if the channel v is not the time derivative x' of x.

    By least squares, the factor k in v = k x' is sum v x'/sum x'^2. The noise of x' is subtracted
    from the sum in the denominator.
    """
    pairs = [
        (piece["v"][piece.sound], piece.velocity[piece.sound])
        for piece in motion.pieces
        if "v" in piece
    ]
    if not pairs:
        return []
    stated, slopes = (np.concatenate(arrays) for arrays in zip(*pairs, strict=True))
    power = float(np.mean(slopes**2)) - velocity_noise(motion) ** 2
    if power <= 0.5 * float(np.mean(slopes**2)):  # the slope of x is too small against its noise
        return []
    slope = float(np.mean(stated * slopes)) / power
    if abs(slope - 1) <= PACE:
        return []
    slope = round(slope, 2) + 0.0  # avoids -0.00
    return [
        f"v is {slope:.2f} times the time derivative of x, so v is ignored; check its unit and sign"
    ]


def _models(
    slidings: Sequence[Sliding],
    motion: ConditionedRecord,
    area: float,
    lag_known: bool,
    settling: float = SETTLED,
) -> tuple[tuple[FrictionPoint, ...], StribeckFit | str, LuGreFit | str]:
    """Points of steady sliding, with the Stribeck and LuGre models fitted to them."""
    points = steady_points(slidings, motion, settling)
    stribeck = fit_stribeck(points, area)
    lugre = fit_lugre(slidings, motion, points, stribeck, lag_known=lag_known, settling=settling)
    return points, stribeck, lugre


def _check_channels(record: Record, bench: Bench, settings: Settings) -> None:
    """Reject a record if a channel of the force balance is missing or given twice."""
    bent = ", or --span for a bending test" if "w" in record else ""
    for name, label in (("p1", "pressure of the cap end"), ("x", "position")):
        if name not in record:
            raise record.fault(
                f"no column {name}, the {label}", f'name it with --column "{name}=..."{bent}'
            )
    if "p2" not in record and not bench.plunger:
        raise record.fault(
            "no column p2, the pressure of the rod end",
            'name it with --column "p2=...", or write "count: 0" in seals.piston for a plunger',
        )
    if "F_L" in record and settings.load_force is not None:
        message = "a load is stated, but the record also contains the measured load in column F_L"
        raise record.fault(message, "leave out --load-force (load_force), or the column")
    if "F_L" not in record and settings.load_force is None:
        raise record.fault(
            "no column F_L, the force of the load",
            'name it with --column "F_L=...", or state its value: --load-force "0 N" for a '
            "free rod",
        )


def _mass(record: Record, bench: Bench, settings: Settings) -> float:
    """Moving mass on the actuator's side of the force sensor [kg].

    Reject invalid forces and masses.
    """
    if settings.mass is not None and not (np.isfinite(settings.mass) and settings.mass >= 0):
        raise record.fault(f"the moving mass is {settings.mass:g} kg", "give 0 kg or more")
    if settings.load_force is not None and not np.isfinite(settings.load_force):
        raise record.fault(f"the load is {settings.load_force:g} N", "give a number")
    if settings.mass is not None:
        return settings.mass
    return bench.mass + (0.0 if "F_L" in record else bench.load_mass)


def _conditioned(
    record: Record,
    bench: Bench,
    settings: Settings,
    mass: float,
    lag: float,
    before: ConditionedRecord | None,
) -> tuple[ConditionedRecord, list[Sliding]]:
    """Condition the record, compute its friction; `before` is the result for another lag."""
    motion = condition(
        record,
        cutoff=settings.cutoff,
        order=settings.order,
        compensated=settings.compensated,
        pressure_lag=lag,
        before=before,
    )
    return motion, slide(motion, bench, mass=mass, load_force=settings.load_force)


def _sizes(
    slidings: Sequence[Sliding], motion: ConditionedRecord, settling: float
) -> tuple[Mean, float, bool]:
    """Mean absolute friction in sliding, largest absolute friction, and whether the rod slides.

    The confidence interval of the mean follows from the means of several batches of samples. After
    a reversal or rest, the rod is in pre-sliding until it has moved `BENDS` breakaway travels.
    Pre-sliding enters the largest value, but not the mean. If the rod never leaves pre-sliding, the
    mean is that of all samples in which it moves.
    """
    distance = BENDS / SETTLING * settling
    moving = any(sliding.moving.any() for sliding in slidings)
    masks = [sliding.moving if moving else sliding.piece.sound for sliding in slidings]
    all_friction = [
        np.abs(sliding.friction[at]) for sliding, at in zip(slidings, masks, strict=True)
    ]
    sliding_friction = [
        np.abs(sliding.friction[settled(sliding, distance)]) for sliding in slidings
    ]
    slides = any(part.size for part in sliding_friction)
    friction = np.concatenate(sliding_friction if slides else all_friction)
    batches = int(np.clip(independent(friction.size, motion) / 5, 2, 20))
    means = np.array([np.mean(batch) for batch in np.array_split(friction, batches)])
    half = quantile(batches - 1) * float(np.std(means, ddof=1)) / float(np.sqrt(batches))
    middle = float(np.mean(friction))
    largest = float(np.max(np.concatenate(all_friction)))
    return Mean(middle, middle - half, middle + half), largest, slides


def _fits(points: Sequence[FrictionPoint]) -> dict[str, LawFit | str]:
    """Fits of the secant damping as a function of speed, weighted for least relative errors."""
    speeds = different([point.speed for point in points])
    if len(speeds) < LEAST_SPEEDS:
        reason = (
            f"the record has {len(speeds)} different speeds, but a law of damping versus speed "
            f"needs {LEAST_SPEEDS}"
        )
        return dict.fromkeys(LAWS, reason)
    speed = np.array([point.speed for point in points])
    damping = np.array([point.damping for point in points])
    fits: dict[str, LawFit | str] = {}
    for name, fit in LAWS.items():
        positive = damping > 0
        try:
            fits[name] = fit(speed[positive], damping[positive], 1 / damping[positive] ** 2)
        except InputError as error:
            fits[name] = error.diagnostics[0].message
    return fits
