"""Seal types: one module each, listed in `kinds.TYPES`.

To add a type, write a module with `TYPE = SealType(...)` and one line in `kinds`. This `SealType`
supplies everything that depends on the type: its name, sizes and help text in the design file and
JSON Schema, the checks of its sizes, groove, contact, outline, sources and finite elements.
"""
