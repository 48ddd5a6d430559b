"""The Pareto front of several objectives: designs that no other design dominates.

`objectives` defines the problem, `tracer` computes designs at given levels, `plane` chooses the
levels, and `front` combines them.
"""
