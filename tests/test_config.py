"""Bad studies and recordings are refused with file, place and remedy; good ones mean what they say."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

import palpate
from palpate.cli import main
from palpate.config import load_study
from palpate.errors import InputError
from palpate.indenters import SHAPES
from palpate.materials import LAWS
from palpate.mechanisms import MECHANISMS, Scale
from palpate.observations import check, observations
from palpate.protocol import recorded, trapezoid
from palpate.recording import Recording, read_recording

STUDY = {
    "study": "s",
    "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34},
    "parameters": {
        "youngs_modulus": [3.0, 3.5],
        "steady_coefficient": [0.05, 0.1],
        "steady_exponent": [0.2],
        "transient_coefficient": [0.24],
        "transient_exponent": [0.4],
        "retardation_time": [0.25],
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "P1_T30", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}],
}
TRUTH = {name: levels[0] for name, levels in STUDY["parameters"].items()}
SCHEMA = json.loads((Path(palpate.__file__).parent / "study.schema.json").read_text())
REFERENCE = (Path(__file__).parents[1] / "docs/study.md").read_text()
CONDITION = STUDY["conditions"][0]
LABORATORY = {"recordings": {"lab": "x"}}
SOURCE = {"file": "nowhere.txt", "recordings": "lab", "condition": "P1_T30"}


def load(folder, **changes):
    file = folder / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY | changes, sort_keys=False))
    return load_study(file)


def test_defaults_and_order(tmp_path):
    study = load(tmp_path)
    assert study.condition_sets == {"all": ("P1_T30",)}
    assert len(study.cells) == 4
    assert study.cells[1] == {**study.cells[0], "steady_coefficient": 0.1}
    assert study.free_parameters == ("youngs_modulus", "steady_coefficient")
    assert (study.points, study.kinematics, study.calibration["population"]) == (100, "large", 200)


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
        ({"laboratory": {"lab": {"parameters": TRUTH}}}, "laboratory.lab", "recordings"),
        (LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH | {"youngs": 3}}}}, "lab.parameters", "youngs"),
        (LABORATORY | {"laboratory": {"lab": {"parameters": TRUTH | {"youngs_modulus": -3}}}}, "parameters", "-3"),
        ({"source": SOURCE | {"recordings": "lib"}, "recordings": {"lab": "x"}}, "source.recordings", "'lab'"),
        ({"source": SOURCE | {"condition": "P1"}, "recordings": {"lab": "x"}}, "source.condition", "P1_T30"),
        (
            {"source": SOURCE, "recordings": {"lab": "x"}, "conditions": [CONDITION, CONDITION | {"name": "P2"}]},
            "source",
            "no test of condition 'P2' is named",
        ),
        ({"source": SOURCE, "recordings": {"lab": "x"}}, "source.file", "--data PATH, snakemake --config data=PATH"),
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
    file.write_text(text.replace("[3.0, 3.5]", "[1e1, 2E+1, 2.5e0, .5e2, 4.e-1]").replace("70.3", "7e1"))
    study = load_study(file)
    assert study.levels["youngs_modulus"] == (10.0, 20.0, 2.5, 50.0, 0.4)
    assert study.indenter.half_angle == 70.0


def tables(rule, name=""):
    """Yield every table of keys within a rule of the schema, with its name."""
    if "properties" in rule:
        yield name or "At the top", rule["properties"]
    for key, inner in rule.get("properties", {}).items():
        for part in (inner, inner.get("items"), inner.get("additionalProperties")):
            if isinstance(part, dict):
                yield from tables(part, f"{name}.{key}".lstrip("."))


def section(name):
    """Return what the reference says under a heading."""
    return re.search(rf"^##+ `?{re.escape(name)}`?\n(.*?)(?=^##|\Z)", REFERENCE, re.MULTILINE | re.DOTALL)[1]


@pytest.mark.parametrize(("name", "rules"), [pytest.param(*table, id=table[0]) for table in tables(SCHEMA)])
def test_the_reference_tells_every_key_and_its_default(name, rules):
    rows = re.search(r"\| key \| meaning \| accepted \| default \|\n.*?\n((?:\|.*\n)+)", section(name))[1].splitlines()
    told = {re.match(r"\| `(\w+)` \|", row)[1]: row for row in rows}
    further = {p.name for declared in SHAPES.values() for p in declared} if name == "indenter" else set()
    assert set(told) == set(rules) | further
    for key, rule in rules.items():
        assert all(f"`{value}`" in told[key] for value in rule.get("enum", ())), key
        if "default" in rule:
            assert yaml.safe_load(told[key].split("|")[-2].strip(" `")) == rule["default"], key


def test_the_reference_tells_what_laws_and_mechanisms_declare():
    for law in LAWS.values():
        assert f"`{law.key}`" in section("material")
        assert all(f"`{p.name}`" in section("material") for p in law.parameters)
    scale = Scale(depth=500.0, load=1.0, modulus=3.0, duration=60.0, loading_time=30.0, half_angle=70.3, pressure=0.1)
    for mechanism in MECHANISMS.values():
        row = re.search(rf"^\| `{mechanism.key}` \|(.*)$", section("diagnosis"), re.MULTILINE)[1]
        assert all(f"`{name}`" in row for name in mechanism.searched(scale))


def test_broken_yaml_names_the_line(tmp_path):
    file = tmp_path / "study.yaml"
    file.write_text("study: s\nmaterial: {model: x\nparameters: 3\n")
    with pytest.raises(InputError, match="line 3"):
        load_study(file)


def curve(n=80, scale=1.0, end=60.0):
    protocol = trapezoid(1.0, 30.0, 0.0, 30.0, points=n)
    t = protocol.sample_time
    return t * end / 60.0, protocol.sample_load, 500 * scale * np.sqrt(np.minimum(t, 30) / 30)


def write(path, t, load, depth):
    rows = [f"{a:.6g},{b:.6g},{c:.6g}" for a, b, c in zip(t, load, depth, strict=True)]
    path.write_text("\n".join(["# note", "time_s,load_mN,depth_nm", *rows]) + "\n")


def spoiled(kind):
    t, load, depth = curve()
    if kind == "backwards":
        t[10] = t[9]
    elif kind == "nan":
        depth[5] = np.nan
    elif kind == "micrometres":
        depth = depth / 1000
    elif kind == "micronewtons":
        load = load * 1000
    elif kind == "few":
        t, load, depth = t[::79], load[::79], depth[::79]
    elif kind == "slow":
        t = np.where(t > 30, 30 + (t - 30) / 3, t)
        t[-1] = 60.0
    elif kind == "short":
        t, load, depth = t[:60], load[:60], depth[:60]
    elif kind == "pulled":
        load = -load
    elif kind == "upwards":
        depth = -depth
    return t, load, depth


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("backwards", "time does not increase"),
        ("nan", "not a number"),
        ("micrometres", "micrometres"),
        ("micronewtons", "uN"),
        ("few", "has 2 points for 2 free parameters"),
        ("pulled", "the load is negative, down to -1 mN: its sign is wrong"),
        ("upwards", "the depth is negative, down to -500 nm: its sign is wrong"),
        ("short", "ends after"),
        ("slow", "load departs"),
    ],
)
def test_a_bad_recording_is_refused_by_name(tmp_path, kind, words, capsys):
    folder = tmp_path / "recordings"
    folder.mkdir()
    write(folder / "P1_T30_1.csv", *spoiled(kind))
    load(tmp_path, recordings={"lab": str(folder)})
    assert main(["check", str(tmp_path / "study.yaml")]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "P1_T30_1.csv" in lines[0]
    assert words in lines[0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("time,load,depth\n0,0,0\n", "header"),
        ("time_s;load_mN;depth_nm\n0;0;0\n", "line 1: the columns are not separated by commas"),
        ("time_s\tload_mN\tdepth_nm\n0\t0\t0\n", "palpate read --columns"),
        ("time_s,load_mN,depth_nm\n0,0,0\n1,abc,2\n", "line 3"),
        ("time_s,load_mN,depth_nm\n0;0;0\n", "line 2"),
    ],
)
def test_a_malformed_file_is_refused_with_its_line(tmp_path, text, words):
    file = tmp_path / "r.csv"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_recording(file)
    assert words in str(caught.value)
    assert str(file) in str(caught.value)


@pytest.mark.parametrize(
    ("load_factor", "depth_factor", "words"),
    [(1, 1, None), (1000, 1, "loads in uN"), (1e-3, 1, "loads in N"), (1, 1e-3, "micrometres"), (1, 1e3, "in pm")],
)
def test_mistaken_units_show_even_under_the_recorded_load(tmp_path, load_factor, depth_factor, words):
    folder = tmp_path / "recordings"
    folder.mkdir()
    t, force, depth = curve()
    write(folder / "P1_T30_1.csv", t, load_factor * force, depth_factor * depth)
    history = [{"name": "P1_T30", "load_history": "recorded"}]
    study = load(tmp_path, recordings={"lab": str(folder)}, conditions=history)
    if words is None:
        check(study, "lab")
    else:
        with pytest.raises(InputError, match=words):
            check(study, "lab")


@pytest.mark.parametrize("ending", ["csv", "CSV"])
def test_a_load_history_is_taken_from_the_recording_of_its_condition(tmp_path, ending):
    folder = tmp_path / "recordings"
    folder.mkdir()
    t, force, depth = curve()
    write(folder / f"P1_T30_2_1.{ending}", t, 2 * force, depth)
    write(folder / f"P1_T30_1.{ending}", t, force, depth)
    history = [{"name": "P1_T30", "load_history": "recorded"}]
    (condition,) = load(tmp_path, recordings={"lab": str(folder)}, conditions=history).conditions
    assert condition.protocol.max_load == pytest.approx(force.max(), rel=1e-2)


def test_recordings_by_another_clock_are_brought_to_contact(tmp_path):
    folder = tmp_path / "recordings"
    folder.mkdir()
    t, force, depth = curve(300)
    write(folder / "P1_T30_1.csv", t, force, depth)
    write(folder / "P1_T30_2.csv", t + 54.4, force, depth)
    item = observations(load(tmp_path, recordings={"lab": str(folder)}), "lab")["P1_T30"]
    assert item.depth[1] == pytest.approx(item.depth[0], abs=0.5)


def told(folder, capsys, **changes):
    load(folder, **changes)
    assert main(["check", str(folder / "study.yaml")]) == 0
    return capsys.readouterr().out


def test_check_tells_what_will_be_done_and_what_is_missing_for_it(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "nothing will be calibrated" in told(tmp_path, capsys)
    (tmp_path / "own").mkdir()
    conditions = [CONDITION, CONDITION | {"name": "V", "role": "validate"}]
    for name in ("P1_T30_1", "V_1"):
        write(tmp_path / f"own/{name}.csv", *curve())
    once = told(tmp_path, capsys, recordings={"lab": "own"}, conditions=conditions)
    assert "4 cells, 2 conditions, 4 snapshots" in once
    assert "calibrated on P1_T30; judged by V" in once
    assert f"recordings lab in {tmp_path / 'own'}: 1 of P1_T30, 1 of V" in once
    assert "too few tests are repeated" in once
    write(tmp_path / "own/P1_T30_2.csv", *curve())
    again = told(tmp_path, capsys, recordings={"lab": "own"}, conditions=conditions)
    assert "2 of P1_T30" in again
    assert "too few" not in again


def test_missing_recordings_and_strange_files(tmp_path):
    folder = tmp_path / "recordings"
    study = load(tmp_path, recordings={"lab": str(folder)})
    with pytest.raises(InputError, match="folder is missing"):
        check(study, "lab")
    folder.mkdir()
    with pytest.raises(InputError, match="no recording of condition"):
        check(study, "lab")
    write(folder / "P2_T30_1.csv", *curve())
    with pytest.raises(InputError, match="CONDITION_REPLICATE"):
        check(study, "lab")


def test_good_recordings_are_resampled(tmp_path):
    folder = tmp_path / "recordings"
    folder.mkdir()
    write(folder / "P1_T30_1.csv", *curve(160))
    write(folder / "P1_T30_2.CSV", *curve(100, scale=1.01))
    (folder / "._P1_T30_1.csv").write_bytes(b"\x00\x05\x16\x07 what macOS leaves on foreign disks")
    item = observations(load(tmp_path, recordings={"lab": str(folder)}), "lab")["P1_T30"]
    assert item.depth.shape == (2, 100)
    assert (item.depth[1] / item.depth[0])[5:] == pytest.approx(1.01, abs=2e-3)


def test_recordings_survive_writing(tmp_path):
    one = Recording(*curve(), name="a", notes=("hello",))
    one.write(tmp_path / "a.csv")
    other = read_recording(tmp_path / "a.csv")
    assert other.depth == pytest.approx(one.depth, rel=1e-8)
    assert other.notes == ("hello",)
    assert [file.name for file in tmp_path.iterdir()] == ["a.csv"]


def test_recorded_history_is_thinned_within_its_tolerance():
    t = np.linspace(0, 60, 5000)
    load = np.interp(t, [0, 30, 40, 60], [0, 5, 5, 0]) + 1e-3 * np.sin(40 * t)
    protocol = recorded(t, load)
    assert len(protocol.knot_time) < 60
    assert np.abs(protocol.load_at(t) - load).max() < 2e-3 * load.max() + 1e-3


def test_trapezoid_samples_all_corners():
    protocol = trapezoid(2.0, 10.0, 3.0, 5.0, points=31)
    assert len(protocol.sample_time) == 31
    for corner in (10.0, 13.0, 18.0):
        assert np.isclose(protocol.sample_time, corner).any()
    assert protocol.sample_load[-1] == 0.0


def test_simulate_writes_a_recording_and_refuses_bad_specifications(tmp_path, capsys):
    spec = {
        "material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3},
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "protocol": {"max_load": 1.0, "loading_time": 10, "unloading_time": 10, "points": 12},
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
        ({"times": [1, 2], "loads": [0, 0]}, "(P)"),
    ],
)
def test_a_load_history_that_is_none_is_refused_with_its_place(tmp_path, condition, place):
    with pytest.raises(InputError) as caught:
        load(tmp_path, conditions=[{"name": "P", **condition}])
    assert caught.value.place.endswith(place)


def test_snapshots_may_fill_the_ranges_instead_of_the_levels(tmp_path):
    levels = {"youngs_modulus": [3.0, 3.5], "retardation_time": [0.25]}
    study = load(tmp_path, parameters={**STUDY["parameters"], **levels}, design={"kind": "sobol", "points": 32})
    cells = study.cells
    moduli = np.array([cell["youngs_modulus"] for cell in cells])
    assert len(cells) == len(np.unique(moduli)) == 32
    assert {cell["retardation_time"] for cell in cells} == {0.25}
    assert np.all(np.histogram(moduli, 8, (3.0, 3.5))[0] == 4), "Sobol's points balance"
