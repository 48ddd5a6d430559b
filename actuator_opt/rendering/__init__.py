"""Renders pages of any subject on paper, on the terminal, as HTML and as CSV."""
