"""Detailed studies of one design: its seals, its equations of motion, its test bench."""
