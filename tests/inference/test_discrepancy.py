"""The discrepancy of a law: what tests share of it, its prior, its algebra, and its effect on fits of a wrong law."""

import numpy as np
import pytest
from scipy.linalg import cholesky
from scipy.special import logsumexp

from palpate.classical import ting
from palpate.configuration.settings import CalibrationSettings
from palpate.inference.calibrate import base_fit
from palpate.inference.discrepancy import LENGTHS, OBEYS, OWN, SIZES, Discrepancy, Size, log_prior
from palpate.inference.estimates import intervals, law_discrepancy
from palpate.inference.law_structure import Indentation
from palpate.inference.marginal import Marginal, Modes
from palpate.inference.problem import Problem
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from studies.coverage.creep import HALF_ANGLE, POISSON_RATIO, burgers, depth
from studies.coverage.fits import SCALE
from studies.coverage.score import wilson
from studies.coverage.sets import draw, recordings
from studies.coverage.solid import MATERIAL, BurgersSolid

SOLID = burgers(3.0, 0.001, 0.1, 20.0)


def trials(*tests):
    return [trapezoid(load, rise, hold, rise, points=40) for load, rise, hold in tests]


def discrepancy(protocols, sharp=True, law_error=0.0025, share=0.01, own=OBEYS, kind="test"):
    depths = {str(k): depth(SOLID, protocol) for k, protocol in enumerate(protocols)}
    tests = [Indentation(protocol, grows=not sharp) for protocol in protocols]
    return Discrepancy.of(tests, depths, law_error, {}).sized(Size(share, own, kind))


def correlations(first, second, sharp=True):
    """Return the correlation (n,) of what histories determine, at the same sample of two tests."""
    common = discrepancy(trials(first, second), sharp).common
    a, b = np.split(common, 2)
    return np.sum(a * b, axis=1) / np.sqrt(np.sum(a**2, axis=1) * np.sum(b**2, axis=1))


def test_under_a_sharp_tip_tests_of_one_history_share_it_wholly_at_every_load():
    assert correlations((1.0, 30.0, 10.0), (9.0, 30.0, 10.0)) == pytest.approx(1.0, abs=1e-3)
    under_a_sphere = correlations((1.0, 30.0, 10.0), (9.0, 30.0, 10.0), sharp=False)
    assert under_a_sphere.max() < 0.1


def of_two_tips(one, two, load=1.0, depth_of_sphere=400.0):
    """Return the correlation (n,) of what histories determine, in tests of one load history with two tips."""
    (protocol,) = trials((load, 30.0, 10.0))
    tips = {"a": one, "b": two}.items()
    tests = [Indentation.under(name, tip, protocol, [protocol], [depth_of_sphere]) for name, tip in tips]
    common = Discrepancy.of(tests, {"a": depth(SOLID, protocol), "b": depth(SOLID, protocol)}, 0.0025, {}).common
    a, b = np.split(common, 2)
    return np.sum(a * b, axis=1) / np.sqrt(np.sum(a**2, axis=1) * np.sum(b**2, axis=1))


def test_tips_share_it_as_far_as_they_strain_the_body_alike():
    cone = Indenter("cone", 70.3)
    assert of_two_tips(cone, Indenter.from_mapping({"shape": "berkovich"})) == pytest.approx(1.0, abs=1e-3)
    assert of_two_tips(cone, Indenter("cone", 42.3)).max() < 1e-3
    slope = 1.0 / np.tan(np.radians(70.3))
    at_its_slope = of_two_tips(cone, Indenter("sphere", radius=400.0 / slope**2))
    loading = slice(0, int(np.argmax(trials((1.0, 30.0, 10.0))[0].sample_load)) + 1)
    assert at_its_slope[loading][-1] == pytest.approx(1.0, abs=1e-3)
    assert at_its_slope[loading][0] < 0.1
    assert of_two_tips(cone, Indenter("sphere", radius=1e6)).max() < 1e-3


def test_a_sphere_shares_with_another_what_it_shares_with_itself_at_the_load_of_equal_strain():
    """Hertz: (a / R)^3 = 3 P / (4 E R^2), so four times the load on twice the radius is the same strain."""
    first, second = trials((1.0, 30.0, 10.0), (4.0, 30.0, 10.0))
    tests = [
        Indentation.under("a", Indenter("sphere", radius=1e4), first, [first], [500.0]),
        Indentation.under("b", Indenter("sphere", radius=2e4), second, [second], [1000.0]),
    ]
    common = Discrepancy.of(tests, {"a": depth(SOLID, first), "b": depth(SOLID, second)}, 0.0025, {}).common
    a, b = np.split(common, 2)
    assert np.sum(a * b, axis=1) == pytest.approx(np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1), rel=1e-3)


def test_a_length_of_one_tip_says_nothing_of_another():
    protocols = trials((1.0, 30.0, 10.0), (4.0, 30.0, 10.0))
    tests = [Indentation(protocol, name) for name in "ab" for protocol in protocols]
    depths = {f"{test.tip}{k}": depth(SOLID, test.protocol) for k, test in enumerate(tests)}
    found = Discrepancy.of(tests, depths, 0.0025, {})
    for kind in LENGTHS:
        a, b = np.split(found.breaches[kind][:, :-1], 2)
        assert np.abs(a @ b.T).max() == 0.0 < np.abs(a).max()
        in_proportion = np.split(found.breaches[kind][:, -1], 2)
        assert in_proportion[0] == pytest.approx(in_proportion[1])


def test_a_length_is_part_of_the_law_where_a_tip_has_one_load():
    one = trials((1.0, 30.0, 10.0), (1.0, 60.0, 0.0))
    of_length, of_law = (discrepancy(one, own=own, kind=LENGTHS[0]).covariance for own in (0.9, 0.0))
    assert of_length == pytest.approx(0.1 * of_law)


def test_times_that_are_nearly_equal_are_equal_and_others_share_it_in_part():
    assert correlations((1.0, 30.00, 10.0), (1.0, 30.02, 10.0)) == pytest.approx(1.0, abs=1e-3)
    assert correlations((1.0, 10.0, 0.0), (1.0, 100.0, 0.0)).max() < 0.5


def test_the_standard_deviation_is_a_share_of_the_largest_depth_so_far():
    protocols = trials((1.0, 30.0, 10.0), (4.0, 10.0, 0.0))
    largest = np.concatenate([np.maximum.accumulate(depth(SOLID, protocol)) for protocol in protocols])
    for own in (OBEYS, *OWN):
        found = np.diag(discrepancy(protocols, own=own).covariance)
        assert np.sqrt(found) == pytest.approx(0.01 * largest, rel=1e-3)


def test_a_breach_begins_where_the_load_turns_or_grows_with_the_clock():
    (test,) = trials((1.0, 30.0, 10.0))
    time = test.sample_time
    turned, walked = (np.diag(discrepancy([test], own=0.9, kind=kind).covariance) for kind in ("reversal", "clock"))
    smooth = np.diag(0.1 * discrepancy([test], own=0.0).covariance)
    assert (turned - smooth)[time < 30.0] == pytest.approx(0.0, abs=1e-6)
    late = (turned - smooth)[(time > 30.5) & (time < 40.0)]
    assert np.all(np.diff(late) < 0.0)
    assert np.all(np.diff(walked - smooth) > 0.0)


@pytest.mark.parametrize(
    "unlisted",
    [
        pytest.param(lambda h, load: -h * h / (h + 700.0), id="modulus that grows with depth"),
        pytest.param(lambda h, load: -h / np.sqrt(h + 40.0), id="area function of Oliver and Pharr"),
        pytest.param(lambda h, load: h * 0.6 / (1.0 + (300.0 / h) ** 1.5), id="layer"),
        pytest.param(lambda h, load: h * np.tanh(load / 2.0), id="load cell that softens"),
    ],
)
def test_what_has_one_length_or_one_load_is_about_a_crossover(unlisted):
    protocols = trials((0.3, 20.0, 10.0), (1.0, 60.0, 0.0), (3.0, 30.0, 30.0), (10.0, 30.0, 10.0))
    curve = np.concatenate([depth(SOLID, protocol) for protocol in protocols])
    load = np.concatenate([protocol.sample_load for protocol in protocols])
    law = discrepancy(protocols)
    change, elastic = unlisted(curve, load) / law.scale, curve / law.scale
    left = []
    for kind in LENGTHS:
        columns = np.column_stack([elastic, law.breaches[kind] / law.scale[:, None]])
        left.append(np.std(change - columns @ np.linalg.lstsq(columns, change, rcond=None)[0]))
    assert min(left) < 0.1 * np.std(change - elastic * (elastic @ change) / (elastic @ elastic))


def test_the_covariance_is_symmetric_and_has_no_negative_eigenvalue():
    covariance = discrepancy(trials((1.0, 30.0, 10.0), (1.0, 30.02, 10.0), (4.0, 10.0, 0.0))).covariance
    assert covariance == pytest.approx(covariance.T)
    values = np.linalg.eigvalsh(covariance)
    assert values[0] > -1e-9 * values[-1]


@pytest.mark.parametrize("law_error", [0.00125, 0.0025, 0.02])
def test_the_prior_has_mass_one_and_the_law_the_stated_median(law_error):
    weights = log_prior(law_error)
    assert logsumexp(weights) == pytest.approx(0.0, abs=1e-12)
    of_law = np.exp(weights)[[size.own == OBEYS for size in SIZES]]
    below = [size.share < law_error for size in SIZES if size.own == OBEYS] @ of_law / of_law.sum()
    assert below == pytest.approx(0.5, abs=0.1)
    assert np.exp(weights)[[size.kind in LENGTHS for size in SIZES]].sum() == pytest.approx(0.2)


def test_marginal_products_agree_with_the_dense_covariance():
    law, rng = discrepancy(trials((1.0, 30.0, 10.0), (4.0, 10.0, 0.0))), np.random.default_rng(3)
    count = len(law.scale)
    root = rng.standard_normal((count, count)) / np.sqrt(count) + np.eye(count)
    known, columns = root @ root.T, rng.standard_normal((count, 5))
    found = Marginal.of(Modes(cholesky(known, lower=True), law), columns)
    for node in (0, 40, 300, 500, len(SIZES) - 1):
        dense = known + law.sized(found.sizes[node]).covariance
        assert found.products[node] == pytest.approx(columns.T @ np.linalg.solve(dense, columns), rel=1e-6, abs=1e-6)
        assert found.half_log_det[node] == pytest.approx(0.5 * np.linalg.slogdet(dense)[1], rel=1e-6)


def test_without_a_discrepancy_there_is_one_node_of_size_zero():
    rng = np.random.default_rng(4)
    known, columns = np.diag(rng.uniform(1.0, 2.0, 6)), rng.standard_normal((6, 3))
    found = Marginal.of(Modes(cholesky(known, lower=True), None), columns)
    assert found.products == pytest.approx((columns.T @ np.linalg.solve(known, columns))[None])


def test_what_the_best_parameters_leave_is_less_than_the_discrepancy():
    law = discrepancy(trials((1.0, 30.0, 10.0), (4.0, 10.0, 0.0)))
    tangent = law.scale[:, None] * np.random.default_rng(5).standard_normal((len(law.scale), 4))
    left = law.left_by_best(tangent)
    smooth = [k for k, size in enumerate(SIZES) if size.kind == "test"]
    shares = np.array([SIZES[k].share for k in smooth])
    assert np.all(left[smooth] < shares)
    assert law.left_by_best(1e-9 * tangent) == pytest.approx(left)
    assert np.all(left[smooth] > 0.8 * shares)


def test_the_fast_closed_form_is_that_of_ting():
    tip = Indenter("cone", half_angle=HALF_ANGLE)
    for protocol in trials((1.0, 30.0, 0.0), (4.0, 10.0, 20.0)):
        assert depth(SOLID, protocol, 400) == pytest.approx(ting.depth(SOLID, tip, protocol, 400), rel=3e-3, abs=0.5)


def fit_of(case, law_error):
    problem = Problem(case.conditions, recordings(case), BurgersSolid(case.conditions), SCALE)
    settings = CalibrationSettings(law_error=law_error, solver_error=0.0)
    start = MATERIAL.named(np.full(4, 0.5))
    return base_fit(problem, settings, [start], np.random.default_rng(1), lambda line: None)[1]


@pytest.fixture(scope="module")
def wrong():
    """A set of three tests and two replicates whose material creeps otherwise than the law."""
    numbers = range(8, 1000, 18)
    case = next(case for number in numbers for case in draw([number], 5) if case.misfit > 2e-3)
    return case, fit_of(case, 0.0025), fit_of(case, 0.0)


def test_a_law_that_is_wrong_has_wider_intervals_which_hold_the_modulus(wrong):
    case, fit, exact = wrong
    found, without = intervals(fit), intervals(exact)
    modulus = MATERIAL.free[0].scaled((1.0 - POISSON_RATIO**2) / case.truth.instantaneous)
    assert found.lower[0] < modulus < found.upper[0]
    assert found.upper[0] - found.lower[0] > without.upper[0] - without.lower[0]


def test_the_discrepancy_that_is_told_is_what_the_best_law_leaves(wrong):
    case, fit, exact = wrong
    found = law_discrepancy(fit)
    assert found["lower"] / 2 < case.misfit < 2 * found["upper"]
    assert law_discrepancy(exact) is None
    assert np.all(exact.law_share([0.1, 0.9]) == 0.0)


def test_a_single_recording_counts_as_few_independent_points():
    """A sample of a hundred errs as its neighbours do: (tr C)^2 / tr C^2 independent directions are left."""
    for protocol in (trapezoid(1.0, 30.0, 0.0, 30.0, points=100), trapezoid(1.0, 10.0, 60.0, 10.0, points=100)):
        law = discrepancy([protocol])
        relative = law.covariance / np.outer(law.scale, law.scale)
        independent = np.trace(relative) ** 2 / np.sum(relative**2)
        assert 2.0 < independent < 15.0


def test_wilsons_interval_holds_the_share():
    assert wilson(95, 100) == pytest.approx((0.8882, 0.9785), abs=1e-3)
    assert wilson(10, 10)[1] == pytest.approx(1.0)
