"""The explanations that were fitted: log evidence of each relative to the base model."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.mechanisms import MECHANISMS
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import SIMULATED
from palpate.output.saved_set import SavedSet

MOST = 9  # explanations that are drawn


def table(saved: SavedSet) -> pd.DataFrame | None:
    """Return the explanations of `of_tried`; None where the base model alone was fitted."""
    return of_tried(saved) if saved.diagnosis and len(saved.diagnosis["tried"]) > 1 else None


def of_tried(saved: SavedSet) -> pd.DataFrame:
    """Return one row an explanation, best first, of many the best and the base model.

    Columns are explanation, log evidence relative to the base model and to the best one, error [nm], whether it was
    accepted, and how many were tried.
    """
    assert saved.diagnosis is not None
    every = saved.diagnosis["tried"]
    drawn, later = every[:MOST], [entry for entry in every[MOST:] if not entry["mechanisms"]]
    base = next((entry["log_evidence"] for entry in every if not entry["mechanisms"]), 0.0)
    adequate: list[list[str]] = [[]] if saved.diagnosis["verdict"] == "adequate" else []
    accepted = adequate + [candidate["mechanisms"] for candidate in saved.accepted]
    return pd.DataFrame(
        {
            "explanation": titles(entry["mechanisms"]),
            "over_base": entry["log_evidence"] - base,
            "behind_best": entry["log_evidence"] - every[0]["log_evidence"],
            "rmse_nm": entry["rmse_nm"],
            "accepted": entry["mechanisms"] in accepted,
            "tried": len(every),
        }
        for entry in ([*drawn[:-1], *later] if later else drawn)
    )


def titles(mechanisms: list[str]) -> str:
    """Return a set of mechanisms in words."""
    return " + ".join(MECHANISMS[key].title for key in mechanisms) or "base model"


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw a bar an explanation."""
    lines = [1 + name.count(" + ") for name in frame["explanation"]]
    figure.set_figheight(0.75 + 0.16 * sum(lines) + 0.09 * len(lines))
    bars(figure.subplots(), frame)


def bars(axis: Axes, frame: pd.DataFrame) -> None:
    """Draw a bar an explanation on given axes; accepted ones are dark, with the distance to the best at the right."""
    names = [name.replace(" + ", "\n+ ") for name in frame["explanation"]]
    for k, row in enumerate(frame.to_dict("records")):
        look = {"color": SIMULATED} if row["accepted"] else {"color": "0.8", "edgecolor": "0.5", "linewidth": 0.5}
        axis.barh(k, row["over_base"], height=0.7, **look)
        axis.text(
            1.01,
            k,
            f"{row['behind_best']:.1f}".replace("-", "−"),
            transform=axis.get_yaxis_transform(),
            va="center",
            fontsize=7,
        )
    axis.text(1.01, -0.9, "rel. to best", transform=axis.get_yaxis_transform(), va="center", fontsize=7)
    axis.axvline(0, color="0.4", lw=0.6)
    axis.set_ylim(len(frame) - 0.4, -1.2)
    axis.set_yticks(range(len(names)), names, linespacing=0.95)
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)
    axis.set_xlabel("log evidence relative to the base model")


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    count = int(frame["tried"].iloc[0])
    which = f"The best {len(frame)} of {count} explanations" if count > len(frame) else f"The {count} explanations"
    accepted = "Dark bars are accepted" if frame["accepted"].any() else "None is accepted"
    return (
        f"{which} that were fitted, the most probable first: log evidence relative to the base model; numbers at the "
        f"right are relative to the best. {accepted}. A probability also counts the prior, which falls with the number "
        "of effects, and an effect below the smallest one that counts as none."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the best explanation and its distance to the next one."""
    best, after = frame.iloc[0], frame.iloc[1]
    return (
        f"The best explanation is {best['explanation']}, {best['over_base']:.1f} above the base model in log evidence; "
        f"next is {after['explanation']}, {-after['behind_best']:.1f} behind."
    )


FIGURE = PaperFigure("explanations", "Explanations that were fitted", table, draw, caption, seen)
