"""Expressions traced from models: derivatives and straight-line code of them.

A `Symbol` is an array-API value like any other, so a model called with symbols returns the
expression of its formula. The expression becomes plain Python (`code`), its exact derivatives
(`derivative`), or the input of another engine.
"""

from .code import function, vectorised
from .derivative import jacobian
from .expression import Expression, Graph, Namespace, Symbol

__all__ = ["Expression", "Graph", "Namespace", "Symbol", "function", "jacobian", "vectorised"]
