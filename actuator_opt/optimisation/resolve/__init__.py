"""Re-solve many problems near a solved one: shared steps, one ladder, parallel searches."""
