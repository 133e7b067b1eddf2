"""The recordings of a study as they are compared: found, checked, resampled, and their noise; no law is known here."""
