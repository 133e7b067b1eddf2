"""Contract of every observable found: what is simulated, recorded and compared is one quantity, in one unit."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.observables import OBSERVABLES, UNITS, Quantity, response_to
from palpate.solver.simulation import simulate_batch, specification_from
from palpate.study.protocol import DISPLACEMENT, LOAD, trapezoid

PROTOCOLS = {LOAD: trapezoid(1.0, 5, 5, 5, 24), DISPLACEMENT: trapezoid(400.0, 5, 5, 5, 24, DISPLACEMENT, 100.0)}
SOFTER = 0.99
STATED = {"material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3}, "kinematics": "small"}


@pytest.fixture(scope="module")
def simulated():
    """Return, by name, the curves of an elastic cone, of a softer one, and of one that is recorded with an offset."""
    found = {}
    for name, observable in OBSERVABLES.items():
        tip = {"shape": "cone", "half_angle": 70.3}
        plain = specification_from({**STATED, "indenter": tip, "protocol": PROTOCOLS[observable.control]})
        softer = replace(plain, parameters={**plain.parameters, "youngs_modulus": SOFTER * 3.0})
        offset = replace(plain, mechanisms={"zero_offset": {"offset": 5.0}})
        found[name] = plain, simulate_batch([plain, softer, offset])
    return found


@pytest.mark.parametrize("name", OBSERVABLES)
def test_it_is_known_by_its_name_and_unit(name):
    observable = OBSERVABLES[name]
    assert observable.name == name
    assert observable.unit in UNITS
    assert observable.column("recorded") == f"recorded_{observable.unit}"
    assert response_to(PROTOCOLS[observable.control]) is observable, "one answers each drive"


@pytest.mark.parametrize("name", OBSERVABLES)
def test_a_recording_gives_what_the_simulation_gave(name, simulated):
    """Written as an instrument writes it, and read at the sample times; a larger one is read as larger."""
    observable, (specification, (curve, *_)) = OBSERVABLES[name], simulated[name]
    response, protocol = observable.of_simulation(curve), specification.protocol
    assert response == pytest.approx(curve.response)
    assert response.shape == protocol.sample_time.shape
    for larger in (response, 1.02 * response):
        load, depth = observable.recorded(protocol, curve, larger)
        time, load, depth = (np.append(0.0, values) for values in (curve.time, load, depth))
        assert protocol.drive_of(load[1:], depth[1:]) == pytest.approx(protocol.sample_drive, rel=1e-6, abs=1e-6)
        read = observable.of_recording(protocol, time, load, depth)
        assert read == pytest.approx(larger, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", OBSERVABLES)
def test_its_scale_is_the_change_of_depth_under_the_same_load(name, simulated):
    """A body with a modulus that is smaller by e is deeper by e / 2 (Sneddon)."""
    observable, (specification, (usual, softer, _)) = OBSERVABLES[name], simulated[name]
    quantity = Quantity.of(observable, specification.protocol, specification.indenter, usual.response)
    peak, deeper = int(np.argmax(usual.response)), SOFTER**-0.5 - 1.0
    change = softer.response[peak] - usual.response[peak]
    assert change / usual.response[peak] == pytest.approx(deeper * quantity.share, rel=0.02)
    assert abs(quantity.nm * change) == pytest.approx(deeper * usual.depth[peak], rel=0.02)


@pytest.mark.parametrize("name", OBSERVABLES)
def test_its_noise_is_a_covariance(name):
    time = np.linspace(1.0, 60.0, 12)
    parts = OBSERVABLES[name].noise(time, np.sqrt(time))
    assert "site" in parts, "a factor of each recording"
    for matrix in parts.values():
        assert matrix.shape == (12, 12)
        assert matrix == pytest.approx(matrix.T)
        assert np.linalg.eigvalsh(matrix).min() > -1e-9 * np.linalg.norm(matrix)


@pytest.mark.parametrize("name", OBSERVABLES)
def test_what_an_instrument_adds_is_in_it_or_in_the_simulation(name, simulated):
    plain, _, offset = simulated[name][1]
    added = offset.response - plain.response
    assert np.allclose(added, 5.0, atol=1e-9) == OBSERVABLES[name].adds_instrument
    assert np.abs(added).max() > 0.0
