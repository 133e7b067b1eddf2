"""The front door: what a notebook reads, simulates, fits and diagnoses, without the workflow."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import yaml
from elastic_study import CONE, MATERIAL, PROTOCOL, SETTINGS, measured
from matplotlib.axes import Axes
from public_files import ANON, LONG, needs_recordings

import palpate
from palpate import Study, calibrate, diagnose, read_recording, read_recordings, simulate
from palpate.base.fingerprint import closure
from palpate.cli.main import main
from palpate.errors import InputError
from palpate.laboratory import virtual
from palpate.notebook.study_tests import given_tests

REPOSITORY = Path(__file__).parents[2]
COMPLIANCE = 60.0
LABORATORY = {
    "parameters": {"youngs_modulus": 3.0}, "replicates": 1, "noise_nm": 0.3, "noise_time": 1.0, "site_scatter": 0.01,
    "seed": 4,
}  # fmt: skip


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return tmp_path_factory.mktemp("results")


@pytest.fixture(scope="module")
def fit(results):
    return calibrate(SETTINGS, [measured(name="one", seed=1), measured(name="two", seed=2)], results=results)


@pytest.fixture(scope="module")
def found(results):
    tests = {"A": [measured(COMPLIANCE, "one", 1), measured(COMPLIANCE, "two", 2)]}
    return diagnose(SETTINGS, tests, results=results)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "good.csv"
    measured().write(path)
    return path


def test_the_package_is_imported_without_what_takes_long():
    code = "import sys, palpate; print(*{'numba', 'scipy', 'pandas', 'matplotlib'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "\n"


def test_a_study_in_a_notebook_needs_neither_workflow_nor_tracking():
    names = ", ".join(palpate.PLACES)
    code = f"import sys; from palpate import {names}; print(*{{'snakemake', 'mlflow'}} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "\n"


def test_all_names_are_there_and_no_others():
    for name in palpate.__all__:
        assert name in dir(palpate)
        assert getattr(palpate, name)
    with pytest.raises(AttributeError, match="no attribute 'Studdy'"):
        _ = palpate.Studdy


def test_the_front_door_decides_no_result():
    for script in REPOSITORY.glob("scripts/*.py"):
        assert not any("notebook" in file.parts for file in closure(script)), script.name


def test_the_notebook_of_the_documents_is_short_and_names_what_is_there():
    (code,) = re.findall(r"```python\n(.*?)```", (REPOSITORY / "docs/notebook.md").read_text(), re.DOTALL)
    compile(code, "notebook", "exec")
    assert len([line for line in code.splitlines() if line.strip()]) <= 12
    (names,) = re.findall(r"from palpate import (.*)", code)
    assert set(names.split(", ")) <= set(palpate.__all__)


def test_a_recording_shows_itself(file):
    test = read_recording(file)
    assert test.name == "good"
    frame = test.to_frame()
    assert list(frame) == ["time_s", "load_mN", "depth_nm"]
    assert frame["depth_nm"].to_numpy() == pytest.approx(measured().depth, rel=1e-6)
    assert [part.kind for part in test.segments] == ["loading", "hold", "unloading"]
    assert "the largest load, 2 mN" in test.summary()
    assert "good" in repr(test) and "<p>" in test._repr_html_()
    axes = test.plot()
    assert [line.get_label() for line in axes.lines] == ["loading", "hold", "unloading"]
    assert test.plot(axes) is axes


def test_a_table_is_read_by_its_columns(tmp_path):
    path = tmp_path / "table.txt"
    np.savetxt(path, [[0, 0, 0], [1, 500, 0.1], [2, 0, 0.05]], header="clock force path", comments="")
    columns = {"time": "clock", "load": 2, "depth": 3}
    test = read_recording(
        path, columns=columns | {"load": "force", "depth": "path"}, units={"load": "uN", "depth": "um"}
    )
    assert test.load == pytest.approx([0, 0.5, 0])
    assert test.depth == pytest.approx([0, 100, 50])
    with pytest.raises(InputError, match="units are given without columns"):
        read_recording(path, units={"load": "uN"})


@needs_recordings
def test_a_vendor_s_file_is_read_as_the_command_line_reads_it(tmp_path):
    test = read_recording(ANON)
    assert main(["read", str(ANON), "-o", str(tmp_path)]) == 0
    (written,) = tmp_path.glob("*.csv")
    assert read_recording(written).to_frame().to_numpy() == pytest.approx(test.to_frame().to_numpy(), rel=1e-8)
    assert test.metadata["EIT"].startswith("2,5187")
    assert "11.13 mN" in test.summary()
    assert read_recording(ANON, contact="auto").depth.max() != test.depth.max()


@needs_recordings
def test_one_of_several_tests_is_chosen_by_name_or_number():
    tests = read_recordings(LONG)
    assert [test.name for test in tests] == [f"HT_V_300mN_{k}" for k in (1, 2, 3, 4)]
    for chosen in (2, "2", "HT_V_300mN_2"):
        assert read_recording(LONG, chosen).depth.tolist() == tests[1].depth.tolist()
    with pytest.raises(InputError, match=r"holds 4 tests: 'HT_V_300mN_1', .*; choose one by name or number"):
        read_recording(LONG)
    with pytest.raises(InputError, match="has no test '9'"):
        read_recording(LONG, 9)


def test_a_simulation_is_the_same_by_mapping_keywords_file_and_study(tmp_path):
    sections = {"material": MATERIAL, "indenter": CONE, "protocol": PROTOCOL | {"points": 20}, "kinematics": "large"}
    path = tmp_path / "spec.yaml"
    path.write_text(yaml.safe_dump(sections))
    study = Study.from_mapping(SETTINGS)
    curves = [
        simulate(sections),
        simulate(**sections),
        simulate(sections, protocol=PROTOCOL | {"points": np.int64(20), "hold_time": np.array(10)}),
        simulate(path),
        simulate(path, material=MATERIAL | {"youngs_modulus": 3}),
        simulate(study.specification({"youngs_modulus": 3.0}, study.conditions[0])),
    ]
    for curve in curves:
        assert curve.depth.tolist() == curves[0].depth.tolist()
    softer = simulate(sections, material=MATERIAL | {"youngs_modulus": 1.5})
    assert softer.depth == pytest.approx(np.sqrt(2.0) * curves[0].depth, rel=1e-6)


def test_a_simulated_curve_shows_itself():
    curve = simulate(material=MATERIAL, indenter=CONE, protocol=PROTOCOL, mechanisms={"thermal_drift": {"rate": 0.1}})
    assert list(curve.to_frame()) == ["time_s", "load_mN", "depth_nm"]
    assert len(curve.to_frame()) == 100
    assert "youngs_modulus 3" in curve.summary() and "thermal_drift" in curve.summary()
    assert "elastic under cone" in repr(curve) and "elastic" in curve._repr_html_()
    axes = curve.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("depth [nm]", "load [mN]")
    assert curve.recording.notes[0].startswith("SYNTHETIC")


def test_a_study_of_a_mapping_is_that_of_its_file(tmp_path):
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump(SETTINGS))
    levels = {"youngs_modulus": np.array([2.0, 2.7, 3.3, 4.0])}
    given, read = Study.from_mapping(SETTINGS | {"parameters": levels}), Study.read(path)
    assert (given.levels, given.fixed, given.cells) == (read.levels, read.fixed, read.cells)
    assert given.to_frame().equals(read.to_frame())
    assert read.to_frame().iloc[0].to_dict() == {
        "condition": "A", "role": "calibrate", "drive": "load", "largest": 2.0, "unit": "mN", "duration_s": 50.0,
        "points": 20,
    }  # fmt: skip
    assert "Young's modulus" in read.summary() and "4 materials" in read.summary()
    assert repr(read) == "<Study 'small': elastic under cone, conditions A>"
    assert "<table" in read._repr_html_()
    axes = read.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "load [mN]")


@pytest.mark.parametrize("how", [str, read_recording, lambda path: [read_recording(path)], lambda path: measured()])
def test_a_drafted_study_is_that_of_the_command_line(file, monkeypatch, how):
    monkeypatch.chdir(file.parent)
    assert main(["draft", "good.csv", "--law", "elastic", "-o", "drafted"]) == 0
    drafted, study = Study.read("drafted/study.yaml"), Study.draft(how(file), law="elastic")
    assert study.name in ("good", "test")
    assert (study.levels, study.fixed) == (drafted.levels, drafted.fixed)
    assert study.to_frame().equals(drafted.to_frame())
    assert given_tests(study, None)[1].keys() == {"P2_T20"}


def test_a_draft_stays_where_a_folder_is_given(file):
    folder = file.parent / "mine"
    study = Study.draft(file, law="elastic", folder=folder)
    assert (study.name, study.file) == ("mine", folder / "study.yaml")
    assert Study.read(folder / "study.yaml").levels == study.levels
    with pytest.raises(InputError, match=r"study\.yaml: exists already"):
        Study.draft(file, law="elastic", folder=folder)


def test_a_draft_says_what_to_look_at(file):
    stiff = replace(measured(), depth=0.2 * measured().depth)
    messages = []
    (file.parent / "notes.txt").write_text("no test")
    study = Study.draft([file, file.parent / "notes.txt", file, stiff], report=messages.append)
    assert any("the same recording as" in line for line in messages)
    assert any("notes.txt" in line and "the file is left out" in line for line in messages)
    assert any("different materials" in line for line in study.remarks)
    assert "different materials" in study.summary() and "different materials" in study._repr_html_()


def test_a_calibration_finds_the_modulus_and_shows_it(fit):
    frame = fit.to_frame()
    assert list(frame["parameter"]) == ["youngs_modulus"]
    (row,) = frame.to_dict("records")
    assert row["unit"] == "GPa"
    assert row["lower"] < 3.0 < row["upper"]
    assert fit.values["youngs_modulus"] == row["estimate"]
    assert fit.errors["rmse_nm"].iloc[0] < 3.0
    assert "Young's modulus" in fit.summary() and "Root mean square misfit" in fit.summary()
    assert repr(fit) == "<Calibration of 'small', recordings 'given': 1 of 1 parameters identified>"
    assert fit._repr_html_().count("<table") == 2
    assert set(fit.curves["condition"]) == {"A"}


def test_a_calibration_is_drawn_whole_or_on_given_axes(fit):
    panels = fit.plot()
    assert [type(panel) for panel in panels] == [Axes]
    assert panels[0].get_title() == "A" and hasattr(panels[0].figure, "savefig")
    axes = simulate(material=MATERIAL, indenter=CONE, protocol=PROTOCOL).plot()
    assert fit.plot(axes) is axes
    assert "A" in [line.get_label() for line in axes.lines]


def test_drawing_leaves_the_settings_of_matplotlib_alone(fit, found):
    before, backend = dict(matplotlib.rcParams), matplotlib.get_backend()
    fit.plot()
    found.plot()
    assert dict(matplotlib.rcParams) == before
    assert matplotlib.get_backend() == backend


def test_a_diagnosis_shows_what_is_missing(fit, found):
    assert found.verdict in ("identified", "suspected")
    frame = found.to_frame()
    assert list(frame["parameter"]) == ["frame_compliance.compliance", "youngs_modulus"]
    assert frame["lower"].iloc[0] < COMPLIANCE < frame["upper"].iloc[0]
    assert set(found.tried["mechanisms"]) == {"base model", "frame_compliance"}
    assert found.tried.set_index("mechanisms")["accepted"].to_dict() == {"base model": False, "frame_compliance": True}
    assert "frame compliance of" in found.summary().lower() and found.verdict in repr(found)
    assert found._repr_html_().count("<table") == 2
    assert len(found.plot()) == 1 and found.plot()[0].figure.savefig
    axes = fit.plot()[0]
    assert found.plot(axes) is axes


def test_every_entry_of_the_results_is_explained(fit, found):
    page = (REPOSITORY / "docs/files.md").read_text()
    for name, content in (("calibration", fit.content), ("diagnosis", found.content)):
        section = page.partition(f"## `{name}.json`")[2].partition("\n## ")[0]
        assert set(content) <= set(re.findall(r"`(\w+)`", section))


def test_a_diagnosis_without_candidates_still_shows_itself(fit):
    messages = []
    alone = diagnose(fit.study, calibration=fit, report=messages.append)
    assert [line.split(",")[0] for line in messages if "expected" in line] == ["explanation 1 of at most 16"]
    assert (alone.verdict, alone.content["recordings"]) == ("adequate", fit.saved.name)
    assert alone.tried["accepted"].to_list()[0]
    assert list(alone.to_frame()["parameter"]) == ["youngs_modulus"] and alone.candidates.empty
    assert alone.parameters["youngs_modulus"]["estimate"] == fit.values["youngs_modulus"]
    assert "no effect of the library is needed" in alone.summary() and alone._repr_html_() and len(alone.plot())


def test_curves_are_kept_where_results_are_and_nobody_is_told_unasked(fit, results, capsys, monkeypatch):
    messages = []

    def failing(study, observed, values, report=print):
        report("not brought to one load")
        return observed

    monkeypatch.setattr("palpate.workflow_support.steps.brought_to_one_load", failing)
    assert len(list((results / "store").rglob("*.npz"))) == 4
    again = calibrate(fit.study, fit.tests, results=results, report=messages.append)
    assert any("4 snapshots, 0 computed" in line for line in messages)
    assert [line.split(": ")[1] for line in messages if line.startswith("step")] == [
        "snapshots", "surrogates", "search and least squares"
    ]  # fmt: skip
    assert again.values == fit.values and "not brought to one load" in messages
    assert capsys.readouterr() == ("", "")


@pytest.mark.usefixtures("truth_once")
def test_sets_of_a_study_are_taken_by_name_from_folders_and_laboratories(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    sets = {"lab": "results/small/recordings/lab", "mine": "mine"}
    Path("mine").mkdir()
    measured().write("mine/A_1.csv")
    study = Study.from_mapping(SETTINGS | {"points": 10, "recordings": sets, "laboratory": {"lab": LABORATORY}})
    made = given_tests(study, "lab")[1]["A"]
    assert made[0].synthetic
    assert not Path("results").exists()
    virtual.write(study, "lab", study.recordings["lab"])
    stale = replace(study, laboratory={"lab": study.laboratory["lab"].model_copy(update={"seed": 5})})
    assert given_tests(stale, "lab")[1]["A"][0].depth != pytest.approx(made[0].depth)
    for one, other in zip(made, given_tests(study, "lab")[1]["A"], strict=True):
        assert one.depth == pytest.approx(other.depth, rel=1e-6)
    assert not given_tests(study, "mine")[1]["A"][0].synthetic
    ((of_set,), (of_file,)) = (given_tests(study, given)[1]["A"] for given in ("mine", "mine/A_1.csv"))
    assert of_set.depth == pytest.approx(of_file.depth)
    with pytest.raises(InputError, match="several sets of recordings; name one of: lab, mine"):
        given_tests(study, None)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"conditions": [{"name": "B", **PROTOCOL}]}, "other conditions: B, A"),
        ({"conditions": [{"name": "A", **PROTOCOL, "hold_time": 20}]}, "other conditions: A"),
        ({"indenter": CONE | {"half_angle": 60}}, "another indenter"),
        ({"kinematics": "small"}, "large strains"),
        ({"material": {"model": "elastic", "poisson_ratio": 0.2}}, "other values under material"),
    ],
)
def test_the_calibration_of_another_study_is_refused(fit, changes, words):
    with pytest.raises(InputError, match=f"calibration: the calibration is of {words}; give the calibration of this"):
        diagnose(SETTINGS | changes, calibration=fit)


def test_a_calibration_of_another_law_is_refused(fit):
    other = SETTINGS | {
        "material": {"model": "elastic", "youngs_modulus": 3.0},
        "parameters": {"poisson_ratio": [0.2, 0.4]},
    }
    with pytest.raises(InputError, match="the calibration is of youngs_modulus, the study asks for poisson_ratio"):
        diagnose(other, calibration=fit)
