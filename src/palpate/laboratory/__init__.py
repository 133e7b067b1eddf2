"""A virtual laboratory, whose recordings hide what is known."""
