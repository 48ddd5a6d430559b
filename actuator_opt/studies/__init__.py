"""Detailed studies of one design: a seal, the plant of a simulation, the test bench."""
