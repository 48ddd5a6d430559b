"""Figures of a sweep: one module for each, which defines the figure as `FIGURE`."""
