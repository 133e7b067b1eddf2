"""The material's parameters over all sets of mechanisms: the mixture of the posteriors of the sets."""

import numpy as np
import pytest
from diagnosis_problem import problem, recordings, search_of

from palpate.diagnosis.explanations import Explanations
from palpate.diagnosis.over_sets import draws_over_sets
from palpate.inference.posterior import DRAWS, posterior_draws


@pytest.fixture(scope="module")
def search():
    """Recordings that a drift has changed a little."""
    return search_of(problem(recordings(np.random.default_rng(2), lambda c, r: 0.05 * c.protocol.sample_time)))


def explanations(search, *keys):
    found = Explanations(len(search.screen.keys))
    found.add(search.base)
    for key in keys:
        found.add(search.candidate(search.joined(search.base.fit, key)))
    return found


def spread(draws):
    return np.quantile(draws, [0.025, 0.5, 0.975], axis=0)


def test_one_set_has_its_own_posterior(search):
    draws = draws_over_sets(explanations(search), search.screen, np.random.default_rng(0))
    assert spread(draws) == pytest.approx(spread(posterior_draws(search.base.fit)), abs=1e-9)


def test_each_set_has_a_share_that_is_its_probability(search):
    found = explanations(search, "thermal_drift")
    shares, ranked = list(found.probabilities().values()), sorted(found.fitted.values(), key=lambda c: -c.rank[1])
    draws = draws_over_sets(found, search.screen, np.random.default_rng(0))
    assert len(draws) == pytest.approx(DRAWS, abs=2)
    means = [posterior_draws(each.fit)[:, 0].mean() for each in ranked]
    assert draws[:, 0].mean() == pytest.approx(np.dot(shares, means), abs=0.02 * np.ptp(means))


def test_a_set_that_was_not_fitted_widens_the_interval_as_its_fit_does(search):
    fitted, estimated = explanations(search, "thermal_drift"), explanations(search)
    gain = max(c.fit.log_evidence for c in fitted.fitted.values()) - search.base.fit.log_evidence
    estimated.estimate(frozenset({"thermal_drift"}), frozenset(), gain)
    wanted, found = (
        spread(draws_over_sets(each, search.screen, np.random.default_rng(0))) for each in (fitted, estimated)
    )
    assert found == pytest.approx(wanted, abs=0.15 * float((wanted[2] - wanted[0]).max()))
