"""The verification itself: its measures, report and exit code, and a small run of CalculiX where there is one."""

import importlib
import json
import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from palpate.cli import verify
from palpate.cli.main import main
from palpate.errors import PalpateError
from palpate.output.export.quadratic import RESOLUTIONS
from palpate.solver.axisymmetric.mesh import Resolution
from studies.verification import calculix, cases, runner
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification, depth, rms, worst
from studies.verification.cases.calculix_large import Curve
from studies.verification.cases.calculix_small import elastic
from studies.verification.cases.mesh_convergence import richardson

GOOD = Row("depth [nm]", 100.0, 100.4, 0.005)
BAD = Row("depth [nm]", 100.0, 101.0, 0.005)
PLOT = Plot(
    "curve",
    "time [s]",
    "depth [nm]",
    [PlottedSeries("one", [1, 2], [3, 4])],
    [PlottedSeries("two", [1, 2], [0.1, math.nan])],
)


@pytest.mark.parametrize("order", [1.0, 2.0, 1.7])
def test_richardson_recovers_order_and_limit(order):
    values = 7.0 + 0.3 * (0.5 ** np.arange(4)) ** order
    assert richardson(values) == pytest.approx((order, 7.0))


@pytest.mark.parametrize("values", [(1.0, 2.0, 1.5), (1.0, 1.1, 1.3), (1.0, 1.0, 1.0)])
def test_richardson_claims_no_order_without_convergence(values):
    order, limit = richardson(values)
    assert math.isnan(order)
    assert limit == values[-1]


def test_a_row_judges_itself():
    assert GOOD.passed is True
    assert BAD.passed is False
    assert Row("not simulated", 1.0, math.nan, 0.1).passed is False
    assert Row("reported only", 1.0, 9.0, None).passed is None


def test_the_worst_sample_is_the_one_shown_and_a_failed_one_is_worst():
    expected = np.array([1.0, 2.0, 4.0])
    assert worst("h", expected, np.array([1.01, 2.1, 4.0]), 0.01).deviation == pytest.approx(0.05)
    assert math.isnan(worst("h", expected, np.array([1.0, np.nan, 5.0]), 0.01).found)
    assert rms("h", expected, np.array([1.03, 2.0, 4.0])).deviation == pytest.approx(0.03 / np.sqrt(3))


def run_with(monkeypatch, *cases):
    monkeypatch.setattr(runner, "CASES", cases)


def fails(settings):
    raise PalpateError("the program stopped")


def test_report_and_json_hold_every_row(monkeypatch, tmp_path, capsys):
    outcome = Outcome([GOOD, Row("reported <only>", math.nan, 9.0, None)], [PLOT], ["a note"])
    run_with(monkeypatch, Verification("one", "First", lambda settings: outcome))
    assert main(["verify", "--quick", "-o", str(tmp_path / "out")]) == 0
    result = json.loads((tmp_path / "out/verification.json").read_text())
    assert result["passed"] and result["checks"] == 1
    assert set(result["cases"][0]["rows"][0]) >= {"quantity", "expected", "found", "deviation", "allowed", "passed"}
    assert result["cases"][0]["rows"][1]["expected"] is None
    page = (tmp_path / "out/report.html").read_text()
    assert "reported &lt;only&gt;" in page and "1 of 1 checks passed" in page and "a note" in page
    assert (tmp_path / "out/figures/curve.png").stat().st_size > 1000
    assert "First: 1 of 1" in capsys.readouterr().out


@pytest.mark.parametrize("broken", [lambda settings: Outcome([GOOD, BAD]), fails])
def test_a_failed_check_is_told_and_ends_with_one(monkeypatch, tmp_path, capsys, broken):
    run_with(monkeypatch, Verification("one", "First", broken))
    assert main(["verify", "--quick", "-o", str(tmp_path)]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert "Failed: First" in (tmp_path / "report.html").read_text()


def test_every_module_of_the_folder_of_cases_holds_some():
    modules = {file.stem for file in Path(cases.__file__).parent.glob("*.py")} - {"__init__"}
    assert {case.run.__module__.split(".")[-1] for case in cases.CASES} <= modules | {"calculix"}
    assert all(importlib.import_module(f"{cases.__name__}.{name}").CASES for name in modules)
    assert len({case.key for case in cases.CASES}) == len(cases.CASES) > 10


def test_away_from_a_clone_it_says_so_in_one_line(monkeypatch, tmp_path, refused):
    monkeypatch.setattr(verify, "CLONE", tmp_path)
    assert refused("verify", "--quick") == (
        "palpate: palpate verify compares the solver with cases that only its repository holds; "
        "run it in a clone, after `pip install -e .` there"
    )


def test_a_missing_reference_folder_is_refused(tmp_path, capsys):
    assert main(["verify", "--reference", str(tmp_path / "none"), "-o", str(tmp_path / "out")]) == 2
    assert "folder is missing" in capsys.readouterr().err


@pytest.mark.parametrize(
    "case", [case for case in runner.CASES if case.key.startswith("calculix")], ids=lambda c: c.key
)
def test_without_calculix_it_says_so(case):
    outcome = case.run(Settings())
    assert not outcome.rows
    assert "not run" in outcome.notes[0]


def curve_of(specification):
    load = specification.protocol.sample_load
    return 400.0 * np.sqrt(load)


@pytest.mark.parametrize(("own_error", "allowed"), [(0.003, 0.01), (0.02, 0.02)])
def test_allowed_is_one_per_cent_or_the_curves_own_refinement_error(monkeypatch, own_error, allowed):
    """Whatever happens below 15 % of the load; all else is only told."""
    test = elastic(20)
    monkeypatch.setattr(calculix, "depth", curve_of)
    low = test.protocol.sample_load < 0.15
    theirs = curve_of(test) / np.where(low, 1.5, 1.008)
    rows, plot = calculix.compared("a cone", test, theirs, own_error)
    assert [row.allowed for row in rows] == [allowed, None, None]
    assert [row.deviation for row in rows] == pytest.approx([0.008] * 3)
    assert f"{100 * own_error:.2f} %" in rows[0].note
    assert len(plot.lower[0].y) == (~low).sum()


def test_refinement_errors_add_up_where_the_curve_counts():
    test = elastic(20)
    fine = curve_of(test)
    others = (np.where(test.protocol.sample_load < 0.15, 2.0, factor) * fine for factor in (1.01, 0.98))
    assert calculix.refinement_error(test, fine, *others) == pytest.approx(0.03)


def test_a_curve_that_calculix_breaks_off_before_it_counts_fails_alone():
    """The comparison without friction stays."""

    def compare(program, friction):
        test, reached = elastic(20, friction), 2 if friction else 20
        depths = np.where(np.arange(40) < reached, np.linspace(1.0, 2.0, 40), np.nan)
        calculix.refinement_error(test, depths, depths)
        return [Row("depth", 1.0, 1.0, 0.01)], Plot("depth", "t", "h", [])

    case = calculix.with_and_without_friction("some", "Some", compare, [])
    found = case.run(Settings(calculix=Path("ccx")))
    assert [row.passed for row in found.rows] == [True, False]
    assert "friction 0.25" in found.rows[1].quantity
    assert "stopped before it reached 15 % of the load" in found.rows[1].note
    assert len(found.plots) == 1


@pytest.mark.parametrize("ripples", [False, True])
def test_mesh_and_step_are_refined_apart(ripples):
    """A depth with errors of first order in the step and in the mesh: that of the mesh is left, and told."""
    test = elastic(20)
    exact = curve_of(test)
    errors = ((0.02, 0.04), (0.02, 0.02), (0.01, 0.04))
    long, short, fine = ((1 + mesh) * (1 + step) * exact for mesh, step in errors)
    depths, own_error = calculix.refined(test, long, short, fine, ripples)
    assert depths / exact - 1 == pytest.approx(0.01, rel=0.1)
    assert own_error == pytest.approx(0.01 + 0.02, rel=0.1)


def test_a_curve_under_another_load_obeys_the_law_of_a_sharp_tip():
    """Depth goes with the root of the load in loading; what a metal springs back does so by the share of its load."""
    up, down = np.linspace(0.1, 1.0, 10), np.linspace(0.9, 0.5, 5)

    def curve(peak):
        depth = np.concatenate([np.sqrt(up), 0.95 + 0.05 * down]) * np.sqrt(peak)
        return Curve(np.arange(1.0, 16.0), depth, peak * np.concatenate([up, down]))

    one, other = curve(4.9), curve(5.6)
    assert other.depth_under(one.load) == pytest.approx(one.depth)
    assert one.protocol.sample_load == pytest.approx(one.load)


def test_a_program_that_writes_nothing_is_an_error(tmp_path):
    program = tmp_path / "ccx"
    program.write_text("#!/bin/sh\nexit 1\n")
    program.chmod(0o755)
    with pytest.raises(PalpateError, match="no depths"):
        calculix.run_deck(program, elastic(2), RESOLUTIONS["standard"])


def test_depths_are_read_and_end_where_the_program_stopped(tmp_path):
    program = tmp_path / "ccx"
    block = " displacements (vx,vy,vz) for set REFERENCE and time  {}\n\n       518  0.000000E+00  {}  0.000000E+00\n\n"
    text = "".join(block.format(f"{t:.7E}", f"{t / 10:.6E}") for t in (0.5, 1.0))
    program.write_text(f"#!/bin/sh\ncat > deck.dat <<'END'\n{text}END\n")
    program.chmod(0o755)
    specification = elastic(2)
    found = calculix.run_deck(program, specification, RESOLUTIONS["standard"])
    assert found[1] - found[0] == pytest.approx(50.0)
    assert np.isnan(found[2:]).all()


@pytest.mark.skipif(not shutil.which("ccx"), reason="CalculiX (ccx) is not installed")
def test_calculix_agrees_with_the_solver():
    """On a coarse mesh; with fewer samples its increments would be too long for it to settle the contact."""
    specification = replace(elastic(20), accuracy="standard")
    mesh = Resolution(growth=1.7, sectors=3, inner=0.1, far=500.0)
    found = calculix.run_deck(Path(shutil.which("ccx")), specification, mesh)
    counts = specification.protocol.sample_load >= 0.15 * specification.protocol.max_load
    assert np.sqrt(np.mean((found / depth(specification) - 1)[counts] ** 2)) < 0.01
