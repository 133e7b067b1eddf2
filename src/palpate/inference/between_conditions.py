"""Variance of amplitudes between conditions, beyond that between the recordings of one condition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palpate.inference.explanation import Fit

SHARES = (0.0, 0.01, 0.03, 0.1, 0.3)  # standard deviations that are tried, of the largest plausible value
LEAST_GAIN = 2.0  # of the log likelihood, above which a variance between conditions is accepted


def with_own_values(fit: Fit) -> Fit:
    """Give each amplitude that varies the most likely variance between conditions."""
    for amplitude in fit.own:
        trials = list[tuple[float, Fit]]()
        for share in SHARES:
            between = {**fit.errors.between, str(amplitude): (share * fit.problem.largest(amplitude)) ** 2}
            trial = replace(fit, errors=replace(fit.errors, between=between))
            tangent = trial.whiten(fit.tangent)
            left = trial.white - tangent @ np.linalg.lstsq(tangent, trial.white, rcond=1e-10)[0]
            trials.append((-0.5 * float(left @ left) - trial.log_volume, trial))
        likeliest, alike = max(trials, key=lambda each: each[0]), trials[0]
        fit = (likeliest if likeliest[0] > alike[0] + LEAST_GAIN else alike)[1]
    return fit
