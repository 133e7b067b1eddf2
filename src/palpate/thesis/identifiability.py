r"""Which parameters the thesis' four tests fix, which they cannot, and which extra test would.

With the slopes G of the curves (central differences of the solver over 5 % of the ranges, parameters scaled to them)
and the covariance C of the mean recordings, the Fisher information of a test is G^T C^-1 G; tests add. What is known
beforehand is that each parameter lies in its range (variance 1/12). A parameter counts as fixed when its 95 %
interval is narrower than half its range, the tool's own rule. Profile likelihoods over the surrogates of the four
tests, with the curve of the truth in place of recordings, show what the quadratic approximation misses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from palpate.calibration.polish import WeightedFit
from palpate.calibration.space import Space
from palpate.config import Study
from palpate.indenters import Indenter
from palpate.protocol import Protocol, trapezoid
from palpate.specification import Specification
from palpate.surrogate import PODRBF
from palpate.thesis.grids import CALIBRATED, EPOXY_SCREENING, Outcomes, Studies
from palpate.thesis.runs import Curves, Design, Run
from palpate.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy, compare

RANGES = {name: (min(v), max(v)) for name, v in EPOXY_SCREENING.items()} | {"poisson_ratio": (0.25, 0.45)}
CONE, SHARP, SPHERE = (
    Indenter("cone", half_angle=70.3),
    Indenter("cone", half_angle=42.3),
    Indenter("sphere", radius=10000.0),
)
EXTRA: dict[str, tuple[str, Indenter, Protocol]] = {
    "repeat": ("the 30 s test once more", CONE, trapezoid(1.0, 30, 0, 30)),
    "half_load": ("0.5 mN in 30 s", CONE, trapezoid(0.5, 30, 0, 30)),
    "hold": ("30 s up, 60 s hold, 30 s down", CONE, trapezoid(1.0, 30, 60, 30)),
    "fast": ("1 s up, 1 s down", CONE, trapezoid(1.0, 1, 0, 1)),
    "step": ("0.1 s up, 3 s hold, 0.1 s down", CONE, trapezoid(1.0, 0.1, 3, 0.1)),
    "sphere": ("sphere of 10 um, 30 s up, 30 s down", SPHERE, trapezoid(1.0, 30, 0, 30)),
    "sphere_step": ("sphere of 10 um, 0.1 s up, 3 s hold, 0.1 s down", SPHERE, trapezoid(1.0, 0.1, 3, 0.1)),
    "sharp": ("cone of 42.3 degrees, 30 s up, 30 s down", SHARP, trapezoid(1.0, 30, 0, 30)),
}
STEP, MEMORY, NOISE, SITE, REPLICATES = 0.05, 2.0, 1.0, 0.01, 3
PROFILE_POINTS = 21
LIMIT = 3.84


def truth(study: Study) -> dict[str, float]:
    """Return the true parameters, Poisson's ratio among them."""
    return {**study.laboratory["virtual"]["parameters"], "poisson_ratio": study.fixed["poisson_ratio"]}


def runs(studies: Studies, outcomes: Outcomes) -> list[Run]:
    """Return every test at the truth and a little to both sides of it in every parameter."""
    study = studies["epoxy"]
    tests = {name: (CONE, study.condition(name).protocol) for name in CALIBRATED}
    tests |= {name: (indenter, protocol) for name, (_, indenter, protocol) in EXTRA.items()}
    middle = truth(study)
    steps: list[tuple[str, float]] = [("", 0.0), *((name, sign * STEP) for name in RANGES for sign in (-1.0, 1.0))]
    found = []
    for test, (indenter, protocol) in tests.items():
        for name, share in steps:
            values = dict(middle)
            if name:
                values[name] += share * (RANGES[name][1] - RANGES[name][0])
            labels = {"test": test, "moved": name, "share": share, **values}
            found.append(Run(labels, Specification(study.model, values, indenter, protocol)))
    return found


DESIGNS = {"identifiability": Design(runs)}


def covariance(time: np.ndarray, depth: np.ndarray, site: float = SITE, noise: float = NOISE) -> np.ndarray:
    """Return the covariance (n, n) of the mean of one test's replicates [nm^2], as in the virtual laboratory."""
    points = noise**2 * np.exp(-np.abs(time[:, None] - time) / MEMORY)
    return (points + site**2 * np.outer(depth, depth)) / REPLICATES + 1e-8 * np.eye(len(time))


def information(curves: Curves) -> np.ndarray:
    """Return the Fisher information (7, 7) of one test, parameters scaled to their ranges."""
    base = curves.where(moved="")
    slopes = []
    for name in RANGES:
        ahead, behind = (curves.where(moved=name, share=sign * STEP).depth[0] for sign in (1.0, -1.0))
        slopes.append((ahead - behind) / (2 * STEP))
    slope = np.array(slopes).T
    return slope.T @ np.linalg.solve(covariance(base.time[0], base.depth[0]), slope)


def deviations(total: np.ndarray) -> np.ndarray:
    """Return half-widths (7,) of 95 % intervals in units of the range, the other parameters within their ranges.

    As in `palpate.calibration.intervals`, a parameter's own range is taken out of its variance again.
    """
    spread = np.diag(np.linalg.inv(total + 12 * np.eye(len(total))))
    with np.errstate(divide="ignore"):
        return 1.96 / np.sqrt(np.maximum(1 / spread - 12, 0.0))


def by_name(values: np.ndarray) -> dict[str, float]:
    """Return one value a parameter by name."""
    return dict(zip(RANGES, map(float, values), strict=True))


def run(context: Context) -> Outcome:
    """Add the information of the four tests, then that of each extra test."""
    curves, study = context.curves["identifiability"], context.studies["epoxy"]
    each = {test: information(curves.where(test=test)) for test in (*CALIBRATED, *EXTRA)}
    four = np.sum([each[name] for name in CALIBRATED], axis=0)
    widths = {"the four tests": deviations(four)}
    widths |= {f"with {EXTRA[name][0]}": deviations(four + each[name]) for name in EXTRA}
    best = four + each["sphere_step"] + each["step"]
    widths["with both steps, cone and sphere"] = deviations(best)
    fixed = {label: [n for n, w in zip(RANGES, width, strict=True) if w < 0.25] for label, width in widths.items()}
    table: Rows = [
        {
            "tests": label,
            **dict(zip(RANGES, map(float, np.minimum(width, 99.0)), strict=True)),
            "fixed": len(fixed[label]),
        }
        for label, width in widths.items()
    ]
    values, vectors = np.linalg.eigh(four)
    directions: Rows = [{"information": float(value), **by_name(vectors[:, k])} for k, value in enumerate(values)]
    profiles = profile_likelihoods(context, study, widths["the four tests"])
    open_ended = [name for name, part in profiles.items() if min(part["left"], part["right"]) < LIMIT]
    loads = curves.where(test="half_load", moved="").depth[0] / curves.where(test=CALIBRATED[0], moved="").depth[0]
    weak = {"transient_coefficient", "transient_exponent", "retardation_time"}
    unfixed = set(RANGES) - set(fixed["the four tests"])
    rank = {name: float(np.sum(np.log(widths[f"with {EXTRA[name][0]}"]))) for name in EXTRA}
    helper = min(rank, key=lambda name: rank[name])
    gains = set(fixed[f"with {EXTRA[helper][0]}"]) & unfixed
    return Outcome(
        tables={
            "half-width of the 95 per cent interval over the range (fixed below 0.25)": table,
            "eigenvectors of the four tests' information, least informed first": directions,
            "profile likelihood over the surrogates": [
                {"parameter": name, "lower": part["lower"], "upper": part["upper"], "closed": name not in open_ended}
                for name, part in profiles.items()
            ],
        },
        findings=[
            compare(
                "C_t, m_t and t_eps from the four tests",
                "given as 0.24, 0.47, 0.25 without intervals",
                f"not fixed by Fisher information: {', '.join(sorted(unfixed)) or 'none'}; "
                f"profile reaches the range's end: {', '.join(open_ended) or 'none'}",
                not weak & unfixed,
                "the thesis quotes estimates for what its tests leave open",
            ),
            compare(
                "tests at other largest loads",
                "used to validate, as another strain level",
                f"0.5 mN repeats the 1 mN curve: ratio {loads.min():.4f} to {loads.max():.4f}, sqrt(1/2) = 0.7071",
                False,
                "a sharp cone has no length: another load says nothing new of the law (chapter 5 assumes it does)",
            ),
            Finding(
                "the one test that would help most",
                "other tips or other data (chapter 5's closing remarks)",
                f"{EXTRA[helper][0]}: fixes {', '.join(sorted(gains)) or 'nothing'} as well",
                "not in the thesis",
                "it acts on the time scale of t_eps; a sharper cone tells C_t from m_t, for it presses harder",
            ),
        ],
        series={
            "widths": {label: [float(min(w, 99.0)) for w in width] for label, width in widths.items()},
            "names": list(RANGES),
            "profiles": profiles,
        },
    )


def profile_likelihoods(context: Context, study: Study, widths: np.ndarray) -> dict[str, dict[str, Any]]:
    """Return the least chi-square with each parameter held, over its range or 3 `widths`, whichever is less."""
    surrogates = {}
    for name in CALIBRATED:
        snapshots = context.curves[f"epoxy_{name}"].succeeded()
        surrogates[name] = PODRBF(**study.surrogate).fit(snapshots.matrix(study.levels), snapshots.depth)
    values = np.array([[truth(study)[name] for name in study.levels]])
    measured = {name: model.predict(values)[0] for name, model in surrogates.items()}
    times = {name: study.condition(name).protocol.sample_time for name in CALIBRATED}
    total = block_diag(*(covariance(times[name], depth) for name, depth in measured.items()))
    bounds = {name: (min(levels), max(levels)) for name, levels in study.levels.items()}
    fit = WeightedFit(Space(bounds), surrogates, measured, total)
    found = {}
    for name in study.free_parameters:
        reach = 3 * widths[list(RANGES).index(name)] * (RANGES[name][1] - RANGES[name][0])
        middle = truth(study)[name]
        grid = np.linspace(max(bounds[name][0], middle - reach), min(bounds[name][1], middle + reach), PROFILE_POINTS)
        chi = [held_fit(fit, bounds, name, value, values[0]) for value in grid]
        inside = grid[np.array(chi) <= LIMIT]
        found[name] = {
            "values": grid.tolist(),
            "chi_square": chi,
            "left": chi[0],
            "right": chi[-1],
            "truth": float(values[0][list(study.levels).index(name)]),
            "lower": float(inside.min()) if len(inside) else None,
            "upper": float(inside.max()) if len(inside) else None,
        }
    return found


def held_fit(
    fit: WeightedFit, bounds: Mapping[str, tuple[float, float]], name: str, value: float, at: np.ndarray
) -> float:
    """Return the least chi-square with one parameter held at `value`, the search begun at the truth and the middle."""
    space = Space({**bounds, name: (float(value), float(value))})
    held = replace(fit, space=space)
    near = ((at - space.lower) / np.where(space.free, space.extent, 1.0))[space.free]
    u = held.solve([np.clip(near, 0.01, 0.99), np.full(space.dimensions, 0.5)])
    return held.chi_square(held.curves(u))


STUDY = ThesisStudy(
    "identifiability",
    "What the tests fix and what they cannot",
    run,
    designs=("identifiability", *(f"epoxy_{name}" for name in CALIBRATED)),
)
