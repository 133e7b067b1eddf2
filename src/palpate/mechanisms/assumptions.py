"""Assumptions of the exact laws; a mechanism declares which of them it breaks."""

from __future__ import annotations

from enum import Enum


class Assumption(Enum):
    """One assumption of an exact law (`palpate.diagnosis.constraints`), in words."""

    UNIFORM = "hardness and modulus are the same at every depth"
    ALL_CREEP_IS_KNOWN = "all creep is in the base model"
    RECORDED_LOAD_ACTS = "the recorded load acts when it is recorded"
    NO_DRIFT = "the depth is free of drift"
    STEADY_DRIFT = "a drift has one rate through the whole test"
    ONE_COMPLIANCE = "the compliance in series with the contact is the same in every test"
