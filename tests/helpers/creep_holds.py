"""Holds under load of a body that creeps, on an instrument that drifts."""

import numpy as np

LOADING, HOLD = 10.0, 20.0


def held(drift, creep, seed=0, noise=0.1, relaxing=0.0):
    """Loading to 3 mN, a hold in which the depth grows by `creep` (s -> nm), and unloading; in 0.05 s steps."""
    time = np.arange(0.0, 2 * LOADING + HOLD, 0.05)
    load = np.interp(time, [0, LOADING, LOADING + HOLD, 2 * LOADING + HOLD], [0, 3, 3 * (1 - relaxing), 0])
    since = np.clip(time - LOADING, 0.0, HOLD)
    noise = noise * np.random.default_rng(seed).standard_normal(len(time))
    return time, load, 80.0 * np.sqrt(load) + creep(since) + drift * time + noise


CREEPS = {
    "none": lambda s: 0.0 * s,
    "exponential": lambda s: 5.0 * (1.0 - np.exp(-s / 1.5)),
    "logarithm": lambda s: 2.0 * np.log1p(s / 0.5),
    "power law": lambda s: 3.0 * s**0.3,
}


def held_low(drift, creep, seed=0):
    """The same test, unloaded to a tenth of its load and held there for 40 s, where it creeps on at `creep` nm/s."""
    time, load, depth = held(drift, CREEPS["logarithm"], seed)
    first = (load >= 0.3) | (time < LOADING)
    rest = np.arange(1, 401) * 0.1
    noise = 0.1 * np.random.default_rng(seed + 1).standard_normal(400)
    low = depth[first][-1] + (drift + creep) * rest + noise
    return (
        np.append(time[first], time[first][-1] + rest),
        np.append(load[first], np.full(400, 0.3)),
        np.append(depth[first], low),
    )
