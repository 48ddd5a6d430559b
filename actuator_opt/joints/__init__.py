"""Joints of the barrel ends: one module each, listed in `kinds.JOINTS`.

Both the reader of design files and the evaluation use a `Joint`, so this package imports neither.
The functions of a joint do not receive the design. Their argument is an end of the barrel, without
load (`End`) or under load (`Loaded`), with all sizes, material properties and forces that they
need. Everything about a joint is in its module: to add a joint, write a module with `JOINT =
Joint(...)` and a line in `kinds`.
"""
