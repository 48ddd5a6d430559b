"""Figures of a sweep: a module for each, which states it as `FIGURE`."""
