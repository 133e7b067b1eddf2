"""Stress in the body: equilibrium with the indenter, Hertz' stress on the axis, and the files that hold it."""

import meshio
import numpy as np
import pandas as pd
import pytest
import yaml
from bodies import case_of, internal_force, moments

from palpate.cli import main
from palpate.fem.fields import von_mises
from palpate.figures.fields import nodal
from palpate.model import fields_at, simulate, specification_from
from palpate.verification.materials import BURGERS as EPOXY

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
}


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_stress_is_in_equilibrium_with_the_indenter(kinematics):
    """The solver's own balance is in the undeformed body and other stresses; at peak and in unloading."""
    case = case_of(specification_from(SPEC | {"kinematics": kinematics, "mechanisms": {"adhesion": {"work": 100.0}}}))
    for moment in moments(case):
        mesh, force = moment.mesh, internal_force(moment)
        load = float(case.protocol.load_at(np.array(moment.time)))
        assert moment.load == pytest.approx(load, abs=2e-6)
        assert -force[mesh.surface, 1].sum() == pytest.approx(load, abs=1e-5)
        free = mesh.equations >= 0
        free[mesh.surface] = False
        assert force[free] == pytest.approx(np.zeros(free.sum()), abs=2e-6)


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
    """At sampling times they are those of the plain simulation, to the last digit."""
    specification = specification_from(SPEC)
    plain = simulate(specification)
    assert [fields.depth for fields in fields_at(specification, plain.time)] == plain.depth.tolist()


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
    assert mesh.point_data["displacement_nm"][0, 1] == pytest.approx(-table["depth_nm"][1], rel=1e-9)
    assert {"von_mises_GPa", "stress_rr_GPa", "stress_zz_GPa", "stress_tt_GPa", "stress_rz_GPa"} == set(mesh.cell_data)
    assert nodal(mesh, "von_mises_GPa").shape == (len(mesh.points),)


@pytest.mark.parametrize("time", ["0", "15,30", "nan"])
def test_times_outside_the_test_are_refused(tmp_path, capsys, time):
    (tmp_path / "spec.yaml").write_text(yaml.safe_dump(SPEC))
    assert main(["fields", str(tmp_path / "spec.yaml"), "--time", time, "-o", str(tmp_path / "out")]) == 2
    assert "lasts 20 s" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
