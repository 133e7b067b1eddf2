"""Synthetic curves whose contact is known: tips, materials, baselines, noise and samplings drawn at random.

Nothing of the contact finder is used here: a curve is a tip's law (Hertz, Sneddon, flat punch, a sphere that passes
into a cone), seen through a cantilever or under load control, on a baseline with offset, tilt, wave, drift and start
transient, with noise that is white or correlated. `python tests/helpers/contact_curves.py evaluation 400` reports how
many of as many 95 % intervals hold the contact; the seeds of the evaluations are for these reports alone and were fixed
before their first runs, what was developed used others.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import binomtest

from indentation_files.contact_point import ContactPoint, first_touch

TIPS = ("sphere", "cone", "flat", "sphero_cone")
DRIVES = ("piezo", "load", "depth")
DISTURBANCES = ("tilt", "wave", "drift", "transient", "creep")  # each in half of the curves
RARE = ("layer", "drop", "curved", "long_wave")  # each in a fifth
SEEDS = {"development": 20260101, "evaluation": 77120345, "second": 530971, "third": 530972}


@dataclass(frozen=True)
class Curve:
    """A curve with its true contact.

    Attributes
    ----------
    time, load, depth : ndarray, shape (n,)
        [s], [mN], [nm].
    contact
        True depth of contact [nm].
    kind
        What disturbs it, such as ``sphere piezo noise 0.5 % tilt wave``.
    reach
        Largest depth beyond contact [nm].
    """

    time: np.ndarray
    load: np.ndarray
    depth: np.ndarray
    contact: float
    kind: str
    reach: float


def law(depth: np.ndarray, tip: str, cap: float) -> np.ndarray:
    """Return the load over that at depth 1, for depths (n,) beyond contact in units of the largest."""
    depth = np.clip(depth, 0.0, None)
    if tip == "sphero_cone":
        joined = (4 / 3 * cap) ** 2
        return np.where(depth < cap, joined * (depth / cap) ** 1.5, (depth + cap / 3) ** 2) / (1 + cap / 3) ** 2
    return depth ** {"sphere": 1.5, "cone": 2.0, "flat": 1.0}[tip]


def layered(depth: np.ndarray, load: np.ndarray, thickness: float, stiffness: float) -> np.ndarray:
    """Return the load (n,) of a body, in units of its largest, that lies under a soft layer.

    Over the layer's `thickness`, a share of the depth, the load rises to a few times the share `stiffness`; beyond it
    the body's own load, from the layer's bottom on, is added.
    """
    soft = stiffness * np.clip(depth, 0.0, None) ** 1.5
    body = np.interp(depth - thickness, np.sort(depth), np.maximum.accumulate(load[np.argsort(depth)]))
    return soft + np.where(depth > thickness, body, 0.0)


def dropping(time: np.ndarray, load: np.ndarray, at: float, size: float, lasting: float) -> np.ndarray:
    """Return a load (n,) that falls by the share `size` `at` a time of its loading, and comes back over `lasting`."""
    since = time - at
    return load * (1 - size * np.where(since > 0, np.exp(-np.clip(since, 0, None) / lasting), 0.0))


def correlated(rng: np.random.Generator, size: int, memory: float) -> np.ndarray:
    """Return noise (n,) of variance one whose correlation falls to 1/e over `memory` points; white for 0."""
    return autoregressive(rng, size, float(np.exp(-1 / memory)) if memory > 0 else 0.0)


def autoregressive(rng: np.random.Generator, size: int, rho: float) -> np.ndarray:
    """Return noise (n,) of variance one, neighbours of which are correlated by `rho`."""
    noise = rng.standard_normal(size)
    for k in range(1, size):
        noise[k] = rho * noise[k - 1] + np.sqrt(1 - rho**2) * noise[k]
    return noise


def path_of(drive: str, tip: str, cap: float, approach: float, size: int, soft: float) -> tuple[np.ndarray, np.ndarray]:
    """Return time and depth (n,), both in units of the loading: an approach, a loading, a short hold, an unloading.

    Under a piezo its way is even and the cantilever takes a share `soft` of it at the largest load; under load control
    the load is even in time.
    """
    depth = np.linspace(0.0, 1.0, 4001)
    load = law(depth, tip, cap)
    way = {"piezo": (depth + soft * load) / (1 + soft), "load": load, "depth": depth}[drive]
    time = np.linspace(-approach, 2.3, size)
    going = np.interp(time, [0.0, 1.0, 1.1, 2.1], [0.0, 1.0, 1.0, 0.0])
    beyond = np.interp(going, way, depth)
    free = np.where(time < 0, time, np.where(time > 2.1, 2.1 - time, 0.0))
    return time, np.where(free < 0, free, beyond)


def draw(rng: np.random.Generator) -> Curve:
    """Draw one curve: each disturbance is absent in half of the curves, each rare one in four of five."""
    tip, drive = str(rng.choice(TIPS)), str(rng.choice(DRIVES))
    cap = rng.uniform(0.02, 0.5)
    approach = np.exp(rng.uniform(np.log(0.2), np.log(6.0)))
    size = int(np.exp(rng.uniform(np.log(250), np.log(20000))))
    time, depth = path_of(drive, tip, cap, approach, size, rng.uniform(0.1, 2.0))
    load = law(depth, tip, cap)
    passed = (depth - depth.min()) / max(-depth.min(), 1.0)
    noise = np.exp(rng.uniform(np.log(0.001), np.log(0.02)))
    memory = rng.choice([0.0, 0.0, np.exp(rng.uniform(0.0, np.log(30.0)))])
    present = rng.random(len(DISTURBANCES)) < 0.5
    tilt, wave, drift, transient, creeps = present
    rare = rng.random(len(RARE)) < 0.2
    layer, drop, curved, long_wave = rare
    soft = layered(depth, load, rng.uniform(0.05, 0.4), rng.uniform(0.1, 1.0))
    load = soft / soft.max() if layer else load
    load = dropping(time, load, rng.uniform(0.1, 0.8), drop * rng.uniform(0.03, 0.15), rng.uniform(0.01, 0.1))
    load = load * (1 + creeps * rng.uniform(0.02, 0.2) * np.exp(-np.clip(time, 0, None) / rng.uniform(0.1, 1.0)))
    load += tilt * rng.uniform(-0.3, 0.3) * passed
    period = rng.uniform(0.1, 1.5) * approach
    load += wave * rng.uniform(0.005, 0.05) * np.sin(2 * np.pi * depth / period + rng.uniform(0, 2 * np.pi))
    bend, end = rng.uniform(0.01, 0.06) * rng.choice([-1, 1]), np.clip(passed, None, 1.0)
    load += curved * bend * (end**2 if rng.random() < 0.5 else np.exp((end - 1) / rng.uniform(0.1, 0.4)))
    slow = np.sin(2 * np.pi * depth / (rng.uniform(1.0, 4.0) * approach) + rng.uniform(0, 2 * np.pi))
    load += long_wave * rng.uniform(0.005, 0.05) * slow
    load += drift * rng.uniform(-0.1, 0.1) * (time - time[0]) / np.ptp(time)
    load += transient * rng.uniform(-0.1, 0.1) * np.exp(-(time - time[0]) / (approach * rng.uniform(0.005, 0.1)))
    load += rng.uniform(-0.5, 0.5) + noise * correlated(rng, size, memory)
    depth = depth + rng.choice([0.0, np.exp(rng.uniform(np.log(1e-4), np.log(2e-3)))]) * rng.standard_normal(size)
    reach, force = 10 ** rng.uniform(2.0, 4.0), 10 ** rng.uniform(-5.0, 2.0)
    contact, duration = rng.uniform(-2.0, 2.0) * reach, 10 ** rng.uniform(0.0, 2.0)
    words = [name for name, on in zip(DISTURBANCES + RARE, [*present, *rare], strict=True) if on]
    kind = f"{tip} {drive} noise {100 * noise:.2g} % memory {memory:.2g} approach {approach:.2g} n {size}"
    return Curve(duration * time, force * load, contact + reach * depth, contact, " ".join([kind, *words]), reach)


def found_in(seed: int, count: int) -> Iterator[tuple[Curve, ContactPoint]]:
    """Yield curves of a seed with the contact that is found in each."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        curve = draw(rng)
        yield curve, first_touch(curve.time, curve.load, curve.depth)


def holds(curve: Curve, point: ContactPoint) -> bool:
    """Return whether the interval holds the true contact."""
    return point.lower <= curve.contact <= point.upper


def report(name: str, count: int) -> None:
    """Print the share of intervals that hold the truth, with Wilson's interval, and their width and error."""
    rows = []
    for curve, point in found_in(SEEDS[name], count):
        width, error = (point.upper - point.lower) / curve.reach, (point.depth - curve.contact) / curve.reach
        rows.append((curve.kind.split(), holds(curve, point), width, abs(error)))
        if not rows[-1][1]:
            print(f"missed by {error:+.3f} of the depth, width {width:.3f}: {curve.kind}", flush=True)
    words = ["", *TIPS, *DRIVES, *DISTURBANCES, *RARE]
    for word in words:
        chosen = [row for row in rows if not word or word in row[0]]
        held = sum(row[1] for row in chosen)
        low, high = binomtest(held, len(chosen)).proportion_ci(method="wilson")
        width, error = np.median([row[2] for row in chosen]), np.median([row[3] for row in chosen])
        print(
            f"{word or 'all':12} {held} of {len(chosen)}: {held / len(chosen):.3f} ({low:.3f} to {high:.3f}), "
            f"median width {width:.3f}, median error {error:.4f} of the depth"
        )


if __name__ == "__main__":
    report(sys.argv[1], int(sys.argv[2]))
