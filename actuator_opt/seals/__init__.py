"""Seal types: one module each, listed in `kinds.TYPES`.

A new type is a module with `TYPE = SealType(...)` and one line in `kinds`. Choices and
help of the design file, JSON Schema, faults, groove, contact, outline, provenance and finite
elements read its `SealType`.
"""
