"""Runs of CalculiX, an independent program: the decks that palpate writes, and what their comparisons share.

Each comparison takes two or more CalculiX runs that differ in mesh or time step: their difference is the curve's own
refinement error. A curve of palpate's has to agree within 1 % at the worst sample from 15 % of the load on, or within
that error where it is larger: before that the contact lies on few of CalculiX' elements.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from palpate.errors import PalpateError
from palpate.output.export.calculix_deck import deck
from palpate.output.export.quadratic import quadratic_mesh
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.study.specification import Specification
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification, depth, not_run, worst

TIME_LIMIT = 1800.0  # s
WITHIN, LOADED_FROM = 0.01, 0.15  # of the depth; and of the largest load, from where on depths count
FRICTIONS = (0.0, 0.25)  # coefficients
PRINTED = re.compile(r"REFERENCE and time\s+(\S+)\s+\d+\s+\S+\s+(\S+)\s+\S+")
NOT_RUN = "CalculiX (ccx) was not run: it is not on the PATH, or a quick run was asked for."
RULE = (
    "From 15 % of the load on; allowed is 1 % at the worst sample, or the refinement error of CalculiX' own curve "
    "where that is larger."
)
STEPS = "Extrapolated to no step; the refinement error is that of the mesh and that of the shorter steps together."


def with_and_without_friction(
    key: str, title: str, compare: Callable[[Path, float], tuple[list[Row], Plot]], notes: Sequence[str]
) -> Verification:
    """Return the case that compares palpate and CalculiX without and with friction, or says that it was not run.

    Parameters
    ----------
    key, title
        Of the case.
    compare
        Returns rows and plot of one comparison, from the program and Coulomb's coefficient.
    notes
        What a reader needs to know of it.
    """

    def run(settings: Settings) -> Outcome:
        if settings.calculix is None:
            return Outcome([], notes=[NOT_RUN])
        rows, plots = list[Row](), list[Plot]()
        for friction in FRICTIONS:
            try:
                found, plot = compare(settings.calculix, friction)
            except PalpateError as error:
                rows.append(not_run(f"{title}, friction {friction:g},", error))
            else:
                rows += found
                plots.append(plot)
        return Outcome(rows, plots, notes)

    return Verification(key, title, run)


def printed(program: Path, text: str) -> str:
    """Run CalculiX on one core with a deck and return what it prints to its .dat file, if anything.

    Raises
    ------
    PalpateError
        When it takes longer than half an hour.
    """
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "deck.inp").write_text(text, encoding="ascii")
        environment = os.environ | {"OMP_NUM_THREADS": "1", "CCX_NPROC_RESULTS": "1"}
        try:
            subprocess.run(
                [program, "deck"], cwd=folder, env=environment, capture_output=True, timeout=TIME_LIMIT, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise PalpateError(f"CalculiX took longer than {TIME_LIMIT:g} s") from error
        output = Path(folder, "deck.dat")
        return output.read_text() if output.exists() else ""


def table(pattern: re.Pattern[str], text: str) -> np.ndarray:
    """Return the numbers (n, k) of all lines that match a pattern of k groups; raises `PalpateError` without any."""
    if not (found := [match.groups() for match in pattern.finditer(text)]):
        raise PalpateError("CalculiX wrote no depths")
    return np.array(found, dtype=float)


def run_deck(program: Path, specification: Specification, resolution: Resolution) -> np.ndarray:
    """Run CalculiX and return the depth (n,) [nm] at the samples, NaN after the time that it reached.

    Raises
    ------
    PalpateError
        When it stops without any result, or takes longer than half an hour.
    """
    overlap = quadratic_mesh(specification, resolution).overlap
    time, rise = table(PRINTED, printed(program, deck(specification, resolution))).T
    wanted = specification.protocol.sample_time
    depths = 1e3 * (overlap + np.interp(wanted, time, rise))
    return np.where(wanted <= time[-1] * (1 + 1e-9), depths, np.nan)


def compared(test: str, specification: Specification, theirs: np.ndarray, own_error: float) -> tuple[list[Row], Plot]:
    """Compare palpate's curve with one of CalculiX'.

    Parameters
    ----------
    test
        Its name, to which that of a friction is added.
    specification
        What palpate simulates.
    theirs : ndarray, shape (n,)
        CalculiX' depth [nm] at the samples; NaN where it has none.
    own_error
        Refinement error of that curve, see `refinement_error`.

    Returns
    -------
    rows
        The worst sample, which is checked; the root mean square and the peak, which are only reported.
    plot
        Both curves, and their deviation where it counts.
    """
    time, load = specification.protocol.sample_time, specification.protocol.sample_load
    found, counts = depth(specification), counted(specification, theirs)
    friction, note = specification.indenter.friction, f"refinement error of CalculiX' curve: {100 * own_error:.2f} %"
    name = f"{test}, friction {friction:g}" if friction else test
    peak, deviation = int(np.argmax(load)), found / theirs - 1
    scatter = float(np.sqrt(np.mean(deviation[counts] ** 2)))
    ends = float(theirs[peak]), float(found[peak])
    rows = [
        worst(f"{name}: depth, worst sample [nm]", theirs[counts], found[counts], max(WITHIN, own_error), note),
        Row(f"{name}: depth, root mean square [nm]", *ends, None, "not a check", scatter),
        Row(f"{name}: depth at peak [nm]", *ends, None, "not a check"),
    ]
    reached = np.isfinite(theirs)
    both = [
        PlottedSeries("CalculiX", time[reached], theirs[reached], True),
        PlottedSeries("palpate, fine", time, found),
    ]
    lower = [PlottedSeries("deviation", time[counts], 100 * deviation[counts])]
    file = "calculix_" + "".join(letter if letter.isalnum() else "_" for letter in name)
    return rows, Plot(file, "time [s]", f"depth, {name} [nm]", both, lower)


def counted(specification: Specification, theirs: np.ndarray) -> np.ndarray:
    """Return which samples (n,) count: those under enough load that CalculiX has reached; `PalpateError` if none."""
    protocol = specification.protocol
    counts = (protocol.sample_load >= LOADED_FROM * protocol.max_load) & np.isfinite(theirs)
    if not counts.any():
        raise PalpateError(f"CalculiX stopped before it reached {100 * LOADED_FROM:g} % of the load")
    return counts


def refined(
    specification: Specification, long: np.ndarray, short: np.ndarray, fine: np.ndarray, ripples: bool = False
) -> tuple[np.ndarray, float]:
    """Return the depth (n,) on the fine mesh, extrapolated to no step, and its refinement error in mesh and step.

    CalculiX integrates creep and plastic flow by Euler's backward rule, whose error is of first order.

    Parameters
    ----------
    specification
        The test.
    long, short, fine : ndarray, shape (n,)
        Depth on a coarse mesh in long and in half as long steps, and on a fine mesh in long ones.
    ripples
        Whether depths ripple as the contact passes from node to node, so that the change by the step is its mean.
    """
    change = short / long
    if ripples:
        change = np.full(len(change), change[counted(specification, change)].mean())
    depths = fine * (2 * change - 1)
    return depths, refinement_error(specification, depths, fine * change, long * (2 * change - 1))


def refinement_error(specification: Specification, fine: np.ndarray, *others: np.ndarray) -> float:
    """Return the sum of the largest relative differences between a curve and coarser ones, where they count."""
    counts = counted(specification, fine)
    return float(sum(np.nanmax(np.abs(other[counts] / fine[counts] - 1)) for other in others))
