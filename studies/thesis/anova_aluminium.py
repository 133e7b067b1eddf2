"""Chapter 4: which parameter of bilinear plasticity decides the curve (modified L16), and the levels that follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from palpate.data.study_recordings import observations
from palpate.surrogate import PODRBF
from studies.thesis.analysis_of_variance import anova
from studies.thesis.fitted import Fitted
from studies.thesis.grids import ALUMINIUM
from studies.thesis.level_reduction import reduce_levels
from studies.thesis.orthogonal_arrays import OrthogonalArray
from studies.thesis.rules import Rule, about, near
from studies.thesis.runs import Curves
from studies.thesis.screening import alias_table, analyses, contribution_table, means_series, responses
from studies.thesis.sobol_indices import total_indices
from studies.thesis.study import Context, Outcome, Rows, ThesisStudy, compare

THESIS = {"youngs_modulus": 1.70, "yield_stress": 87.14, "hardening": 5.60}
SQUARES = 268843
COUNTS = {"youngs_modulus": 3, "yield_stress": 4, "hardening": 3}
SHARE = 15.0


def run(context: Context) -> Outcome:
    """Analyse the L16 against the synthetic recording, and against every other truth that it might have had."""
    study, curves = context.studies["aluminium"], context.curves["aluminium_L16"]
    full = context.curves["aluminium_full"].where(role="training")
    design = OrthogonalArray.of("L16", tuple(study.levels))
    recorded = observations(study, "virtual")[ALUMINIUM[0]].mean
    found = analyses(design, curves, recorded)
    reduced = reduce_levels(study.levels, found["relative"])
    by_depth = reduce_levels(study.levels, found["max_depth"])
    by_truth = truth_table(design, curves, full.succeeded())
    snapshots = full.succeeded().matrix(study.levels), full.succeeded().depth
    surrogate = PODRBF(shape="loo").fit(*snapshots)
    sobol = total_indices(surrogate, study.levels, recorded, study.seed)
    contributions = {name: found["relative"].effects[name].contribution for name in THESIS}
    depth = {name: found["max_depth"].effects[name].contribution for name in THESIS}
    shown = ", ".join(f"{name} {contributions[name]:.2f}" for name in THESIS)
    counts = {name: len(values) for name, values in reduced.items()}
    middle, total = by_truth[0], {row["parameter"]: row for row in sobol}
    own = total["youngs_modulus"]["error_total_percent"]
    return Outcome(
        tables={
            "ANOVA of chapter 4's error": found["relative"].rows(),
            "ANOVA of the largest depth": found["max_depth"].rows(),
            "contribution by response": contribution_table(found, THESIS),
            "contribution of the yield stress over 64 possible truths": by_truth,
            "interactions aliased with main effects": alias_table(design),
            "total Sobol indices from the surrogate": sobol,
            "levels that follow": [
                {
                    "parameter": name,
                    "from_the_error": levels_of(reduced[name]),
                    "from_the_depth": levels_of(by_depth[name]),
                }
                for name in reduced
            ],
        },
        findings=[
            compare(
                "the yield stress decides, per cent of the error's variance",
                "E 1.70, yield stress 87.14, hardening 5.60",
                shown,
                near(contributions["yield_stress"], THESIS["yield_stress"], SHARE),
                "the error is a distance from a recording, so its ANOVA depends on the truth: over 64 truths the yield "
                f"stress contributes {middle['least']:.0f} to {middle['largest']:.0f} per cent",
            ),
            compare(
                "hardening matters more than E",
                "5.60 against 1.70 per cent",
                f"error {contributions['hardening']:.2f} against {contributions['youngs_modulus']:.2f}, largest depth "
                f"{depth['hardening']:.2f} against {depth['youngs_modulus']:.2f} per cent",
                Rule("the larger share to the hardening", contributions["hardening"] > contributions["youngs_modulus"]),
                f"with all interactions (total Sobol index) E makes {own:.2f} per cent of the error: what the L16 "
                "books as E's is the interaction of yield stress and hardening, which its column carries",
            ),
            compare(
                "sum of squares of the yield stress",
                f"{SQUARES} for a relative error",
                f"{found['relative'].effects['yield_stress'].square:.3g} for the relative error, "
                f"{found['max_depth'].effects['yield_stress'].square:.0f} nm2 for the largest depth",
                about(found["relative"].effects["yield_stress"].square, SQUARES),
                "a relative error cannot have so large a sum of squares: the thesis' table is of an error in nm",
            ),
            compare(
                "levels after the analysis",
                "3 x 4 x 3 = 36 points (E, yield stress, hardening)",
                " x ".join(str(counts[name]) for name in THESIS) + f" = {np.prod(list(counts.values()))} points",
                Rule("as many levels of each parameter", counts == COUNTS),
                "by the rule of studies.thesis.level_reduction; from the ANOVA of the largest depth, E would be held",
            ),
        ],
        series={
            "reduced_levels": reduced,
            "main_effects": means_series(study.levels, found["relative"]),
            "depth_effects": means_series(study.levels, found["max_depth"]),
            "contributions": contributions,
            "depth_contributions": depth,
            "thesis": THESIS,
        },
        fitted=[Fitted.surrogate("aluminium, 64 points, shape by leave-one-out", surrogate, *snapshots)],
    )


def levels_of(values: Sequence[float]) -> str:
    """Return levels as they are printed."""
    return ", ".join(f"{value:g}" for value in values)


def truth_table(design: OrthogonalArray, curves: Curves, truths: Curves) -> Rows:
    """Return, for both errors, the least, median and largest contribution of the yield stress over possible truths."""
    rows = []
    for measure in ("relative", "mean_square"):
        shares = [
            anova(design, responses(curves, truth)[measure]).effects["yield_stress"].contribution
            for truth in truths.depth
        ]
        rows.append(
            {
                "error": measure,
                "least": float(np.min(shares)),
                "median": float(np.median(shares)),
                "largest": float(np.max(shares)),
            }
        )
    return rows


STUDY = ThesisStudy(
    "anova_aluminium",
    "Analysis of variance, aluminium (chapter 4, modified L16)",
    run,
    designs=("aluminium_L16", "aluminium_full"),
    recordings=("aluminium",),
)
