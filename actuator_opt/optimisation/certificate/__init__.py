"""A lower bound on the objective of every design: traced, relaxed, branched and bounded."""
