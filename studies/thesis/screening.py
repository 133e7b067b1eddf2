"""What both analyses of variance share: responses, tables, and which interactions hide where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from palpate.data.measures import OBJECTIVES
from studies.thesis.analysis_of_variance import Anova, anova
from studies.thesis.orthogonal_arrays import OrthogonalArray
from studies.thesis.runs import Curves
from studies.thesis.study import Rows


def responses(curves: Curves, recorded: np.ndarray) -> dict[str, np.ndarray]:
    """Return every response (n,) of curves to be compared with a recorded one (points,)."""
    errors = {name: measure(recorded, curves.depth) for name, measure in OBJECTIVES.items()}
    return {**errors, "max_depth": curves.max_depth, "residual_depth": curves.residual_depth}


def analyses(design: OrthogonalArray, curves: Curves, recorded: np.ndarray) -> dict[str, Anova]:
    """Return the analysis of variance of every response."""
    return {name: anova(design, values) for name, values in responses(curves, recorded).items()}


def contribution_table(found: Mapping[str, Anova], thesis: Mapping[str, float]) -> Rows:
    """Return per cent contributions of each factor, one column a response, beside the thesis'."""
    return [
        {"factor": name, "thesis_percent": thesis.get(name)}
        | {f"{response}_percent": analysis.effects[name].contribution for response, analysis in found.items()}
        for name in [*thesis, "error"]
    ]


def alias_table(design: OrthogonalArray) -> Rows:
    """Return, for each factor, the interactions that its main effect carries and their share."""
    return [
        {
            "main_effect": name,
            "carries": ", ".join(f"{a} x {b} ({100 * share:.0f} %)" for a, b, share in hidden) or "none",
        }
        for name, hidden in design.aliases().items()
    ]


def means_series(levels: Mapping[str, Sequence[float]], analysis: Anova) -> dict[str, dict[str, list[float]]]:
    """Return the main effects for the figure: levels and mean responses of each factor."""
    return {name: {"levels": list(levels[name]), "means": list(analysis.means[name])} for name in levels}
