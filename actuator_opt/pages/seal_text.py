"""The seals of a place as text for the terminal."""

from __future__ import annotations

from ..rendering import text
from ..rendering.blocks import Column
from ..rendering.console import Console
from ..studies.seal import SealStudy
from . import seal_rows as rows
from .seal_elements_figure import sentence
from .seal_figures import bars, degrees, speed_words, squeeze_limits, stroke_names


def seal_text(
    study: SealStudy, *, colour: bool = False, unicode: bool = True, width: int = 100
) -> str:
    """What `seal` shows: operating point, contact, squeeze, friction over speed, leakage."""
    console = Console(colour, unicode, width)
    parts = [
        _head(study, console),
        _operating(study, console),
        _contact(study, console),
        _squeeze(study, console),
        _speeds(study, console),
        _notes(study, console),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _head(study: SealStudy, console: Console) -> str:
    state = (
        console.paint("film found", "green")
        if study.converged
        else console.paint("no film", "red", "bold")
    )
    name = console.paint(console.say(study.design.name), "bold")
    lines = [f"{name}  {console.say(study.place)} seals  {state}"]
    gap = f"radial gap {text.trimmed(1e3 * study.clearance)} mm"
    if study.growth > 0:
        gap += f", the bore grows {text.number(1e3 * study.growth, 2)} mm more"
    lines.append(console.wrap(f"at {rows.at(study)}; {gap}. {rows.strokes(study)}", "dim"))
    if why := rows.why(study):
        lines.append(console.wrap(why, "red"))
    return "\n".join(lines)


def _operating(study: SealStudy, console: Console) -> str:
    columns = [Column("", width=1.0)]
    columns += [Column(name, "right") for name in stroke_names(study)]
    found = rows.operating(study)
    body = [[line.name, line.drive, line.other] for line in found]
    styles = [["", "bold", "bold"] if line.strong else ["", "", ""] for line in found]
    return "\n".join(console.table(columns, body, styles))


def _contact(study: SealStudy, console: Console) -> str:
    columns = [
        Column(
            head, "right" if 2 <= k < 7 else "left", drop={7: 5, 6: 4, 5: 3, 4: 2, 1: 1}.get(k, 0)
        )
        for k, head in enumerate(rows.CONTACT_HEADS)
    ]
    lines = console.table(columns, rows.contacts(study))
    if said := sentence(study):
        lines.append(console.wrap(said, "dim"))
    return "\n".join([console.heading("contact"), *lines])


def _squeeze(study: SealStudy, console: Console) -> str:
    columns = [
        Column("ring", width=1.0),
        Column("", "right"),
        Column("pressure", "right"),
        Column("loosest", "right"),
        Column("nominal", "right"),
        Column("tightest", "right"),
    ]
    body, styles = [], []
    for row in study.squeezes:
        values = [row.loosest, row.nominal, row.tightest]
        shown = [f"{text.number(100 * value, 3)} %" for value in values]
        body.append([row.label, degrees(row.temperature), bars(row.pressure), *shown])
        styles.append(["", "dim", "dim", "red" if row.loosest <= 0 else "", "", ""])
    lines = [console.heading("squeeze over the tolerances"), *console.table(columns, body, styles)]
    limits = [f"{sense} {text.trimmed(100 * level)} %" for sense, level in squeeze_limits(study)]
    if limits:
        lines.append(console.wrap(f"required: {', '.join(limits)}", "dim"))
    return "\n".join(lines)


_SHOWN = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)


def _speeds(study: SealStudy, console: Console) -> str:
    """Friction and damping over a few of the curves' speeds."""
    found = study.curves
    if found is None:
        return ""
    heads = [f"{bars(float(p))}" for p in found.pressures]
    columns = [Column("speed", "right")]
    columns += [Column(f"F, {head}", "right") for head in heads]
    columns += [Column(f"B, {head}", "right", drop=1) for head in heads]
    body = []
    for k in sorted({int(abs(found.speeds - v).argmin()) for v in _SHOWN}):
        forces = [rows.force(float(row[k])) for row in found.friction]
        dampings = [rows.damping(float(row[k])) for row in found.damping]
        body.append([speed_words(float(found.speeds[k])), *forces, *dampings])
    driven = stroke_names(study)[0]
    lines = [console.heading(f"friction F and secant damping B over speed, {driven}")]
    lines += console.table(columns, body)
    if found.why:
        lines.append(console.wrap(rows.missing(found).strip(), "dim"))
    return "\n".join(lines)


def _notes(study: SealStudy, console: Console) -> str:
    said = [rows.leakage(study), *rows.notes(study)[1:3]]
    return "\n".join(
        console.wrap(words, "" if k == 0 else "dim") for k, words in enumerate(said) if words
    )
