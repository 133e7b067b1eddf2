"""A virtual laboratory: synthetic recordings of a known material, for studies whose real recordings are not public.

It simulates on a finer mesh and a finer time grid than the snapshots, with nodes between those of the mesh on which an
estimate is confirmed, gives each recording its own depth factor (scatter between sites on the specimen) and adds noise
that is correlated in time (a stationary Ornstein-Uhlenbeck process). Under displacement control factor and noise are
those of the load that they amount to, see `palpate.observables.load`, and the recorded depth is what the transducer
leaves of its displacement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from indentation_files.recording import SYNTHETIC, Recording
from indentation_files.recording_file import recording_files
from palpate.configuration.condition import Condition
from palpate.configuration.settings import LaboratorySettings
from palpate.configuration.study_file import Study
from palpate.errors import PalpateError
from palpate.mechanisms import MECHANISMS
from palpate.observables.observable import Quantity
from palpate.solver.simulation import Simulation, simulate_batch
from palpate.solver.variation import written
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification

DENSER = 4  # samples in place of each of a snapshot
SHIFTS = (0.5, 1 / 6, 5 / 6)  # of a ring's spacing, off the mesh of a fit; the further ones where plasticity fails


def correlated_noise(
    time: np.ndarray, deviation: float, correlation_time: float, rng: np.random.Generator
) -> np.ndarray:
    """Return a stationary Gaussian process at `time` (n,), covariance deviation^2 exp(-|t - t'| / correlation_time).

    Parameters
    ----------
    time : ndarray, shape (n,)
        [s], increasing.
    deviation
        Standard deviation, in the unit of the result.
    correlation_time
        Time over which the correlation falls to 1/e [s].
    rng
        Source of randomness.
    """
    shocks = rng.standard_normal(len(time))
    noise = np.empty(len(time))
    noise[0] = shocks[0]
    decay = np.exp(-np.diff(time) / correlation_time)
    for i, keep in enumerate(decay, 1):
        noise[i] = keep * noise[i - 1] + np.sqrt(1 - keep**2) * shocks[i]
    return deviation * noise


def denser(protocol: Protocol) -> Protocol:
    """Return the protocol with `DENSER` samples in place of each one."""
    ends = protocol.sample_time
    starts = np.concatenate([[0.0], ends[:-1]])
    parts = np.arange(1, DENSER + 1) / DENSER
    sample = (starts[:, None] + (ends - starts)[:, None] * parts).ravel()
    sample[DENSER - 1 :: DENSER] = ends
    return replace(protocol, sample_time=sample)


def record(study: Study, settings: LaboratorySettings) -> dict[str, Recording]:
    """Return synthetic recordings of every condition by file name (without ending).

    Parameters
    ----------
    settings
        The truth, what is concealed, and the noise.

    Raises
    ------
    PalpateError
        When a simulation of the truth fails.
    """
    rng = np.random.default_rng(settings.seed)
    mechanisms = settings.mechanisms
    ordered = {key: values for key, values in mechanisms.items() if MECHANISMS[key].by_test_order}
    recordings: dict[str, Recording] = {}
    for condition, simulation in zip(study.tested.values(), exact_curves(study, settings), strict=True):
        for replicate in range(1, settings.replicates + 1):
            site = settings.site_scatter * rng.standard_normal()
            noise = correlated_noise(simulation.time, settings.noise_nm, settings.noise_time, rng)
            name = f"{condition.name}_{replicate}"
            load, depth = disturbed(study, condition, simulation, site, noise)
            number = len(recordings) + 1
            depth = written(ordered, simulation.time, load, depth, order=number)
            recordings[name] = Recording(
                simulation.time,
                load,
                depth,
                name=name,
                notes=(
                    f"{SYNTHETIC}: written by palpate's virtual laboratory, not measured",
                    f"study {study.name}",
                    f"test_number: {number}",
                ),
            )
    return recordings


def disturbed(
    study: Study, condition: Condition, simulation: Simulation, site: float, noise: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return load [mN] and depth [nm] (n,) as recorded where a `site` is so much deeper, under `noise` (n,) [nm].

    Parameters
    ----------
    study, condition
        The study, and the condition of the test.
    simulation
        The exact curve.
    site
        Relative change of the depth at the site [-].
    noise : ndarray, shape (n,)
        Noise of the depth [nm].
    """
    protocol = replace(condition.protocol, sample_time=simulation.time)
    quantity = Quantity.of(condition.observable, protocol, study.tip_of(condition), simulation.response)
    response = (1 + site * quantity.share) * simulation.response + noise / quantity.nm
    return condition.observable.recorded(protocol, simulation, response)


def exact_curves(study: Study, settings: LaboratorySettings) -> list[Simulation]:
    """Return the curves of all conditions as the laboratory knows them; those that differ in size are solved once.

    Raises
    ------
    PalpateError
        When a simulation fails on every mesh.
    """
    specifications = []
    for condition in study.tested.values():
        exact = replace(condition, protocol=denser(condition.protocol))
        specification = study.specification(settings.parameters, exact, accuracy="fine")
        mechanisms = settings.mechanisms.items()
        kept = {key: values for key, values in mechanisms if not MECHANISMS[key].by_test_order}
        specifications.append(replace(specification, mechanisms=kept))
    return off_the_mesh(specifications, [f"virtual laboratory, {name}" for name in study.tested])


def off_the_mesh(specifications: Sequence[Specification], names: Sequence[str]) -> list[Simulation]:
    """Return curves simulated together on meshes whose nodes lie between those of a fit's.

    Plasticity that fails on one mesh is tried on another, with its nodes elsewhere between them; not under a pyramid,
    which keeps its mesh.

    Raises
    ------
    PalpateError
        When a simulation fails on every mesh, with its name.
    """
    found = simulate_batch(specifications, SHIFTS[0])
    for place, (specification, name) in enumerate(zip(specifications, names, strict=True)):
        for shift in SHIFTS[1:] if specification.indenter.of_revolution else ():
            if found[place].status != "ok":
                (found[place],) = simulate_batch([specification], shift)
        if found[place].status != "ok":
            raise PalpateError(f"{name}: {found[place].reason}")
    return found


def write(study: Study, name: str, folder: Path) -> None:
    """Write the recordings of laboratory `name` and, beside them, the truth in ``truth.json``."""
    settings = study.laboratory[name]
    folder.mkdir(parents=True, exist_ok=True)
    for old in recording_files(folder):
        old.unlink()
    for recording in record(study, settings).values():
        recording.write(folder / f"{recording.name}.csv")
    (folder / "truth.json").write_text(settings.model_dump_json(indent=2) + "\n", encoding="utf-8")
