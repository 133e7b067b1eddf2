"""Code of particular studies, which the workflow knows and an installed package does without."""
