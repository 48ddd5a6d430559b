"""Standard JSON text: NaN and infinity become null, with the reason beside them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from .errors import Diagnostic, InputError

LOST = "not_finite"
"""Key that lists the numbers of an object that are null because they are not finite."""


def encoded(data: Mapping[str, Any], **style: Any) -> str:
    """JSON text of an object.

    Parameters
    ----------
    data : plain data
    style : options of `json.dumps` (``indent``, ``separators``, ``sort_keys``, ``ensure_ascii``)

    Raises
    ------
    InputError : nested too deeply

    Notes
    -----
    RFC 8259, section 6: "Infinity and NaN are not permitted".

    >>> encoded({"a": 1.5, "b": [float("inf")]})
    '{"a": 1.5, "b": [null], "not_finite": {"b[0]": "unbounded"}}'
    """
    try:
        try:
            return json.dumps(data, allow_nan=False, **style)
        except ValueError:
            lost: dict[str, str] = {}
            finite = _finite(data, "", lost)
            if not lost:
                raise
            return json.dumps(finite | {LOST: lost}, allow_nan=False, **style)
    except RecursionError:
        raise InputError(Diagnostic("the data is nested too deeply", "reduce its depth")) from None


def _finite(value: Any, path: str, lost: dict[str, str]) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        lost[path] = "not computable" if math.isnan(value) else "unbounded"
        return None
    if isinstance(value, Mapping):
        start = f"{path}." if path else ""
        return {key: _finite(below, f"{start}{key}", lost) for key, below in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(below, f"{path}[{k}]", lost) for k, below in enumerate(value)]
    return value
