"""Parts of a test that are held out: simulated and compared, in no likelihood."""

import re
from dataclasses import replace

import numpy as np
import pytest
from test_config import CONDITION, load

from indentation_files.recording import Recording
from palpate import calibrate, diagnose
from palpate.cli.main import main
from palpate.configuration.settings import LaboratorySettings
from palpate.configuration.study_file import load_study
from palpate.data.study_recordings import find, observations
from palpate.errors import InputError
from palpate.laboratory import virtual
from palpate.notebook.notebook_study import study_of
from palpate.study.held_out import divided, inside
from palpate.study.prescribed_segments import last_cycles
from palpate.study.protocol import trapezoid

TIMES, LOADS = [10, 20, 30, 40, 50, 60], [1.0, 0.1, 1.0, 0.1, 1.0, 0.1]
SECOND = (20.0, 40.0)
STUDY = {
    "study": "cycles",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [2.0, 3.0, 4.0]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "kinematics": "small",
    "points": 45,
    "conditions": [{"name": "C", "times": TIMES, "loads": LOADS, "held_out": [list(SECOND)]}],
    "calibration": {"population": 40, "generations": 20},
    "diagnosis": {"mechanisms": ["thermal_drift"]},
}


def cycles(modulus=3.0, shift=0.0, within=SECOND):
    """Return Sneddon's cone under three cycles [mN, nm], with noise, and off by `shift` nm within a time."""
    time = np.linspace(0.0, 60.0, 601)
    load = np.interp(time, [0, *TIMES], [0, *LOADS])
    stiffness = 2e-6 / np.pi * modulus / (1 - 0.3**2) * np.tan(np.radians(70.3))
    depth = np.sqrt(load / stiffness) + 0.5 * np.random.default_rng(1).standard_normal(len(time))
    depth[inside(time, (within,))] += shift
    depth -= depth[0]
    return Recording(time, load, depth, "C_1")


@pytest.fixture(scope="module")
def told():
    """Return calibration and diagnosis of a test, and of one that is off by 40 nm in the part that is held out."""
    found = []
    for shift in (0.0, 40.0):
        fit = calibrate(STUDY, [cycles(shift=shift)])
        found.append((fit, diagnose(fit.study, calibration=fit)))
    return found


def test_what_is_held_out_is_in_no_likelihood(told):
    (fit, found), (shifted, as_found) = told
    assert fit.parameters == shifted.parameters
    stiffer = 1.037  # than Sneddon's cone, whose surface may move into the tip (Hay et al., J. Mater. Res. 14 (1999))
    assert fit.parameters["youngs_modulus"]["estimate"] == pytest.approx(3.0 / stiffer, rel=0.01)
    for key in ("verdict", "p_value", "inclusion", "location", "parameters", "noise", "model_free", "laws", "tried"):
        assert found.content[key] == as_found.content[key], key


def test_what_is_held_out_is_compared(told):
    """The mean square of a shift adds to that of the noise; what was fitted has the same errors."""
    (fit, found), (shifted, as_found) = told
    assert [(name, row["role"]) for name, row in fit.content["conditions"].items()] == [
        ("C", "calibrate"),
        ("C.held_out", "validate"),
    ]
    assert fit.content["conditions"]["C"] == shifted.content["conditions"]["C"]
    assert fit.content["conditions"]["C.held_out"]["rmse_nm"] < 2.0
    assert shifted.content["conditions"]["C.held_out"]["rmse_nm"] == pytest.approx(40.0, rel=0.05)
    of, of_shifted = (each.content["fit"]["validate"]["before_rmse_nm"] for each in (found, as_found))
    assert of < 2.0 and of_shifted == pytest.approx(40.0, rel=0.05)


def test_no_misfit_is_located_in_a_part_that_is_held_out(told):
    rows = told[0][1].content["location"]
    assert {row["cycle"] for row in rows} == {1, 3}
    assert all(row["to_s"] <= SECOND[0] or row["from_s"] >= SECOND[1] for row in rows)


def test_the_parts_share_the_recordings_of_their_test(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = study_of(STUDY | {"recordings": {"lab": "lab"}})
    (tmp_path / "lab").mkdir()
    cycles().write(tmp_path / "lab/C_1.csv")
    assert list(find(study, "lab")) == ["C"]
    whole, found = study.tested["C"].protocol.sample_time, observations(study, "lab")
    assert np.sort(np.concatenate([item.time for item in found.values()])) == pytest.approx(whole)
    assert inside(found["C.held_out"].time, (SECOND,)).all() and not inside(found["C"].time, (SECOND,)).any()


def test_a_laboratory_records_the_whole_test(monkeypatch):
    monkeypatch.setattr(virtual, "off_the_mesh", lambda specifications, names: specifications)
    (specification,) = virtual.exact_curves(study_of(STUDY), LaboratorySettings(parameters={"youngs_modulus": 3.0}))
    sampled = specification.protocol.sample_time
    assert len(sampled) == virtual.DENSER * STUDY["points"] and np.diff(sampled, prepend=0.0).max() < 1.0


def test_counted_points_of_a_recording_lie_outside_the_parts():
    (condition, part) = study_of(STUDY).conditions
    kept = condition.counted(cycles()).time
    assert kept == pytest.approx(np.concatenate([np.arange(0, 20, 0.1), np.arange(40.1, 60.05, 0.1)]))
    assert len(part.counted(cycles())) == len(cycles())
    own = replace(condition, own_loads=True)
    twice = replace(cycles(), time=2.0 * cycles().time)
    assert own.counted(twice).time == pytest.approx(2.0 * kept)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ([[40, 70]], "a part from 40 to 70 s leaves the test, of 0 to 60 s"),
        ([[-1, 20]], "leaves the test"),
        ([[30, 30]], "has no length"),
        ([[40, 20]], "FROM_S before TO_S"),
        ([[5, 20], [10, 30]], "two parts overlap, from 10 to 20 s"),
        ([[0, 60]], "of 100 simulated points 0 are left"),
        ([[20, 20.1]], "fewer than 2 simulated points lie between"),
        ([[20]], "give [[FROM_S, TO_S], ...]"),
        ([20, 30], "give [[FROM_S, TO_S], ...]"),
        ([], "give [[FROM_S, TO_S], ...]"),
        ([["a", 30]], "expected a number"),
        ([[20, float("nan")]], "expected a number"),
    ],
)
def test_parts_that_cannot_be_held_out_are_refused(tmp_path, parts, words):
    with pytest.raises(InputError) as caught:
        load(tmp_path, conditions=[CONDITION | {"held_out": parts}])
    assert words in str(caught.value) and "conditions[0]" in caught.value.place and "held_out" in caught.value.place


def test_a_condition_is_held_out_as_a_whole_or_in_parts(tmp_path):
    with pytest.raises(InputError, match="all of a test is held out"):
        load(tmp_path, conditions=[CONDITION, CONDITION | {"name": "b", "role": "validate", "held_out": [[0, 9]]}])


def test_a_history_is_divided_at_its_samples():
    protocol = trapezoid(1.0, 10.0, 5.0, 10.0)
    parts, counted, rest = divided(protocol, [[20, 25], [1, 2]], 1)
    assert parts == ((1.0, 2.0), (20.0, 25.0))
    assert np.array_equal(np.sort([*counted.sample_time, *rest.sample_time]), protocol.sample_time)
    assert np.array_equal(counted.knot_drive, protocol.knot_drive)


def test_the_last_third_of_cycles_is_proposed():
    (condition, _) = study_of(STUDY).conditions
    (begin, end), words = last_cycles(condition.protocol)
    assert (begin, end, words) == (40.0, 60.0, "the last cycle")
    assert last_cycles(trapezoid(1.0, 10.0, 5.0, 10.0)) is None


def test_a_draft_of_one_test_holds_its_last_cycles_out(tmp_path, capsys):
    """And check proposes them where a study holds nothing out."""
    cycles().write(tmp_path / "C_1.csv")
    assert main(["draft", str(tmp_path / "C_1.csv"), "-o", str(tmp_path / "first")]) == 0
    study = load_study(tmp_path / "first/study.yaml")
    assert [(each.role, each.part_of != "") for each in study.conditions] == [("calibrate", False), ("validate", True)]
    (part,) = study.conditions[0].held_out
    assert part == pytest.approx((40.0, 60.0), abs=0.5)
    shown = capsys.readouterr()
    assert "the last cycle" in shown.err and f"validated on {study.conditions[1].name}" in shown.out
    text = (tmp_path / "first/study.yaml").read_text()
    (tmp_path / "study.yaml").write_text(re.sub(r", held_out: \[\[.*?\]\]", "", text))
    assert main(["check", str(tmp_path / "study.yaml")]) == 0
    assert "would validate on the last cycle" in capsys.readouterr().out
