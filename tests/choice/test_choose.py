"""The choice of a law: where fits begin, the ranges about a fit, and which law is chosen."""

from dataclasses import replace

import numpy as np
import pytest

from indentation_files.recording import Recording
from palpate.choice.choose import check_distinguishable, choose, levels_about
from palpate.choice.compared_laws import ComparedLaws, with_levels
from palpate.configuration.levels import checked_levels
from palpate.configuration.study_file import study_from
from palpate.data.study_recordings import check, resampled
from palpate.draft.guesses import ranges
from palpate.errors import InputError
from palpate.materials.families import FAMILIES, neutral
from palpate.solver.simulation import simulate_batch

METAL = {
    "study": "metal",
    "material": {"model": "auto", "family": "metal", "poisson_ratio": 0.3},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "kinematics": "small",
    "points": 20,
    "conditions": [
        {"name": "A", "max_load": 5.0, "loading_time": 30, "unloading_time": 30},
        {"name": "B", "max_load": 2.0, "loading_time": 60, "unloading_time": 60, "role": "validate"},
    ],
    "recordings": {"lab": "recordings"},
}
CREEPS = "bilinear_plasticity+retardation_spectrum"
TRUTH = {
    "youngs_modulus": 70.0, "yield_stress": 0.8, "hardening": 1.0, "spectrum_coefficient": 2e-3,
    "spectrum_exponent": 0.1,
}  # fmt: skip


@pytest.fixture(scope="module")
def metal(tmp_path_factory):
    """A study whose recordings are of a metal that creeps; three replicates with a noise of 0.3 nm, sites of 0.3 %."""
    folder = tmp_path_factory.mktemp("metal")
    study = study_from(METAL | {"recordings": {"lab": str(folder)}}, "study.yaml")
    true, rng = with_levels(study, CREEPS, {name: [value] for name, value in TRUTH.items()}), np.random.default_rng(4)
    for condition in true.conditions:
        (curve,) = simulate_batch([true.specification(TRUTH, condition)])
        time, load = condition.protocol.sample_time, condition.protocol.sample_drive
        for number in (1, 2, 3):
            depth = curve.response * (1.0 + 0.003 * rng.normal()) + 0.3 * rng.normal(size=len(time))
            Recording(time, load, depth, "made").write(folder / f"{condition.name}_{number}.csv")
    return study


@pytest.fixture(scope="module")
def compared(metal):
    """The laws of the family, and the fit of the base law."""
    recorded = check(metal, "lab")
    solid, loading = check_distinguishable(metal, recorded)
    guessed = {law: ranges(law, solid, loading) for law in FAMILIES["metal"].laws}
    laws, law = ComparedLaws(metal, resampled(metal, recorded), guessed), FAMILIES["metal"].base
    begun = laws.problem(law).forward.coordinates.scaled(TRUTH)
    return laws, laws.weighed(laws.fit(law, [begun]))


def test_levels_hold_the_estimate_and_keep_to_the_law(compared):
    laws, base = compared
    levels, named = levels_about(laws.study, base), base.coordinates.named(base.z)
    assert all(row[0] <= named[name] <= row[-1] for name, row in levels.items())
    assert checked_levels(FAMILIES["metal"].base, laws.study.fixed, levels, "sobol")


def test_a_fit_begins_at_the_base_law_where_the_law_contains_it(compared):
    laws, base = compared
    values = neutral(base.coordinates.named(base.z), 30.0)
    (begun,) = laws.at_base("ludwik_plasticity", values)
    named = laws.problem("ludwik_plasticity").forward.coordinates.named(begun)
    assert named["strength"] == pytest.approx(values["hardening"], rel=1e-6) and named["hardening_exponent"] == 1.0
    del values["strength"]
    assert laws.at_base("ludwik_plasticity", values) == []


def test_tests_without_unloading_are_refused(metal):
    loading = {name: [test.at(slice(0, 10)) for test in tests] for name, tests in check(metal, "lab").items()}
    with pytest.raises(InputError, match="no test is unloaded, so that the laws of the family metal"):
        check_distinguishable(metal, loading)
    with pytest.raises(InputError, match="no test is unloaded or held"):
        check_distinguishable(replace(metal, family="gel"), loading)


@pytest.mark.slow
def test_the_law_that_made_the_recordings_is_chosen(metal):
    """Although the base law takes creep for hardening: its hardening is ten times the true one."""
    found = choose(metal, lambda line: None)
    assert found["law"] == CREEPS and found["probability"] > 0.9
    best, *others = found["candidates"]
    assert best["held_out_nm"] < 2.0 * best["residual_nm"] + 3.0
    assert len(others) == len(FAMILIES["metal"].laws) - 1
    assert sum(each["probability"] for each in found["candidates"]) == pytest.approx(1.0)
    modulus = best["parameters"]["youngs_modulus"]
    assert modulus["lower"] < TRUTH["youngs_modulus"] < modulus["upper"]
    assert checked_levels(CREEPS, metal.fixed, found["levels"], "sobol")
