"""Two studies in closed form on one instrument: a bulk solid, and a film that is told from the frame by its prior."""

from dataclasses import replace

import numpy as np
from closed_forms import rounded
from diagnosis_problem import SCALE, problem, recordings, search_of

from palpate.configuration.condition import Condition
from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.instrument_posterior import instrument_posterior
from palpate.study.protocol import trapezoid

SHARES = ("frame_compliance", "tip_rounding")
FILM = {"thickness": 5000.0, "substrate_modulus": 0.6}


def film(protocol, values):
    """Depth (n,) that a soft substrate adds: in proportion to the load, as a frame does."""
    return protocol.sample_load * 2.5e4 / values["thickness"] * (3.0 / values["substrate_modulus"] - 1.0)


def diagnosed(load, seed, *, compliance=0.0, radius=0.0, on_film=False, film_may_act=False, prior=None):
    """Diagnose tests that all reach one load [mN], and return the outcome and what it says of the instrument."""
    conditions = tuple(
        Condition(name, "calibrate", trapezoid(load, rise, hold, rise, points=60), order=float(k))
        for k, (name, rise, hold) in enumerate([("a", 10, 0), ("b", 40, 20)])
    )

    def effect(condition, _):
        cap = rounded(condition.protocol, {"radius": radius}) if radius else 0.0
        return cap + compliance * condition.protocol.sample_load + (film(condition.protocol, FILM) if on_film else 0.0)

    observed = recordings(np.random.default_rng(seed), effect, conditions=conditions)
    task = problem(observed, conditions, tip_rounding=rounded, film_on_substrate=film)
    task = replace(task, scale=replace(SCALE, depth=500.0 * load**0.5, load=load, instrument=prior))
    search = search_of(task, [*SHARES, *(["film_on_substrate"] if film_may_act else [])])
    outcome = diagnose(search, lambda line: None)
    return outcome, instrument_posterior(outcome, search.screen, SHARES, np.random.default_rng(0))
