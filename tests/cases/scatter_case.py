"""A knee whose only scatter is what a test states, and whose only wish is what a test asks."""

from __future__ import annotations

import re
from pathlib import Path

import actuator_opt as ao
from actuator_opt.uncertainties.inputs import inputs

KNEE = (Path(__file__).parents[2] / "designs" / "knee_bonded.yaml").read_text(encoding="utf-8")
PLAIN = re.sub(r"requirements:\n(?:  .*\n|\n)+?(?=waivers)", "", KNEE, flags=re.MULTILINE)
"""The knee without requirements: only the forces of its load cases, met with a third to spare."""


def block(stated, *, still=(), text=PLAIN):
    """A text with a block ``uncertainty``; the PATHs of `still` do not scatter."""
    lines = ["", "uncertainty:"]
    for path in still:
        if path not in stated:
            lines += [f"  {path}:", "    distribution: fixed"]
    for path, entry in stated.items():
        lines += [f"  {path}:", *(f"    {key}: {value}" for key, value in entry.items())]
    return text + "\n".join(lines) + "\n"


def only(stated, text=PLAIN):
    """The same where nothing scatters but what is stated."""
    known = [one.path for one in inputs(ao.read(text).subject())]
    return block(stated, still=known, text=text)
