"""Duty cycles of a design: its pressures, energies, fatigue and wear along recorded motions.

`numbers` collects the numbers of a design on which its cycles depend, `samples` has the model of a
sample, `results` sums up a cycle, and `metrics` derives the metrics of all cycles.
"""
