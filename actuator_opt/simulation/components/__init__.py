"""Components of a circuit, which add their states, rates and signals to a system."""
