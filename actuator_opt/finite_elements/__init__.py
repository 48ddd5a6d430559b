"""Finite-element models of seals in their grooves; they give static contact pressures.

They need the optional extra ``fem`` (scikit-fem for meshes, shape functions and quadrature), which
is imported with the first mesh. The core never imports this package. The entry points are
`o_ring.squeezed_ring` and `step_ring.squeezed_step_ring`, which return a `result.SealSolution`.
"""
