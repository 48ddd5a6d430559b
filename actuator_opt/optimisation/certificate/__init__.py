"""Lower bound on the objective of every design: trace, relax, branch and bound."""
