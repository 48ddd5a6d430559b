"""Joints of the barrel's ends: one module each, listed in `kinds.JOINTS`.

This package lies below `design`, so that the words, fields and faults of the design file can read
the same `Joint` as the evaluation, and its functions know no design: they take plain sizes, the
numbers of materials and forces, as an `End` and a `Loaded` end. So all of a joint stands in one
module, and a new one is a module with `JOINT = Joint(...)` and one line in `kinds`.
"""
