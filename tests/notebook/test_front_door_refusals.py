"""Bad input to the front door is told in one line, before anything is simulated."""

from dataclasses import replace

import numpy as np
import pytest
from elastic_study import CONE, MATERIAL, PROTOCOL, SETTINGS, measured

from palpate import Study, calibrate, diagnose, read_recording, read_recordings, simulate
from palpate.errors import InputError, PalpateError

COLUMNS = {"time": "t", "load": "F", "depth": "h"}


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: read_recording("missing.TXT"), r"missing\.TXT: cannot be read"),
        (lambda: read_recording("x.csv", corrections=["tilt"]), "corrections are tilt; name some of: drift, frame"),
        (lambda: read_recording("x.csv", corrections=5), "corrections are 5; name some of: drift, frame"),
        (lambda: read_recording("x.csv", corrections=["drift", None]), "corrections are drift, None; name some of"),
        (lambda: read_recording("x.csv", columns=["t"]), "columns: list is no mapping of channels; name time, load"),
        (lambda: read_recording("x.csv", columns=COLUMNS, units={"load": 5}), "units: load in '5' is not known"),
        (lambda: read_recording(None), "path: NoneType is no path; give the path of a file"),
        (lambda: read_recording("test.csv", contact=None), "contact None is not known; give a depth or one of: file"),
        (lambda: read_recordings("missing.TXT"), r"missing\.TXT: cannot be read"),
        (lambda: simulate(), "material is missing"),
        (lambda: simulate("missing.yaml"), r"missing\.yaml: cannot be read"),
        (lambda: simulate(material=MATERIAL | {"youngs_modulus": -1}, indenter=CONE, protocol=PROTOCOL), "-1 GPa"),
        (lambda: simulate([1, 2]), "the specification is not a table of keys"),
        (lambda: Study.read(None), "NoneType is no study; give a Study"),
        (lambda: Study.read("missing.yaml"), r"missing\.yaml: cannot be read"),
        (lambda: Study.from_mapping(SETTINGS | {"pointz": 3}), "the mapping, pointz: unknown key 'pointz'"),
        (lambda: Study.draft([]), "no recordings are given"),
        (lambda: Study.draft(3.0), "float is no recording"),
        (lambda: Study.draft("test.csv", sphere="x"), "sphere: sphere is 'x', expected a number; give a number in nm"),
        (lambda: Study.draft("test.csv", sphere=-5), "sphere = -5 nm is outside its range"),
        (lambda: diagnose(SETTINGS, calibration=3), "int is no calibration of a study; give what calibrate returns"),
        (lambda: calibrate(3.0), "float is no study"),
        (lambda: calibrate(SETTINGS), "the study names no recordings; give tests"),
        (lambda: calibrate(SETTINGS, "lob"), "'lob' is no set of recordings of the study, which has: none"),
        (lambda: calibrate(SETTINGS, [3.0]), "float is no recording"),
        (lambda: calibrate(SETTINGS, {"B": [measured()]}), "'B' is no condition of the study"),
        (lambda: calibrate(SETTINGS, {"A": []}), "no recording of condition 'A'"),
        (lambda: calibrate(SETTINGS, [measured(), measured()]), "test of A: is the same recording as test of A"),
        (lambda: calibrate(SETTINGS, replace(measured(), load=0.5 * measured().load)), "the largest load is 1 mN"),
    ],
)
def test_bad_input_is_told_in_one_line(tmp_path, monkeypatch, call, words):
    monkeypatch.chdir(tmp_path)
    measured().write("test.csv")
    with pytest.raises(InputError, match=words) as raised:
        call()
    assert "\n" not in str(raised.value)


def test_tests_without_the_name_of_their_condition_need_a_study_with_one():
    two = SETTINGS | {"conditions": [{"name": name, **PROTOCOL} for name in ("A", "B")]}
    with pytest.raises(InputError, match=r"2 conditions; give tests by the name of their condition: \{'A'"):
        calibrate(two, measured())


def test_a_whole_specification_takes_no_sections_beside():
    study = Study.from_mapping(SETTINGS)
    whole = study.specification(study.cells[0], study.conditions[0])
    with pytest.raises(InputError, match="accuracy is given beside a whole specification"):
        simulate(whole, accuracy="fine")


def test_a_simulation_that_fails_says_why():
    ball = {"shape": "sphere", "radius": 10.0}
    with pytest.raises(PalpateError, match="the sphere sinks in beyond its radius"):
        simulate(material=MATERIAL, indenter=ball, protocol=PROTOCOL)


@pytest.mark.parametrize(
    ("call", "changes", "words"),
    [
        (calibrate, {"calibration": {"population": 201}}, "calibration.subpopulations: population 201"),
        (calibrate, {"surrogate": {"shape": 1e9}}, "surrogate: the multiquadric interpolation system"),
        (calibrate, {"calibration": {"objective": "relative"}}, "calibration.objective: the mean curve of A"),
        (diagnose, {"diagnosis": {"mechanisms": ["thermal_drfit"]}}, "'thermal_drfit' is not known"),
        (diagnose, {"diagnosis": {"ranges": {"friction": {"coefficient": [0.4, 0]}}}}, "is no range"),
        (diagnose, {"diagnosis": {"bootstrap": 200}}, "200 draws cannot show a misfit"),
    ],
)
def test_settings_are_checked_before_anything_is_simulated(monkeypatch, call, changes, words):
    test = measured()
    monkeypatch.setattr("palpate.solver.store.computed", lambda *_: pytest.fail("snapshots are simulated"))
    with pytest.raises(InputError, match=words):
        call(SETTINGS | changes, replace(test, depth=np.maximum(test.depth - 20.0, 0.0)))
