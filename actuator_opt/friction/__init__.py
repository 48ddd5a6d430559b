"""Friction laws of a seal: one module each, listed in `kinds.LAWS`.

A new law is a module with `LAW = FrictionLaw(...)` and one line in `kinds`. Everything that depends
on the law reads its `FrictionLaw`: words and help of the design file, JSON Schema, faults, the
numbers of the compound, friction, and whether oil films are solved.
"""
