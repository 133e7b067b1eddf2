"""The law of a study, chosen by its recordings among those of a family.

1. The base law of the family is fitted, from the middle of its ranges and from places scattered over them.
2. The other laws are fitted, from the middle of their ranges, where all their terms act, and from the base law's
   optimum if they contain that law. Parameters of the base law may stand in there for a term that it lacks: of a
   metal that creeps, bilinear plasticity took the creep for hardening, and neither a score test at that optimum nor a
   search from there alone found the spectrum.
3. The law with the largest evidence is chosen; all of them count equally beforehand. Of laws whose evidence is as large
   within what Laplace's approximation leaves, it is the one with the fewest parameters.

The recordings are those of the calibrate conditions of the study's first set. Other sets of a study hold the same
material, and share its surrogates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import logsumexp

from indentation_files.recording import Recording
from palpate.base.threads import on_one_thread
from palpate.choice.compared_laws import ComparedLaws
from palpate.configuration.levels import checked_levels
from palpate.configuration.study_file import Study
from palpate.data.measures import root_mean_square
from palpate.data.study_recordings import check, resampled
from palpate.draft.guesses import ranges
from palpate.draft.known_tip import KnownTip
from palpate.draft.solid import Solid
from palpate.errors import InputError, PalpateError
from palpate.inference.discrepancy import power_of_evidence
from palpate.inference.explanation import Fit
from palpate.inference.fit_policy import FitPolicy
from palpate.inference.starting_places import scattered
from palpate.materials.families import FAMILIES, neutral
from palpate.models.finite_elements import FiniteElements

LEAST_WIDTH, MOST_WIDTH = 0.1, 0.5  # of the guessed range, to either side of the estimate
WIDTH = 6.0  # standard deviations of the posterior to either side: the grid hardly adds to what the tests say
NARROWER = 0.7  # factor on that width while the law refuses a corner
ANSWER = 1.96  # standard deviations of the intervals, 95 %
TIE = 0.5  # of log evidence; chosen: by so much the approximation errs where a parameter lies on its limit
STATED = 0.1  # probability from which the answer of the runner-up is stated


@dataclass(frozen=True, eq=False)
class Judged:
    """A law that was compared.

    Parameters
    ----------
    law
        Its key.
    fit
        None where it failed.
    """

    law: str
    fit: Fit | None

    @property
    def log_evidence(self) -> float:
        """With the discrepancy of the law, at the optimum as far as the search came; -inf where it failed."""
        return self.fit.optimistic_log_evidence if self.fit else -np.inf


@on_one_thread
def choose(study: Study, report: Callable[[str], None] = print) -> dict[str, Any]:
    """Choose the law of a study, and return the content of ``law.json``.

    Keys: `study`, `family`, `recordings` (the set), `law`, `levels` of its parameters, `probability`, `runner_up` (its
    `law`, `probability` and `parameters`; none where it has less than `STATED`), `curves`, and `candidates`, each with
    `law`, `log_evidence`, `probability`, `residual_nm`, `residual_percent` of the largest depth, `held_out_nm`,
    `curves` and `parameters`.

    Parameters
    ----------
    study
        Whose law is open.
    report
        Called with one line on the progress.

    Raises
    ------
    InputError
        When the tests cannot tell the laws of the family from each other.
    PalpateError
        When the base law fails wherever a search may begin.
    """
    family, name = FAMILIES[study.family], next(iter(study.recordings))
    recorded = check(study, name)
    solid, loading = check_distinguishable(study, recorded)
    guessed = {law: ranges(law, solid, loading) for law in family.laws}
    laws, base = _base_fit(ComparedLaws(study, resampled(study, recorded), guessed), family.base, report)
    values = neutral(base.coordinates.named(base.z), loading)
    others = [_fitted(laws, law, values, report) for law in family.others]
    return _content(study, [Judged(family.base, base), *others])


def check_distinguishable(study: Study, recorded: Mapping[str, Sequence[Recording]]) -> tuple[Solid, float]:
    """Return what tests show of the solid without a simulation, and their shortest time of loading [s].

    Parameters
    ----------
    study
        Whose law is open.
    recorded
        Recordings of each condition.

    Raises
    ------
    InputError
        When the tests cannot tell the laws of the family from each other: without an unloading yielding looks like
        creep, and without a hold besides creep looks like elasticity.
    """
    tests = [test for condition in study.calibrated for test in recorded[condition.test]]
    tip, gel = study.indenter, study.family == "gel"
    keys = {key: getattr(tip, key) for key in ("shape", "half_angle", "radius", "area") if getattr(tip, key)}
    solid = Solid.of(tests, KnownTip(keys), study.fixed["poisson_ratio"])
    if np.isnan(solid.returned) and (np.isnan(solid.creep) or not gel):
        shown = f"no test is unloaded{' or held' if gel else ''}"
        raise InputError(
            f"{shown}, so that the laws of the family {study.family} cannot be told from each other",
            remedy="add a test that is unloaded, or state the law",
            place="material.family",
        )
    return solid, min(float(test.time[np.argmax(test.load)]) for test in tests)


def _base_fit(laws: ComparedLaws, law: str, report: Callable[[str], None]) -> tuple[ComparedLaws, Fit]:
    """Return the base law's fit, and the laws with what it says of the noise and of tests under loads of their own."""
    problem, middle = laws.problem(law), laws.middle(law)
    brought = problem.at_one_load(problem.forward.coordinates.named(middle), report)
    laws = replace(laws, observed=brought.recorded)
    rng = np.random.default_rng([laws.study.seed, 2])
    fit = laws.fit(law, [middle, *scattered(problem.material, FitPolicy(), rng)])
    if brought is not problem:
        own = problem.at_one_load(fit.coordinates.named(fit.z), report)
        laws = replace(laws, observed=own.recorded)
    laws = replace(laws, residual=fit.residual)
    report(f"{law}: root mean square {root_mean_square(fit.residual):.4g} nm")
    return laws, laws.weighed(fit)


def _fitted(laws: ComparedLaws, law: str, values: Mapping[str, float], report: Callable[[str], None]) -> Judged:
    """Return a law after its fit; without one where that fails."""
    try:
        fit = laws.weighed(laws.fit(law, [*laws.at_base(law, values), laws.middle(law)]))
    except PalpateError as error:
        report(f"{law} could not be fitted: {error}")
        return Judged(law, None)
    found = Judged(law, fit)
    report(f"{law}: root mean square {root_mean_square(fit.residual):.4g} nm, log evidence {found.log_evidence:.1f}")
    return found


def _content(study: Study, judged: list[Judged]) -> dict[str, Any]:
    """Return the content of ``law.json``."""
    evidence = np.array([each.log_evidence for each in judged])
    best = max(judged, key=lambda each: (each.log_evidence > evidence.max() - TIE, -_size(each), each.log_evidence))
    assert best.fit is not None
    weights = power_of_evidence(best.fit.errors.law) * evidence
    probability = dict(zip([each.law for each in judged], np.exp(weights - logsumexp(weights)), strict=True))
    ranked = [best, *sorted((each for each in judged if each is not best), key=lambda each: -each.log_evidence)]
    rows = [_row(each, float(probability[each.law])) for each in ranked]
    second = rows[1] if len(rows) > 1 else None
    return {
        "study": study.name,
        "family": study.family,
        "recordings": next(iter(study.recordings)),
        "law": best.law,
        "levels": levels_about(study, best.fit),
        "probability": rows[0]["probability"],
        "runner_up": second if second and second["probability"] > STATED else None,
        "curves": sum(row["curves"] for row in rows),
        "candidates": rows,
    }


def _row(judged: Judged, probability: float) -> dict[str, Any]:
    """Return what is stated of one law; one that could not be fitted has its key alone, and a probability of zero."""
    fit = judged.fit
    if fit is None:
        names = ("log_evidence", "residual_nm", "residual_percent", "held_out_nm")
        return {"law": judged.law, "probability": 0.0, "curves": 0, "parameters": {}} | dict.fromkeys(names)
    residual = root_mean_square(fit.residual)
    return {
        "law": judged.law,
        "probability": probability,
        "log_evidence": judged.log_evidence,
        "residual_nm": residual,
        "residual_percent": 100.0 * residual / float(fit.problem.mean.max()),
        "held_out_nm": _held_out(fit),
        "curves": _curves(fit),
        "parameters": _parameters(fit),
    }


def _held_out(fit: Fit) -> float | None:
    """Return the root mean square error of the held-out tests [nm]; None where there are none."""
    errors = [
        curve - fit.problem.observed[name].mean
        for name, curve in fit.everywhere.items()
        if name not in fit.problem.names and not isinstance(curve, str)
    ]
    return root_mean_square(np.concatenate(errors)) if errors else None


def _parameters(fit: Fit) -> dict[str, dict[str, float]]:
    """Return estimates with 95 % intervals to first order, by name."""
    named, away = fit.coordinates.named, ANSWER * np.sqrt(np.diag(fit.posterior))
    lower, upper = named(fit.z - away), named(fit.z + away)
    return {
        name: {"estimate": value, "lower": lower[name], "upper": upper[name]} for name, value in named(fit.z).items()
    }


def levels_about(study: Study, fit: Fit) -> dict[str, list[float]]:
    """Return levels of the snapshot grid about a fit, at whose corners its law can be.

    They reach as far as the posterior does, and no farther than half of the guessed range to either side.
    """
    away = np.clip(WIDTH * np.sqrt(np.diag(fit.posterior)), LEAST_WIDTH, MOST_WIDTH)
    least, largest = fit.coordinates.limits
    law = fit.problem.forward.specification(fit.z, fit.problem.conditions[0]).model
    while True:
        lower, upper = (fit.coordinates.named(np.clip(fit.z + side * away, least, largest)) for side in (-1.0, 1.0))
        levels = {name: sorted({value, upper[name]}) for name, value in lower.items()}
        try:
            checked_levels(law, study.fixed, levels, "sobol")
        except InputError:
            away = NARROWER * away
            continue
        return levels


def _size(judged: Judged) -> int:
    """Return the number of free parameters of a law that was fitted."""
    return len(judged.fit.z) if judged.fit else 0


def _curves(fit: Fit) -> int:
    assert isinstance(fit.model, FiniteElements)
    return fit.model.body.spent.curves
