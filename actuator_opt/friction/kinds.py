"""Every friction law of a seal, by the word of a design file."""

from __future__ import annotations

from ..kinds import kinds
from . import coefficient, film

LAWS = kinds("friction law", coefficient.LAW, film.LAW)
