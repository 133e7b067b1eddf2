"""What a constitutive law declares: its key, its parameters, and its coefficients for the radial equation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from palpate.parameters import Parameter, check_values

YOUNGS_MODULUS = Parameter("youngs_modulus", "E", "GPa", 1e-6, 2000.0, "Young's modulus")
POISSON_RATIO = Parameter("poisson_ratio", r"\nu", "-", 0.0, 0.4999, "Poisson's ratio")
NO_YIELD = 1e30


@dataclass(frozen=True)
class Law:
    """A constitutive law of the radial family.

    Parameters
    ----------
    key
        Name used in configurations.
    title
        Name used on figures.
    parameters
        Everything a user may give.
    to_coefficients
        Maps checked values by name to the coefficients of `palpate.materials.radial` (G, K, C_s, m_s, sigma_Y, H,
        then C_t, m_t, t_eps of each Voigt element).
    extend
        Maps the names a user gives to the parameters declared, for laws with any number of elements.
    """

    key: str
    title: str
    parameters: tuple[Parameter, ...]
    to_coefficients: Callable[[Mapping[str, float]], np.ndarray]
    extend: Callable[[Mapping[str, object]], tuple[Parameter, ...]] | None = None

    def declared(self, values: Mapping[str, object]) -> tuple[Parameter, ...]:
        """Return the parameters of the law as `values` spells it out."""
        return self.extend(values) if self.extend else self.parameters

    def check(self, values: Mapping[str, object]) -> dict[str, float]:
        """Return all parameters by name, checked; raises `InputError`."""
        return check_values(self.declared(values), values, f"material model {self.key}")

    def coefficients(self, values: Mapping[str, object]) -> np.ndarray:
        """Return the coefficients of the radial equation for `values`; raises `InputError`."""
        return self.to_coefficients(self.check(values))


def elastic_coefficients(values: Mapping[str, float]) -> list[float]:
    """Return G and K [GPa] from `youngs_modulus` and `poisson_ratio`."""
    modulus, ratio = values["youngs_modulus"], values["poisson_ratio"]
    return [modulus / (2 * (1 + ratio)), modulus / (3 * (1 - 2 * ratio))]
