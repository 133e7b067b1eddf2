"""Stress under a pyramid: equilibrium with the indenter, Hertz' stress under a sphere, and the files that hold it."""

import meshio
import numpy as np
import pytest
import yaml

from palpate.cli.main import main
from palpate.materials import LAWS
from palpate.solver import simulation
from palpate.solver.axisymmetric.mesh import Resolution
from palpate.solver.pyramid.fields_3d import along_xyz, cauchy_stress, fields_of
from palpate.solver.pyramid.indent_3d import indent_3d
from palpate.solver.simulation import specification_from, states_at
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specimen import Specimen
from studies.verification.reference_materials import BURGERS

pytestmark = pytest.mark.slow

SPEC = {
    "material": {"model": "burgers_plasticity", **BURGERS, "yield_stress": 0.15, "hardening": 0.3},
    "indenter": {"shape": "berkovich"},
    "protocol": {"max_load": 1.0, "loading_time": 10, "unloading_time": 10, "points": 12},
    "kinematics": "small",
}


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    monkeypatch.setitem(simulation.RESOLUTIONS_3D, "standard", Resolution(growth=1.3, sectors=3))


def internal_force(problem, state):
    """Force of the stresses on the nodes along their own axes, by virtual work in the deformed body."""
    mesh, (xx, yy, zz, xy, yz, zx) = problem.mesh, np.moveaxis(cauchy_stress(problem, state), -1, 0)
    gradient = np.einsum("eai,egaj->egij", along_xyz(problem, state)[mesh.elements], mesh.gradients)
    deformation = np.eye(3) + (gradient if problem.large else 0.0 * gradient)
    slopes = np.einsum("egaj,egji->egai", mesh.gradients, np.linalg.inv(deformation))
    stress = np.stack([np.stack(row, axis=-1) for row in ((xx, xy, zx), (xy, yy, yz), (zx, yz, zz))], axis=-2)
    weights = mesh.weights * np.linalg.det(deformation)
    force = np.zeros((len(mesh.nodes), 3))
    np.add.at(force, mesh.elements, np.einsum("eg,egij,egaj->eai", weights, stress, slopes))
    (cos, sin), (x, y, z) = mesh.turn.T, force.T
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=1)


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_stress_is_in_equilibrium_with_the_indenter(kinematics):
    """The solver's own balance is in the undeformed body and other stresses; at peak and in unloading."""
    problem, states = states_at(specification_from(SPEC | {"kinematics": kinematics}), [10.0, 14.0])
    for state in states:
        free = problem.mesh.equations >= 0
        assert internal_force(problem, state)[free] == pytest.approx(state.force[free], abs=1e-7)


def test_hertz_stress_on_the_axis():
    """Largest von Mises stress 0.62 p_0 at a depth of 0.48 a for nu = 0.3 (Johnson, Contact Mechanics, section 3.4)."""
    radius, modulus, found = 100.0, 3.0 / (1 - 0.3**2), []
    law = LAWS["elastic"].coefficients({"youngs_modulus": 3.0, "poisson_ratio": 0.3})
    protocol = trapezoid(1.0, 1.0, 0.0, 1.0, points=4)
    sphere = Indenter("sphere", radius=1e3 * radius)
    mesh = Resolution(growth=1.15, sectors=9)
    indent_3d(Specimen(law), sphere, protocol, mesh, observe=lambda *at: found.append(at))
    fields = next(fields_of(*at) for at in found if at[1].time == 1.0)
    contact = (0.75 * radius / modulus) ** (1 / 3)
    pressure = 1.5 / (np.pi * contact**2)
    highest = np.argmax(fields.element_von_mises)
    centre = fields.mesh.nodes[fields.mesh.elements[highest]].mean(axis=0)
    assert fields.element_von_mises[highest] == pytest.approx(0.62 * pressure, rel=0.04)
    assert -centre[2] == pytest.approx(0.48 * contact, rel=0.15)
    assert fields.load == pytest.approx(1.0, abs=1e-6)


def test_command_writes_what_paraview_and_people_read(tmp_path):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC | {"kinematics": "large"}))
    out = tmp_path / "out"
    assert main(["fields", str(tmp_path / "spec.yaml"), "--time", "5,10", "-o", str(out)]) == 0
    assert (out / "fields.png").stat().st_size > 1000
    mesh = meshio.read(out / "fields_001.vtu")
    assert mesh.cells[0].type == "hexahedron"
    assert {f"stress_{name}_GPa" for name in ("xx", "yy", "zz", "xy", "yz", "zx")} < set(mesh.cell_data)
    assert mesh.point_data["displacement_nm"].shape == mesh.points.shape
