"""What a reader wants to know of the wall beyond its metrics: stresses, ladder, metal rivals."""

from .record import WallStudy
from .through_wall import study

__all__ = ["WallStudy", "study"]
