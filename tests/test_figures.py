"""Figures name what they show, with its unit."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from palpate.materials import LAWS
from palpate.output.figures import estimates_figure, explained_curves, search_history
from palpate.output.figures.style import SERIES

RANGES = {"youngs_modulus": [3.0, 4.0], "steady_coefficient": [0.1, 0.2], "transient_exponent_2": [0.3, 0.5]}


def drawn(monkeypatch, **further):
    rows = [
        {"parameter": name, "condition_set": "all", "estimate": low, "lower": low, "upper": high, "identified": True}
        for name, (low, high) in RANGES.items()
    ]
    figures = []
    monkeypatch.setattr(estimates_figure, "save", lambda figure, path: figures.append(figure))
    declared = LAWS["nonlinear_burgers"].declared(dict.fromkeys(RANGES, 1.0))
    estimates_figure.draw(pd.DataFrame(rows).assign(**further), RANGES, declared, "", "PMMA", False)
    figures[0].canvas.draw()
    return figures[0]


def test_parameters_are_drawn_with_symbol_and_unit(monkeypatch):
    figure = drawn(monkeypatch)
    labels = [axis.get_xlabel() for axis in figure.axes]
    assert labels == ["$E$ [GPa]", "$C_s$ [GPa$^{-(2m_s+1)}$/s]", "$m_t^{(2)}$"]
    assert figure.axes[0].get_title() == "Young's modulus"
    assert "truth" not in figure.get_suptitle()
    assert "dashed: truth" in drawn(monkeypatch, truth=3.45).get_suptitle()


@pytest.mark.parametrize(("objective", "unit"), [("mean_square", "nm$^2$"), ("relative", "-")])
def test_convergence_is_drawn_with_its_unit(monkeypatch, objective, unit):
    figures = []
    monkeypatch.setattr(search_history, "save", lambda figure, path: figures.append(figure))
    history = [{"generation": k, "best_sum": 9.0 - k} for k in range(3)]
    search_history.draw({"all": {"settings": {"objective": objective}, "history": history}}, "", "search", False)
    assert figures[0].axes[0].get_ylabel().endswith(f"[{unit}]")


def test_series_are_told_apart_by_who_confuses_red_and_green():
    """As a deuteranope sees them: G. M. Machado et al., IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, severity 1."""
    seen = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])
    light = np.array([to_rgb(colour) for colour in SERIES]) ** 2.2
    colours = (light @ seen.T).clip(0.0, 1.0) ** (1 / 2.2)
    apart = np.linalg.norm(colours[:, None] - colours, axis=2)
    assert apart[np.triu_indices(len(SERIES), 1)].min() > 0.15


@pytest.mark.parametrize(("part", "meaning"), [("late", "dot: q"), ("whole", "no part shown has q")])
def test_the_map_of_misfits_explains_a_dot_where_one_is_drawn(part, meaning):
    """The whole of a segment is not drawn, only its halves."""
    loading = {"condition": "A", "segment": "loading", "residual_nm": 3.0}
    rows = [loading | {"part": each, "q_value": 0.01 if each == part else 1.0} for each in ("early", "late", "whole")]
    tried = [{"mechanisms": [], "log_evidence": -9.0}]
    content = {"location": rows, "tried": tried, "candidates": [], "verdict": "adequate"}
    columns = {key: [1.0, 2.0] for key in ("time_s", "recorded_nm", "before_nm", "after_nm", "noise_nm")}
    curves = pd.DataFrame({"condition": "A", "role": "calibrate", **columns})
    figure = Figure()
    explained_curves.compose(figure, content, curves, "PMMA", False)
    (left,) = [axis for axis in figure.axes if axis.get_title().startswith("base model, recorded")]
    assert f"[nm]; {meaning} < 0.05" in left.get_title()
    assert len(left.lines) == (part == "late")
