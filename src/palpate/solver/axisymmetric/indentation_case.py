"""One indentation by a tip of revolution: its mesh, its time steps, and what those that run in lanes share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from palpate.materials.flow.row import structure
from palpate.solver.axisymmetric.contact_size import contact_range
from palpate.solver.axisymmetric.discretisation import GRADED_START, mesh_radii, step_times
from palpate.solver.axisymmetric.drive import NO_LOAD
from palpate.solver.axisymmetric.folding import merged, mergings
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specimen import Specimen

HALVINGS = 6  # of a step that finds no equilibrium
FEW_HALVINGS = 2  # where the innermost rings may be merged instead; where adhesion makes surfaces jump, that is no cure
DIGITS = 9  # of the logarithms of the rings' radii


@dataclass(frozen=True, eq=False)
class Case:
    """One indentation by a tip of revolution, and its mesh.

    All nodes have a `shift` outwards, in rings; the innermost rings are `merged` so many times. The radii of the
    `rings` may be given [um].
    """

    specimen: Specimen
    indenter: Indenter
    protocol: Protocol
    resolution: Resolution
    large: bool = False
    shift: float = 0.0
    merged: int = 0
    rings: np.ndarray | None = None

    @property
    def contacts(self) -> tuple[float, float]:
        """Smallest contact radius that counts, and the largest one [um]."""
        return contact_range(self.specimen, self.indenter, self.protocol)

    @cached_property
    def radii(self) -> np.ndarray:
        """Radii of the rings of nodes [um]."""
        usual = self.rings
        if usual is None:
            usual = mesh_radii(self.specimen, self.indenter, self.protocol, self.resolution)
        rings = merged(usual, self.resolution, not self.indenter.sharp, self.merged)
        return rings * self.resolution.growth**self.shift

    @cached_property
    def shape(self) -> np.ndarray:
        """Radii of the rings over that of the innermost one, rounded: of one kind they agree to the last bit."""
        return np.exp(np.round(np.log(self.radii / self.radii[0]), DIGITS))

    @property
    def mergeable(self) -> bool:
        """Whether its innermost rings may be merged once more."""
        return self.merged < mergings(self.large)

    @property
    def halvings(self) -> int:
        """How many times a step that finds no equilibrium is halved."""
        return FEW_HALVINGS if self.mergeable and not self.specimen.adhesion else HALVINGS

    @property
    def and_merged(self) -> Iterator[Case]:
        """The case, and as it is with its innermost rings merged, once more each time."""
        for times in range(self.merged, 1 + mergings(self.large)):
            yield replace(self, merged=times)

    @cached_property
    def times(self) -> np.ndarray:
        """Ends of the time steps [s]."""
        return step_times(self.protocol, self.resolution, self.specimen.yields)

    @property
    def unloaded_steps(self) -> int:
        """Number of steps before the first that loads the contact.

        The body rests, unless adhesion draws it to the tip in a contact that the mesh resolves.
        """
        drive = self.protocol.drive_at(self.times)
        return int(np.argmax(drive > NO_LOAD * self.protocol.largest_drive))

    @property
    def carries(self) -> np.ndarray:
        """Whether each step may carry the last change on: not from a corner of the load history, nor at the onset."""
        corners = np.isin(self.times, self.protocol.knot_time)
        steps_loaded = np.cumsum(self.protocol.drive_at(self.times) > 0.0)
        return ~np.append(True, corners[:-1]) & (steps_loaded > (len(GRADED_START) + 2 if self.large else 0))

    @property
    def kind(self) -> tuple:
        """What cases that run together have in common."""
        shape = self.shape.tobytes()
        body = self.large, structure(self.specimen.coefficients), self.specimen.is_uniform
        surface = self.indenter.friction > 0.0, self.specimen.adhesion > 0.0
        return self.resolution, shape, body, surface
