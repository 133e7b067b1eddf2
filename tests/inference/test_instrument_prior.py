"""Amplitudes with the posterior of an earlier study as their prior: departures, evidence and draws."""

from dataclasses import replace

import numpy as np
import pytest
from closed_forms import rounded
from diagnosis_problem import SCALE, fitted, problem, recordings
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from palpate.inference.posterior import posterior_draws
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.instrument_prior import InstrumentPrior, JointAmplitudes, SearchedRange

FRAME, CAP = frozenset({"frame_compliance"}), frozenset({"frame_compliance", "tip_rounding"})
NAMES = ("frame_compliance.compliance", "tip_rounding.radius")
JOINT = JointAmplitudes(NAMES, np.array([0.55, 0.1]), np.array([[4e-4, -1.5e-4], [-1.5e-4, 1e-4]]))
PRIOR = InstrumentPrior(
    "earlier",
    {
        "frame_compliance": {"compliance": SearchedRange(-50.0, 50.0, 1.0)},
        "tip_rounding": {"radius": SearchedRange(1.0, 400.0, None)},
    },
    {FRAME: 0.3, CAP: 0.7},
    {FRAME: JOINT.of(FRAME), CAP: JOINT},
)


def task(prior=PRIOR, compliance=4.0, radius=40.0):
    def effect(condition, _):
        return compliance * condition.protocol.sample_load + rounded(condition.protocol, {"radius": radius})

    found = problem(recordings(np.random.default_rng(4), effect), tip_rounding=rounded)
    return replace(found, scale=replace(SCALE, instrument=prior))


def test_departures_are_those_from_the_joint_density():
    coordinates, u = task().coordinates(("tip_rounding", "frame_compliance")), np.array([0.4, 1.2, 0.13, 0.5])
    off = coordinates.departures(u)
    assert off[:2] == pytest.approx([0.0, 0.2]), "the material's are those from the ranges"
    away = u[[3, 2]] - JOINT.mean
    assert off[2:] @ off[2:] == pytest.approx(away @ np.linalg.solve(JOINT.covariance, away))
    steps = [(coordinates.departures(u + d) - coordinates.departures(u - d)) / 2e-6 for d in 1e-6 * np.eye(4)]
    assert coordinates.slopes_of_departures(u) == pytest.approx(np.transpose(steps))


def test_each_set_has_a_density_of_its_own():
    alone = task().coordinates(("frame_compliance",))
    assert alone.normal.covariance == pytest.approx(np.array([[4e-4]]))
    assert not len(task().coordinates(("tip_rounding",)).normal.places), "the earlier study did not fit it"
    assert MECHANISMS["frame_compliance"].searched(task().scale)["compliance"].upper == 50.0


def test_evidence_is_that_of_numerical_integration_over_the_joint_prior():
    """Without the law's discrepancy the curves are Gaussian in the frame's compliance and nearly so in the radius."""
    fit = fitted(task(), ("frame_compliance", "tip_rounding"))
    flat = fit.marginal(np.column_stack([fit.residual, fit.tangent]))
    own = fit.coordinates.normal
    off, slopes = fit.coordinates.departures(fit.z), fit.coordinates.slopes_of_departures(fit.z)
    rows = np.column_stack([-off, slopes])
    curves = replace(flat, products=flat.products - rows.T @ rows)
    rest, found = [0, 1, 2], []
    spread = 6.0 * np.sqrt(np.diag(fit.posterior))[own.places]
    axes = [np.linspace(z - s, z + s, 61) for z, s in zip(fit.z[own.places], spread, strict=True)]
    for point in np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2):
        moved = curves.from_elsewhere(own.places + 1, point - fit.z[own.places]).of_columns(rest)
        density = logsumexp(moved.log_prior + moved.log_densities(1.0 / (2.0 * np.pi)))
        found.append(density + multivariate_normal.logpdf(point, own.mean, own.covariance))
    cell = np.prod([axis[1] - axis[0] for axis in axes])
    expected = logsumexp(found) + np.log(cell) + fit.errors.noise.log_likelihood
    assert fit.log_evidence == pytest.approx(expected, abs=0.02)


def test_draws_follow_the_prior_where_the_recordings_say_less():
    narrow = JointAmplitudes(NAMES, JOINT.mean, 1e-4 * JOINT.covariance)
    sure = fitted(task(replace(PRIOR, amplitudes={CAP: narrow})), ("frame_compliance", "tip_rounding"))
    drawn = posterior_draws(sure)[:, sure.coordinates.normal.places]
    assert drawn.mean(axis=0) == pytest.approx(JOINT.mean, abs=3e-4)
    assert np.cov(drawn.T) == pytest.approx(narrow.covariance, rel=0.2, abs=1e-9)


def test_the_density_of_a_mixture_has_its_mean_and_covariance():
    rng = np.random.default_rng(0)
    parts = [(0.25, JOINT), (0.75, JointAmplitudes(NAMES, np.array([0.6, 0.2]), 2.0 * JOINT.covariance))]
    drawn = [rng.multivariate_normal(each.mean, each.covariance, int(4e5 * weight)) for weight, each in parts]
    pooled = JointAmplitudes.pooled(parts)
    assert pooled.mean == pytest.approx(np.concatenate(drawn).mean(axis=0), abs=2e-4)
    assert pooled.covariance == pytest.approx(np.cov(np.concatenate(drawn).T), rel=0.02)
