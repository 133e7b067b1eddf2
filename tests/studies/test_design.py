"""Designs and their analysis: strength, the tables printed in the thesis, exact partitions of variance."""

import itertools
import sys

import numpy as np
import pytest
from scipy import stats

from palpate.design.sampling import factorial, latin_hypercube, midpoints, sobol
from palpate.errors import InputError
from studies.thesis.analysis_of_variance import Anova, anova, effect
from studies.thesis.level_reduction import reduce_levels
from studies.thesis.libraries import library
from studies.thesis.orthogonal_arrays import OrthogonalArray

L16_OF_THE_THESIS = """1 1 1, 1 2 2, 1 3 3, 1 4 4, 2 1 2, 2 2 1, 2 3 4, 2 4 3,
                       3 1 3, 3 2 4, 3 3 1, 3 4 2, 4 1 4, 4 2 3, 4 3 2, 4 4 1"""
L27_OF_THE_THESIS = """3 .02 .15 .15 .2 .1, 3 .02 .15 .15 .5 .25, 3 .02 .15 .15 .8 .4, 3 .06 .25 .25 .2 .1,
 3 .06 .25 .25 .5 .25, 3 .06 .25 .25 .8 .4, 3 .1 .35 .35 .2 .1, 3 .1 .35 .35 .5 .25, 3 .1 .35 .35 .8 .4,
 3.25 .02 .25 .35 .2 .25, 3.25 .02 .25 .35 .5 .4, 3.25 .02 .25 .35 .8 .1, 3.25 .06 .35 .15 .2 .25,
 3.25 .06 .35 .15 .5 .4, 3.25 .06 .35 .15 .8 .1, 3.25 .1 .15 .25 .2 .25, 3.25 .1 .15 .25 .5 .4,
 3.25 .1 .15 .25 .8 .1, 3.5 .02 .35 .25 .2 .4, 3.5 .02 .35 .25 .5 .1, 3.5 .02 .35 .25 .8 .25,
 3.5 .06 .15 .35 .2 .4, 3.5 .06 .15 .35 .5 .1, 3.5 .06 .15 .35 .8 .25, 3.5 .1 .25 .15 .2 .4,
 3.5 .1 .25 .15 .5 .1, 3.5 .1 .25 .15 .8 .25"""
EPOXY = {
    "E": (3, 3.25, 3.5),
    "C_s": (0.02, 0.06, 0.1),
    "m_s": (0.15, 0.25, 0.35),
    "C_t": (0.15, 0.25, 0.35),
    "m_t": (0.2, 0.5, 0.8),
    "t": (0.1, 0.25, 0.4),
}
# source: DF, SS, F, p, % contribution, as printed in chapters 4 and 5
ALUMINIUM_ANOVA = {
    "E": (3, 5272, 0.62, 0.629, 1.70),
    "Y": (3, 268843, 31.45, 0.0, 87.14),
    "h": (3, 17288, 2.02, 0.212, 5.60),
}
EPOXY_ANOVA = {
    "E": (2, 5597885401, 3630.33, 0.0, 11.20),
    "C_s": (2, 16004929654, 10379.48, 0.0, 32.01),
    "m_s": (2, 22166899947, 14375.63, 0.0, 44.34),
    "C_t": (2, 6207522908, 4025.69, 0.0, 12.42),
    "m_t": (2, 14961103, 9.70, 0.002, 0.03),
    "t": (2, 92652, 0.06, 0.942, 0.00),
}


def printed(table, error, error_freedom, total):
    rows = {name: effect(row[0], row[1], error / error_freedom, error_freedom, total) for name, row in table.items()}
    return Anova(rows, {name: () for name in table})


def test_l16_is_the_one_printed_in_the_thesis():
    expected = np.array([row.split() for row in L16_OF_THE_THESIS.split(",")], dtype=int) - 1
    assert np.array_equal(OrthogonalArray.of("L16", "EYh").levels, expected)


def test_l27_is_the_one_printed_in_the_thesis():
    expected = np.array([row.split() for row in L27_OF_THE_THESIS.split(",")], dtype=float)
    points = OrthogonalArray.of("L27", tuple(EPOXY)).points(EPOXY)
    assert np.array_equal([list(point.values()) for point in points], expected)


@pytest.mark.parametrize(("name", "columns"), [("L16", 5), ("L27", 13)])
def test_parents_have_strength_two(name, columns):
    assert OrthogonalArray.of(name, tuple(range(columns))).strength == 2


def test_a_broken_array_is_refused():
    levels = OrthogonalArray.of("L16", "EYh").levels.copy()
    levels[0, 0] = 3
    with pytest.raises(InputError, match="unequally"):
        OrthogonalArray(("E", "Y", "h"), levels)


def test_too_many_factors_are_refused():
    with pytest.raises(InputError, match="5 columns for 6"):
        OrthogonalArray.of("L16", "abcdef")


def test_interaction_is_booked_where_aliases_says():
    """A pure interaction of two factors: the ANOVA's sum of squares of each other factor is the named share."""
    design = OrthogonalArray.of("L27", tuple("abcdef"))
    rng = np.random.default_rng(1)
    aliases = design.aliases()
    for i, j in itertools.combinations(range(6), 2):
        shares = {
            n: next((s for a, b, s in rows if (a, b) == ("abcdef"[i], "abcdef"[j])), 0) for n, rows in aliases.items()
        }
        found = dict.fromkeys("abcdef", 0.0)
        for _ in range(400):
            cell = rng.standard_normal((3, 3))
            cell -= cell.mean(axis=0)
            cell -= cell.mean(axis=1, keepdims=True)
            analysis = anova(design, cell[design.levels[:, i], design.levels[:, j]])
            for name in "abcdef":
                found[name] += analysis.effects[name].square / analysis.effects["total"].square / 400
        for name in "abcdef":
            assert found[name] == pytest.approx(shares[name], abs=0.06)


def test_l16_of_the_thesis_aliases_every_interaction_with_the_third_factor():
    aliases = OrthogonalArray.of("L16", "EYh").aliases()
    assert {name: [(a, b) for a, b, _ in rows] for name, rows in aliases.items()} == {
        "E": [("Y", "h")],
        "Y": [("E", "h")],
        "h": [("E", "Y")],
    }
    assert all(share == pytest.approx(1 / 3) for rows in aliases.values() for *_, share in rows)


def test_additive_response_is_partitioned_exactly():
    design = OrthogonalArray.of("L16", "EYh")
    effects = np.array([[-3, -1, 1, 3], [2, -2, 2, -2], [0, 0, 0, 0]], dtype=float)
    response = 7.0 + sum(effects[k][design.levels[:, k]] for k in range(3))
    analysis = anova(design, response)
    assert [analysis.effects[n].square for n in "EYh"] == pytest.approx([80, 64, 0], abs=1e-9)
    assert analysis.effects["total"].square == pytest.approx(144)
    assert analysis.means["E"] == pytest.approx(7 + effects[0])


def test_a_response_that_nothing_changes_is_told():
    design = OrthogonalArray.of("L16", "EYh")
    with pytest.raises(InputError, match="is 7 in all runs"):
        anova(design, np.full(16, 7.0))


def test_one_factor_agrees_with_scipy():
    levels = np.repeat([0, 1, 2], 9)[:, None]
    response = np.random.default_rng(3).standard_normal(27) + levels[:, 0]
    row = anova(OrthogonalArray(("a",), levels), response).effects["a"]
    expected = stats.f_oneway(*(response[levels[:, 0] == k] for k in range(3)))
    assert (row.ratio, row.p_value) == pytest.approx((expected.statistic, expected.pvalue))


@pytest.mark.parametrize(
    ("table", "error", "freedom", "total"),
    [(ALUMINIUM_ANOVA, 17094, 6, 308498), (EPOXY_ANOVA, 10793843, 14, 50003085508)],
)
def test_the_printed_sums_of_squares_give_the_printed_ratios(table, error, freedom, total):
    analysis = printed(table, error, freedom, total)
    for name, (_, _, ratio, p_value, contribution) in table.items():
        row = analysis.effects[name]
        assert row.ratio == pytest.approx(ratio, rel=2e-3, abs=6e-3)
        assert row.p_value == pytest.approx(p_value, abs=2e-3)
        assert row.contribution == pytest.approx(contribution, abs=0.02)


def test_levels_are_reduced_as_in_the_thesis():
    four = {"E": (60, 65, 70, 75), "Y": (0.05, 0.1, 0.15, 0.2), "h": (0.4, 0.5, 0.6, 0.7)}
    reduced = reduce_levels(four, printed(ALUMINIUM_ANOVA, 17094, 6, 308498))
    assert reduced == {"E": (60, 67.5, 75), "Y": (0.05, 0.1, 0.15, 0.2), "h": (0.4, 0.55, 0.7)}
    counts = [len(v) for v in reduce_levels(EPOXY, printed(EPOXY_ANOVA, 10793843, 14, 50003085508)).values()]
    assert counts == [3, 4, 4, 3, 2, 1]


def test_midpoints_are_as_far_from_all_their_neighbours():
    levels = {"a": (0, 1, 2), "b": (0, 1), "c": (5,)}
    corners = np.array([list(p.values()) for p in factorial(levels)])
    for point in midpoints(levels):
        nearest = np.sort(np.linalg.norm(corners - list(point.values()), axis=1))[:4]
        assert nearest == pytest.approx(np.sqrt(0.5))


def test_sequences_stay_within_bounds_and_fill_them():
    bounds = {"a": (1.0, 3.0), "b": (-2.0, -1.0)}
    for points in (sobol(bounds, 64, seed=1), latin_hypercube(bounds, 64, seed=1)):
        values = np.array([list(p.values()) for p in points])
        unit = (values - [1, -2]) / [2, 1]
        assert np.array_equal(np.sort(np.floor(64 * unit), axis=0)[:, 0], np.arange(64))
        assert np.array_equal(np.sort(np.floor(64 * unit), axis=0)[:, 1], np.arange(64))


def test_a_longer_sobol_design_contains_the_shorter():
    bounds = {"a": (0.0, 1.0), "b": (0.0, 1.0)}
    assert sobol(bounds, 100, seed=2)[:40] == sobol(bounds, 40, seed=2)


def test_a_library_that_is_missing_is_named_with_the_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "pydoe", None)
    with pytest.raises(InputError, match="library pydoe; install it: pip install pydoe"):
        OrthogonalArray.of("L16", "abc")
    assert library("json").__name__ == "json"
