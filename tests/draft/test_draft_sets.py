"""Drafts of whole sets: one bad test never stops them, and tests of one method are one condition."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from elastic_tests import MODULUS, elastic

from indentation_files.pop_in import pop_ins
from indentation_files.recording import Recording
from palpate.analytic import hertz, sneddon
from palpate.base.classes import levels
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.draft.grouping import grouped
from palpate.draft.prescribed_drive import Drive, cut_off
from palpate.draft.stated import Stated
from palpate.study.protocol import DISPLACEMENT, trapezoid
from palpate.study.recorded_history import MOST_KNOTS, averaged_over, recorded

TIME = np.linspace(0.0, 20.0, 2001)
RAMP = np.interp(TIME, [0, 8, 12, 20], [0, 2, 2, 0])


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Work in a folder with three good tests in `set`."""
    monkeypatch.chdir(tmp_path)
    Path("set").mkdir()
    for site in (1, 2, 3):
        elastic(2.0 * (1 + 1e-3 * site), 20).write(f"set/good_{site}.csv")
    return tmp_path


def drafted(*arguments):
    return main(["draft", *map(str, arguments)])


def air(wander):
    """Return a test that never touches: noise, and a load cell that wanders while the tip goes down and up."""
    noise = 2e-3 * np.random.default_rng(0).standard_normal(len(TIME))
    return Recording(TIME, wander * TIME / TIME[-1] + noise, np.interp(TIME, [0, 10, 20], [0, 1500, 0]))


@pytest.mark.parametrize("wander", [0.0, 0.02, -0.05, 1.0])
def test_a_test_in_air_is_left_out_and_a_folder_is_drafted(capsys, wander):
    air(wander).write("set/air_4.csv")
    Path("set/notes.md").write_text("Tuesday\n")
    assert drafted("set", "-o", "out") == 0
    told = capsys.readouterr()
    assert "3 of P2_T20" in told.out
    assert "set/air_4.csv, air_4: never bears load" in told.err
    assert "set/notes.md: is of no format" in told.err
    assert told.out.splitlines()[-1].endswith("then palpate check out/study.yaml")


def test_files_of_known_formats_are_drafted_beside_tables(capsys):
    for number, load in enumerate((2.003, 2.005, 2.004)):
        test = elastic(load, 20)
        rows = zip(test.time, 1e3 * test.load, test.depth, strict=True)
        text = "\n".join(["t [s],P [uN],h [nm]", *(",".join(map(str, row)) for row in rows)])
        Path(f"set/table_{number}.txt").write_text(text)
    Path("set/unread.txt").write_text("t [s],P [uN],h [nm]\n" + "0,1,nan\n" * 50)
    assert drafted("set", "--columns", "time=t [s],load=P [uN],depth=h [nm]", "-o", "out") == 0
    told = capsys.readouterr()
    assert "5 of P2_T20" in told.out
    assert "set/good_1.csv, good_1: lacks the columns named, and is read as palpate" in told.err
    assert "set/unread.txt: has the columns t [s], P [uN], h [nm], but no row with a number in each" in told.err
    assert "set/table_2.txt, table_2: the same recording as set/good_2.csv, good_2; left out" in told.err


def test_every_test_in_air_is_refused(capsys):
    air(0.0).write("air.csv")
    assert drafted("air.csv", "-o", "out") == 2
    assert "never bears load" in capsys.readouterr().err


def test_read_says_that_a_test_never_bears_load(capsys):
    air(0.0).write("air.csv")
    assert main(["read", "air.csv", "-o", "out"]) == 0
    assert "never bears load" in capsys.readouterr().err


@pytest.mark.parametrize("depth_too", [True, False])
def test_a_load_of_the_wrong_sign_is_refused_as_one(capsys, depth_too):
    noise = 1e-3 * np.random.default_rng(0).standard_normal(len(TIME))
    loads, depths = np.interp(TIME, [0, 10, 20], [0, 1, 0]) + noise, np.interp(TIME, [0, 10, 20], [0, 1500, 600])
    Recording(TIME, -loads, -depths if depth_too else depths).write("turned.csv")
    assert drafted("turned.csv", "-o", "out") == 2
    assert "where the tip presses; turn it" in capsys.readouterr().err


@pytest.mark.parametrize(("hertz_", "amplitude"), [(45.0, 0.04), (3.0, 0.05), (49.0, 0.1)])
def test_an_oscillating_load_is_followed_in_its_middle(hertz_, amplitude):
    loads = RAMP + amplitude * np.sin(2 * np.pi * hertz_ * TIME) * (TIME > 0)
    protocol = recorded(TIME, np.append(loads[:-1], 0.0))
    assert len(protocol.knot_time) < MOST_KNOTS
    if averaged_over(TIME, loads) > 1:
        assert np.abs(protocol.load_at(TIME) - RAMP).max() < 0.5 * amplitude


@pytest.mark.parametrize("hertz_", [1.0, 3.0, 10.0, 30.0])
@pytest.mark.parametrize("amplitude", [0.005, 0.01, 0.05])
def test_no_slow_oscillation_asks_for_more_corners_than_can_be_simulated(hertz_, amplitude):
    time = np.linspace(0, 50, 5001)
    ramp = np.interp(time, [0, 20, 30, 50], [0, 1, 1, 0])
    protocol = recorded(time, np.maximum(ramp + amplitude * np.sin(2 * np.pi * hertz_ * time) * (ramp > 0.03), 0.0))
    assert len(protocol.knot_time) <= MOST_KNOTS
    assert np.abs(protocol.load_at(time) - ramp).max() < max(1.5 * amplitude, 0.03)


@pytest.mark.parametrize("shape", [1.0, 2.0])
def test_a_noisy_load_is_followed_in_its_middle(shape):
    rng = np.random.default_rng(1)
    time = np.linspace(0, 20, 20001)
    true = np.interp(time, [0, 8, 12, 20], [0, 1, 1, 0]) ** shape
    noisy = true + 0.03 * rng.standard_normal(len(time))
    noisy[0] = 0.0
    protocol = recorded(time, noisy)
    assert len(protocol.knot_time) < 50
    assert np.abs(protocol.load_at(time) - true).max() < 0.03


def test_an_oscillating_load_is_told(capsys):
    rippled = np.maximum(RAMP**1.5 + 0.05 * np.sin(2 * np.pi * 45 * TIME) * (RAMP > 0), 0.0)
    Recording(TIME, rippled, sneddon.depth(RAMP**1.5, MODULUS, 0.35, 70.3)).write("csm.csv")
    assert drafted("csm.csv", "-o", "out") == 0
    assert "oscillates or is noisy by 1.2% of its largest; its average over 0." in capsys.readouterr().out


@pytest.mark.parametrize("modulus", [1e-7, 1e-6, 1e-3])
@pytest.mark.parametrize("law", [None, "nonlinear_burgers", "bilinear_plasticity"])
def test_gels_of_100_pa_are_drafted(modulus, law):
    """A sphere of 10 um; the largest depth is 2 um whatever the modulus (Hertz)."""
    load = RAMP / RAMP.max() * hertz.load(2000.0, modulus, 0.35, 1e4)
    Recording(TIME, load, hertz.depth(load, modulus, 0.35, 1e4)).write("gel.csv")
    assert drafted("gel.csv", "-o", "out", "--sphere", 1e4, *(["--law", law] if law else [])) == 0
    low, high = load_study("out/study.yaml").levels["youngs_modulus"]
    assert low < modulus < high


def depth_limited(stiffness, name, duration=40.0):
    """Return a test to 1000 nm at a constant rate of the load's logarithm, on a site of its own stiffness."""
    time = np.linspace(0, duration, 800)
    depth = 1000 * np.interp(time / duration, np.linspace(0, 1, 9), [0, 0.05, 0.12, 0.27, 0.55, 1, 1.01, 1.02, 0.6])
    return Recording(time, stiffness * 1e-4 * depth**2 * np.where(time > 0.95 * duration, 0.8, 1), depth, name)


def test_tests_to_one_depth_are_one_condition_with_loads_of_their_own():
    tests = [depth_limited(s, str(k), 40 + k) for k, s in enumerate((0.86, 1.0, 1.12))]
    (group,) = grouped(tests, Drive())
    assert group.history == {"load_history": "recorded", "own_loads": True}
    assert group.recordings[0].name == "1"


def test_many_tests_whose_loads_spread_are_one_condition():
    loads = np.linspace(1.0, 1.3, 36)
    assert [len(group.recordings) for group in grouped([elastic(load, 20) for load in loads], Drive())] == [36]


def test_many_tests_behind_a_cantilever_are_few_conditions():
    """The piezo ends at one height, and touches at many: displacements from contact on spread by a factor of 2.2."""
    drive, tests = Drive(DISPLACEMENT, 0.5e-6), []
    for z in np.linspace(3000, 6600, 40):
        protocol = trapezoid(z, z / 1000, 0, z / 1000, points=200, control=DISPLACEMENT)
        depth = np.append(0.0, protocol.sample_drive) * 0.5
        load = 0.5e-6 * (np.append(0.0, protocol.sample_drive) - depth)
        tests.append(Recording(np.append(0.0, protocol.sample_time), load, depth, f"{z:.0f}"))
    groups = grouped(tests, drive)
    assert len(groups) <= 6 and sum(len(group.recordings) for group in groups) == 40
    assert all(group.history["spring"] == 0.5e-6 for group in groups)


def test_loads_that_form_levels_stay_conditions_of_their_own():
    loads = np.repeat([1.0, 1.2, 1.44], 12) * np.tile(np.linspace(0.995, 1.005, 12), 3)
    assert [len(group.recordings) for group in grouped([elastic(load, 20) for load in loads], Drive())] == [12, 12, 12]


def test_near_loads_stay_levels_whatever_the_order():
    loads = [2.0, 2.105, 2.001, 2.106, 2.002]
    for order in (loads, loads[::-1]):
        groups = grouped([elastic(load, 20) for load in order], Drive())
        assert [len(group.recordings) for group in groups] == [3, 2]
    assert levels([2.08, 2.0, 2.09, 2.01], float, 1.05) == [[2.0, 2.01], [2.08, 2.09]]
    assert levels([2.08, 2.0], float, 1.05) == [[2.0, 2.08]]


@pytest.mark.parametrize("missing", ["start", "end"])
def test_a_test_whose_ends_were_seen_late_is_none_of_another_condition(missing):
    """Half a second of forty, in which the load rises or falls by 2.5 %, and 1.5 s without load after it."""
    whole = elastic(2.0, 20)
    part = whole.time > 0.5 if missing == "start" else whole.time < 38.5
    short = replace(whole.at(part), name="short")
    if missing == "start":
        short = replace(short, time=short.time - short.time[0], load=short.load - short.load[0])
    (group,) = grouped([elastic(2.0, 20, name="a"), short, elastic(2.0, 20, name="b")], Drive())
    assert {test.name for test in group.recordings} == {"a", "b", "short"}


@pytest.mark.parametrize(("until", "told"), [(12.0, True), (22.0, True), (39.0, False)])
def test_a_test_cut_in_the_middle_is_left_out(capsys, until, told):
    whole = elastic(2.0, 20)
    replace(whole.at(whole.time < until), name="").write("set/cut_4.csv")
    assert drafted("set", "-o", "out") == 0
    said = capsys.readouterr()
    assert (
        "set/cut_4.csv, cut_4: ends after" in said.err and "it was cut off; the test is left out" in said.err
    ) == told
    assert f"{3 if told else 4} of P2_T20" in said.out


def test_tests_that_all_end_under_load_are_drafted():
    whole = [elastic(load, 20, name=f"{load}") for load in (1.0, 2.0)]
    assert cut_off([test.at(test.time < 20) for test in whole], Drive()) == {}
    short = [replace(whole[1].at(whole[1].time < 15), name=f"{k}") for k in range(3)]
    assert cut_off([whole[1], *short], Drive()) == {}, "they may be meant to end there"
    assert cut_off([whole[1], short[0]], Drive()) == {short[0]: whole[1]}


def test_noise_after_unloading_is_no_segment_of_a_trapezoid():
    test = elastic(9.0, 5)
    after = np.arange(1, 8) * 0.01
    tail = np.append(test.load, 9.0 * np.linspace(0.0, 2e-3, 7))
    noisy = Recording(np.append(test.time, test.time[-1] + after), tail, np.append(test.depth, np.zeros(7)), "noisy")
    (group,) = grouped([noisy], Drive())
    assert group.history["max_load"] == 9.0


def test_a_depth_that_is_prescribed_is_a_displacement_driven_study():
    protocol = trapezoid(1000.0, 10, 20, 10, points=400, control=DISPLACEMENT)
    depth = np.append(0.0, protocol.sample_drive)
    time = np.append(0.0, protocol.sample_time)
    relaxed = sneddon.load(depth, MODULUS, 0.35, 70.3) * (0.7 + 0.3 * np.exp(-time / 5))
    test = Recording(time, relaxed, depth, "relaxation")
    drive = Drive.by_all([test], Stated())
    (group,) = grouped([test], drive)
    assert group.history == {
        "drive": "displacement", "max_displacement": 1000.0, "loading_time": 10.0, "hold_time": 20.0,
        "unloading_time": 10.0,
    }  # fmt: skip
    assert Drive.by_all([elastic(1.0, 20)], Stated()).control == "load"


OPTICS = """Date\t01/02/2024\tTime\t10:00:00\tStatus\tOK
gel
k (N/m)\t0.500

Tip radius (um)\t10.000

Control mode: Displacement

Time (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\tAuxiliary
"""


def test_what_an_optics11_file_states_is_used(capsys):
    """A gel of 1 kPa (Hertz) behind a spring of 0.5 N/m: z = h + F / k."""
    depth = np.interp(TIME, [0, 2, 10, 18, 20], [0, 0, 2000, 0, 0])
    load = hertz.load(depth, 1e-6, 0.5, 1e4)
    bent = load / 0.5e-6
    piezo = depth + bent + np.interp(TIME, [0, 2, 18, 20], [-500, 0, 0, -500])
    rows = zip(TIME, 1e3 * load, depth, bent, piezo, strict=True)
    Path("gel.txt").write_text(
        OPTICS + "".join(f"{t:.3f}\t{p:.7f}\t{h:.3f}\t{b:.5f}\t{z:.4f}\t0\n" for t, p, h, b, z in rows)
    )
    assert drafted("gel.txt", "-o", "out") == 0
    study = load_study("out/study.yaml")
    assert (study.indenter.shape, study.indenter.radius) == ("sphere", 1e4)
    protocol = study.conditions[0].protocol
    assert protocol.control == "displacement" and protocol.compliance == pytest.approx(1 / 0.5e-6)
    low, high = study.levels["youngs_modulus"]
    assert low < 1e-6 < high
    assert "sphere 10000" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("metadata", "expected"),
    [
        ({"Tip radius (um)": "10.000"}, {"radius": 1e4}),
        ({"Indenter radius": "500 nm", "Tip Name": "Spherical 5"}, {"radius": 500.0, "shape": "sphere"}),
        ({"Bead diameter [um]": "6,1"}, {"radius": 3050.0}),
        ({"Tip Name": "Berk-20210318"}, {"shape": "berkovich"}),
        ({"Indenter type": "Cube corner"}, {"shape": "cube corner"}),
        ({"spring constant": "0.043"}, {"spring": pytest.approx(0.043e-6)}),
        ({"k (nN/nm)": "0.5"}, {"spring": pytest.approx(0.5e-6)}),
        ({"K [mN/m]:": "43"}, {"spring": pytest.approx(0.043e-6)}),
        ({"Contact radius": "500 nm", "Tip radius (um)": "0"}, {}),
        ({"Support Spring": "80 N/m", "X Stiffness": "2291 N/m"}, {}),
    ],
)
def test_tip_and_spring_are_taken_whatever_the_vendor(metadata, expected):
    found = Stated.by_all([metadata] * 2)
    for name in ("radius", "shape", "spring"):
        assert getattr(found, name) == expected.get(name, getattr(Stated(), name))


def test_the_vendor_s_modulus_stands_beside_ours(capsys):
    test = elastic(1.0, 20)
    notes = ("EIT: 2,95 GPa", "HIT: 250,0 MPa")
    replace(test, notes=notes).write("test.csv")
    assert drafted("test.csv", "-o", "out") == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if "by unloading" in line]
    assert [row[-2] for row in rows] == ["2.95", "0.25"]


def test_a_pull_off_that_is_cut_is_told(capsys):
    load = np.interp(TIME, [0, 10, 18, 19, 19.2, 20], [0, 2, 0, -0.2, 0, 0])
    depth = sneddon.depth(np.maximum(load, 0.0), MODULUS, 0.35, 70.3) + np.minimum(load, 0.0) * 100
    Recording(TIME, load, depth).write("sticky.csv")
    assert drafted("sticky.csv", "-o", "out") == 0
    assert "pulls on the tip by up to 0.198 mN while it leaves" in capsys.readouterr().err


def test_pop_ins_are_found_and_told(capsys):
    test = elastic(2.0, 20, noise=1e-4)
    jumped = replace(test, depth=test.depth + 30.0 * (test.time > 10.0))
    (found,) = pop_ins(jumped)
    assert found.load == pytest.approx(1.0, rel=0.02) and found.jump == pytest.approx(30.0, rel=0.1)
    assert pop_ins(test) == []
    ramp = Recording(TIME[::10], np.minimum(TIME, 8.0)[::10], 100 * np.minimum(TIME, 8.0)[::10])
    assert pop_ins(ramp) == [], "a depth that is held is no jump before"
    jumped.write("jump.csv")
    assert drafted("jump.csv", "-o", "out") == 0
    assert "the depth jumps while the load grows, by 30" in capsys.readouterr().out


def test_a_check_tells_folder_and_time(capsys, folder):
    assert drafted("set", "-o", "out") == 0
    capsys.readouterr()
    assert main(["check", "out/study.yaml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"relative paths count from {folder}"
    assert any(line.startswith("expected time, within a factor of two: ") and "16 snapshots" in line for line in lines)
    assert lines[-1] == "next: palpate run out/study.yaml"
