r"""Relaxation modulus of the linear Burgers solid, as a Prony series, and the hereditary integral of a growing contact.

    s(t) = int_0^t Y(t - t') de(t'),    Y(t) = Y_inf + sum_i Y_i exp(-lambda_i t)

The inelastic strains x_j, of rates r_j s less x_j / t_j (r = C_s, or C_t / t_eps; 1/t = 0, or 1/t_eps), obey a linear
system whose matrix is similar to the symmetric -(2G w w^T + diag(1/t)), w_j = sqrt(r_j). With its eigenvalues -lambda_i
and eigenvectors v_i,

    Y_i = (2G)^2 (v_i . w)^2 / lambda_i,    Y_inf = 2G - sum_i Y_i.

Assumes incompressibility, as `palpate.analytic.linear_viscoelastic`.

Source: W. N. Findley, J. S. Lai & K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials (1976), section
5.6, for one Voigt element.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad

from palpate.analytic.linear_viscoelastic import LinearBurgers
from palpate.errors import InputError
from palpate.study.protocol import Protocol


@dataclass(frozen=True, eq=False)
class RelaxationModulus:
    """Prony series of the deviatoric relaxation modulus.

    Parameters
    ----------
    equilibrium
        Y_inf [GPa].
    moduli, rates : ndarray, shape (n,)
        Y_i [GPa] and lambda_i [1/s].
    """

    equilibrium: float
    moduli: np.ndarray
    rates: np.ndarray

    @classmethod
    def of(cls, solid: LinearBurgers) -> RelaxationModulus:
        """Return the modulus of a solid whose compliance is known."""
        elements = [(c / t, 1.0 / t) for c, t in solid.voigt if c > 0.0]
        if solid.steady_coefficient > 0.0:
            elements.append((solid.steady_coefficient, 0.0))
        rate, fading = np.reshape(elements, (-1, 2)).T
        root, stiffness = np.sqrt(rate), 2.0 * solid.shear_modulus
        rates, vectors = np.linalg.eigh(stiffness * np.outer(root, root) + np.diag(fading))
        moduli = stiffness**2 * (vectors.T @ root) ** 2 / rates
        return cls(float(stiffness - moduli.sum()), moduli, rates)

    def __call__(self, time: np.ndarray) -> np.ndarray:
        """Return Y [GPa] at `time` [s] >= 0, of the same shape."""
        return self.equilibrium + np.exp(-np.multiply.outer(time, self.rates)) @ self.moduli

    def hereditary_integral(self, protocol: Protocol, exponent: float) -> np.ndarray:
        """Return int_0^t Y(t - t') d(z^n) at the sampling times (m,) [GPa um^n], for prescribed displacements z.

        Raises
        ------
        InputError
            When the displacement falls before the last sample: such solutions hold while contact does not shrink.
        """
        time, drive = protocol.knot_time, 1e-3 * protocol.knot_drive
        speed = np.diff(drive) / np.diff(time)
        if np.any(speed[time[:-1] < protocol.sample_time[-1] * (1 - 1e-12)] < 0):
            raise InputError(
                "the displacement falls before the last sample",
                remedy="end the samples where unloading begins",
                place="protocol",
            )

        def until(t: float) -> float:
            total = 0.0
            for start, end, begin, v in zip(time[:-1], time[1:], drive[:-1], speed, strict=True):
                if start < t and v > 0.0:
                    powers = begin**exponent, (begin + v * (min(end, t) - start)) ** exponent
                    total += quad(
                        lambda q, t=t, start=start, begin=begin, v=v: float(
                            self(np.array(t - start - (q ** (1 / exponent) - begin) / v))
                        ),
                        *powers,
                        epsabs=1e-13,
                        epsrel=1e-11,
                    )[0]
            return total

        return np.array([until(t) for t in protocol.sample_time])
