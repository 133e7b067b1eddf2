"""Kernels, shape, noise, spectrum and the map of leave-one-out errors of chapter 4's surrogate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palpate.base.parameters import in_words
from palpate.output.figures.paper_figure import PaperFigure
from palpate.output.figures.style import BASE, RECORDED, SERIES, SIMULATED, SMALLEST

LIGHT = BASE["color"]
SHORT = {"linear": "LS", "cubic": "CS", "multiquadric": "MQ", "gaussian": "GS", "inverse_multiquadric": "IMQ"}
LOOKS = {
    "linear": ("0.6", "v"),
    "cubic": (SERIES[1], "^"),
    "multiquadric": (RECORDED, "o"),
    "gaussian": (SIMULATED, "s"),
    "inverse_multiquadric": (LIGHT, "D"),
}
BARS = {
    ("64", "one mode"): "0.75",
    ("36", "one mode"): RECORDED,
    ("64", "all modes"): LIGHT,
    ("36", "all modes"): SIMULATED,
}
THESIS = (5.31e8, 4.35e5, 1.21e4, 5.66e3, 3.22e3, 2.12e3)  # eigenvalues that it prints [nm^2]
MODES = 12  # of the spectrum
KEYS = ["snapshots", "modes", "kernel"]


def table(outcome: Mapping[str, Any]) -> pd.DataFrame:
    """Return the numbers of all panels, each row with the name of its panel."""
    series = outcome["series"]
    kernels = pd.DataFrame(series["kernels"])[[*KEYS, "midpoint_percent"]]
    noise = pd.DataFrame(series["noise"]).melt(["snapshots", "kernel"], var_name="noise", value_name="midpoint_percent")
    noise["noise_percent"] = noise.pop("noise").str.extract(r"noise_(\d+)", expand=False).astype(float)
    shapes = pd.DataFrame(series["shapes"])
    scaled = [
        shapes[["modes", "shape"]].assign(
            kernel=kernel,
            midpoint_percent=shapes[f"{kernel}_percent"],
            condition_number=shapes[f"{kernel}_condition"],
        )
        for kernel in ("multiquadric", "gaussian", "inverse_multiquadric")
    ]
    printed = pd.DataFrame(series["printed_shapes"])[["shape", "gaussian_percent"]].assign(modes="as printed")
    scaled.append(printed.rename(columns={"gaussian_percent": "midpoint_percent"}).assign(kernel="gaussian"))
    values = {grid: found["eigenvalues"][:MODES] for grid, found in series["spectra"].items()} | {"thesis": THESIS}
    spectra = [
        pd.DataFrame({"snapshots": grid, "mode": range(1, len(row) + 1), "eigenvalue_nm2": row})
        for grid, row in values.items()
    ]
    grid = series["map"]
    errors = pd.DataFrame(grid["percent"], grid["youngs_modulus"], grid["yield_stress"]).rename_axis("youngs_modulus")
    errors = errors.reset_index().melt("youngs_modulus", var_name="yield_stress", value_name="left_out_percent")
    panels = {"kernels": [kernels], "noise": [noise], "spectrum": spectra, "shapes": scaled, "map": [errors]}
    return pd.concat([part.assign(panel=name) for name, parts in panels.items() for part in parts], ignore_index=True)


def draw(figure: Figure, frame: pd.DataFrame) -> None:
    """Draw six panels."""
    figure.set_figheight(4.8)
    axes = figure.subplots(2, 3)
    panels = dict(list(frame.groupby("panel")))
    _kernels(axes[0, 0], panels["kernels"])
    _noise(axes[0, 1], panels["noise"])
    _spectrum(axes[0, 2], panels["spectrum"])
    _shapes(axes[1, 0], axes[1, 1], panels["shapes"])
    _map(figure, axes[1, 2], panels["map"])


def _kernels(axis: Axes, rows: pd.DataFrame) -> None:
    for k, ((grid, modes), colour) in enumerate(BARS.items()):
        own = rows[(rows["snapshots"] == grid) & (rows["modes"] == modes)].set_index("kernel").loc[list(SHORT)]
        places = np.arange(len(SHORT)) + 0.2 * (k - 1.5)
        axis.bar(places, own["midpoint_percent"], 0.18, color=colour, label=f"{grid}, {modes}")
    axis.set_xticks(range(len(SHORT)), SHORT.values())
    axis.set(ylabel="error at mid-points [%]", title="kernels, shape 0.5")
    axis.legend()


def _noise(axis: Axes, rows: pd.DataFrame) -> None:
    for (grid, kernel), own in rows.groupby(["snapshots", "kernel"]):
        colour, marker = LOOKS[str(kernel)]
        style, label = ("-", SHORT[str(kernel)]) if grid == "36" else ("--", None)
        look = {"color": colour, "marker": marker, "ms": 3, "lw": 0.9, "label": label}
        axis.plot(own["noise_percent"], own["midpoint_percent"], style, **look)
    axis.set(xlabel="noise on training data [%]", ylabel="error at mid-points [%]", title="noise", ylim=(0, None))
    axis.legend(ncols=2)


def _spectrum(axis: Axes, rows: pd.DataFrame) -> None:
    looks = {"64": (RECORDED, "o-"), "36": (LIGHT, "D--"), "thesis": (SIMULATED, "x")}
    for grid, (colour, style) in looks.items():
        own = rows[rows["snapshots"] == grid]
        label = grid if grid == "thesis" else f"{grid} points"
        axis.semilogy(own["mode"], own["eigenvalue_nm2"], style, ms=3, color=colour, label=label)
    axis.set(xlabel="mode", ylabel="eigenvalue [nm²]", title="spectrum of the snapshots")
    axis.legend()


def _shapes(left: Axes, right: Axes, rows: pd.DataFrame) -> None:
    styles = {"one mode": "-", "all modes": "--", "as printed": ":"}
    for (kernel, modes), own in rows.groupby(["kernel", "modes"]):
        colour, marker = LOOKS[str(kernel)]
        look = {"marker": marker, "ms": 3, "color": colour}
        left.plot(own["shape"], own["midpoint_percent"], styles[str(modes)], **look)
        if modes == "all modes":
            right.semilogy(own["shape"], own["condition_number"], "-", label=SHORT[str(kernel)], **look)
    left.set(ylabel="error at mid-points [%]", title="shape, 36 points", ylim=(0, None), xlabel="shape parameter c")
    for modes, style in styles.items():
        left.plot([], [], style, color="0.3", label=modes)
    left.legend()
    right.set(ylabel="condition number", title="shape, 36 points", xlabel="shape parameter c")
    right.legend()


def _map(figure: Figure, axis: Axes, rows: pd.DataFrame) -> None:
    values = rows.pivot_table("left_out_percent", "youngs_modulus", "yield_stress")
    image = axis.imshow(values, origin="lower", cmap="Greys", vmin=0, aspect="auto")
    for (i, k), value in np.ndenumerate(values.to_numpy()):
        colour = "white" if value > 0.6 * values.to_numpy().max() else "black"
        axis.text(k, i, f"{value:.1f}", ha="center", va="center", fontsize=SMALLEST, color=colour)
    axis.set_xticks(range(values.shape[1]), [f"{value:g}" for value in values.columns])
    axis.set_yticks(range(values.shape[0]), [f"{value:g}" for value in values.index])
    axis.set(xlabel=r"$\sigma_Y$ [GPa]", ylabel="E [GPa]", title="leave-one-out error [%]")
    figure.colorbar(image, ax=axis, shrink=0.8)


def caption(frame: pd.DataFrame) -> str:
    """Return what is drawn."""
    return (
        "Surrogates of aluminium with linear (LS), cubic (CS), multiquadric (MQ), Gaussian (GS) and inverse "
        "multiquadric (IMQ) kernels. Above: error at mid-points of the grids of 64 and 36 snapshots by kernel and "
        "number of modes; the same under noise (solid 36, dashed 64 snapshots, one mode); eigenvalues of the "
        "snapshots. Below: error and condition number over the shape parameter; leave-one-out error over modulus and "
        "yield stress, 64 snapshots, multiquadric."
    )


def seen(frame: pd.DataFrame) -> str:
    """Return the best kernel on each grid."""
    rows = frame[frame["panel"] == "kernels"]
    best = rows.sort_values("midpoint_percent").drop_duplicates("snapshots")[[*KEYS, "midpoint_percent"]]
    texts = (
        f"{in_words(kernel)} kernel, {modes}, {error:.2g} % on {grid} snapshots"
        for grid, modes, kernel, error in best.itertuples(index=False)
    )
    return f"Smallest errors at mid-points: {'; '.join(texts)}."


FIGURE = PaperFigure("rbf", "Radial kernels, shape and noise", table, draw, caption, seen, of_study=True)
