"""Expressions traced from models: derivatives, and generated code.

A `Symbol` behaves like an array-API value, so a model that is called with symbols returns its
formula as an expression. The expression is then turned into plain Python (`code`), differentiated
exactly (`derivative`), or passed to another engine.
"""

from .code import function, vectorised
from .derivative import jacobian
from .equations import Equations
from .expression import Expression, Graph, Namespace, Symbol

__all__ = [
    "Equations", "Expression", "Graph", "Namespace", "Symbol", "function", "jacobian", "vectorised",
]  # fmt: skip
