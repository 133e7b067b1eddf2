"""Decks: the mesh, the laws they hold, and what they refuse in one line."""

import numpy as np
import pytest
import yaml

from palpate.cli.main import main
from palpate.errors import InputError
from palpate.materials.flow.estimate import secant_compliance
from palpate.output.export import calculix_moved
from palpate.output.export.abaqus import user_constants
from palpate.output.export.calculix_deck import deck, norton
from palpate.output.export.quadratic import RESOLUTIONS, quadratic_mesh
from palpate.solver.simulation import specification_from
from palpate.study.specification import ACCURACIES

NORTON = {
    "model": "nonlinear_burgers",
    "youngs_modulus": 3.28,
    "poisson_ratio": 0.34,
    "steady_coefficient": 0.09,
    "steady_exponent": 0.2,
    "transient_coefficient": 0.0,
    "transient_exponent": 0.47,
    "retardation_time": 0.25,
}
METAL = {
    "model": "bilinear_plasticity",
    "youngs_modulus": 70.0,
    "poisson_ratio": 0.345,
    "yield_stress": 0.1,
    "hardening": 0.5,
}
HOOKE = {"youngs_modulus": 3.28, "poisson_ratio": 0.34}
LUDWIK = {"yield_stress": 0.06, "strength": 0.2, "hardening_exponent": 0.3}
PRESSED = {"pressure_coefficient": 0.1}
DRUCKER = HOOKE | PRESSED | {"model": "drucker_prager", "yield_stress": 0.1, "hardening": 0.5}
EYRING = HOOKE | PRESSED | {"model": "eyring", "reference_rate": 1e-8, "eyring_stress": 0.004}
BACKED = METAL | {"model": "bilinear_plasticity+kinematic_hardening", "hardening": 0.0, "kinematic_modulus": 0.3}
CREEPING = NORTON | {"model": "kinematic_hardening+nonlinear_burgers", "kinematic_modulus": 0.3}
BOTH = NORTON | {"model": "burgers_plasticity", "yield_stress": 0.1, "hardening": 0.5}


def values(material=NORTON, **more):
    return {
        "material": material,
        "indenter": {"shape": "cone", "half_angle": 70.3},
        "protocol": {"max_load": 1.0, "loading_time": 30, "hold_time": 5, "unloading_time": 30, "points": 20},
        "kinematics": "small",
    } | more


@pytest.fixture
def export(tmp_path, capsys):
    def run(given, form, output="out"):
        file = tmp_path / "spec.yaml"
        file.write_text(yaml.safe_dump(given))
        code = main(["export", str(file), "--format", form, "-o", str(tmp_path / output)])
        return code, capsys.readouterr().err.splitlines(), tmp_path / output

    return run


def area(corners):
    x, y = corners[..., 0], corners[..., 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1), axis=-1)


def test_every_accuracy_has_a_mesh_and_finer_means_more_nodes():
    meshes = [quadratic_mesh(specification_from(values()), RESOLUTIONS[accuracy]) for accuracy in ACCURACIES]
    sizes = [len(mesh.nodes) for mesh in meshes]
    assert sizes == sorted(set(sizes))


@pytest.mark.parametrize("indenter", [{"shape": "cone", "half_angle": 70.3}, {"shape": "sphere", "radius": 5000.0}])
def test_mesh_fills_the_quarter_disc(indenter):
    mesh = quadratic_mesh(specification_from(values(indenter=indenter)), RESOLUTIONS["standard"])
    triangles, quads = area(mesh.nodes[mesh.triangles[:, :3]]), area(mesh.nodes[mesh.quads[:, :4]])
    behind = area(mesh.nodes[mesh.indenter[:, :4]])
    assert min(triangles.min(), quads.min(), behind.min()) > 0
    radius, sectors = -mesh.nodes[:, 1].min(), len(mesh.triangles)
    assert triangles.sum() + quads.sum() == pytest.approx(0.5 * sectors * radius**2 * np.sin(np.pi / 2 / sectors))
    assert mesh.nodes[mesh.quads[mesh.top_quads][:, [0, 1, 4]], 1] == pytest.approx(0.0, abs=1e-12)
    assert len(mesh.nodes) == len(np.unique(np.concatenate([part.ravel() for part in (
        mesh.triangles, mesh.quads, mesh.indenter)])))  # fmt: skip
    for elements, corners in ((mesh.quads, 4), (mesh.indenter, 4), (mesh.triangles, 3)):
        ends = mesh.nodes[elements[:, :corners]]
        middles = mesh.nodes[elements[:, corners:]]
        chord = np.linalg.norm(ends - np.roll(ends, -1, axis=1), axis=-1)
        off = np.linalg.norm(middles - 0.5 * (ends + np.roll(ends, -1, axis=1)), axis=-1)
        assert np.all(off < 0.15 * chord)


def test_norton_is_steady_creep():
    """In shear the strain rate of steady creep is A q^n."""
    factor, exponent = norton(NORTON["steady_coefficient"], NORTON["steady_exponent"])
    row, q = specification_from(values()).coefficients, 0.03
    after, before = (q * secant_compliance(row, q, 0.0, duration) for duration in (1.0, 0.0))
    equivalent_rate = 2 / np.sqrt(3) * (after - before)
    assert factor * (np.sqrt(3) * q) ** exponent == pytest.approx(equivalent_rate, rel=1e-12)


def test_calculix_deck_holds_the_law_and_the_load(export):
    code, _, path = export(values(), "calculix", "deck.inp")
    text = path.read_text()
    assert code == 0
    factor, exponent = norton(0.09, 0.2)
    assert f"*CREEP, LAW=NORTON\n{factor:.12g}, {exponent:.12g}, 0." in text
    assert text.count("*STEP") == 4
    onset = text.split("*STEP")[1]
    assert "CLOAD" not in onset and "REFERENCE, 2, 2" in onset
    amplitude = text.split("TOTAL TIME\n")[1].split("*")[0].split("\n")
    assert [float(part) for part in amplitude[-2].split(",")] == [65.0, 0.0]


@pytest.mark.parametrize(("form", "name"), [("calculix", ""), ("abaqus", "indentation.inp")])
def test_friction_goes_with_the_contact(export, form, name):
    rough = values(METAL) | {"indenter": {"shape": "cone", "half_angle": 70.3, "friction": 0.25}}
    for given, coefficients in ((rough, ["0.25"]), (values(METAL), [])):
        _, _, path = export(given, form)
        text = (path / name if name else path).read_text()
        assert [part.split(",")[0].strip() for part in text.split("*FRICTION\n")[1:]] == coefficients


def test_plasticity_is_a_hardening_line():
    assert "*PLASTIC\n0.1, 0\n5.1, 10" in deck(specification_from(values(METAL)))
    assert "*PLASTIC, HARDENING=KINEMATIC\n0.1, 0\n3.1, 10" in deck(specification_from(values(BACKED)))


@pytest.mark.parametrize(
    ("given", "form", "words"),
    [
        (values(NORTON | {"transient_coefficient": 0.2}), "calculix", "no Voigt elements"),
        (values(BOTH), "calculix", "creep and hardening"),
        (values(DRUCKER), "calculix", "drucker_prager"),
        (values(DRUCKER), "abaqus", "drucker_prager"),
        (values(BACKED | {"hardening": 0.1}), "calculix", "no kinematic hardening beside isotropic"),
        (values(CREEPING), "abaqus", "does not know the law kinematic_hardening"),
        (values(EYRING), "calculix", "does not know the law eyring"),
        (values(EYRING | NORTON | {"model": "nonlinear_burgers+eyring"}), "abaqus", "does not know the law eyring"),
        (values(kinematics="large"), "calculix", "kinematics"),
        (values(mechanisms={"thermal_drift": {"rate": 0.05}}), "calculix", "mechanisms"),
        (values(mechanisms={"thermal_drift": {"rate": 0.05}}), "abaqus", "mechanisms"),
        (values(BOTH), "abaqus", "no yielding"),
    ],
)
def test_what_a_program_lacks_is_refused_in_one_line(export, given, form, words):
    code, lines, path = export(given, form)
    assert code == 2
    assert len(lines) == 1 and words in lines[0] and "spec.yaml" in lines[0]
    assert not path.exists()


def moved(given, depth):
    specification = specification_from(given)
    mesh = quadratic_mesh(specification, calculix_moved.SHEARED["standard"])
    return mesh, calculix_moved.deck(specification, np.array(depth), mesh)


def test_at_large_strains_the_body_is_moved_to_the_depths_asked_for():
    """Less the overlap from which it begins; with elements that are integrated fully, and the force asked for."""
    depth = [0.0, 620.0, 620.0, 600.0]
    mesh, text = moved(values(METAL, kinematics="large"), depth)
    amplitude = text.split("NAME=LOAD, TIME=TOTAL TIME\n")[1].split("*")[0].split("\n")[:-1]
    rise = np.array([float(row.split(",")[1]) for row in amplitude])
    assert 1e3 * (rise[1:] + mesh.overlap) == pytest.approx(depth[1:])
    assert text.count("*STEP, NLGEOM") == text.count("*STEP") == 4
    assert "CAX8, ELSET=RINGS" in text and "RF" in text
    assert "CLOAD" not in text and "*BOUNDARY, AMPLITUDE" not in text.split("*END STEP")[0]


def test_the_overlap_takes_in_more_than_one_element():
    for resolutions in (RESOLUTIONS, calculix_moved.SHEARED):
        mesh = quadratic_mesh(specification_from(values(METAL)), resolutions["standard"])
        inside = np.tan(np.radians(70.3)) * mesh.overlap
        assert inside > 2 * mesh.nodes[mesh.triangles].max()


@pytest.mark.parametrize("given", [values(METAL), values(kinematics="large")])
def test_only_bodies_that_yield_are_moved_at_large_strains(given):
    with pytest.raises(InputError, match="where the body yields alone"):
        moved(given, [0.0, 620.0, 620.0, 600.0])


def test_abaqus_folder(export):
    second = {"transient_coefficient_2": 0.1, "transient_exponent_2": 0.3, "retardation_time_2": 20.0}
    code, _, path = export(values(NORTON | second, kinematics="large"), "abaqus")
    assert code == 0
    text = (path / "indentation.inp").read_text()
    assert "NLGEOM=YES" in text
    assert "CONSTANTS=10" in text and "*DEPVAR\n12," in text
    assert "SUBROUTINE UMAT" in (path / "burgers.f").read_text()
    assert max(len(line) for line in (path / "burgers.f").read_text().splitlines()) <= 72


def test_abaqus_needs_no_subroutine_for_its_own_laws(export):
    code, _, path = export(values(METAL), "abaqus")
    assert code == 0
    assert "*PLASTIC" in (path / "indentation.inp").read_text()
    assert not (path / "burgers.f").exists()


def test_a_spectrum_is_written_as_linear_voigt_elements():
    spectrum = {"spectrum_coefficient": 0.05, "spectrum_exponent": 0.2, "elements": 3}
    constants = user_constants(specification_from(values(HOOKE | {"model": "retardation_spectrum"} | spectrum)))
    assert constants[2:4] == pytest.approx([0.0, 0.0])
    assert constants[4:].reshape(3, 3)[:, 2] == pytest.approx([0.1, 10.0, 1000.0])
    assert constants[4:].reshape(3, 3)[:, :2] == pytest.approx(
        np.array([[0.05 * t**0.2, 0.0] for t in (0.1, 10, 1000)])
    )


def test_curved_hardening_is_a_table():
    text = deck(specification_from(values(HOOKE | {"model": "ludwik_plasticity"} | LUDWIK)))
    lines = text.split("*PLASTIC\n")[1].split("*")[0].split()
    table = np.array([float(part.rstrip(",")) for part in lines]).reshape(-1, 2)
    assert table[:, 0] == pytest.approx(0.06 + 0.2 * table[:, 1] ** 0.3, rel=1e-10)
    assert table[0].tolist() == [0.06, 0.0] and table[-1, 1] == 10.0
