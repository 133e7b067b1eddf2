"""The imprints of a study: recorded profiles, and those that the finite elements leave at the end of a test."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from indentation_files.imprint_profile import ImprintProfile, read_imprint
from palpate.configuration.condition import Condition
from palpate.configuration.further_evidence import IMPRINT
from palpate.configuration.study_file import Study
from palpate.errors import InputError, located_in
from palpate.solver.simulation import fields_at
from palpate.study.specification import Specification


@dataclass(frozen=True, eq=False)
class Imprint:
    """A recorded profile and the condition whose test made it."""

    profile: ImprintProfile
    condition: Condition


def imprints(study: Study) -> Iterator[Imprint]:
    """Yield the imprints of a study.

    Raises
    ------
    InputError
        When a file is none, or the tip is a pyramid, whose imprint is no profile of revolution.
    """
    for evidence in (each for each in study.evidence if each.kind == IMPRINT):
        if not study.tip_of(study.condition(evidence.of)).of_revolution:
            raise InputError(
                f"the imprint {evidence.name} is compared by its radius, but the tip is a pyramid",
                remedy="leave it out, or use the equivalent cone",
                place="evidence",
            )
        with located_in(evidence.file):
            yield Imprint(read_imprint(evidence.file), study.tested[evidence.of])


def residual_profile(specification: Specification) -> tuple[np.ndarray, np.ndarray]:
    """Return radii and heights (m,) [nm] of the surface at the end of a test, where its nodes have moved to.

    Raises
    ------
    PalpateError
        When the solver fails.
    """
    (found,) = fields_at(specification, [float(specification.protocol.sample_time[-1])])
    nodes = found.mesh.surface
    radius = 1e3 * found.mesh.nodes[nodes, 0] + found.displacement[nodes, 0]
    order = np.argsort(radius)
    return radius[order], found.displacement[nodes, 1][order]
