"""Epoxy from end to end: residuals of all tests in time, and parameters with intervals over their ranges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import ACCEPTED, RECORDED, SIMULATED, SMALLEST
from studies.thesis.figures.estimates import EPOXY, interval, ranged

SYMBOLS = {**EPOXY, "youngs_modulus": "E [GPa]"}
LOOKS: dict[str, dict[str, Any]] = {"calibrate": ACCEPTED, "validate": {**ACCEPTED, "color": RECORDED}}
ROLES = {"calibrate": "fitted", "validate": "held out"}


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return one row a point of the residuals of each test, then one a parameter with interval, truth and range."""
    series = outcome["series"]
    errors = {row["condition"]: row for row in outcome["tables"]["errors of every test"]}
    tests = [
        pd.DataFrame({"condition": name, "role": part["role"], "time_s": part["time"], "residual_nm": part["misfit"]})
        .assign(rmse_nm=errors[name]["rmse_nm"], thesis_rmse_nm=errors[name]["thesis_rmse_nm"])
        for name, part in series["misfit"].items()
    ]  # fmt: skip
    return pd.concat([*tests, ranged(outcome["tables"]["parameters"], series["levels"])], ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw one panel a test above, one a parameter below."""
    figure.set_figheight(4.8)
    top, bottom = figure.subfigures(2, 1, height_ratios=[3, 1], squeeze=False)[:, 0]
    tests = list(frame[frame["time_s"].notna()].groupby("condition", sort=False))
    for axis, (name, part) in zip(top.subplots(2, 4, sharey=True).ravel(), tests, strict=True):
        test = part.iloc[0]
        axis.plot(part["time_s"], part["residual_nm"], **LOOKS[test["role"]])
        axis.axhline(0, color="0.7", lw=0.6)
        error = f"{test['rmse_nm']:.1f} nm (thesis {test['thesis_rmse_nm']:.1f})"
        axis.set_title(f"{name}, {ROLES[test['role']]}\n{error}", fontsize=SMALLEST)
        axis.set_xlabel("time [s]")
    top.supylabel("simulated less recorded depth [nm]", fontsize=SMALLEST)
    parameters = frame[frame["parameter"].notna()]
    for axis, (_, row) in zip(bottom.subplots(1, len(parameters)), parameters.iterrows(), strict=True):
        interval(axis, row, 0, SIMULATED)
        axis.set_yticks([])
        axis.locator_params(axis="x", nbins=3)
        axis.set_xlabel(SYMBOLS[row["parameter"]])


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Epoxy, calibrated on four loading times. Above: simulated less recorded depth of the fitted and the held-out "
        "tests, with the root mean square error and that of the thesis. Below: estimates with 95 % intervals over the "
        "ranges searched; open symbols: not identified; dashed: true value."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the errors of the tests by their role."""
    errors = frame.groupby("role")["rmse_nm"].agg(["min", "max"])
    texts = (f"{ROLES[role]} {low:.2g} to {high:.2g} nm" for role, low, high in errors.itertuples())
    return f"Root mean square errors: {', '.join(texts)}."


FIGURE = PaperFigure("epoxy", "Epoxy: calibration and held-out tests", table, draw, caption, seen)
