"""Several tips in one study: which tip presses where, what of a description is refused, and whose each effect is."""

from dataclasses import replace

import pytest
from study_file import TRUTH, load

from palpate.cli.main import main
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS
from palpate.solver.store import address, conditions_by_shape
from palpate.solver.study_scale import scale_of
from palpate.solver.variation import applied_to_body
from palpate.study.indenter import Indenter

TIMES = {"loading_time": 30, "unloading_time": 30}
SPHERE = {"name": "ball", "shape": "sphere", "radius": 10_000.0}
CORNER = {"name": "corner", "shape": "cone", "half_angle": 42.3}


def conditions(**tips):
    """Return conditions of 1 mN by their names, each with the tip that is given, if any."""
    return [{"name": name, "max_load": 1.0, **TIMES} | ({"indenter": tip} if tip else {}) for name, tip in tips.items()]


def test_a_tip_is_described_once_and_named_elsewhere(tmp_path):
    study = load(tmp_path, conditions=conditions(a=None, b=SPHERE, c="ball"))
    tips = [study.specification(study.cells[0], condition).indenter for condition in study.conditions]
    assert tips == [Indenter("cone", 70.3), *[Indenter("sphere", radius=10_000.0)] * 2]
    assert {name: len(tests) for name, tests in study.by_tip(study.conditions).items()} == {"": 1, "ball": 2}


def test_parts_that_are_held_out_are_pressed_by_the_tip_of_their_test(tmp_path):
    held_out = conditions(b=SPHERE)[0] | {"held_out": [[40, 50]]}
    study = load(tmp_path, conditions=[*conditions(a=None), held_out])
    assert study.condition("b.held_out").tip == "ball"


@pytest.mark.parametrize(
    ("changes", "place", "problem"),
    [
        ({"conditions": conditions(a=None, b="ball")}, "conditions[1] (b).indenter", "'ball' is described nowhere"),
        ({"conditions": conditions(a=None, b=SPHERE, c="bal")}, "conditions[2] (c)", "did you mean 'ball'?"),
        ({"conditions": conditions(b=SPHERE)}, "indenter", "no condition is tested with this tip"),
        (
            {"conditions": conditions(a=None, b=SPHERE, c=SPHERE | {"radius": 500.0})},
            "conditions[2] (c).indenter.name", "another tip is called 'ball', too",
        ),
        ({"conditions": conditions(a=None, b={"shape": "sphere"})}, "conditions[1].indenter", "give {name: NAME"),
        ({"conditions": conditions(a=None, b=SPHERE | {"name": "a.b"})}, "conditions[1].indenter", "letters, digits"),
        (
            {"conditions": conditions(a=None, b={"name": "ball", "shape": "sphere"})},
            "conditions[1] (b).indenter.radius", "no value",
        ),
        (
            {"conditions": conditions(a=None, b=SPHERE | {"poisson_ratio": 0.2})},
            "conditions[1] (b).indenter.poisson_ratio", "rigid",
        ),
        (
            {"conditions": conditions(a=None, b=CORNER), "diagnosis": {"mechanisms": ["tip_angle[korner]"]}},
            "diagnosis.mechanisms", "did you mean 'corner'?",
        ),
        (
            {"conditions": conditions(a=None, b=CORNER), "diagnosis": {"ranges": {"tip_angle[b]": {"x": [1, 2]}}}},
            "diagnosis.ranges", "no condition has a tip of this name",
        ),
        ({"diagnosis": {"mechanisms": ["tip_angle[corner]"]}}, "diagnosis.mechanisms", "the study has one tip"),
        (
            {"conditions": conditions(a=None, b=CORNER), "diagnosis": {"mechanisms": ["thermal_drift[corner]"]}},
            "diagnosis.mechanisms", "is not known",
        ),
        (
            {
                "recordings": {"lab": "results/s/recordings/lab"},
                "laboratory": {"lab": {"parameters": TRUTH, "mechanisms": {"tip_rounding[b]": {"radius": 9.0}}}},
            },
            "laboratory.lab.mechanisms", "the study has one tip",
        ),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused_with_its_place(tmp_path, changes, place, problem):
    with pytest.raises(InputError) as caught:
        load(tmp_path, **changes)
    assert place in str(caught.value) and problem in str(caught.value)


def test_a_single_test_has_no_named_tip(tmp_path, refused):
    file = tmp_path / "spec.yaml"
    file.write_text(
        "material: {model: elastic, youngs_modulus: 3, poisson_ratio: 0.3}\n"
        "indenter: {shape: cone, half_angle: 70.3}\nprotocol: {max_load: 1, loading_time: 9, unloading_time: 9}\n"
        "mechanisms: {'tip_rounding[b]': {radius: 100}}\n"
    )
    line = refused("simulate", str(file), "-o", str(tmp_path / "curve.csv"))
    assert "mechanisms.tip_rounding[b]" in line and "one tip; leave the brackets out" in line


def test_an_effect_of_a_tip_acts_under_that_tip_alone(tmp_path):
    study = load(tmp_path, conditions=conditions(a=None, b=CORNER, c=SPHERE))
    effects = {"tip_rounding": {"radius": 50.0}, "tip_rounding[corner]": {"radius": 200.0}}
    bodies = [
        applied_to_body(replace(study.specification(study.cells[0], condition), mechanisms=effects))
        for condition in study.conditions
    ]
    assert [body.indenter.radius for body in bodies] == [50.0, 200.0, 10_000.0]
    assert [body.indenter.half_angle for body in bodies] == [70.3, 42.3, 0.0]


def test_an_effect_of_a_tip_is_searched_about_its_nominal_shape(tmp_path):
    scale = scale_of(load(tmp_path, conditions=conditions(a=None, b=CORNER)))
    own, corner = (MECHANISMS[key].searched(scale)["half_angle"] for key in ("tip_angle", "tip_angle[corner]"))
    assert (own.lower + own.upper) / 2 == pytest.approx(70.3)
    assert (corner.lower + corner.upper) / 2 == pytest.approx(42.3)


def test_effects_of_tips_have_names_of_their_own():
    of_corner = MECHANISMS["tip_rounding[corner]"]
    assert (of_corner.key, of_corner.title) == ("tip_rounding[corner]", "tip rounding of corner")
    assert of_corner.family != MECHANISMS["tip_rounding"].family
    assert MECHANISMS["tip_rounding[corner]"] is of_corner
    assert "tip_rounding[corner]" not in list(MECHANISMS)
    assert "frame_compliance[corner]" not in MECHANISMS and "tip_rounding[a.b]" not in MECHANISMS


def test_a_curve_has_one_address_whatever_its_tip_is_called(tmp_path):
    study = load(tmp_path, conditions=conditions(a=None, b=CORNER, c=CORNER | {"name": "other"}))
    addresses = [address(study.specification(study.cells[0], condition)) for condition in study.conditions]
    assert addresses[1] == addresses[2] != addresses[0]
    assert [[c.name for c in alike] for alike in conditions_by_shape(study)] == [["a"], ["b", "c"]]


def test_the_check_says_which_tip_presses_where(tmp_path, capsys):
    load(tmp_path, conditions=conditions(a=None, b=SPHERE, c="ball"))
    assert main(["check", str(tmp_path / "study.yaml")]) == 0
    printed = capsys.readouterr().out
    assert "a: cone, half-angle 70.3°\n" in printed
    assert "b, c: ball, sphere, radius 10000 nm\n" in printed
