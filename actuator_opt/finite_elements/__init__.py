"""Finite-element solutions of seals in their grooves, as static contact pressures.

They need the optional extra ``fem`` (scikit-fem for meshes, shape functions and quadrature), which
is loaded when a mesh is first made; the core never imports this package. `o_ring.squeezed_ring` and
`step_ring.squeezed_step_ring` are what others call; both return a `result.SealSolution`.
"""
