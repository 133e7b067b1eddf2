"""The studies of the thesis: they are found, their designs are what they say, and scaling laws hold in their maps."""

import datetime
import os
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import least_squares
from thesis_outcomes import OUTCOMES

from palpate.configuration.study_file import load_study
from palpate.errors import InputError
from palpate.output.figures.style import SMALLEST
from palpate.output.written_figures import write_figure
from palpate.solver.simulation import simulate, specification_from
from palpate.study.protocol import trapezoid
from palpate.surrogate.surrogates import Surrogates
from studies.thesis import DESIGNS, STUDIES, Curves, Finding, compute, optimisers
from studies.thesis import index as page
from studies.thesis.dimensionless import MODULUS, NAMES, groups
from studies.thesis.figures import FIGURES
from studies.thesis.fitted import Fitted
from studies.thesis.friction import reductions
from studies.thesis.identifiability import RANGES, deviations
from studies.thesis.kernels_as_printed import PRINTED, predict_as_printed
from studies.thesis.optimisers import OPTIMISERS, Finished, Problem
from studies.thesis.profiles import profile
from studies.thesis.rules import about, at_least, at_most, both, falling, near, rising
from studies.thesis.runs import Run
from studies.thesis.sobol_indices import total_indices

ROOT = Path(__file__).parents[2]
MATERIALS = ("aluminium", "epoxy")


@pytest.fixture(scope="module")
def studies():
    return {name: load_study(ROOT / f"config/thesis/{name}.yaml") for name in MATERIALS}


@pytest.mark.parametrize("key", STUDIES)
def test_every_study_names_designs_and_studies_that_exist(key):
    study = STUDIES[key]
    assert set(study.designs) <= set(DESIGNS)
    assert {name for design in study.designs for name in DESIGNS[design].after} <= set(STUDIES) - {key}
    assert set(study.recordings) <= set(MATERIALS)
    assert key in page.ORDER


@pytest.mark.parametrize(("design", "count"), [("aluminium_L16", 16), ("epoxy_L27", 108), ("epoxy_P1.00_T030", 288)])
def test_designs_have_the_size_of_the_thesis(design, count, studies):
    assert len(DESIGNS[design].runs(studies, {})) == count


def test_the_full_grid_has_64_points_and_27_cells(studies):
    roles = [run.labels["role"] for run in DESIGNS["aluminium_full"].runs(studies, {})]
    assert (roles.count("training"), roles.count("midpoint")) == (64, 27)


def test_l16_lies_on_the_full_grid(studies):
    def points(design):
        return {tuple(run.labels[n] for n in studies["aluminium"].levels) for run in DESIGNS[design].runs(studies, {})}

    assert points("aluminium_L16") <= points("aluminium_full")


def test_friction_is_run_or_refused_with_a_reason(studies):
    for run in DESIGNS["friction"].runs(studies, {}):
        assert (run.specification is None) == bool(run.reason)


def burgers(values, load, duration):
    return simulate(
        specification_from(
            {
                "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34, **values},
                "indenter": {"shape": "cone", "half_angle": 70.3},
                "protocol": trapezoid(load, duration, 0, duration, points=20),
                "kinematics": "small",
            }
        )
    ).depth


def test_materials_of_equal_groups_have_one_curve():
    """The solver itself obeys the scaling that the dimensionless surrogate rests on."""
    values = dict(zip(NAMES, (3.5, 0.03, 0.3, 0.3, 0.6, 0.4), strict=True))
    load, duration = 0.6, 90.0
    log_steady, m_s, log_transient, m_t, log_retardation = groups(np.array([list(values.values())]), np.array([90.0]))[
        0
    ]
    equal = (MODULUS, np.exp(log_steady), m_s, np.exp(log_transient), m_t, np.exp(log_retardation))
    reference = burgers(dict(zip(NAMES, map(float, equal), strict=True)), 1.0, 30.0)
    assert burgers(values, load, duration) == pytest.approx(reference * np.sqrt(load * MODULUS / 3.5), rel=2e-3)


def test_curves_come_from_the_store_the_second_time(tmp_path, studies):
    study = studies["epoxy"]
    run = Run({"condition": "P1.00_T030"}, study.specification(study.cells[0], study.condition("P1.00_T030")))
    refused = Run({"condition": "none"}, None, "not offered")
    first = compute([run, refused], tmp_path / "store", report=lambda line: None)
    files = {file: file.stat().st_mtime_ns for file in tmp_path.rglob("*.npz")}
    second = compute([run, refused], tmp_path / "store", report=lambda line: None)
    assert {file: file.stat().st_mtime_ns for file in tmp_path.rglob("*.npz")} == files
    assert np.array_equal(first.depth, second.depth, equal_nan=True)
    first.save(tmp_path / "design.npz")
    loaded = Curves.load_from(tmp_path / "design.npz")
    assert loaded.labels == first.labels
    assert loaded.reasons == ["", "not offered"]
    assert len(loaded.succeeded().labels) == 1
    assert loaded.max_depth[0] == loaded.depth[0, 49]


def test_printed_kernels_interpolate_one_mode_exactly():
    points = np.random.default_rng(1).random((12, 3))
    depth = np.outer(1 + points.sum(axis=1), np.linspace(1, 2, 7))
    for kernel in PRINTED:
        assert predict_as_printed(kernel, 0.5, points, depth, points) == pytest.approx(depth, rel=1e-6)


def test_what_no_test_informs_is_as_wide_as_anything():
    information = np.diag([1e6, 1e4, 0.0, 1.0, 1.0, 1.0, 1.0])
    width = deviations(information)
    assert width[:2] == pytest.approx([1.96e-3, 1.96e-2])
    assert width[2] > 1e6
    assert len(width) == len(RANGES)


def test_a_row_of_a_table_becomes_settings_and_metrics():
    fit = Fitted.row("one", "fit", {"kernel": "cubic", "error": 0.5, "snapshots": 3, "curve": [1.0], "none": None})
    assert (fit.settings, fit.metrics) == ({"kernel": "cubic"}, {"error": 0.5, "snapshots": 3.0})


class Product:
    """A surrogate whose curve is the product of two parameters."""

    def predict(self, x):
        return x[:, :1] * x[:, 1:]


def test_sobol_indices_of_a_product():
    """Exact: of the variance 7/144 each factor alone makes 3/144, and 1/144 is their interaction."""
    rows = total_indices(Product(), {"a": (0.0, 1.0), "b": (0.0, 1.0)}, np.array([1.0]), seed=1)
    for row in rows:
        assert row["depth_first_percent"] == pytest.approx(100 * 3 / 7, abs=1)
        assert row["depth_total_percent"] == pytest.approx(100 * 4 / 7, abs=1)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("maybe", "because", "rule"), "verdict"),
        (("reproduced", "because", ""), "rule"),
        (("differs", "", "rule"), "reason"),
    ],
)
def test_a_finding_has_a_known_verdict_a_rule_and_a_reason(given, message):
    verdict, why, rule = given
    with pytest.raises(InputError, match=message):
        Finding("a", "b", "c", verdict, why, rule)


def test_rules_hold_within_their_tolerance():
    assert near(99.8, 99.91, 0.2).holds
    assert not near(99.6, 99.91, 0.2).holds
    assert about([0.5, 3.6], 1, 1.8).holds
    assert not about(0.49, 1, 1.8).holds
    assert about(2, 1).statement == "within a factor of two: 0.5 to 2"
    assert rising([1, 2, 3]).holds
    assert not falling([1, 2, 2]).holds
    assert not both(at_least(3, 2), at_most(3, 2)).holds


def bent(points):
    """Residuals that vanish at (0.5, 0.5, 0.5), curved in the last parameter."""
    a, b, c = (points - 0.5).T
    return np.column_stack([4 * (a + b), 6 * (b - c), 3 * (c + c**2), 2 * a])


def test_profiles_are_those_of_a_search_for_each_value():
    start = np.full(3, 0.5)
    jacobian = np.array([[4.0, 4.0, 0.0], [0.0, 6.0, -6.0], [0.0, 0.0, 3.0], [2.0, 0.0, 0.0]])
    grid = np.array([0.1, 0.4, 0.5, 0.9])
    found = profile(start, jacobian, [grid] * 3, bent)
    for index in range(3):
        for value, chi in zip(grid, found[index], strict=True):

            def held(free, index=index, value=value):
                return bent(np.insert(free, index, value)[None])[0]

            best = least_squares(held, [0.5, 0.5], bounds=(0, 1))
            assert chi >= 2 * best.cost - 1e-6
            assert chi == pytest.approx(2 * best.cost, rel=0.05, abs=0.01)


def test_the_page_says_how_much_of_it_was_made_now(tmp_path):
    old, new = tmp_path / "old", tmp_path / "new"
    for file, time in ((old, 100.0), (new, 300.0)):
        file.touch()
        os.utime(file, (time, time))
    began, now = (datetime.datetime.fromtimestamp(time) for time in (200.0, 500.0))
    text = page.elapsed(began, now, [old, new])
    assert "5.0 minutes later; 1 of 2 files" in text


def test_the_page_shows_findings_and_effort(tmp_path):
    finding = {"what": "x", "thesis": "1 < 2", "here": "2", "rule": "3 +- 1", "verdict": "differs", "why": "because"}
    outcomes = {"friction": {"findings": [finding], "tables": {"t": [{"a": 1}]}, "seconds": 2.0} | OUTCOMES["friction"]}
    labels = [{"address": "one"}, {"address": "one"}, {"address": ""}]
    blank = np.full((3, 1), np.nan)
    curves = Curves(labels, blank, blank, blank, ["", "", "refused"])
    (picture,) = write_figure(FIGURES["friction"], outcomes["friction"], tmp_path / "friction", True)
    page.write(outcomes, {"friction": picture}, [curves], tmp_path / "index.html")
    text = (tmp_path / "index.html").read_text()
    assert "1 different curves" in text
    assert "2 s in the studies" in text
    assert "1 &lt; 2" in text
    assert (tmp_path / "friction.txt").read_text().strip() in text


def test_every_study_has_a_figure_of_its_name():
    assert list(FIGURES) == list(STUDIES) == list(OUTCOMES)


@pytest.mark.parametrize("key", FIGURES)
def test_a_figure_has_type_that_can_be_read_numbers_and_a_caption(key, tmp_path):
    figure, outcome = FIGURES[key], OUTCOMES[key]
    (file,) = write_figure(figure, outcome, tmp_path / key, True)
    drawn = file.read_text()
    assert min(float(size) for size in re.findall(r"<text [^>]*font-size: ([\d.]+)px", drawn)) >= SMALLEST - 0.01
    assert ("synthetic recordings" in drawn) != figure.of_study
    assert len(pd.read_csv(tmp_path / f"{key}.csv")) == len(figure.table(outcome))
    assert figure.seen(figure.table(outcome)).endswith(".") and (tmp_path / f"{key}.txt").read_text().count(".") > 0


def test_friction_is_measured_against_the_frictionless_curve_of_the_same_test():
    common = {"kinematics": "large", "max_load": 1.0, "loading_time": 30.0}
    labels, depth = [], []
    for name, scale in (("P1.00_T030", 1.0), ("P0.50_T030", 0.7)):
        for coefficient in (0.0, 0.5):
            labels.append({"condition": name, "friction": coefficient} | common)
            depth.append(scale * np.array([100.0, 200.0 * (1 - 0.02 * coefficient), 150.0 * (1 - 0.04 * coefficient)]))
    load = np.tile([0.5, 1.0, 0.0], (4, 1))
    curves = Curves(labels, load, load, np.array(depth), [""] * 4)
    rows = [row for row in reductions(curves) if row["friction"] == 0.5]
    assert [row["max_depth_reduction_percent"] for row in rows] == pytest.approx([1.0, 1.0])
    assert [row["residual_depth_reduction_percent"] for row in rows] == pytest.approx([2.0, 2.0])


class Bowl:
    """A surrogate whose curve is the parameters themselves."""

    def predict(self, x):
        return x


@pytest.mark.parametrize("optimiser", OPTIMISERS)
def test_every_optimiser_reaches_the_bottom_of_a_bowl_or_spends_its_budget(optimiser, monkeypatch):
    monkeypatch.setattr(optimisers, "BUDGET", 30000)
    model = Surrogates({"one": Bowl(), "two": Bowl()}, {"a": (0.0, 1.0), "b": (0.0, 2.0)})
    bottom = np.array([0.3, 1.4])
    problem = Problem(model, {"one": bottom, "two": bottom + 0.1}, least=0.005)
    with pytest.raises(Finished):
        OPTIMISERS[optimiser](problem, 1)
    assert problem.evaluations <= 30000 + 200
    assert problem.best < 0.005 * (1.001 if 0.001 in problem.reached else 1.1)
    counts = [problem.reached[excess][0] for excess in sorted(problem.reached, reverse=True)]
    assert counts == sorted(counts)
