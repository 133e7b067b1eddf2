"""How often the intervals of a calibration hold the truth: sets of recordings in closed form, most by another law."""
