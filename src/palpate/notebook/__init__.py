"""The front door: what `palpate` offers a notebook or a script, as objects with a summary, a table and a plot.

Everything here wraps what other rooms do, and none of them imports it.
"""
