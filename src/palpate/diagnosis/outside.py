"""Which quantities of a fit lie outside the plausible ranges of a study."""

from __future__ import annotations

from palpate.inference.explanation import Fit

OUTSIDE = 0.005  # of a range, beyond its ends


def outside(fit: Fit) -> list[str]:
    """Return, in words, the quantities of an explanation outside their ranges, with their values."""
    coordinates = fit.coordinates
    beyond = abs(coordinates.beyond(fit.z)) > OUTSIDE
    return [
        f"{each.name} {float(each.physical(x)):.3g}"
        for each, x, far in zip(coordinates.free, fit.z, beyond, strict=True)
        if far
    ]
