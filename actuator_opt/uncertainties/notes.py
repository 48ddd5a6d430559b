"""What a yield means, and what it leaves out, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..evaluation import PreparedDesign
from ..evaluation.film_tables import films_asked
from .inputs import Input


def notes(subject: PreparedDesign, found: Sequence[Input]) -> tuple[str, ...]:
    """What to know of the draws of a design."""
    return tuple(_notes(subject, found))


def _notes(subject: PreparedDesign, found: Sequence[Input]) -> Iterator[str]:
    drawn = {one.path for one in found}
    strengths = sorted(path for path in drawn if "strength" in path)
    if not found:
        yield "nothing scatters: the yield is whether the design as it stands meets everything"
    yield (
        "strengths stand at their allowables (knocked down for temperature, moisture, basis and "
        "process) and are not drawn again: the yield is that of actuators whose material is no "
        "stronger than that"
        if not strengths
        else f"drawn without the knock-down of their basis, which is there for the same scatter: "
        f"{', '.join(strengths)}; all other strengths stand at their allowables"
    )
    yield (
        "squeeze, fill and extrusion gap are judged at the worst of the tolerances of ring and "
        "gland, which are therefore not drawn"
    )
    for path in sorted(drawn):
        place, _, last = path.rpartition(".")
        twice = {"section": "section_tolerance", "squeeze": "tolerance"}.get(last)
        if twice and place.startswith("seals.") and subject.numbers.get(f"{place}.{twice}", 0.0):
            yield f"{path} is drawn, and {place}.{twice} is taken at its worst too: set it to 0"
    yield "all draws are independent of each other, those of one material too"
    practice = [one.path for one in found if one.origin == "practice"]
    if practice:
        yield (
            f"scatter by practice, not by a source that was checked: {', '.join(practice)}; state "
            "your own under uncertainty"
        )
    if films_asked(subject.design):
        yield "oil films follow what scatters to the first order, within their tables"
