"""Bodies that another finite-element code computed: recordings made from its curves, diagnosed, and scored blindly."""

SEED, DRAWS = 20261130, 12  # of the noise and the effects; recordings of each body, with and without an effect each
GROUP = 6  # sets that are diagnosed at once
