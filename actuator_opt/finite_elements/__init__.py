"""Finite-element solutions of seals in their grooves, as static contact pressures.

They need the optional extra ``fem`` (scikit-fem for meshes, shape functions and quadrature), which
is loaded with the first mesh; the core never imports this package. The entry points are
`o_ring.squeezed_ring` and `step_ring.squeezed_step_ring`, which return a `result.SealSolution`.
"""
