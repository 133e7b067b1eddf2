"""A material point under a given history of strain: the project's update, and SciPy's integration of the law itself.

Tensors have the components xx, yy, zz, xy, yz, zx. The deviator turns while the body is squeezed.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from palpate.materials import law_of
from palpate.materials.flow.point import commit, history, length, residual, solve, state_size
from palpate.materials.flow.row import BULK, SHEAR, step_weights

DOUBLE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # T : U = sum of DOUBLE * T * U
FIRST, SECOND = np.array([0.6, 0.4, -1.0, 0.3, 0.0, 0.1]), np.array([-0.2, 0.5, -0.3, 0.0, 0.4, 0.6])
DURATION = 10.0
HOOKE = {"youngs_modulus": 3.0, "poisson_ratio": 0.35}
BURGERS_TERMS = {
    "values": {
        "steady_coefficient": 0.09,
        "steady_exponent": 0.2,
        "transient_coefficient": 0.24,
        "transient_exponent": 0.47,
        "retardation_time": 2.5,
    },
    "terms": {"creep": lambda q, p, alpha: 0.09 * q**0.4, "elements": [(2.5, lambda q: 0.24 * q**0.94)]},
}


def strain_at(time, size, squeeze=0.0):
    """Return the strain deviator (6,) and the volumetric strain at a `time` [s]."""
    part = time / DURATION
    return size * (np.sin(2.0 * part) * FIRST + part**2 * SECOND), -squeeze * np.sin(3.0 * part)


def strain_rate(time, size, squeeze=0.0):
    """Return the derivative of `strain_at` by time."""
    part = time / DURATION
    deviator = size * (2.0 * np.cos(2.0 * part) * FIRST + 2.0 * part * SECOND) / DURATION
    return deviator, -3.0 * squeeze * np.cos(3.0 * part) / DURATION


def updated(model, values, steps, size, squeeze=0.0, resistance=1.0):
    """Return the stress deviator (6,) at the end of the history by the project's update in so many `steps`."""
    law = law_of(model).coefficients(values)
    dt = DURATION / steps
    weights = step_weights(law[None], dt, resistance)[0]
    state, past, back, q = np.zeros(state_size(law, 6)), np.empty(6), np.empty(6), 0.0
    for k in range(1, steps + 1):
        deviator, volume = strain_at(k * dt, size, squeeze)
        pressure = -law[BULK] * volume
        alpha = history(state, weights, law, past, back)
        trial = residual(deviator, past, weights)
        q, _, _ = solve(length(trial, 6), q, alpha, pressure, weights, law)
        commit(state, trial, back, alpha, q, pressure, weights, law)
    return state[:6].copy()


def integrated(
    values,
    size,
    squeeze=0.0,
    creep: Callable = lambda q, p, alpha: 0.0,
    elements=(),
    strength: Callable | None = None,
    pressed=0.0,
    back=0.0,
    linear=(),
):
    """Return the stress deviator (6,) at the end of the history by integration of the rate equations.

    Parameters
    ----------
    creep
        d e/dt over s - X at (q, p) and the equivalent strain of that flow, where there is no yield stress.
    elements
        Retardation time of each Voigt element, and the strain over s - X that it tends to at q.
    strength
        Yield stress at alpha without pressure, and its derivative.
    pressed
        Rise of the yield stress with pressure.
    back
        The back stress X over the strain of all flow but the `linear` elements.
    linear
        Retardation time and compliance of each linear Voigt element.
    """
    law = law_of("elastic").coefficients({k: values[k] for k in ("youngs_modulus", "poisson_ratio")})
    shear, bulk = law[SHEAR], law[BULK]

    def rates(time, y):
        s, alpha, flowed, retarded = y[:6], y[6], y[7:13], y[13:].reshape(-1, 6)
        eta = s - back * flowed
        (rate, swelling), (_, volume) = strain_rate(time, size, squeeze), strain_at(time, size, squeeze)
        q, p, p_rate = np.sqrt(0.5 * np.sum(DOUBLE * eta * eta)), -bulk * volume, -bulk * swelling
        driven = [(time, tends(q) * eta) for time, tends in elements] + [(time, j * s) for time, j in linear]
        tending = np.array([(end - e) / time for (time, end), e in zip(driven, retarded, strict=True)]).reshape(-1, 6)
        fluidity = creep(q, p, alpha)
        flowing = fluidity * eta + tending[: len(elements)].sum(axis=0)
        rate = rate - flowing - tending[len(elements) :].sum(axis=0)
        flow = 0.0 if strength else 2.0 / np.sqrt(3.0) * fluidity * q
        plastic = np.zeros(6)
        if strength is not None and q > 0.0:
            stress, hardening = strength(alpha)
            if np.sqrt(3.0) * q >= stress + pressed * p:
                moving = 2.0 * shear * rate - back * flowing
                wanted = 0.5 * np.sqrt(3.0) * np.sum(DOUBLE * eta * moving) / q - pressed * p_rate
                flow = max(wanted, 0.0) / (hardening + 3.0 * shear + 1.5 * back)
                plastic = 0.5 * np.sqrt(3.0) * flow * eta / q
        return np.concatenate([2.0 * shear * (rate - plastic), [flow], flowing + plastic, tending.ravel()])

    start = np.zeros(13 + 6 * (len(elements) + len(linear)))
    options = {"rtol": 1e-9, "atol": 1e-13} if strength is None else {"rtol": 1e-7, "atol": 1e-10, "max_step": 0.01}
    method = "Radau" if strength is None else "RK45"
    return solve_ivp(rates, (0.0, DURATION), start, method=method, **options).y[:6, -1]


def error(found, expected):
    """Return the largest difference over the largest component."""
    return np.abs(found - expected).max() / np.abs(expected).max()


def check_yielding(key, flow, strength, joined, squeeze=0.0, pressed=0.0, back=0.0):
    """A law with a yield stress, alone or beside Burgers creep, keeps to its rate equations, the closer in finer steps.

    Parameters
    ----------
    flow
        Its parameters but the elastic ones.
    strength, squeeze, pressed, back
        See `integrated`.
    joined
        Whether creep acts beside it.
    """
    creep = BURGERS_TERMS if joined else {"values": {}, "terms": {}}
    values, model = HOOKE | flow | creep["values"], key + "+nonlinear_burgers" * joined
    expected = integrated(HOOKE, 0.05, squeeze, strength=strength, pressed=pressed, back=back, **creep["terms"])
    coarse, fine = (error(updated(model, values, steps, 0.05, squeeze), expected) for steps in (100, 400))
    assert fine < 0.005 and fine < 0.5 * coarse
