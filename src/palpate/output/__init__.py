"""Figures, pages, and files for other programs."""
