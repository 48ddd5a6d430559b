"""Base class of all sections of a design file."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """A block of the design file; unknown keys are faults."""

    model_config = ConfigDict(extra="forbid", frozen=True)
