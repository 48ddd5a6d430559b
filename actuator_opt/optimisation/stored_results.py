"""Stores an optimisation or a Pareto front as plain data of a run record, and restores it.

A design is stored as a tree of SI numbers, from which exactly the same design can be rebuilt. An
evaluation is stored as its design and its yield estimate (share of parts that meet all limits); the
design is evaluated again on reading. All other data are dataclasses, which are restored by their
type annotations.
"""

from __future__ import annotations

import math
import types
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from ..base.errors import InputError
from ..base.quantities import Sense
from ..design import Design
from ..design.build import build as build_design, to_tree
from ..design.data_file import DataFile
from ..design.kinds import Fraction
from ..evaluation import Evaluation, evaluate, prepare
from ..evaluation.plugin import Plugin, with_own
from ..evaluation.result import YieldEstimate
from .pareto import ParetoFront
from .result import Optimisation
from .run import _DESIGN, _EVALUATION, _FILE, _FRACTION, _NUMBER

Found = TypeVar("Found", Optimisation, ParetoFront)


_PLAIN: dict[Any, Any] = {float: (int, float), int: int, str: str, bool: bool}
"""Plain Python types, with the JSON types that are accepted for each."""


def to_plain(result: Optimisation | ParetoFront) -> dict[str, Any]:
    """A result as JSON data: `designs`, and `result`, which refers to the designs.

    If the designs have data files, `files` are the texts to which the designs refer.
    """
    designs: list[dict[str, Any]] = []
    files: list[str] = []

    def file(text: str) -> int:
        if text not in files:
            files.append(text)
        return files.index(text)

    def place(design: Design) -> int:
        tree = plain(to_tree(design, stated=True))
        if tree not in designs:
            designs.append(tree)
        return designs.index(tree)

    def plain(value: Any) -> Any:
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, DataFile) and not value.inside:
            return {_FILE: [str(value), file(value.text)]}
        if value is None or isinstance(value, (str, bool, int)):
            return value
        if isinstance(value, float):
            return value if math.isfinite(value) else {_NUMBER: repr(value)}
        if isinstance(value, Fraction):
            return {_FRACTION: value.value}
        if isinstance(value, Design):
            return {_DESIGN: place(value)}
        if isinstance(value, Evaluation):
            return {_EVALUATION: [place(value.design), plain(value.yield_estimate)]}
        if isinstance(value, Mapping):
            return {key: plain(item) for key, item in value.items()}
        if is_dataclass(value):
            return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
        assert isinstance(value, Iterable), (
            f"values of the type {type(value).__name__} cannot be stored"
        )
        return [plain(item) for item in value]

    data = {"result": plain(result), "designs": designs}
    return data | ({"files": files} if files else {})


def from_plain(
    kind: type[Found], data: Mapping[str, Any], plugins: tuple[Plugin, ...] = ()
) -> Found:
    """Restore the result from the data of `to_plain`.

    Parameters
    ----------
    kind : type of the result
    data : JSON data
    plugins : the user's own metrics, if the design needs them

    Raises
    ------
    InputError
        invalid data, or data of a version with other names
    """
    metrics = with_own(plugins)
    evaluated: dict[int, Evaluation] = {}
    aims: dict[str, Sense] = {}

    def design(index: int) -> Design:
        built = build_design(special(data["designs"][index]), metrics=metrics, contradictions=False)
        if built.design is None:
            raise InputError(f"invalid design in the record: {built.faults[0].message}")
        return built.design

    def evaluation(entry: Any) -> Evaluation:
        # records before version 0.7 contain no yield
        index, estimate = entry if isinstance(entry, list) else (entry, None)
        if index not in evaluated:
            subject = prepare(design(index), None, plugins)
            evaluated[index] = evaluate(replace(subject, lenient=True, aims=aims))
        if estimate is None:
            return evaluated[index]
        return replace(evaluated[index], yield_estimate=_typed(YieldEstimate, special(estimate)))

    def special(value: Any) -> Any:
        if isinstance(value, list):
            return [special(item) for item in value]
        if not isinstance(value, dict):
            return value
        if len(value) == 1:
            ((key, item),) = value.items()
            if key in readers:
                return readers[key](item)
        return {key: special(item) for key, item in value.items()}

    readers: dict[str, Callable[[Any], Any]] = {
        _DESIGN: design,
        _EVALUATION: evaluation,
        _FILE: lambda entry: DataFile(str(entry[0]), str(data["files"][entry[1]])),
        _FRACTION: Fraction,
        _NUMBER: float,
    }
    try:
        aims |= {
            objective["metric"]: objective["sense"]
            for objective in data["result"].get("objectives", ())
        }
        result = _typed(kind, special(data["result"]))
        if not isinstance(result, kind):
            raise TypeError(f"no {kind.__name__}")
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise InputError(f"does not fit this version ({type(error).__name__}: {error})") from None
    return result


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _typed(kind: Any, value: Any) -> Any:
    """Convert a JSON value to its annotated type, dataclasses and tuples included.

    Raises
    ------
    TypeError, ValueError : the value does not fit
    """
    if value is None:
        if type(None) not in get_args(kind) and kind not in (Any, None, object):
            raise TypeError(f"null is no {kind}")
        return None
    if kind in _PLAIN:
        if not isinstance(value, _PLAIN[kind]) or (isinstance(value, bool) and kind is not bool):
            raise TypeError(f"a value of type {type(value).__name__} instead of {kind.__name__}")
        return value
    if isinstance(kind, type) and is_dataclass(kind):
        if isinstance(value, kind):
            return value
        return kind(**{name: _typed(_hints(kind)[name], item) for name, item in value.items()})
    origin, inner = get_origin(kind), get_args(kind)
    if origin is tuple:
        inner = (inner[0],) * len(value) if inner[-1] is ... else inner
        return tuple(_typed(option, item) for option, item in zip(inner, value, strict=True))
    if origin in (Union, types.UnionType):
        options = [option for option in inner if option is not type(None)]
        return _typed(options[0], value) if len(options) == 1 else value
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {key: _typed(inner[1], item) for key, item in value.items()}
    if origin is Literal and value not in inner:
        raise ValueError(f"{value!r} is none of {', '.join(map(str, inner))}")
    return value
