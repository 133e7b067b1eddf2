"""The specification of a test: load history, indenter and body."""
