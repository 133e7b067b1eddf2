"""Figures, one a file, drawn from saved results alone."""
