"""Components of a circuit. Each adds its states, rates and signals to a system of equations."""
