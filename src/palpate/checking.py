"""A study held to all that can be known before anything is simulated; the command line and the workflow begin here."""

from __future__ import annotations

from pathlib import Path

from palpate.config import Study, load_study
from palpate.diagnosis.design import candidates
from palpate.errors import InputError
from palpate.observations import check_given
from palpate.steps import settings_of


def checked_study(path: str | Path, data: str | None = None) -> Study:
    """Read a study, and check its recordings, the settings of its calibration and what its diagnosis considers.

    Parameters
    ----------
    path, data
        As for `palpate.config.load_study`.

    Raises
    ------
    InputError
        With file, place and remedy, on the first mistake.
    """
    study = load_study(path, data=data)
    check_given(study)
    try:
        settings_of(study)
    except InputError as error:
        place = f"calibration.{error.place}"
        raise InputError(error.problem, remedy=error.remedy, file=study.file, place=place) from None
    if study.diagnosis["enabled"]:
        candidates(study)
    return study
