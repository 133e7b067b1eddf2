"""The section ``instrument``: what may be shared, which prior is refused, and what of a prior is read."""

import json
from pathlib import Path

import numpy as np
import pytest
from study_file import STUDY, load

from palpate.base.checksum import checksum
from palpate.configuration.instrument_section import instrument_file, instrument_record
from palpate.diagnosis.candidates import candidates
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS
from palpate.solver.study_scale import scale_of

BOTH = ["frame_compliance", "tip_rounding"]
FOUND = {
    "shares": BOTH,
    "inclusion": {"frame_compliance": 0.8, "tip_rounding": 0.5},
    "quantities": [
        {"name": "frame_compliance.compliance", "unit": "nm/mN", "lower": -20.0, "upper": 20.0, "typical": 0.3},
        {"name": "tip_rounding.radius", "unit": "nm", "lower": 1.0, "upper": 600.0, "typical": None},
    ],
    "sets": [
        {
            "mechanisms": BOTH,
            "probability": 0.4,
            "quantities": ["frame_compliance.compliance", "tip_rounding.radius"],
            "mean": [0.6, 0.1],
            "covariance": [[4e-4, 1e-4], [1e-4, 9e-4]],
        },
        {
            "mechanisms": ["frame_compliance"],
            "probability": 0.4,
            "quantities": ["frame_compliance.compliance"],
            "mean": [0.7],
            "covariance": [[4e-4]],
        },
        {"mechanisms": ["tip_rounding"], "probability": 0.1},
        {"mechanisms": [], "probability": 0.1},
    ],
}


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def kept(study="silica", name="xp", prior=None, recordings=None):
    file = instrument_file(study)
    file.parent.mkdir(parents=True, exist_ok=True)
    record = {"name": name, "study": study, **FOUND, "recordings": recordings or {}, "prior": prior}
    file.write_text(json.dumps(record))
    return record


def shared(shares=BOTH, prior="silica", name="xp", **changes):
    instrument = {"name": name, "shares": list(shares)} | ({"prior": prior} if prior else {})
    return load(Path(), instrument=instrument, **changes)


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("magic", "instrument.shares: mechanism 'magic' is not known"),
        ("thermal_drift", "instrument.shares: thermal drift has no value that every test on the instrument shares"),
        ("mount_compliance", "has no value that every test on the instrument shares"),
        ("film_on_substrate", "has no value that every test on the instrument shares; use some of: controller_lag"),
    ],
)
def test_only_effects_of_the_instrument_are_shared(key, words):
    with pytest.raises(InputError) as refused:
        shared([key], None)
    assert words in str(refused.value) and str(refused.value).startswith("study.yaml")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"prior": "s"}, "a study cannot be its own prior"),
        ({"prior": "no"}, "results/no/instrument.json is missing; run the study first: palpate run no.yaml"),
        ({"prior": "nowhere.json"}, "nowhere.json is missing; give its path"),
        ({"name": "g200"}, "silica was made on xp, this study names g200"),
        ({"shares": ["tip_angle"]}, "silica does not share tip_angle; use some of: frame_compliance, tip_rounding"),
        (
            {"diagnosis": {"ranges": {"tip_rounding": {"radius": [10, 90]}}}},
            "tip_rounding has the ranges of its prior, and others under diagnosis.ranges",
        ),
    ],
)
def test_a_prior_that_cannot_be_is_refused(changes, words):
    kept()
    with pytest.raises(InputError) as refused:
        shared(**changes)
    assert f"instrument.prior: {words}" in str(refused.value)


def test_two_studies_that_rest_on_each_other_are_refused():
    kept("steel", prior=kept("silica", prior=kept("s")))
    with pytest.raises(InputError, match=r"instrument\.prior: steel rests on s; let one of the two"):
        shared(prior="steel")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"name": "xp", "quantities": 1, "sets": []}'])
def test_a_damaged_prior_is_refused(text):
    kept()
    instrument_file("silica").write_text(text)
    with pytest.raises(InputError, match="does not hold what a study finds of an instrument; make it again"):
        shared()


def test_several_sets_of_recordings_are_refused():
    with pytest.raises(InputError, match="instrument: the study has several sets of recordings; give each set"):
        shared(prior=None, recordings={"a": "a", "b": "b"})


def test_recordings_that_made_the_prior_are_refused():
    own, other = Path("own.csv"), Path("other.csv")
    own.write_text("1"), other.write_text("2")
    kept("steel", prior=kept("silica", recordings={"elsewhere.csv": checksum(own)}))
    instrument = shared(prior="steel").instrument
    instrument.check_data([other])
    with pytest.raises(InputError, match=r"own\.csv is among the recordings of silica, which made the prior"):
        instrument.check_data([other, own])


def test_shared_effects_are_among_those_considered():
    kept()
    assert set(BOTH) <= set(candidates(shared()))
    with pytest.raises(InputError, match=r"instrument\.shares: tip_rounding is not considered"):
        candidates(shared(diagnosis={"mechanisms": ["frame_compliance"]}))


def test_the_prior_of_some_effects_is_the_marginal_one():
    kept()
    prior = shared(["frame_compliance"]).instrument.prior
    frame = frozenset({"frame_compliance"})
    assert prior.probabilities == pytest.approx({frame: 0.8, frozenset(): 0.2})
    assert prior.amplitudes[frame].mean == pytest.approx([0.65])
    assert prior.amplitudes[frame].covariance == pytest.approx(np.array([[4e-4 + 0.05**2]]))


def test_an_effect_has_the_coordinate_of_the_earlier_study():
    kept()
    scale = scale_of(shared())
    ranges = MECHANISMS["frame_compliance"].searched(scale)["compliance"]
    assert (ranges.lower, ranges.upper, ranges.typical) == (-20.0, 20.0, 0.3)
    assert scale_of(load(Path())).instrument is None


def test_a_record_holds_that_of_its_prior():
    file = Path("test.csv")
    file.write_text("1")
    first = kept()
    record = instrument_record("s", shared().instrument, FOUND, [file])
    assert record["prior"] == first and record["recordings"] == {"test.csv": checksum(file)}
    assert STUDY["study"] == record["study"] and record["name"] == "xp"
