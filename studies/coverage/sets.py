"""The sets of recordings: what is true in each, drawn and written to a file before any is fitted, and the recordings.

Half of the reported sets, or so, are of materials that the base model describes; the creep of the others has a spectrum
of retardation times in place of one. How strong that creep is follows from a wanted misfit: the root mean square of
what the best Burgers solid leaves, as a share of the depth.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from palpate.classical.viscoelastic_depth import Compliance
from palpate.configuration.condition import Condition
from palpate.data.observation import Observation
from palpate.mechanisms.draws import log_uniform
from palpate.study.protocol import trapezoid
from palpate.workflow_support.result_files import checksum, write_json
from studies.coverage.creep import POISSON_RATIO, burgers, cole_cole, depth, log_normal, power
from studies.coverage.solid import RANGES

RIGHT = "burgers"
WRONG = ("second_element", "log_normal", "cole_cole")
DEVELOPMENT = ("box", "power")  # on which defaults were chosen; none is reported
MISFIT = (0.001, 0.02)  # of the depth, root mean square after the best fit of the base model
MOST_CREEP = 2.0  # times the elastic compliance
SAMPLES = 20  # of the loading
LOADS = (0.1, 10.0)  # mN
LOADING_TIMES = (10.0, 20.0, 40.0, 80.0)  # s
HOLDS = (0, 1, 2)  # loading times
UNLOADINGS = (0.5, 1.0)  # loading times


@dataclass(frozen=True)
class Case:
    """One set of recordings.

    Parameters
    ----------
    name
        Neutral.
    family
        `RIGHT`, or one of `WRONG`.
    compliance
        `instantaneous`, `rate` and `terms` of the truth, see `palpate.classical.viscoelastic_depth.Compliance`.
    parameters
        Those of the base model, where it is right.
    misfit
        Root mean square of what the best fit of the base model leaves without noise, as a share of the depth.
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
    family: str
    compliance: Mapping[str, object]
    parameters: Mapping[str, float]
    misfit: float
    tests: Sequence[Sequence[float]]
    replicates: int
    noise: Mapping[str, float]
    seed: int

    @property
    def truth(self) -> Compliance:
        """The contact compliance of the material."""
        return Compliance(**{**self.compliance, "terms": tuple(map(tuple, self.compliance["terms"]))})  # type: ignore

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """The tests."""
        return tuple(condition(number, *test) for number, test in enumerate(self.tests))


def draw(numbers: Iterable[int], seed: int, wrong: Sequence[str] = WRONG) -> list[Case]:
    """Draw the sets of these numbers, each from a stream of its own.

    One in three is of the right law. The numbers of tests and of replicates, and the kind of creep, come in turn.
    """
    cases = list[Case]()
    for number in numbers:
        rng = np.random.default_rng([seed, number])
        tests, replicates = 1 + number % 6, 1 + number // 6 % 3
        turn = number + number // 18  # so that each number of tests and replicates has every law
        family = RIGHT if turn % 3 == 0 else wrong[(turn + number // 54) % len(wrong)]
        while not (drawn := _drawn(family, tests, rng)):
            pass
        noise = drawn_noise(rng)
        cases.append(Case(f"set_{number:04d}", family, *drawn, replicates, noise, int(rng.integers(2**31))))
    return cases


def recordings(case: Case) -> dict[str, Observation]:
    """Return the recordings of a set."""
    rng, found = np.random.default_rng(case.seed), {}
    for condition in case.conditions:
        exact = depth(case.truth, condition.protocol)
        rows = [replicate(exact, case.noise, rng) for _ in range(case.replicates)]
        found[condition.name] = Observation(condition.protocol.sample_time, np.array(rows))
    return found


def replicate(exact: np.ndarray, noise: Mapping[str, float], rng: np.random.Generator) -> np.ndarray:
    """Return a recording (n,) of an exact depth (n,) [nm] with the noise of a set, at a site of its own."""
    sigma, memory = noise["sigma"], noise["autocorrelation"]
    innovations = sigma * np.sqrt(1.0 - memory**2) * rng.standard_normal(len(exact))
    innovations[0] /= np.sqrt(1.0 - memory**2)
    site = noise["site"] * rng.standard_normal()
    return exact * (1.0 + site) + lfilter([1.0], [1.0, -memory], innovations)


def drawn_noise(rng: np.random.Generator) -> dict[str, float]:
    """Draw the noise of a set, see `Case`."""
    return {
        "sigma": float(rng.uniform(0.6, 1.0)),
        "autocorrelation": float(rng.uniform(0.3, 0.9)),
        "site": float(rng.uniform(0.005, 0.015)),
    }


def drawn_test(rng: np.random.Generator) -> list[float]:
    """Draw load [mN], loading time [s], hold and unloading [loading times] of a test."""
    return [log_uniform(rng, *LOADS), *(float(rng.choice(values)) for values in (LOADING_TIMES, HOLDS, UNLOADINGS))]


def best_burgers(
    truth: Compliance, conditions: Sequence[Condition], times: Sequence[float] = (5.0, 50.0)
) -> tuple[dict[str, float], float]:
    """Return the Burgers solid closest to the depths of a compliance, and the misfit it leaves.

    The misfit is the root mean square of the difference, as a share of the largest depth so far. Searches begin at
    retardation `times` [s].
    """
    protocols = [condition.protocol for condition in conditions]
    exact = [depth(truth, protocol) for protocol in protocols]
    largest = np.concatenate([np.maximum.accumulate(curve) for curve in exact])

    def left(x: np.ndarray) -> np.ndarray:
        solid = burgers(*np.exp(x))
        return (np.concatenate([depth(solid, protocol) for protocol in protocols]) - np.concatenate(exact)) / largest

    lower, upper = np.log(np.array(list(RANGES.values())).T) + np.array([[-1.0], [1.0]]) * np.log(10.0)
    first = np.log([(1.0 - POISSON_RATIO**2) / truth.instantaneous, 1e-3, 0.1, np.nan])
    starts = [np.append(first[:3], np.log(time)) for time in times]
    found = min((least_squares(left, x, bounds=(lower, upper), xtol=1e-4) for x in starts), key=lambda each: each.cost)
    values = dict(zip(RANGES, np.exp(found.x).tolist(), strict=True))
    return values, float(np.sqrt(np.mean(found.fun**2)))


def condition(number: int, load: float, loading: float, hold: float, unloading: float) -> Condition:
    """Return a test: its load [mN], loading time [s], hold and unloading [loading times]."""
    points = round(SAMPLES * (1.0 + hold + unloading))
    return Condition(f"t{number}", "calibrate", trapezoid(load, loading, hold * loading, unloading * loading, points))


def _drawn(
    family: str, count: int, rng: np.random.Generator
) -> tuple[dict[str, object], dict[str, float], float, list[list[float]]] | None:
    """Return compliance, parameters, misfit and tests; None where creep of this kind cannot leave the wanted misfit."""
    tests = [drawn_test(rng) for _ in range(count)]
    modulus, rate = log_uniform(rng, *RANGES["youngs_modulus"]), log_uniform(rng, *RANGES["steady_coefficient"])
    if family == RIGHT:
        drawn = [log_uniform(rng, *RANGES[name]) for name in ("transient_coefficient", "retardation_time")]
        parameters = dict(zip(RANGES, (modulus, rate, *drawn), strict=True))
        return vars(burgers(**parameters)), parameters, 0.0, tests
    elements, wanted = _elements(family, rng), log_uniform(rng, *MISFIT)
    elastic, conditions = (1.0 - POISSON_RATIO**2) / modulus, [condition(k, *test) for k, test in enumerate(tests)]
    creep, misfit = 0.5 * elastic, np.nan
    for _ in range(3):
        truth = Compliance(elastic, 0.5 * rate, tuple((creep * share, time) for share, time in elements))
        _, misfit = best_burgers(truth, conditions, (15.0,))
        if abs(np.log(misfit / wanted)) < 0.2:
            break
        creep = min(creep * wanted / misfit, MOST_CREEP * elastic)
    _, misfit = best_burgers(truth, conditions)
    within = MISFIT[0] <= misfit <= MISFIT[1] and abs(np.log(misfit / wanted)) < 0.5
    return (vars(truth), {}, misfit, tests) if within else None


def _elements(family: str, rng: np.random.Generator) -> tuple[tuple[float, float], ...]:
    """Return the shares and the retardation times [s] of a kind of creep."""
    if family == "second_element":
        first, share = log_uniform(rng, 1.0, 10.0), rng.uniform(0.3, 0.7)
        return ((share, first), (1.0 - share, first * log_uniform(rng, 5.0, 30.0)))
    if family == "log_normal":
        return log_normal(log_uniform(rng, 3.0, 100.0), rng.uniform(0.4, 1.0))
    if family in DEVELOPMENT:
        shortest = log_uniform(rng, 0.3, 3.0)
        exponent = rng.uniform(0.1, 0.5) if family == "power" else 0.0
        return power(exponent, shortest, shortest * log_uniform(rng, 30.0, 1000.0))
    return cole_cole(log_uniform(rng, 5.0, 100.0), rng.uniform(0.4, 0.8))


def seal(cases: Sequence[Any], path: Path) -> str:
    """Write the truth of sets, dataclasses, to one file and return its SHA-256."""
    write_json(path, [asdict(case) for case in cases])
    return checksum(path)
