"""The materials and indenters of the cases: an epoxy and a single crystal of aluminium."""

from __future__ import annotations

from palpate.study.indenter import Indenter

HOOKE = {"youngs_modulus": 3.28, "poisson_ratio": 0.34}
VOIGT = {"transient_coefficient": 0.24, "transient_exponent": 0.47, "retardation_time": 0.25}
BURGERS = HOOKE | {"steady_coefficient": 0.09, "steady_exponent": 0.20} | VOIGT
STEADY_CREEP = BURGERS | {"transient_coefficient": 0.0}
ALUMINIUM = {"youngs_modulus": 70.0, "poisson_ratio": 0.345, "yield_stress": 0.1, "hardening": 0.5}
CONE = Indenter("cone", 70.3)
