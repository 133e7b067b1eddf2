"""The search among explanations, with fits that are given."""

from types import SimpleNamespace

from palpate.diagnosis.diagnose import Candidate, _sharpened

LEVEL = 0.01


def candidate(name, evidence, p_value=0.5):
    fit = SimpleNamespace(explanation=(name,), log_evidence=evidence)
    return Candidate(fit, p_value, confirmed=True)


def names(candidates):
    return ["+".join(candidate.fit.explanation) for candidate in candidates]


def stand(found, sharpened):
    """Return the names of what stands of `found`, where some turn out otherwise once `sharpened`; by name."""
    better = {"+".join(candidate.fit.explanation): candidate for candidate in sharpened}
    search = SimpleNamespace(sharpened=lambda each: better.get("+".join(each.fit.explanation), each))
    tried, standing = _sharpened(search, found, found, LEVEL)
    assert len(tried) == len(found)
    evidence = [each.fit.log_evidence for each in tried]
    assert evidence == sorted(evidence, reverse=True)
    return names(standing)


def test_what_stands_is_listed_best_first():
    """Sharpened, the second is the likelier; answer and curves rest on the first of the list."""
    found = [candidate("film", 10.0), candidate("frame", 9.0)]
    assert stand(found, [candidate("film", 8.0)]) == ["frame", "film"]


def test_one_that_turns_out_less_likely_does_not_stand_alone():
    """The second was beyond the likelihood ratio of a hundred of what the first had seemed."""
    found = [candidate("film", 10.0), candidate("frame", 4.0), candidate("drift", 2.0)]
    assert stand(found, [candidate("film", 3.0), candidate("frame", 4.5)]) == ["frame", "film", "drift"]


def test_another_may_stand_in_place_of_one_that_turns_out_to_leave_more_than_noise():
    found = [candidate("film", 10.0), candidate("frame", 4.0)]
    assert stand(found, [candidate("film", 6.0, p_value=0.001)]) == ["frame"]
    assert stand(found, [candidate("film", 9.0, p_value=0.001)]) == []
