"""The first line of a saved optimum: the hash of the optimised design.

The hash covers the design, its material values and the version. After any change it no longer
matches, and the file is an ordinary design.
"""

from __future__ import annotations

import re

_STAMP = "# Written by actuator-opt optimise: an optimum as long as its spec hash is "
_LINE = re.compile(re.escape(_STAMP) + r"([0-9a-f]{16})\n")


def stamped(text: str, spec_hash: str) -> str:
    """A design file with the stamp, replacing an older one."""
    return f"{_STAMP}{spec_hash}\n{_LINE.sub('', text, count=1)}"


def is_optimum(text: str, spec_hash: str) -> bool:
    """Whether a design file is still the optimum that was saved."""
    found = _LINE.match(text)
    return found is not None and found[1] == spec_hash
