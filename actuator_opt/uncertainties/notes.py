"""Notes on what a yield covers and what it leaves out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..evaluation import PreparedDesign
from ..evaluation.film_tables import films_asked
from .inputs import Input


def notes(subject: PreparedDesign, found: Sequence[Input]) -> tuple[str, ...]:
    """Return the notes on the draws of a design."""
    return tuple(_notes(subject, found))


def _notes(subject: PreparedDesign, found: Sequence[Input]) -> Iterator[str]:
    drawn = {one.path for one in found}
    strengths = sorted(path for path in drawn if "strength" in path)
    if not found:
        yield (
            "no input is uncertain: the yield is 100 % if the nominal design meets all "
            "requirements, else 0"
        )
    yield (
        "strengths are not drawn: they stay at their allowables, with all knock-downs, so the "
        "yield is conservative for material strength"
        if not strengths
        else (
            "drawn without their basis knock-down, which covers the same scatter: "
            f"{', '.join(strengths)}; all other strengths stay at their allowables"
        )
    )
    yield (
        "squeeze, gland fill and extrusion gap are checked at the worst tolerances of ring and "
        "gland, so these tolerances are not drawn"
    )
    for path in sorted(drawn):
        place, _, last = path.rpartition(".")
        twice = {"section": "section_tolerance", "squeeze": "tolerance"}.get(last)
        if twice and place.startswith("seals.") and subject.numbers.get(f"{place}.{twice}", 0.0):
            yield f"{path} is drawn, and {place}.{twice} is applied at its worst too: set it to 0"
    yield "all inputs are drawn independently, even properties of the same material"
    practice = [one.path for one in found if one.origin == "practice"]
    if practice:
        yield (
            f"scatter from common practice, not from a verified source: {', '.join(practice)}; "
            "state your own under uncertainty"
        )
    if films_asked(subject.design):
        yield (
            "oil films follow the uncertain inputs to first order, within the range of their tables"
        )
