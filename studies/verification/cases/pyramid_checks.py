"""The Berkovich pyramid in three dimensions: against its equivalent cone, a published formula and refined meshes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from palpate.analytic import berkovich
from palpate.materials import LAWS
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid.indent_3d import RESOLUTIONS, indent_3d
from palpate.solver.pyramid.mesh_3d import Mesh3D
from palpate.solver.pyramid.problem_3d import Problem3D, State
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification
from palpate.study.specimen import Specimen
from studies.verification.case import Outcome, Plot, PlottedSeries, Row, Settings, Verification, depth, worst
from studies.verification.cases.mesh_convergence import richardson
from studies.verification.reference_materials import BURGERS, CONE, HOOKE

PYRAMID = Indenter("berkovich", face_angle=65.27)
LOADING = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.linspace(0.1, 1.0, 10))
MANY = np.geomspace(0.4, 1.0, 40)  # so that the contact meets every place between two nodes equally often
GROWING = Protocol(np.array([0.0, 1.0]), np.array([0.0, 1.0]), MANY)
CREEP = trapezoid(1.0, 30.0, 0.0, 30.0)
PUNCH = 1.034  # King, Int. J. Solids Struct. 23 (1987) 1657-1664: a flat triangular punch
WITHIN = {"standard": 0.007, "fine": 0.004}  # of the depth, by accuracy
SIMILAR_WITHIN, PUBLISHED_WITHIN, CONVERGED_WITHIN, LARGE_WITHIN = 0.003, 0.02, 0.01, 0.004


def contact_area(mesh: Mesh3D, displacement: np.ndarray, touching: np.ndarray) -> float:
    """Return the projected area [um^2] of the whole contact, all six wedges, whose nodes are `touching` (n,).

    On each ray of surface nodes the contact ends halfway, in the logarithm of the distance from the axis, between the
    last node that touches and the next one, both where `displacement` (n, 3) has put them. Between rays at the angles
    p and q it ends on a curve that encloses r(p) r(q) (q - p)/2: a circle exactly, a straight line nearly.
    """
    nodes = mesh.surface[1:]
    (x, y, _), (one, two, _) = mesh.nodes[nodes].T, displacement[nodes].T
    angle, distance = np.round(np.arctan2(y, x), 6), np.hypot(x, y)
    cos, sin = mesh.turn[nodes].T
    moved = np.hypot(x + cos * one - sin * two, y + sin * one + cos * two)
    rays = np.lexsort((distance, angle)).reshape(len(np.unique(angle)), -1)
    ray, last = np.arange(len(rays)), touching[nodes[rays]].sum(axis=1)
    edge = np.sqrt(moved[rays[ray, last - 1]] * moved[rays[ray, last]])
    return float(3.0 * np.sum(edge[1:] * edge[:-1] * np.diff(angle[rays[:, 0]])))


@dataclass(frozen=True, eq=False)
class Elastic:
    """An elastic loading curve in three dimensions.

    Attributes
    ----------
    loading : Protocol
    depth : ndarray, shape (n,)
        [nm]
    area : float
        Contact area over depth squared, mean of the samples.
    nodes : int
    seconds : float
        Wall time.
    """

    loading: Protocol
    depth: np.ndarray
    area: float
    nodes: int
    seconds: float

    @classmethod
    def of(cls, indenter: Indenter, resolution: Resolution, loading: Protocol) -> Elastic:
        """Simulate the epoxy without its creep."""
        areas, nodes = [], set()

        def observe(problem: Problem3D, state: State) -> None:
            nodes.add(len(problem.mesh.nodes))
            if state.time >= loading.sample_time[0]:
                areas.append(contact_area(problem.mesh, state.displacement, state.contact) / state.depth**2)

        specimen = Specimen(LAWS["elastic"].coefficients(HOOKE))
        history = indent_3d(specimen, indenter, loading, resolution, observe=observe)
        return cls(loading, history.depth, float(np.mean(areas)), nodes.pop(), history.seconds)

    @property
    def similarity(self) -> np.ndarray:
        """Depth over the root of the load (n,) [nm/mN^0.5], which should be constant."""
        return self.depth / np.sqrt(self.loading.sample_load)

    @property
    def stiffness(self) -> float:
        """Stiffness over the root of the contact area, in proportion to beta in S = beta (2/sqrt(pi)) E* sqrt(A)."""
        return float(np.mean(self.similarity**-2)) / np.sqrt(self.area)


def run(settings: Settings) -> Outcome:
    """Compare, elastic and with creep; the factor beta and the creep curves are reported, not checked."""
    rows: list[Row] = []
    notes = ["One sixth of the body, by symmetry; the equivalent cone has the same section at every height."]
    exact = depth(Specification("elastic", HOOKE, CONE, LOADING, accuracy="fine", kinematics="small"))
    for accuracy in ("standard",) if settings.quick else ("standard", "fine"):
        cone, pyramid = (Elastic.of(indenter, RESOLUTIONS[accuracy], LOADING) for indenter in (CONE, PYRAMID))
        quantity = f"cone, elastic: depth in three dimensions, {accuracy}, worst sample [nm]"
        rows.append(worst(quantity, exact, cone.depth, WITHIN[accuracy], "expected: the axisymmetric solver, fine"))
        scaled = pyramid.similarity
        quantity = f"pyramid, elastic: depth / sqrt(load) along one curve, {accuracy} [nm/mN^0.5]"
        rows.append(worst(quantity, np.full(len(scaled), scaled.mean()), scaled, SIMILAR_WITHIN, "expected: its mean"))
        published = berkovich.depth(1.0, **HOOKE)
        note = "expected: Larsson et al. 1996, finite elements, no error stated"
        quantity = f"pyramid, elastic: depth, {accuracy} [nm]"
        rows.append(Row(quantity, float(published), float(pyramid.depth[-1]), PUBLISHED_WITHIN, note))
        quantity = f"load at equal depth, pyramid over cone, {accuracy}"
        gain = float(np.mean((cone.depth / pyramid.depth) ** 2))
        rows.append(Row(quantity, 1.0, gain, None, "not a check"))
        notes.append(f"{accuracy}: {pyramid.nodes} nodes, {pyramid.seconds:.1f} s for an elastic loading curve.")
    if settings.quick:
        return Outcome(rows, notes=notes)
    rows += [*_refined(RESOLUTIONS["standard"]), _beta(RESOLUTIONS["standard"])]
    rows += _large_strains("standard")
    creep_rows, plot = _creep("medium")
    return Outcome(rows + creep_rows, [plot], notes)


def _refined(standard: Resolution) -> list[Row]:
    """Refine the shells and their growth together, by halves, to an extrapolated depth."""
    meshes = [Resolution(growth=1.1 ** (12 / sectors), sectors=sectors) for sectors in (3, 6, 12)]
    curves = [Elastic.of(PYRAMID, mesh, LOADING) for mesh in (*meshes, standard)]
    *values, found = [float(np.mean(curve.similarity)) for curve in curves]
    order, limit = richardson(values)
    listed = ", ".join(f"{curve.nodes} nodes {value:.1f}" for curve, value in zip(curves[:3], values, strict=True))
    return [
        Row("pyramid, elastic: observed order in the mesh", 2.0, order, None, f"not a check; {listed} nm/mN^0.5"),
        Row(
            "pyramid, elastic: depth / sqrt(load), standard against extrapolated [nm/mN^0.5]",
            limit,
            found,
            CONVERGED_WITHIN,
        ),
    ]


def _beta(resolution: Resolution) -> Row:
    """Report the stiffness at equal contact area."""
    cone, pyramid = (Elastic.of(indenter, resolution, GROWING).stiffness for indenter in (CONE, PYRAMID))
    note = "not a check: expected is King's flat triangular punch; the elastic contact has hollow sides"
    return Row("beta: stiffness at equal contact area, pyramid over cone, standard", PUNCH, pyramid / cone, None, note)


def _large_strains(accuracy: str) -> list[Row]:
    """Compare what large strains change at peak, under the cone and under the pyramid, with the axisymmetric solver."""
    body, peak = Specimen(LAWS["nonlinear_burgers"].coefficients(BURGERS)), int(np.argmax(CREEP.sample_load))

    def in_space(tip: Indenter) -> float:
        histories = (indent_3d(body, tip, CREEP, RESOLUTIONS[accuracy], large) for large in (False, True))
        small, large = (history.depth[peak] for history in histories)
        return float(large / small)

    flat = Specification("nonlinear_burgers", BURGERS, CONE, CREEP, accuracy="fine", kinematics="small")
    expected = float(depth(replace(flat, kinematics="large"))[peak] / depth(flat)[peak])
    quantity = f"epoxy: depth at peak, large over small strains, {accuracy}"
    note = "not a check: expected is the cone's"
    return [
        Row(f"{quantity}, cone", expected, in_space(CONE), LARGE_WITHIN, "expected: the axisymmetric solver, fine"),
        Row(f"{quantity}, pyramid", expected, in_space(PYRAMID), None, note),
    ]


def _creep(accuracy: str) -> tuple[list[Row], Plot]:
    """Compare the epoxy's curves under the pyramid and under its equivalent cone."""
    curves = [
        depth(Specification("nonlinear_burgers", BURGERS, indenter, CREEP, accuracy=accuracy, kinematics="small"))
        for indenter in (CONE, PYRAMID)
    ]
    cone, pyramid = curves
    peak, note = (
        int(np.argmax(CREEP.sample_load)),
        "not a check: difference between the pyramid and its equivalent cone",
    )
    rows = [
        Row(f"epoxy: depth at {name}, pyramid against cone, {accuracy} [nm]", cone[k], pyramid[k], None, note)
        for name, k in (("peak", peak), ("the end", -1))
    ]
    ratio = "epoxy: residual over peak depth, pyramid against cone"
    rows.append(Row(ratio, float(cone[-1] / cone[peak]), float(pyramid[-1] / pyramid[peak]), None, note))
    time = CREEP.sample_time
    plot = Plot(
        "pyramid",
        "time [s]",
        "depth of the epoxy [nm]",
        [
            PlottedSeries("equivalent cone", time, cone, True),
            PlottedSeries("Berkovich pyramid", time, pyramid),
        ],
        [PlottedSeries("pyramid - cone", time, 100 * (pyramid / cone - 1))],
    )
    return rows, plot


CASES = (Verification("pyramid", "Berkovich pyramid in three dimensions", run),)
