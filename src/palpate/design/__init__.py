"""Design of experiments: which parameters to simulate."""
