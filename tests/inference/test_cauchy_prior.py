"""The prior of an instrument's errors: Cauchy's distribution as a mixture, and the evidence that follows from it."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_problem import fitted, problem, recordings
from scipy.special import logsumexp
from scipy.stats import cauchy

from palpate.inference.marginal import Marginal, Modes
from palpate.mechanisms import MECHANISMS, Scale
from palpate.models.coordinates import Coordinate, Coordinates

SIZE = 0.03
PRIOR = Coordinates([Coordinate("a", -1.0, 1.0, -50.0, 50.0, typical=2.0 * SIZE)], {})
NANO = Scale(2000.0, 10.0, 3.0, 120.0, 10.0, 70.3, 0.2)
AFM = Scale(2000.0, 1e-4, 1e-6, 20.0, 1.0, 0.0, 1e-8)


def density(u):
    return np.exp(PRIOR.log_cauchy(np.asarray(u)[:, None]))


def test_half_of_the_prior_lies_within_the_typical_size_and_its_tails_are_long():
    u = np.linspace(-60.0, 61.0, 2_000_001)
    masses = density(u) * (u[1] - u[0])
    assert masses.sum() == pytest.approx(1.0, abs=1e-3)
    assert masses[np.abs(u - 0.5) < SIZE].sum() == pytest.approx(0.5, abs=0.05)
    for times in (3.0, 10.0):
        beyond = masses[np.abs(u - 0.5) > times * SIZE].sum()
        assert beyond == pytest.approx(2.0 * cauchy.sf(times), rel=0.4)


@pytest.mark.parametrize("planted", [0.0, 0.5, 3.0, 12.0])
def test_evidence_of_a_compliance_is_that_of_numerical_integration(planted):
    """The frame adds in proportion, so the integral over its compliance is one of Gaussians, here summed at points."""
    observed = recordings(np.random.default_rng(11), lambda condition, _: planted * condition.protocol.sample_load)
    fit = fitted(problem(observed), ("frame_compliance",))
    marginal = fit.marginal(np.column_stack([fit.residual, fit.tangent]))
    (place,), k = fit.coordinates.cauchy, len(fit.z)
    away = np.linspace(-12.0, 12.0, 20001)
    rest = [0, *(1 + j for j in range(k) if j != place)]
    at = []
    for u in away:
        moved = marginal.from_elsewhere(np.array([1 + place]), np.array([u - fit.z[place]]))
        at.append(logsumexp(moved.log_prior + moved.of_columns(rest).log_densities(1.0 / (2.0 * np.pi))))
    prior = fit.coordinates.log_cauchy(np.tile(fit.z, (len(away), 1)) + np.outer(away - fit.z[place], np.eye(k)[place]))
    expected = logsumexp(np.array(at) + prior) + np.log(away[1] - away[0])
    noise = fit.errors.noise
    assert fit.log_evidence == pytest.approx(expected + noise.log_likelihood * noise.replicated, abs=0.02)


def test_where_a_search_did_not_converge_the_prior_counts_where_it_stopped():
    fit = fitted(problem(recordings(np.random.default_rng(3))), ("frame_compliance",))
    stopped = replace(fit, converged=False)
    farther = replace(stopped, z=stopped.z + 0.3 * np.eye(len(fit.z))[fit.coordinates.cauchy[0]])
    change = float(farther.coordinates.log_cauchy(farther.z) - fit.coordinates.log_cauchy(fit.z))
    assert farther.log_evidence - stopped.log_evidence == pytest.approx(change, abs=1e-9)


def test_columns_seen_from_elsewhere_give_what_a_moved_residual_gives():
    rng = np.random.default_rng(0)
    columns, factor = rng.standard_normal((12, 4)), np.linalg.cholesky(np.eye(12) + 0.2)
    moved = columns.copy()
    moved[:, 0] -= columns[:, [1, 3]] @ [0.4, -1.3]
    seen = Marginal.of(Modes(factor, None), columns).from_elsewhere(np.array([1, 3]), np.array([0.4, -1.3]))
    assert seen.products == pytest.approx(Marginal.of(Modes(factor, None), moved).products)


@pytest.mark.parametrize(("key", "name"), [("frame_compliance", "compliance"), ("thermal_drift", "rate")])
def test_instruments_of_every_class_have_a_typical_error_well_within_the_range(key, name):
    for scale in (NANO, AFM):
        found = MECHANISMS[key].searched(scale)[name]
        assert 0.0 < found.typical <= 0.5 * found.upper


def test_a_stated_range_moves_the_middle_of_the_prior():
    stated = replace(NANO, stated={"frame_compliance": {"compliance": (4.0, 6.0)}})
    found = MECHANISMS["frame_compliance"].searched(stated)["compliance"]
    assert (found.lower, found.upper, found.typical) == (4.0, 6.0, 1.0)
