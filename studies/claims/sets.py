"""The sets of recordings: what is true in each, drawn and written to a file before any is diagnosed.

A fifth of the sets are of bodies that the study's law, tip and instrument describe; the others depart from these in a
law, a length, a clock or a reversal. How strong a departure is follows from a wanted misfit: the root mean square of
what a refit of the material leaves of it, to first order, as a share of the depth. Six in ten sets conceal no effect of
the library, a quarter one, and the others two.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from palpate.configuration.condition import Condition
from palpate.data.observation import Observation
from palpate.diagnosis.explanations import may_act_together
from palpate.mechanisms import MECHANISMS
from palpate.mechanisms.draws import log_uniform
from studies.claims.body import KEYS, recorded
from studies.claims.departures import DEPARTURES
from studies.coverage.creep import burgers, depth
from studies.coverage.sets import condition, drawn_noise, drawn_test, replicate
from studies.coverage.solid import MATERIAL, RANGES, BurgersSolid

KINDS = ("none", *DEPARTURES)
EFFECTS = (0, 1, 0, 2, 0, 1, 0, 0, 1, 0, 2, 0, 0, 0, 0, 1, 0, 2, 0, 1)  # of the library, in turn
MISFIT = (0.001, 0.02)  # of the depth
OWN = 0.2  # relative spread between recordings of what varies
TESTS, REPLICATES = (3, 4, 5, 6), (2, 3, 4)


@dataclass(frozen=True)
class Case:
    """One set of recordings.

    Parameters
    ----------
    name
        Neutral.
    kind, departure, misfit, strength
        Class of what no library holds, its name, the root mean square of what a refit leaves of it as a share of the
        depth, and the factor of its change; ``none``, empty and zero without.
    parameters
        Of the solid.
    mechanisms
        What acts, with amplitudes.
    tests
        Load [mN], loading time [s], hold and unloading [loading times] of each test.
    replicates
        Recordings of each test.
    noise
        `sigma` [nm] and `autocorrelation` of the points, `site` (scatter of the depth between sites).
    seed
        Of the noise.
    """

    name: str
    kind: str
    departure: str
    misfit: float
    strength: float
    parameters: Mapping[str, float]
    mechanisms: Mapping[str, Mapping[str, float]]
    tests: Sequence[Sequence[float]]
    replicates: int
    noise: Mapping[str, float]
    seed: int

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """The tests."""
        return tuple(condition(number, *test) for number, test in enumerate(self.tests))

    def departed(self) -> list[np.ndarray]:
        """Return the change (n,) of the depth under each condition by what no library holds [nm]."""
        return [
            self.strength * change for change in _changes(self.departure, self.conditions, self.parameters, self.seed)
        ]


def draw(numbers: Iterable[int], seed: int) -> list[Case]:
    """Draw the sets of these numbers, each from a stream of its own."""
    cases = []
    for number in numbers:
        rng = np.random.default_rng([seed, number])
        kind = KINDS[number % len(KINDS)]
        departure = str(rng.choice(list(DEPARTURES[kind]))) if kind in DEPARTURES else ""
        parameters = {name: log_uniform(rng, *ends) for name, ends in RANGES.items()}
        tests, noise = [drawn_test(rng) for _ in range(int(rng.choice(TESTS)))], drawn_noise(rng)
        own, misfit = int(rng.integers(2**31)), log_uniform(rng, *MISFIT) if departure else 0.0
        under = tuple(condition(k, *test) for k, test in enumerate(tests))
        left = left_by_refit(under, parameters, np.concatenate(_changes(departure, under, parameters, own)))
        mechanisms = _mechanisms(EFFECTS[number // len(KINDS) % len(EFFECTS)], rng)
        scale = misfit / left if left > 0.0 else 0.0
        drawn = (departure, misfit, scale, parameters, mechanisms, tests, int(rng.choice(REPLICATES)), noise, own)
        cases.append(Case(f"set_{number:04d}", kind, *drawn))
    return cases


def recordings(case: Case) -> dict[str, Observation]:
    """Return the recordings of a set."""
    rng, solid, found = np.random.default_rng(case.seed), burgers(**case.parameters), dict[str, Observation]()
    for test, change in zip(case.conditions, case.departed(), strict=True):
        rows = []
        for _ in range(case.replicates):
            factors = {key: 1.0 + OWN * rng.standard_normal() * MECHANISMS[key].varies for key in case.mechanisms}
            own = {key: _shared(key, values, factors[key]) for key, values in case.mechanisms.items()}
            rows.append(replicate(recorded(solid, test.protocol, own) + change, case.noise, rng))
        found[test.name] = Observation(test.protocol.sample_time, np.array(rows))
    return found


def _shared(key: str, values: Mapping[str, float], factor: float) -> dict[str, float]:
    """Return the amplitudes of one recording: those with a sign vary, times do not."""
    signed = {each.name for each in MECHANISMS[key].parameters if each.lower < 0.0}
    return {name: factor * value if name in signed else value for name, value in values.items()}


def _mechanisms(count: int, rng: np.random.Generator) -> dict[str, dict[str, float]]:
    """Draw mechanisms that may act together, with amplitudes."""
    while True:
        keys = sorted(str(key) for key in rng.choice(KEYS, count, replace=False))
        if may_act_together(keys):
            return {key: {k: float(v) for k, v in MECHANISMS[key].concealed(rng).items()} for key in keys}


def _changes(
    departure: str, conditions: Sequence[Condition], parameters: Mapping[str, float], seed: int
) -> list[np.ndarray]:
    """Return the changes (n,) by a departure of strength one."""
    rng, solid, found = np.random.default_rng([seed, 1]), burgers(**parameters), list[np.ndarray]()
    changes = {name: change for kind in DEPARTURES.values() for name, change in kind.items()}
    for each in conditions:
        curve = depth(solid, each.protocol)
        change = changes[departure](each.protocol, curve, solid, rng) if departure else np.zeros(len(curve))
        found.append(change)
    return found


def left_by_refit(conditions: tuple[Condition, ...], parameters: Mapping[str, float], change: np.ndarray) -> float:
    """Return the root mean square of what a refit of the material leaves of a change, as a share of the depth.

    To first order. The change (n_all,) of the depths [nm] is that of all conditions, one after the other.
    """
    model = BurgersSolid(conditions)
    (found,) = model.tangents([MATERIAL.scaled(parameters)])
    assert not isinstance(found, str)
    curves, slopes = found
    largest = np.concatenate([np.maximum.accumulate(curves[each.name]) for each in conditions])
    tangent, share = np.concatenate([slopes[each.name] for each in conditions]) / largest[:, None], change / largest
    rest = share - tangent @ np.linalg.lstsq(tangent, share, rcond=None)[0]
    return float(np.sqrt(np.mean(rest**2)))
