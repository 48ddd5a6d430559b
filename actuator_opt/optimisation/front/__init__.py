"""The Pareto front of several objectives: designs that no other design dominates.

`objectives` defines the problem, `tracer` computes designs for given levels (upper limits) of the
objectives, `plane` chooses the levels, and `front` combines these steps.
"""
