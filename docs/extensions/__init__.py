"""Parts of the documentation build: generated reference, run blocks, roles, formulas, checks."""
