"""The outcome of a calibration and its place in `calibration.json`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

MOST_MISFIT = 1.5  # chosen, of chi-square per degree of freedom: above it something is missing from the model


@dataclass(frozen=True)
class Estimate:
    """A calibrated parameter, in its physical unit.

    Parameters
    ----------
    estimate
        Best value.
    lower, upper
        95 % interval.
    identified
        Whether the data determine it (see `palpate.inference.estimates`).
    held
        Whether it was held constant; then all values are equal and it is not identified.
    at_bound
        Whether the estimate lies on a limit of the law.
    outside
        Whether it lies outside its range.
    """

    estimate: float
    lower: float
    upper: float
    identified: bool
    held: bool = False
    at_bound: bool = False
    outside: bool = False


@dataclass(frozen=True, eq=False)
class CalibrationOutcome:
    """What a calibration found.

    Attributes
    ----------
    parameters
        `Estimate` of each parameter.
    conditions
        For each condition what `error_measures` returns of the forward model's curve, and `role`.
    surrogate_curves
        Curves (n_points,) of the surrogates at their own optimum, of depth [nm] or load [mN].
    simulated_curves
        Curves of the forward model at the estimate, of every condition under which it did not fail.
    on_surrogates
        Parameters at the optimum of the genetic search.
    converged
        Whether the search on the forward model converged.
    misfit_ratio
        chi^2 per degree of freedom at the estimate.
    discrepancy
        `share`, `lower` and `upper` of what the law leaves at its best parameters, as a share of the depth, 95 %
        interval; None where the law is taken to be exact.
    uniaxial
        For each uniaxial test of the bulk what `palpate.inference.bulk_prediction.predicted` returns.
    imprint
        For each imprint what `palpate.inference.imprint_prediction.imprint_predictions` returns.
    correlation
        Correlations of the free parameters, by name.
    noise
        For each calibrated condition: sigma_nm (or sigma_mN under displacement control), correlation, site_scatter,
        replicates.
    evaluations
        Surrogate evaluations of the genetic search.
    seed
        Entropy of the random generator's seed, where it has one.
    settings
        Everything that was set.
    pareto
        `parameters` (name: values) and `objectives` (condition: values) of the front of the genetic search.
    history
        One entry for each generation: `generation`, `evaluations`, `best`, `best_sum`.
    """

    parameters: Mapping[str, Estimate]
    conditions: Mapping[str, Mapping[str, Any]]
    surrogate_curves: Mapping[str, np.ndarray]
    simulated_curves: Mapping[str, np.ndarray]
    on_surrogates: Mapping[str, float]
    converged: bool
    misfit_ratio: float
    discrepancy: Mapping[str, float] | None
    uniaxial: Mapping[str, Mapping[str, Any]]
    imprint: Mapping[str, Mapping[str, Any]]
    correlation: Mapping[str, Mapping[str, float]]
    noise: Mapping[str, Mapping[str, float]]
    evaluations: int
    seed: int | list[int] | None
    settings: Mapping[str, Any]
    pareto: Mapping[str, Mapping[str, list[float]]]
    history: list[dict[str, Any]]

    @property
    def values(self) -> dict[str, float]:
        """Best values by name."""
        return {name: found.estimate for name, found in self.parameters.items()}

    def to_mapping(self, **extra: Any) -> dict[str, Any]:
        """Contents of `calibration.json`, for the json module; curves are left out.

        Parameters
        ----------
        extra
            Further entries, such as the name of the condition set.
        """
        content = asdict(self)
        return {name: content[name] for name in content if not name.endswith("_curves")} | extra


def rmse(content: Mapping[str, Any], role: str, unit: str = "nm") -> float | None:
    """Return the root mean square error over the conditions of a role, in nm or mN; None where there is none.

    Parameters
    ----------
    content
        Of ``calibration.json``.
    """
    entries = [entry for entry in content["conditions"].values() if entry["role"] == role]
    errors = [entry[f"rmse_{unit}"] for entry in entries if f"rmse_{unit}" in entry]
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else None
