"""Lower bound on the objective of every design: trace the models, relax them, branch and bound."""
