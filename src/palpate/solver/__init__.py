"""Finite elements: one indentation or many simulated, and the store of their curves."""
