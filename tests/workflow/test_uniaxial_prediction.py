"""What a calibrated law predicts of uniaxial tests, and where results show it."""

from dataclasses import replace

import numpy as np
import pytest
import results_of

from indentation_files.uniaxial_test import UniaxialTest
from palpate.data.bulk_tests import BulkTest
from palpate.errors import InputError
from palpate.inference.bulk_prediction import predicted
from palpate.models.bulk_model import BulkModel
from palpate.output.figures.catalogue import FIGURES
from palpate.output.results.answer import Answer
from palpate.output.results.bulk_errors import bulk_metrics
from palpate.output.results.calibration import Calibration
from palpate.workflow_support.run_records import calibration_metrics

TIME = np.linspace(0.0, 60.0, 121)
E = 3.0


def elastic_test(noise=0.0, offset=0.0, control="strain"):
    """A bar of modulus 3 GPa, whose load cell is off by a constant."""
    strain = 0.02 * TIME / 60.0
    stress = E * strain + offset + noise * np.random.default_rng(0).standard_normal(len(TIME))
    return BulkTest(UniaxialTest(TIME, strain, stress, "bar"), "validate", control)


def of(test, estimate=E, draws=(2.9, 3.1), flow=None, model="elastic"):
    bulk = BulkModel(model, {"poisson_ratio": 0.3} | (flow or {}), (test,))
    values = [{"youngs_modulus": value} for value in draws]
    return predicted(bulk, {"youngs_modulus": estimate}, values, 0.95)["bar"]


def test_errors_are_those_of_the_response_in_its_own_unit():
    found = of(elastic_test(), 3.3)
    share = np.sqrt(np.mean((TIME / 60.0) ** 2))
    assert found["rmse_GPa"] == pytest.approx(0.3 * 0.02 * share)
    assert found["percent_error"] == pytest.approx(10.0 * share)
    stress = of(elastic_test(control="stress"), 3.3)
    assert stress["rmse_strain"] == pytest.approx(0.02 * (1.0 - 3.0 / 3.3) * share)


def test_the_band_is_that_of_the_parameters():
    """Uniform draws of the modulus between 2 and 4 GPa: 95 % of them lie between 2.05 and 3.95."""
    found = of(elastic_test(), draws=np.linspace(2.0, 4.0, 2001))
    assert found["curve"]["lower"][-1] == pytest.approx(2.05 * 0.02, rel=2e-3)
    assert found["curve"]["upper"][-1] == pytest.approx(3.95 * 0.02, rel=2e-3)


def test_noise_alone_leaves_the_points_in_the_band_and_an_offset_does_not():
    noisy, off = (of(elastic_test(2e-4, offset), draws=(2.999, 3.001)) for offset in (0.0, 2e-3))
    assert noisy["rmse_GPa"] == pytest.approx(2e-4, rel=0.2) and noisy["noise_GPa"] == pytest.approx(2e-4, rel=0.3)
    assert noisy["within_band"] > 0.9 and off["within_band"] < 0.05


def test_a_stress_that_the_law_does_not_bear_counts_as_far_as_it_does():
    """Yielding at 0.03 GPa without hardening: half of a test to 0.06 GPa under stress control."""
    perfect = {"yield_stress": 0.03, "hardening": 0.0}
    found = of(elastic_test(control="stress"), flow=perfect, model="bilinear_plasticity", draws=(3.0, 3.0))
    assert found["borne"] == pytest.approx(0.5, abs=0.02)
    assert found["rmse_strain"] < 1e-9 and found["curve"]["predicted"][-1] is None


@pytest.fixture
def saved(tmp_path):
    """Saved results with two uniaxial tests: one predicted, one fitted and under a prescribed stress."""
    crept = elastic_test(control="stress")
    other = BulkTest(replace(crept.test, name="creep"), "calibrate", "stress")
    bulk = BulkModel("elastic", {"poisson_ratio": 0.3}, (elastic_test(1e-4), other))
    found = predicted(bulk, {"youngs_modulus": 3.3}, [{"youngs_modulus": value} for value in (3.2, 3.4)], 0.95)
    content = results_of.calibration() | {"uniaxial": found}
    return replace(results_of.saved(tmp_path), calibrations={"all": content})


def test_results_show_the_tests_wherever_they_show_the_depth(saved):
    answer, calibration = Answer(saved), Calibration(saved)
    text = "bar: 0.0035 GPa, 5.8 % of the largest stress; creep: 0.0011, 5.3 % of the largest strain (fitted)"
    assert dict(answer.facts())["Uniaxial tests of the bulk"] == text
    assert f"bulk        {text}" in answer.lines()
    assert "curve" not in answer.to_mapping()["uniaxial"]["bar"]
    assert "Uniaxial test bar, predicted: root mean square error of the stress 0.0035 GPa" in calibration.summary()
    table = calibration.tables()[-1]
    assert list(table["test"]) == ["bar", "creep"] and list(table["rmse"]) == ["0.0035 GPa", "0.0011"]
    assert len(calibration.plot_uniaxial()) == 2


def test_runs_hold_the_errors_by_plain_keys(saved):
    metrics = calibration_metrics(saved.calibrations["all"])
    assert metrics["uniaxial.bar.rmse_GPa"] == pytest.approx(0.3 * 0.02 / np.sqrt(3.0), rel=0.02)
    assert "uniaxial.creep.rmse_strain" in metrics and bulk_metrics({}) == {}


def test_the_figure_holds_what_is_drawn(saved, tmp_path):
    figure = FIGURES["uniaxial"]
    numbers = figure.table(saved)
    assert list(numbers["test"].unique()) == ["bar", "creep"]
    np.testing.assert_allclose(numbers["predicted"][numbers["test"] == "bar"], 3.3 * 0.02 * TIME / 60.0, rtol=1e-5)
    assert "creep took part in the calibration" in figure.caption(numbers)
    assert figure.seen(numbers).startswith("bar: root mean square error 5.8 % of the largest stress;")


def test_a_study_without_such_tests_shows_none(tmp_path):
    saved = results_of.saved(tmp_path)
    assert FIGURES["uniaxial"].table(saved) is None
    assert "Uniaxial tests of the bulk" not in dict(Answer(saved).facts())
    with pytest.raises(InputError, match="no uniaxial test"):
        Calibration(saved).plot_uniaxial()
