"""Design of experiments: which parameters to simulate, and what an effect is worth."""
