"""Re-solves many problems near a solved problem: shared steps, fallbacks, parallel searches."""
