r"""A rigid tip at given depths in a linear viscoelastic, incompressible half-space, alone and through a spring.

    cone:    P(t) = (4/pi) tan(alpha) int_0^t Y(t - t') d(h^2)
    sphere:  P(t) = (8/3) sqrt(R) int_0^t Y(t - t') d(h^(3/2))

These are Sneddon's and Hertz' solutions with E/(1 - nu^2) = 4G at nu = 0.5 and 2G replaced by the hereditary operator
of the relaxation modulus Y, a Prony series:

    s(t) = int_0^t Y(t - t') de(t'),    Y(t) = Y_inf + sum_i Y_i exp(-lambda_i t).

The inelastic strains x_j, of rates r_j s less x_j / t_j (r = C_s, or C_t / t_eps; 1/t = 0, or 1/t_eps), obey a linear
system whose matrix is similar to the symmetric -(2G w w^T + diag(1/t)), w_j = sqrt(r_j). With its eigenvalues -lambda_i
and eigenvectors v_i,

    Y_i = (2G)^2 (v_i . w)^2 / lambda_i,    Y_inf = 2G - sum_i Y_i.

Assumes a shallow cone, or a contact much smaller than the sphere, small strains, no friction, and a contact that does
not shrink.

Sources: E. H. Lee & J. R. M. Radok, J. Appl. Mech. 27 (1960) 438-444; T. C. T. Ting, J. Appl. Mech. 33 (1966) 845-854;
W. N. Findley, J. S. Lai & K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials (1976), section 5.6, for
the modulus with one Voigt element.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq


def cone(half_angle):
    """Return factor [mN / (GPa um^2)] and exponent of the depth under a cone of a half-angle in degrees."""
    return 4 / np.pi * np.tan(np.radians(half_angle)), 2.0


def sphere(radius):
    """Return factor [mN / (GPa um^1.5)] and exponent of the depth under a sphere of a radius in nm."""
    return 8 / 3 * np.sqrt(1e-3 * radius), 1.5


@dataclass(frozen=True, eq=False)
class RelaxationModulus:
    """Y_inf [GPa], and Y_i [GPa] and lambda_i [1/s] (n,)."""

    equilibrium: float
    moduli: np.ndarray
    rates: np.ndarray

    @classmethod
    def of(cls, solid):
        """Return the modulus of an incompressible `palpate.classical.viscoelastic_depth.Compliance`, half of J."""
        elements = [(2.0 * c / t, 1.0 / t) for c, t in solid.terms if c > 0.0]
        if solid.rate > 0.0:
            elements.append((2.0 * solid.rate, 0.0))
        rate, fading = np.reshape(elements, (-1, 2)).T
        root, stiffness = np.sqrt(rate), 0.5 / solid.instantaneous
        rates, vectors = np.linalg.eigh(stiffness * np.outer(root, root) + np.diag(fading))
        moduli = stiffness**2 * (vectors.T @ root) ** 2 / rates
        return cls(stiffness - moduli.sum(), moduli, rates)

    def __call__(self, time):
        """Return Y [GPa] at `time` [s] >= 0, of the same shape."""
        return self.equilibrium + np.exp(-np.multiply.outer(time, self.rates)) @ self.moduli

    def load(self, protocol, factor, exponent):
        """Return the load [mN] (n,) at the sampling times of a prescribed depth, by quadrature in each segment."""
        time, depth = protocol.knot_time, 1e-3 * protocol.knot_drive
        speed = np.diff(depth) / np.diff(time)

        def until(t):
            total = 0.0
            for start, end, begin, v in zip(time[:-1], time[1:], depth[:-1], speed, strict=True):
                if start < t and v > 0.0:
                    total += quad(
                        lambda q, start=start, begin=begin, v=v: self(t - start - (q ** (1 / exponent) - begin) / v),
                        begin**exponent,
                        (begin + v * (min(end, t) - start)) ** exponent,
                        epsabs=1e-13,
                        epsrel=1e-11,
                    )[0]
            return total

        return factor * np.array([until(t) for t in protocol.sample_time])

    def through_spring(self, protocol, factor, exponent):
        """Return load [mN] and depth [nm] (n,) at the sampling times of a displacement z = h + C P, by integration.

        The hereditary integral is q Y(0) - sum_i Y_i y_i, q = h^n, with dy_i/dt = lambda_i (q - y_i), so that two
        equations determine h and P at any y.
        """
        instantaneous, compliance = self.equilibrium + self.moduli.sum(), 1e-3 * protocol.compliance

        def force(h, y):
            return factor * (instantaneous * h**exponent - self.moduli @ y)

        def depth(t, y):
            z = 1e-3 * float(protocol.drive_at(t))
            if compliance == 0.0 or z <= 0.0:
                return z
            return brentq(lambda h: h + compliance * force(h, y) - z, 0.0, 2.0 * z + 1.0, xtol=1e-15, rtol=1e-14)

        def rate(t, y):
            return self.rates * (depth(t, y) ** exponent - y)

        y, found, start = np.zeros(len(self.rates)), [], 0.0
        for corner in protocol.knot_time[1:]:
            wanted = protocol.sample_time[(protocol.sample_time > start) & (protocol.sample_time <= corner)]
            ends = np.union1d(wanted, corner)
            path = solve_ivp(rate, (start, corner), y, t_eval=ends, rtol=1e-10, atol=1e-14, method="DOP853")
            for t, state in zip(path.t, path.y.T, strict=True):
                if t in wanted:
                    h = depth(t, state)
                    found.append((force(h, state), 1e3 * h))
            y, start = path.y[:, -1], corner
        return np.array(found).T
