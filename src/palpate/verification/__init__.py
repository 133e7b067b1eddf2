"""The solver held to closed forms, exact laws, its own convergence and another program, in one run."""
