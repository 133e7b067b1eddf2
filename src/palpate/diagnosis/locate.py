"""Where simulation and recordings differ: the mean residual of each part of a test, with false-discovery control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import cho_solve
from scipy.stats import false_discovery_control
from scipy.stats import t as student

from palpate.inference.estimated_noise import freedom
from palpate.inference.explanation import Fit
from palpate.study.prescribed_segments import segments

CERTAIN = 0.05  # share of false discoveries below which a misfit of a part is reported


@dataclass(frozen=True, eq=False)
class Residuals:
    """What a fit leaves, with its covariance and what the noise does not determine.

    Attributes
    ----------
    fit
        The fit.
    left : ndarray, shape (n_all, n_all)
        Takes from recorded curves what the fit does not absorb.
    covariance : ndarray, shape (n_all, n_all)
        Of the residual after the fit [nm^2], C - T (T' C^-1 T)^+ T'.
    """

    fit: Fit
    left: np.ndarray
    covariance: np.ndarray

    @classmethod
    def of(cls, fit: Fit) -> Residuals:
        """Return those of a fit."""
        white = fit.whiten(fit.tangent)
        absorbed = fit.tangent @ np.linalg.pinv(white.T @ white, rcond=1e-10) @ fit.tangent.T
        left = np.eye(len(absorbed)) - cho_solve((fit.factor, True), absorbed)
        return cls(fit, left, fit.errors.covariance - absorbed)

    def weighted(self, weights: np.ndarray) -> tuple[float, float]:
        """Return the weighted sum of recorded less simulated depths, and the probability that it is noise.

        The most likely effect of the sites is left out where their scatter is assumed, see `Fit.by_sites`.
        Student's distribution allows for a noise that is estimated, see `palpate.inference.estimated_noise`.

        Parameters
        ----------
        weights : ndarray, shape (n_all,)
        """
        weights = weights - self.fit.by_sites.T @ weights
        value, variance = float(weights @ self.fit.residual), float(weights @ self.covariance @ weights)
        variance = max(variance, 1e-12 * float(weights @ weights))
        free = freedom(self.fit, self.left @ weights, variance)
        return value, float(2 * student.sf(abs(value) / np.sqrt(variance), free))

    def located(self) -> list[dict[str, Any]]:
        """Return the mean residual (recorded less simulated depth) of each part of the tests, the most certain first.

        Of a test whose loads are recorded it is the depth under the same load: a larger load means a smaller one.
        The q-values are those of Benjamini & Hochberg, J. R. Stat. Soc. B 57 (1995) 289-300.
        """
        fit, first = self.fit, 0
        rows: list[dict[str, Any]] = []
        p_values = []
        for condition in fit.problem.conditions:
            sign = np.sign(fit.problem.shares[condition.name])
            for name, where in segments(condition.protocol).items():
                places = first + np.flatnonzero(where)
                half = (len(places) + 1) // 2
                for part, chosen in (("early", places[:half]), ("late", places[half:]), ("whole", places)):
                    weights = np.zeros(len(fit.residual))
                    weights[chosen] = sign / len(chosen)
                    mean, p_value = self.weighted(weights)
                    rows.append({"condition": condition.name, "segment": name, "part": part, "residual_nm": mean})
                    p_values.append(p_value)
            first += len(condition.protocol.sample_time)
        for row, q in zip(rows, false_discovery_control(p_values), strict=True):
            row["q_value"] = float(q)
        return sorted(rows, key=lambda row: (row["q_value"], -abs(row["residual_nm"])))
