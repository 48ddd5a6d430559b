"""Optional libraries, loaded when a format needs them: the core works without."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .errors import ActuatorError, Diagnostic

EXTRAS = {"ezdxf": ("DXF", "cad"), "openpyxl": ("XLSX", "excel"), "pyarrow": ("Parquet", "parquet")}
"""Format and extra of every library."""


def library(name: str) -> Any:
    """A module of an optional library; one clear line where its extra is not installed.

    Raises
    ------
    ActuatorError : it is missing
    """
    try:
        return import_module(name)
    except ImportError as missing:
        root = name.partition(".")[0]
        kind, extra = EXTRAS[root]
        fault = Diagnostic(f"{kind} files need {root}", f"pip install 'actuator-opt[{extra}]'")
        raise ActuatorError(fault) from missing
