"""Friction laws of a seal: one module each, listed in `kinds.LAWS`.

To add a law, write a module with `LAW = FrictionLaw(...)` and one line in `kinds`. Its
`FrictionLaw` defines the choices and help of the design file, JSON Schema, faults, compound
properties and friction, and whether oil films are solved.
"""
