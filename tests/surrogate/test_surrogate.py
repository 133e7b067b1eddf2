"""The POD-RBF surrogate: exact laws of interpolation, brute-force leave-one-out, scikit-learn's own checks."""

import itertools
import pickle
import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator
from scipy.spatial.distance import cdist
from scipy.stats import qmc
from sklearn.base import clone
from sklearn.utils.estimator_checks import estimator_checks_generator

from palpate.configuration.settings import SurrogateSettings
from palpate.errors import InputError, PalpateError
from palpate.surrogate import KERNELS, PODRBF, ConditionError
from palpate.surrogate.saved import load, save
from palpate.workflow_support import steps
from palpate.workflow_support.steps import checked_missing

T = np.linspace(0.0, 1.0, 40)


def grid(*levels):
    return np.array(list(itertools.product(*levels)))


def curves(X):
    """Smooth family with a held third parameter: depth [nm] over T."""
    e, c = X[:, [0]], X[:, [1]]
    return 500.0 * np.sqrt(T * 3.0 / e) * (1.0 + 4.0 * c * T) + 100.0 * np.exp(-8.0 * c) * T**2


X = grid(np.linspace(3.0, 3.5, 4), np.linspace(0.02, 0.1, 4), [0.34])
Y = curves(X)


@pytest.mark.parametrize("kernel", KERNELS)
def test_interpolates_its_snapshots(kernel):
    model = PODRBF(kernel, n_modes=8).fit(X, Y)
    assert np.abs(model.predict(X) - Y).max() < 1e-6 * Y.max()


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernel_formula_spans_scipys_interpolant(kernel):
    rng = np.random.default_rng(1)
    centres, data, query = rng.random((12, 2)), rng.random(12), rng.random((5, 2))
    phi, degree = KERNELS[kernel].formula, KERNELS[kernel].degree
    polynomial = np.hstack([np.ones((12, 1)), centres][: degree + 1])
    m = polynomial.shape[1]
    system = np.block([[phi(cdist(centres, centres), 0.7), polynomial], [polynomial.T, np.zeros((m, m))]])
    weights = np.linalg.solve(system, np.concatenate([data, np.zeros(m)]))
    ours = np.hstack([phi(cdist(query, centres), 0.7), np.ones((5, 1)), query][: degree + 2]) @ weights
    scipys = RBFInterpolator(centres, data, kernel=kernel, epsilon=1 / 0.7, degree=degree)(query)
    assert ours == pytest.approx(scipys, rel=1e-7)


@pytest.mark.parametrize("kernel", KERNELS)
def test_leave_one_out_equals_refits(kernel):
    model = PODRBF(kernel, n_modes=3).fit(X, Y)
    points = model._scale(X)
    coordinates = model.pod_.reduce(Y)
    for i in (0, 5, 10, 15):
        rest = np.delete(np.arange(len(X)), i)
        refit = RBFInterpolator(
            points[rest], coordinates[rest], kernel=kernel, epsilon=1.0, degree=KERNELS[kernel].degree
        )
        without = model.pod_.expand(refit(points[i : i + 1]))[0]
        assert model.loo_error_[i] == pytest.approx(Y[i] - without, abs=1e-6 * Y.max())


def test_unit_of_a_parameter_does_not_matter():
    factors = np.array([1e3, 1e-3, 7.0])
    query = np.array([[3.2, 0.05, 0.34]])
    assert PODRBF().fit(X * factors, Y).predict(query * factors) == pytest.approx(PODRBF().fit(X, Y).predict(query))


def test_error_between_the_snapshots_is_small_and_its_estimate_covers_it():
    rng = np.random.default_rng(0)
    query = np.column_stack([rng.uniform(3.0, 3.5, 50), rng.uniform(0.02, 0.1, 50), np.full(50, 0.34)])
    model = PODRBF().fit(X, Y)
    rms = np.sqrt(np.mean((model.predict(query) - curves(query)) ** 2))
    assert rms < 0.002 * Y.max()
    assert rms < np.sqrt(np.mean(model.loo_error_**2))


def test_chosen_shape_is_no_worse_than_the_default():
    chosen, default = PODRBF(shape="loo").fit(X, Y), PODRBF().fit(X, Y)
    assert np.mean(chosen.loo_error_**2) <= np.mean(default.loo_error_**2)


def test_a_length_for_each_parameter_tells_what_matters():
    """A curve that hardly depends on one of three parameters is learnt far better than with one length for all."""

    def curves(x):
        waves = np.outer(np.sin(4.0 * x[:, 0]) * np.cos(3.0 * x[:, 1]), np.linspace(1.0, 2.0, 8))
        return waves + np.outer(x[:, 0] ** 2 + 0.01 * x[:, 2], np.linspace(3.0, 1.0, 8) ** 2)

    points, query = qmc.Sobol(3, seed=1).random(64), np.random.default_rng(0).random((200, 3))
    one, each = (PODRBF(shape=shape).fit(points, curves(points)) for shape in ("loo", "loo_each"))
    assert each.lengths_[2] > 5.0 * each.lengths_[:2].max()
    assert np.mean(each.loo_error_**2) < 0.25 * np.mean(one.loo_error_**2)
    error, usual = (np.mean((model.predict(query) - curves(query)) ** 2) for model in (each, one))
    assert error < 0.25 * usual


def test_energy_keeps_as_few_modes_as_it_says():
    model = PODRBF(energy=0.9999).fit(X, Y)
    assert model.energy_[model.n_modes_ - 1] >= 0.9999
    assert model.n_modes_ == 1 or model.energy_[model.n_modes_ - 2] < 0.9999
    assert PODRBF(n_modes=2).fit(X, Y).n_modes_ == 2


def test_jacobian_is_the_slope_of_the_prediction():
    model, x = PODRBF().fit(X, Y), np.array([3.21, 0.047, 0.34])
    slope = model.jacobian(x)
    for j, h in enumerate((1e-3, 1e-4)):
        step = np.eye(3)[j] * h
        expected = (model.predict([x + step]) - model.predict([x - step]))[0] / (2 * h)
        assert slope[:, j] == pytest.approx(expected, rel=1e-3, abs=1e-3)
    assert not slope[:, 2].any()


def test_bad_conditioning_is_an_error_with_a_remedy():
    with pytest.raises(ConditionError, match="use a smaller shape") as caught:
        PODRBF("gaussian", shape=50.0).fit(X, Y)
    assert caught.value.condition_number > caught.value.limit
    with pytest.raises(ConditionError):
        PODRBF().fit(np.vstack([X, X[:1]]), np.vstack([Y, Y[:1]]))


@pytest.mark.parametrize(
    "bad", [{"kernel": "spline"}, {"shape": -1.0}, {"shape": "best"}, {"energy": 0.0}, {"n_modes": 0}]
)
def test_bad_settings_name_their_key(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        PODRBF(**bad).fit(X, Y)


def test_no_varying_parameter_is_refused():
    with pytest.raises(InputError, match="no parameter varies"):
        PODRBF().fit(np.ones((3, 2)), np.ones((3, 5)))


def test_points_outside_the_snapshots_are_told():
    model = PODRBF("cubic").fit(X, Y)
    with pytest.warns(UserWarning, match="1 of 2 points lie outside"):
        model.predict([model.upper_, 1.1 * model.upper_])


def test_clones_refits_and_pickles():
    model = PODRBF("cubic", n_modes=4).fit(X, Y)
    assert clone(model).get_params() == model.get_params()
    again = pickle.loads(pickle.dumps(model))
    assert np.array_equal(again.predict(X[:3]), model.predict(X[:3]))
    refit = PODRBF(shape="loo").fit(X, Y).fit(X, 2.0 * Y)
    assert refit.predict(X) == pytest.approx(2.0 * Y, rel=1e-3, abs=1.0)


CHECKS = estimator_checks_generator(
    PODRBF("linear"), expected_failed_checks={"check_positive_only_tag_during_fit": "repeats a snapshot"}, mark="skip"
)


@pytest.mark.parametrize(("estimator", "check"), list(CHECKS))
def test_scikit_learn_contract(estimator, check):
    check(estimator)


def test_points_of_no_depth_do_not_count_in_the_relative_error():
    """An elastic body's depth is back at zero in the end, to rounding."""
    modulus = np.geomspace(2.0, 8.0, 7)[:, None]
    curves = 500.0 * np.sqrt(np.append(np.linspace(0.1, 1.0, 10), 0.0) / modulus)
    curves[:, -1] = -4e-14
    contents = [
        {"quantity": "depth", "status": "ok", "parameters": {"modulus": value}, "depth": curve}
        for value, curve in zip(modulus[:, 0], curves, strict=True)
    ]
    study = SimpleNamespace(levels={"modulus": modulus[:, 0]}, surrogate=SurrogateSettings())
    model, _, _, summary = steps.fit_surrogate(study, "one", contents)
    relative = (model.loo_error_ / curves)[:, :-1]
    assert summary["loo_relative_percent"] == pytest.approx(100 * np.sqrt(np.mean(relative**2, axis=0)).mean())


def test_the_relative_error_of_a_case_done_by_hand():
    curves = np.array([[100.0, 200.0, 0.0], [50.0, 400.0, 3.0]])
    error = np.array([[1.0, 4.0, 9.0], [1.0, 4.0, 9.0]])
    by_point = np.sqrt([(0.01**2 + 0.02**2) / 2, (0.02**2 + 0.01**2) / 2])
    assert steps.relative_percent(error, curves) == pytest.approx(100 * by_point.mean())


@pytest.mark.parametrize(
    ("lost", "said"),
    [
        (lambda e, m: e > 0, "16 of 20 snapshots failed"),
        (lambda e, m: (e == 4) & (m > 0), "3 of 20 snapshots failed, 75 % of those at the upper end of modulus"),
    ],
)
def test_a_surrogate_is_not_fitted_where_too_many_snapshots_failed(lost, said):
    modulus, fluidity = (grid.ravel() for grid in np.meshgrid(np.arange(5), np.arange(4)))
    cells = [{"modulus": float(e), "fluidity": float(m)} for e, m in zip(modulus, fluidity, strict=True)]
    with pytest.raises(PalpateError, match=re.escape(said)):
        checked_missing("T030", cells, lost(modulus, fluidity))


def test_a_few_failed_snapshots_are_said():
    cells = [{"modulus": float(value)} for value in range(20)]
    failed = [value == 19 for value in range(20)]
    told = checked_missing("T030", cells, failed)
    assert told == "T030: 1 of 20 snapshots failed, 25 % of those at the upper end of modulus."
    assert checked_missing("T030", cells, [False] * 20) == ""


@pytest.mark.faults(before="unpickled, whatever it held; a traceback")
def test_a_saved_surrogate_comes_back_and_a_damaged_one_is_named(tmp_path):
    x, y = np.linspace(0.0, 1.0, 6)[:, None], np.outer(np.linspace(1.0, 2.0, 6) ** 2, [1.0, 2.0])
    model, file = PODRBF(shape="loo").fit(x, y), tmp_path / "surrogate.npz"
    save(model, x, y, file)
    assert load(file).predict([[0.33]]) == pytest.approx(model.predict([[0.33]]), rel=1e-12)
    whole = file.read_bytes()
    method = whole.rindex(b"PK\1\2") + 10  # how an array is compressed
    altered = (whole[:place] + b"?" + whole[place + 1 :] for place in (300, method))
    for damaged in (whole[: len(whole) // 2], b"", *altered):
        file.write_bytes(damaged)
        with pytest.raises(PalpateError, match="holds no surrogate that can be read; delete it"):
            load(file)


@pytest.mark.parametrize("dimensions", [1, 2])
def test_many_snapshots_of_few_parameters_are_interpolated(dimensions):
    """As of a drafted elastic study: 128 points on one line."""
    points = qmc.Sobol(dimensions, seed=1).random_base2(7)
    curves = np.outer(1.0 / np.sqrt(1.0 + points.sum(axis=1)), [1.0, 2.0])
    model = PODRBF(shape="loo")
    model.check_points(points)
    middle = np.full((1, dimensions), 0.5)
    assert model.fit(points, curves).predict(middle)[0, 0] == pytest.approx(
        1.0 / np.sqrt(1.0 + 0.5 * dimensions), rel=1e-5
    )
