"""Friction laws of a seal: one module each, listed in `kinds.LAWS`.

A new law is a module with `LAW = FrictionLaw(...)` and one line in `kinds`. Choices and
help of the design file, JSON Schema, faults, compound properties, friction, and the choice to
solve oil films read its `FrictionLaw`.
"""
