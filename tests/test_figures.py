"""Figures name what they show, with its unit."""

import pandas as pd

from palpate.figures import parameters
from palpate.materials import LAWS

RANGES = {"youngs_modulus": [3.0, 4.0], "steady_coefficient": [0.1, 0.2], "transient_exponent_2": [0.3, 0.5]}


def drawn(monkeypatch, **further):
    rows = [
        {"parameter": name, "condition_set": "all", "estimate": low, "lower": low, "upper": high, "identified": True}
        for name, (low, high) in RANGES.items()
    ]
    figures = []
    monkeypatch.setattr(parameters, "save", lambda figure, path: figures.append(figure))
    declared = LAWS["nonlinear_burgers"].declared(dict.fromkeys(RANGES, 1.0))
    parameters.draw(pd.DataFrame(rows).assign(**further), RANGES, declared, "", "PMMA", False)
    figures[0].canvas.draw()
    return figures[0]


def test_parameters_are_drawn_with_symbol_and_unit(monkeypatch):
    figure = drawn(monkeypatch)
    labels = [axis.get_xlabel() for axis in figure.axes]
    assert labels == ["$E$ [GPa]", "$C_s$ [GPa$^{-(2m_s+1)}$/s]", "$m_t^{(2)}$"]
    assert figure.axes[0].get_title() == "Young's modulus"
    assert "truth" not in figure.get_suptitle()
    assert "dashed: truth" in drawn(monkeypatch, truth=3.45).get_suptitle()
