"""The way to the optimum: a generic solver, and the actuator as its problem."""
