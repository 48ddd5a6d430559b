"""Rendering of pages on paper, on the terminal, as HTML and as CSV, whatever their subject."""
