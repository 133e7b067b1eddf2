"""Contract of every mechanism found: neutral means nothing, an amplitude is seen, pairs run, bad values fail."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from closed_forms import TRUTH, cone
from diagnosis_problem import problem, recordings, search_of
from documents import HOOKS

from palpate.diagnosis.diagnose import diagnose
from palpate.errors import InputError
from palpate.mechanisms import MECHANISMS, Scale
from palpate.solver import simulation
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.simulation import simulate, simulate_batch, specification_from
from palpate.solver.variation import added_by_instrument, applied_to_body
from studies.verification.reference_materials import BURGERS as EPOXY

BASE = {
    "material": {"model": "nonlinear_burgers", **EPOXY},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "protocol": {"max_load": 1.0, "loading_time": 30, "hold_time": 10, "unloading_time": 30, "points": 28},
    "kinematics": "small",
}
SCALE = Scale(**HOOKS.TYPICAL)
RECORDED = [key for key, mechanism in MECHANISMS.items() if not mechanism.acts_on_body]
VISIBLE = {key: dict(mechanism.example) for key, mechanism in MECHANISMS.items()}


PAIRS = list(itertools.combinations(VISIBLE, 2))


def depth(mechanisms=None):
    simulation = simulate(specification_from(BASE | {"mechanisms": mechanisms or {}}))
    assert simulation.status == "ok", simulation.reason
    return simulation.depth


@pytest.fixture(scope="module")
def curves():
    """Return the simulations of every mechanism, neutral and visible, and of all pairs, which run in lanes together."""
    wanted = {("neutral", key): {key: dict(mechanism.neutral)} for key, mechanism in MECHANISMS.items()}
    wanted |= {keys: {key: VISIBLE[key] for key in keys} for keys in [*((key,) for key in VISIBLE), *PAIRS]}
    found = simulate_batch([specification_from(BASE | {"mechanisms": each}) for each in wanted.values()])
    return dict(zip(wanted, found, strict=True))


@pytest.fixture(scope="module")
def plain():
    return depth()


@pytest.mark.parametrize("key", MECHANISMS)
def test_neutral_amplitude_is_the_identity(key, curves, plain):
    assert curves["neutral", key].depth == pytest.approx(plain, rel=2e-3)


@pytest.mark.parametrize("key", MECHANISMS)
def test_effect_is_visible(key, curves, plain):
    assert np.abs(curves[key,].depth - plain).max() > 1.0


@pytest.mark.parametrize("key", RECORDED)
def test_what_only_adds_to_the_depth_is_linear_in_the_amplitudes(key):
    """And the same at every depth, unless it follows the depth; its parameters are what is searched."""
    mechanism, time = MECHANISMS[key], np.linspace(1.0, 70.0, 28)
    load, twice = np.sin(time), {name: 2.0 * VISIBLE[key][name] for name in mechanism.amplitudes}
    deep = np.sqrt(time)
    other = deep if mechanism.follows_depth else 0.0 * deep
    once, double = (
        mechanism.record(time, load, depth, values) - depth
        for depth, values in ((deep, VISIBLE[key]), (other, {**VISIBLE[key], **twice}))
    )
    assert np.abs(once).max() > 0.0
    assert double == pytest.approx(2.0 * once)
    assert set(mechanism.plausible(SCALE)) == {parameter.name for parameter in mechanism.parameters}


@pytest.mark.parametrize(
    ("key", "included"), [(key, inner) for key, mechanism in MECHANISMS.items() for inner in mechanism.includes]
)
def test_a_mechanism_equals_what_it_includes_where_all_else_does_nothing(key, included, plain):
    example = VISIBLE[included]
    assert depth({key: dict(MECHANISMS[key].neutral) | example}) - plain == pytest.approx(
        depth({included: example}) - plain, abs=1e-9
    )


@pytest.mark.parametrize("key", RECORDED)
def test_what_is_planted_is_diagnosed_as_itself(key):
    """On a closed form, with values that differ by a fifth between recordings where they are each one's own."""
    mechanism, rng = MECHANISMS[key], np.random.default_rng(4)

    def planted(condition, _):
        sizes = {name: 3.0 * (1.0 + 0.2 * mechanism.varies * rng.standard_normal()) for name in mechanism.amplitudes}
        values = {name: value * sizes.get(name, 1.0) for name, value in VISIBLE[key].items()}
        return added_by_instrument(
            {key: values}, condition.protocol, cone(condition.protocol, **TRUTH), condition.order
        )

    found = diagnose(search_of(problem(recordings(np.random.default_rng(5), planted)), RECORDED), lambda said: None)
    assert (found.verdict, [each.fit.explanation for each in found.accepted]) == ("identified", [(key,)])


@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_pairs_run(pair, curves):
    assert curves[pair].status == "ok", curves[pair].reason


@pytest.mark.parametrize("kinematics", ["small", "large"])
@pytest.mark.slow
def test_a_pyramid_knows_every_mechanism(monkeypatch, kinematics):
    """Each does about what it does under the equivalent cone, those that only add to the depth at once; so do all."""
    monkeypatch.setitem(simulation.RESOLUTIONS_3D, "standard", Resolution(growth=1.15, sectors=6))
    spec = BASE | {"kinematics": kinematics, "protocol": BASE["protocol"] | {"points": 7}}
    pyramid = spec | {"indenter": {"shape": "berkovich"}}

    def depths(values, mechanisms):
        simulation = simulate(specification_from(values | {"mechanisms": mechanisms}))
        assert simulation.status == "ok", (mechanisms, simulation.reason)
        return simulation.depth

    cone, sharp = (depths(values, {}) for values in (spec, pyramid))
    recorded = {key: VISIBLE[key] for key in RECORDED}
    for mechanisms in (recorded, *({key: values} for key, values in VISIBLE.items() if key not in recorded)):
        effect, expected = (depths(tip, mechanisms) - alone for tip, alone in ((pyramid, sharp), (spec, cone)))
        assert effect @ expected > 0.5 * expected @ expected, mechanisms
        assert effect @ expected < 1.6 * expected @ expected, mechanisms
    assert np.abs(depths(pyramid, VISIBLE) - sharp).max() > 1.0


@pytest.mark.parametrize(
    ("key", "length"),
    [("film_on_substrate", "thickness"), ("size_effect", "length"), ("tip_rounding", "radius"), ("skin", "depth")],
)
def test_a_length_scales_with_the_depth(key, length):
    """With every length of the problem doubled and the load fourfold, depths double: the exact law of a length."""
    values = VISIBLE[key]
    doubled = values | {length: 2 * values[length]}
    high = BASE | {"protocol": BASE["protocol"] | {"max_load": 4.0}, "mechanisms": {key: doubled}}
    assert simulate(specification_from(high)).depth == pytest.approx(2 * depth({key: values}), rel=1e-5)


def test_a_film_of_the_substrates_own_modulus_is_a_half_space():
    elastic = BASE | {"material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}}
    film = elastic | {"mechanisms": {"film_on_substrate": {"thickness": 800.0, "substrate_modulus": 3.0}}}
    half_space, layered = (simulate(specification_from(values)).depth for values in (elastic, film))
    assert layered == pytest.approx(half_space, rel=1e-9)


def test_a_thick_elastic_film_deepens_by_the_first_order_theory():
    """Far below the contact the load acts as a point force, whose stress falls like 1/z^2 (Boussinesq).

    To first order in its compliance, a substrate adds the strain energy that it holds: the integral of z^-4 over the
    half-space below the film, which falls like 1/thickness.
    """
    elastic = BASE | {"material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}}

    def gain(thickness):
        film = {"film_on_substrate": {"thickness": thickness, "substrate_modulus": 2.7}}
        return simulate(specification_from(elastic | {"mechanisms": film})).depth[11] - half_space

    half_space = simulate(specification_from(elastic)).depth[11]
    assert gain(10e3) / gain(20e3) == pytest.approx(2.0, rel=0.05)


def test_signs_and_sizes(plain):
    time = np.linspace(2.5, 70, 28)
    load = specification_from(BASE).protocol.sample_load
    assert depth({"thermal_drift": {"rate": 0.1}}) - plain == pytest.approx(0.1 * time, abs=1e-9)
    assert depth({"frame_compliance": {"compliance": 5.0}}) - plain == pytest.approx(5 * load, abs=1e-9)
    peak = np.argmax(load)
    assert depth({"tip_rounding": {"radius": 200.0}})[peak] < plain[peak]
    assert depth({"tip_angle": {"half_angle": 71.0}})[peak] < plain[peak]
    assert depth({"second_voigt": VISIBLE["second_voigt"]})[peak] > plain[peak]
    assert depth({"controller_lag": {"lag": 1.0}})[5] < plain[5]


@pytest.mark.parametrize(
    ("mechanisms", "place"),
    [
        ({"thermal_drft": {"rate": 1}}, "mechanisms"),
        ({"thermal_drift": {"rat": 1}}, "mechanisms.thermal_drift.rat"),
        ({"thermal_drift": {}}, "mechanisms.thermal_drift.rate"),
        ({"tip_rounding": {"radius": -1}}, "mechanisms.tip_rounding.radius"),
        ({"controller_lag": {"lag": -1.0}}, "mechanisms.controller_lag.lag"),
        (
            {"film_on_substrate": {"thickness": 100, "substrate_modulus": -1}},
            "mechanisms.film_on_substrate.substrate_modulus",
        ),
    ],
)
def test_bad_values_are_refused_by_name(mechanisms, place):
    with pytest.raises(InputError) as caught:
        specification_from(BASE | {"mechanisms": mechanisms})
    assert caught.value.place == place


def test_a_mechanism_that_cannot_act_says_so():
    elastic = {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}
    spec = BASE | {"material": elastic, "mechanisms": {"second_voigt": VISIBLE["second_voigt"]}}
    with pytest.raises(InputError, match="no Voigt element"):
        simulate(specification_from(spec))
    late = BASE | {"mechanisms": {"controller_lag": {"lag": 500.0}}}
    with pytest.raises(InputError, match="lag = 500 s is not shorter than the test"):
        simulate(specification_from(late))


def test_a_lag_too_short_to_be_resolved_is_none_and_a_corner_that_it_moves_to_the_end_is_the_end():
    base = specification_from(BASE)
    unloading = BASE["protocol"]["unloading_time"]
    none, late = (
        applied_to_body(replace(base, mechanisms={"controller_lag": {"lag": lag}})).protocol
        for lag in (1e-9, unloading * (1.0 - 1e-9))
    )
    assert none is base.protocol
    assert late.knot_drive == pytest.approx([0.0, 0.0, 1.0, 1.0])


def test_a_size_effect_beside_a_low_yield_stress_begins_under_the_first_node():
    """The first step begins at no depth, where the resistance has no bounds; stresses it left are too much later."""
    burgers = EPOXY | {"youngs_modulus": 3.04, "steady_coefficient": 0.0888, "steady_exponent": 0.239}
    burgers |= {"transient_coefficient": 0.302, "transient_exponent": 0.3, "retardation_time": 0.25}
    mechanisms = {"plastic_yield": {"yield_stress": 0.184, "hardening": 0.0743}, "size_effect": {"length": 69.5}}
    protocol = {"max_load": 10.0, "loading_time": 10, "hold_time": 60, "unloading_time": 10, "points": 100}
    material = {"model": "nonlinear_burgers", **burgers}
    spec = BASE | {"material": material, "mechanisms": mechanisms, "protocol": protocol}
    found = [simulate(specification_from(spec | {"accuracy": name})) for name in ("standard", "medium")]
    assert [outcome.status for outcome in found] == ["ok", "ok"]
    assert found[0].depth == pytest.approx(found[1].depth, rel=0.005)


@pytest.mark.parametrize(
    ("mechanism", "place"),
    [
        ({"film_on_substrate": {"thickness": 20.0, "substrate_modulus": 70.0}}, "film_on_substrate.thickness"),
        ({"tip_rounding": {"radius": 1e8}}, "radius"),
    ],
)
def test_what_the_mesh_cannot_hold_is_refused_with_the_range(mechanism, place):
    with pytest.raises(InputError, match="give at") as caught:
        simulate(specification_from(BASE | {"mechanisms": mechanism}))
    assert caught.value.place.endswith(place)


def test_a_sample_right_behind_a_lag_is_resolved():
    """Sneddon's depth goes with the root of the load, however small the load that acts on a sample is."""
    elastic = {"material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}}
    base = specification_from(BASE | elastic)
    first = float(base.protocol.sample_time[0])
    for behind in (0.3, 0.007):
        found = simulate(replace(base, mechanisms={"controller_lag": {"lag": first - behind}}))
        load = base.protocol.load_at(np.maximum(found.time[:6] - first + behind, 0.0))
        ratio = found.depth[:6] / np.sqrt(load)
        assert ratio == pytest.approx(np.full(6, ratio[-1]), rel=5e-3)


@pytest.mark.parametrize("key", [key for key, each in MECHANISMS.items() if each.assumed])
def test_what_the_tip_has_without_a_mechanism_changes_nothing(key):
    plain = specification_from(BASE)
    specification = replace(plain, indenter=replace(plain.indenter, half_angle=65.0, friction=0.25))
    assumed = MECHANISMS[key].assumed(specification)
    assert MECHANISMS[key].simulate(specification, assumed).indenter == specification.indenter
    assert MECHANISMS[key].simulate(specification, MECHANISMS[key].neutral).indenter != specification.indenter
