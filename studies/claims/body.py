"""A Burgers solid under a cone with mechanisms, in closed form, as a forward model.

What acts on the compliance, the load or the angle enters Ting's solution; a size effect, a rounded tip and a film
change its depth: by the resistance of Nix and Gao (J. Mech. Phys. Solids 46 (1998) 411), by the way from the bottom of
a cap to the apex of its cone, and by the elastic weights of Gao, Chiu and Lee (Int. J. Solids Struct. 29 (1992) 2471).
Mechanisms of the instrument are those of the library. Offered is what a diagnosis considers where a study names
nothing, but for adhesion, friction and yielding, which have no closed form here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palpate.classical.viscoelastic_depth import Compliance
from palpate.configuration.condition import Condition
from palpate.mechanisms import MECHANISMS, Mechanism, Scale
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol
from palpate.study.specification import Specification
from studies.coverage.creep import HALF_ANGLE, POISSON_RATIO, burgers, depth
from studies.coverage.solid import RANGES, BurgersSolid

Amplitudes = Mapping[str, Mapping[str, float]]

NO_CLOSED_FORM = ("adhesion", "friction", "plastic_yield")
KEYS = tuple(key for key, each in MECHANISMS.items() if each.by_default and key not in NO_CLOSED_FORM)
TANGENT = math.tan(math.radians(HALF_ANGLE))
CAP = 1.0 / math.sin(math.radians(HALF_ANGLE)) - 1.0  # way from the bottom of a cap to the apex, in radii
RADIUS = 2.0 / math.pi * TANGENT  # of contact of an elastic cone, in depths
ROUNDS = 12  # of the fixed point for the depth with a size effect


def recorded(compliance: Compliance, protocol: Protocol, amplitudes: Amplitudes) -> np.ndarray:
    """Return the depth (n,) [nm] that is recorded on a compliance with mechanisms of these amplitudes."""
    found = of_body(compliance, protocol, amplitudes)
    for key in [key for key in amplitudes if not MECHANISMS[key].acts_on_body]:
        found = MECHANISMS[key].record(protocol.sample_time, protocol.sample_load, found, amplitudes[key])
    return found


def of_body(compliance: Compliance, protocol: Protocol, amplitudes: Amplitudes) -> np.ndarray:
    """Return the depth (n,) [nm] of a body with those mechanisms that act on it."""
    elastic = compliance.instantaneous
    if more := amplitudes.get("second_voigt"):
        element = (0.5 * more["coefficient"], more["retardation_time"])
        compliance = replace(compliance, terms=(*compliance.terms, element))
    found = depth(compliance, protocol)
    if late := amplitudes.get("controller_lag"):
        time = np.append(0.0, protocol.sample_time)
        found = np.interp(protocol.sample_time - late["lag"], time, np.append(0.0, found))
    if tip := amplitudes.get("tip_angle"):
        found = found * math.sqrt(TANGENT / math.tan(math.radians(tip["half_angle"])))
    if film := amplitudes.get("film_on_substrate"):
        found = found * np.sqrt(_softer(RADIUS * found / film["thickness"], elastic, film["substrate_modulus"]))
    if size := amplitudes.get("size_effect"):
        sharp = found
        for _ in range(ROUNDS):
            found = sharp * (1.0 + size["length"] / np.maximum(found, 1e-3)) ** -0.25
    if tip := amplitudes.get("tip_rounding"):
        lost = CAP * tip["radius"]
        found = found + lost * np.expm1(-found / lost)
    return found


def _softer(reach: np.ndarray, elastic: float, substrate_modulus: float) -> np.ndarray:
    """Return by how much the compliance of a film differs from its bulk's, for radii of contact (n,) in thicknesses."""
    ratio = 1.0 / np.maximum(reach, 1e-6)
    square = ratio**2
    of_film = 2.0 / math.pi * np.arctan(ratio)
    of_film += ((1.0 - 2.0 * POISSON_RATIO) * ratio * np.log1p(1.0 / square) - ratio / (1.0 + square)) / (
        2.0 * math.pi * (1.0 - POISSON_RATIO)
    )
    modulus = (1.0 - POISSON_RATIO**2) / elastic
    return of_film + (1.0 - of_film) * modulus / substrate_modulus


@dataclass(frozen=True, eq=False)
class BodyWithMechanisms(BurgersSolid):
    """The solid of the coverage study, which mechanisms may join.

    Parameters
    ----------
    mechanisms, scale
        That act, and the size of the study by which their amplitudes are searched for.
    """

    mechanisms: tuple[Mechanism, ...] = ()
    scale: Scale | None = None

    def joined(self, mechanisms: Sequence[Mechanism], scale: Scale) -> BodyWithMechanisms:  # type: ignore[override]
        """Return the model with mechanisms, whose amplitudes are further coordinates."""
        coordinates = self.coordinates.joined(mechanisms, scale)
        return replace(self, coordinates=coordinates, mechanisms=(*self.mechanisms, *mechanisms), scale=scale)

    def amplitudes(self, u: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters of each mechanism at coordinates u (k,), by its key."""
        named, found = self.coordinates.named(u), dict[str, dict[str, float]]()
        for mechanism in self.mechanisms:
            assert self.scale is not None
            searched = {name: named[f"{mechanism.key}.{name}"] for name in mechanism.searched(self.scale)}
            found[mechanism.key] = dict(mechanism.from_search(searched, self.scale))
        return found

    def specification(self, u: np.ndarray, condition: Condition) -> Specification:
        """Return the body at coordinates u (k,) as finite elements would simulate it: a linear Burgers solid."""
        named = self.coordinates.named(u)
        linear = {name: named[name] for name in RANGES} | {"steady_exponent": 0.0, "transient_exponent": 0.0}
        parameters = linear | {"poisson_ratio": POISSON_RATIO}
        return Specification("nonlinear_burgers", parameters, Indenter("cone", HALF_ANGLE), condition.protocol)

    def _curves(self, u: np.ndarray) -> dict[str, np.ndarray]:
        material = {name: value for name, value in self.coordinates.named(u).items() if "." not in name}
        compliance, amplitudes, found = burgers(**material), self.amplitudes(u), dict[str, np.ndarray]()
        for condition in self.conditions:
            curve = recorded(compliance, condition.protocol, amplitudes)
            found[condition.name] = curve[self.keep[condition.name]] if self.keep else curve
        return found
