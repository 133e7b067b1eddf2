"""A frame that stiffens: its slope at small and its limit at large loads, and where it is told from a steady frame."""

import numpy as np
import pytest
from diagnosis_problem import RECORD_ONLY, problem, recordings, search_of

from palpate.diagnosis.diagnose import diagnose
from palpate.mechanisms import MECHANISMS

KEY, FRAME = "frame_stiffening", "frame_compliance"


def added(load, compliance=8.0, scale=0.5):
    values = {"compliance": compliance, "load": scale}
    return MECHANISMS[KEY].record(np.zeros_like(load), load, np.zeros_like(load), values)


def test_it_begins_with_its_compliance_and_ends_at_a_constant():
    assert added(np.array([1e-6])) == pytest.approx(8.0 * 1e-6)
    assert added(np.array([50.0])) == pytest.approx(8.0 * 0.5)


@pytest.mark.parametrize(("scale", "expected"), [(0.5, KEY), (1e6, FRAME)])
def test_it_is_named_where_a_steady_frame_does_not_suffice(scale, expected):
    observed = recordings(np.random.default_rng(3), lambda c, _: added(c.protocol.sample_load, 20.0, scale))
    found = diagnose(search_of(problem(observed), [*RECORD_ONLY, KEY]), lambda said: None)
    assert (found.verdict, [each.fit.explanation for each in found.accepted]) == ("identified", [(expected,)])
