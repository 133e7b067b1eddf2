"""Recordings of a study: good ones are resampled, bad ones are refused with file, place and remedy."""

import numpy as np
import pytest
from study_file import CONDITION, TRUTH, load

from indentation_files.recording import Recording
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.data.study_recordings import check, check_given, check_tests, observations
from palpate.errors import InputError
from palpate.study.protocol import trapezoid


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
    elif kind == "milliseconds":
        t = 1000 * t
    elif kind == "minutes":
        t = t / 60
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
        ("short", "ends after 45 s, the condition lasts 60 s; export the whole test or correct the times"),
        ("minutes", "ends after 1 s, the condition lasts 60 s; are times in min?"),
        ("slow", "load departs"),
        ("milliseconds", "it lasts 6e+04 s, are times in ms?"),
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


def test_a_laboratory_follows_a_history_and_prescribes_none(tmp_path):
    """Its set was written under another load; without a measured recording there is nothing to follow."""
    t, force, depth = curve()
    folders = {name: tmp_path / name for name in ("virtual", "lab")}
    for factor, folder in zip((2, 1), folders.values(), strict=True):
        folder.mkdir()
        write(folder / "P1_T30_1.csv", t, factor * force, depth)
    asked = {
        "conditions": [{"name": "P1_T30", "load_history": "recorded"}],
        "laboratory": {"virtual": {"parameters": TRUTH}},
    }
    sets = {name: str(folder) for name, folder in folders.items()}
    (condition,) = load(tmp_path, recordings=sets, **asked).conditions
    assert condition.protocol.max_load == pytest.approx(force.max(), rel=1e-2)
    with pytest.raises(InputError, match=r"P1_T30_1\.csv to a folder under recordings that no laboratory writes"):
        load(tmp_path, recordings={"virtual": sets["virtual"]}, **asked)


def test_recordings_by_another_clock_are_brought_to_contact(tmp_path):
    folder = tmp_path / "recordings"
    folder.mkdir()
    t, force, depth = curve(300)
    write(folder / "P1_T30_1.csv", t, force, depth)
    write(folder / "P1_T30_2.csv", t + 54.4, force, depth)
    item = observations(load(tmp_path, recordings={"lab": str(folder)}), "lab")["P1_T30"]
    assert item.response[1] == pytest.approx(item.response[0], abs=0.5)


def told(folder, capsys, **changes):
    load(folder, **changes)
    assert main(["check", str(folder / "study.yaml")]) == 0
    return capsys.readouterr().out


def test_check_tells_what_will_be_done_and_what_is_missing_for_it(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "nothing will be calibrated" in told(tmp_path, capsys)
    (tmp_path / "own").mkdir()
    conditions = [CONDITION, CONDITION | {"name": "V", "role": "validate"}]
    for name, scale in (("P1_T30_1", 1.0), ("V_1", 1.02)):
        write(tmp_path / f"own/{name}.csv", *curve(scale=scale))
    once = told(tmp_path, capsys, recordings={"lab": "own"}, conditions=conditions)
    assert "4 materials, 2 conditions, 4 snapshots" in once
    assert "calibrated on P1_T30; validated on V" in once
    assert f"recordings lab in {tmp_path / 'own'}: 1 of P1_T30, 1 of V" in once
    assert "too few tests are repeated" in once
    write(tmp_path / "own/P1_T30_2.csv", *curve(scale=1.01))
    again = told(tmp_path, capsys, recordings={"lab": "own"}, conditions=conditions)
    assert "2 of P1_T30" in again
    assert "too few" not in again


def test_check_tells_which_conditions_share_their_simulations(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    twice = CONDITION | {"name": "P2_T30", "max_load": 2.0 * CONDITION["max_load"]}
    slow = CONDITION | {"name": "slow", "loading_time": 2.0 * CONDITION["loading_time"]}
    shared = "P1_T30, P2_T30 differ in size alone: one simulation gives them all"
    assert shared in told(tmp_path, capsys, conditions=[CONDITION, slow, twice])
    assert "one simulation" not in told(tmp_path, capsys, conditions=[CONDITION, slow])


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
    (folder / "P2_T30_1.csv").rename(folder / "P1_T30_.csv")
    with pytest.raises(InputError, match="CONDITION_REPLICATE"):
        check(study, "lab")
    (folder / "P1_T30_.csv").rename(folder / "P2_T30_1.csv")
    with pytest.raises(InputError, match=r"P2_T30_1\.csv: is a file, no folder; correct recordings.lab"):
        check(load(tmp_path, recordings={"lab": str(folder / "P2_T30_1.csv")}), "lab")


def test_a_file_named_after_a_condition_alone_is_no_replicate_of_another(tmp_path):
    for name in ("P1_1", "P1_T2_1", "P1_T2"):
        write(tmp_path / f"{name}.csv", *curve(scale=1 + 0.01 * len(name)))
    conditions = [CONDITION | {"name": name} for name in ("P1", "P1_T2")]
    study = load(tmp_path, recordings={"lab": str(tmp_path)}, conditions=conditions)
    with pytest.raises(InputError, match=r"P1_T2\.csv: the file's name is that of a condition, without a replicate"):
        check(study, "lab")


def test_tests_of_unlike_loads_last_about_as_long(tmp_path):
    """Times in another unit would vanish where tests are brought to one duration."""
    t, force, depth = curve()
    write(tmp_path / "P1_T30_1.csv", t, force, depth)
    own = [{"name": "P1_T30", "load_history": "recorded", "own_loads": True}]
    study = load(tmp_path, recordings={"lab": str(tmp_path)}, conditions=own)
    for factor, words in ((0.5, None), (1 / 60, "ends after 1 s, .*; are times in min?"), (1000, "are times in ms?")):
        write(tmp_path / "P1_T30_2.csv", factor * t, 0.8 * force, 0.9 * depth)
        if words is None:
            check(study, "lab")
        else:
            with pytest.raises(InputError, match=words):
                check(study, "lab")


def test_a_replicate_of_another_course_is_not_told_what_its_condition_has(tmp_path):
    t, force, depth = curve()
    write(tmp_path / "P1_T30_1.csv", t, force, depth)
    write(tmp_path / "P1_T30_2.csv", 2 * t, force, depth)
    study = load(
        tmp_path, recordings={"lab": str(tmp_path)}, conditions=[{"name": "P1_T30", "load_history": "recorded"}]
    )
    with pytest.raises(InputError, match=r"the load departs .*; give the test a condition of its own, or remove it"):
        check(study, "lab")


def test_check_tells_a_load_that_is_misstated_and_recordings_in_a_folder_below(tmp_path, capsys):
    folder = tmp_path / "own"
    (folder / "day_2").mkdir(parents=True)
    t, force, depth = curve()
    write(folder / "day_2/P1_T30_3.csv", t, force, depth)
    recordings = {"lab": str(folder)}
    for size, is_told in ((1.005, False), (1.04, True)):
        for number in (1, 2):
            write(folder / f"P1_T30_{number}.csv", t, size * force, (size + 0.01 * number) * depth)
        said = told(tmp_path, capsys, recordings=recordings, conditions=[CONDITION | {"hold_time": 0}])
        assert ("of P1_T30 is 1.04 mN in the median of its tests, the study states 1 mN" in said) == is_told
        assert "the recordings in the folder day_2 are not read" in said


def test_a_copy_is_no_replicate(tmp_path):
    for name, scale in (("1", 1.0), ("2", 1.01), ("2 (copy)", 1.01)):
        write(tmp_path / f"P1_T30_{name}.csv", *curve(scale=scale))
    study = load(tmp_path, recordings={"lab": str(tmp_path)})
    with pytest.raises(InputError, match=r"P1_T30_2\.csv: is the same recording as P1_T30_2 \(copy\)\.csv; remove one"):
        check_given(study)


def test_a_copy_of_a_fitted_test_validates_nothing(tmp_path):
    conditions = [CONDITION, CONDITION | {"name": "V", "role": "validate"}]
    for name in ("P1_T30_1", "V_1"):
        write(tmp_path / f"{name}.csv", *curve())
    study = load(tmp_path, recordings={"lab": str(tmp_path)}, conditions=conditions)
    with pytest.raises(InputError, match=r"V_1\.csv: is the same recording as P1_T30_1\.csv; remove one"):
        check(study, "lab")
    test = Recording(*curve(), name="one")
    with pytest.raises(InputError, match="one of V: is the same recording as one of P1_T30"):
        check_tests(study, {"P1_T30": [test], "V": [test]})


def test_columns_of_a_source_are_never_passed_over(tmp_path, capsys):
    """The file is of a known format, which would be read without them."""
    write(tmp_path / "day.csv", *curve())
    with (tmp_path / "day.csv").open("a") as stream:
        stream.write("61,x,2\n")
    columns = {"time": "time_s", "load": "load_mN", "depth": "depth_nm"}
    source = {"file": str(tmp_path / "day.csv"), "recordings": "lab", "condition": CONDITION["name"]}
    recordings = {"lab": "results/s/recordings/lab"}
    said = told(tmp_path, capsys, source=source | {"columns": columns}, recordings=recordings)
    assert "recordings lab: day: 1 of 81 rows left out" in said
    wrong = source | {"columns": columns | {"time": "Tiem"}, "units": {"depth": "um"}}
    with pytest.raises(InputError, match=r"source\.columns: .* the columns Tiem, load_mN, .*header \(time_s, load_mN"):
        check_given(load(tmp_path, source=wrong, recordings=recordings))


def test_a_copy_in_a_vendors_file_is_no_replicate(tmp_path):
    rows = [f"{t:.6g};{load:.6g};{depth:.6g}" for t, load, depth in zip(*curve(), strict=True)]
    header = "Time [s];Load [mN];Depth [nm]"
    (tmp_path / "day.txt").write_text("\n".join([header, *rows, "", header, *rows]) + "\n")
    columns = {"time": "Time [s]", "load": "Load [mN]", "depth": "Depth [nm]"}
    source = {
        "file": str(tmp_path / "day.txt"),
        "recordings": "lab",
        "condition": CONDITION["name"],
        "columns": columns,
    }
    study = load(tmp_path, source=source, recordings={"lab": str(tmp_path / "lab")})
    with pytest.raises(InputError, match=r"day\.txt, .*: is the same recording as .*; remove one of them"):
        check_given(study)


def test_good_recordings_are_resampled(tmp_path):
    folder = tmp_path / "recordings"
    folder.mkdir()
    write(folder / "P1_T30_1.csv", *curve(160))
    write(folder / "P1_T30_2.CSV", *curve(100, scale=1.01))
    (folder / "._P1_T30_1.csv").write_bytes(b"\x00\x05\x16\x07 what macOS leaves on foreign disks")
    item = observations(load(tmp_path, recordings={"lab": str(folder)}), "lab")["P1_T30"]
    assert item.response.shape == (2, 100)
    assert (item.response[1] / item.response[0])[5:] == pytest.approx(1.01, abs=2e-3)


def test_recordings_survive_writing(tmp_path):
    one = Recording(*curve(), name="a", notes=("hello",))
    one.write(tmp_path / "a.csv")
    other = read_recording(tmp_path / "a.csv")
    assert other.depth == pytest.approx(one.depth, rel=1e-8)
    assert other.notes == ("hello",)
    assert [file.name for file in tmp_path.iterdir()] == ["a.csv"]


def test_a_sphere_with_its_radius_in_micrometres_is_told(tmp_path):
    write(tmp_path / "P1_T30_1.csv", *curve())
    sphere = {"indenter": {"shape": "sphere", "radius": 50}}
    with pytest.raises(InputError, match="under a sphere of 50 nm; is the radius in um"):
        check(load(tmp_path, recordings={"lab": str(tmp_path)}, **sphere), "lab")
