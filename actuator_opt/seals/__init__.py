"""Seal types: one module each, listed in `kinds.TYPES`.

To add a type, write a module with `TYPE = SealType(...)` and one line in `kinds`. Its `SealType`
defines the choices and help of the design file, JSON Schema, faults, groove, contact, outline,
provenance and finite elements.
"""
