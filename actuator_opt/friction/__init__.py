"""Friction laws of a seal: one module each, listed in `kinds.LAWS`.

To add a law, write a module with `LAW = FrictionLaw(...)`, and list it by one line in `kinds`. All
else follows from this `FrictionLaw`: the choice and its help in design files, the JSON Schema, the
error messages, the properties that a compound must state, the friction, and whether oil films are
solved.
"""
