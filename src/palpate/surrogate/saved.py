"""Surrogates in files: the snapshots they were fitted to and their lengths, as plain arrays.

Loading solves the interpolation system again, in milliseconds. Nothing that a file holds is executed, and a file made
on one machine serves on any other.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from indentation_files.whole_file import written_whole
from palpate.errors import PalpateError
from palpate.surrogate.pod_rbf import PODRBF


def save(model: PODRBF, parameters: np.ndarray, curves: np.ndarray, path: str | Path) -> None:
    """Write a surrogate and what it was fitted to; the file appears whole or not at all.

    Parameters
    ----------
    model
        The fitted surrogate.
    path
        File that is written.
    parameters : ndarray, shape (n_snapshots, n_parameters)
    curves : ndarray, shape (n_snapshots, n_points)
    """
    settings = json.dumps(model.get_params())
    with written_whole(Path(path)) as partial, partial.open("wb") as stream:
        np.savez(stream, parameters=parameters, curves=curves, lengths=model.lengths_, settings=settings)


def load(path: str | Path) -> PODRBF:
    """Return the surrogate in a file.

    Raises
    ------
    PalpateError
        When the file is no surrogate, or was cut or altered.
    """
    try:
        with np.load(path, allow_pickle=False) as stored:
            model = PODRBF(**json.loads(str(stored["settings"])))
            return model.fit(stored["parameters"], stored["curves"], stored["lengths"])
    except Exception as error:  # a damaged archive may raise anything
        raise PalpateError(f"{path} holds no surrogate that can be read; delete it and run the study again") from error
