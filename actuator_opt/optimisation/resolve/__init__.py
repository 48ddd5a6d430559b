"""Re-solve many problems near a solved one: shared steps, fallbacks, parallel searches."""
