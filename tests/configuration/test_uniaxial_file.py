"""Files of uniaxial tests: what is read, converted, taken as prescribed, and refused."""

import numpy as np
import pytest
import yaml
from study_file import STUDY

from indentation_files.uniaxial_test import MOST, UniaxialTest, read_uniaxial
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.data.bulk_tests import BulkTest, bulk_tests

TIME = np.linspace(0.0, 60.0, 61)
STRAIN = 0.02 * TIME / 60.0


def written(folder, time=TIME, strain=STRAIN, stress=3.0 * STRAIN, head="", header="time_s,strain,stress_GPa"):
    lines = [f"{t:.9g},{e:.9g},{s:.9g}" for t, e, s in zip(time, strain, stress, strict=True)]
    (folder / "tension.csv").write_text("\n".join([*filter(None, [head]), header, *lines]) + "\n")
    return folder / "tension.csv"


def study(folder, *entries, **changes):
    entries = entries or ({"file": str(folder / "tension.csv"), "role": "validate"},)
    evidence = [{"kind": "uniaxial", **entry} for entry in entries]
    file = folder / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY | {"evidence": evidence} | changes, sort_keys=False))
    return file


def test_true_stress_and_logarithmic_strain_are_read_as_they_are(tmp_path):
    found = read_uniaxial(written(tmp_path))
    assert found.name == "tension"
    np.testing.assert_allclose([found.time, found.strain, found.stress], [TIME, STRAIN, 3.0 * STRAIN], rtol=1e-8)


def test_nominal_values_are_converted_for_a_body_that_keeps_its_volume(tmp_path):
    """A bar of length l and area A under the force F: strain ln(l / l_0), stress F / A with A l = A_0 l_0."""
    length, force = np.linspace(1.0, 1.4, 61), np.linspace(0.0, 0.1, 61)
    found = read_uniaxial(written(tmp_path, strain=length - 1.0, stress=force, head="# engineering"))
    np.testing.assert_allclose(found.strain, np.log(length), atol=1e-8)
    np.testing.assert_allclose(found.stress, force * length, atol=1e-9)


def test_compression_may_be_written_as_positive(tmp_path):
    found = read_uniaxial(written(tmp_path, strain=STRAIN, head="# compression\n# engineering"))
    assert found.strain[-1] == pytest.approx(np.log(1.0 - 0.02))
    assert found.stress[-1] == pytest.approx(-3.0 * 0.02 * (1.0 - 0.02))


def test_of_a_long_file_points_are_kept_evenly_first_and_last_among_them(tmp_path):
    time = np.linspace(0.0, 10.0, 5001)
    found = read_uniaxial(written(tmp_path, time, 1e-3 * time, 3e-3 * time))
    assert len(found.time) == MOST and (found.time[0], found.time[-1]) == (0.0, 10.0)
    assert np.ptp(np.diff(found.time)) < 0.003


@pytest.mark.parametrize(
    ("strain", "stress", "expected"),
    [
        (STRAIN, 3.0 * STRAIN, "strain"),
        (0.01 + 1e-5 * TIME, np.minimum(0.03, 0.01 * TIME), "stress"),
        (np.minimum(0.01, 0.01 * TIME), 0.03 * np.exp(-TIME / 30.0), "strain"),
        (0.01 * np.sin(TIME), 0.03 * np.sin(TIME + 0.1), "strain"),
    ],
    ids=["tension", "creep", "relaxation", "cycles"],
)
def test_what_is_held_longer_was_prescribed(strain, stress, expected):
    assert UniaxialTest(TIME, strain, stress).held_longer == expected


def test_noise_is_found_beside_a_curve_that_bends():
    noise = 3e-4 * np.random.default_rng(0).standard_normal(400)
    time = np.linspace(0.0, 1.0, 400)
    test = BulkTest(UniaxialTest(time, 0.03 * time, 0.1 * (1.0 - np.exp(-5.0 * time)) + noise), "validate", "strain")
    assert test.noise == pytest.approx(3e-4, rel=0.15)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"header": "time_s,strain"}, "line 1: header is 'time_s,strain', expected 'time_s,strain,stress_GPa'"),
        ({"header": "time_s,strain,stress_MPa"}, "header is 'time_s,strain,stress_MPa'"),
        ({"time": TIME[::-1]}, "time_s: time does not increase from point 1 (60 s) to point 2"),
        ({"stress": 3000.0 * STRAIN}, "stress_GPa: the largest stress, 60, exceeds Young's modulus, 3.5 GPa: it looks"),
        ({"stress": 30.0 * STRAIN}, "is 8.57 times what the largest strain, 0.02, can bring about: it looks like MPa"),
        ({"strain": 100.0 * STRAIN, "stress": STRAIN}, "strain: the largest strain is 2, but the law, with kinematics"),
        ({"stress": 0.0 * STRAIN}, "stress_GPa: the stress is zero throughout"),
        ({"stress": np.where(TIME == 3.0, np.nan, STRAIN)}, "stress_GPa: stress_GPa is not a number at point 4"),
        ({"strain": -60.0 * STRAIN, "head": "# engineering"}, "the engineering strain -1.2 leaves nothing of the body"),
    ],
)
def test_files_that_are_no_test_of_this_body_are_refused(tmp_path, refused, change, words):
    file = written(tmp_path, **change)
    line = refused("check", study(tmp_path))
    assert str(file) in line and words in line


def test_small_strains_are_for_small_strains(tmp_path, refused):
    written(tmp_path, strain=10.0 * STRAIN, stress=STRAIN)
    assert main(["check", str(study(tmp_path))]) == 0
    assert "is for logarithmic strains up to 0.1" in refused("check", study(tmp_path, kinematics="small"))


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"kind": "imprit"}, 'evidence[0].kind: "imprit" is given, expected one of: uniaxial'),
        ({"of": "P1_T3"}, "evidence[0].of: 'P1_T3' is no condition of the study (did you mean 'P1_T30'?)"),
        (
            {"of": "P1_T30"},
            "evidence[0].of: a uniaxial test belongs to no condition, 'P1_T30' is given; write of: none",
        ),
        ({"rol": "validate"}, "evidence[0].rol: unknown key 'rol' (did you mean 'role'?)"),
        ({"file": "a{b}.csv"}, "evidence[0].file: a{b}.csv has braces, which are wildcards of Snakemake"),
        ({"file": "nowhere.csv"}, "nowhere.csv: cannot be read (No such file or directory)"),
    ],
)
def test_entries_that_mean_nothing_are_refused(tmp_path, refused, entry, words):
    file = written(tmp_path)
    assert words in refused("check", study(tmp_path, {"file": str(file), "role": "validate"} | entry))


def test_two_files_of_one_name_are_refused(tmp_path, refused):
    (tmp_path / "again").mkdir()
    files = [{"file": str(written(folder))} for folder in (tmp_path, tmp_path / "again")]
    assert "evidence[1].file: another file of evidence is called tension" in refused("check", study(tmp_path, *files))


def test_check_says_what_is_taken_of_a_test(tmp_path, capsys):
    written(tmp_path)
    assert main(["check", str(study(tmp_path))]) == 0
    line = (
        "evidence tension: uniaxial test of 61 points in 60 s, strain 0 to 0.02, stress 0 to 0.06 GPa; the strain is "
    )
    assert line + "taken as prescribed, the stress judges the calibrated law" in capsys.readouterr().out


def test_control_may_be_stated(tmp_path):
    file = {"file": str(written(tmp_path))}
    read = [bulk_tests(load_study(study(tmp_path, file | more))) for more in ({}, {"control": "stress"})]
    assert [[(test.control, test.observed, test.role) for test in tests] for tests in read] == [
        [("strain", "stress", "calibrate")],
        [("stress", "strain", "calibrate")],
    ]
