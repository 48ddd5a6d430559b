"""Which names a role knows."""

from __future__ import annotations

import re
from collections.abc import Mapping

TABLES = r"requirements\.|materials\.|variables\.|waivers\."
"""Blocks of a design file with free names: a PATH in them leads to the block."""


def known_label(labels: Mapping[str, Mapping[str, str]], kind: str, name: str) -> str | None:
    """Label of the entry of a name; None if it is unknown.

    A PATH may have any index or name in its brackets.
    """
    known = labels.get(kind, {})
    if kind == "key" and name not in known:
        name = re.sub(r"\[[^\[\]]*\]", "[*]", name)
        name = name.partition(".")[0] if re.match(TABLES, name) else name
    return known.get(name)
