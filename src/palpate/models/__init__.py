"""Forward models: curves of a study and their derivatives by the coordinates of a search, at levels of fidelity."""
