"""Kernels, shape, noise, spectrum and the map of leave-one-out errors of chapter 4's surrogate."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from palpate.output.figures.style import DOUBLE_COLUMN, RECORDED, SIMULATED, SURROGATE, TRUTH, save, styled, subplots

SHORT = {
    "linear": "LS",
    "cubic": "CS",
    "multiquadric": "MQ",
    "gaussian": "GS",
    "inverse_multiquadric": "IMQ",
}
COLOURS = {"multiquadric": RECORDED, "gaussian": SIMULATED, "inverse_multiquadric": SURROGATE}


@styled
def draw(outcome: Mapping[str, Any], path: str | Path) -> None:
    """Draw six panels."""
    series = outcome["series"]
    figure, axes = subplots(2, 3, figsize=(DOUBLE_COLUMN, 4.6))
    _kernels(axes[0, 0], series["kernels"])
    _noise(axes[0, 1], series["noise"])
    _spectrum(axes[0, 2], series["spectra"])
    _shapes(axes[1, 0], axes[1, 1], series["shapes"], series["printed_shapes"])
    _map(figure, axes[1, 2], series["map"])
    save(figure, path)


def _kernels(axis, rows) -> None:
    for k, (grid, modes, colour) in enumerate(
        (
            ("64", "one mode", "0.6"),
            ("36", "one mode", RECORDED),
            ("64", "all modes", "#9dbbd6"),
            ("36", "all modes", SURROGATE),
        )
    ):
        values = [
            next(r for r in rows if (r["snapshots"], r["modes"], r["kernel"]) == (grid, modes, kernel))
            for kernel in SHORT
        ]
        places = np.arange(len(SHORT)) + 0.2 * (k - 1.5)
        axis.bar(places, [r["midpoint_percent"] for r in values], 0.18, color=colour, label=f"{grid}, {modes}")
    axis.set_xticks(range(len(SHORT)), SHORT.values())
    axis.set_ylabel("error at mid-points [%]")
    axis.legend(fontsize=6)
    axis.set_title("kernels, shape 0.5")


def _noise(axis, rows) -> None:
    for grid, style in (("64", "--"), ("36", "-")):
        for kernel, short in SHORT.items():
            row = next(r for r in rows if (r["snapshots"], r["kernel"]) == (grid, kernel))
            values = [row[f"noise_{level}_percent"] for level in (0, 1, 5)]
            axis.plot([0, 1, 5], values, style, color=COLOURS.get(kernel, TRUTH), lw=0.9)
            if grid == "36":
                axis.annotate(short, (5, values[-1]), fontsize=6, xytext=(3, 0), textcoords="offset points")
    axis.set_xlabel("noise on training data [%]")
    axis.set_ylabel("error at mid-points [%]")
    axis.set_ylim(bottom=0)
    axis.set_title("noise (solid 36, dashed 64 points)")


def _spectrum(axis, spectra) -> None:
    for grid, colour in (("64", RECORDED), ("36", SURROGATE)):
        values = spectra[grid]["eigenvalues"][:12]
        axis.semilogy(range(1, len(values) + 1), values, "o-", ms=3, color=colour, label=f"{grid} points")
    axis.semilogy(range(1, 7), [5.31e8, 4.35e5, 1.21e4, 5.66e3, 3.22e3, 2.12e3], "x", color=SIMULATED, label="thesis")
    axis.set_xlabel("mode")
    axis.set_ylabel("eigenvalue [nm²]")
    axis.legend(fontsize=7)
    axis.set_title("spectrum of the snapshots")


def _shapes(left, right, rows, printed) -> None:
    for kernel, colour in COLOURS.items():
        for modes, style in (("one mode", "-"), ("all modes", "--")):
            own = [r for r in rows if r["modes"] == modes]
            left.plot(
                [r["shape"] for r in own], [r[f"{kernel}_percent"] for r in own], style, marker="o", ms=3, color=colour
            )
        right.semilogy(
            [r["shape"] for r in own],
            [r[f"{kernel}_condition"] for r in own],
            "o-",
            ms=3,
            color=colour,
            label=SHORT[kernel],
        )
    left.plot(
        [r["shape"] for r in printed],
        [r["gaussian_percent"] for r in printed],
        ":",
        marker="s",
        ms=3,
        color=COLOURS["gaussian"],
        label="GS as printed",
    )
    left.legend(fontsize=7)
    left.set_ylim(bottom=0)
    left.set_ylabel("error at mid-points [%]")
    left.set_title("36 points (solid one mode, dashed all)")
    right.set_ylabel("condition number")
    right.legend(fontsize=7)
    right.set_title("36 points")
    for axis in (left, right):
        axis.set_xlabel("shape parameter c")


def _map(figure, axis, grid) -> None:
    values = np.array(grid["percent"])
    image = axis.imshow(values, origin="lower", cmap="Greys", vmin=0, aspect="auto")
    for i, row in enumerate(values):
        for k, value in enumerate(row):
            axis.text(
                k,
                i,
                f"{value:.1f}",
                ha="center",
                va="center",
                fontsize=7,
                color="white" if value > 0.6 * values.max() else "black",
            )
    axis.set_xticks(range(values.shape[1]), [f"{v:g}" for v in grid["yield_stress"]])
    axis.set_yticks(range(values.shape[0]), [f"{v:g}" for v in grid["youngs_modulus"]])
    axis.set_xlabel(r"$\sigma_Y$ [GPa]")
    axis.set_ylabel("E [GPa]")
    axis.set_title("leave-one-out error [%], 64 points, MQ")
    figure.colorbar(image, ax=axis, shrink=0.8)
