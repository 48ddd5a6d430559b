"""Numbers, units and margins as printed, the same on paper and on the terminal."""

from __future__ import annotations

import math
import re

from ..base import quantities
from ..base.quantities import Quantity
from ..metrics import METRICS, of_metric

MINUS = "\N{MINUS SIGN}"
DASH = "\N{EN DASH}"
NARROW = "\N{NARROW NO-BREAK SPACE}"
AT_LEAST, AT_MOST = "\N{GREATER-THAN OR EQUAL TO}", "\N{LESS-THAN OR EQUAL TO}"
SENSES = {"min": AT_LEAST, "max": AT_MOST}
STATUS_WORDS = {
    "met": "met",
    "no_reserve": "no reserve",
    "missed": "missed",
    "not_checked": "not checked",
}

_UNITS = {"-": "", "degC": "°C", "degF": "°F", "deg": "°", "um": "µm"}
SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_PRETTY = tuple(
    (re.compile(pattern), written)
    for pattern, written in (
        (r"(?<![\w)\]-])-(?=\d)", MINUS),
        (r"\bdeg([CF])\b", r"°\1"),
        (r"(?<=\d) deg\b", "°"),
        (r"\bum\b", "µm"),
        (r"\^2\b", "²"),
        (r"\^3\b", "³"),
        (r"\b(k?N)\*(?=[ms])", r"\1·"),
        (r"\((m|kg)\*K\)", r"(\1·K)"),
    )
)
_POWER_E = re.compile(r"(?<=\d)e([+-]?\d+)\b")
_DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_POWER = re.compile("×10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)")
_ASCII = str.maketrans(
    {
        MINUS: "-",
        DASH: "-",
        NARROW: " ",
        "\N{NO-BREAK SPACE}": " ",
        AT_LEAST: ">=",
        AT_MOST: "<=",
        "·": "*",
        "×": "x",
        "µ": "u",
        "²": "^2",
        "³": "^3",
        "°": "deg",
        "⌀": "dia ",
        "±": "+-",
        "→": "->",
        "∞": "inf",
        "—": "-",
        "\N{RIGHT SINGLE QUOTATION MARK}": "'",
        "…": "...",
        "✔": "+",
        "✘": "x",
        "●": "*",
        "○": "o",
        "σ": "sigma",
        "δ": "delta",
        "τ": "tau",
        "₀": "_0",
        "₁": "_1",
        "₂": "_2",
    }
)


def number(value: float | None, digits: int = 4, *, signed: bool = False) -> str:
    """A number with `digits` significant digits, a true minus sign, no exponent unless needed.

    >>> number(-0.0123456, 3), number(12345.6), number(None)
    ('−0.0123', '12\u202f346', '–')
    """
    if value is None or math.isnan(value):
        return DASH
    sign = MINUS if value < 0 else "+" if signed and value > 0 else ""
    size = math.fabs(value)
    if math.isinf(size):
        return f"{sign}∞"
    if size == 0:
        return "0"
    exponent = math.floor(math.log10(float(f"{size:.{digits - 1}e}")))
    if exponent < -3 or exponent > 6:
        mantissa, _, power = f"{size:.{digits - 1}e}".partition("e")
        return f"{sign}{mantissa}×10{str(int(power)).translate(SUPERSCRIPTS)}"
    text = f"{size:.{max(digits - 1 - exponent, 0)}f}"
    whole, point, fraction = text.partition(".")
    if len(whole) > 4:
        whole = f"{int(whole):,}".replace(",", NARROW)
    return f"{sign}{whole}{point}{fraction}"


def fixed(value: float, places: int) -> str:
    """A number with a fixed number of decimals, for columns with a total.

    >>> fixed(-1234.5678, 2), fixed(43210.0, 1)
    ('−1234.57', '43\u202f210.0')
    """
    body = f"{math.fabs(value):.{places}f}"
    whole, point, fraction = body.partition(".")
    if len(whole) > 4:
        whole = f"{int(whole):,}".replace(",", NARROW)
    sign = MINUS if value < 0 and float(body) != 0 else ""
    return f"{sign}{whole}{point}{fraction}"


def decimals(value: float, digits: int) -> int:
    """Number of decimals with which a value has `digits` significant digits.

    >>> decimals(205.2, 5), decimals(0.0, 5)
    (2, 4)
    """
    size = math.fabs(value)
    exponent = math.floor(math.log10(size)) if size > 0 and math.isfinite(size) else 0
    return max(digits - 1 - exponent, 0)


def trimmed(value: float | None, digits: int = 4) -> str:
    """Like `number`, without trailing zeros, for limits and bounds as the user writes them.

    >>> trimmed(10.0), trimmed(0.25), trimmed(1200.0)
    ('10', '0.25', '1200')
    """
    text = number(value, digits)
    return text.rstrip("0").rstrip(".") if "." in text and "×" not in text else text


def unit_text(unit: str) -> str:
    """A unit as printed.

    >>> unit_text("kN*s/m"), unit_text("mm^2/s"), unit_text("um"), unit_text("-")
    ('kN·s/m', 'mm²/s', 'µm', '')
    """
    if unit in _UNITS:
        return _UNITS[unit]
    return unit.replace("*", "·").replace("^2", "²").replace("^3", "³")


def pretty(words: str) -> str:
    """Text with its numbers and units as printed: true minus, °C, µm, squares and cubes.

    >>> pretty("-20 degC, 30 um, 1570 kg/m^3, 38 N*s/m, 6.9 W/(m*K), 4e-05")
    '−20 °C, 30 µm, 1570 kg/m³, 38 N·s/m, 6.9 W/(m·K), 4×10⁻⁵'
    """
    for pattern, replacement in _PRETTY:
        words = pattern.sub(replacement, words)
    return _POWER_E.sub(lambda m: f"×10{str(int(m[1])).translate(SUPERSCRIPTS)}", words)


def with_unit(text: str, unit: str) -> str:
    """Number and unit with a space, except before a degree sign."""
    if not unit or text == DASH:
        return text
    return f"{text}{unit}" if unit == "°" else f"{text} {unit}"


def metric(name: str) -> Quantity:
    """The quantity of a metric; a user's own metric that declares none is taken as a pure ratio."""
    return of_metric(name)


def input_quantity(name: str) -> Quantity:
    """The quantity of an input; an input that declares none is taken as a pure ratio."""
    quantity = quantities.INPUTS.get(name) or METRICS.get(name)
    return quantity or Quantity(name, "", "ratio", "", name)


def display(quantity: Quantity, value: float | None) -> float | None:
    """An SI value, converted to the display unit of its quantity; None stays None."""
    return None if value is None else quantity.to_display(value)


def limit_text(quantity: Quantity, sense: str | None, limit: float | None) -> str:
    """A limit with its sense and unit, ``"≥ 10 kN/mm"``."""
    if limit is None or sense is None:
        return DASH
    text = with_unit(trimmed(quantity.to_display(limit)), unit_text(quantity.unit))
    return f"{SENSES[sense]} {text}"


def value_text(quantity: Quantity, value: float | None, digits: int = 4) -> str:
    """A value with its display unit."""
    return with_unit(number(display(quantity, value), digits), unit_text(quantity.unit))


def margin_text(margin: float | None, *, met: bool = True) -> str:
    """A relative margin in per cent; 0 means an active limit, and a missed limit never shows 0.

    >>> margin_text(0.031), margin_text(-1e-9), margin_text(-0.0002, met=False)
    ('+3.1 %', '0.0 %', '−0.02 %')
    """
    if margin is None or math.isnan(margin):
        return DASH
    percent = 100 * margin
    if math.fabs(percent) < 0.05:
        return "0.0 %" if met else f"{number(percent, 1)} %"
    if math.fabs(percent) >= 1000:
        return f"> {MINUS if percent < 0 else '+'}999 %"
    if math.fabs(percent) >= 100:
        return f"{number(round(percent, 1), 4, signed=True)} %"
    return f"{percent:+.1f} %".replace("-", MINUS)


def margin_of(
    quantity: Quantity, limit: float | None, margin: float | None, *, met: bool = True
) -> str:
    """A margin in per cent of its limit; for a limit of 0, the absolute margin with its unit.

    >>> margin_of(metric("pressure_loss"), 2.0, 0.031), margin_of(metric("bore_growth"), 0.0, -3e-5)
    ('+3.1 %', '−30.0 µm')
    """
    if limit != 0 or margin is None or math.isnan(margin):
        return margin_text(margin, met=met)
    room = quantity.to_display(margin) - quantity.to_display(0.0)
    return with_unit(number(room, 3, signed=True), unit_text(quantity.unit))


def degrees(temperature: float) -> str:
    """A temperature in whole °C.

    >>> degrees(253.15), degrees(313.15)
    ('−20 °C', '40 °C')
    """
    return f"{temperature - 273.15:.0f} °C".replace("-", MINUS)


def bars(pressure: float) -> str:
    """A pressure in bar without trailing zeros.

    >>> bars(2e5), bars(20.5e6)
    ('2 bar', '205 bar')
    """
    return f"{trimmed(pressure / 1e5)} bar"


def speed_words(speed: float) -> str:
    """A speed in mm/s.

    >>> speed_words(0.00917), speed_words(0.4)
    ('9.17 mm/s', '400 mm/s')
    """
    return f"{trimmed(1e3 * speed)} mm/s"


def share_text(share: float) -> str:
    """A share in per cent with one decimal."""
    return f"{100 * share:.1f} %".replace("-", MINUS)


def plain(text: str) -> str:
    """A text in ASCII."""
    text = _POWER.sub(lambda m: f"e{m[1].translate(_DIGITS)}", text)
    return text.translate(_ASCII).encode("ascii", "backslashreplace").decode("ascii")


def sentence(words: str) -> str:
    """Words as a sentence, with capital letter and full stop; a name (pressure_a) stays unchanged.

    >>> sentence("optimum found"), sentence("pressure_a: left out")
    ('Optimum found.', 'pressure_a: left out.')
    """
    words = words.strip()
    if not words:
        return ""
    first = words[0] if "_" in words.split()[0] else words[0].upper()
    return first + words[1:] + ("" if words[-1] in ".!?" else ".")


_PLACES = (
    (re.compile(r"\b(extend|retract)ing, "), r"\1, "),
    (re.compile(r"(\d+ %) of the stroke\b"), r"\1"),
    (re.compile(r"\bweakest position\b"), "weakest"),
)


def brief(case: str | None, place: str | None) -> str:
    """Load case and position as a short text.

    >>> brief("stance", "retracting, 25 % of the stroke"), brief(None, "weakest position")
    ('stance, retract, 25 %', 'weakest')
    """
    for pattern, replacement in _PLACES:
        place = pattern.sub(replacement, place or "")
    return ", ".join(part for part in (case, place) if part)
