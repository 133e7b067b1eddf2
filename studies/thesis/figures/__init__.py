"""Figures of the thesis' studies, one a file, drawn from saved outcomes."""
