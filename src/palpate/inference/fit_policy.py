"""The settings of a fit on the finite elements, each with its origin."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class FitPolicy:
    """How far a fit goes; chosen for its time, not by the cases that are reported, where nothing else is said.

    Parameters
    ----------
    scattered
        Places of the ranges that are tried beside the optima of the genetic search.
    single_start
        Chi-square per degree of freedom up to which a fit from the optimum of the genetic search needs no other start.
    searches
        That go on side by side, from the best of all places where a fit may begin; one that falls behind is given up.
    base_searches
        The same of the base model where it has several places to begin, with few samples. On a single recording of a
        polymer two of eight ended near the least residual, which was half that of the others, and neither was among the
        two that began best; from each of three sets of 16 places eight searches found it.
    iterations
        Largest number of iterations of a search; those that converge take 4 to 8, and 1 to 3 where one ended before.
    base_iterations
        The same of the base model, whose search begins far away and may follow a long valley.
    sizes
        Largest number of searches until the size of the law's discrepancy agrees with the parameters.
    first_tolerance, tolerance
        Changes of chi-square below which a search has converged: 0.7 and 0.14 standard deviations of the whole
        estimate. Chi-square of an explanation counts over its ratio to the degrees of freedom, where that exceeds one.
    without_effect
        Increase of chi-square over the smaller explanation up to which a search ended where one more mechanism hardly
        acts, and no other start is tried: twice ten in log evidence, beyond which explanations are not accepted.
    poor_fit
        Chi-square per sample above which the base model leaves far more than noise, whatever the error of the mesh.
    unlikely
        Standard deviations of chi-square above its mean, beyond which noise does not leave it: an explanation that is
        not expected to come there is not followed to its end.
    noise_error
        The same by the relative error of the noise's variance, which is estimated from few recordings; the larger bound
        counts. In cases of the blind trial explanations that leave noise in the end begin their refinement within it.
    refined
        Chi-square per degree of freedom up to which an explanation is refined. Those that leave noise in the end begin
        with 1.3 at most in cases of the blind trial.
    finer_meshes
        Chi-square per degree of freedom up to which a fit goes on with finer meshes.
    finer_share
        Discrepancy of the law, as a share of the depth, up to which that matters: finer meshes change 0.07 % of the
        depth, and what is left of their error is a third of it.
    finer_steps
        Largest number of simulated steps with them where the edge of contact matters; two suffice where the fit before
        ended five standard deviations away.
    first_order
        Decrease of chi-square, predicted for a step with them, below which it is taken with derivatives alone, and is
        the last one. These err by 3 % at most, which moves the estimate by 0.02 standard deviations. With a strong
        adhesion it ended 0.2 from where simulated steps did, which themselves end within 0.14 (`tolerance`).
    """

    scattered: int = 16
    single_start: float = 3.0
    searches: int = 2
    base_searches: int = 8
    iterations: int = 12
    base_iterations: int = 30
    sizes: int = 6
    first_tolerance: float = 0.5
    tolerance: float = 0.02
    without_effect: float = 20.0
    poor_fit: float = 50.0
    unlikely: float = 4.0
    noise_error: float = 0.3
    refined: float = 10.0
    finer_meshes: float = 1.5
    finer_share: float = 0.002
    finer_steps: int = 3
    first_order: float = 0.5

    def likely_chi_square(self, count: int) -> float:
        """Return chi-square of a number of samples up to which noise may leave it, see `unlikely`."""
        return count * (1.0 + max(self.noise_error, self.unlikely * math.sqrt(2.0 / count)))
