"""The uniaxial tests of a study: read, checked against its law, and with what is compared in each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from indentation_files.uniaxial_test import STRESS, UniaxialTest, read_uniaxial
from palpate.configuration.further_evidence import AUTO, UNIAXIAL
from palpate.configuration.study_file import Study
from palpate.errors import InputError, located_in

LARGEST_STRAIN = {"large": 1.0, "small": 0.1}  # chosen, by the kinematics of a study; a steel's 50 % is 0.4
STIFFER = 3.0  # times the modulus times the strain: a larger stress is in another unit
THIRD = np.sqrt(20.0) * 0.6745  # median of the absolute third differences of noise over its standard deviation
LEAST_NOISE = 1e-4  # of the largest response, below which its own rounding or that of the law counts
UNITS = {"stress": "GPa", "strain": "strain"}  # by which names of results end


@dataclass(frozen=True, eq=False)
class BulkTest:
    """A uniaxial test, what was prescribed in it, and what for it is used.

    Parameters
    ----------
    test
    role
        ``calibrate`` or ``validate``.
    control
        ``strain`` or ``stress``: which of them its machine prescribed. The other one is compared.
    """

    test: UniaxialTest
    role: str
    control: str

    @property
    def name(self) -> str:
        """By which results call it."""
        return self.test.name

    @property
    def observed(self) -> str:
        """What is compared, ``stress`` or ``strain``."""
        return "strain" if self.control == STRESS else "stress"

    @property
    def unit(self) -> str:
        """By which names of its results end."""
        return UNITS[self.observed]

    @property
    def prescribed(self) -> np.ndarray:
        """Strain or stress [GPa] that was prescribed (n,)."""
        return self.test.stress if self.control == STRESS else self.test.strain

    @property
    def response(self) -> np.ndarray:
        """Stress [GPa] or strain that was recorded (n,)."""
        return self.test.strain if self.control == STRESS else self.test.stress

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of the response, from its third differences, robustly."""
        rough = float(np.median(np.abs(np.diff(self.response, 3)))) / THIRD
        return max(rough, LEAST_NOISE * float(np.abs(self.response).max()))


def bulk_tests(study: Study) -> Iterator[BulkTest]:
    """Yield the uniaxial tests of a study.

    Raises
    ------
    InputError
        When a file is no test, its units are in doubt, or its strains are beyond what the law is for.
    """
    for evidence in (each for each in study.evidence if each.kind == UNIAXIAL):
        test = read_uniaxial(evidence.file)
        with located_in(evidence.file):
            _check_sizes(test, study)
        control = test.held_longer if evidence.control == AUTO else evidence.control
        yield BulkTest(test, evidence.role, control)


def _check_sizes(test: UniaxialTest, study: Study) -> None:
    """Refuse stresses and strains that no body of the study's stiffness can have; raises `InputError`."""
    modulus = max(study.levels.get("youngs_modulus", ()) or [study.fixed["youngs_modulus"]])
    stress, strain = (float(np.abs(values).max()) for values in (test.stress, test.strain))
    if stress == 0.0 or strain == 0.0:
        raise InputError(
            f"the {'strain' if stress else 'stress'} is zero throughout", remedy="export the test again",
            place="strain" if stress else "stress_GPa",
        )  # fmt: skip
    if stress > min(1.0, STIFFER * strain) * modulus:
        reason = (
            f"exceeds Young's modulus, {modulus:g} GPa"
            if stress > modulus
            else f"is {stress / strain / modulus:.3g} times what the largest strain, {strain:.3g}, can bring about"
        )
        raise InputError(
            f"the largest stress, {stress:.4g}, {reason}: it looks like MPa", remedy="give it in GPa",
            place="stress_GPa",
        )  # fmt: skip
    if strain > LARGEST_STRAIN[study.kinematics]:
        raise InputError(
            f"the largest strain is {strain:.4g}, but the law, with kinematics: {study.kinematics}, is for logarithmic "
            f"strains up to {LARGEST_STRAIN[study.kinematics]:g}",
            remedy="give a ratio, not per cent, or leave the part beyond out",
            place="strain",
        )
