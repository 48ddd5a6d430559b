"""Expressions traced from models: derivatives, and generated code.

A `Symbol` is an array-API value, so a model called with symbols returns the expression of its
formula. The expression becomes plain Python (`code`), its exact derivatives (`derivative`), or
the input of another engine.
"""

from .expression import Expression, Graph, Namespace, Symbol, function, jacobian, vectorised

__all__ = ["Expression", "Graph", "Namespace", "Symbol", "function", "jacobian", "vectorised"]
