"""What Newton's method works on in a time step of `LANES` indentations, as arguments of compiled functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from palpate.solver.axisymmetric.contact import Contact, ContactState
from palpate.solver.axisymmetric.element import Body
from palpate.solver.axisymmetric.law_lanes import Points


class Setup(NamedTuple):
    """What stays during a simulation.

    Attributes
    ----------
    large : bool or None
        See `palpate.solver.axisymmetric.assembly`.
    body : Body
    contact : Contact
    """

    large: bool | None
    body: Body
    contact: Contact


class Material(NamedTuple):
    """The material in a step.

    Attributes
    ----------
    points, laws, weights
        See `palpate.solver.axisymmetric.law_lanes`; the points are those at the start of the step until it has
        converged.
    """

    points: Points
    laws: np.ndarray
    weights: np.ndarray


class Trial(NamedTuple):
    """The trial state at the end of a step.

    Attributes
    ----------
    contact : ContactState
    displacement : ndarray, shape (size + 1, LANES)
    depth, reaction : ndarray, shape (LANES,)
        Of the indenter; the reaction is its load.
    """

    contact: ContactState
    displacement: np.ndarray
    depth: np.ndarray
    reaction: np.ndarray


class Prescribed(NamedTuple):
    """What the trial state has to meet, each of shape (LANES,).

    Attributes
    ----------
    force_weight, depth_weight, target
        See `palpate.solver.axisymmetric.drive`.
    scale
        Largest load of the history.
    tolerance
        What every unbalanced force falls below, as a share of that.
    """

    force_weight: np.ndarray
    depth_weight: np.ndarray
    target: np.ndarray
    scale: np.ndarray
    tolerance: float


class Residual(NamedTuple):
    """By what the trial state does not meet it.

    Attributes
    ----------
    forces : ndarray, shape (size + 1, LANES)
        R.
    excess : ndarray, shape (LANES,)
        Of the last equation.
    late, limit : ndarray, shape (LANES,)
        The e of the area, and the largest change of the area.
    """

    forces: np.ndarray
    excess: np.ndarray
    late: np.ndarray
    limit: np.ndarray


class Direction(NamedTuple):
    """Newton's direction.

    Attributes
    ----------
    displacement : ndarray, shape (size + 1, LANES)
    depth, area : ndarray, shape (LANES,)
    work : ndarray, shape (LANES,)
        Of the forces along it, at its start.
    """

    displacement: np.ndarray
    depth: np.ndarray
    area: np.ndarray
    work: np.ndarray
