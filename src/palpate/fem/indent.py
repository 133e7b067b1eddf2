"""A whole load history: choose mesh and steps, march, halve what does not converge, return depth against time."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from palpate.errors import ConvergenceError, InputError
from palpate.fem.adhesion import GPA_UM, Adhesion
from palpate.fem.clock import Clock
from palpate.fem.contact import Profile
from palpate.fem.directions import Directions
from palpate.fem.folding import ever_wider
from palpate.fem.march import march_by
from palpate.fem.mesh import Mesh, Resolution, polar_mesh, ring_radii, volume_above
from palpate.fem.newton import Problem, State, Workspace, advance
from palpate.fem.sensitivity import Sensitivity
from palpate.indenters import Indenter
from palpate.materials.radial import BULK, HARDENING, SHEAR, STEADY, STEADY_EXPONENT, VOIGT, YIELD
from palpate.protocol import Protocol
from palpate.specimen import Specimen, series

RESOLUTIONS = {
    "standard": Resolution(growth=1.10, sectors=8),
    "medium": Resolution(
        growth=1.07, sectors=12, inner=0.15, far=3000.0, outer_growth=1.3, refine=2, load_growth=0.0625
    ),
    "fine": Resolution(growth=1.05, sectors=16, inner=0.1, far=4000.0, outer_growth=1.2, refine=2, load_growth=0.0625),
}
ROUGH = Resolution(growth=1.20, sectors=6, far=1000.0, outer_growth=1.6, load_growth=0.25)  # for differences of curves
LEAST_PART = 1 / 32  # of the attraction, the least growth that is tried
GRADED_START = np.array([0.05, 0.1, 0.2, 0.35, 0.55, 0.77])


@dataclass(frozen=True, eq=False)
class History:
    """Outcome of one simulated indentation.

    Attributes
    ----------
    depth : ndarray, shape (n,)
        Depth at the protocol's sampling times [nm]; NaN from a failure on.
    reason
        Why the history is incomplete; empty when it is whole.
    seconds
        Wall time spent in the solver.
    iterations, steps
        Newton iterations and time steps done.
    derivatives : ndarray, shape (n, p)
        Of the depth, by each parameter asked for [nm per unit of the parameter]; NaN from a failure on.
    """

    depth: np.ndarray
    reason: str
    seconds: float
    iterations: int
    steps: int
    derivatives: np.ndarray


def mean_pressure(coefficients: np.ndarray, slope: float, duration: float) -> float:
    """Estimate the mean contact pressure under a cone [GPa], for the size of the mesh alone.

    A cone of slope cot(alpha) strains what lies under it by about 0.2 cot(alpha) (Johnson, Contact Mechanics, 1985,
    section 6.3); the secant modulus of the law at that strain after `duration` [s] then takes the place of Young's
    modulus in the elastic p_m = E slope / (2 (1 - nu^2)).
    """
    shear, bulk = coefficients[SHEAR], coefficients[1]
    ratio = (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear)

    def pressure(secant_shear: float) -> float:
        return secant_shear * (1 + ratio) * slope / (1 - ratio**2)

    p = pressure(shear)
    for _ in range(30):
        q = p / 3.0
        strain = q / (2 * shear) + duration * coefficients[STEADY] * q ** (2 * coefficients[STEADY_EXPONENT] + 1)
        for c_t, m_t, _t in coefficients[VOIGT:].reshape(-1, 3):
            strain += c_t * q ** (2 * m_t + 1)
        p = np.sqrt(p * pressure(q / (2 * strain)))
    flow = coefficients[YIELD] + 0.2 * slope * coefficients[HARDENING]
    return float(min(p, 2.8 * flow))


def contact_range(specimen: Specimen, indenter: Indenter, protocol: Protocol) -> tuple[float, float]:
    """Estimate the smallest contact radius that counts and the largest one [um].

    The softer of film and substrate decides the largest, the film alone the smallest. Adhesion pulls the surface up to
    the tip: its contact carries the load and what a flat punch would bear at the work of adhesion (JKR, see
    `palpate.analytic.jkr`).
    """
    smallest, largest = _contact_range(specimen.coefficients, specimen.adhesion, indenter, protocol)
    if specimen.substrate is None:
        return smallest, largest
    return smallest, max(largest, _contact_range(specimen.substrate, specimen.adhesion, indenter, protocol)[1])


def _contact_range(
    coefficients: np.ndarray, work: float, indenter: Indenter, protocol: Protocol
) -> tuple[float, float]:
    radius = indenter.radius * 1e-3
    duration = float(protocol.knot_time[-1] * 0.6)
    slope = indenter.slope
    loads = protocol.sample_load
    smallest_load = loads[loads > 0].min(initial=protocol.max_load, where=loads[loads > 0] > 0.005 * protocol.max_load)
    punch = 8.0 * np.pi * plane_strain_modulus(coefficients) * GPA_UM * work

    def contact_radius(load: float) -> float:
        if radius == 0.0 and work == 0.0:
            return float(np.sqrt(load / (np.pi * mean_pressure(coefficients, slope, duration))))
        a = radius * 0.1 if radius else 0.1
        for _ in range(40):
            local = min(slope, 0.7 * a / radius) if radius else slope
            borne = load + np.sqrt(punch * a**3)
            a = 0.5 * (a + np.sqrt(borne / (np.pi * mean_pressure(coefficients, local, duration))))
        return float(a)

    return contact_radius(smallest_load), contact_radius(protocol.max_load)


def plane_strain_modulus(coefficients: np.ndarray) -> float:
    """Return E / (1 - nu^2) of a law [GPa]."""
    shear, bulk = coefficients[SHEAR], coefficients[BULK]
    return float(4 * shear * (3 * bulk + shear) / (3 * bulk + 4 * shear))


def mesh_radii(specimen: Specimen, indenter: Indenter, protocol: Protocol, resolution: Resolution) -> np.ndarray:
    """Return the radii [um] of the rings of the mesh that an indentation needs."""
    return ring_radii(*contact_range(specimen, indenter, protocol), resolution, not indenter.sharp)


def step_times(protocol: Protocol, resolution: Resolution, yields: bool = False) -> np.ndarray:
    """Return the ends of all time steps: samples, knots, steps between them, and a graded onset of loading.

    Where a body yields, a step in which the load grows by more than the resolution's share is divided: the direction of
    plastic flow is that at the end of a step, and a contact that spreads turns it meanwhile.
    """
    ends = np.union1d(protocol.sample_time, protocol.knot_time[1:])
    ends = ends[np.concatenate([[True], np.diff(ends) > 1e-9 * ends[-1]])]
    fine = divided(ends, np.full(len(ends), resolution.refine))
    onset = protocol.knot_time[np.flatnonzero(protocol.knot_load > 0)[0] - 1]
    first = fine[fine > onset * (1 + 1e-9)][0]
    graded = np.union1d(fine, onset + (first - onset) * GRADED_START)
    if not yields:
        return graded
    load = protocol.load_at(graded)
    before = np.append(0.0, load[:-1])
    growth = np.divide(load - before, before, out=np.zeros_like(load), where=before > 0.0)
    return divided(graded, np.maximum(np.ceil(growth / resolution.load_growth - 1e-6), 1).astype(int))


def divided(ends: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return the ends of steps of which each is divided into so many equal parts; the first begins at zero."""
    starts = np.append(0.0, ends[:-1])
    return np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b, n in zip(starts, ends, parts, strict=True)])


def laws_of(specimen: Specimen) -> np.ndarray:
    """Return the laws (regions, c): substrate and film in series, by shares of the film in steps of an eighth."""
    if specimen.substrate is None:
        return specimen.coefficients[None, :]
    return np.stack([series(specimen.coefficients, specimen.substrate, k / 8) for k in range(9)])


def regions(specimen: Specimen, mesh: Mesh, unit: float = 1.0) -> np.ndarray:
    """Return the law of each element (m,), by the share of its volume above the interface; the mesh is in `unit` um."""
    if specimen.substrate is None:
        return np.zeros(len(mesh.elements), dtype=np.int64)
    return np.rint(8 * volume_above(mesh, -1e-3 * specimen.film_thickness / unit)).astype(np.int64)


def resolved(specimen: Specimen, indenter: Indenter, first: float) -> Specimen:
    """Return the specimen with a size effect down to the depth at which the `first` ring of nodes [um] touches."""
    return replace(specimen, shallowest=1e3 * Profile.of(indenter).depth_for(first))


def check_size(specimen: Specimen, indenter: Indenter, resolution: Resolution, largest: float) -> None:
    """Refuse what the mesh for a largest contact radius [um] cannot hold.

    Raises
    ------
    InputError
        When a film is thinner than an element at the edge of contact, or a tip larger than the body.
    """
    element, body = 1e3 * (resolution.growth - 1.0) * largest, 1e3 * resolution.far * largest
    if specimen.film_thickness < element:
        raise InputError(
            f"thickness = {specimen.film_thickness:g} nm is less than an element at the edge of contact",
            remedy=f"give at least {element:.3g} nm, or a smaller load",
            place="mechanisms.film_on_substrate.thickness",
        )
    if indenter.radius > body:
        raise InputError(
            f"radius = {indenter.radius:g} nm is larger than the body that is simulated",
            remedy=f"give at most {body:.3g} nm, or a larger load",
            place="indenter.radius",
        )


def attraction(specimen: Specimen, resolution: Resolution, largest: float, mesh: Mesh) -> Adhesion | None:
    """Return the adhesion of the specimen, ranged for the elements at the edge of the largest contact [um]."""
    if specimen.adhesion == 0.0:
        return None
    modulus = plane_strain_modulus(specimen.coefficients)
    return Adhesion.of(specimen.adhesion, modulus, (resolution.growth - 1.0) * largest, mesh)


def indent(
    specimen: Specimen,
    indenter: Indenter,
    protocol: Protocol,
    resolution: Resolution,
    large: bool = False,
    radii: np.ndarray | None = None,
    directions: Directions | None = None,
    observe: Callable[[Problem, State], None] | None = None,
) -> History:
    """Simulate an indentation.

    Parameters
    ----------
    specimen, indenter, protocol, resolution
        What is pressed, by what, how, and how finely it is resolved.
    large
        Logarithmic instead of linear strains.
    radii : ndarray, optional
        Rings of the mesh [um], in place of `mesh_radii`; simulations that are compared closely should share theirs.
        Where the innermost fold they are merged, see `palpate.fem.folding`.
    directions : Directions, optional
        Derivatives of the inputs by the parameters for which those of the depth are wanted, on a mesh that stays.
    observe
        Called with the problem and the state at the end of every time step asked for, sampling times among them; from
        the beginning again, with another problem, after a failure.

    Returns
    -------
    History
        A failure of the solver is reported in it, never raised.

    Raises
    ------
    InputError
        When the mesh cannot hold the specimen or the tip, see `check_size`, or the depth has no derivative.
    """
    radii = mesh_radii(specimen, indenter, protocol, resolution) if radii is None else radii
    seconds = 0.0
    for rings in ever_wider(radii, specimen, indenter, resolution, large):
        history = indent_on(rings, specimen, indenter, protocol, resolution, large, directions, observe)
        seconds += history.seconds
        if not history.reason:
            break
    return replace(history, seconds=seconds)


def indent_on(
    radii: np.ndarray,
    specimen: Specimen,
    indenter: Indenter,
    protocol: Protocol,
    resolution: Resolution,
    large: bool = False,
    directions: Directions | None = None,
    observe: Callable[[Problem, State], None] | None = None,
) -> History:
    """Simulate an indentation on the mesh with rings at `radii` [um] and no other; see `indent`."""
    began = clock.perf_counter()
    largest = contact_range(specimen, indenter, protocol)[1]
    check_size(specimen, indenter, resolution, largest)
    mesh = polar_mesh(radii, resolution.sectors)
    specimen = resolved(specimen, indenter, radii[0])
    law, region = laws_of(specimen), regions(specimen, mesh)
    adhesion = attraction(specimen, resolution, largest, mesh)
    problem = Problem(mesh, Profile.of(indenter), specimen, law, region, large, indenter.friction, adhesion)
    work = Workspace.of(problem)
    steps_of = partial(step_times, resolution=resolution, yields=specimen.yields)
    ends = steps_of(protocol)
    sensitivity = None
    if directions:
        moved = tuple((steps_of(shift.low), steps_of(shift.high)) for shift in directions.shifts)
        sensitivity = Sensitivity(problem, directions, Clock(ends, moved, directions.shifts, directions.count))
    state, before = State.initial(problem), None
    depth = np.full(len(protocol.sample_time), np.nan)
    derivatives = np.full((len(depth), directions.count if directions else 0), np.nan)
    reason, steps = "", 0
    corners = set(protocol.knot_time)
    for target in ends:
        try:
            state, before, taken = march(problem, protocol, state, before, target, work, sensitivity)
        except ConvergenceError as error:
            reason = str(error)
            break
        steps += taken
        where = np.searchsorted(protocol.sample_time, target * (1 - 1e-12))
        if where < len(depth) and abs(protocol.sample_time[where] - target) <= 1e-9 * target:
            depth[where] = state.depth * 1e3
            if sensitivity:
                derivatives[where] = sensitivity.depth * 1e3
        if observe is not None:
            observe(problem, state)
        if target in corners:
            before = None
    return History(depth, reason, clock.perf_counter() - began, work.iterations, steps, derivatives)


def march(
    problem: Problem,
    protocol: Protocol,
    state: State,
    before: State | None,
    target: float,
    work: Workspace,
    sensitivity: Sensitivity | None = None,
) -> tuple[State, State, int]:
    """March to `target`, halving what does not converge; return the state there, the one before, and the steps."""

    def step(state: State, time: float, load: float, guess: State) -> State:
        return advance_or_ease(problem, state, time, load, protocol.max_load, guess, work)

    follow = partial(sensitivity.follow, work=work) if sensitivity else None
    return march_by(step, protocol, state, before, target, follow)


def advance_or_ease(
    problem: Problem, state: State, time: float, load: float, scale: float, guess: State, work: Workspace
) -> State:
    """Do what `advance` does; where it fails, carefully; where attraction changes the contact, let that grow in parts.

    Each part repeats the whole step and begins where the part before it ended, so only the last one counts.
    """
    try:
        return advance(problem, state, time, load, scale, guess, work)
    except ConvergenceError:
        if problem.adhesion is None:
            return advance(problem, state, time, load, scale, guess, work, careful=True)
    guess, done, more = state, -0.25, 0.25
    while done < 1.0:
        part = min(done + more, 1.0)
        eased = replace(problem, adhesion=problem.adhesion.weakened(part))
        try:
            guess, done, more = advance(eased, state, time, load, scale, guess, work), part, 1.5 * more
        except ConvergenceError:
            more *= 0.5
            if more < LEAST_PART or done < 0.0:
                raise
    return guess
