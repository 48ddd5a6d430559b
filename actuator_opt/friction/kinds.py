"""All friction laws of a design file."""

from __future__ import annotations

from ..base.kinds import Kinds, kinds_in
from .law import FrictionLaw

LAWS: Kinds[FrictionLaw] = kinds_in(
    "friction law",
    __package__,
    "LAW",
    "coefficient",
    "film",
)
