"""Foundations of every package: errors, units, quantities, numerics, files, databases."""
