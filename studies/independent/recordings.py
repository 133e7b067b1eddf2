"""Recordings made from given curves: sites, noise with memory, and an effect of the instrument in half of the sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from indentation_files.recording import SYNTHETIC, Recording
from palpate.configuration.study_file import Study
from palpate.mechanisms import MECHANISMS
from studies.blind_trial.cases import Case
from studies.blind_trial.laboratory import REPLICATES, first_order
from studies.independent.bodies import BODIES

EFFECTS = ("thermal_drift", "frame_compliance", "zero_offset")  # they are added to a signal, whoever computed it
OWN = 0.2  # relative spread between recordings of what varies


def draw(seed: int, draws: int) -> list[Case]:
    """Draw the sets of recordings of every body, in random order: half of them with an effect of the instrument."""
    rng, drawn = np.random.default_rng(seed), []
    for body, truth in BODIES.items():
        for number in range(2 * draws):
            key = EFFECTS[number // 2 % len(EFFECTS)] if number % 2 else None
            added = {key: {k: float(v) for k, v in MECHANISMS[key].concealed(rng).items()}} if key else {}
            noise = {
                "sigma_nm": float(rng.uniform(0.7, 1.3)),
                "memory": float(rng.uniform(0.5, 0.85)),
                "site_scatter": float(rng.uniform(0.007, 0.013)),
                "own": OWN,
            }
            mechanisms = {**truth.mechanisms, **added}
            kind = ("none", "one", "two")[len(mechanisms)]
            drawn.append((kind, truth.parameters, mechanisms, {"key": body}, noise, int(rng.integers(2**31))))
    return [Case(f"set_{place:03d}", *drawn[k]) for place, k in enumerate(rng.permutation(len(drawn)))]


def write(study: Study, case: Case, curves: Path, folder: Path) -> None:
    """Write the recordings of one set, at the times of its curves.

    Parameters
    ----------
    study
        Whose conditions were simulated.
    case
        What is concealed.
    curves
        Folder with a CSV file for each body: ``condition,time_s,load_mN,depth_nm``.
    folder
        Gains one file for each recording.
    """
    rng, noise = np.random.default_rng(case.seed), case.noise
    table = pd.read_csv(curves / f"{case.unknown['key']}.csv", comment="#").groupby("condition")
    folder.mkdir(parents=True, exist_ok=True)
    for condition in study.conditions:
        time, load, depth = table.get_group(condition.name)[["time_s", "load_mN", "depth_nm"]].to_numpy()[1:].T
        for replicate in range(1, REPLICATES + 1):
            h = depth * (1.0 + noise["site_scatter"] * rng.standard_normal())
            for key in [key for key in case.mechanisms if key in EFFECTS]:
                mechanism, factor = MECHANISMS[key], 1.0 + noise["own"] * rng.standard_normal()
                share = factor if mechanism.varies else 1.0
                values = {name: share * value for name, value in case.mechanisms[key].items()}
                h = mechanism.record(time, load, h, values)
            h = h + noise["sigma_nm"] * first_order(len(time), noise["memory"], rng)
            notes = (f"{SYNTHETIC}: made from curves of another finite-element code, not measured",)
            Recording(time, load, h, name=f"{condition.name}_{replicate}", notes=notes).write(
                folder / f"{condition.name}_{replicate}.csv"
            )
