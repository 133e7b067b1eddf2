"""Another load than the recorded one: a gain is a modulus, and a spring beside an elastic cone has a closed form."""

from dataclasses import replace

import numpy as np
import pytest
from closed_forms import TRUTH, ClosedForms, cone
from diagnosis_problem import CONDITIONS, RECORD_ONLY, SCALE, recordings, search_of

from palpate.diagnosis.diagnose import diagnose
from palpate.errors import InputError
from palpate.inference.problem import Problem
from palpate.mechanisms import MECHANISMS
from palpate.models.coordinates import Coordinate, Coordinates
from palpate.solver.simulation import simulate, simulate_batch, specification_from
from palpate.study.protocol import DISPLACEMENT, trapezoid

KEY = "load_gain"
BASE = {
    "material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "protocol": {"max_load": 1.0, "loading_time": 30, "hold_time": 10, "unloading_time": 30, "points": 28},
    "kinematics": "small",
}


def specification(gain=1.0, spring=0.0, load=1.0, modulus=3.0):
    protocol, material = BASE["protocol"] | {"max_load": load}, BASE["material"] | {"youngs_modulus": modulus}
    mechanisms = {KEY: {"gain": gain, "spring": spring}}
    return specification_from(BASE | {"protocol": protocol, "material": material, "mechanisms": mechanisms})


def test_a_gain_is_a_modulus_and_a_recording_keeps_the_recorded_load():
    gained, softer = simulate_batch([specification(gain=1.25), specification(modulus=3.0 / 1.25)])
    assert gained.depth == pytest.approx(softer.depth, rel=1e-6, abs=1e-3)
    assert gained.load == pytest.approx(specification().protocol.sample_load)


@pytest.mark.parametrize("spring", [2e-4, -2e-4])
def test_a_spring_beside_an_elastic_cone(spring):
    """With P = k h^2 of the cone alone on this mesh, k h^2 - spring h is the recorded load."""
    plain, found = simulate(specification()), simulate(specification(spring=spring))
    assert found.status == "ok", found.reason
    load, depth = plain.load[:-1], plain.depth[:-1]
    stiffness = load / depth**2
    expected = (spring + np.sqrt(spring**2 + 4.0 * stiffness * load)) / (2.0 * stiffness)
    assert found.depth[:-1] == pytest.approx(expected, rel=1e-3)


def test_a_spring_is_a_length_ratio_of_its_own():
    """Twice as deep under four times the load where the spring is twice as stiff, and not where it is the same."""
    small, large, other = simulate_batch(
        [specification(spring=1e-4), specification(spring=2e-4, load=4.0), specification(spring=1e-4, load=4.0)]
    )
    assert large.depth == pytest.approx(2.0 * small.depth, rel=1e-9)
    assert np.abs(other.depth - large.depth).max() > 1.0


def test_what_it_cannot_act_on_is_refused():
    moved = replace(specification(gain=1.1), protocol=trapezoid(100.0, 10, 0, 10, points=20, control=DISPLACEMENT))
    pyramid = BASE | {"indenter": {"shape": "berkovich"}, "mechanisms": {KEY: {"gain": 1.0, "spring": 1e-4}}}
    for wrong, place in ((moved, "mechanisms.load_gain"), (specification_from(pyramid), "mechanisms.load_gain.spring")):
        with pytest.raises(InputError) as caught:
            simulate(wrong)
        assert caught.value.place == place


KNOWN = Coordinates([Coordinate(name, *(2 * (0.995 * v, 1.005 * v))) for name, v in TRUTH.items()], {})


class Loaded(ClosedForms):
    """The cone under another load than the recorded one, which a spring makes depend on the depth."""

    def _curve(self, u, condition):
        values = self.amplitudes(u).get(KEY, MECHANISMS[KEY].neutral)
        others = tuple(each for each in self.mechanisms if each.key != KEY)
        named, protocol = self.coordinates.named(u), condition.protocol
        depth = deep(protocol, values, **{name: named[name] for name in TRUTH})
        for each in others:
            depth = each.record(protocol.sample_time, protocol.sample_load, depth, self.amplitudes(u)[each.key])
        return depth[self.keep[condition.name]] if self.keep else depth


def deep(protocol, values, **material):
    depth = np.zeros_like(protocol.sample_time)
    for _ in range(12):
        load = np.maximum(values["gain"] * protocol.sample_load + values["spring"] * depth, 0.0)
        knots = {"knot_time": np.append(0.0, protocol.sample_time), "knot_drive": np.append(0.0, load)}
        depth = cone(replace(protocol, **knots), **material)
    return depth


@pytest.mark.parametrize("planted", [{"gain": 1.05, "spring": 0.0}, {"gain": 1.0, "spring": 3e-4}])
def test_it_is_named_where_the_material_is_known(planted):
    def acted_on(condition, _):
        return deep(condition.protocol, planted, **TRUTH) - cone(condition.protocol, **TRUTH)

    observed = recordings(np.random.default_rng(4), acted_on)
    task = Problem(CONDITIONS, observed, Loaded(CONDITIONS, KNOWN), SCALE)
    found = diagnose(search_of(task, [*RECORD_ONLY, KEY]), lambda said: None)
    assert (found.verdict, [each.fit.explanation for each in found.accepted]) == ("identified", [(KEY,)])
    fit = found.accepted[0].fit
    values = fit.model.amplitudes(fit.z)[KEY]
    assert values["gain"] == pytest.approx(planted["gain"], abs=0.02)
    assert values["spring"] == pytest.approx(planted["spring"], abs=1e-4)
