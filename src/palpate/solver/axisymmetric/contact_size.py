"""How large the contact becomes, estimated before anything is simulated: it sets the size of the mesh."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from palpate.errors import InputError
from palpate.materials.flow.estimate import flow_stress, secant_compliance
from palpate.materials.flow.row import SHEAR
from palpate.solver.axisymmetric.mesh import LEAST_LOAD, Resolution
from palpate.solver.axisymmetric.profile import Profile
from palpate.study.indenter import Indenter
from palpate.study.protocol import LOAD, Protocol
from palpate.study.specimen import Specimen, plane_strain_modulus

GPA_UM = 1e-6  # one mJ/m^2
RADII = 81  # contact radii, over eight decades, at which depth and load are estimated
LOADED = 0.6  # of a test, after which the contact is about largest where a body creeps; chosen
SOFTEST = 1e-12  # share of an elastic body's pressure, below which none is sought


def mean_pressure(coefficients: np.ndarray, slope: float, duration: float) -> float:
    """Estimate the mean contact pressure under a cone [GPa], for the size of the mesh alone.

    A cone of slope cot(alpha) strains what lies under it by about 0.2 cot(alpha) (Johnson, Contact Mechanics, 1985,
    section 6.3); the secant modulus of the law at that strain after `duration` [s] then takes the place of Young's
    modulus in the elastic p_m = E slope / (2 (1 - nu^2)). Meshes, tips and first steps of one indentation ask for the
    same.
    """
    return _mean_pressure(coefficients.tobytes(), slope, duration)


@lru_cache(maxsize=256)
def _mean_pressure(law: bytes, slope: float, duration: float) -> float:
    """Return the `mean_pressure` under a law given by its bytes, which are known by their value."""
    coefficients = np.frombuffer(law)
    elastic = 0.5 * slope * plane_strain_modulus(coefficients)

    def too_stiff(share: float) -> float:
        """Compare the secant modulus with Young's at a logarithm of the pressure over that of an elastic body."""
        p = elastic * math.exp(share)
        secant = 1.0 / secant_compliance(coefficients, p / 3.0, p, duration)
        return math.log(secant / (2.0 * coefficients[SHEAR])) - share

    share = brentq(too_stiff, math.log(SOFTEST), 0.0, xtol=1e-12) if too_stiff(0.0) < 0.0 else 0.0
    p = elastic * math.exp(share)
    return float(min(p, 2.8 * flow_stress(coefficients, 0.2 * slope, p)))


@lru_cache(maxsize=64)
def contact_range(specimen: Specimen, indenter: Indenter, protocol: Protocol) -> tuple[float, float]:
    """Estimate the smallest contact radius that counts and the largest one [um].

    The softer of film and substrate decides the largest, the film alone the smallest; with a skin, surface and body
    decide both. Adhesion pulls the surface up to
    the tip: its contact carries the load and what a flat punch would bear at the work of adhesion (K. L. Johnson,
    K. Kendall and A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301-313). All meshes of one indentation ask for the
    same.
    """
    laws = [specimen.coefficients, *([specimen.at_surface] if specimen.skin_depth else [])]
    smallest, largest = zip(*(_contact_range(law, specimen.adhesion, indenter, protocol) for law in laws), strict=True)
    if specimen.substrate is not None:
        largest = (*largest, _contact_range(specimen.substrate, specimen.adhesion, indenter, protocol)[1])
    return min(smallest), max(largest)


def _contact_range(
    coefficients: np.ndarray, work: float, indenter: Indenter, protocol: Protocol
) -> tuple[float, float]:
    radius, profile = indenter.radius * 1e-3, Profile.of(indenter)
    duration = loaded_time(protocol)
    slope = indenter.slope
    loads = _expected_loads(coefficients, indenter, protocol)
    most = expected_load(coefficients, indenter, protocol)
    least = LEAST_LOAD * most
    smallest_load = loads[loads > least].min(initial=most)
    rising = loads[: int(np.argmax(loads)) + 1]
    if (rising[rising > 0] < least).any():
        smallest_load = least
    punch = 8.0 * np.pi * plane_strain_modulus(coefficients) * GPA_UM * work

    def contact_radius(load: float) -> float:
        if indenter.sharp and work == 0.0:
            return float(np.sqrt(load / (np.pi * mean_pressure(coefficients, slope, duration))))
        a = radius * 0.1 if radius else 0.1
        for _ in range(40):
            if indenter.area:
                local = min(slope, 0.7 * profile.slope_for(a))
            else:
                local = min(slope, 0.7 * a / radius) if radius else slope
            borne = load + np.sqrt(punch * a**3)
            a = 0.5 * (a + np.sqrt(borne / (np.pi * mean_pressure(coefficients, local, duration))))
        return float(a)

    return contact_radius(smallest_load), contact_radius(most)


def expected_load(coefficients: np.ndarray, indenter: Indenter, protocol: Protocol) -> float:
    """Return the largest load [mN] on a body of a law; under displacement control an estimate, for mesh and scale."""
    if protocol.control == LOAD:
        return protocol.max_load
    return float(_loads_at(np.array([protocol.largest_drive]), coefficients, indenter, protocol)[0])


def _expected_loads(coefficients: np.ndarray, indenter: Indenter, protocol: Protocol) -> np.ndarray:
    """Return the loads at the sampling times (n,) [mN]; under displacement control an estimate."""
    if protocol.control == LOAD:
        return protocol.sample_load
    return _loads_at(protocol.sample_drive, coefficients, indenter, protocol)


def _loads_at(displacement: np.ndarray, coefficients: np.ndarray, indenter: Indenter, protocol: Protocol) -> np.ndarray:
    """Estimate the loads (n,) [mN] at displacements (n,) [nm] of the transducer; zero where these are not positive.

    The depth is taken as 1.2 times what the tip's slope at the edge of contact makes of the contact radius: a cone's is
    1 (full plasticity without pile-up) to pi/2 times as much (Sneddon).
    """
    duration, slope, cap = loaded_time(protocol), indenter.slope, 1e-3 * indenter.radius
    radius = np.geomspace(1e-8, 1.0, RADII) * max(0.1 * protocol.largest_drive, cap)
    local = np.full(RADII, slope)
    if indenter.area:
        local = np.minimum(slope, [Profile.of(indenter).slope_for(a) for a in radius])
    elif cap:
        local = np.minimum(slope, radius / cap)
    if indenter.sharp:
        pressure = [mean_pressure(coefficients, slope, duration)] * RADII
    else:
        pressure = [mean_pressure(coefficients, 0.7 * f, duration) for f in local]
    load = np.pi * radius**2 * np.array(pressure)
    path = 1.2e3 * radius * local + max(protocol.compliance, 0.0) * load
    wanted = np.maximum(displacement, path[0])
    found = np.exp(np.interp(np.log(wanted), np.log(path), np.log(load)))
    return np.where(displacement > 0.0, found, 0.0)


def loaded_time(protocol: Protocol) -> float:
    """Return how long a body is taken to have crept when its contact is largest [s]."""
    return LOADED * float(protocol.knot_time[-1])


def check_size(specimen: Specimen, indenter: Indenter, resolution: Resolution, largest: float) -> None:
    """Refuse what the mesh for a largest contact radius [um] cannot hold.

    Parameters
    ----------
    specimen, indenter
        Body and tip.
    resolution
        Of the mesh.
    largest
        Largest contact radius [um].

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
