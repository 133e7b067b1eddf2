"""Families of materials: the law by which the choice among laws begins, and the laws that are compared with it.

The base law of a family has few parameters. Most of the others contain it, or nearly so, at neutral values of their
further parameters, and `neutral` gives these. Eyring flow, whose stress depends on the rate, has no such limit within
usual values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

SATURATION = 0.3  # saturation strain, beyond the strains under the tip: hardening is about linear below
FAINT = 0.01  # compliance of creep beside the elastic one, that is none


@dataclass(frozen=True)
class Family:
    """Laws among which tests choose.

    Parameters
    ----------
    base
        Key of the law that is fitted first, parts joined by ``+``.
    others
        Keys of the laws that are compared with it.
    """

    base: str
    others: tuple[str, ...]

    @property
    def laws(self) -> tuple[str, ...]:
        """Keys of all laws of the family."""
        return (self.base, *self.others)


SPECTRUM, KINEMATIC = "retardation_spectrum", "kinematic_hardening"
FAMILIES = {
    "polymer": Family(
        f"bilinear_plasticity+{SPECTRUM}",
        (
            f"bilinear_plasticity+{KINEMATIC}+{SPECTRUM}",
            f"drucker_prager+{SPECTRUM}",
            f"ludwik_plasticity+{SPECTRUM}",
            f"voce_plasticity+{SPECTRUM}",
            f"hardening_eyring+{SPECTRUM}",
            f"hardening_eyring+{KINEMATIC}+{SPECTRUM}",
        ),
    ),
    "metal": Family(
        "bilinear_plasticity",
        (
            f"bilinear_plasticity+{KINEMATIC}",
            f"bilinear_plasticity+{SPECTRUM}",
            "ludwik_plasticity",
            "voce_plasticity",
        ),
    ),
    # In minutes no glass creeps: what depends on time is the instrument's, and a spectrum would take a lag for creep.
    "glass": Family("bilinear_plasticity", ("drucker_prager", "ludwik_plasticity", "voce_plasticity")),
    "gel": Family(SPECTRUM, (f"nonlinear_burgers+{SPECTRUM}", "elastic")),
}


def neutral(base: Mapping[str, float], loading_time: float) -> dict[str, float]:
    """Return values of the parameters of laws that contain a base law at which they equal it, or nearly so.

    Parameters
    ----------
    base
        Parameters of the base law by name.
    loading_time
        Shortest time of loading among the tests [s].
    """
    stress, hardening = base.get("yield_stress", 0.0), base.get("hardening", 0.0)
    return {
        "kinematic_modulus": 0.0,
        "pressure_coefficient": 0.0,
        "strength": hardening,
        "hardening_exponent": 1.0,
        "saturation_strain": SATURATION,
        "saturation_stress": stress + SATURATION * hardening,
        "spectrum_coefficient": FAINT / base["youngs_modulus"],
        "spectrum_exponent": 0.0,
        "steady_coefficient": 0.0,
        "steady_exponent": 0.0,
        "transient_coefficient": 0.0,
        "transient_exponent": 0.0,
        "retardation_time": loading_time,
        **base,
    }
