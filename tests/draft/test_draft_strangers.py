"""Drafts of what strangers bring: odd names, foreign files, mistaken units, tips stated and not taken, preloads."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from elastic_tests import elastic
from public_files import ANON, HLD, XP, needs_recordings

from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.draft.guesses import ranges
from palpate.draft.known_tip import KnownTip
from palpate.draft.remarks import not_taken
from palpate.draft.solid import Solid
from palpate.draft.stated import Stated
from palpate.draft.yaml_text import scalar, study_name
from palpate.materials import LAWS, law_of

HEADER = "Indentation\n   Poisson's ratio(nu)=\t{}\nTime (s)\tPd (nm)\tFn (mN)\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Work in a folder with one good recording of an elastic body."""
    monkeypatch.chdir(tmp_path)
    elastic(1.0, 20).write("good.csv")
    return tmp_path


def drafted(*arguments, law="elastic"):
    return main(["draft", *map(str, arguments), "--law", law])


def anton_paar(path, poisson_ratio, load=1.0):
    """Write a test as an Anton Paar export."""
    test = elastic(load, 20)
    rows = "\n".join(f"{t:.4f}\t{h:.4f}\t{p:.6f}" for t, h, p in zip(test.time, test.depth, test.load, strict=True))
    Path(path).write_text(HEADER.format(poisson_ratio) + rows + "\n", encoding="utf-8")


NAMES = ["2024-03-05", "12", "007", "1e5", "on", "yes", "null", "1.5", "thesis", "0x1F"]
FOLDERS = [
    "a #b", "a, b", "{a}", "a: b", "[a]", "&a", "*a", "!a", "%a", "@a", "a\nb", "\N{GRINNING FACE}", "'a\"",
]  # fmt: skip


@pytest.mark.parametrize("name", [*NAMES, *FOLDERS])
def test_a_study_is_read_back_whatever_its_folder_is_called(name):
    assert drafted("good.csv", "-o", name) == 0
    study = load_study(Path(name) / "study.yaml")
    assert study.recordings == {"lab": Path(name) / "recordings"}


def test_a_name_that_needs_no_quotes_has_none():
    assert [scalar(text) for text in ("my_study", "my study/recordings", "/tmp/a-b/c")] == [
        "my_study", "my study/recordings", "/tmp/a-b/c",
    ]  # fmt: skip
    assert [yaml.safe_load(f"{{lab: {scalar(text)}}}")["lab"] for text in FOLDERS] == FOLDERS
    assert study_name(Path("verification")) == "verification_study"


def test_foreign_files_are_named_and_left_out(capsys):
    Path("LICENSE").write_text("MIT License\n\nPermission is hereby granted\n")
    Path("notes.txt").write_text("Tuesday: sample 3; new tip, 2 mN\n1, 2, 3\n")
    Path("picture.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)))
    Path("archive.xlsx").write_bytes(b"PK\x03\x04" + bytes(200))
    Path("folder").mkdir()
    elastic(1.0, 20).at(slice(0, None, 90)).write("short.csv")
    foreign = ["LICENSE", "notes.txt", "picture.png", "archive.xlsx", "folder", "short.csv", "gone.csv"]
    assert drafted(*foreign, "good.csv", "-o", "out") == 0
    told = capsys.readouterr().err.splitlines()
    assert len(told) == len(foreign)
    for name, line in zip(foreign, told, strict=True):
        assert line.startswith(f"palpate: {name}") and line.endswith("the file is left out")
    assert [file.name for file in Path("out/recordings").iterdir()] == ["P1_T20_1.csv"]


def test_where_nothing_can_be_read_nothing_is_written(capsys):
    Path("LICENSE").write_text("MIT License\n")
    Path("folder").mkdir()
    assert drafted("LICENSE", "folder", "-o", "out") == 2
    assert "LICENSE: is of no format" in capsys.readouterr().err
    assert not Path("out").exists()


@pytest.mark.parametrize("law", ["nonlinear_burgers", "bilinear_plasticity"])
@pytest.mark.parametrize("mistake", ["um", "uN", "swapped"])
def test_a_mistaken_unit_is_asked_for_and_leaves_nothing_behind(capsys, law, mistake):
    test = elastic(1.0, 20)
    changed = {
        "um": {"depth": 1e-3 * test.depth},
        "uN": {"load": 1e3 * test.load},
        "swapped": {"load": test.depth, "depth": test.load},
    }
    replace(test, **changed[mistake]).write("wrong.csv")
    assert drafted("wrong.csv", "-o", "new/out", law=law) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "wrong.csv, wrong, depth_nm" in line
    assert "are depths in micrometres, or loads in uN" in line
    assert not Path("new").exists()
    assert drafted("good.csv", "wrong.csv", "-o", "out", law=law) == 0
    line = next(line for line in capsys.readouterr().err.splitlines() if "wrong.csv, wrong, depth_nm" in line)
    assert line.endswith("or the two swapped?; the test is left out")
    assert [file.name for file in Path("out/recordings").iterdir()] == ["P1_T20_1.csv"]


def test_a_body_softer_than_any_is_a_mistaken_unit(capsys):
    test = elastic(1.0, 20)
    replace(test, depth=1e6 * test.depth).write("wrong.csv")
    assert drafted("wrong.csv", "-o", "out") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "wrong.csv, wrong, depth_nm" in line and "Pa, softer than any gel; is the unit of the depth" in line


def test_one_load_that_stands_out_is_the_reason_of_its_refusal(capsys):
    test = elastic(1.0, 20)
    odd = len(test) // 5
    load = test.load.copy()
    load[odd] = 100 * test.load.max()
    replace(test, load=load).write("spike.csv")
    assert drafted("spike.csv", "-o", "out") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"its load jumps to {load[odd]:.4g} mN at {test.time[odd]:.4g} s, where the points beside it read" in line


def test_loads_in_n_are_asked_for(capsys):
    """They may be a rubber's, so that the draft goes on."""
    test = elastic(1.0, 20)
    replace(test, load=1e-3 * test.load).write("soft.csv")
    assert drafted("soft.csv", "-o", "out") == 0
    assert "are depths in pm, or loads in N?" in capsys.readouterr().err


def test_a_draft_that_is_not_sound_is_taken_back(monkeypatch):
    """What else lies in the folder stays."""
    Path("out").mkdir()
    Path("out/mine.txt").write_text("precious")
    monkeypatch.setattr("palpate.draft.guesses.POINTS", {1: -1})
    assert drafted("good.csv", "-o", "out") == 2
    assert [file.name for file in Path("out").iterdir()] == ["mine.txt"]


def test_a_recording_that_is_not_sound_is_named_as_it_was_given(capsys):
    test = elastic(2.0, 20)
    replace(test, depth=100.0 * test.depth).write("soft.csv")
    elastic(4.0, 20).write("third.csv")
    assert drafted("good.csv", "soft.csv", "third.csv", "-o", "out") == 0
    line = next(line for line in capsys.readouterr().err.splitlines() if line.endswith("the test is left out"))
    assert line.startswith("palpate: soft.csv, soft, depth_nm: ") and "are depths in pm, or loads in N?" in line
    assert len(list(Path("out/recordings").iterdir())) == 2


def test_a_name_that_is_no_text_is_written_as_numbers():
    name = b"caf\xe9\x1b.csv".decode(errors="surrogateescape")
    Path("good.csv").rename(name)
    assert drafted(name, "-o", "out") == 0
    assert read_recording("out/recordings/P1_T20_1.csv").notes[0].startswith("from caf\\udce9\\x1b.csv, caf")


@pytest.mark.parametrize("modulus", [1e-6, 1e-3, 1.0, 1199.0])
def test_no_range_leaves_that_of_its_parameter(modulus):
    solid = Solid(modulus, modulus, 0.1 * modulus)
    for key in LAWS:
        law = f"eyring+{key}" if key == "kinematic_hardening" else key  # a back stress needs a flow
        declared = {parameter.name: parameter for parameter in law_of(law).declared({})}
        for name, (values, _) in ranges(law, solid, 20.0).items():
            assert [declared[name].check(value) for value in values] == list(values)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("Poisson's ratio(nu)", 0.3), ("Poisson\u2019s ratio", 0.3), ("Sample Poisson Ratio", 0.3),
        ("Poissons Ratio", 0.3), ("Poisson's ratio of indenter", None),
    ],
)  # fmt: skip
def test_poisson_s_ratio_is_taken_whatever_the_vendor(key, value):
    assert Stated.by_all([{key: "0,30"}] * 2).poisson_ratio == value


def test_poisson_s_ratio_of_a_header_is_taken_and_kept_through_read(capsys):
    anton_paar("test.TXT", "0,30")
    assert drafted("test.TXT", "-o", "out") == 0
    assert load_study("out/study.yaml").fixed["poisson_ratio"] == 0.3
    assert main(["read", "test.TXT", "-o", "read"]) == 0
    assert drafted("read/test.csv", "-o", "again") == 0
    assert load_study("again/study.yaml").fixed["poisson_ratio"] == 0.3
    assert capsys.readouterr().err == ""


def remark(folder, capsys, words):
    """Return the line with these words on stderr, after seeing it among the study's comments, too."""
    (line,) = [line for line in capsys.readouterr().err.splitlines() if words in line]
    comments = " ".join(
        line.lstrip("# ") for line in (folder / "study.yaml").read_text().splitlines() if line.startswith("#")
    )
    assert line.removeprefix("palpate: ") in comments
    return line


def test_files_that_disagree_are_told(capsys):
    for name, value, load in (("a.TXT", "0,30", 1.01), ("b.TXT", "0,40", 2.0), ("c.TXT", "0,40", 4.0)):
        anton_paar(name, value, load)
    assert drafted("a.TXT", "b.TXT", "c.TXT", "good.csv", "-o", "out") == 0
    line = remark(Path("out"), capsys, "Poisson's ratio")
    assert "0.3 by a.TXT, a; 0.4 by b.TXT, b and 1 more; nothing by good.csv, good; 0.35 is guessed" in line
    anton_paar("d.TXT", "0,50")
    assert drafted("d.TXT", "-o", "half") == 0
    assert "stated as 0.5 and not taken, as it is not above 0" in remark(Path("half"), capsys, "Poisson's ratio")


@pytest.mark.parametrize(
    ("tips", "words"),
    [
        ([{}, {}], None),
        ([{"Tip C0": "24.5 nm^2/nm^2"}, {}], None),
        ([{"Tip C0": "2.598 nm^2/nm^2"}] * 2, "stated as 2.598 and not taken, as a single coefficient"),
        ([{"Tip C0": "24.5", "Tip C1": "800"}, {"Tip C0": "24.5"}], "24.5, 800 by 0; 24.5 by 1"),
        ([{"Tip C0": "24.5", "Tip C1": "800"}] * 2, None),
        (
            [{"Tip radius (um)": "0"}] * 2,
            "radius is stated as Tip radius (um) 0 and not taken, as it is no length above",
        ),
        (
            [{"Tip radius (um)": "10"}, {"Tip radius (um)": "50"}],
            "(um) 10 by 0; Tip radius (um) 50 by 1; a Berkovich tip",
        ),
        ([{"Tip radius (um)": "10"}] * 2, None),
    ],
    ids=["none", "ideal", "cube corner", "unlike", "taken", "no radius", "unlike radii", "radius"],
)
def test_a_tip_is_told_where_it_is_stated_and_not_taken(tips, words):
    stated, named = Stated.by_all(tips), [(str(number), tip) for number, tip in enumerate(tips)]
    told = not_taken(named, stated, KnownTip.of(stated, None, 0.0), 0.0, 0.35)
    assert len(told) == (words is not None)
    assert words is None or words in told[0]


@needs_recordings
def test_a_stated_tip_that_is_not_taken_is_told(capsys):
    assert drafted(HLD, "-o", "steel", law="bilinear_plasticity") == 0
    line = remark(Path("steel"), capsys, "tip")
    assert "24.5, -329697" in line and "it gives 38% of the area that its first term does" in line
    assert drafted(HLD, "-o", "ball", "--sphere", "5000") == 0
    assert "tip" not in capsys.readouterr().err
    assert drafted(HLD, XP, "-o", "both", law="bilinear_plasticity") == 0
    assert "differs between the files" in remark(Path("both"), capsys, "tip")


@needs_recordings
def test_a_real_header_s_poisson_s_ratio_is_taken():
    assert drafted(ANON, "-o", "out") == 0
    assert load_study("out/study.yaml").fixed["poisson_ratio"] == 0.3


def test_tests_that_look_like_different_materials_are_told(capsys):
    test = elastic(2.0, 20)
    for factor, name in ((0.7, "same"), (0.5, "other")):
        replace(test, depth=factor * test.depth).write(f"{name}.csv")
        assert drafted("good.csv", f"{name}.csv", "-o", name) == 0
    line = remark(Path("other"), capsys, "different materials")
    assert "0.0103 /GPa in other.csv, other and 0.0411 /GPa in good.csv, good" in line
    assert "different materials" not in Path("same/study.yaml").read_text()


def test_provenance_is_kept(capsys):
    for day in ("monday", "tuesday"):
        Path(day).mkdir()
    anton_paar("monday/test.TXT", "0,30", 1.0)
    anton_paar("tuesday/test.TXT", "0,30", 1.01)
    assert main(["read", "monday/test.TXT", "-o", "read"]) == 0
    assert drafted("monday/test.TXT", "tuesday/test.TXT", "monday/../monday/test.TXT", "-o", "out") == 0
    first, second = (read_recording(f"out/recordings/P1_T20_{number}.csv").notes for number in (1, 2))
    assert (first[0], second[0]) == ("from monday/test.TXT, test", "from tuesday/test.TXT, test")
    assert first[1:] == read_recording("read/test.csv").notes[1:]
    assert "corrections in depth: those of the vendor" in first and "Poisson's ratio(nu): 0,30" in first
    assert "monday/../monday/test.TXT, test: the same recording as monday/test.TXT, test" in capsys.readouterr().err


@needs_recordings
def test_chosen_corrections_are_told():
    assert drafted(XP, "--correct", "drift", "-o", "out") == 0
    (first,) = Path("out/recordings").glob("*_1.csv")
    assert "corrections in depth: drift" in read_recording(first).notes


def test_a_loading_that_was_not_recorded_is_told(capsys):
    test = elastic(4.0, 100)
    preloaded = test.at(test.load > 0.2)
    for number in (1, 2):
        replace(preloaded, depth=preloaded.depth + 0.1 * number).write(f"site{number}.csv")
    assert drafted("site1.csv", "site2.csv", "-o", "out") == 0
    line = remark(Path("out"), capsys, "assumed")
    assert "site1.csv, site1 and 1 more begin under load (0.2" in line
    (seconds,) = [word for word in line.split() if word.replace(".", "").isdigit()][-1:]
    assert float(seconds) == pytest.approx(100 * 0.2 / 4.0, rel=0.1)
    kept = read_recording("out/recordings/P4_T100_1.csv")
    assert kept.time[1] == pytest.approx(float(seconds), rel=0.02) and "is assumed" in kept.notes[-1]


def test_a_first_point_just_after_contact_is_no_preload(capsys):
    test = elastic(4.0, 100)
    test.at(test.load > 0.0).write("late.csv")
    assert np.count_nonzero(test.load == 0.0) >= 1
    assert drafted("late.csv", "-o", "out") == 0
    assert "assumed" not in capsys.readouterr().err


def test_the_noise_of_a_first_point_is_no_preload(capsys):
    """Six tests with 0.3 % of noise: two standard deviations are no load at the start."""
    for seed in range(6):
        test = elastic(4.0, 100)
        noise = 0.012 * np.random.default_rng(seed).standard_normal(len(test))
        replace(test, load=test.load + np.append(0.024, noise[1:]), depth=test.depth + 0.1 * seed).write(
            f"site{seed}.csv"
        )
    assert drafted(".", "-o", "out") == 0
    assert "begin under load" not in capsys.readouterr().err
