"""The report of a study: one page whose first screen is the answer, with interactive curves, that opens from disk."""
