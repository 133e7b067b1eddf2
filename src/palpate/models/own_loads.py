"""Tests of one method under unlike loads: each is simulated under its own, and brought to that of its condition.

Under depth or strain-rate control the specimen decides the load, and replicates of one condition reach different ones.
Snapshots and surrogates have one history, that of the condition. Of what a test i answers, what its own load explains
is taken off with the forward model h,

    r_i' (t) = r_i (t T_i / T) - h(t T_i / T; P_i) + h(t; P),

where T and T_i are the durations. Both simulations share their errors, so that they cancel in the difference.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from palpate.configuration.condition import Condition
from palpate.configuration.study_file import Study
from palpate.data.observation import Observation
from palpate.errors import PalpateError
from palpate.solver.simulation import simulate_batch
from palpate.study.specification import of_equivalent_cone


def raise_failure(reason: str) -> None:
    """Raise `PalpateError` with a reason, where tests under other loads would count as they are."""
    raise PalpateError(reason)


def brought_to_one_load(
    study: Study,
    observed: Mapping[str, Observation],
    values: Mapping[str, float],
    report: Callable[[str], None] = print,
) -> dict[str, Observation]:
    """Return what was observed, each replicate under the load of its condition; conditions of one load as they are.

    Parameters
    ----------
    study
        Says what is simulated.
    observed
        By the names of conditions.
    values
        Material parameters of the forward model.
    report
        Called with one line for each condition whose simulations fail.
    """
    return {
        name: _brought(study, study.condition(name), item, values, report) if item.own else item
        for name, item in observed.items()
    }


def _brought(
    study: Study,
    condition: Condition,
    item: Observation,
    values: Mapping[str, float],
    report: Callable[[str], None],
) -> Observation:
    first = of_equivalent_cone(study.specification({name: values[name] for name in study.levels}, condition))
    outcomes = simulate_batch([first, *(replace(first, protocol=own) for own in item.own)])
    failed = [outcome.reason for outcome in outcomes if outcome.status != "ok"]
    if failed:
        report(f"{condition.name}: its tests are not brought to one load, as a simulation failed ({failed[0]})")
        return item
    common, *own = (outcome.response for outcome in outcomes)
    return replace(item, response=item.response + common - np.array(own))
