"""The interface for notebooks and scripts: objects with a summary, a table and a plot.

Everything here wraps what other packages do, and none of them imports it.
"""
