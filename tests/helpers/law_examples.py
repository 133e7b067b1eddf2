"""Every law found, alone or with a back stress, and values of its parameters."""

from palpate.materials import LAWS

HOOKE = {"youngs_modulus": 3.0, "poisson_ratio": 0.35}
ALONE = [key for key in LAWS if key != "kinematic_hardening"]
BACKED = ["bilinear_plasticity+kinematic_hardening", "hardening_eyring+kinematic_hardening+retardation_spectrum"]


def values(model):
    return HOOKE | {name: value for key in model.split("+") for name, value in LAWS[key].example.items()}
