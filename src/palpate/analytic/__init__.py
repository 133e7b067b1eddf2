"""Closed forms and exact laws of indentation, one a file: what a solver can be held to."""
