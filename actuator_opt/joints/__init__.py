"""Joints of the barrel ends: one module each, listed in `kinds.JOINTS`.

This package lies below `design`: the design file and the evaluation read the same `Joint`. Its
functions do not know the design; their arguments are sizes, material properties and forces, as an
`End` and a `Loaded` end. A joint is complete in its module: a new joint is a module with
`JOINT = Joint(...)` and a line in `kinds`.
"""
