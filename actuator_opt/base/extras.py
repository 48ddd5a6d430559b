"""Optional libraries, imported only by the formats that need them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .errors import ActuatorError, Diagnostic

EXTRAS = {"ezdxf": ("DXF", "cad"), "openpyxl": ("XLSX", "excel"), "pyarrow": ("Parquet", "parquet")}
"""Format and package extra of every optional library."""


def library(name: str) -> Any:
    """Import a module of an optional library; a one-line error where it is not installed.

    Raises
    ------
    ActuatorError : not installed
    """
    try:
        return import_module(name)
    except ImportError as missing:
        root = name.partition(".")[0]
        kind, extra = EXTRAS[root]
        fault = Diagnostic(f"{kind} files need {root}", f"pip install 'actuator-opt[{extra}]'")
        raise ActuatorError(fault) from missing
