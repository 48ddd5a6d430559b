"""Impossible sizes give NaN: one rule for every model, based on its argument names."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any, ParamSpec, TypeVar

import numpy as np

from .numeric import real, where

P = ParamSpec("P")
T = TypeVar("T")

_SIZE = re.compile(
    r"(?:.*_)?(?:bore|radius|diameter|thickness(?:es)?|length|width|section|stroke|span|pitch|gap"
    r"|depth|height|land|engagement|clearance|tolerance|roughness|travel|area|volume"
    r"|second_moments?|wetted_(?:back|front))(?:_[ab12])?"
)
"""Names of lengths, areas, volumes and second moments, which are never negative."""
_RATE = re.compile(r".*_per_.*")
PAIRS = (
    ("outer_radius", "inner_radius"),
    ("outer_diameter", "inner_diameter"),
    ("outer_diameter", "bore"),
    ("bore", "rod_diameter"),
    ("radius", "hole_radius"),
    ("edge_radius", "hub_radius"),
)
"""Pairs of a larger and a smaller size: walls have a thickness, rods leave an annulus."""


def sizes(function: Callable[..., object]) -> tuple[str, ...]:
    """Arguments of a function that are sizes, by name."""
    code = function.__code__
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    return tuple(name for name in names if _SIZE.fullmatch(name) and not _RATE.fullmatch(name))


def geometry(function: Callable[P, T]) -> Callable[P, T]:
    """Make a model return NaN where a size is negative or an inner size is not the smaller.

    Other elements of an array keep their values. The thicknesses of `layers` are checked too.
    Symbols and arrays of other libraries than NumPy are not checked: they are traced once for many
    values, which the checks and limits of the design keep possible.
    """
    names = sizes(function)
    pairs = [pair for pair in PAIRS if pair[0] in names and pair[1] in names]

    @functools.wraps(function)
    def checked(*args: P.args, **arguments: P.kwargs) -> T:
        given: dict[str, Any] = arguments
        wrong: Any = False
        for name in names:
            if name in given and not _possible(given[name]):
                given[name], found = _checked(given[name])
                wrong = wrong | found
        for greater, lesser in pairs:
            if greater in given and lesser in given:
                given[greater], found = _kept(
                    real(given[greater]) <= real(given[lesser]), given[greater]
                )
                wrong = wrong | found
        if "layers" in given and not all(_possible(one.thickness) for one in given["layers"]):
            kept = [_checked(layer.thickness) for layer in given["layers"]]
            given["layers"] = [
                layer if value is layer.thickness else replace(layer, thickness=value)
                for layer, (value, _) in zip(given["layers"], kept, strict=True)
            ]
            wrong = functools.reduce(lambda one, layer: one | layer[1], kept, wrong)
        result = function(*args, **arguments)
        return result if wrong is False else _spoiled(result, wrong)

    return checked


def _possible(value: Any) -> bool:
    """Whether no value of a size is negative; the common case, kept fast."""
    if isinstance(value, float):
        return not value < 0
    if type(value) is np.ndarray and value.dtype.kind in "fc":
        return not np.fmin.reduce(value.real, axis=None, initial=0.0) < 0
    return value is None


def _checked(value: Any) -> tuple[Any, Any]:
    """A size, or several, with NaN for negative values; and a mask of these values."""
    if not isinstance(value, tuple | list):
        return _kept(real(value) < 0, value)
    kept = [_checked(one) for one in value]
    wrong = functools.reduce(lambda one, other: one | other[1], kept, False)
    return type(value)(one for one, _ in kept), wrong


def _kept(impossible: Any, value: Any) -> tuple[Any, Any]:
    """A value with NaN where it is impossible, and a mask of these; symbols are unchanged."""
    if impossible is False:
        return value, False
    if impossible is True:
        return where(impossible, np.nan, value), impossible
    if isinstance(impossible, np.bool_ | np.ndarray) and impossible.dtype.kind == "b":
        if not impossible.any():
            return value, False
        return where(impossible, np.nan, value), impossible
    return value, False


def _spoiled(result: Any, wrong: Any) -> Any:
    """A result with NaN for each number whose geometry is impossible."""
    if isinstance(result, tuple | list):
        parts = [_spoiled(part, wrong) for part in result]
        return type(result)(*parts) if hasattr(result, "_fields") else type(result)(parts)
    if isinstance(result, dict):
        return {name: _spoiled(part, wrong) for name, part in result.items()}
    if is_dataclass(result) and not isinstance(result, type):
        known = [one.name for one in fields(result) if one.init]
        return replace(result, **{name: _spoiled(getattr(result, name), wrong) for name in known})
    if isinstance(result, float | complex | np.floating | np.complexfloating):
        return where(wrong, np.nan, result)
    if isinstance(result, np.ndarray) and result.dtype.kind in "fc":
        return np.where(wrong, np.nan, result)
    return result
