r"""Which parameters the thesis' four tests fix, which they cannot, and which extra test would.

With the slopes G of the curves (central differences of the solver over 5 % of the ranges, parameters scaled to them)
and the covariance C of the mean recordings, the Fisher information of a test is G^T C^-1 G; tests add. What is known
beforehand is that each parameter lies in its range (variance 1/12). A parameter counts as fixed when its 95 %
interval is narrower than half its range, the tool's own rule. Profile likelihoods of the four tests over the solver
itself, with the curve of the truth in place of recordings, show what the quadratic approximation misses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from palpate.configuration.study_file import Study
from palpate.solver.simulation import simulate_batch
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification
from studies.thesis.grids import CALIBRATED, EPOXY_SCREENING, Outcomes, Studies, ranges
from studies.thesis.profiles import profile
from studies.thesis.rules import Rule
from studies.thesis.runs import Curves, Design, Run
from studies.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy, compare

RANGES = ranges(EPOXY_SCREENING) | {"poisson_ratio": (0.25, 0.45)}
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
OFFSETS = (-1.8, -1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.2, 1.8)
LIMIT = 3.84
Fixed = Mapping[str, Sequence[str]]


def truth(study: Study) -> dict[str, float]:
    """Return the true parameters, Poisson's ratio among them."""
    return {**study.laboratory["virtual"].parameters, "poisson_ratio": study.fixed["poisson_ratio"]}


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
            found.append(Run(labels, Specification(study.model, values, indenter, protocol, kinematics="small")))
    return found


DESIGNS = {"identifiability": Design(runs)}


def covariance(time: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the covariance (n, n) of the mean of one test's replicates [nm^2], as in the virtual laboratory."""
    points = NOISE**2 * np.exp(-np.abs(time[:, None] - time) / MEMORY)
    return (points + SITE**2 * np.outer(depth, depth)) / REPLICATES + 1e-8 * np.eye(len(time))


def slopes(curves: Curves) -> np.ndarray:
    """Return the slope (n, 7) of one test's curve, parameters scaled to their ranges."""
    columns = []
    for name in RANGES:
        ahead, behind = (curves.where(moved=name, share=sign * STEP).depth[0] for sign in (1.0, -1.0))
        columns.append((ahead - behind) / (2 * STEP))
    return np.array(columns).T


def information(curves: Curves) -> np.ndarray:
    """Return the Fisher information (7, 7) of one test, parameters scaled to their ranges."""
    base, slope = curves.where(moved=""), slopes(curves)
    return slope.T @ np.linalg.solve(covariance(base.time[0], base.depth[0]), slope)


def deviations(total: np.ndarray) -> np.ndarray:
    """Return half-widths (7,) of 95 % intervals in units of the range, the other parameters within their ranges.

    The prior variance of each range is taken out again, so that an interval tells what the tests alone determine.
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
    profiles = profile_likelihoods(curves, study, widths["the four tests"])
    open_ended = [name for name, part in profiles.items() if part["open"]]
    loads = curves.where(test="half_load", moved="").depth[0] / curves.where(test=CALIBRATED[0], moved="").depth[0]
    weak = {"transient_coefficient", "transient_exponent", "retardation_time"}
    unfixed = [name for name in RANGES if name not in fixed["the four tests"]]
    rank = {name: float(np.sum(np.log(widths[f"with {EXTRA[name][0]}"]))) for name in EXTRA}
    helper = min(rank, key=lambda name: rank[name])
    return Outcome(
        tables={
            "half-width of the 95 per cent interval over the range (fixed below 0.25)": table,
            "eigenvectors of the four tests' information, least informed first": directions,
            "profile likelihood over the solver, four tests": [
                {"parameter": name, "lower": part["lower"], "upper": part["upper"], "closed": not part["open"]}
                for name, part in profiles.items()
            ],
            "which extra test fixes what": [
                {"extra test": EXTRA[name][0], "fixes as well": ", ".join(gained(fixed, name, unfixed)) or "nothing"}
                for name in EXTRA
            ],
        },
        findings=[
            compare(
                "C_t, m_t and t_eps from the four tests",
                "given as 0.24, 0.47, 0.25 without intervals",
                f"not fixed by Fisher information: {', '.join(unfixed) or 'none'}; "
                f"profile reaches an end of the range: {', '.join(open_ended) or 'none'}",
                Rule("all three fixed, by information and by profile", not weak & {*unfixed, *open_ended}),
                "the transient strain is small and over within a second; the thesis quotes estimates for what its "
                "tests leave open",
            ),
            compare(
                "tests at other largest loads",
                "used to validate, as another strain level",
                f"0.5 mN repeats the 1 mN curve: ratio {loads.min():.4f} to {loads.max():.4f}, sqrt(1/2) = 0.7071",
                Rule("the ratio departs from sqrt(1/2) by more than 0.1 per cent", _departs(loads)),
                "a sharp cone has no length: another load says nothing new of the law (chapter 5 assumes it does)",
            ),
            Finding(
                "the one test that would help most",
                "other tips or other data (chapter 5's closing remarks)",
                f"{EXTRA[helper][0]}: fixes {', '.join(gained(fixed, helper, unfixed)) or 'nothing'} as well",
                "not in the thesis",
                "; ".join(
                    f"{name}: fixed by {' or '.join(fixers(fixed, name)) or 'none of them alone'}" for name in unfixed
                ),
            ),
        ],
        series={
            "widths": {label: [float(min(w, 99.0)) for w in width] for label, width in widths.items()},
            "names": list(RANGES),
            "profiles": profiles,
        },
    )


def gained(fixed: Fixed, extra: str, unfixed: Sequence[str]) -> list[str]:
    """Return the parameters that one extra test fixes beside those that the four tests fix."""
    return [name for name in unfixed if name in fixed[f"with {EXTRA[extra][0]}"]]


def fixers(fixed: Fixed, name: str) -> list[str]:
    """Return the extra tests that fix a parameter."""
    return [text for text, _, _ in EXTRA.values() if name in fixed[f"with {text}"]]


def _departs(ratio: np.ndarray) -> bool:
    return bool(np.abs(ratio / np.sqrt(0.5) - 1).max() > 1e-3)


def profile_likelihoods(curves: Curves, study: Study, widths: np.ndarray) -> dict[str, dict[str, Any]]:
    """Return the least chi-square with each of the seven held, to both sides of the truth by shares of its interval."""
    low, high = np.array(list(RANGES.values())).T
    middle = (np.array([truth(study)[name] for name in RANGES]) - low) / (high - low)
    base = {name: curves.where(test=name, moved="") for name in CALIBRATED}
    factors = {name: cholesky(covariance(part.time[0], part.depth[0]), lower=True) for name, part in base.items()}
    jacobian = np.vstack(
        [solve_triangular(factors[name], slopes(curves.where(test=name)), lower=True) for name in CALIBRATED]
    )

    def residuals(points: np.ndarray) -> np.ndarray:
        values = [dict(zip(RANGES, map(float, row), strict=True)) for row in low + points * (high - low)]
        parts = []
        for name in CALIBRATED:
            protocol = study.condition(name).protocol
            found = simulate_batch(
                Specification(study.model, row, CONE, protocol, kinematics="small") for row in values
            )
            depth = np.array([one.depth if one.status == "ok" else np.full(len(one.depth), np.nan) for one in found])
            parts.append(
                solve_triangular(factors[name], (depth - base[name].depth).T, lower=True, check_finite=False).T
            )
        return np.hstack(parts)

    grids = [
        np.unique(np.clip(at + np.array(OFFSETS) * width, 0.0, 1.0)) for at, width in zip(middle, widths, strict=True)
    ]
    found = {}
    for k, (name, chi) in enumerate(zip(RANGES, profile(middle, jacobian, grids, residuals), strict=True)):
        values = low[k] + grids[k] * (high[k] - low[k])
        inside = values[chi <= LIMIT]
        found[name] = {
            "values": values.tolist(),
            "chi_square": chi.tolist(),
            "truth": truth(study)[name],
            "open": bool(min(chi[0], chi[-1]) <= LIMIT),
            "lower": _crossing(values[::-1], chi[::-1], inside.min()),
            "upper": _crossing(values, chi, inside.max()),
        }
    return found


def _crossing(values: np.ndarray, chi: np.ndarray, last: float) -> float:
    """Return where chi-square crosses the limit beyond the `last` value inside, by linear interpolation."""
    k = int(np.flatnonzero(values == last)[0])
    if k + 1 == len(values):
        return float(last)
    share = (LIMIT - chi[k]) / (chi[k + 1] - chi[k])
    return float(values[k] + share * (values[k + 1] - values[k]))


STUDY = ThesisStudy(
    "identifiability",
    "What the tests fix and what they cannot",
    run,
    designs=("identifiability",),
)
