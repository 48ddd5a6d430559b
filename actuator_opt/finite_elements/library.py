"""The finite-element library, imported on first use: the core works without it."""

from __future__ import annotations

from typing import Any

from ..base.errors import ActuatorError, Diagnostic


def finite_element_library() -> Any:
    """The module ``skfem``; a one-line error if the extra is not installed.

    Raises
    ------
    ActuatorError
        When scikit-fem is missing.
    """
    try:
        import skfem
    except ImportError as missing:
        raise ActuatorError(
            Diagnostic("finite elements need scikit-fem", "pip install 'actuator-opt[fem]'")
        ) from missing
    return skfem
