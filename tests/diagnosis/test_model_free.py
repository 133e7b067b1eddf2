"""Facts without a model, on cones in closed form that creep, with planted effects of the instrument."""

import numpy as np
import pytest
from study_file import load
from wilson import wilson

from indentation_files.recording import Recording
from palpate.configuration.condition import Condition
from palpate.data.observation import Observation
from palpate.diagnosis import replicate_facts, scaling_facts
from palpate.diagnosis.fact import Fact
from palpate.diagnosis.model_free import model_free
from palpate.mechanisms import MECHANISMS
from palpate.study.protocol import trapezoid

LOADS = (0.5, 2.0, 8.0)
CONDITIONS = [Condition(f"P{load:g}", "calibrate", trapezoid(load, 20, 10, 20, points=100)) for load in LOADS]


def unloaded(protocol):
    """Depth (n,) that follows the scaling law through unloading, too: the cone's, less what its load gives back."""
    highest = np.maximum.accumulate(protocol.sample_load)
    recovered = 60.0 * np.sqrt(highest) * (1.0 - protocol.sample_load / highest)
    flow = np.cumsum(protocol.sample_load * np.diff(protocol.sample_time, prepend=0.0))
    return 500.0 * np.sqrt(highest + 0.01 * flow) - recovered


def drawn(rng, effect=lambda protocol, r: 0.0, replicates=4, site=0.005, noise=0.5):
    found = []
    for condition in CONDITIONS:
        protocol = condition.protocol
        time, load = np.append(0.0, protocol.sample_time), np.append(0.0, protocol.sample_load)
        rows = [
            unloaded(protocol) * (1.0 + site * rng.standard_normal())
            + effect(protocol, r)
            + noise * rng.standard_normal(len(load) - 1)
            for r in range(replicates)
        ]
        found.append((condition, [Recording(time, load, np.append(0.0, row)) for row in rows]))
    return found


def scaled(tests):
    return {fact.fact.split(",")[0].split(" of P")[0]: fact for fact in scaling_facts.facts(tests, 0.01, True)}


def of_replicates(tests):
    observed = {c.name: Observation.from_recordings(c.protocol, rs) for c, rs in tests}
    return {fact.fact.split(" of ")[1].split(",")[0]: fact for fact in replicate_facts.differences(observed)}


def test_a_creeping_cone_obeys_the_scaling_law():
    """Its intervals hold what is true as often as they say; creep is no length."""
    draws, rng, kept = 200, np.random.default_rng(1), {}
    for _ in range(draws):
        for name, fact in scaled(drawn(rng)).items():
            if fact.neutral is not None:
                kept[name] = kept.get(name, 0) + (fact.lower <= fact.neutral <= fact.upper)
    assert len(kept) >= 2
    assert {name: count for name, count in kept.items() if wilson(count, draws)[1] < 0.95} == {}


def test_a_planted_frame_shows_in_every_fact_of_the_scaling_law():
    found = scaled(drawn(np.random.default_rng(2), lambda protocol, r: 8.0 * protocol.sample_load))
    frame = found["compliance in series"]
    assert frame.lower <= 8.0 <= frame.upper and frame.lower > 0.0
    assert "frame_compliance" in frame.suggests
    ratio = found["depth / sqrt(load)"]
    assert ratio.lower > 1.0 and "frame_compliance" in ratio.suggests


def test_a_planted_zero_moves_the_ratio_and_not_the_slope():
    found = scaled(drawn(np.random.default_rng(3), lambda protocol, r: 30.0))
    assert found["depth / sqrt(load)"].upper < 1.0
    assert "zero_offset" in found["depth / sqrt(load)"].suggests
    slope = found["change of d(depth)/d(sqrt(load)) along loading"]
    assert slope.lower <= 0.0 <= slope.upper


@pytest.mark.parametrize(
    ("kind", "key", "effect", "truth"),
    [
        ("zero points", "zero_offset", lambda protocol, r: (-9.0, -3.0, 3.0, 9.0)[r], 7.75),
        ("drifts", "thermal_drift", lambda protocol, r: (-0.3, -0.1, 0.1, 0.3)[r] * protocol.sample_time, 0.258),
    ],
)
def test_replicates_differ_by_what_was_planted(kind, key, effect, truth):
    found = of_replicates(drawn(np.random.default_rng(4), effect))
    assert found[kind].estimate == pytest.approx(truth, rel=0.3)
    assert key in found[kind].suggests
    others = [fact for name, fact in found.items() if name != kind]
    assert [fact.suggests for fact in others] == [[], []]


def test_sites_scatter_in_proportion_and_suggest_nothing():
    found = of_replicates(drawn(np.random.default_rng(5), site=0.02))
    assert found["sites"].lower <= 0.02 <= found["sites"].upper
    assert found["sites"].lower > 0.0
    assert all(not fact.suggests for fact in found.values())


def test_a_trend_from_test_to_test():
    def worn(protocol, r):
        return 0.02 * r * unloaded(protocol)

    (found,) = replicate_facts.trend(drawn(np.random.default_rng(6), worn))
    assert found.lower <= 0.02 <= found.upper
    assert found.lower > 0.0


def test_histories_of_one_shape_are_compared():
    longer = Condition("long", "calibrate", trapezoid(4.0, 40, 10, 20, points=100))
    groups = scaling_facts.alike([(c, []) for c in (longer, *reversed(CONDITIONS))])
    assert [[test[0].name for test in group] for group in groups] == [["long"], ["P0.5", "P2", "P8"]]


def test_a_fact_about_another_tip_suggests_that_tip_s_own_effects():
    fact = Fact("level", 1.2, 1.1, 1.3, "-", ("tip_rounding", "frame_compliance"), 1.0)
    assert fact.under_tip("") is fact
    of_corner = fact.under_tip("corner")
    assert of_corner.suggests == ["tip_rounding[corner]", "frame_compliance"]
    assert (of_corner.row()["fact"], of_corner.estimate) == ("level, with corner", 1.2)
    assert MECHANISMS[of_corner.suggests[0]].title == "tip rounding of corner"


def test_loads_are_compared_within_each_sharp_tip(tmp_path):
    """A blunter tip at another load is no length of the first one; under a sphere no such law holds."""
    rng, times = np.random.default_rng(8), {"loading_time": 20, "hold_time": 10, "unloading_time": 20}
    blunt = {"name": "blunt", "shape": "cone", "half_angle": 75.0}
    tips = {"a": None, "b": None, "c": blunt, "d": "blunt", "e": {"name": "ball", "shape": "sphere", "radius": 1e4}}
    entries = [
        {"name": name, "max_load": load, **times} | ({"indenter": tip} if tip else {})
        for (name, tip), load in zip(tips.items(), (0.5, 2.0, 1.0, 8.0, 4.0), strict=True)
    ]
    study = load(tmp_path, conditions=entries)
    recorded, observed = {}, {}
    for condition in study.conditions:
        factor = {"": 1.0, "blunt": 0.7, "ball": 0.5}[condition.tip]
        rows = [factor * unloaded(condition.protocol) * (1 + 0.005 * rng.standard_normal()) for _ in range(3)]
        rows = [row + 0.5 * rng.standard_normal(len(row)) for row in rows]
        time, pressed = condition.protocol.sample_time, condition.protocol.sample_load
        recorded[condition.name] = [Recording(*(np.append(0.0, x) for x in (time, pressed, row))) for row in rows]
        observed[condition.name] = Observation(time, np.array(rows), "calibrate")
    levels = [fact for fact in model_free(study, recorded, observed) if fact.fact.startswith("depth / sqrt(load)")]
    assert [fact.fact for fact in levels] == [
        "depth / sqrt(load) of b over a",
        "depth / sqrt(load) of d over c, with blunt",
    ]
    assert all(fact.lower < 1.0 < fact.upper for fact in levels)


def test_a_fact_suggests_nothing_where_its_interval_holds_what_is_found_without():
    keys = ("thermal_drift", "unheard_of")
    clear = Fact("rate", 0.2, 0.1, 0.3, "nm/s", keys, negligible=0.01)
    assert clear.suggests == ["thermal_drift"]
    for quiet in (
        Fact("rate", 0.2, -0.1, 0.3, "nm/s", keys),
        Fact("rate", 0.2, 0.1, 0.3, "nm/s", keys, neutral=None),
        Fact("rate", 0.008, 0.005, 0.009, "nm/s", keys, negligible=0.01),
    ):
        assert quiet.suggests == []
