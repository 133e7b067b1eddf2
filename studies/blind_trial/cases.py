"""The cases of the trial: what is concealed in each, drawn from realistic continuous ranges."""

from __future__ import annotations

import itertools
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate.base.checksum import checksum
from palpate.configuration.study_file import Study
from palpate.mechanisms import considered
from palpate.mechanisms.draws import log_uniform
from studies.blind_trial.unknown import UNKNOWN

INNER = 0.1


@dataclass(frozen=True)
class Case:
    """One set of recordings and what it conceals.

    Parameters
    ----------
    name
        Neutral.
    kind
        ``none``, ``one``, ``two`` or ``unknown``.
    parameters
        The material.
    mechanisms
        What acts, with amplitudes.
    unknown
        Key and strength of an effect that is in no library; empty otherwise.
    noise
        `sigma_nm`, `memory`, `site_scatter`, `drift_nm_s` and `drift_time_s` of the background, `own` (relative spread
        between recordings of values that vary).
    seed
        Of the noise.
    """

    name: str
    kind: str
    parameters: Mapping[str, float]
    mechanisms: Mapping[str, Mapping[str, float]]
    unknown: Mapping[str, Any]
    noise: Mapping[str, float]
    seed: int


def draw(study: Study) -> list[Case]:
    """Draw the cases of a study's section ``challenge``, in random order."""
    settings = study.challenge
    rng = np.random.default_rng(settings.seed)
    kinds = [kind for kind in ("none", "one", "two", "unknown") for _ in range(getattr(settings, kind))]
    concealed = considered(settings.mechanisms, "challenge.mechanisms")
    available = list(concealed)
    singles = itertools.cycle(rng.permutation(available))
    unknown = itertools.cycle(rng.permutation(list(UNKNOWN)))
    drawn = []
    for kind in kinds:
        keys: list[str] = []
        if kind == "one":
            keys = [next(singles)]
        elif kind == "two":
            keys = sorted(rng.choice(available, 2, replace=False))
        strange = {"key": str(next(unknown)), "strength": log_uniform(rng, 0.2, 1.0)} if kind == "unknown" else {}
        mechanisms = {str(key): {k: float(v) for k, v in concealed[key].concealed(rng).items()} for key in keys}
        drawn.append((kind, _material(study, rng), mechanisms, strange, _noise(rng), int(rng.integers(2**31))))
    order = rng.permutation(len(drawn))
    return [Case(f"case_{number:03d}", *drawn[k]) for number, k in enumerate(order)]


def divided(folders: list[str], together: int) -> dict[str, list[str]]:
    """Divide the folders of the cases among jobs."""
    return {
        f"group_{number:02d}": folders[first : first + together]
        for number, first in enumerate(range(0, len(folders), together))
    }


def seal(cases: list[Case], path: Path) -> str:
    """Write the truth of all cases to one file and return its SHA-256."""
    text = json.dumps([asdict(case) for case in cases], indent=1) + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return checksum(path)


def _material(study: Study, rng: np.random.Generator) -> dict[str, float]:
    """Draw a material from the inner part of the study's grid."""
    values = {}
    for name, levels in study.levels.items():
        low, high = min(levels), max(levels)
        values[name] = float(low + (INNER + (1 - 2 * INNER) * rng.random()) * (high - low))
    return values


def _noise(rng: np.random.Generator) -> dict[str, float]:
    return {
        "sigma_nm": float(rng.uniform(0.6, 1.5)),
        "memory": float(rng.uniform(0.5, 0.9)),
        "site_scatter": float(rng.uniform(0.005, 0.015)),
        "drift_nm_s": float(rng.uniform(0.001, 0.005)),
        "drift_time_s": float(rng.uniform(50.0, 300.0)),
        "own": float(rng.uniform(0.1, 0.5)),
    }
