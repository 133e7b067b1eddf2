"""Bad studies are refused with file, place and remedy; good ones mean what they say."""

import re
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import yaml
from documents import HOOKS
from pydantic import BaseModel
from study_file import CONDITION, STUDY, TRUTH, load

from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.configuration.checked_file import WITHOUT_LENGTH, bare, checked_file
from palpate.configuration.study_file import load_study
from palpate.configuration.study_sections import StudyFile
from palpate.errors import InputError
from palpate.materials import LAWS
from palpate.study.indenter import AREA, SHAPES
from palpate.surrogate import KERNELS

REFERENCE = (Path(__file__).parents[2] / "docs/study.md").read_text()
LABORATORY = {"recordings": {"lab": "x"}}
SOURCE = {"file": "nowhere.txt", "recordings": "lab", "condition": "P1_T30"}
SILICA = {"youngs_modulus": 72, "poisson_ratio": 0.17, "area": [24.5], "uncertainty": 0.02}


def test_a_length_is_taken_with_the_kernels_that_it_changes(tmp_path):
    for name, kernel in KERNELS.items():
        if kernel.scaled:
            assert load(tmp_path, surrogate={"kernel": name, "shape": 0.3}).surrogate.shape == 0.3
        else:
            assert name in WITHOUT_LENGTH
            assert load(tmp_path, surrogate={"kernel": name, "shape": "loo_each"}).surrogate.shape == "loo_each"


def test_defaults_and_order(tmp_path):
    study = load(tmp_path)
    assert study.condition_sets == {"all": ("P1_T30",)}
    assert len(study.cells) == 4
    assert study.cells[1] == {**study.cells[0], "steady_coefficient": 0.1}
    assert study.free_parameters == ("youngs_modulus", "steady_coefficient")
    assert (study.points, study.kinematics, study.calibration.population) == (100, "large", 200)


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"conditons": []}, "conditons", "did you mean 'conditions'"),
        ({"indenter": None}, "indenter", "nothing is given, expected a table of keys; see indenter in docs/study.md"),
        ({"parameters": {"youngs_modulus": 2.5}}, "parameters.youngs_modulus", "2.5 is given, expected a list"),
        ({"parameters": {"youngs_modulus": []}}, "youngs_modulus", "0 entries are given, expected 1 or more"),
        ({"diagnosis": False}, "diagnosis", "false is given, expected a table of keys"),
        ({"title": 3}, "title", "3 is given, expected text (in quotes where it looks like a number)"),
        ({"conditions": [{"max_load": 1.0}]}, "conditions[0]", "'name' is missing; see conditions in docs/study.md"),
        ({"points": 3}, "points", "3 is given, expected 10 or more"),
        ({"surrogate": {"kernel": "thin"}}, "surrogate.kernel", "expected one of: linear, cubic"),
        ({"calibration": {"popolation": 3}}, "calibration.popolation", "did you mean 'population'"),
        ({"material": {"model": "burgers"}}, "material.model", "nonlinear_burgers"),
        ({"material": {"model": "nonlinear_burgers", "poisson_ratio": 0.5}}, "material.poisson_ratio", "0.4999"),
        ({"material": {"model": "nonlinear_burgers"}}, "parameters", "poisson_ratio"),
        ({"parameters": STUDY["parameters"] | {"youngs_modulus": [3.0, -1.0]}}, "parameters.youngs_modulus", "-1"),
        ({"parameters": STUDY["parameters"] | {"steady_exponent": []}}, "parameters.steady_exponent", ""),
        ({"parameters": STUDY["parameters"] | {"steadyexponent": [1]}}, "parameters.steadyexponent", "did you mean"),
        ({"parameters": {name: [value] for name, value in TRUTH.items()}}, "parameters", "at least two levels"),
        ({"indenter": {"shape": "cone", "half_angle": 7.03}}, "indenter.half_angle", "20 to 89"),
        ({"indenter": {"shape": "cone", "half_angle": 70.3, "friction": 3}}, "indenter.friction", "0 to 0.5"),
        ({"indenter": {"shape": "con"}}, "indenter.shape", "cone"),
        ({"conditions": [STUDY["conditions"][0]] * 2}, "conditions", "twice"),
        ({"conditions": [{"name": "a", "max_load": 1.0}]}, "conditions[0]", "loading_time"),
        ({"conditions": [STUDY["conditions"][0] | {"role": "validate"}]}, "conditions", "calibrate"),
        ({"condition_sets": {"fast": ["P1_T3"]}}, "condition_sets.fast", "did you mean 'P1_T30'"),
        ({"kinematics": "huge"}, "kinematics", ""),
        ({"conditions": [STUDY["conditions"][0] | {"name": "a/b"}]}, "conditions[0].name", "use letters"),
        ({"surrogate": {"shape": "auto"}}, "surrogate.shape", "loo"),
        ({"parameters": STUDY["parameters"] | {"youngs_modulus": [float("nan")]}}, "parameters.youngs_modulus", "nan"),
        ({"recordings": {"snapshots": "x"}}, "recordings", "another name"),
        ({"recordings": {"figures": "x"}}, "recordings", "another name"),
        ({"recordings": {"report.html": "x"}}, "recordings", "another name"),
        ({"study": "mlflow.db"}, "study", "another name"),
        ({"study": "store"}, "study", "another name"),
        ({"conditions": [CONDITION | {"name": "a__b"}]}, "conditions[0].name", "single underscores between"),
        ({"laboratory": {"lab": {"parameters": TRUTH}}}, "laboratory.lab", "recordings"),
        (LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH | {"youngs": 3}}}}, "lab.parameters", "youngs"),
        (LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH | {"youngs_modulus": -3}}}}, "parameters", "-3"),
        (LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH, "mechanisms": {"drif": {}}}}}, "mechanisms", "drif"),
        (
            LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH, "mechanisms": {"thermal_drift": {"rat": 1}}}}},
            "lab.mechanisms.thermal_drift",
            "rat",
        ),
        ({"calibration": {"solver_error": float("nan")}}, "calibration.solver_error", "nan is given"),
        ({"surrogate": {"shape": float("inf")}}, "surrogate.shape", "inf is given"),
        ({"indenter": {"shape": "area_function", "area": [10**400]}}, "indenter.area[0]", "expected a number"),
        ({"indenter": {"shape": ["cone"], "half_angle": 70.3}}, "indenter.shape", "cone"),
        ({"source": SOURCE | {"recordings": "lib"}, "recordings": {"lab": "x"}}, "source.recordings", "'lab'"),
        ({"source": SOURCE | {"condition": "P1"}, "recordings": {"lab": "x"}}, "source.condition", "P1_T30"),
        (
            {"source": SOURCE, "recordings": {"lab": "x"}, "conditions": [CONDITION, CONDITION | {"name": "P2"}]},
            "source",
            "no test of condition 'P2' is named",
        ),
        ({"design": {"points": 64}}, "design.points", "add kind: sobol"),
        ({"surrogate": {"energy": 0.99, "n_modes": 5}}, "surrogate.energy", "keep one"),
        ({"surrogate": {"kernel": "linear", "shape": 0.3}}, "surrogate.shape", "no effect on the kernel linear"),
        ({"indenter": STUDY["indenter"] | {"poisson_ratio": 0.07}}, "indenter.poisson_ratio", "add its modulus"),
        ({"source": SOURCE, "recordings": {"lab": "x"}}, "source.file", "--data PATH, snakemake --config data=PATH"),
        (
            {"calibration": {"solver_error": 0.01}},
            "calibration.solver_error",
            "state what the law leaves by calibration.law_error",
        ),
        ({"calibration": {"law_error": 0.3}}, "calibration.law_error", "0.2 or less; give a ratio"),
        ({"calibration": {"law_error": -0.1}}, "calibration.law_error", "0 or more; give a ratio"),
        ({"calibration": {"site_scatter": 5}}, "calibration.site_scatter", "0.5 or less; give a ratio"),
        (
            LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH, "site_scatter": 1}}},
            "laboratory.lab.site_scatter",
            "give a ratio",
        ),
        (
            LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH | {"poisson_ratio": 0.3}}}},
            "lab.parameters.poisson_ratio",
            "is 0.34 under material",
        ),
        (
            LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH}}, "source": SOURCE | {"file": __file__}},
            "laboratory.lab",
            "converted from the vendor's file, too",
        ),
        (
            {"diagnosis": {"reference": SILICA | {"youngs_modulus": 72e9}}},
            "diagnosis.reference.youngs_modulus",
            "2000 or less; give it in GPa",
        ),
        (
            {"diagnosis": {"reference": SILICA}, "conditions": [{"name": "z", "drive": "displacement"}]},
            "diagnosis.reference",
            "fitted tests under load control",
        ),
        ({"indenter": {"shape": "area_function", "area": [2.45e-5]}}, "indenter.area", "0.16 degrees, expected 20 to"),
        (
            {"conditions": [CONDITION, CONDITION | {"name": "P2"}], "condition_sets": {"all": ["P1_T30"]}},
            "condition_sets.all",
            "'P2' has the role calibrate",
        ),
        ({"parameters": STUDY["parameters"] | {"youngs_modulus": [1, 5, 3, 2]}}, "youngs_modulus", "with a point"),
        ({"diagnosis": {"enabled": False, "mechanisms": ["xx"]}}, "diagnosis.mechanisms", "'xx' is not known"),
        ({"challenge": {"mechanisms": ["thermal_drfit"]}}, "challenge.mechanisms", "'thermal_drfit' is not known"),
        ({"challenge": {"mechanisms": ["friction"]}}, "challenge.mechanisms", "name more, or give two: 0"),
        ({"recordings": {"receipt.json": "x"}}, "recordings", "another name"),
        ({"recordings": {1: "x"}}, "recordings", "the key 1 is no text; put it in quotes"),
    ],
)
def test_a_bad_study_is_refused_with_place_and_remedy(tmp_path, change, place, words):
    with pytest.raises(InputError) as caught:
        load(tmp_path, **change)
    message = str(caught.value)
    assert str(tmp_path / "study.yaml") in message
    assert place in str(caught.value.place)
    assert words in message
    assert "\n" not in message


def test_a_misspelt_key_is_told_before_the_one_that_is_missing_for_it(tmp_path):
    file = tmp_path / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY).replace("indenter:", "indentor:"))
    with pytest.raises(InputError, match="did you mean 'indenter'"):
        load_study(file)


def test_numbers_may_be_written_as_everywhere_else(tmp_path):
    """PyYAML follows YAML 1.1, to which 1e1 is a word."""
    file = tmp_path / "study.yaml"
    text = yaml.safe_dump(STUDY, default_flow_style=None, sort_keys=False)
    file.write_text(text.replace("[3.0, 3.5]", "[4.e-1, 2.5e0, 1e1, 2E+1, .5e2]").replace("70.3", "7e1"))
    study = load_study(file)
    assert study.levels["youngs_modulus"] == (0.4, 2.5, 10.0, 20.0, 50.0)
    assert study.indenter.half_angle == 70.0


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ("loading_time: 030", "line 2: .*030 is not read as a decimal number"),
        ("loading_time: 1:30", "1:30 is not read as"),
        ("no: 3", "key 'no' is read as no text"),
        ("~: 3", "key '~' is read as no text"),
    ],
)
def test_what_yaml_would_read_as_something_else_is_refused(tmp_path, written, words):
    (tmp_path / "study.yaml").write_text(f"study: s\n{written}\n")
    with pytest.raises(InputError, match=words):
        load_study(tmp_path / "study.yaml")


def test_tests_may_be_named_by_their_numbers(tmp_path):
    (tmp_path / "vendor.txt").write_text("")
    contact = {1: 80.0, 3: 850.0}
    given = SOURCE | {"file": str(tmp_path / "vendor.txt"), "contact": contact}
    assert load(tmp_path, source=given, recordings={"lab": "x"}).source["contact"] == contact


def tables(kind, name=""):
    """Yield every table of keys within a declared type, with its place in a study's file."""
    kind = bare(kind)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield name or "At the top", kind
        for key, field in kind.model_fields.items():
            yield from tables(field.annotation, f"{name}.{key}".lstrip("."))
    else:
        for inner in get_args(kind):
            yield from tables(inner, name)


def section(name):
    """Return what the reference says under a heading, with what is generated there."""
    found = re.search(rf"^##+ `?{re.escape(name)}`?\n(.*?)(?=^##|\Z)", REFERENCE, re.MULTILINE | re.DOTALL)
    return HOOKS.expanded(found[1])


@pytest.mark.parametrize(("name", "table"), [pytest.param(*each, id=each[0]) for each in tables(StudyFile)])
def test_the_reference_tells_every_key_and_its_default(name, table):
    rows = re.search(r"\| key \| meaning \| accepted \| default \|\n.*?\n((?:\|.*\n)+)", section(name))[1].splitlines()
    told = {re.match(r"\| `(\w+)` \|", row)[1]: row for row in rows}
    further = {AREA} | {p.name for declared in SHAPES.values() for p in declared} if name == "indenter" else set()
    assert set(told) == set(table.model_fields) | further
    for key, field in table.model_fields.items():
        choices = [value for value in get_args(bare(field.annotation)) if isinstance(value, str)]
        assert all(f"`{value}`" in told[key] for value in choices), key
        shown = yaml.safe_load(told[key].split("|")[-2].strip(" `"))
        if isinstance(field.default, str | float | int):
            assert shown == field.default, key


def test_the_reference_tells_what_laws_declare():
    for law in LAWS.values():
        assert f"`{law.key}`" in section("material")
        assert all(f"`{p.name}`" in section("material") for p in law.parameters)


def test_broken_yaml_names_the_line(tmp_path):
    file = tmp_path / "study.yaml"
    file.write_text("study: s\nmaterial: {model: x\nparameters: 3\n")
    with pytest.raises(InputError, match="line 3"):
        load_study(file)


def test_simulate_writes_a_recording_and_refuses_bad_specifications(tmp_path, capsys):
    spec = {
        "material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "protocol": {"max_load": 1.0, "loading_time": 10, "unloading_time": 10, "points": 12},
        "kinematics": "small",
    }
    file, out = tmp_path / "spec.yaml", tmp_path / "curve.csv"
    file.write_text(yaml.safe_dump(spec))
    assert main(["simulate", str(file), "-o", str(out)]) == 0
    assert len(read_recording(out)) == 12
    for change, words in (
        ({"protocl": {}}, "protocl"),
        ({"protocol": {"max_load": -1, "loading_time": 1, "unloading_time": 1}}, "max_load"),
        ({"indenter": {"shape": "cone", "half_angle": 70.3, "friction": 3}}, "indenter.friction"),
        ({"accuracy": "best"}, "accuracy"),
        ({"indenter": "cone"}, "indenter is 'cone', expected a table of keys; write such as indenter: {shape: cone"),
        ({"protocol": 3}, "protocol is 3, expected a table of keys"),
    ):
        file.write_text(yaml.safe_dump(spec | change))
        assert main(["simulate", str(file), "-o", str(out)]) == 2
        line = capsys.readouterr().err.strip()
        assert str(file) in line
        assert words in line
        assert "\n" not in line


def test_a_condition_may_load_at_constant_strain_rate_or_in_cycles(tmp_path):
    rate = {"name": "R", "max_load": 1.0, "strain_rate": 0.05, "unloading_time": 5}
    cycles = {"name": "C", "times": [5, 10, 20], "loads": [0.5, 0.1, 1.0], "role": "validate"}
    study = load(tmp_path, conditions=[rate, cycles])
    assert study.condition("R").protocol.max_load == 1.0
    assert study.condition("C").protocol.knot_time.tolist() == [0, 5, 10, 20]


@pytest.mark.parametrize(
    ("condition", "place"),
    [
        ({"max_load": 1.0, "unloading_time": 30}, "(P).loading_time"),
        ({"max_load": 1.0, "strain_rate": 0.1, "loading_time": 5, "unloading_time": 30}, "(P).loading_time"),
        ({"times": [1, 2], "loads": [1]}, "(P).loads"),
        ({"times": [1, 2], "loads": [0, 0]}, "(P).loads"),
        ({"times": [1, 2], "loads": [1, -1]}, "(P).loads"),
        ({"max_load": 1.0, "loading_time": 1e-3, "hold_time": 864000, "unloading_time": 1e-3}, "(P).protocol"),
    ],
)
def test_a_load_history_that_is_none_is_refused_with_its_place(tmp_path, condition, place):
    with pytest.raises(InputError) as caught:
        load(tmp_path, conditions=[{"name": "P", **condition}])
    assert caught.value.place.endswith(place)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"time_s,load_mN\n0,0\n30,1,5\n60,0\n", "line 3: '30,1,5' is not two numbers"),
        ("time_s,load_mN\n0,0\n30,1\n60,0\n".encode("utf-16"), "is not text in UTF-8"),
    ],
)
def test_a_load_history_that_would_be_misread_is_refused(tmp_path, content, words):
    (tmp_path / "load.csv").write_bytes(content)
    with pytest.raises(InputError, match=words):
        load(tmp_path, conditions=[{"name": "P1_T30", "load_history": str(tmp_path / "load.csv")}])


def test_a_load_history_may_begin_with_the_mark_of_a_spreadsheet(tmp_path):
    (tmp_path / "load.csv").write_text("time_s,load_mN\n0,0\n30,1.5\n60,0\n", encoding="utf-8-sig")
    study = load(tmp_path, conditions=[{"name": "P1_T30", "load_history": str(tmp_path / "load.csv")}])
    assert study.conditions[0].protocol.max_load == 1.5


@pytest.mark.parametrize(
    ("loads", "words"), [((-0.0, -1.0, -2.0, 0.0), "never above zero"), ((2.0, 1.0, 0.5, 0.0), "does not rise")]
)
def test_a_load_that_cannot_be_followed_is_told_with_its_condition(tmp_path, loads, words):
    (tmp_path / "load.csv").write_text("time_s,load_mN\n" + "".join(f"{t},{load}\n" for t, load in enumerate(loads)))
    with pytest.raises(InputError, match=words) as caught:
        load(tmp_path, conditions=[CONDITION, {"name": "P", "load_history": str(tmp_path / "load.csv")}])
    assert caught.value.place == "conditions[1] (P).load_mN"


def test_snapshots_may_fill_the_ranges_instead_of_the_levels(tmp_path):
    levels = {"youngs_modulus": [3.0, 3.5], "retardation_time": [0.25]}
    study = load(tmp_path, parameters={**STUDY["parameters"], **levels}, design={"kind": "sobol", "points": 32})
    cells = study.cells
    moduli = np.array([cell["youngs_modulus"] for cell in cells])
    assert len(cells) == len(np.unique(moduli)) == 32
    assert {cell["retardation_time"] for cell in cells} == {0.25}
    assert np.all(np.histogram(moduli, 8, (3.0, 3.5))[0] == 4), "Sobol's points balance"


def test_whole_numbers_may_be_written_as_powers_of_ten(tmp_path):
    file = tmp_path / "study.yaml"
    written = yaml.safe_dump(STUDY | {"points": 50}).replace("points: 50", "points: 5e1\ncells_per_job: 1.0e+1")
    file.write_text(written)
    study = load_study(file)
    assert (study.points, study.cells_per_job) == (50, 10)
    assert isinstance(study.points, int) and isinstance(study.cells_per_job, int)


def test_numbers_that_the_command_line_reads_as_text_are_numbers_and_names_stay_text():
    """Snakemake reads 1e1 as text."""
    given = STUDY | {
        "study": "1e5",
        "points": "5e1",
        "parameters": STUDY["parameters"] | {"youngs_modulus": ["1e0", "2e0"]},
        "material": STUDY["material"] | {"poisson_ratio": "3.e-1"},
        "conditions": [CONDITION | {"name": "1e3", "max_load": "1e1"}],
        "recordings": {"1e2": "1e4"},
        "condition_sets": {"2e1": ["1e3"]},
        "surrogate": {"shape": "5e-1"},
        "diagnosis": {"reference": SILICA | {"youngs_modulus": "7.2e1", "area": ["2.45e1", 500]}},
        "source": SOURCE | {"contact": {"A": "1e2"}},
    }
    found = checked_file(given)
    assert (found.study, found.recordings, found.condition_sets) == ("1e5", {"1e2": "1e4"}, {"2e1": ["1e3"]})
    assert (found.points, found.surrogate.shape, found.source.contact) == (50, 0.5, {"A": 100.0})
    assert (found.conditions[0].name, found.conditions[0].max_load) == ("1e3", 10.0)
    assert found.parameters["youngs_modulus"] == [1.0, 2.0] and found.material.poisson_ratio == 0.3
    assert (found.diagnosis.reference.youngs_modulus, found.diagnosis.reference.area) == (72.0, [24.5, 500.0])


def test_the_vendors_file_may_stand_under_data(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / SOURCE["file"]).write_text("")
    study = load(tmp_path, source=SOURCE, recordings={"lab": "x"}, data=str(tmp_path / "folder"))
    assert Path(study.source["file"]).parent == tmp_path / "folder"
