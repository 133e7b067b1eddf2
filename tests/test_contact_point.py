"""Contact found in recordings whose contact is known, exactly or from their own loading curves."""

import numpy as np
import pytest
from contact_curves import autoregressive
from scipy.ndimage import median_filter
from test_readers import KLA, XP, needs_recordings

from indentation_files.contact_point import first_touch, loading, touch_at
from indentation_files.readers import read_vendor_file
from indentation_files.readers.zero import zeroed
from indentation_files.sharp_origin import sharp_origin
from palpate.errors import InputError

CONTACT, RAMP = 37.0, 9e-5


def law(depth, cap):
    """Load of a sharp tip with a spherical cap of height `cap`: Hertz, then a square, smooth where they meet."""
    depth = np.clip(depth, 0.0, None)
    hertz = RAMP * (cap + cap / 3) ** 2 / cap**1.5
    return np.where(depth < cap, hertz * depth**1.5, RAMP * (depth + cap / 3) ** 2)


def recording(seed, cap, size=800, approach=True):
    """Approach from 100 nm above, on a spring that leaves 1e-6 mN/nm; then 800 nm down in 50 s."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0 if approach else 10, 60, size)
    path = np.where(time < 10, -100 + 10 * time, 16 * (time - 10))
    load = law(path, cap) + 3e-4 * autoregressive(rng, size, 0.5) + (0.01 + 1e-6 * path if approach else 0.0)
    return time, load, path + CONTACT + 0.5 * autoregressive(rng, size, 0.5)


@pytest.mark.parametrize("approach", [True, False])
@pytest.mark.parametrize("cap", [1.0, 20.0, 60.0])
def test_known_contact_lies_in_the_interval(cap, approach):
    found = [first_touch(*recording(seed, cap, 400 + 200 * (seed % 4), approach)) for seed in range(12)]
    errors = np.array([point.depth - CONTACT for point in found])
    assert np.sqrt(np.mean(errors**2)) < 3.0
    held = sum(point.lower <= CONTACT <= point.upper for point in found)
    assert held >= 9, "of 12, at 95 %"
    assert np.median([point.upper - point.lower for point in found]) < 10.0


@pytest.mark.parametrize("drive", ["even depth", "spring"])
@pytest.mark.parametrize(("exponent", "noise", "tilt"), [(1.5, 0.0, 0.0), (1.5, 3e-5, 0.1), (2.0, 1e-4, -0.1)])
@pytest.mark.parametrize(("way", "size"), [(400.0, 300), (400.0, 2000), (1000.0, 300)])
def test_contact_of_a_force_curve_of_little_noise(drive, exponent, noise, tilt, way, size):
    """A force curve, 600 nm before contact, and back; the spring bends by three times the depth."""
    depth = np.linspace(0.0, 1.0, 20001)
    piezo = 600.0 / way + depth + (3.0 * depth**exponent if drive == "spring" else 0.0)
    ramp = np.linspace(0.0, piezo[-1], size)
    path = np.where(ramp < piezo[0], ramp - piezo[0], np.interp(ramp, piezo, depth))
    path = np.append(path, path[::-1])
    load = 1e-4 * (np.clip(path, 0.0, None) ** exponent + tilt * path - 2.0)
    load += 1e-4 * noise * np.random.default_rng(1).standard_normal(2 * size)
    point = first_touch(1e-3 * np.arange(2 * size), load, 600.0 + way * path)
    assert point.lower <= 600.0 <= point.upper
    assert point.upper - point.lower < 0.1 * way


def test_contact_moves_with_depth_time_and_unit():
    time, load, depth = recording(3, 20.0)
    point, moved = first_touch(time, load, depth), first_touch(time + 7.0, 2 * load, depth - 500.0)
    assert moved.depth == pytest.approx(point.depth - 500.0, abs=1e-6)
    assert moved.time == pytest.approx(point.time + 7.0, abs=1e-6)
    assert moved.load == pytest.approx(2 * point.load, abs=1e-9)
    assert point.load == pytest.approx(0.01, abs=3e-4)
    assert point.time == pytest.approx(10.0, abs=0.3)


def test_an_earlier_touch_and_lift_is_not_taken_for_contact():
    time, load, depth = recording(5, 20.0)
    before = np.linspace(-20, -0.1, 300)
    lifted = np.interp(before, [-20, 0], [CONTACT + 5, CONTACT - 100])
    first = 0.01 + law(lifted - CONTACT, 20.0)
    point = first_touch(np.append(before, time), np.append(first, load), np.append(lifted, depth))
    assert point.depth == pytest.approx(CONTACT, abs=4.0)
    assert point.time == pytest.approx(10.0, abs=0.5)


def test_contact_after_a_lift_and_a_quick_way_back_of_few_points():
    """As quasi-static tests in air begin: lifted by 27 nm in 2 s, back in 0.08 s, 600 uN at 70 nm after 5 s."""
    points, errors, held = 9, [], 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        lift, down = np.linspace(0, 2, 200), np.linspace(0, 5, 500)
        path = np.concatenate([-27 * lift / 2, np.linspace(-27, -1.5, points), 70 * np.sqrt(down / 5)])
        load = np.concatenate([-3.6e-3 - 6e-4 * lift, np.linspace(-4.7e-3, -3.6e-3, points), 0.6 * down / 5 - 3.5e-3])
        time = 0.01 * np.arange(len(path))
        point = first_touch(time, load + rng.normal(0, 1e-4, len(path)), path + rng.normal(0, 0.15, len(path)))
        errors.append(point.depth)
        held += point.lower <= 0.0 <= point.upper
        assert point.load == pytest.approx(-3.5e-3, abs=1e-3)
    assert np.sqrt(np.mean(np.square(errors))) < 1.0
    assert held >= 9, "of 12, at 95 %"


@pytest.mark.parametrize("zero", [20.0, -100.0])
def test_what_the_load_reads_without_contact_does_not_matter(zero):
    time, load, depth = recording(2, 20.0)
    plain, moved = first_touch(time, load, depth), first_touch(time, load + zero, depth)
    assert moved.depth == pytest.approx(plain.depth, abs=1e-6)
    assert moved.load == pytest.approx(plain.load + zero)


@pytest.mark.parametrize("far", [20e3, 100e3])
def test_a_test_that_is_short_beside_its_approach(far):
    """As force curves of a microscope: 800 nm of loading after up to 100 um of air."""
    time, load, depth = recording(4, 20.0)
    before = np.linspace(-40, -0.1, 400)
    away = np.interp(before, [-40, 0], [depth[0] - far, depth[0]])
    quiet = load[0] + 3e-4 * np.random.default_rng(1).standard_normal(400)
    point = first_touch(np.append(before, time), np.append(quiet, load), np.append(away, depth))
    assert point.lower <= CONTACT <= point.upper
    assert point.upper - point.lower < 40.0


def test_a_spike_on_the_way_in_is_not_taken_for_contact():
    time, load, depth = recording(2, 20.0)
    plain = first_touch(time, load, depth)
    load[40] = 0.5 * load.max()
    assert first_touch(time, load, depth).depth == pytest.approx(plain.depth, abs=1.0)


def test_contact_lies_before_the_first_of_growing_cycles():
    """Each of them unloads fully and retreats; the first gains a fiftieth of the largest load."""
    time, load, depth = recording(3, 20.0)
    plain = first_touch(time, load, depth)
    small = load < 0.02 * load.max()
    back = np.linspace(depth[small][-1], CONTACT - 20.0, 60)
    force = 0.01 + law(np.linspace(0.0, 1.0, 60)[::-1] * (back[0] - CONTACT), 20.0)
    after = np.append(depth[small], back)
    cycles = first_touch(
        np.arange(len(after) + len(time)) * (time[1] - time[0]),
        np.concatenate([load[small], force, load]),
        np.append(after, depth),
    )
    assert cycles.time < small.sum() * (time[1] - time[0])
    assert cycles.depth == pytest.approx(plain.depth, abs=6.0)


def test_origin_of_the_sharp_law_lies_before_a_blunt_tip_s_touch():
    _, load, depth = recording(1, 60.0, approach=False)
    origin, lower, upper = sharp_origin(load, depth)
    assert origin == pytest.approx(CONTACT - 20.0, abs=1.0)
    assert lower < origin < upper


def test_origin_lies_within_its_interval_where_neighbours_share_their_noise():
    """With a correlation estimated from what the fit leaves, 0.79 of such intervals held it, of 20 points 0.58."""
    rng, load, held = np.random.default_rng(31), np.linspace(0.0, 4.0, 61)[1:], 0
    for _ in range(200):
        depth = 10.0 + 500.0 * np.sqrt(load) + autoregressive(rng, 60, 0.9)
        _, lower, upper = sharp_origin(load, depth)
        held += lower <= 10.0 <= upper
    assert held >= 0.92 * 200


def test_contact_given_by_the_user():
    time, load, depth = recording(2, 20.0)
    point = touch_at(CONTACT, time, load, depth)
    assert (point.depth, point.lower, point.upper) == (CONTACT, CONTACT, CONTACT)
    assert point.time == pytest.approx(10.0, abs=0.2)
    with pytest.raises(InputError, match="outside the way in"):
        touch_at(5000.0, time, load, depth)


def test_too_few_points_are_refused():
    with pytest.raises(InputError, match="too few"):
        first_touch(np.arange(5.0), np.arange(5.0), np.arange(5.0))


@needs_recordings
def test_fused_silica_zero_points():
    """The zeros that the loading curves extrapolate to: 14 at 45 to 57 nm, test 11 at 161, test 3 (dirt) at 855."""
    for number, test in enumerate(read_vendor_file(KLA, contact="none"), 1):
        r = test.recording
        touch = first_touch(r.time, r.load, r.depth)
        origin, lower, upper = sharp_origin(r.load - touch.load, r.depth)
        expected = {3: (855, 5), 11: (161, 5)}.get(number, (51, 7))
        assert origin == pytest.approx(expected[0], abs=expected[1]), test.name
        assert lower < origin < upper
        assert touch.upper < lower if number == 3 else touch.depth > upper, "dirt is touched first; a blunt tip too"


@needs_recordings
def test_vendor_s_contact_is_found_again():
    """The XP marks contact by a rise in harmonic stiffness, on its way in at 10 nm/s: within a second of that."""
    for test in read_vendor_file(XP, contact="none"):
        r = test.recording
        assert first_touch(r.time, r.load, r.depth).depth == pytest.approx(0.0, abs=10.0), test.name


@needs_recordings
@pytest.mark.parametrize("name", ["S-1 X-1 Y-2", "X-3 Y-5", "X-1 Y-1", "X-10 Y-10", "X-5 Y-1", "X-9 Y-1"])
def test_contact_of_gels_lies_where_it_is_drawn_by_eye(name):
    """Where the load was last within twice its noise about a line in air, to where it has risen by 3 %."""
    (file,) = (KLA.parents[1] / "ritchie_gels").glob(f"*{name} I-1.txt")
    r = read_vendor_file(file, contact="none")[0].recording
    first, last = loading(r.load, r.depth)
    load, depth = median_filter(r.load, 5)[first : last + 1], r.depth[first : last + 1]
    air = (depth < -1000.0) & (depth > 0.85 * depth[0])
    excess = load - np.polyval(np.polyfit(depth[air], load[air], 1), depth)
    risen = int(np.argmax((excess > 0.03 * excess[-1]) & (depth > -1000.0)))
    still = np.flatnonzero(excess[:risen] < 2 * np.std(excess[air]))[-1]
    point = first_touch(r.time, r.load, r.depth)
    assert point.lower <= depth[risen]
    assert point.upper >= depth[still]


@needs_recordings
def test_replicates_of_a_soft_solid_are_touched_alike():
    """Its load rises by a kink at about -40 nm; test 13 met dirt."""
    pytest.importorskip("h5py")
    tests = read_vendor_file(KLA.parents[1] / "micromechanics/N1_1.hdf5", contact="none")
    assert len(tests) == 16, "none is taken for the mean of the others"
    for r in (test.recording for test in tests):
        point = first_touch(r.time, r.load, r.depth)
        assert abs(point.depth + 40.0) < 250.0, r.name
        assert point.lower <= 0.0 <= point.upper, r.name


@needs_recordings
def test_contact_chosen():
    file, auto, whole, own = (
        read_vendor_file(KLA, contact=choice)[0].recording for choice in ("file", "auto", "none", 80)
    )
    assert whole.depth.max() == file.depth.max()
    assert auto.time[0] == auto.depth[0] == auto.load[0] == 0
    assert file.depth.max() - auto.depth.max() == pytest.approx(87, abs=3)
    assert file.depth.max() - own.depth.max() == 80
    assert any("contact found by palpate: at" in note for note in auto.notes)
    with pytest.raises(InputError, match="file, auto, none"):
        zeroed(read_vendor_file(KLA)[0], "automatic")


@pytest.mark.parametrize("size", [12, 300])
@pytest.mark.parametrize("constant", ["load", "depth"])
def test_a_channel_that_never_changes_is_refused(size, constant):
    noise = np.random.default_rng(size).standard_normal(size)
    noise[-1] = 9.0
    load, depth = (np.full(size, 3.0) if name == constant else noise for name in ("load", "depth"))
    with pytest.raises(InputError, match=r"does not change on the way|points lie on the way in"):
        first_touch(np.arange(size) / 10, load, depth)
