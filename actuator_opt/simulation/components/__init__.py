"""The parts of a circuit: each adds its states, rates and signals to a system."""
