"""`palpate check`: what would stop a study later, or what is odd about its recordings, is said before anything runs."""

import itertools
from pathlib import Path

import numpy as np
import pytest
import yaml

from indentation_files.recording import Recording
from palpate.cli.main import main
from palpate.configuration.study_file import load_study, study_from
from palpate.workflow_support import expected_time
from palpate.workflow_support.expected_time import expected, job_seconds

CHALLENGE = Path(__file__).parents[2] / "config" / "challenge.yaml"
ELASTIC = {
    "study": "el",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [2.0, 4.0]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "A", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}],
}


@pytest.mark.parametrize(
    ("section", "settings", "words"),
    [
        ("diagnosis", {"mechanisms": ["magic"]}, "diagnosis.mechanisms: mechanism 'magic' is not known"),
        ("diagnosis", {"ranges": {"friction": {"amount": [0, 1]}}}, "diagnosis.ranges.friction: amount is not"),
        ("diagnosis", {"snapshots": 8}, "diagnosis.snapshots: snapshots was removed: explanations are fitted on the"),
        (
            "diagnosis",
            {"reference": {"youngs_modulus": 72, "poisson_ratio": 0.17, "area": [-24.5], "uncertainty": 0.02}},
            "diagnosis.reference.area: the area is not positive",
        ),
        (
            "diagnosis",
            {"reference": {"youngs_modulus": 72, "poisson_ratio": 0.17, "area": [24.5e-6], "uncertainty": 0.02}},
            "diagnosis.reference.area: area at 1e+04 nm is that of a cone of half-angle 0.16 degrees",
        ),
        ("surrogate", {"shape": 50.0}, "surrogate: the multiquadric interpolation system with shape 50 has condition"),
        ("calibration", {"population": 202}, "calibration.subpopulations: population 202 cannot be split into 4"),
    ],
)
def test_what_cannot_be_done_later_is_found_by_check(tmp_path, refused, section, settings, words):
    study = yaml.safe_load(CHALLENGE.read_text())
    file = tmp_path / "study.yaml"
    file.write_text(yaml.safe_dump(study | {section: settings}))
    assert f"{file}, {words}" in refused("check", file)


@pytest.mark.parametrize(
    ("concealed", "words"),
    [
        ({"second_voigt": {"coefficient": 0.1, "exponent": 0.3, "retardation_time": 5}}, "no Voigt element to add to"),
        ({"controller_lag": {"lag": 100}}, "lag: lag = 100 s is not shorter than the test"),
    ],
)
def test_what_a_laboratory_cannot_conceal_is_found_by_check(tmp_path, refused, concealed, words):
    file = tmp_path / "study.yaml"
    laboratory = {"lab": {"parameters": {"youngs_modulus": 3.2}, "mechanisms": concealed}}
    writes = {"recordings": {"lab": "results/el/recordings/lab"}, "laboratory": laboratory}
    file.write_text(yaml.safe_dump(ELASTIC | writes))
    line = refused("check", file)
    assert words in line and f"{file}, laboratory.lab.mechanisms." in line


def checked(folder, capsys, **changes):
    """Return what `palpate check` prints of the elastic study with some of its keys changed."""
    (folder / "study.yaml").write_text(yaml.safe_dump(ELASTIC | changes))
    assert main(["check", str(folder / "study.yaml")]) == 0
    return capsys.readouterr().out


def test_check_expects_more_time_under_a_pyramid_and_says_for_which_accuracy(tmp_path, capsys):
    """Without recordings nothing is fitted, and snapshots are those of the cone."""
    (tmp_path / "lab").mkdir()
    time = np.linspace(0.0, 60.0, 81)
    load = np.minimum(time / 30.0, 2.0 - time / 30.0)
    Recording(time, load, 400.0 * np.sqrt(load)).write(tmp_path / "lab/A_1.csv")
    studies = {"cone": {}, "pyramid": {"indenter": {"shape": "berkovich"}}, "finer": {"accuracy": "fine"}}
    lines = {}
    for name, changes in studies.items():
        for recordings in ({}, {"lab": str(tmp_path / "lab")}):
            said = checked(tmp_path, capsys, recordings=recordings, diagnosis={"enabled": False}, **changes)
            (lines[name, bool(recordings)],) = [row for row in said.splitlines() if row.startswith("expected time")]
    assert lines["pyramid", False] == lines["cone", False]
    assert "up to 3 curves of the pyramid" in lines["pyramid", True]
    assert "pyramid" not in lines["cone", True]
    assert lines["finer", True].startswith("expected time, within a factor of two for accuracy standard (fine takes")


def test_check_says_what_is_odd_about_recordings(tmp_path, capsys):
    """One begins far from contact; one outlasts the load that the condition follows; one is no .csv file."""
    folder = tmp_path / "lab"
    folder.mkdir()
    (folder / "A_3.txt").write_text("time,load,depth")
    time = np.linspace(0.0, 40.0, 81)
    load = np.minimum(time / 20.0, 2.0 - time / 20.0)
    for name, kept, offset in (("A_1", time <= 30.0, 0.0), ("A_2", time <= 40.0, 400.0)):
        Recording(time[kept], load[kept], 400.0 * np.sqrt(load[kept]) + offset).write(folder / f"{name}.csv")
    condition = {"name": "A", "load_history": "recorded"}
    said = checked(tmp_path, capsys, conditions=[condition], recordings={"lab": str(folder)})
    assert "A_2.csv begins at a depth of 400 nm, not at contact" in said
    assert "A_3.txt is not read" in said
    assert "A_2.csv lasts 40 s, the recorded load that its condition follows ends after 30 s" in said
    assert "(the first file by name is followed)" in said


def test_check_reports_no_oscillation_of_a_load_that_is_not_followed(tmp_path, capsys):
    """The condition follows a file of its own, and its recording is noisy and outlasts it."""
    (tmp_path / "lab").mkdir()
    (tmp_path / "load.csv").write_text("time_s,load_mN\n0,0\n20,1\n40,0\n")
    time = np.linspace(0.0, 45.0, 9001)
    load = np.maximum(np.minimum(time / 20.0, 2.0 - time / 20.0), 0.0)
    noisy = load + 0.02 * np.random.default_rng(1).standard_normal(len(time)) * (load > 0.0)
    Recording(time, noisy, 400.0 * np.sqrt(load)).write(tmp_path / "lab/A_1.csv")
    condition = {"name": "A", "load_history": str(tmp_path / "load.csv")}
    said = checked(tmp_path, capsys, conditions=[condition], recordings={"lab": str(tmp_path / "lab")})
    assert "oscillates" not in said
    assert "A_1.csv lasts 45 s, the recorded load that its condition follows ends after 40 s" in said
    assert f"({condition['load_history']} is followed)" in said


def test_check_reports_a_pull_off_and_no_noise_below_zero(tmp_path, capsys):
    """Both tests have noisy loads; the surface holds the tip of the second while it leaves."""
    time, rng = np.linspace(0.0, 63.0, 631), np.random.default_rng(1)
    load = np.interp(time, [0.0, 30.0, 60.0, 61.0, 62.5, 63.0], [0.0, 1.0, 0.0, -0.2, -0.2, 0.0])
    said = []
    for number, least in ((1, 0.0), (2, -0.2)):
        noisy = np.append(0.0, np.maximum(load, least)[1:] + 0.015 * rng.standard_normal(630))
        Recording(time, noisy, 400.0 * np.sqrt(np.maximum(load, 0.0))).write(tmp_path / f"A_{number}.csv")
        lines = checked(tmp_path, capsys, recordings={"lab": str(tmp_path)}).splitlines()
        said.append([line for line in lines if "pulls" in line])
    assert said[0] == []
    assert "A_2.csv: the surface pulls on the tip by up to 0.2" in said[1][0]


def test_check_names_a_test_ten_times_as_deep_as_its_like(tmp_path, capsys):
    time = np.linspace(0.0, 60.0, 81)
    load = np.minimum(time / 30.0, 2.0 - time / 30.0)
    for number, scale in enumerate((1.0, 1.02, 10.0), 1):
        Recording(time, load, scale * 400.0 * np.sqrt(load)).write(tmp_path / f"A_{number}.csv")
    said = checked(tmp_path, capsys, recordings={"lab": str(tmp_path)})
    assert "A_3.csv is 4000 nm deep, the median of its condition's tests 408 nm" in said
    assert "A_1.csv is" not in said


def test_check_tells_another_material_from_another_zero(tmp_path, capsys):
    """A test four times as stiff and as deep as the others; then one of their kind whose depth begins elsewhere."""
    time = np.linspace(0.0, 60.0, 81)
    load = np.minimum(time / 30.0, 2.0 - time / 30.0)
    elastic = 400.0 * np.sqrt(load)
    for number, depth in enumerate((elastic, 1.02 * elastic, 0.5 * elastic + 200.0 * (time > 0.0)), 1):
        Recording(time, load, depth).write(tmp_path / f"A_{number}.csv")
    said = checked(tmp_path, capsys, recordings={"lab": str(tmp_path)})
    assert "the tests look like different materials" in said and "in A_3 and" in said
    Recording(time, load, elastic + 900.0 * (time > 0.0)).write(tmp_path / "A_3.csv")
    said = checked(tmp_path, capsys, recordings={"lab": str(tmp_path)})
    assert "different materials" not in said and "A_3.csv is 1300 nm deep" in said


@pytest.mark.parametrize(
    "folder", ["mine", ".", "results", "results/trial", "results/trial/lab", "results/x/recordings/y"]
)
@pytest.mark.parametrize("writer", ["laboratory", "source"])
def test_a_folder_of_the_user_s_is_not_given_to_the_workflow_to_empty(tmp_path, monkeypatch, refused, writer, folder):
    """Before it writes a set of recordings, Snakemake removes the folder with all that stands there."""
    monkeypatch.chdir(tmp_path)
    study = yaml.safe_load(CHALLENGE.read_text())
    truth = {name: levels[0] for name, levels in study["parameters"].items()}
    (tmp_path / "vendor.csv").write_text("precious")
    sections = {
        "laboratory": {"laboratory": {"lab": {"parameters": truth}}},
        "source": {"source": {"file": "vendor.csv", "recordings": "lab", "conditions": {
            condition["name"]: [1] for condition in study["conditions"]
        }}},
    }[writer]  # fmt: skip
    Path("study.yaml").write_text(yaml.safe_dump(study | sections | {"recordings": {"lab": folder}}))
    assert "study.yaml, recordings.lab: the workflow writes this set, and would empty" in refused("check", "study.yaml")


@pytest.mark.parametrize("below", [".", "inner"])
@pytest.mark.parametrize("written", [["lab", "other"], ["lab"]])
def test_a_set_does_not_lie_in_a_folder_that_the_workflow_writes(tmp_path, monkeypatch, refused, written, below):
    monkeypatch.chdir(tmp_path)
    study = yaml.safe_load(CHALLENGE.read_text())
    truth = {"parameters": {name: levels[0] for name, levels in study["parameters"].items()}}
    folder = f"results/{study['study']}/recordings/lab"
    sets = {"lab": folder, "other": f"{folder}/{below}"}
    shared = {"laboratory": dict.fromkeys(written, truth), "recordings": sets}
    Path("study.yaml").write_text(yaml.safe_dump(study | shared))
    assert "study.yaml, recordings.other: it lies in the folder of lab" in refused("check", "study.yaml")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {
                "recordings": {"lab": "results/el/recordings/{lab}"},
                "laboratory": {"lab": {"seed": 1, "parameters": {"youngs_modulus": 3.0}}},
            },
            "recordings.lab: results/el/recordings/{lab} has braces, which are wildcards",
        ),
        ({"diagnosis": {"ranges": {"tip_angle": {}}}}, "diagnosis.ranges.tip_angle: 0 entries are given, expected 1"),
        ({"calibration": {"objective": "relative"}}, "calibration.objective: the mean curve of A is not positive at"),
        (
            {"diagnosis": {"reference": {
                "youngs_modulus": 3, "poisson_ratio": 0.3, "area": [24.5], "uncertainty": 0.02,
            }}},
            "diagnosis.reference: unloading has",
        ),
    ],
)  # fmt: skip
def test_what_would_stop_the_workflow_is_found_by_check(tmp_path, monkeypatch, refused, changes, words):
    """The test recovers all of its depth, and its unloading has two points."""
    monkeypatch.chdir(tmp_path)
    time = np.append(np.linspace(0.0, 30.0, 81), [45.0, 60.0])
    load = np.minimum(time / 30.0, 2.0 - time / 30.0)
    Path("mine").mkdir()
    Recording(time, load, 400.0 * np.sqrt(load)).write("mine/A_1.csv")
    Path("study.yaml").write_text(yaml.safe_dump(ELASTIC | {"recordings": {"lab": "mine"}} | changes))
    assert f"study.yaml, {words}" in refused("check", "study.yaml")


def test_the_default_study_takes_about_as_long_as_check_expects():
    """A run took 418 s of processor time, 40 s of it for compilation: docs/measurements.md."""
    study = load_study(Path(__file__).parents[2] / "config/config.yaml")
    seconds = job_seconds(study)
    jobs = {"snapshots": 8, "surrogate": 4, "calibration": 3, "diagnosis": 1, "laboratory": 1, "figures": 1}
    jobs |= {"report": 1, "tracking": 1}
    assert sum(seconds[rule] * count for rule, count in jobs.items()) == pytest.approx(378, rel=0.33)
    (line,) = expected(study, 1)
    assert "12 mechanisms" in line and line.startswith("expected time, within a factor of two: 6 min on 1 free core")


def test_more_cores_take_no_less_than_their_share_and_no_more_than_one(monkeypatch):
    """Of the default study, whose figures, report and tracking have to wait for its diagnosis."""
    study = load_study(Path(__file__).parents[2] / "config/config.yaml")
    monkeypatch.setattr(expected_time, "time_in_words", str)
    cores = (1, 2, 4, 64)
    took = [float(next(expected(study, count)).split(": ")[1].split()[0]) for count in cores]
    seconds = job_seconds(study)
    last = seconds["diagnosis"] / 2 + seconds["figures"] + seconds["report"] + seconds["tracking"]
    assert took[0] > took[1] > took[2] > took[3] > last
    assert all(count * time > took[0] for count, time in zip(cores[1:], took[1:], strict=True))


def an_elastic_law_in_a_laboratory(folder, monkeypatch):
    """Return a study with an empty folder of recordings, and times [s] and loads [mN] of a test."""
    monkeypatch.chdir(folder)
    Path("lab").mkdir()
    time = np.linspace(0.0, 60.0, 81)
    return (
        study_from(ELASTIC | {"recordings": {"lab": "lab"}}, "study"),
        time,
        np.minimum(time / 30.0, 2.0 - time / 30.0),
    )


def test_fits_without_replicates_are_expected_to_take_longer(tmp_path, monkeypatch):
    study, time, load = an_elastic_law_in_a_laboratory(tmp_path, monkeypatch)
    took = []
    for number in (1, 2):
        Recording(time, load, 400.0 * np.sqrt(load)).write(f"lab/A_{number}.csv")
        took.append(job_seconds(study))
    for rule, times in {"calibration": 2.0, "diagnosis": 1.0}.items():
        assert took[0][rule] > times * took[1][rule]


def test_a_diagnosis_of_an_elastic_law_is_expected_to_take_longer_where_tests_leave_an_imprint(tmp_path, monkeypatch):
    study, time, load = an_elastic_law_in_a_laboratory(tmp_path, monkeypatch)
    took = []
    for left in (0.0, 100.0):
        for number in (1, 2):
            Recording(time, load, 400.0 * np.sqrt(load) + left * (time > 30.0)).write(f"lab/A_{number}.csv")
        took.append(job_seconds(study)["diagnosis"])
    assert took[1] > 2.0 * took[0]


def test_the_times_of_a_small_study_are_those_of_its_runs(tmp_path, monkeypatch):
    """Under its law 14 and 22 s of processor time, under an elastic one 8 and 34 s: docs/measurements.md."""
    monkeypatch.chdir(tmp_path)
    content = yaml.safe_load((Path(__file__).parents[2] / "docs/data/comparison.yaml").read_text())
    for law, calibration, diagnosis in (("nonlinear_burgers", 14.0, 22.0), ("elastic", 8.0, 34.0)):
        if law == "elastic":
            content["material"]["model"] = law
            content["parameters"] = {"youngs_modulus": content["parameters"]["youngs_modulus"]}
            del content["laboratory"]
            time = np.linspace(0.0, 70.0, 141)
            load = np.interp(time, [0, 30, 40, 70], [0, 1, 1, 0])
            for folder in content["recordings"].values():
                Path(folder).mkdir(parents=True)
                for condition, number in itertools.product(content["conditions"], (1, 2, 3)):
                    depth = 400.0 * np.sqrt(load) + 60.0 * (time > 40.0)
                    Recording(time, load, depth).write(f"{folder}/{condition['name']}_{number}.csv")
        seconds = job_seconds(study_from(content, "study"))
        assert seconds["calibration"] == pytest.approx(calibration, rel=0.5)
        assert seconds["diagnosis"] == pytest.approx(diagnosis, rel=0.5)
