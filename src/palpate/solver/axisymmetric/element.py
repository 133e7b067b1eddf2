"""Internal forces and stiffness at small strains, for `LANES` bodies of one shape at once.

The bodies differ in size: lengths are measured in units of one's own, forces in GPa times its square. Then they share
all that the mesh decides.

Arguments of the kernels:

- `body`: `Body`; `points`: state of the Gauss points, see `palpate.solver.axisymmetric.law_lanes.Points`
- `laws`, `weights` (regions, rows, LANES): laws and their weights in the time step, see `palpate.materials.flow.row`
- `displacement`, `forces` (size + 1, LANES): nodal displacements, and internal forces; the last row belongs to held
  nodes
- `band` (size * width + 1, LANES): lower half of the matrix, see `palpate.solver.axisymmetric.banded`
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from palpate.base.inner_kernel import inner_kernel
from palpate.materials.flow.radial import NOTHING, borne, solve_radial
from palpate.materials.flow.row import BACK_STRESS, BULK, PRESSED, SPLIT, STATE
from palpate.solver.axisymmetric.banded import PANEL
from palpate.solver.axisymmetric.lanes import LANES, load, root, splat, store, where_less
from palpate.solver.axisymmetric.law_lanes import region_of
from palpate.solver.axisymmetric.mesh import Mesh

LOWER = np.array([(i, j) for i in range(8) for j in range(i + 1)])


class Body(NamedTuple):
    """What bodies of one shape share.

    Attributes
    ----------
    unknowns : ndarray of int, shape (m, 8)
        Row of each displacement component of an element; those that are held share the row `size`, which stays zero.
    gradients, volumes
        See `palpate.solver.axisymmetric.mesh.Mesh`.
    dilatation : ndarray, shape (m, 8)
        See `fixed_matrices`.
    stiffness : ndarray, shape (m, 36, 5)
        For each pair `LOWER` of an element's unknowns the stiffness at unit q/rho of each Gauss point, and at unit bulk
        modulus.
    entries : ndarray of int, shape (m, 36)
        Row of the band where each pair goes, see `palpate.solver.axisymmetric.banded`; those that are held go behind
        it.
    radial, vertical : ndarray of int, shape (k,)
        Rows of the surface nodes' two components; -1 for the radial one of the apex.
    distance : ndarray, shape (k,)
        Distance of the surface nodes from the axis.
    size, width
        Number of unknowns, and of the rows that each takes in the band.
    """

    unknowns: np.ndarray
    gradients: np.ndarray
    volumes: np.ndarray
    dilatation: np.ndarray
    stiffness: np.ndarray
    entries: np.ndarray
    radial: np.ndarray
    vertical: np.ndarray
    distance: np.ndarray
    size: int
    width: int

    @classmethod
    def of(cls, mesh: Mesh) -> Body:
        """Return the body of a mesh whose unit of length is the bodies' own.

        An element that collapses at the apex counts its node there once, with the sum of both shape functions.
        """
        gradients, equations = mesh.gradients.copy(), mesh.equations[mesh.elements]
        twice = mesh.elements[:, 0] == mesh.elements[:, 3]
        gradients[twice, :, :, 0] += gradients[twice, :, :, 3]
        gradients[twice, :, :, 3] = 0.0
        equations[twice, 3] = -1
        equations = equations.reshape(-1, 8)
        deviatoric, dilatation = fixed_matrices(gradients, mesh.weights)
        i, j = LOWER.T
        volumetric = mesh.weights.sum(axis=1)[:, None] * dilatation[:, i] * dilatation[:, j]
        first, second = np.minimum(equations[:, i], equations[:, j]), np.maximum(equations[:, i], equations[:, j])
        width = int((second - first)[first >= 0].max()) + PANEL
        return cls(
            np.where(equations < 0, mesh.size, equations),
            gradients,
            mesh.weights,
            dilatation,
            np.concatenate([np.moveaxis(deviatoric[:, :, i, j], 1, 2), volumetric[:, :, None]], axis=2),
            np.where(first < 0, mesh.size * width, first * width + second - first),
            mesh.equations[mesh.surface, 0],
            mesh.equations[mesh.surface, 1],
            mesh.nodes[mesh.surface, 0],
            mesh.size,
            width,
        )


@inner_kernel(cache=True)
def internal_forces(body, points, laws, weights, displacement, forces):
    """Write the `forces` (size + 1, LANES) of the stress at a `displacement` (same), and the solution at `points`."""
    forces[:] = 0.0
    u, f = np.empty((8, LANES)), np.empty((8, LANES))
    for e in range(body.unknowns.shape[0]):
        region = region_of(e, laws)
        law, step, bulk = laws[region], weights[region], load(laws[region], BULK)
        pressed, stateful = law[PRESSED, 0] > 0.0, law[STATE, 0] > 0.0
        backed, split = law[BACK_STRESS, 0] > 0.0, load(step, SPLIT)
        dilatation = body.dilatation[e]
        # Mean dilatation of the element: its four Gauss points share one pressure, or isochoric flow would lock it.
        theta = splat(0.0)
        for i in range(8):
            value = load(displacement, body.unknowns[e, i])
            store(u, i, value)
            theta = theta + dilatation[i] * value
        volumes = body.volumes[e]
        squeezed = splat(0.0) - bulk * theta
        store(points.pressure, e, squeezed)
        pressure = bulk * theta * (volumes[0] + volumes[1] + volumes[2] + volumes[3])
        for i in range(8):
            store(f, i, pressure * dilatation[i])
        for g in range(4):
            gradients, p = body.gradients[e, g], 4 * e + g
            err, ezz, ett, erz = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
            for a in range(4):
                radial, vertical = load(u, 2 * a), load(u, 2 * a + 1)
                err = err + gradients[0, a] * radial
                ezz = ezz + gradients[1, a] * vertical
                ett = ett + gradients[2, a] * radial
                erz = erz + (gradients[1, a] * radial + gradients[0, a] * vertical)
            mean = (err + ezz + ett) * (1.0 / 3.0)
            # R of the radial equation: the strain deviator less what the history fixes; r3 is half of the shear angle.
            r0 = split * (err - mean) - load(points.past, 4 * p)
            r1 = split * (ezz - mean) - load(points.past, 4 * p + 1)
            r2 = split * (ett - mean) - load(points.past, 4 * p + 2)
            r3 = split * (0.5 * erz) - load(points.past, 4 * p + 3)
            rho = root(0.5 * (r0 * r0 + r1 * r1 + r2 * r2) + r3 * r3)
            rho = where_less(rho, splat(NOTHING), splat(NOTHING), rho)
            last, log_q, order = load(points.rho, p), load(points.log_q, p), load(points.order, p)
            # A law that does not harden has no alpha to load; any vector serves in its place.
            strained = load(points.alpha, p) if stateful else rho
            q, log_q, order, push = solve_radial(rho, last, log_q, order, strained, squeezed, law, step)
            inverse = 1.0 / rho
            store(points.rho, p, rho)
            store(points.log_q, p, log_q)
            store(points.secant, p, q * inverse)
            store(points.order, p, order)
            if pressed:
                store(points.push, p, push)
            r0, r1, r2, r3 = r0 * inverse, r1 * inverse, r2 * inverse, r3 * inverse
            store(points.direction, 4 * p, r0)
            store(points.direction, 4 * p + 1, r1)
            store(points.direction, 4 * p + 2, r2)
            store(points.direction, 4 * p + 3, r3)
            # s, along R but for a back stress, whose work with the gradients is the force of each node.
            size, _, _ = borne(q * inverse, order, push, step)
            size = size * rho * volumes[g]
            r0, r1, r2, r3 = r0 * size, r1 * size, r2 * size, r3 * size
            if backed:
                r0, r1 = r0 + volumes[g] * load(points.back, 4 * p), r1 + volumes[g] * load(points.back, 4 * p + 1)
                r2, r3 = r2 + volumes[g] * load(points.back, 4 * p + 2), r3 + volumes[g] * load(points.back, 4 * p + 3)
            for a in range(4):
                nr, nz, nt = gradients[0, a], gradients[1, a], gradients[2, a]
                store(f, 2 * a, load(f, 2 * a) + (r0 * nr + r2 * nt + r3 * nz))
                store(f, 2 * a + 1, load(f, 2 * a + 1) + (r1 * nz + r3 * nr))
        for i in range(8):
            row = body.unknowns[e, i]
            store(forces, row, load(forces, row) + load(f, i))


@inner_kernel(cache=True)
def stiffness(body, points, laws, weights, band):
    """Write the lower half of the consistent tangent at the solution of `points` to the `band`.

    Of what the pressure does to the flow it holds the symmetric half.
    """
    band[:] = 0.0
    v, w = np.empty((8, 4, LANES)), np.empty((8, 4, LANES))
    secant, pushes, squeeze = np.empty((4, LANES)), np.empty((4, LANES)), np.empty((8, LANES))
    for e in range(body.unknowns.shape[0]):
        law, step = laws[region_of(e, laws)], weights[region_of(e, laws)]
        bulk, pressed, split = load(law, BULK), law[PRESSED, 0] > 0.0, load(step, SPLIT)
        for g in range(4):
            gradients, p = body.gradients[e, g], 4 * e + g
            ratio, order, push = borne(load(points.secant, p), load(points.order, p), load(points.push, p), step)
            ratio = split * ratio
            store(pushes, g, push)
            store(secant, g, ratio)
            # ds = (q/rho) (dR + (order - 1) direction (direction : dR) / 2): fixed by the mesh, and of rank one.
            excess = (0.5 * body.volumes[e, g]) * ratio * (order - 1.0)
            r0, r1 = load(points.direction, 4 * p), load(points.direction, 4 * p + 1)
            r2, r3 = load(points.direction, 4 * p + 2), load(points.direction, 4 * p + 3)
            for a in range(4):
                nr, nz, nt = gradients[0, a], gradients[1, a], gradients[2, a]
                radial, vertical = r0 * nr + r2 * nt + r3 * nz, r1 * nz + r3 * nr
                store(v, 8 * a + g, radial)
                store(v, 8 * a + 4 + g, vertical)
                store(w, 8 * a + g, radial * excess)
                store(w, 8 * a + 4 + g, vertical * excess)
        # The pressure that slows the flow couples stress to dilatation: half of it and its transpose are added below.
        if pressed:
            for i in range(8):
                value = splat(0.0)
                for g in range(4):
                    value = value + body.volumes[e, g] * load(pushes, g) * load(v, 4 * i + g)
                store(squeeze, i, 0.5 * bulk * value)
        s0, s1, s2, s3 = load(secant, 0), load(secant, 1), load(secant, 2), load(secant, 3)
        pair = 0
        for i in range(8):
            w0, w1, w2, w3 = load(w, 4 * i), load(w, 4 * i + 1), load(w, 4 * i + 2), load(w, 4 * i + 3)
            for j in range(i + 1):
                unit, row = body.stiffness[e, pair], body.entries[e, pair]
                value = load(band, row) + bulk * unit[4]
                value = value + (s0 * unit[0] + s1 * unit[1])
                value = value + (s2 * unit[2] + s3 * unit[3])
                value = value + (w0 * load(v, 4 * j) + w1 * load(v, 4 * j + 1))
                value = value + (w2 * load(v, 4 * j + 2) + w3 * load(v, 4 * j + 3))
                if pressed:
                    value = value - body.dilatation[e, j] * load(squeeze, i) - body.dilatation[e, i] * load(squeeze, j)
                store(band, row, value)
                pair += 1


@njit(cache=True)
def fixed_matrices(gradients, volumes):
    """Return the matrices M = B^T I_dev B (m, 4, 8, 8) times volume, and the mean rows of tr B (m, 8)."""
    count = gradients.shape[0]
    deviatoric = np.zeros((count, 4, 8, 8))
    dilatation = np.zeros((count, 8))
    b = np.zeros((4, 8))
    for e in range(count):
        volume = volumes[e].sum()
        for g in range(4):
            weight = volumes[e, g]
            for a in range(4):
                nr, nz, nt = gradients[e, g, 0, a], gradients[e, g, 1, a], gradients[e, g, 2, a]
                b[0, 2 * a], b[1, 2 * a + 1], b[2, 2 * a] = nr, nz, nt
                b[3, 2 * a], b[3, 2 * a + 1] = 0.5 * nz, 0.5 * nr
                dilatation[e, 2 * a] += weight / volume * (nr + nt)
                dilatation[e, 2 * a + 1] += weight / volume * nz
            for i in range(8):
                third = (b[0, i] + b[1, i] + b[2, i]) / 3.0
                for j in range(8):
                    value = 2.0 * b[3, i] * b[3, j]
                    for k in range(3):
                        value += (b[k, i] - third) * b[k, j]
                    deviatoric[e, g, i, j] = weight * value
    return deviatoric, dilatation
