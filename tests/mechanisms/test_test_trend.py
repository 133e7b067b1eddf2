"""A trend over the order of the recordings: read from their numbers, named, and refused without."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from closed_forms import TRUTH, cone
from diagnosis_problem import CONDITIONS, RECORD_ONLY, SCALE, problem, recordings, search_of
from elastic_study import SETTINGS, measured

from palpate.configuration.settings import LaboratorySettings
from palpate.configuration.study_file import load_study
from palpate.data.observation import in_order
from palpate.data.study_recordings import check_tests, resampled
from palpate.diagnosis.diagnose import diagnose
from palpate.errors import InputError
from palpate.inference.problem import Problem
from palpate.laboratory import virtual
from palpate.mechanisms import MECHANISMS

KEY, RATE = "test_trend", 0.005
TWO = [
    {"name": name, "max_load": 2.0, "loading_time": 20, "hold_time": hold, "unloading_time": 20}
    for name, hold in (("A", 10), ("B", 0))
]


def study(tmp_path, **changes):
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(SETTINGS | {"diagnosis": {"mechanisms": [KEY]}} | changes))
    return load_study(tmp_path / "study.yaml")


def test_conditions_know_when_their_tests_were_made():
    """Each in tests since the mean recording; without numbers an effect counts once."""
    observed = recordings(np.random.default_rng(1))
    for (name, item), number in zip(observed.items(), (2.0, 5.0, 8.0, 11.0), strict=True):
        observed[name] = replace(item, order=number)
    assert [each.order for each in in_order(CONDITIONS, observed)] == pytest.approx([-4.5, -1.5, 1.5, 4.5])
    unknown = {name: replace(item, order=np.nan) for name, item in observed.items()}
    assert [each.order for each in in_order(CONDITIONS, unknown)] == [each.order for each in CONDITIONS]


def test_a_number_is_read_and_a_recording_without_is_refused(tmp_path):
    told, silent = (replace(measured(seed=k), notes=notes) for k, notes in ((1, ("test_number: 7",)), (2, ())))
    small = study(tmp_path)
    assert resampled(small, check_tests(small, {"A": [told]}))["A"].order == 7.0
    with pytest.raises(InputError, match="does not say when it was made"):
        check_tests(small, {"A": [told, silent]})


def test_it_is_named_in_the_order_of_the_tests():
    def changed(condition, _):
        return RATE * condition.order * cone(condition.protocol, **TRUTH)

    found = diagnose(
        search_of(problem(recordings(np.random.default_rng(3), changed)), [*RECORD_ONLY, KEY]), lambda said: None
    )
    assert (found.verdict, [each.fit.explanation for each in found.accepted]) == ("identified", [(KEY,)])
    fit = found.accepted[0].fit
    assert fit.model.amplitudes(fit.z)[KEY]["rate"] == pytest.approx(RATE, rel=0.3)


def test_the_virtual_laboratory_numbers_its_tests_and_finite_elements_follow_them(tmp_path):
    truth = {"youngs_modulus": 3.0}
    settings = LaboratorySettings(
        seed=1, parameters=truth, mechanisms={KEY: {"rate": RATE}}, replicates=1, noise_nm=0.0, site_scatter=0.0
    )
    small = study(tmp_path, conditions=TWO)
    first, second = virtual.record(small, settings).values()
    assert (first.test_number, second.test_number) == (1, 2)
    assert second.depth.max() / first.depth.max() == pytest.approx((1.0 + 2.0 * RATE) / (1.0 + RATE), rel=1e-4)
    task = Problem.of(small, resampled(small, check_tests(small, {"A": [first], "B": [second]})))
    model = task.forward.joined([MECHANISMS[KEY]], SCALE)
    place = np.append(task.forward.coordinates.scaled(truth), model.coordinates.free[1].scaled(RATE))
    (plain,), (trending,) = task.forward.curves([place[:1]]), model.curves([place])
    ratios = [trending[name][5] / plain[name][5] for name in ("A", "B")]
    assert ratios == pytest.approx([1.0 - 0.5 * RATE, 1.0 + 0.5 * RATE], rel=1e-5)
