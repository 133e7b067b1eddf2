"""A compliance of the mount: a frame where all recordings share it, and each recording's own where they do not."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis_problem import CONDITIONS, fitted, problem, recordings

from palpate.configuration.settings import CalibrationSettings
from palpate.diagnosis.constraints import contradicted
from palpate.diagnosis.individual_amplitudes import recording_values
from palpate.inference.amplitude_constraint import AmplitudeConstraint
from palpate.mechanisms import Assumption, breaking

KEY, FRAME = "mount_compliance", "frame_compliance"
STUDY = SimpleNamespace(conditions=CONDITIONS, calibration=CalibrationSettings(solver_error=0.003))


def both(compliance):
    """Return fits of a frame and of a mount to recordings with a ``compliance(condition, replicate)`` [nm/mN]."""
    observed = recordings(np.random.default_rng(5), lambda c, r: compliance(c.name, r) * c.protocol.sample_load)
    task = problem(observed)
    return fitted(task, (FRAME,)), fitted(task, (KEY,))


@pytest.fixture(scope="module")
def varied():
    own = np.random.default_rng(1).normal(8.0, 4.0, (4, 3))
    return own, *both(lambda name, r: own["abcd".index(name), r])


def test_one_compliance_for_all_is_as_likely_a_frame():
    frame, mount = both(lambda name, r: 8.0)
    assert mount.log_evidence == pytest.approx(frame.log_evidence, abs=2.0)
    for key, fit in ((FRAME, frame), (KEY, mount)):
        assert fit.problem.amplitudes(fit.explanation, fit.z)[key]["compliance"] == pytest.approx(8.0, abs=1.0)


def test_compliances_that_differ_are_no_frame(varied):
    _, frame, mount = varied
    assert mount.log_evidence > frame.log_evidence + 5.0


def test_every_recording_has_its_own_compliance(varied):
    own, _, mount = varied
    rows = recording_values(STUDY, mount.problem.observed, mount)[f"{KEY}.compliance"]
    held = [row["lower"] < own["abcd".index(row["condition"]), row["number"] - 1] < row["upper"] for row in rows]
    assert np.mean(held) > 0.85


def test_what_is_measured_of_a_frame_says_nothing_of_a_mount(varied):
    """Exact laws take tests together, as if they shared one compliance."""
    _, frame, mount = varied
    law = AmplitudeConstraint(
        FRAME, "compliance", 30.0, 29.0, 31.0, "tops of unloadings", breaking(Assumption.ONE_COMPLIANCE)
    )
    assert contradicted(frame, [law]) == [law]
    assert contradicted(mount, [law]) == []
