"""Error of the mesh and of few samples in a diagnosis: a fast model in place of that of record, near a place."""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from closed_forms import ClosedForms
from diagnosis_problem import CONDITIONS, RECORD_ONLY, fitted, problem, recordings, search_of

from palpate.configuration.study_file import load_study
from palpate.inference.covariance import REFINED, errors, noise_of
from palpate.mechanisms import MECHANISMS
from palpate.models import body_model
from palpate.models.anchors import Anchor
from palpate.models.fidelity import COARSE, kept
from palpate.models.finite_elements import FiniteElements
from palpate.solver.simulation import simulate
from palpate.solver.study_scale import middle, scale_of
from palpate.study.protocol import Protocol

CHALLENGE = Path(__file__).parents[2] / "config" / "challenge.yaml"
STUDY = {
    "study": "refined",
    "points": 16,
    "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34},
    "parameters": {
        "youngs_modulus": [2.6, 3.3, 4.0],
        "steady_coefficient": [0.06],
        "steady_exponent": [0.2],
        "transient_coefficient": [0.25],
        "transient_exponent": [0.3],
        "retardation_time": [0.25],
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "T010", "max_load": 1.0, "loading_time": 10, "unloading_time": 10}],
}
HELD_OUT = {
    "name": "V010",
    "max_load": 2.0,
    "loading_time": 10,
    "hold_time": 5,
    "unloading_time": 10,
    "role": "validate",
}


def loaded(folder, **changes):
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY | changes))
    return load_study(folder / "study.yaml")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    conditions = [*STUDY["conditions"], HELD_OUT]
    return loaded(tmp_path_factory.mktemp("refined"), conditions=conditions)


@pytest.fixture(scope="module")
def plain(study):
    """Return the finite elements under the test that takes part."""
    return FiniteElements.of(study, ["T010"])


@pytest.fixture(scope="module")
def record(study, plain):
    """Return the model of record, which is known at the middle material."""
    return plain.reanchored(plain.coordinates.scaled(middle(study)))


def on_fine_mesh(model, u, condition, accuracy="medium"):
    return simulate(replace(model.specification(u, condition), accuracy=accuracy)).depth


def history(time):
    """Return a load that grows until the last of some times."""
    return Protocol(np.array([0.0, time[-1]]), np.array([0.0, 1.0]), time)


def off_where_loaded(depth, true, condition):
    """Return the root mean square of the relative error where the body is loaded."""
    loaded = condition.protocol.sample_load > 0.05 * condition.protocol.max_load
    return np.sqrt(np.mean((depth / true - 1.0)[loaded] ** 2))


@pytest.mark.slow
def test_at_the_place_curves_are_those_of_the_model_of_record(study, plain, record):
    """Under the test that takes part, and under the one that was held out."""
    u = plain.coordinates.scaled(middle(study))
    for condition in study.conditions:
        usual, found = (model.under([condition.name]).curves([u])[0][condition.name] for model in (plain, record))
        true = on_fine_mesh(plain, u, condition)
        assert found == pytest.approx(true, rel=1e-9, abs=1e-4)
        assert off_where_loaded(usual, true, condition) > 5e-4, "the usual mesh errs"


@pytest.mark.parametrize("modulus", [3.0, 3.7])
@pytest.mark.slow
def test_it_serves_another_material_nearby(tmp_path, modulus):
    """To a quarter of what the usual mesh errs by itself, though it has fewer samples and hence longer steps."""
    study = loaded(tmp_path, points=100)
    plain = FiniteElements.of(study, ["T010"])
    record = plain.reanchored(plain.coordinates.scaled(middle(study)))
    (condition,) = plain.conditions
    u = plain.coordinates.scaled(middle(study) | {"youngs_modulus": modulus})
    usual, found = (model.curves([u])[0]["T010"] for model in (plain, record))
    true = on_fine_mesh(plain, u, condition)
    assert off_where_loaded(found, true, condition) < 0.25 * off_where_loaded(usual, true, condition)


@pytest.mark.parametrize("share", [0.35, 0.8])
@pytest.mark.slow
def test_the_base_models_curves_serve_a_body_that_yields(study, plain, record, share):
    """Of another modulus, too: within the error of grid convergence, which the study states."""
    (condition,) = plain.conditions
    yielding = record.joined([MECHANISMS["plastic_yield"]], scale_of(study))
    u = np.append(plain.coordinates.scaled(middle(study) | {"youngs_modulus": 3.7}), [share, 0.6])
    (found,) = yielding.curves([u])
    true = on_fine_mesh(yielding, u, condition)
    assert off_where_loaded(found["T010"], true, condition) < study.calibration.solver_error


@pytest.mark.slow
def test_what_creeps_needs_no_derivatives_of_a_finer_mesh(record):
    assert record.extrapolated(record.anchors.point) is None


@pytest.mark.slow
def test_curves_of_finer_meshes_serve_there_and_elsewhere(tmp_path):
    """Measured by `finest`, which no fit uses."""
    study = loaded(tmp_path, points=60)
    plain = FiniteElements.of(study, ["T010"])
    here, elsewhere = (plain.coordinates.scaled(middle(study) | {"youngs_modulus": value}) for value in (3.2, 3.9))
    (condition,), record = plain.conditions, plain.reanchored(here)
    refined = record.refined(here)
    for u, usual, finer in (
        (here, record, refined),
        (elsewhere, record.reanchored(elsewhere), refined.reanchored(elsewhere)),
    ):
        true = on_fine_mesh(plain, u, condition, "finest")
        before, after = (off_where_loaded(each.curves([u])[0]["T010"], true, condition) for each in (usual, finer))
        assert after < 0.6 * before
    assert refined.refined(here) is None


@pytest.mark.slow
def test_where_the_edge_of_contact_matters_curves_are_refined_with_their_derivatives(study, record):
    yielding = record.joined([MECHANISMS["plastic_yield"]], scale_of(study))
    assert yielding.refined(np.append(record.anchors.point, [0.3, 0.2])) is None


@pytest.mark.parametrize(
    ("key", "amplitudes"),
    [
        ("plastic_yield", ([0.3, 0.2], [0.3, 0.3])),
        ("friction", ([0.4], [0.5])),
        ("adhesion", ([0.4], [0.5])),
    ],
)
@pytest.mark.slow
def test_what_depends_on_the_edge_of_contact_changes_curves_as_on_a_finer_mesh(tmp_path, key, amplitudes):
    """The usual mesh errs by a visible part of what the amplitude changes."""
    study = loaded(tmp_path, points=60)
    plain = FiniteElements.of(study, ["T010"])
    (condition,), body = plain.conditions, plain.coordinates.scaled(middle(study))
    model = plain.joined([MECHANISMS[key]], scale_of(study))
    places = [np.append(body, values) for values in amplitudes]
    true = [on_fine_mesh(model, u, condition, "fine") for u in places]
    usual = model.reanchored(places[0])
    finer, there, slopes = usual.extrapolated(places[0])
    found = finer.consistent(places[0], there, slopes)
    assert found.curves(places[:1])[0]["T010"] == pytest.approx(there["T010"], rel=1e-5)
    medium = on_fine_mesh(model, places[0], condition)
    assert off_where_loaded(there["T010"], 2.0 * true[0] - medium, condition) < 3e-4
    off = [np.subtract(*(curves["T010"] for curves in each.curves(places)[::-1])) for each in (model, found)]
    missed = [float(np.sqrt(np.mean((each - (true[1] - true[0])) ** 2))) for each in off]
    assert missed[1] < 0.5 * missed[0]


@pytest.mark.slow
def test_a_held_out_test_like_a_fitted_one_has_its_curve_where_a_fit_ended_on_finer_meshes(tmp_path):
    """One fast model serves both, and both hold what finer meshes add to the accurate one."""
    (fitted_test,) = STUDY["conditions"]
    study = loaded(tmp_path, conditions=[fitted_test, fitted_test | {"name": "AGAIN", "role": "validate"}])
    plain = FiniteElements.of(study, ["T010"])
    model = plain.joined([MECHANISMS["friction"]], scale_of(study))
    u = np.append(plain.coordinates.scaled(middle(study)), 0.4)
    finer, there, slopes = model.reanchored(u).extrapolated(u)
    (curves,) = finer.consistent(u, there, slopes).under(["AGAIN"]).curves([u])
    of_fitted, accurate = there["T010"], on_fine_mesh(model, u, study.condition("AGAIN"))
    assert np.abs(curves["AGAIN"] - of_fitted).max() < 0.1 * np.abs(accurate - of_fitted).max()


@pytest.mark.slow
def test_the_curves_at_one_lag_serve_another(tmp_path):
    """From the first sample on, where the load comes late by half of what it lasts."""
    study = loaded(tmp_path, points=100)
    plain = FiniteElements.of(study, ["T010"]).joined([MECHANISMS["controller_lag"]], scale_of(study))
    body = plain.coordinates.scaled(middle(study) | {"controller_lag.lag": 0.1})[:-1]
    lags = [np.append(body, lag) for lag in (0.11, 0.09)]
    (condition,) = plain.conditions
    (found,) = plain.reanchored(lags[0]).curves([lags[1]])
    assert found["T010"] == pytest.approx(on_fine_mesh(plain, lags[1], condition), abs=1e-3 * found["T010"].max())


@pytest.mark.slow
def test_what_the_refinement_changed_is_known_at_all_samples(plain, record):
    anchor, keep = record.anchors.of["T010"], kept(plain.conditions[0].protocol)
    changed = record.refinements["T010"]
    (usual,) = replace(plain, level=COARSE).curves([record.anchors.point])
    assert changed[keep] == pytest.approx(anchor.accurate[keep] - usual["T010"])
    assert np.abs(changed).max() < 0.01 * anchor.accurate.max()
    assert plain.refinements == {}


class Refined(ClosedForms):
    """Its refinement changed the depth by 5 nm under one condition and by 2 nm under another."""

    @property
    def refinements(self):
        changes = {"a": 5.0, "b": 2.0}
        return {c.name: np.full(len(c.protocol.sample_time), changes.get(c.name, 0.0)) for c in self.conditions}


def test_curves_may_err_by_what_the_refinement_changed():
    """A part of it under all conditions alike, and half of that part under each alone; none if the solver is exact."""
    task = replace(problem(recordings(np.random.default_rng(1))), forward=Refined(CONDITIONS))
    noise = noise_of(task, (), task.mean, 0.01)
    found, exact = (errors(task, task.forward, (), task.mean, noise, solver) for solver in (1e-9, 0.0))
    assert not np.any(exact.refinements)
    parts = {name: np.zeros(len(item.mean)) for name, item in task.observed.items()}
    for of_b, chi_square in ((2.0, 2.0 / 2.25), (-2.0, 2.0 / 0.25)):
        off = REFINED * task.stacked(parts | {"a": np.full(len(parts["a"]), 5.0), "b": np.full(len(parts["b"]), of_b)})
        cost = off @ np.linalg.solve(found.shared + 1e-6 * np.eye(len(off)), off)
        assert cost == pytest.approx(chi_square, rel=1e-3)


def test_where_a_body_is_unloaded_no_mesh_errs():
    """Nor does the rounding of a depth that is none count as a ratio."""
    accurate, fast = np.array([2.02, 1.01, 1e-14]), np.array([2.0, 1.0, -4e-15])
    found = Anchor(accurate, fast, np.zeros(3)).scaled(np.array([3.0, 1.4, 8e-15]), history(np.array([1.0, 2.0, 3.0])))
    assert found == pytest.approx([3.03, 1.414, 0.0], abs=1e-12)


def test_what_a_change_makes_of_a_curve_is_told_by_few_samples():
    """It varies slowly in time, the curve itself does not; so it is with several columns at once."""
    time = np.arange(1.0, 13.0, 0.1)
    keep = kept(history(time))
    assert keep.sum() < 0.4 * len(time)
    accurate = np.sqrt(time) * (1.0 + 0.01 * np.sin(time))
    anchor = Anchor(accurate, np.sqrt(time)[keep], np.zeros(len(time)))
    columns = np.stack([np.sqrt(time) * (1.1 + 0.02 * time), 3.0 * np.sqrt(time)], axis=1)
    expected = accurate[:, None] * np.stack([1.1 + 0.02 * time, np.full(len(time), 3.0)], axis=1)
    assert anchor.scaled(columns[keep], history(time)) == pytest.approx(expected)
    assert anchor.scaled(columns[keep, 0], history(time)) == pytest.approx(expected[:, 0])


@pytest.mark.slow
def test_the_mesh_errs_by_the_bodys_depth_not_by_what_the_instrument_adds(study, plain, record):
    """In curves and slopes, wherever the model of record is known: with the instrument's effects, or without."""
    scale, load = scale_of(study), plain.conditions[0].protocol.sample_load
    base = plain.coordinates.scaled(middle(study) | {"youngs_modulus": 3.5})
    ((body, slopes),) = record.tangents([base])
    instrument = [MECHANISMS[key] for key in ("zero_offset", "frame_compliance")]
    u = np.append(base, [0.9, 0.4])
    model = record.joined(instrument, scale)
    values = model.amplitudes(u)
    added = values["zero_offset"]["offset"] + values["frame_compliance"]["compliance"] * load
    ((curves, found),) = model.tangents([u])
    assert curves["T010"] - added == pytest.approx(body["T010"], rel=1e-6)
    assert found["T010"][:, :1] == pytest.approx(slopes["T010"], rel=1e-6, abs=1e-4)
    by_amplitudes = [model.coordinates.free[number].slope(u[number]) for number in (1, 2)]
    assert found["T010"][:, 1] == pytest.approx(np.full_like(load, by_amplitudes[0]))
    assert found["T010"][:, 2] == pytest.approx(by_amplitudes[1] * load, abs=1e-6)
    (alone,) = model.curves([u])
    assert alone["T010"] == pytest.approx(curves["T010"], rel=1e-6)
    (there,) = plain.joined(instrument, scale).reanchored(u).curves([u])
    true = on_fine_mesh(plain.joined(instrument, scale), u, plain.conditions[0])
    assert there["T010"] == pytest.approx(true, rel=1e-9, abs=1e-4)


@pytest.mark.slow
def test_slopes_are_those_of_the_curves(study, record):
    """With what the instrument adds, over a step that is a hundred times that of the neighbours."""
    model = record.joined([MECHANISMS["frame_compliance"]], scale_of(study))
    u, step = np.append(record.coordinates.scaled(middle(study)), 0.4), 3e-3
    ends = model.curves([u + side * row for row in step * np.eye(2) for side in (1.0, -1.0)])
    differences = [(a["T010"] - b["T010"]) / (2.0 * step) for a, b in zip(ends[::2], ends[1::2], strict=True)]
    ((_, slopes),) = model.tangents([u])
    for slope, difference in zip(slopes["T010"].T, differences, strict=True):
        assert slope == pytest.approx(difference, abs=0.01 * np.abs(difference).max())


@pytest.mark.slow
def test_a_condition_under_which_the_model_of_record_fails_is_left_to_the_usual_mesh(study, plain, monkeypatch):
    def failing(specifications, few_sectors):
        return [
            replace(outcome, status="failed") if each.accuracy == "medium" and outcome.load.max() > 1.5 else outcome
            for each, outcome in zip(specifications, simulate_batch(specifications, 0.0, few_sectors), strict=True)
        ]

    u, simulate_batch = plain.coordinates.scaled(middle(study)), body_model.simulate_batch
    monkeypatch.setattr(body_model, "simulate_batch", failing)
    found = plain.reanchored(u)
    usual, same = (model.under(["V010"]).curves([u])[0]["V010"] for model in (plain, found))
    assert same == pytest.approx(usual)
    better = found.under(["T010"]).curves([u])[0]["T010"]
    assert better == pytest.approx(on_fine_mesh(plain, u, plain.conditions[0]), rel=1e-9, abs=1e-4)


@pytest.mark.parametrize(("key", "own", "within"), [("second_voigt", 3, 0.01), ("plastic_yield", 2, 0.05)])
@pytest.mark.slow
def test_changes_by_some_of_the_points_are_those_of_all(key, own, within):
    """Of the model of record: the errors of mesh and steps cancel in them."""
    study = load_study(CHALLENGE)
    condition = study.conditions[0]
    usual = FiniteElements.of(study, [condition.name]).joined([MECHANISMS[key]], scale_of(study))
    at = np.full(len(usual.coordinates.free), 0.4)
    place = at + np.append([0.1, -0.1, 0.05, 0.1], np.full(own, 0.1))
    there, here = (on_fine_mesh(usual, u, condition) for u in (place, at))
    moved, before = (curves[condition.name] for curves in usual.reanchored(at).curves([place, at]))
    assert moved - before == pytest.approx(there - here, abs=within * np.abs(there - here).max())


@pytest.mark.slow
def test_a_body_that_no_mesh_holds_fails_and_leaves_others(study, plain):
    """A film that is thinner than an element, asked for together with a thick one."""
    model = plain.joined([MECHANISMS["film_on_substrate"]], scale_of(study))
    body = plain.coordinates.scaled(middle(study))
    thin, thick = model.curves([np.append(body, [share, 0.5]) for share in (-1.0, 0.5)])
    assert "less than an element" in thin
    assert np.isfinite(thick["T010"]).all()


@dataclass(frozen=True, eq=False)
class Counting(ClosedForms):
    """Notes of which parameters the model of record was asked for."""

    asked: list = field(default_factory=list)

    def reanchored(self, u):
        self.asked.append(self.coordinates.names)
        return self


def test_only_what_may_pass_is_brought_to_the_model_of_record():
    """And the base model, on which effects are screened."""
    planted = recordings(np.random.default_rng(1), lambda c, r: 10.0 * np.sin(c.protocol.sample_time))
    hopeless, quiet = Counting(CONDITIONS), Counting(CONDITIONS)
    search = search_of(replace(problem(planted), forward=hopeless))
    for key in RECORD_ONLY:
        search.joined(search.base.fit, key)
    fitted(replace(problem(recordings(np.random.default_rng(1))), forward=quiet), ("thermal_drift",))
    base = ["modulus", "fluidity"]
    assert hopeless.asked and all(names == base for names in hopeless.asked)
    assert quiet.asked[0] == base and quiet.asked[-1] == [*base, "thermal_drift.rate"]
