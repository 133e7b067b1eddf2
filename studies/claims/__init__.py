"""How often claims of a diagnosis are true, in closed form: with laws, lengths, clocks and reversals that are wrong."""

SEED, COUNT, GROUP = 20270131, 2500, 50  # of the sets; as many are drawn, and then diagnosed, at once
