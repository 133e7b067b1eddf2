"""Imprints: profiles that are read or refused, what the finite elements leave, and where results show it."""

from dataclasses import replace

import numpy as np
import pytest
import results_of
import yaml
from study_file import STUDY

from indentation_files.imprint_profile import ImprintProfile, read_imprint
from palpate.cli.main import main
from palpate.configuration.study_file import load_study
from palpate.inference.imprint_prediction import imprint_predictions
from palpate.models.imprints import Imprint, imprints, residual_profile
from palpate.output.figures.catalogue import FIGURES
from palpate.output.results.answer import Answer
from palpate.output.results.calibration import Calibration
from palpate.solver.simulation import simulate, specification_from
from palpate.workflow_support.run_records import calibration_metrics

RADIUS = np.linspace(0.0, 6000.0, 61)
HEIGHT = -400.0 + 450.0 * np.minimum(RADIUS / 1800.0, 1.0) - 50.0 * np.clip((RADIUS - 1800.0) / 3000.0, 0.0, 1.0)
ALUMINIUM = {"model": "bilinear_plasticity", "youngs_modulus": 70.0, "poisson_ratio": 0.345}
ALUMINIUM |= {"yield_stress": 0.1, "hardening": 0.5}


def specification(load, **material):
    protocol = {"max_load": load, "loading_time": 15, "unloading_time": 15, "points": 30}
    tip = {"shape": "cone", "half_angle": 70.3}
    return specification_from({"material": ALUMINIUM | material, "indenter": tip, "protocol": protocol})


@pytest.fixture(scope="module")
def soft():
    return residual_profile(specification(4.9))


def test_profiles_of_two_loads_are_similar(soft):
    """A sharp tip has no length: radii and heights grow with the root of the load."""
    radius, height = residual_profile(specification(4.0 * 4.9))
    np.testing.assert_allclose(0.5 * np.interp(2.0 * soft[0], radius, height), soft[1], atol=2e-3 * -soft[1].min())


def test_the_middle_is_as_deep_as_the_test_ends_and_the_surface_far_away_rests(soft):
    radius, height = soft
    assert -height[0] == pytest.approx(simulate(specification(4.9)).depth[-1], rel=0.01)
    assert np.abs(height[radius > 20.0 * radius[np.argmax(height)]]).max() < 1e-3 * -height.min()


def test_hardening_less_piles_up_more(soft):
    """K. L. Johnson, Contact Mechanics, section 6.4: what hardens sinks in, what does not piles up."""
    _, ideal = residual_profile(specification(4.9, hardening=0.0))
    assert ideal.max() / -ideal.min() > 1.05 * soft[1].max() / -soft[1].min() > 0.05


def written(folder, radius=RADIUS, height=HEIGHT, header="radius_nm,height_nm"):
    rows = [f"{r:.9g},{h:.9g}" for r, h in zip(radius, height, strict=True)]
    (folder / "afm.csv").write_text("\n".join([header, *rows]) + "\n")
    return folder / "afm.csv"


def study(folder, **entry):
    given = {"kind": "imprint", "of": "P1_T30", "file": str(folder / "afm.csv"), "role": "validate"} | entry
    changes = {"indenter": {"shape": "berkovich"}} if entry.pop("pyramid", None) else {}
    given.pop("pyramid", None)
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY | {"evidence": [given]} | changes, sort_keys=False))
    return folder / "study.yaml"


def test_a_profile_is_read_as_it_is(tmp_path, capsys):
    found = read_imprint(written(tmp_path))
    np.testing.assert_allclose([found.radius, found.height], [RADIUS, HEIGHT])
    assert main(["check", str(study(tmp_path))]) == 0
    line = "evidence afm: imprint of P1_T30, 61 points to 6000 nm, 400 nm deep; it judges the calibrated law"
    assert line in capsys.readouterr().out


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"of": "none"}, "evidence[0].of: an imprint without the test that made it says nothing; name its condition"),
        ({"of": "P1_T3"}, "evidence[0].of: 'P1_T3' is no condition of the study (did you mean 'P1_T30'?); use one of"),
        ({"role": "calibrate"}, "evidence[0].role: an imprint judges the law, it cannot calibrate it yet"),
        ({"control": "stress"}, "evidence[0].control: nothing is prescribed of an imprint"),
        ({"pyramid": True}, "the imprint afm is compared by its radius, but the tip is a pyramid"),
    ],
)
def test_entries_that_mean_nothing_are_refused(tmp_path, refused, entry, words):
    written(tmp_path)
    assert words in refused("check", study(tmp_path, **entry))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"height": 1e-3 * HEIGHT}, "height_nm: the deepest point lies at -0.4 nm: no imprint, or heights in um"),
        ({"height": np.abs(HEIGHT)}, "height_nm: the deepest point lies at"),
        ({"radius": RADIUS - 3000.0}, "radius_nm: the radius does not increase from zero or above"),
        ({"header": "radius_um,height_nm"}, "header is 'radius_um,height_nm', expected 'radius_nm,height_nm'"),
    ],
)
def test_files_that_are_no_imprint_are_refused(tmp_path, refused, change, words):
    file = written(tmp_path, **change)
    line = refused("check", study(tmp_path))
    assert str(file) in line and words in line


def test_results_show_the_error_wherever_they_show_the_depth(tmp_path, soft):
    """Against a profile that is off by 10 nm everywhere."""
    (tmp_path / "saved").mkdir()
    saved = results_of.saved(tmp_path / "saved")
    condition = saved.study.conditions[0]
    height = np.interp(RADIUS, *soft) + 10.0
    imprint = Imprint(ImprintProfile(RADIUS, height, "afm"), condition)

    class Known:
        z = None
        problem = type("Problem", (), {"imprints": (imprint,)})
        model = type("Model", (), {"specification": staticmethod(lambda z, condition: specification(4.9))})

    found = imprint_predictions(Known, print)
    assert found["afm"]["rmse_nm"] == pytest.approx(10.0, rel=1e-3)
    assert found["afm"]["pile_up_nm"] == pytest.approx(found["afm"]["predicted_pile_up_nm"] + 10.0, rel=1e-6)
    saved = replace(saved, calibrations={"all": results_of.calibration() | {"imprint": found}})
    assert dict(Answer(saved).facts())["Imprints"].startswith("afm: 10 nm, 1.")
    assert "Imprint afm of A, predicted: root mean square error of the profile 10 nm" in Calibration(saved).summary()
    assert calibration_metrics(saved.calibrations["all"])["imprint.afm.rmse_nm"] == pytest.approx(10.0, rel=1e-3)
    assert "curve" not in Answer(saved).to_mapping()["imprint"]["afm"]
    numbers = FIGURES["imprint"].table(saved)
    assert len(numbers) == len(RADIUS) and FIGURES["imprint"].seen(numbers).startswith("afm: highest")


def test_a_study_reads_its_imprints(tmp_path):
    written(tmp_path)
    (entry,) = load_study(study(tmp_path)).evidence
    assert (entry.kind, entry.of, entry.role) == ("imprint", "P1_T30", "validate")


def test_an_imprint_is_that_of_the_whole_test_though_its_end_is_held_out(tmp_path):
    written(tmp_path)
    file = study(tmp_path)
    held_out = {**STUDY["conditions"][0], "held_out": [[45.0, 60.0]]}
    file.write_text(yaml.safe_dump(yaml.safe_load(file.read_text()) | {"conditions": [held_out]}))
    (found,) = imprints(load_study(file))
    assert found.condition.protocol.sample_time[-1] == pytest.approx(60.0)
