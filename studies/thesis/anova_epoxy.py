"""Chapter 5: which parameters of the nonlinear Burgers solid decide the curve (L27), and the levels that follow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from palpate.data.study_recordings import observations
from studies.thesis.analysis_of_variance import Anova
from studies.thesis.grids import CALIBRATED, EPOXY_GRIDS, EPOXY_SCREENING
from studies.thesis.level_reduction import level_counts
from studies.thesis.orthogonal_arrays import OrthogonalArray
from studies.thesis.rules import Rule, about, at_most, both, near
from studies.thesis.screening import alias_table, analyses, contribution_table, means_series
from studies.thesis.sobol_indices import total_indices
from studies.thesis.study import Context, Finding, Outcome, Rows, ThesisStudy, compare
from studies.thesis.surrogates import epoxy_surrogate

THESIS = {
    "youngs_modulus": 11.20,
    "steady_coefficient": 32.01,
    "steady_exponent": 44.34,
    "transient_coefficient": 12.42,
    "transient_exponent": 0.03,
    "retardation_time": 0.00,
}
COUNTS = (3, 4, 4, 3, 2, 1)
STEADY = ("steady_coefficient", "steady_exponent")
SHARE = 15.0
Shares = Mapping[str, Sequence[float]]


def run(context: Context) -> Outcome:
    """Analyse the L27 under each of the four conditions; the thesis does not say which one it analysed."""
    study = context.studies["epoxy"]
    measured = observations(study, "virtual")
    design = OrthogonalArray.of("L27", tuple(EPOXY_SCREENING))
    found: dict[str, dict[str, Anova]] = {
        name: analyses(design, context.curves["epoxy_L27"].where(condition=name), measured[name].mean)
        for name in CALIBRATED
    }
    first, last = found[CALIBRATED[0]], found[CALIBRATED[-1]]
    shares = {
        response: {n: [v[response].effects[n].contribution for v in found.values()] for n in THESIS}
        for response in ("mean_square", "max_depth")
    }
    surrogate = epoxy_surrogate(context, CALIBRATED[0])
    counts = {
        (name, response): tuple(level_counts(v[response]).values()) for name, v in found.items() for response in shares
    }
    return Outcome(
        tables={
            f"ANOVA of chapter 5's error, {CALIBRATED[0]}": first["mean_square"].rows(),
            f"ANOVA of chapter 5's error, {CALIBRATED[-1]}": last["mean_square"].rows(),
            f"ANOVA of the largest depth, {CALIBRATED[0]}": first["max_depth"].rows(),
            f"contribution by response, {CALIBRATED[0]}": contribution_table(first, THESIS),
            f"contribution by response, {CALIBRATED[-1]}": contribution_table(last, THESIS),
            "contribution to the error by condition": by_condition(shares["mean_square"]),
            "contribution to the largest depth by condition": by_condition(shares["max_depth"]),
            "levels that follow": [
                {"condition": name, "response": response, "levels": " x ".join(map(str, c)), "points": int(np.prod(c))}
                for (name, response), c in counts.items()
            ],
            "interactions aliased with main effects": alias_table(design),
            "total Sobol indices from the surrogate": total_indices(
                surrogate, study.levels, measured[CALIBRATED[0]].mean, study.seed
            ),
        },
        findings=findings(shares["mean_square"], shares["max_depth"], [counts[n, "mean_square"] for n in CALIBRATED]),
        series={
            "main_effects": means_series(EPOXY_SCREENING, first["mean_square"]),
            "depth_effects": means_series(EPOXY_SCREENING, first["max_depth"]),
            "contributions": {n: shares["mean_square"][n][0] for n in THESIS},
            "depth_contributions": {n: shares["max_depth"][n][0] for n in THESIS},
            "thesis": THESIS,
        },
    )


def by_condition(shares: Shares) -> Rows:
    """Return the contributions of each factor, one column a loading time."""
    return [{"factor": n, **dict(zip(CALIBRATED, values, strict=True))} for n, values in shares.items()]


def findings(error: Shares, depth: Shares, counts: Sequence[tuple[int, ...]]) -> list[Finding]:
    """Judge contributions to the error and to the largest depth, and the levels that follow from the error."""
    steady = [sum(values) for values in zip(*(error[n] for n in STEADY), strict=True)]
    two = all(set(sorted(error, key=lambda n: -error[n][k])[:2]) == set(STEADY) for k in range(len(CALIBRATED)))
    return [
        compare(
            "the steady parameters C_s and m_s decide",
            "32.01 + 44.34 = 76 per cent of the error",
            f"{listed(steady)} of the error at 30, 45, 60, 240 s",
            both(
                Rule("the two largest at every loading time", two),
                near(float(np.mean(steady)), THESIS["steady_coefficient"] + THESIS["steady_exponent"], SHARE),
            ),
            "the error is a distance from a recording and depends on the truth; of the largest depth they make "
            + listed([sum(values) for values in zip(*(depth[n] for n in STEADY), strict=True)]),
        ),
        compare(
            "m_s contributes more than C_s",
            "44.34 against 32.01 per cent",
            "; ".join(f"{listed(error[n])} ({n})" for n in reversed(STEADY)),
            Rule(
                "the larger share to m_s, at one loading time at least",
                any(a > b for a, b in zip(error["steady_exponent"], error["steady_coefficient"], strict=True)),
            ),
            "which of the two leads depends on the truth that the recording has, and on the loading time: m_s gains "
            "as the test gets slower",
        ),
        compare(
            "C_t contributes",
            "12.42 per cent",
            f"{listed(error['transient_coefficient'])} of the error",
            about(error["transient_coefficient"], THESIS["transient_coefficient"]),
            "the transient strain is a few per cent of the steady one at these pressures, and the thesis' own "
            "one-at-a-time study finds C_t insignificant. In the L27 the columns of E and of C_t each carry half of "
            "the interaction C_s x m_s, so part of both shares is that interaction",
        ),
        compare(
            "t_eps contributes nothing",
            "0.00 per cent (p 0.942)",
            f"at most {max(error['retardation_time']):.3f} per cent of the error",
            at_most(error["retardation_time"], 0.05),
            "t_eps is a hundredth of the loading time or less",
        ),
        compare(
            "levels after the analysis",
            " x ".join(map(str, COUNTS)) + " = 288 points",
            "; ".join(
                f"{' x '.join(map(str, count))} ({int(name[-3:])} s)"
                for name, count in zip(CALIBRATED, counts, strict=True)
            ),
            Rule("as many levels of each parameter, at one loading time at least", COUNTS in counts),
            "the rule that turns the thesis' two tables into its two grids, applied to our tables of the same error",
        ),
    ]


def listed(values: Sequence[float]) -> str:
    """Return shares as they are printed."""
    return ", ".join(f"{value:.1f}" for value in values) + " per cent"


STUDY = ThesisStudy(
    "anova_epoxy",
    "Analysis of variance, epoxy (chapter 5, L27)",
    run,
    designs=("epoxy_L27", EPOXY_GRIDS[CALIBRATED[0]]),
    recordings=("epoxy",),
)
