"""The next test: the feasible one that separates two accounts of the recordings best.

These are the two best explanations, a suspected one and the base model, or the base model and the same with the effect
that could hide beside it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.stats import chi2, ncx2

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.diagnosis.individual_amplitudes import about
from palpate.diagnosis.undetected import UndetectedEffect
from palpate.errors import InputError
from palpate.inference.covariance import components_under
from palpate.inference.explanation import Fit
from palpate.mechanisms import MECHANISMS
from palpate.solver.simulation import Simulation, simulate_batch
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification

POINTS = 30  # samples of a proposed test
DRAWS = 7  # with the best one they fill the lanes of one run
REPLICATES = 3  # of a proposed test
FALSE_ALARM = 0.01  # significance at which its power is given
SPHERE = 10_000.0  # nm
BERKOVICH = 70.3  # deg, the equivalent cone


@dataclass(frozen=True, eq=False)
class FeasibleTest:
    """A test that the laboratory could run next.

    Parameters
    ----------
    phrase, settings
        The test in one phrase, and its numbers.
    protocol
        Its load history.
    indenter, tip
        A tip that the study does not have, or the name of one that it has; empty for its own.
    """

    phrase: str
    settings: dict[str, float]
    protocol: Protocol
    indenter: Indenter | None = None
    tip: str = ""

    @property
    def condition(self) -> Condition:
        """The test as a condition that takes no part in the fit."""
        return Condition("", "validate", self.protocol, tip=self.tip)


def feasible(
    load: float, loading_time: float, indenter: Indenter, further: Mapping[str, float] | None = None
) -> Iterator[FeasibleTest]:
    """Yield tests around the largest load [mN] and shortest loading time [s] of a study, with each of its tips.

    Parameters
    ----------
    load, loading_time, indenter
        Of the study's own tip.
    further
        The largest load of each further tip, by its name. Where there is none, a tip that the study does not have is
        feasible.
    """
    for size in [factor * load for factor in (0.03, 0.1, 0.3, 3.0)]:
        yield _trapezoid(f"the same times at {size:.3g} mN", size, loading_time)
    for time in [factor * loading_time for factor in (0.3, 10.0)]:
        yield _trapezoid(f"loading and unloading in {time:.3g} s at {load:.3g} mN", load, time)
    low, hold = 0.1 * load, 10 * loading_time
    yield _trapezoid(f"a hold of {hold:.3g} s at {load:.3g} mN", load, loading_time, hold)
    knots = np.array([0.0, loading_time, 1.9 * loading_time, 1.9 * loading_time + hold, 2 * loading_time + hold])
    loads = np.array([0.0, load, low, low, 0.0])
    sample = np.union1d(np.linspace(0.0, knots[-1], POINTS + 1)[1:], knots[1:])
    yield FeasibleTest(
        f"a hold of {hold:.3g} s at {low:.3g} mN after unloading from {load:.3g} mN",
        {"max_load": load, "loading_time": loading_time, "low_load": low, "low_hold_time": hold},
        Protocol(knots, loads, sample),
    )
    if not further:
        yield _with_another_tip(_trapezoid(f"the same times at {load:.3g} mN", load, loading_time), indenter)
        return
    for name, largest in further.items():
        for size in [factor * largest for factor in (0.1, 3.0)]:
            yield replace(_trapezoid(f"the same times at {size:.3g} mN with {name}", size, loading_time), tip=name)


def _with_another_tip(test: FeasibleTest, indenter: Indenter) -> FeasibleTest:
    """Return the test with a sphere in place of another tip, or with a Berkovich tip in place of a sphere."""
    if indenter.shape != "sphere":
        other = replace(indenter, shape="sphere", half_angle=0.0, face_angle=0.0, area=(), radius=SPHERE)
        phrase, size = f"{test.phrase} with a sphere of {1e-3 * SPHERE:g} um", {"radius": SPHERE}
    else:
        other = replace(indenter, shape="cone", half_angle=BERKOVICH, radius=0.0)
        phrase, size = f"{test.phrase} with a Berkovich tip", {"half_angle": BERKOVICH}
    return replace(test, phrase=phrase, settings=test.settings | size, indenter=other)


def _trapezoid(phrase: str, load: float, time: float, hold: float = 0.0) -> FeasibleTest:
    """Return a test that is loaded and unloaded in the same time [s]."""
    settings = {"max_load": load, "loading_time": time, "hold_time": hold, "unloading_time": time}
    return FeasibleTest(phrase, settings, trapezoid(load, time, hold, time, POINTS))


@dataclass(frozen=True, eq=False)
class Account:
    """What is compared with another account of the same recordings.

    Parameters
    ----------
    name, fit
        The explanation in words, and its fit, whose noise and amplitudes are used.
    draws : ndarray, shape (m, k)
        Draws from its posterior.
    hidden
        An effect beside the explanation, if any.
    """

    name: str
    fit: Fit
    draws: np.ndarray
    hidden: UndetectedEffect | None = None

    @classmethod
    def of(cls, fit: Fit, draws: np.ndarray) -> Account:
        """Return the account of an explanation, of whose posterior some `draws` (m, k) are taken."""
        return cls(
            "+".join(fit.explanation) or "base model", fit, draws[np.linspace(0, len(draws) - 1, DRAWS, dtype=int)]
        )

    def with_hidden(self, effect: UndetectedEffect) -> Account:
        """Return the same with an effect beside it, and all parameters changed by as much as it requires."""
        return replace(self, name=f"{self.name} with {effect.amplitude.key}", hidden=effect)

    def specification(self, z: np.ndarray, test: FeasibleTest) -> Specification:
        """Return what is simulated of a test at coordinates z (k,) of the explanation."""
        if self.hidden is None:
            return of_test(self.fit.model.specification(z, test.condition), test)
        least, largest = self.fit.coordinates.limits
        moved = np.clip(z + self.hidden.change, least, largest)
        found, amplitude = self.fit.model.specification(moved, test.condition), self.hidden.amplitude
        mechanisms = {**found.mechanisms, amplitude.key: amplitude.parameters(self.hidden.value)}
        return of_test(replace(found, mechanisms=mechanisms), test)


def discriminating_test(study: Study, first: Account, second: Account) -> dict[str, Any] | None:
    """Return the test that separates two accounts most surely, with its expected power; None if none can be simulated.

    The distance of the two predicted curves is measured against the covariance of noise, site scatter, slow drift,
    values of three new recordings and the simulation's error (the mean over both accounts), plus the uncertainty of
    the parameters of both (from draws from their posteriors); the power is that of a 1 % test.
    """
    scale, found = first.fit.problem.scale, list[dict[str, Any]]()
    by_tip = study.by_tip(study.calibrated).items()
    loads = {name: max(each.protocol.max_load for each in conditions) for name, conditions in by_tip if name}
    tests = list(feasible(scale.load, scale.loading_time, study.indenter, loads))
    hidden = {"hidden_effect": {str(second.hidden.amplitude): second.hidden.value}} if second.hidden else {}
    predicted = (_predicted(account, tests) for account in (first, second))
    for test, *both in zip(tests, *predicted, strict=True):
        if None in both:
            continue
        (a, spread_a), (b, spread_b) = both
        errors = [error_of_means(study, of.fit, test.condition, x) for of, x in ((first, a), (second, b))]
        spread = 0.5 * (errors[0] + errors[1]) + spread_a + spread_b
        distance = float((a - b) @ np.linalg.solve(spread, a - b))
        power = float(ncx2.sf(chi2.isf(FALSE_ALARM, 1), 1, distance))
        entry = {"test": test.phrase, **test.settings, "expected_power": power, "distance": distance}
        entry |= {"tip": test.tip} if test.tip else {}
        found.append(entry | {"separates": [first.name, second.name]} | hidden)
    return max(found, key=lambda entry: entry["distance"], default=None)


def error_of_means(study: Study, fit: Fit, condition: Condition, curve: np.ndarray) -> np.ndarray:
    """Return the covariance (n, n) [nm^2] of the mean of three recordings of a test about its simulated `curve` (n,).

    A mechanism that varies has unknown values in the new recordings. The simulation's error counts as in a diagnosis: a
    difference by a common factor of the depth distinguishes nothing. The test, as a `condition`, has the noise of a
    `fit`; other arguments as `palpate.diagnosis.individual_amplitudes.about`.
    """
    errors, parts = fit.errors, components_under(fit.problem, fit.own, condition, curve)
    names = [str(amplitude) for amplitude in fit.own]
    own = [(errors.noise.variances[name] / REPLICATES + errors.between.get(name, 0.0)) * parts[name] for name in names]
    return about(study, fit, condition, curve, REPLICATES) + sum(own)


def _predicted(account: Account, tests: list[FeasibleTest]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """Return the predicted curve of each test and the covariance that the uncertain parameters give it.

    None where the forward model fails.
    """
    points = (account.fit.z, *account.draws)
    predicted: list[tuple[np.ndarray, np.ndarray] | None] = []
    for outcomes in _simulated([[account.specification(z, test) for z in points] for test in tests]):
        if not outcomes or any(outcome.status != "ok" for outcome in outcomes):
            predicted.append(None)
            continue
        best, *others = outcomes
        departures = np.array([outcome.depth - best.depth for outcome in others])
        predicted.append((best.depth, departures.T @ departures / len(others)))
    return predicted


def _simulated(rows: list[list[Specification]]) -> list[list[Simulation]]:
    """Simulate all rows together, or row by row where one is refused, which gives an empty list."""
    try:
        outcomes = iter(simulate_batch([specification for row in rows for specification in row]))
        return [[next(outcomes) for _ in row] for row in rows]
    except InputError:
        return [found for row in rows for found in _simulated([row])] if len(rows) > 1 else [[]]


def of_test(specification: Specification, test: FeasibleTest) -> Specification:
    """Return the specification with the tip of a test; mechanisms of the old tip are dropped."""
    if test.indenter is None:
        return specification
    kept = {key: values for key, values in specification.mechanisms.items() if not MECHANISMS[key].of_the_tip}
    return replace(specification, indenter=test.indenter, mechanisms=kept)
