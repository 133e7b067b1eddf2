"""A study held to all that can be known before anything is simulated; the command line and the workflow begin here."""

from __future__ import annotations

from pathlib import Path

from palpate.config import Study, load_study
from palpate.diagnosis.design import PAIRS_FOR_EACH, candidates, pairs
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
        _check_pairs(study)
    return study


def _check_pairs(study: Study) -> None:
    """Refuse a diagnosis with fewer pairs of simulations than an effect can be learnt from; raises `InputError`."""
    condition = next(condition for condition in study.conditions if condition.role == "calibrate")
    for key in candidates(study):
        found = pairs(study, condition, key)
        if not found:
            continue
        quantities = len(found[0].coordinates)
        least = PAIRS_FOR_EACH * (len(study.free_parameters) + quantities)
        if len(found) < least:
            raise InputError(
                f"{study.diagnosis['snapshots']} is too few to learn {key} beside {len(study.free_parameters)} free "
                "parameters",
                remedy=f"give {-(-2 * least // (1 + quantities))} or more",
                file=study.file,
                place="diagnosis.snapshots",
            )
