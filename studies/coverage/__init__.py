"""How often the intervals of a calibration hold the truth: sets of recordings in closed form, most of another law."""

SEED, COUNT, GROUP = 20261201, 1008, 36  # of the reported sets; as many are drawn, and then fitted, at once
LAW_ERRORS = (0.00125, 0.0025, 0.005)  # the default's half, itself, and its double
EVERY = 6  # set that is fitted with half and double the default, too
