"""Every command: exit code 0, or one line on stderr and 2; a simulation that fails is 1."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from indentation_files.overwrite import written_beside
from indentation_files.recording_file import read_recording
from palpate.cli.main import main
from palpate.solver import simulation

CHALLENGE = Path(__file__).parents[2] / "config" / "challenge.yaml"
SPEC = {
    "material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "protocol": {"max_load": 1.0, "loading_time": 10, "unloading_time": 10, "points": 12},
    "kinematics": "small",
}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "COMMAND"),
        (["simulat"], "simulat"),
        (["simulate", "spec.yaml"], "-o"),
        (["read", "x", "-o", "y", "--correct", "gravity"], "gravity"),
        (["check", "missing.yaml"], "missing.yaml: cannot be read"),
        (["check", "."], ".: is no regular file; give a file"),
        (["read", "missing.txt", "-o", "out"], "missing.txt: cannot be read"),
        (["read", "missing.txt", "-o", "out", "--contact", "-1e-3"], "missing.txt: cannot be read"),
        (["run", "x.yaml", "--cores", "0"], "--cores: '0' is not a number of cores, 1 or more"),
        (["run", "x.yaml", "--cores", "-3"], "--cores: '-3' is not a number of cores, 1 or more"),
        (["run", "x.yaml", "--cores", "1.5"], "--cores: '1.5' is not a number of cores, 1 or more"),
        (["track", "--results", "nowhere"], "nowhere: the folder is missing; give a folder of results"),
        (["track", "--send", "--results", "nowhere"], "nowhere: the folder is missing; give a folder of results"),
        (["read", "x", "-o", "y", "--units", "load=uN,load=N"], "--units: 'load' is given twice"),
        (["read", "x", "-o", "y", "--columns", "time=a,load=b,time=c"], "--columns: 'time' is given twice"),
    ],
)
def test_bad_command_lines(tmp_path, monkeypatch, refused, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert words in refused(*arguments)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: [\n", "line 3"),
        ("material: {}\nindenter: {}\nmaterial: {}\n", "line 3: is not valid YAML (key 'material' is given twice)"),
        (b"\xff\xfe\x00", "is not text in UTF-8"),
        ("? [a]\n: 1\n", "line 1: is not valid YAML (a key is no word)"),
        ("a: 1\ntitle: 2024-02-30\n", "line 2: is not valid YAML ('2024-02-30' is not what it looks like"),
        ("a: !!int abc\n", "line 1: is not valid YAML ('abc' is not what it looks like"),
        ("[" * 3000, "is nested too deeply"),
        ("", "table of keys"),
        ("- 1\n", "table of keys"),
    ],
)
@pytest.mark.parametrize("command", ["simulate", "check"])
def test_bad_yaml(tmp_path, refused, command, text, words):
    file = tmp_path / "x.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    line = refused(command, file, *(["-o", tmp_path / "c.csv"] if command == "simulate" else []))
    assert str(file) in line
    assert words in line or command == "check"


def test_output_that_cannot_be_written(tmp_path, refused):
    file = tmp_path / "spec.yaml"
    file.write_text(yaml.safe_dump(SPEC))
    assert "folder is missing" in refused("simulate", file, "-o", tmp_path / "no/curve.csv")
    assert f"{tmp_path}: is a folder; name a file in it" in refused("simulate", file, "-o", tmp_path)
    assert f"{file}: is a file; name a folder" in refused("fields", file, "--time", "1", "-o", file)
    recording = tmp_path / "a.csv"
    recording.write_text("time_s,load_mN,depth_nm\n0,0,0\n1,1,1\n")
    assert str(recording) in refused("read", recording, "-o", recording)


@pytest.mark.parametrize("value", [0.05, [0.05], "fast"])
def test_a_mechanism_without_its_parameters_is_refused(tmp_path, refused, value):
    file = tmp_path / "spec.yaml"
    file.write_text(yaml.safe_dump(SPEC | {"mechanisms": {"thermal_drift": value}}))
    for command in (["simulate", file, "-o", tmp_path / "c.csv"], ["fields", file, "--time", "1", "-o", tmp_path]):
        line = refused(*command)
        assert f"{file}, mechanisms.thermal_drift: mechanism thermal_drift is {value!r}, expected a table" in line
        assert "{rate: ...}" in line


def test_a_failed_simulation_is_told_with_its_reason(tmp_path, monkeypatch, capsys):
    failed = simulation.Simulation(np.ones(1), np.ones(1), np.ones(1), "failed", "the step became too small", 0.0)
    monkeypatch.setattr(simulation, "simulate", lambda specification: failed)
    file = tmp_path / "spec.yaml"
    file.write_text(yaml.safe_dump(SPEC))
    assert main(["simulate", str(file), "-o", str(tmp_path / "c.csv")]) == 1
    assert "the step became too small" in capsys.readouterr().err
    assert not (tmp_path / "c.csv").exists()


def test_strains_are_large_unless_small_ones_are_asked_for_and_the_curve_says_so(tmp_path):
    file, depths = tmp_path / "spec.yaml", {}
    for given in (None, "large", "small"):
        plain = {key: value for key, value in SPEC.items() if key != "kinematics"}
        file.write_text(yaml.safe_dump(plain | ({"kinematics": given} if given else {})))
        assert main(["simulate", str(file), "-o", str(tmp_path / f"{given}.csv")]) == 0
        curve = read_recording(tmp_path / f"{given}.csv")
        assert f"kinematics: {given or 'large'}" in curve.notes
        depths[given] = curve.depth.max()
    assert depths[None] == depths["large"] < depths["small"]


def test_an_interrupt_is_told_in_a_line(tmp_path, monkeypatch, capsys):
    file = tmp_path / "spec.yaml"
    file.write_text(yaml.safe_dump(SPEC))

    def interrupted(specification):
        raise KeyboardInterrupt

    monkeypatch.setattr("palpate.solver.simulation.simulate", interrupted)
    assert main(["simulate", str(file), "-o", str(tmp_path / "curve.csv")]) == 130
    assert capsys.readouterr().err == "palpate: interrupted\n"


def test_help_needs_no_heavy_imports():
    code = (
        "import sys\nfrom palpate.cli.main import main\n"
        "try:\n    main(['--help'])\nexcept SystemExit:\n    pass\n"
        "print([m for m in ('numba', 'pandas', 'mlflow') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "[]"
    assert all(command in out for command in ("simulate", "read", "check"))


TABLE = "t,P,h\n0,0,0\n1,1,1\n2,2,2\n"
BY_NAME = ["--columns", "time=t,load=P,depth=h", "--units", "time=s,load=mN,depth=nm"]


@pytest.fixture
def palpate(tmp_path):
    """Run the command line in a process of its own, with the words `before` and `after` it in the shell."""

    def run(*arguments, before="", after=""):
        code = "import sys; from palpate.cli.main import main; sys.exit(main())"
        line = f"{before} {sys.executable} -c {shlex.quote(code)} {shlex.join(map(str, arguments))} {after}"
        return subprocess.run(["bash", "-c", line], capture_output=True, text=True, cwd=tmp_path)

    return run


def test_names_that_the_output_cannot_write(tmp_path, palpate):
    (tmp_path / "x.csv").write_text(TABLE)
    done = palpate("read", "x.csv", *BY_NAME, "-o", "\u6d4b\u8bd5", before="PYTHONIOENCODING=cp1252")
    assert (done.returncode, done.stdout, done.stderr) == (0, "\\u6d4b\\u8bd5/x.csv\n", "")
    assert (tmp_path / "\u6d4b\u8bd5/x.csv").exists()


@pytest.mark.parametrize("more", [[], ["--survey"]])
def test_a_file_whose_name_is_no_unicode(tmp_path, more, capsys):
    file = tmp_path / os.fsdecode(b"Pr\xfcfung.txt")
    try:
        file.write_text("t,P,h\n" + "".join(f"{k},{k},{k}\n" for k in range(20)))
    except OSError:
        pytest.skip("this file system keeps names in Unicode only")
    assert main(["read", str(file), *BY_NAME, *more, "-o", str(tmp_path / "out")]) == 0
    assert "# from Pr\\udcfcfung.txt" in (tmp_path / "out/Pr_udcfcfung.csv").read_text()


def test_no_command_writes_over_what_it_reads(tmp_path, refused):
    table, file = tmp_path / "x.csv", tmp_path / "spec.yaml"
    table.write_text(TABLE)
    file.write_text(yaml.safe_dump(SPEC))
    for source, line in (
        (table, ["read", table, *BY_NAME, "-o", tmp_path]),
        (file, ["simulate", file, "-o", file]),
        (file, ["export", file, "--format", "calculix", "-o", tmp_path / "." / "spec.yaml"]),
    ):
        before = source.read_text()
        assert f"{source}: the output would replace the file that is read; name another output" in refused(*line)
        assert source.read_text() == before


def test_what_cannot_be_written_leaves_no_part(tmp_path):
    def half(place):
        place.write_text("half")
        raise OSError("no space left on the disk")

    with pytest.raises(OSError, match="no space"):
        written_beside(tmp_path / "curve.csv", half)
    assert list(tmp_path.iterdir()) == []


def test_a_recording_of_the_same_name_is_never_replaced(tmp_path, capsys):
    """Laboratories keep a folder a day, with the same names in each."""
    told = []
    for day, scale in (("Monday", 1), ("Tuesday", 2), ("Tuesday", 2)):
        (tmp_path / day).mkdir(exist_ok=True)
        (tmp_path / day / "1.txt").write_text(f"t,P,h\n0,0,0\n1,1,{scale}\n2,2,{2 * scale}\n")
        assert main(["read", str(tmp_path / day / "1.txt"), *BY_NAME, "-o", str(tmp_path / "out")]) == 0
        told.append(capsys.readouterr().err)
    beside = f"palpate: {tmp_path / 'out/1.csv'}: exists with another content; written to {tmp_path / 'out/1_2.csv'}"
    assert told == ["", f"{beside}\n", f"{beside}\n"]
    assert read_recording(tmp_path / "out/1.csv").depth[-1] == 2.0
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == ["1.csv", "1_2.csv"]


def test_a_survey_replaces_no_picture_and_is_the_same_the_second_time(tmp_path, capsys):
    (tmp_path / "x.txt").write_text("t,P,h\n" + "".join(f"{k},{k},{k}\n" for k in range(20)))
    (tmp_path / "out").mkdir()
    (tmp_path / "out/x.png").write_bytes(b"another picture")
    for _ in range(2):
        assert main(["read", str(tmp_path / "x.txt"), *BY_NAME, "--survey", "-o", str(tmp_path / "out")]) == 0
        beside = f"{tmp_path / 'out/x.png'}: exists with another content; written to {tmp_path / 'out/x_2.png'}"
        assert beside in capsys.readouterr().err
    assert (tmp_path / "out/x.png").read_bytes() == b"another picture"
    written = ["x.csv", "x.png", "x_2.png", "x_survey.txt"]
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == written


@pytest.mark.parametrize("buffer", ["PYTHONUNBUFFERED=", "PYTHONUNBUFFERED=1"])
def test_a_reader_that_leaves_early_gets_no_complaint(palpate, buffer):
    done = palpate("check", CHALLENGE, before=buffer, after="| true; exit ${PIPESTATUS[0]}")
    assert (done.returncode, done.stderr) == (1, "")


@pytest.mark.parametrize("rows", [7, 8, 9])
def test_what_cannot_be_surveyed_leaves_no_file(tmp_path, refused, rows):
    file = tmp_path / "x.csv"
    file.write_text("t,P,h\n" + "".join(f"{k},{k},{k}\n" for k in range(rows)))
    assert f"{file}, " in refused("read", file, *BY_NAME, "--survey", "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_one_test_that_cannot_be_surveyed_keeps_nobody_from_the_others(tmp_path, capsys):
    """Two tests one below another: the first has too few points on its way in to find contact."""
    short, whole = ([*range(size), *range(size - 2, -1, -1)] for size in (4, 60))
    parts = ["\n".join(f"{k},{value},{value}" for k, value in enumerate(part)) for part in (short, whole)]
    (tmp_path / "x.txt").write_text("t,P,h\n" + "\n\n".join(parts) + "\n")
    assert main(["read", str(tmp_path / "x.txt"), *BY_NAME, "--survey", "-o", str(tmp_path / "out")]) == 0
    assert len(list((tmp_path / "out").glob("*.csv"))) == 2
    assert len((tmp_path / "out/x_survey.txt").read_text().splitlines()) == 2
    said = capsys.readouterr().err
    assert "too few to find the contact in" in said
    assert said.rstrip().endswith("left out of the survey")
