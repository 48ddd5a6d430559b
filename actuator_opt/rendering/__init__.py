"""Pages on paper, on the terminal, as HTML and as CSV; no subject is known here."""
