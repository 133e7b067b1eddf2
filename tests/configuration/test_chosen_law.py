"""A study that leaves its law to the recordings: what it may say, and how it is read once they have chosen."""

import json
from pathlib import Path

import pytest
from study_file import STUDY, load

from palpate.configuration.study_file import study_from
from palpate.diagnosis.candidates import candidates
from palpate.errors import InputError

OPEN = {key: value for key, value in STUDY.items() if key != "parameters"} | {
    "material": {"model": "auto", "family": "polymer", "poisson_ratio": 0.34},
    "recordings": {"lab": "recordings"},
}
LEVELS = {"youngs_modulus": [2.0, 4.0], "yield_stress": [0.02, 0.1], "hardening": [0.0, 0.3]}


def chosen(law, levels, family="polymer"):
    file = Path("results/s/law.json")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"family": family, "law": law, "levels": levels}))
    return study_from(OPEN, "study.yaml")


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_a_law_is_open_until_it_is_chosen():
    study = study_from(OPEN, "study.yaml")
    assert study.law_is_open and (study.model, study.fixed) == ("elastic", {"poisson_ratio": 0.34})
    study = chosen("bilinear_plasticity", LEVELS)
    assert not study.law_is_open and study.model == "bilinear_plasticity"
    assert study.levels == {name: tuple(row) for name, row in LEVELS.items()} and len(study.cells) == 128


def test_a_choice_of_another_family_does_not_count():
    assert chosen("bilinear_plasticity", LEVELS, "metal").law_is_open


def test_what_the_chosen_law_contains_is_not_offered_again():
    creep = {"spectrum_coefficient": [0.0, 0.1], "spectrum_exponent": [0.0, 0.2]}
    yields = candidates(chosen("bilinear_plasticity+retardation_spectrum", LEVELS | creep))
    only_creeps = candidates(chosen("retardation_spectrum", {"youngs_modulus": [2.0, 4.0]} | creep))
    assert "plastic_yield" in only_creeps and "plastic_yield" not in yields
    assert "second_voigt" not in yields and "frame_compliance" in yields


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"material": {"model": "auto", "poisson_ratio": 0.3}}, "material"),
        ({"material": {"model": "auto", "family": "wood", "poisson_ratio": 0.3}}, "material.family"),
        ({"material": {"model": "elastic", "family": "metal", "poisson_ratio": 0.3}}, "material.family"),
        ({"material": {"model": "auto", "family": "metal", "yield_stress": 0.3}}, "material.yield_stress"),
        ({"material": {"model": "elastic", "poisson_ratio": 0.3}}, "top level"),
        ({"parameters": {"youngs_modulus": [1.0, 2.0]}}, "parameters"),
        ({"recordings": {}}, "material"),
        ({"laboratory": {"lab": {"parameters": {"youngs_modulus": 3.0}}}}, "material"),
    ],
)
def test_what_does_not_go_with_an_open_law_is_refused(change, place):
    with pytest.raises(InputError) as refused:
        study_from(OPEN | change, "study.yaml")
    assert refused.value.place == place


def test_levels_are_read_as_before_beside_a_stated_law(tmp_path):
    assert not load(tmp_path).family and load(tmp_path).choice == {}
