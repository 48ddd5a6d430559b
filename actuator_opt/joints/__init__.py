"""Joints of the barrel ends: one module each, listed in `kinds.JOINTS`.

Both the reader of design files and the evaluation use a `Joint`, so this package imports neither.
The functions of a joint do not receive the design. Their arguments are an `End` or a `Loaded` end
of the barrel, which contain sizes, material properties and forces. Everything about a joint is in
its module: to add a joint, write a module with `JOINT = Joint(...)` and a line in `kinds`.
"""
