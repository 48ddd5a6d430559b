"""Optimisation: a generic solver, and the actuator formulated as its problem."""
