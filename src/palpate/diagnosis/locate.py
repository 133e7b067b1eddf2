r"""Where simulation and recordings differ: the signed mean residual of parts of the tests, with their q-values.

A part is tested against the same alternative to noise as the whole: noise of the recordings, the error of the mesh and
a discrepancy of the law that is no larger than the study tolerates. So the covariance C is that of the fit with the
share of the discrepancy cut at the tolerance. Where that is less than what the fit estimated, the parameters move, to
first order by (T' C^-1 T)^+ T' C^-1 r with the tangent T, and the residual is that after the move.

Each segment of each cycle is halved, and the halves once more. These places are fixed beforehand, so that where the
residual changes its sign is no choice that a probability would have to allow for; all of them count among the tests.

Where no explanation is accepted, the same of the closest one, and how it differs between tests, says what the missing
physics would have to change.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import cho_solve
from scipy.stats import chi2, false_discovery_control
from scipy.stats import t as student

from palpate.base.orthonormal import orthonormal
from palpate.diagnosis.estimated_noise import freedom
from palpate.diagnosis.parts import in_segments, polynomials
from palpate.inference.explanation import Fit
from palpate.solver.study_scale import longest_rise
from palpate.study.prescribed_segments import by_cycle, cycle_begins

CERTAIN = 0.05  # share of false discoveries below which a misfit of a part is reported
QUARTER = 2  # points of a quarter of a segment, at least
APART = 1.5  # least ratio of loads, or of loading times, between tests that are compared
Place = tuple[str, int]  # name of a part, and which half of it: 0 for all of it


@dataclass(frozen=True, eq=False)
class Residuals:
    """What a fit leaves, with its covariance and what the noise does not determine.

    Attributes
    ----------
    fit
        The fit, with a discrepancy of the law that is no larger than tolerated.
    left : ndarray, shape (n_all, n_all)
        Takes from recorded curves what the fit does not absorb.
    covariance : ndarray, shape (n_all, n_all)
        Of the residual after the fit [nm^2], C - T (T' C^-1 T)^+ T'.
    """

    fit: Fit
    left: np.ndarray
    covariance: np.ndarray

    @classmethod
    def of(cls, fit: Fit, tolerance: float = np.inf) -> Residuals:
        """Return those of a fit, see `with_tolerable_law`."""
        fit = with_tolerable_law(fit, tolerance)
        white = fit.whiten(fit.tangent)
        absorbed = fit.tangent @ np.linalg.pinv(white.T @ white, rcond=1e-10) @ fit.tangent.T
        left = np.eye(len(absorbed)) - cho_solve((fit.factor, True), absorbed)
        return cls(fit, left, fit.errors.covariance - absorbed)

    @cached_property
    def residual(self) -> np.ndarray:
        """Recorded less simulated depths (n_all,) [nm], after the parameters' move to first order."""
        return self.left.T @ self.fit.residual

    def weighted(self, weights: np.ndarray) -> tuple[float, float]:
        """Return the sum of recorded less simulated depths by weights (n_all,), and the probability that it is noise.

        The most likely effect of the sites is left out where their scatter is assumed, see `Fit.by_sites`.
        Student's distribution allows for a noise that is estimated, see `palpate.diagnosis.estimated_noise`.
        """
        weights = weights - self.fit.by_sites.T @ weights
        value, variance = float(weights @ self.residual), float(weights @ self.covariance @ weights)
        variance = max(variance, 1e-12 * float(weights @ weights))
        free = freedom(self.fit, self.left @ weights, variance)
        return value, float(2 * student.sf(abs(value) / np.sqrt(variance), free))

    def located(self) -> list[dict[str, Any]]:
        """Return the mean residual (recorded less simulated depth) of parts of the tests, the most certain first.

        Each row has `condition`, `cycle` (from 1), `segment`, `part` (``early`` or ``late`` half, or the ``whole``
        segment), `from_s` and `to_s`, the signed `residual_nm` and `q_value`. Where the sign of the residual changes
        between halves the whole is left out, and where it does so within a half its quarters stand for it. Of a test
        whose loads are recorded the residual is the depth under the same load: a larger load means a smaller one.

        The q-values are those of Y. Benjamini and Y. Hochberg, J. R. Stat. Soc. B 57 (1995) 289-300, among all parts.
        """
        problem, segments = self.fit.problem, list[dict[Place, dict[str, Any]]]()
        times = [condition.protocol.sample_time for condition in problem.conditions]
        time, before = np.concatenate(times), np.concatenate([np.append(0.0, each[:-1]) for each in times])
        for condition, (cycle, name), places in in_segments(problem, by_cycle):
            segments.append({})
            for place, chosen in _parts(places).items():
                weights = np.zeros(len(time))
                weights[chosen] = float(np.sign(problem.shares[condition.name])) / len(chosen)
                mean, p_value = self.weighted(weights)
                ends = [end for _, end in condition.held_out if end <= time[chosen[0]]]
                row = {"condition": condition.name, "cycle": cycle, "segment": name, "part": place[0]}
                row |= {"from_s": float(max([before[chosen[0]], *ends])), "to_s": float(time[chosen[-1]])}
                segments[-1][place] = row | {"residual_nm": mean, "q_value": p_value}
        rows = [row for parts in segments for row in parts.values()]
        for row, q in zip(rows, false_discovery_control([row["q_value"] for row in rows]), strict=True):
            row["q_value"] = float(q)
        shown = [row for parts in segments for row in _of_one_sign(parts)]
        return sorted(shown, key=lambda row: (row["q_value"], -abs(row["residual_nm"])))

    def pattern(self, effects: Mapping[str, np.ndarray]) -> tuple[str, float]:
        """Return the name of the pattern that the residual follows most clearly, and its p-value, of that one alone.

        It says what rejected a model of which no single part is significant.

        Parameters
        ----------
        effects : mapping of ndarray, shape (n_all, k)
            Columns of each pattern by its name [nm], such as the effect of a mechanism, or its values in each test.
            Polynomials over each segment of each cycle are added.
        """
        fit, found, every = self.fit, {}, dict(effects)
        for condition, (cycle, segment), columns in polynomials(fit.problem, by_cycle):
            of_cycle = f" of cycle {cycle}" if len(cycle_begins(condition.protocol)) > 1 else ""
            every[f"slow change during {segment}{of_cycle} of {condition.name}"] = columns
        for name, columns in every.items():
            basis = orthonormal(fit.whiten(np.reshape(columns, (len(fit.residual), -1))), fit.tangent_space, 1e-3)
            if basis.shape[1]:
                found[name] = float(chi2.logsf(np.sum((basis.T @ fit.white) ** 2), basis.shape[1]))
        name = min(found, key=lambda key: found[key])
        return name, float(np.exp(found[name]))


def with_tolerable_law(fit: Fit, tolerance: float) -> Fit:
    """Return a fit with a law's discrepancy of at most a `tolerance`, as a share of the depth [-]."""
    law = fit.errors.law
    if law is None or law.share <= tolerance:
        return fit
    return replace(fit, errors=replace(fit.errors, law=law.sized(replace(law.size, share=tolerance))))


def _parts(places: np.ndarray) -> dict[Place, np.ndarray]:
    """Return the indices of a segment (n,), of its halves and, where there are enough, of their halves."""
    half = (len(places) + 1) // 2
    found: dict[Place, np.ndarray] = {("whole", 0): places}
    for name, chosen in (("early", places[:half]), ("late", places[half:])):
        found[name, 0] = chosen
        middle = (len(chosen) + 1) // 2
        if len(chosen) - middle >= QUARTER:
            found |= {(name, 1): chosen[:middle], (name, 2): chosen[middle:]}
    return found


def _of_one_sign(parts: Mapping[Place, dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the rows of those parts of a segment within which the residual keeps its sign."""

    def changes(one: Place, two: Place) -> bool:
        return one in parts and parts[one]["residual_nm"] * parts[two]["residual_nm"] < 0.0

    shown = [] if changes(("early", 0), ("late", 0)) else [parts["whole", 0]]
    for name in ("early", "late"):
        chosen = (1, 2) if changes((name, 1), (name, 2)) else (0,)
        shown += [parts[name, which] for which in chosen]
    return shown


def missing_physics(fit: Fit) -> dict[str, Any]:
    """Return where a fit that is not accepted differs from the recordings: what is missing would have to change it.

    Returns
    -------
    content
        ``mechanisms`` of the fit; ``location``, as that of the base model; ``trends``, a row for the load and for the
        loading time where tests differ in it: `by`, `unit`, the values of the tests compared, `from` and `to`, their
        mean residuals there in parts of the largest depth, `residual_from` and `residual_to`, and `p_value` of their
        difference being noise.
    """
    residuals = Residuals.of(fit)
    return {"mechanisms": sorted(fit.explanation), "location": residuals.located(), "trends": _trends(residuals)}


def _trends(residuals: Residuals) -> list[dict[str, Any]]:
    fit, conditions, found = residuals.fit, residuals.fit.problem.conditions, list[dict[str, Any]]()
    if not all(c.observable.is_depth for c in conditions):
        return []
    curves = [fit.problem.observed[c.name].mean for c in conditions]
    counts, largest = np.array([len(curve) for curve in curves]), np.array([curve.max() for curve in curves])
    loads, times = zip(*((c.protocol.largest_drive, longest_rise(c.protocol)) for c in conditions), strict=True)
    for by, unit, values in (("load", "mN", loads), ("loading time", "s", times)):
        low, high = min(values), max(values)
        if high < APART * low:
            continue
        # weights (n_all,) that average a residual over the tests at either end, in parts of their largest depths
        ends = (np.isclose(values, end, rtol=0.05) for end in (low, high))
        first, last = (np.repeat(which / (counts * largest * which.sum()), counts) for which in ends)
        found.append(
            {"by": by, "unit": unit, "from": float(low), "to": float(high)}
            | {"residual_from": float(first @ fit.left), "residual_to": float(last @ fit.left)}
            | {"p_value": residuals.weighted(last - first)[1]}
        )
    return found
