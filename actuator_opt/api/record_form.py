"""Required form of the fields of a run record and of a report's attachment.

Either may be damaged, or written by someone else.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Form = Any
"""A type, a tuple of alternative forms, ``[form]`` for a list of any length, or an object: fields
by name (``name?`` is optional, others are allowed), or ``{"*": form}`` for any names. ``float``
also accepts whole numbers, None is null, ``object`` is anything."""

_OBJECTIVE = {"metric?": (str, None), "value?": (float, None)}
_HEAD: Form = {
    "kind": str,
    "name": str,
    "file": str,
    "started": str,
    "command": str,
    "version": str,
    "spec_hash": str,
    "seed": int,
    "status?": str,
    "outcome?": str,
    "met?": bool,
    "seconds?": float,
    "objective?": (_OBJECTIVE, None),
    "objectives?": [{"metric": str, "sense": str}],
    "points?": int,
    "knee?": ({"*": (float, None)}, None),
    "requested?": int,
    "feasible?": (int, None),
    "failed?": int,
}
_BODY: Form = {
    "date": (str, None),
    "input": {
        "name": str,
        "text": str,
        "set": [[str]],
        "plugins": [{"file": str, "sha256": str}],
    },
    "versions": {"*": str},
}
_STATE: Form = {"designs": [{}], "result": {}}
_AXIS: Form = {
    "path": str,
    "quantity": (str, None),
    "values": ([float], None),
    "texts": [str],
    "range": bool,
    "steps": (int, None),
}
_HEADS: Mapping[str, Form] = {
    "optimise": {"met": bool, "objective": _OBJECTIVE},
    "pareto": {"objectives": object, "points": object, "knee": object},
    "sweep": {"met": bool, "objective": {"metric": str}, "requested": object, "feasible": object},
}
_BODIES: Mapping[str, Form] = {
    "optimise": {
        "trace": [[float]],
        "result": {
            "metrics": {"*": {"value": (float, None)}},
            "algorithm": str,
            "evaluations": int,
        },
        "state": _STATE,
        "tables": [
            {"title": str, "columns": [str], "rows": [[object]], "note": str, "widths": [float]}
        ],
    },
    "pareto": {
        "result": {
            "metrics": {"*": {"value": (float, None)}},
            "points": [{"metrics": {"*": (float, None)}}],
        },
        "state": _STATE,
    },
    "sweep": {
        "plan": {"method": str, "count": int, "axes": [_AXIS]},
        "asked": {
            "store": ({"path": str, "study": str}, None),
            "csv": (str, None),
            "parquet": (str, None),
            "reduce": bool,
            "keep": int,
            "figures": [str],
            "show": [str],
        },
        "result": {
            "best": [{"variables": {"*": (float, str)}, "metrics": {"*": (float, None)}}],
        },
    },
}


_NUMBERS: Form = ({"*": (float, None)}, None)
_RUN: Form = {
    "actuator_opt": str,
    "command": str,
    "source_name": str,
    "date?": (str, None),
    "spec_hash?": str,
    "result?": (
        {
            "status?": (str, None),
            "spec_hash?": str,
            "metrics?": _NUMBERS,
            "variables?": _NUMBERS,
        },
        None,
    ),
}


def run_fault(run: object) -> str:
    """The fault of the facts attached to a report; "" if there is none."""
    return _fault(run, _RUN)


def head_fault(head: object) -> str:
    """The fault of the head of a record; "" if there is none.

    >>> head_fault({"kind": 3})
    'kind must be text'
    """
    found = _fault(head, _HEAD)
    if found or not isinstance(head, Mapping):
        return found
    return _fault(head, _HEADS.get(head["kind"], {}))


def body_fault(kind: str, body: object) -> str:
    """The fault of the body of a record of this kind; "" if there is none."""
    return _fault(body, _BODY) or _fault(body, _BODIES.get(kind, {}))


_WORDS = {str: "text", int: "a whole number", bool: "true or false", float: "a number"}


def _fault(value: object, form: Form, path: str = "") -> str:
    """Where a value deviates from a form, and what is expected; "" if it fits."""
    if isinstance(form, tuple):
        found = [_fault(value, one, path) for one in form]
        return "" if "" in found else found[0]
    if isinstance(form, list):
        if not isinstance(value, list):
            return f"{path} must be a list"
        return next(
            filter(None, (_fault(x, form[0], f"{path}[{k}]") for k, x in enumerate(value))), ""
        )
    if isinstance(form, dict):
        return _object_fault(value, form, path)
    if form is None:
        return "" if value is None else f"{path} must be null"
    wanted = (int, float) if form is float else form
    if isinstance(value, wanted) and (form in (bool, object) or not isinstance(value, bool)):
        return ""
    return f"{path} must be {_WORDS[form]}"


def _object_fault(value: object, form: dict[str, Form], path: str) -> str:
    """`_fault` for an object."""
    if not isinstance(value, dict):
        return f"{path or 'it'} must be an object"
    head = f"{path}." if path else ""
    if "*" in form:
        found = (_fault(below, form["*"], f"{head}{name}") for name, below in value.items())
        return next(filter(None, found), "")
    for key, below in form.items():
        name = key.removesuffix("?")
        if name in value:
            fault = _fault(value[name], below, f"{head}{name}")
            if fault:
                return fault
        elif name == key:
            return f"{head}{name} is missing"
    return ""
