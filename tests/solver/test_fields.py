"""Stress in the body: equilibrium with the indenter, Hertz' stress on the axis, and the files that hold it."""

import math

import meshio
import numpy as np
import pandas as pd
import pytest
import yaml
from bodies import internal_force

from palpate.cli.main import main
from palpate.output.figures.stress_fields import nodal
from palpate.solver.axisymmetric.fields import von_mises
from palpate.solver.axisymmetric.newton import TOLERANCE
from palpate.solver.simulation import fields_at, simulate, specification_from
from studies.verification.reference_materials import BURGERS as EPOXY

BURGERS = {
    "model": "burgers_plasticity",
    **EPOXY,
    "yield_stress": 0.15,
    "hardening": 0.3,
}
SPEC = {
    "material": BURGERS,
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "protocol": {"max_load": 1.0, "loading_time": 10, "unloading_time": 10, "points": 20},
    "kinematics": "small",
}


@pytest.mark.parametrize("adhesion", [{}, {"adhesion": {"work": 100.0}}])
@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_stress_is_in_equilibrium_with_the_indenter(kinematics, adhesion):
    """At peak and in unloading no force is left inside; the surface bears the load, along the normal of the cone.

    The solver's own balance is in the undeformed body and other stresses.
    """
    specification = specification_from(SPEC | {"kinematics": kinematics, "mechanisms": adhesion})
    slope = specification.indenter.slope
    for fields in fields_at(specification, [10.0, 14.0]):
        mesh, large = fields.mesh, kinematics == "large"
        force = internal_force(mesh, fields.stress, 1e-3 * fields.displacement, large)
        free, surface = mesh.equations >= 0, mesh.surface
        inside = np.setdiff1d(np.arange(len(mesh.nodes)), surface)
        assert force[inside][free[inside]] == pytest.approx(0.0, abs=TOLERANCE)
        assert force[surface[1:], 0] == pytest.approx(-slope * force[surface[1:], 1], abs=TOLERANCE)
        assert -force[surface, 1].sum() == pytest.approx(fields.load, abs=1e-8 + len(surface) * TOLERANCE)
        assert fields.load == pytest.approx(specification.protocol.load_at(fields.time), abs=TOLERANCE)


def test_hertz_stress_on_the_axis():
    """Largest von Mises stress 0.62 p_0 at a depth of 0.48 a for nu = 0.3 (Johnson, Contact Mechanics, section 3.4)."""
    radius, load, modulus = 100.0, 1.0, 3.0 / (1 - 0.3**2)
    values = {
        "material": {"model": "elastic", "youngs_modulus": 3.0, "poisson_ratio": 0.3},
        "indenter": {"shape": "sphere", "radius": 1e3 * radius},
        "accuracy": "fine",
    }
    (fields,) = fields_at(specification_from(SPEC | values), [10.0])
    a = (0.75 * load * radius / modulus) ** (1 / 3)
    peak = 1.5 * load / (np.pi * a**2)
    centres = fields.mesh.nodes[fields.mesh.elements].mean(axis=1)
    highest = np.argmax(fields.element_von_mises)
    assert fields.element_von_mises[highest] == pytest.approx(0.62 * peak, rel=0.03)
    assert -centres[highest, 1] == pytest.approx(0.48 * a, rel=0.1)
    assert centres[highest, 0] < 0.1 * a
    touched = fields.mesh.nodes[fields.touching, 0]
    assert touched.max() == pytest.approx(a, rel=0.1)


def test_von_mises_of_pure_shear_and_of_tension():
    assert von_mises(np.array([[0.0, 0, 0, 2], [0, 3, 0, 0], [5, 5, 5, 0]])) == pytest.approx([2 * np.sqrt(3), 3, 0])


def test_asking_for_fields_changes_no_step():
    """At sampling times the fields are those of the plain simulation."""
    specification = specification_from(SPEC)
    plain = simulate(specification)
    fields = fields_at(specification, plain.time)
    assert [each.time for each in fields] == plain.time.tolist()
    assert [each.depth for each in fields] == pytest.approx(plain.depth, rel=1e-14)


def test_a_sampling_time_may_be_asked_for_to_rounding():
    specification = specification_from(SPEC)
    (fields,) = fields_at(specification, [float(np.nextafter(specification.protocol.sample_time[0], 0.0))])
    assert fields.time == pytest.approx(specification.protocol.sample_time[0], rel=1e-12)


def test_nodes_that_touch_reach_as_far_as_the_contact_of_a_cone():
    """Sneddon's contact radius a = (2 / pi) h tan(angle), to a ring of nodes; the surface under it follows the tip."""
    values = {"material": {"model": "elastic", "youngs_modulus": 3.28, "poisson_ratio": 0.34}}
    (fields,) = fields_at(specification_from(SPEC | values), [10.0])
    nodes, slope = fields.mesh.nodes, math.tan(math.radians(90.0 - 70.3))
    reach = 2e-3 / np.pi * fields.depth / slope
    radius = nodes[fields.touching, 0].max()
    assert radius == pytest.approx(reach, rel=0.12)
    under = fields.touching & (nodes[:, 0] > 0.2 * reach) & (nodes[:, 0] < 0.6 * reach)
    height = slope * (1e3 * nodes[under, 0] + fields.displacement[under, 0]) - fields.depth
    assert fields.displacement[under, 1] == pytest.approx(height, abs=0.01 * fields.depth)


def test_command_writes_what_paraview_and_people_read(tmp_path):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC))
    out = tmp_path / "out"
    assert main(["fields", str(tmp_path / "spec.yaml"), "--time", "15,5", "-o", str(out)]) == 0
    table = pd.read_csv(out / "fields.csv")
    assert table["time_s"].tolist() == [5.0, 15.0]
    assert table["load_mN"].tolist() == pytest.approx([0.5, 0.5], abs=2e-7)
    assert (out / "fields.png").stat().st_size > 1000
    assert all(name in (out / "fields.pvd").read_text() for name in table["file"])
    mesh = meshio.read(out / table["file"][1])
    *_, last = fields_at(specification_from(SPEC), [5.0, 15.0])
    assert table["depth_nm"][1] == pytest.approx(last.depth, rel=1e-9)
    assert mesh.point_data["displacement_nm"][:, :2] == pytest.approx(last.displacement)
    assert {"von_mises_GPa", "stress_rr_GPa", "stress_zz_GPa", "stress_tt_GPa", "stress_rz_GPa"} == set(mesh.cell_data)
    assert nodal(mesh).shape == (len(mesh.points),)


def test_fields_under_displacement_control_bear_the_simulated_load():
    pushed = {"drive": "displacement", "max_displacement": 300.0, "loading_time": 10, "unloading_time": 10}
    specification = specification_from(SPEC | {"protocol": pushed | {"spring": 0.01, "points": 20}})
    curve = simulate(specification)
    for fields in fields_at(specification, [5.0, 10.0]):
        assert fields.load == pytest.approx(np.interp(fields.time, curve.time, curve.load), rel=1e-6)
        assert fields.depth + fields.load / 0.01 == pytest.approx(30.0 * fields.time, rel=1e-6)


@pytest.mark.parametrize("time", ["0", "15,30", "nan"])
def test_times_outside_the_test_are_refused(tmp_path, capsys, time):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC))
    assert main(["fields", str(tmp_path / "spec.yaml"), "--time", time, "-o", str(tmp_path / "out")]) == 2
    assert "lasts 20 s" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
