"""Where a misfit lies: cycles, parts of one sign, and a discrepancy of the law that is no larger than tolerated."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_problem import fitted, problem, recordings

from palpate.diagnosis.locate import CERTAIN, Residuals
from palpate.inference.covariance import discrepancy_of
from palpate.inference.discrepancy import Size
from palpate.study.prescribed_segments import by_cycle, cycles
from palpate.study.protocol import Protocol, trapezoid


def with_law(fit, share):
    law = discrepancy_of(fit.problem, fit.curve, 0.0025).sized(Size(share, 0.1))
    return replace(fit, errors=replace(fit.errors, law=law))


def test_cycles_are_numbered_from_one():
    corners = np.array([0.0, 1.0, 0.1, 2.0, 2.0, 0.2, 3.0, 0.0])
    protocol = Protocol(np.arange(8.0), corners, np.linspace(0.0, 7.0, 71)[1:])
    assert list(np.unique(cycles(protocol))) == [1, 2, 3]
    assert set(by_cycle(protocol)) == {
        (1, "loading"), (1, "unloading"), (2, "loading"), (2, "hold"), (2, "unloading"), (3, "loading"),
        (3, "unloading"),
    }  # fmt: skip
    assert np.unique(cycles(trapezoid(1.0, 10, 5, 10))) == [1]


def test_a_ripple_of_the_load_begins_no_cycle():
    protocol = Protocol(np.arange(5.0), np.array([0.0, 1.0, 0.98, 1.5, 0.0]), np.linspace(0.0, 4.0, 41)[1:])
    assert np.unique(cycles(protocol)) == [1]


@pytest.fixture(scope="module")
def swung():
    """A fit that leaves a residual that changes its sign in the middle of a hold."""

    def effect(condition, replicate):
        time = condition.protocol.sample_time
        return 12.0 * np.sign(time - 50.0) * ((time > 40) & (time <= 60)) * (condition.name == "b")

    return fitted(problem(recordings(np.random.default_rng(2), effect)))


def test_parts_are_split_where_the_residual_changes_its_sign(swung):
    rows = [row for row in Residuals.of(swung).located() if (row["condition"], row["segment"]) == ("b", "hold")]
    parts = {row["part"]: row for row in rows}
    assert "whole" not in parts
    assert parts["early"]["residual_nm"] < 0.0 < parts["late"]["residual_nm"]
    assert min(parts["early"]["q_value"], parts["late"]["q_value"]) < CERTAIN
    assert parts["early"]["from_s"] >= 39.0 and parts["early"]["to_s"] <= parts["late"]["from_s"] + 1e-9
    assert {"condition", "cycle", "segment", "part", "from_s", "to_s", "residual_nm", "q_value"} == set(rows[0])


def test_what_a_tolerated_discrepancy_covers_is_less_certain(swung):
    def of_the_hold(tolerance):
        rows = Residuals.of(with_law(swung, 0.05), tolerance).located()
        return min(row["q_value"] for row in rows if (row["condition"], row["segment"]) == ("b", "hold"))

    assert of_the_hold(1e-4) < 0.1 * of_the_hold(0.05)
    cut = Residuals.of(with_law(swung, 0.05), 0.01)
    assert cut.fit.errors.law.share == 0.01
    assert cut.fit.errors.law.size.own == 0.1


def test_the_pattern_that_a_residual_follows_is_named(swung):
    name, p_value = Residuals.of(swung).pattern({"none": np.zeros(len(swung.residual))})
    assert name == "slow change during hold of b"
    assert p_value < 1e-3
    whole = swung.residual / np.abs(swung.residual).max()
    assert Residuals.of(swung).pattern({"of itself": whole})[0] == "of itself"
