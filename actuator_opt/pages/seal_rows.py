"""What a seal sheet says of a SealStudy in numbers and sentences, for paper and terminal alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..design.seals import SealElement
from ..metrics import METRICS
from ..rendering.text import DASH, number, trimmed, value_text
from ..studies.seal import HARDNESS_SCATTER, STATED_FACTOR, FilmMap, RingPoint, SealPoint, SealStudy
from .seal_figures import bars, degrees, speed_words, stroke_names
from .seal_gland_figure import slots, tolerance_text

_METRICS = METRICS


@dataclass(frozen=True, slots=True)
class Line:
    """A quantity with its value on the driven stroke and on the other."""

    name: str
    drive: str
    other: str
    strong: bool = False


def force(value: float) -> str:
    """A force in N.

    >>> force(119.93), force(float("nan"))
    ('119.9 N', '–')
    """
    return value_text(_METRICS["friction_running"], None if math.isnan(value) else value)


def damping(value: float) -> str:
    """A secant damping in kN s/m."""
    return value_text(_METRICS["damping_seal"], None if math.isnan(value) else value)


def volume(value: float) -> str:
    """A volume in mm³; none without a film."""
    return DASH if math.isnan(value) else f"{number(1e9 * value)} mm³"


def flow(value: float) -> str:
    """A flow in mm³/s; none without a film."""
    return DASH if math.isnan(value) else f"{number(1e9 * value)} mm³/s"


def _residual(values: Sequence[float]) -> str:
    known = [abs(v) for v in values if not math.isnan(v)]
    return number(max(known), 1) if known else DASH


def at(study: SealStudy) -> str:
    """Pressure, speed and temperature of the operating point."""
    point = study.drive
    return f"{bars(point.pressure)}, {speed_words(point.speed)}, {degrees(point.temperature)}"


def band(point: SealPoint) -> str:
    """Least and most friction over the scatter of the moduli; none without a film."""
    known = sorted(v for v in (point.lower, point.upper) if not math.isnan(v))
    return f"{number(known[0])} to {force(known[-1])}" if known else DASH


def operating(study: SealStudy) -> list[Line]:
    """The operating point on both strokes."""

    def line(name: str, words: Callable[[SealPoint], str], *, strong: bool = False) -> Line:
        return Line(name, words(study.drive), words(study.other), strong)

    found = [
        line("friction, film", lambda p: force(p.friction), strong=True),
        line("of the oil's shear", lambda p: force(p.viscous)),
        line("of the asperities", lambda p: force(p.asperity)),
        line("friction over the moduli's scatter", band),
        line("friction by the coefficient instead", lambda p: force(p.coefficient_friction)),
        line("breakaway, dry", lambda p: force(p.breakaway)),
        line("secant damping at this speed", lambda p: damping(p.damping), strong=True),
        line("flow towards the outer side", lambda p: flow(p.flow)),
    ]
    if len(study.drive.rings) > 1:
        found.append(line("pressure between the rings, gauge", _between))
    if oil := study.double_stroke:
        carried = volume(oil.carried_out), volume(-oil.drawn_back)
        found.append(Line("oil a stroke carries out", *carried))
    return [
        *found,
        line("load residual", lambda p: _residual([r.load_residual for r in p.rings])),
        line("mass residual", lambda p: _residual([r.mass_residual for r in p.rings])),
    ]


def _between(point: SealPoint) -> str:
    known = None if math.isnan(point.between) else point.between
    return value_text(_METRICS["inter_seal_pressure"], known)


# ---- gland and contact ----

GLAND_HEADS = (
    "place", "type", "material", "section", "squeeze", "gland depth", "groove width", "ring",
)  # fmt: skip


def gland(study: SealStudy) -> list[list[str]]:
    """Sizes of every groove and ring with their tolerances, mm."""
    rows = []
    for slot in slots(study.design, study.place):
        element = slot.element
        if element is None:
            rows.append(
                [
                    slot.groove.place,
                    slot.groove.role,
                    slot.groove.material,
                    DASH,
                    DASH,
                    trimmed(1e3 * slot.depth),
                    trimmed(1e3 * slot.width),
                    trimmed(1e3 * float(slot.groove.ring_width)),
                ]
            )
            continue
        rows.append(
            [
                slot.groove.place,
                element.type.replace("_", " "),
                element.compound,
                tolerance_text(element.section, element.section_tolerance),
                f"{trimmed(100 * element.squeeze)} %",
                tolerance_text(slot.depth, element.tolerance),
                trimmed(1e3 * slot.width),
                _ring_size(element),
            ]
        )
    return rows


def _ring_size(element: SealElement) -> str:
    """Axial and radial size of what is not round; back-up rings."""
    sizes = element.stated_sizes()
    words = trimmed(1e3 * sizes["width"]) if "width" in sizes else "round"
    if "thickness" in sizes:
        words += f" × {trimmed(1e3 * sizes['thickness'])}"
    if element.back_ups and element.back_up_thickness is not None:
        words += f" + {element.back_ups} × {trimmed(1e3 * element.back_up_thickness)} back-up"
    return words


def law_of(one: RingPoint) -> str:
    """Which model the contact of a ring is from."""
    element = one.ring.element
    if element.contact:
        return "stated profiles"
    return element.seal_type.contact_model.format(law=element.law.replace("_", " "))


def modulus_text(one: RingPoint) -> str:
    """Lowest, assumed and highest modulus in MPa."""
    low, value, high = (number(1e-6 * x, 3) for x in one.modulus)
    return f"{low} {DASH} {value} {DASH} {high}"


CONTACT_HEADS = (
    "ring", "stroke", "pressure across", "line load", "width", "peak", "modulus, MPa",
    "contact model",
)  # fmt: skip


def contacts(study: SealStudy) -> list[list[str]]:
    """Contact of every ring; both strokes where its pressure differs between them."""
    rows = []
    names = ("out", "in") if study.place == "rod" else stroke_names(study)
    for index, points in enumerate(zip(study.drive.rings, study.other.rings, strict=True)):
        one, other = points
        apart = one.ring["pressure"] != other.ring["pressure"]
        for words, point in zip(names, points, strict=True) if apart else (("both", one),):
            rows.append(
                [
                    point.ring.label,
                    words,
                    bars(float(f"{point.ring['pressure']:.4g}")),
                    f"{number(1e-3 * float(point.contact.line_load))} N/mm",
                    f"{number(1e3 * float(point.contact.width))} mm",
                    f"{number(1e-6 * float(point.contact.peak))} MPa",
                    modulus_text(point),
                    law_of(point) if index or not study.elements else "finite elements",
                ]
            )
    return rows


# ---- sentences ----


def why(study: SealStudy) -> str:
    """Why the operating point has no film; empty where it has one on both strokes."""
    parts = [
        f"No film {name}: {_sentence(point.why)}"
        for name, point in zip(_strokes(study), (study.drive, study.other), strict=True)
        if point.why
    ]
    return " ".join(parts)


def _strokes(study: SealStudy) -> tuple[str, ...]:
    names = stroke_names(study)
    return tuple(f"on the {name}" for name in names) if study.place == "rod" else names


def strokes(study: SealStudy) -> str:
    """What the two strokes of the place are, and against what pressure its seal holds."""
    over = f"{bars(study.drive.pressure)} over"
    if study.place == "rod":
        return f"The seal holds {over} the atmosphere."
    return (
        "Driven, the piston runs away from the pressure it seals; overrun, a load pushes it"
        f" against that pressure. The seal holds {over} the {bars(study.outer_pressure)} of the"
        " other chamber."
    )


def _sentence(words: str) -> str:
    return words.rstrip(".") + "."


def leakage(study: SealStudy) -> str:
    """Leakage in a sentence: of a rod's double stroke, or across a piston; empty without a film."""
    if not study.converged:
        return ""
    point, oil = study.drive, study.double_stroke
    held, run = bars(point.pressure), speed_words(point.speed)
    if oil is None:
        return (
            f"Flow across the piston while driven, at {held} and {run}:"
            f" {_across(point.flow, 'the chamber of higher pressure')};"
            f" overrun: {_across(study.other.flow, 'it')}."
        )
    back = oil.drawn_back
    told = f"draws {volume(back)} back" if back >= 0 else f"leaks {volume(-back)} more"
    return (
        f"Over {trimmed(1e3 * study.stroke)} mm the stroke out carries {volume(oil.carried_out)}"
        f" past the seal and the stroke in {told}, both at {held} and {run}: a double stroke"
        f" leaves {volume(oil.net)} outside."
    )


def _across(value: float, room: str) -> str:
    return f"{flow(abs(value))} {'out of' if value >= 0 else 'back into'} {room}"


def missing(found: FilmMap) -> str:
    """How many points of a map have no film, and why; empty where all have one."""
    if not found.why:
        return ""
    reasons: dict[str, int] = {}
    for _, _, reason in found.why:
        plain = reason.partition(":")[0].rstrip(".")
        plain = " ".join("…" if _is_number(word) else word for word in plain.split())
        reasons[plain] = reasons.get(plain, 0) + 1
    told = "; ".join(f"{count} × {reason}" for reason, count in reasons.items())
    points = f"{len(found.why)} of {found.friction.size} points"
    return f" Without a film, and not drawn: {points} ({told})."


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def notes(study: SealStudy) -> list[str]:
    """What is model, what is input, and how far either is to be trusted."""
    spread = f"hardness ±{trimmed(HARDNESS_SCATTER)} Shore A"
    if any("hardness" not in one.ring.numbers for one in study.drive.rings):
        spread += f", a stated modulus × or ÷ {trimmed(STATED_FACTOR)}"
    face = sorted({one.ring["asperity_friction"] for one in study.drive.rings})
    told = " and ".join(trimmed(x) for x in face)
    said = study.lugre
    bristles = (
        []
        if said is None
        else [
            "LuGre for a simulation of this seal: bristle stiffness"
            f" {number(said.stiffness / 1e6, 3)} N/µm (breakaway over"
            f" {trimmed(1e3 * study.design.stiffness.seal_deflection)} mm), damping"
            f" {number(said.damping / 1e3, 3)} kN·s/m (square root of stiffness times load mass)."
            f" It cannot create energy up to {number(1e3 * said.passive_speed, 3)} mm/s; beyond,"
            " taper the damping."
        ]
    )
    return [
        "Model: static contact, oil film with cavitation between two rough planes, asperity"
        " contact, leakage. Input: sizes, modulus or hardness, oil, and the surfaces' numbers.",
        f"Asperity density, radius and friction ({told}) are literature orders of magnitude for"
        " the compound, not measurements of this seal. The asperity part of the friction is"
        " proportional to the asperity friction: where it is nearly all, so is the friction.",
        "The averaged film passes some oil at any gap, at rest too, where a real elastomer seal"
        " holds: its flow factors do not know the contact pressure at which the last path"
        " closes. Near standstill its leakage is told too high.",
        f"Band: {spread}, all rings together, the oil and the surfaces as stated.",
        "Breakaway is all oil squeezed out: asperity friction times the whole line load.",
        "Secant damping is friction over speed: it holds at the stated speed and amplitude"
        " alone, falls as 1/v where friction hardly depends on speed, and is not the damping"
        " of the oil.",
        *bristles,
    ]
