"""Comparisons of the solver with closed forms, exact laws, its own convergence and another program."""
