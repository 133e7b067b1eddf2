"""Closed forms and exact laws of indentation, one a file, with which solvers are compared."""
