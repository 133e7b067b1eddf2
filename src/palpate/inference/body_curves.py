"""Simulated curves of the body alone, without what the instrument adds."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from palpate.errors import InputError
from palpate.solver.simulation import simulate_batch
from palpate.solver.variation import added_by_instrument

if TYPE_CHECKING:
    from palpate.inference.forward import FiniteElements


def bodies(model: FiniteElements, u: np.ndarray, pyramid: bool = False) -> dict[str, np.ndarray]:
    """Return the curve of the body (n,) under each condition where its simulation succeeds; none of an impossible body.

    A body may be impossible under a single condition, such as one that ends before the controller's lag.

    Parameters
    ----------
    model
        Its mesh, conditions and samples.
    u
        Coordinates (k,).
    pyramid
        Whether a pyramid is simulated as such, and not as the equivalent cone.
    """
    specification, acting = model.of_study if pyramid else model.specification, model.amplitudes(u)
    try:
        outcomes = simulate_batch([specification(u, condition) for condition in model.conditions])
    except InputError:
        alone = [replace(model, conditions=(condition,)) for condition in model.conditions]
        parts = [bodies(each, u, pyramid) for each in alone] if len(alone) > 1 else []
        return {name: curve for part in parts for name, curve in part.items()}
    return {
        condition.name: outcome.response - added_by_instrument(acting, condition.protocol)
        for condition, outcome in zip(model.conditions, outcomes, strict=True)
        if outcome.status == "ok"
    }
