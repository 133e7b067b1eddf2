"""What remains open beside the named effects: whether anything further acts, what may hide, and how large it may be."""

from __future__ import annotations

from typing import Any

import numpy as np

from palpate.classical.reference_sample import NORMAL_95
from palpate.diagnosis.diagnose import DiagnosisOutcome
from palpate.diagnosis.screen import Screen
from palpate.inference.explanation import DENSITY_ONE, Fit
from palpate.mechanisms import MECHANISMS

SHOWN = 0.01  # inclusion from which on a hidden mechanism is listed
MOST = 5  # mechanisms that are listed
VAGUE = 1e6  # variance of a coefficient beforehand: next to nothing is known of it


def nothing_further(diagnosis: DiagnosisOutcome, screen: Screen) -> dict[str, Any]:
    """Return what may act beside the mechanisms of the best explanation.

    Returns
    -------
    dict
        `probability` that nothing else of the library changes a part of a test by more than the smallest effect;
        `hidden`, the likeliest mechanisms with their probability and parameters; `may_cover`, for each family the
        largest change of a curve [nm] that the recordings and the discrepancy of the law do not exclude at 95 %.
    """
    known = set(diagnosis.best.fit.explanation)
    alone = sum(probability for members, probability in diagnosis.all_sets.items() if members <= known)
    others = {key: p for key, p in diagnosis.inclusion.items() if key not in known and p >= SHOWN}
    return {
        "probability": min(alone, 1.0),
        "hidden": [
            {"mechanism": key, "probability": p, "parameters": _parameters(key, diagnosis)}
            for key, p in list(others.items())[:MOST]
        ],
        "may_cover": may_cover(diagnosis.best.fit, screen),
    }


def _parameters(key: str, diagnosis: DiagnosisOutcome) -> dict[str, dict[str, float]]:
    """Return a mechanism's parameters in the likeliest fitted set that holds it, with 95 % intervals to first order."""
    fitted = diagnosis.sets.fitted
    fit = next((fitted[members].fit for members in diagnosis.all_sets if key in members and members in fitted), None)
    if fit is None:
        return {}
    reach = NORMAL_95 * np.sqrt(np.diag(fit.posterior))
    here, *ends = (fit.problem.amplitudes(fit.explanation, fit.z + side * reach)[key] for side in (0.0, -1.0, 1.0))
    return {
        f"{key}.{name}": {
            "estimate": float(value),
            "lower": float(min(each[name] for each in ends)),
            "upper": float(max(each[name] for each in ends)),
        }
        for name, value in here.items()
    }


def may_cover(fit: Fit, screen: Screen) -> dict[str, float]:
    """Return, for each family, the largest change of a curve [nm] by one of its mechanisms that is not excluded.

    To first order the effect at three quarters of its range has a coefficient, which joins the parameters of the fit at
    the likeliest size of the law's discrepancy; the end of its 95 % interval that is farther from zero counts.
    """
    found, acting = dict[str, float](), {MECHANISMS[key].family for key in fit.explanation}
    for key in [key for key in screen.keys if MECHANISMS[key].family not in acting]:
        effect = screen.shown(key)
        change, covariance = fit.joined(effect, VAGUE, DENSITY_ONE)
        end = abs(float(change[-1])) + NORMAL_95 * float(np.sqrt(covariance[-1, -1]))
        family = MECHANISMS[key].family
        found[family] = max(found.get(family, 0.0), end * float(np.abs(effect).max()))
    return found
