"""Estimation of parameters: coordinates and prior, noise, and least squares on the finite elements."""
