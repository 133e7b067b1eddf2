"""Machinery that the laws of the parent folder share: their arithmetic, their rows of numbers, the radial equation."""
