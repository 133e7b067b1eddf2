"""A study's law under its uniaxial tests: the same law as under the tip, at a point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from palpate.configuration.study_file import Study
from palpate.data.bulk_tests import BulkTest, bulk_tests
from palpate.materials import law_of
from palpate.materials.flow.uniaxial import response_to


@dataclass(frozen=True)
class BulkModel:
    """A law and the uniaxial tests that it is compared with.

    Parameters
    ----------
    model
        Key of the law.
    fixed
        Parameters that no calibration changes, by name.
    tests
        In the order of the study's section ``evidence``.
    """

    model: str = ""
    fixed: Mapping[str, float] = field(default_factory=dict)
    tests: tuple[BulkTest, ...] = ()

    @classmethod
    def of(cls, study: Study) -> BulkModel:
        """Read the uniaxial tests of a study; raises `InputError`."""
        return cls(study.model, study.fixed, tuple(bulk_tests(study)))

    def response(self, test: BulkTest, values: Mapping[str, float]) -> np.ndarray:
        """Return the response (n,) of the material with `values` by name; NaN from where it cannot bear the stress."""
        row = law_of(self.model).coefficients({**self.fixed, **values})
        return response_to(row, test.test.time, test.prescribed, test.control)
