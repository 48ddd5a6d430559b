"""What every package rests on: errors, units, quantities, numerics, files, databases."""
