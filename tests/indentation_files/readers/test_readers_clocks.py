"""Times as instruments write them: clocks, dates, durations, padded, doubled, and begun anew in every segment."""

import datetime as dt

import numpy as np
import pytest
from tables import NUMBERED
from workbooks import write_workbook

from indentation_files.readers import read_each, read_vendor_file
from indentation_files.readers.clock import seconds
from palpate.errors import InputError

STEP = 0.5025
T = STEP * np.arange(100)
LOAD = np.interp(T, [0, 20, 30, 50], [0, 2, 2, 0.02])
DEPTH = 620 * np.sqrt(LOAD) + 1.5 * np.minimum(T, 30) + np.where(T > 30, 60 * (1 - np.sqrt(LOAD / 2)), 0)
START = dt.datetime(2024, 3, 5, 23, 59, 40)
MOMENTS = [START + dt.timedelta(seconds=float(t)) for t in T]


def text(file, times, load=LOAD, depth=DEPTH, heading="Time (s)\tLoad (mN)\tDepth (nm)"):
    rows = [f"{a}\t{b:.5f}\t{c:.3f}" for a, b, c in zip(times, load, depth, strict=True)]
    file.write_text("\n".join([heading, *rows]) + "\n")
    return file


KINDS = {
    "am/pm": lambda m: m.strftime("%I:%M:%S.%f %p"),
    "a.m.": lambda m: m.strftime("%I:%M:%S.%f ") + m.strftime("%p").replace("M", ".m.").lower(),
    "PM first": lambda m: m.strftime("%p %I:%M:%S.%f"),
    "in Japanese": lambda m: m.strftime("%p %I:%M:%S.%f").replace("AM ", "午前").replace("PM ", "午後"),
    "in Chinese": lambda m: m.strftime("%Y年%m月%d日 %p%I:%M:%S.%f").replace("AM", "上午").replace("PM", "下午"),
    "twelve hours": lambda m: m.strftime("%I:%M:%S.%f"),
    "iso": lambda m: m.isoformat(),
    "iso with a blank": lambda m: m.isoformat(" "),
    "iso with a zone": lambda m: m.replace(tzinfo=dt.timezone(dt.timedelta(hours=2))).isoformat(),
    "iso zulu": lambda m: m.isoformat() + "Z",
    "iso without signs": lambda m: m.strftime("%Y%m%dT%H%M%S.%f"),
    "day first": lambda m: m.strftime("%d.%m.%Y %H:%M:%S,%f"),
    "month first": lambda m: m.strftime("%m/%d/%Y %I:%M:%S.%f %p"),
    "month in words": lambda m: m.strftime("%b %d %Y, %H:%M:%S.%f"),
    "over midnight": lambda m: m.strftime("%H:%M:%S.%f"),
    "milliseconds behind a colon": lambda m: m.strftime("%H:%M:%S:") + f"{round(m.microsecond / 1e3):03d}"[:3],
    "over the hour": lambda m: m.strftime("%M:%S.%f"),
    "duration": lambda m: str(m - START),
    "duration of minutes": lambda m: f"{(m - START).seconds // 60:02d}:{(m - START).total_seconds() % 60:06.3f}",
    "duration of days": lambda m: f"{(m - dt.datetime(2024, 3, 5)).days} days {m.strftime('%H:%M:%S.%f')}",
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_clock_of_any_kind_is_read(tmp_path, kind):
    (test,) = read_vendor_file(
        text(tmp_path / "x.txt", map(KINDS[kind], MOMENTS), heading="Time\tLoad (mN)\tDepth (nm)"), columns=NUMBERED
    )
    assert test.warnings == ()
    assert test.recording.time == pytest.approx(T, abs=1.1e-3 if "milli" in kind or "minutes" in kind else 2e-6)
    assert test.recording.load == pytest.approx(LOAD, abs=1e-5)


@pytest.mark.parametrize("half", ["PM", "p.m.", "pm"])
def test_the_half_of_the_day_is_no_column_of_a_table_at_blanks(tmp_path, half):
    times = [f"1:{k // 60:02d}:{k % 60:02d}.5 {half}" for k in range(100)]
    rows = [f"{a}  {b:.5f}   {c:.3f}" for a, b, c in zip(times, LOAD, DEPTH, strict=True)]
    (tmp_path / "x.txt").write_text("\n".join(["Time  Load (mN)  Depth (nm)", *rows]))
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=NUMBERED)
    assert test.recording.time == pytest.approx(np.arange(100))
    assert test.recording.load == pytest.approx(LOAD, abs=1e-5)


@pytest.mark.parametrize("heading", ["Time", "Time (s)"])
def test_times_without_enough_digits_are_called_so(tmp_path, heading):
    times = [f"1:00:{k // 4:02d}" if heading == "Time" else k // 4 for k in range(100)]
    file = text(tmp_path / "x.txt", times, heading=f"{heading}\tLoad (mN)\tDepth (nm)")
    with pytest.raises(InputError, match=r"has the time of the row before; 75 of 100 rows.*with more digits"):
        read_vendor_file(file, columns=NUMBERED)


def serial(moment):
    """A moment as a workbook's number of days."""
    return (moment - dt.datetime(1899, 12, 30)).total_seconds() / 86400


@pytest.mark.parametrize(
    ("style", "number"),
    [
        ("yyyy-mm-dd hh:mm:ss.000", serial),
        ("h:mm:ss AM/PM", lambda m: serial(m) % 1),
        ("mm:ss.0", lambda m: serial(m) % 1),
        ("[h]:mm:ss.00", lambda m: serial(m) - serial(START)),
        ("h:mm:ss", lambda m: serial(m) - int(serial(START))),
    ],
)
def test_cells_of_dates_and_times_are_read(tmp_path, style, number):
    cells = [[(number(m), style), p, h] for m, p, h in zip(MOMENTS, LOAD.tolist(), DEPTH.tolist(), strict=True)]
    file = write_workbook(tmp_path / "x.xlsx", {"Data": [["Time", "Load (mN)", "Depth (nm)"], *cells]})
    (test,) = read_vendor_file(file, columns=NUMBERED)
    assert test.warnings == ()
    assert test.recording.time == pytest.approx(T, abs=1.1e-3)


def test_two_fields_are_minutes_and_seconds_unless_the_heading_says_hours(tmp_path):
    times = [f"{k // 60:02d}:{k % 60:02d}" for k in range(100)]
    for heading, factor, words in (("Time", 1, 1), ("Time (mm:ss)", 1, 0), ("Time [hh:mm]", 60, 0)):
        file = text(tmp_path / "x.txt", times, heading=f"{heading}\tLoad (mN)\tDepth (nm)")
        (test,) = read_vendor_file(file, columns=NUMBERED)
        assert test.recording.time == pytest.approx(factor * np.arange(100))
        assert len(test.warnings) == words
        assert all("taken as minutes and seconds" in warning for warning in test.warnings)


def test_a_date_that_changes_at_noon_is_refused(tmp_path):
    times = [f"{5 + (k > 50)}.3.2024 11:00:{k % 60:02d}" for k in range(60)]
    with pytest.raises(InputError, match="cannot be used"):
        read_vendor_file(text(tmp_path / "x.txt", times, LOAD[:60], DEPTH[:60]), columns=NUMBERED)


@pytest.mark.parametrize("cell", ["1:2", "99:99", "1:60:00", "25:00:00 PM", "2024-13-41T00:00:00", "ratio 1:2", ""])
def test_what_is_no_clock_stays_as_it_is(cell):
    assert seconds([cell]) == ([cell], ())


def test_rows_written_twice_count_once(tmp_path):
    times, load, depth = (np.repeat(channel, 2) for channel in (T, LOAD, DEPTH))
    (test,) = read_vendor_file(text(tmp_path / "x.txt", times, load, depth), columns=NUMBERED)
    assert test.recording.time == pytest.approx(T)
    assert "100 rows written twice, counted once" in test.warnings[-1]


@pytest.mark.parametrize("count", [1, 30])
def test_zeros_at_the_end_are_left_out(tmp_path, count):
    channels = (np.append(channel, np.zeros(count)) for channel in (T, LOAD, DEPTH))
    (test,) = read_vendor_file(text(tmp_path / "x.txt", *channels), columns=NUMBERED)
    assert test.recording.time == pytest.approx(T)
    assert f"{count} row{'s' * (count > 1)} of zeros at the end left out" in test.warnings[-1]


def test_zeros_at_the_end_are_left_out_though_time_goes_on(tmp_path):
    """As programs pad channels of unlike length; a tip that comes back to zero is no padding."""
    time = np.append(T, T[-1] + STEP * np.arange(1, 31))
    load, depth = (np.append(channel, np.zeros(30)) for channel in (LOAD, DEPTH))
    (test,) = read_vendor_file(text(tmp_path / "x.txt", time, load, depth), columns=NUMBERED)
    assert test.recording.time == pytest.approx(T)
    assert "30 rows of zeros at the end left out" in test.warnings[-1]
    load = np.append(np.maximum(LOAD - LOAD[-1], 0), np.zeros(30))
    (test,) = read_vendor_file(text(tmp_path / "x.txt", time, load, load), columns=NUMBERED)
    assert len(test.recording) == 130


@pytest.mark.parametrize("held", [0.25, 1.0, 10.0])
def test_segments_may_be_sampled_at_unlike_rates(tmp_path, held):
    times = [np.arange(0, 20, 0.1), np.arange(0, 20, held), np.arange(0, 20.01, 0.1)]
    clock = np.concatenate([since + time for since, time in zip((0, 20, 40), times, strict=True)])
    load = np.interp(clock, [0, 20, 40, 60], [0, 2, 2, 0.02])
    (test,) = read_vendor_file(
        text(tmp_path / "x.txt", np.concatenate(times), load, 300 * np.sqrt(load) + clock), columns=NUMBERED
    )
    assert test.recording.time == pytest.approx(clock, abs=2 * held)
    assert "joined as segments of one test" in test.warnings[-1]


@pytest.mark.parametrize(
    ("begins", "shared"), [((0, 20.0, 30.0), False), ((0, T[40], T[60]), False), ((0, T[40], T[60]), True)]
)
def test_a_clock_that_begins_anew_in_each_segment_goes_on(tmp_path, begins, shared):
    """By the segment's nominal begin, by its first point, and by its first point written as the last of the one before.

    The time is right to less than a step, and exact where sampling goes on evenly.
    """
    first, second = int(np.argmax(begins[1] <= T)), int(np.argmax(begins[2] <= T))
    parts = [(0, first + shared), (first, second + shared), (second, len(T))]
    ours = [T[a:b] - since for (a, b), since in zip(parts, begins, strict=True)]
    load, depth = (np.concatenate([channel[a:b] for a, b in parts]) for channel in (LOAD, DEPTH))
    (test,) = read_vendor_file(text(tmp_path / "x.txt", np.concatenate(ours), load, depth), columns=NUMBERED)
    assert test.recording.time == pytest.approx(T, abs=1e-6)
    assert test.recording.load == pytest.approx(LOAD, abs=1e-5)
    assert "time begins anew where load and depth go on" in " ".join(test.warnings)


def test_one_time_that_goes_back_is_no_segment(tmp_path):
    times = T.copy()
    times[50] = 0
    (test,) = read_vendor_file(text(tmp_path / "x.txt", times), columns=NUMBERED)
    assert len(test.recording) == 99
    assert test.warnings == ("1 of 100 rows left out: time does not increase (line 52)",)


def three(elastic=False):
    """Time, load and depth of three tests, whose depths end at zero or not."""
    load = np.interp(np.arange(61), [0, 30, 60], [0, 2, 0])
    depth = 600 * np.sqrt(load) + (0 if elastic else 5 * np.arange(61))
    return [(np.arange(61.0), f * load, f * depth) for f in (1, 0.8, 1.1)]


@pytest.mark.parametrize("blank", [0, 2])
@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("workbook", [False, True])
def test_tests_below_one_another_begin_where_time_begins_anew(tmp_path, blank, elastic, workbook):
    rows = [["Time (s)", "Load (mN)", "Depth (nm)"]]
    for time, load, depth in three(elastic):
        rows += [*zip(time.tolist(), load.tolist(), depth.tolist(), strict=True), *[["", "", ""]] * blank]
    file = tmp_path / ("x.xlsx" if workbook else "x.txt")
    if workbook:
        write_workbook(file, {"Data": rows})
    else:
        file.write_text("\n".join("\t".join(map(str, row)).strip() for row in rows))
    tests = read_vendor_file(file, columns=NUMBERED)
    for test, (time, load, depth) in zip(tests, three(elastic), strict=True):
        assert test.recording.time == pytest.approx(time)
        assert test.recording.load == pytest.approx(load)
        assert test.recording.depth == pytest.approx(depth)
    said = [warning for test in tests for warning in test.warnings]
    assert len(said) == (0 if blank else 2)
    assert all("begin anew as in the test before" in warning for warning in said)


@pytest.mark.parametrize("blank", [0, 2])
def test_tests_below_one_another_may_share_one_clock(tmp_path, blank):
    rows, late = ["Time (s)\tLoad (mN)\tDepth (nm)"], 0.0
    for time, load, depth in three():
        rows += [f"{a + late}\t{b}\t{c}" for a, b, c in zip(time, load, depth, strict=True)] + [""] * blank
        late += 100
    (tmp_path / "x.txt").write_text("\n".join(rows))
    tests = read_vendor_file(tmp_path / "x.txt", columns=NUMBERED)
    assert [len(test.recording) for test in tests] == [61, 61, 61]
    assert [test.recording.time[-1] for test in tests] == [60, 60, 60]
    assert [any("load and depth begin anew" in warning for warning in test.warnings) for test in tests[1:]] == [
        not blank
    ] * 2


def test_a_jump_back_without_load_that_follows_is_no_other_test(tmp_path):
    """As where the surface lets go of the tip, and where cycles come back to where they began."""
    time, load, depth = three()[0]
    air = np.arange(1.0, 41.0)
    away = [np.append(time, 60 + air), np.append(load, 0 * air), np.append(depth, -0.1 * air)]
    cycles = [np.concatenate([time, 61 + time]), np.tile(three(elastic=True)[0][1], 2), np.tile(three(True)[0][2], 2)]
    for values in (away, cycles):
        assert len(read_vendor_file(text(tmp_path / "x.txt", *values), columns=NUMBERED)) == 1


def test_blank_rows_within_a_test_part_nothing(tmp_path):
    rows = [f"{a}\t{b}\t{c}" for a, b, c in zip(*three()[0], strict=True)]
    (tmp_path / "x.txt").write_text("\n".join(["Time (s)\tLoad (mN)\tDepth (nm)", *rows[:30], "", "", *rows[30:]]))
    (test,) = read_vendor_file(tmp_path / "x.txt", columns=NUMBERED)
    assert len(test.recording) == 61
    assert test.warnings == ()


def test_cycles_whose_clock_begins_anew_are_one_test(tmp_path):
    """Load returns to zero in each cycle; depth stays where the cycle before left it."""
    load = np.interp(np.arange(61), [0, 30, 60], [0, 2, 0])
    depth = [600 * np.sqrt(load) + 200 * k + np.interp(np.arange(61), [0, 60], [0, 200]) for k in range(3)]
    file = text(tmp_path / "x.txt", [*range(61)] * 3, np.tile(load, 3), np.concatenate(depth))
    (test,) = read_each(file, columns=NUMBERED)
    assert test.recording.time[-1] == pytest.approx(180, abs=2)
    assert "joined as segments" in test.warnings[-1]
