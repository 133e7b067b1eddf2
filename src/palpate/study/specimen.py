"""The body that is pressed: a half-space of one law, a film on an elastic substrate, a size effect, adhesion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from palpate.materials.flow.row import BULK, SHARE, SHEAR, yields


@dataclass(frozen=True, eq=False)
class Specimen:
    """A half-space z <= 0.

    Parameters
    ----------
    coefficients : ndarray, shape (c,)
        The law of the material that the tip touches, see `palpate.materials.flow.row`.
    film_thickness
        Depth at which the substrate begins [nm]; infinite for a homogeneous body.
    substrate : ndarray, shape (c,), optional
        The law of the substrate, with the layout of `coefficients`.
    size_length
        Length of the size effect [nm], see `resistance`; zero for none.
    adhesion
        Work that separates its surface from the tip [mJ/m^2]; zero for none.
    skin_contrast, skin_depth
        At the surface the modulus is larger by this share, which falls to 37 % at the depth [nm]; none at depth zero.
    shallowest
        Depth [nm] below which the resistance rises no further: a first step that begins at zero depth would otherwise
        meet an unbounded resistance, and the next one the stresses that remain from it.
    """

    coefficients: np.ndarray
    film_thickness: float = math.inf
    substrate: np.ndarray | None = None
    size_length: float = 0.0
    adhesion: float = 0.0
    skin_contrast: float = 0.0
    skin_depth: float = 0.0
    shallowest: float = 1e-3

    @property
    def yields(self) -> bool:
        """Whether the material has a yield stress."""
        return yields(self.coefficients)

    @property
    def is_uniform(self) -> bool:
        """Whether it has one law everywhere."""
        return self.substrate is None and not self.skin_depth

    @property
    def at_surface(self) -> np.ndarray:
        """The law (c,) at the surface."""
        surface = self.coefficients.copy()
        surface[[SHEAR, BULK]] *= 1.0 + self.skin_contrast
        return surface

    def softening(self, upper: float, lower: float) -> float:
        """Return the factor on the elastic compliance of a layer between two depths [nm] by the skin: its mean.

        The modulus is E (1 + contrast exp(-z / depth)); the mean of its inverse is an elementary integral.
        """
        begin, end = upper / self.skin_depth, lower / self.skin_depth
        return 1.0 + (
            math.log1p(self.skin_contrast * math.exp(-end)) - math.log1p(self.skin_contrast * math.exp(-begin))
        ) / (end - begin)

    def resistance(self, depth: float) -> float:
        """Return the factor sqrt(1 + length / depth) on the stress that inelastic flow needs at `depth` [nm].

        Source: W.D. Nix and H. Gao, J. Mech. Phys. Solids 46 (1998) 411-425, equation (9), for the hardness.
        """
        return math.sqrt(1.0 + self.size_length / max(depth, self.shallowest)) if self.size_length else 1.0


def halfway(depth: float, before: float, load: float) -> float:
    """Return the depth halfway through a step, which begins at a `depth` under the load `before`.

    While the load rises a sharp tip sinks in with its root; else the depth is taken as it is.
    """
    return 0.5 * depth * (1.0 + root_growth(before, load))


def root_growth(before: float, load: float) -> float:
    """Return the root of the factor by which the load rises in a step; one where it does not, or begins at zero."""
    return math.sqrt(load / before) if load > before > 0.0 else 1.0


def plane_strain_modulus(coefficients: np.ndarray) -> float:
    """Return E / (1 - nu^2) of a law [GPa]."""
    shear, bulk = coefficients[SHEAR], coefficients[BULK]
    return float(4.0 * shear * (3.0 * bulk + shear) / (3.0 * bulk + 4.0 * shear))


def elastic_substrate(coefficients: np.ndarray, modulus: float) -> np.ndarray:
    """Return the law (c,) of an elastic substrate of modulus E = `modulus` [GPa] and the film's Poisson's ratio."""
    shear, bulk = coefficients[SHEAR], coefficients[BULK]
    youngs = 9 * bulk * shear / (3 * bulk + shear)
    substrate = coefficients.copy()
    substrate[[SHEAR, BULK]] *= modulus / youngs
    return without_flow(substrate)


def under_tip(coefficients: np.ndarray, compliance: float) -> np.ndarray:
    """Return the law that under a rigid indenter does what `coefficients` do under one of `compliance` [1/GPa].

    The elastic moduli are lowered until the plane-strain modulus equals the reduced one, Poisson's ratio kept:

        1/E_r = (1 - nu^2)/E + (1 - nu_i^2)/E_i

    Exact where both bodies are elastic half-spaces (Hertz, Sneddon), since both deform under the same pressures; with
    plastic flow or creep it is the usual approximation, which rests on the curve's depending on E_r alone.

    Source: K.L. Johnson, Contact Mechanics (1985), equation (4.6), for elastic bodies; M. Dao et al., Acta Mater. 49
    (2001) 3899-3918, section 2, for elastic-plastic ones.
    """
    lowered = coefficients.copy()
    lowered[[SHEAR, BULK]] /= 1.0 + plane_strain_modulus(coefficients) * compliance
    return lowered


def without_flow(coefficients: np.ndarray) -> np.ndarray:
    """Return the elastic part (c,) of a law (c,), in the same layout."""
    elastic = coefficients.copy()
    elastic[SHARE] = 0.0
    return elastic
