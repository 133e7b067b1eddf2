"""How wide and how stiff the contact is: the numbers behind `palpate.solver.axisymmetric.contact`.

All are chosen. `WIDTH` and `STIFFNESS` make the scatter of the depth over offsets of the mesh smaller than 5e-5 in
elastic and creeping bodies and 2e-4 in yielding ones; in a body that flows under a small share of the elastic pressure
the pressure ends abruptly at the edge of contact, which asks for a wider and softer one. `BLEND` then makes the depth
at fixed load that of a mesh of infinitely many elements, to first order in their size; the part of the sectors makes up
for a body that few of them leave too stiff. `tests/helpers/ripple.py` and `tests/helpers/mesh_levels.py` measure both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from palpate.solver.axisymmetric.adhesive_traction import Adhesion
from palpate.solver.axisymmetric.contact import FARTHEST, SLIP, Contact, ContactState
from palpate.solver.axisymmetric.contact_size import contact_range, loaded_time, mean_pressure
from palpate.solver.axisymmetric.lanes import LANES
from palpate.solver.axisymmetric.profile import Profile
from palpate.solver.axisymmetric.tip import Tip
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specimen import Specimen, plane_strain_modulus

WIDTH, WIDTH_POWER = 1.4, 0.07  # s, and how it grows with the elastic pressure over that of the body
STIFFNESS, STIFFNESS_POWER = 8.5, np.array([-0.096, -0.13])  # C, likewise, under a cone and under a sphere
BLEND = 0.552  # b of infinitely small elements
BLEND_OF_GROWTH = np.array([[0.83], [0.0]])  # what it grows by with the growth of the rings, under a cone and a sphere
BLEND_OF_CUBE = np.array([[0.0], [16.0]])  # likewise with the cube of that growth
BLEND_OF_EXCESS = np.array([[0.019], [0.079]])  # with that growth times the squared logarithm of the excess
BLEND_OF_SECTORS = 0.025  # what it falls by with 1 / (squared number of sectors times that growth)
ROUNDS = 12  # towards the radius of the first contact, from which the iteration only begins


def elastic_excess(specimen: Specimen, indenter: Indenter, protocol: Protocol) -> float:
    """Return the mean pressure that an elastic body of the same moduli would bear, over that of the body."""
    slope = indenter.slope
    if not indenter.sharp:
        largest = contact_range(specimen, indenter, protocol)[1]
        slope = min(slope, 0.7 * Profile.of(indenter).slope_for(largest))
    pressure = mean_pressure(specimen.coefficients, slope, loaded_time(protocol))
    return 0.5 * slope * plane_strain_modulus(specimen.coefficients) / pressure


def contact_of(
    profiles: Sequence[Profile],
    excess: np.ndarray,
    friction: Sequence[float],
    attraction: tuple[np.ndarray, np.ndarray, np.ndarray],
    surface: np.ndarray,
    contacts: np.ndarray,
    growth: float,
    sectors: int,
) -> Contact:
    """Return the contact of k surface nodes; lengths are in the unit of each lane.

    Parameters
    ----------
    profiles
        Of each lane.
    excess : ndarray, shape (LANES,)
        See `elastic_excess`.
    friction
        Coulomb's coefficient in each lane.
    attraction
        See `attraction_in_lanes`.
    surface : ndarray, shape (2, k)
        Undeformed distance of each node from the axis, and the area that belongs to it.
    contacts : ndarray, shape (2, LANES)
        Smallest contact radius that counts, and the largest one.
    growth
        Ratio of neighbouring rings.
    sectors
        Number of elements between surface and axis.
    """
    (distance, area), (smallest, largest) = surface, contacts
    spacing = np.gradient(distance)
    spacing = np.minimum(spacing, (growth - 1.0) * np.maximum(distance, distance[2]))
    spacing = np.minimum(spacing[:, None], np.interp(FARTHEST * largest, distance, spacing))
    slopes = [p(np.maximum(distance, s))[1] for p, s in zip(profiles, smallest, strict=True)]
    widened = growth - 1.0
    by_tip = BLEND_OF_GROWTH + BLEND_OF_CUBE * widened**2 + BLEND_OF_EXCESS * np.log(excess) ** 2
    return Contact(
        Tip.of(profiles),
        spacing * WIDTH * excess**WIDTH_POWER,
        area,
        STIFFNESS * excess ** STIFFNESS_POWER[:, None],
        BLEND + widened * by_tip - BLEND_OF_SECTORS / (sectors**2 * widened),
        *attraction,
        np.array(friction),
        SLIP * np.maximum(distance[:, None], smallest) * np.stack(slopes, axis=1),
    )


def attraction_in_lanes(
    adhesions: Sequence[Adhesion | None], units: np.ndarray, nodes: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return attraction (nodes, LANES), strength and reach (LANES,) of a `Contact` with the adhesion of each lane.

    Parameters
    ----------
    adhesions
        Of each lane.
    units : ndarray, shape (LANES,)
        Unit of length of each lane [um].
    nodes
        Number of surface nodes.
    """
    attraction, strength, reach = np.zeros((nodes, LANES)), np.zeros(LANES), np.ones(LANES)
    for lane, adhesion in enumerate(adhesions):
        if adhesion is not None:
            strength[lane], reach[lane] = adhesion.strength, adhesion.reach / units[lane]
            attraction[:, lane] = adhesion.hold
    return attraction, strength, reach


def first_contact(
    profiles: Sequence[Profile], specimens: Sequence[Specimen], durations: Sequence[float], distance: np.ndarray,
    smallest: np.ndarray, loads: np.ndarray,
) -> ContactState:  # fmt: skip
    """Return the state of a contact before it begins, as it is expected at the end of the first step.

    Parameters
    ----------
    profiles, specimens, durations
        Of each lane; lengths in its unit, durations in s, see `palpate.solver.axisymmetric.contact_size.loaded_time`.
    distance : ndarray, shape (k,)
        Of the surface nodes from the axis.
    smallest : ndarray, shape (LANES,)
        Smallest contact radius that counts.
    loads : ndarray, shape (LANES,)
        At the end of the first step, in GPa times the square of the unit; not positive where they are not known.
    """
    radius = smallest.copy()
    for lane, (profile, specimen, load) in enumerate(zip(profiles, specimens, loads, strict=True)):
        for _ in range(ROUNDS if load > 0.0 else 0):
            mean = mean_pressure(specimen.coefficients, profile.slope_for(radius[lane]), durations[lane])
            radius[lane] = 0.5 * (radius[lane] + math.sqrt(load / (math.pi * mean)))
    slope = np.array([p.slope_for(a) for p, a in zip(profiles, radius, strict=True)])
    height = np.array([p.depth_for(a) for p, a in zip(profiles, radius, strict=True)])
    pressure = np.array(
        [mean_pressure(b.coefficients, f, t) for b, f, t in zip(specimens, slope, durations, strict=True)]
    )
    rise, places = 0.5 * slope * (1.0 + radius * slope / height), np.repeat(distance[:, None], LANES, axis=1)
    area, stiffness, none = np.asarray(np.pi * radius**2), np.asarray(STIFFNESS * pressure), np.zeros(LANES)
    return ContactState(
        area, pressure, stiffness, rise, np.full(LANES, BLEND), np.zeros((3, LANES)), none, none.copy(), places,
        np.zeros_like(places), places.copy(),
    )  # fmt: skip
