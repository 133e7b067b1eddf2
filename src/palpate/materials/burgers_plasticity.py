"""Nonlinear Burgers creep with rate-independent J2 yielding beside it; both flow along the stress deviator."""

from __future__ import annotations

from palpate.materials import bilinear_plasticity, nonlinear_burgers
from palpate.materials.joined import joined

LAW = joined((nonlinear_burgers.LAW, bilinear_plasticity.LAW), "burgers_plasticity", "nonlinear Burgers with yielding")
