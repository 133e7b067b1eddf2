"""Tips that a laboratory gives by their area function, against Sneddon's solution for any tip of revolution."""

from dataclasses import replace

import numpy as np
import pytest
from derivatives import sensitivities
from scipy.interpolate import CubicSpline

from palpate.errors import InputError
from palpate.materials import LAWS
from palpate.solver.axisymmetric.discretisation import RESOLUTIONS, mesh_radii
from palpate.solver.axisymmetric.indentation_case import Case
from palpate.solver.axisymmetric.march_cases import indent_batch
from palpate.solver.axisymmetric.profile import Profile
from palpate.solver.simulation import simulate, simulate_batch
from palpate.study.area_function import AreaFunction
from palpate.study.indenter import Indenter
from palpate.study.protocol import trapezoid
from palpate.study.specification import Specification
from palpate.study.specimen import Specimen
from studies.verification.reference_materials import BURGERS

BLUNT = [24.56, 2000.0, -300.0, 500.0]
MODULUS, RATIO = 3.28, 0.45


def tip(*area, **further):
    return Indenter.from_mapping({"shape": "area_function", "area": list(area), **further})


def sneddon(profile, radii):
    """Return depth [nm] and load [mN] at contact radii [um]: Sneddon (1965), equations 6.1 and 6.2.

    With r = a sin(t), h = int f'(r) a dt and P = 2 E* int f'(r) r^2 dt from 0 to pi / 2.
    """
    angle = (np.arange(2000) + 0.5) * np.pi / 4000
    r = radii[:, None] * np.sin(angle)
    slope = profile(r.ravel())[1].reshape(r.shape) * np.pi / 4000
    depth, force = radii * slope.sum(axis=1), (slope * r**2).sum(axis=1)
    return 1e3 * depth, 2 * MODULUS / (1 - RATIO**2) * force


@pytest.mark.parametrize("area", [(24.5,), (24.5, 2000.0), (-3.14, 6e5), tuple(BLUNT)])
def test_sections_of_the_tip_have_the_areas_of_the_function(area):
    depth = np.geomspace(2.0, 5000.0, 50)
    section = AreaFunction(area).area(depth)
    height, slope, curvature = Profile.of(tip(*area))(1e-3 * np.sqrt(section / np.pi))
    assert 1e3 * height == pytest.approx(depth, rel=2e-4)
    assert np.all(slope > 0.0)
    assert np.all(curvature > -1e-9)


def test_slope_and_curvature_are_derivatives_of_the_height_in_any_unit():
    profile = Profile.of(tip(*BLUNT)).in_units_of(0.5)
    r, step = np.linspace(0.01, 4.0, 97), 1e-6
    height, slope, _ = profile(r)
    assert (profile(r + step)[0] - profile(r - step)[0]) / (2 * step) == pytest.approx(slope, rel=1e-6)
    assert profile(r + step)[2] == pytest.approx((profile(r + 2 * step)[1] - profile(r)[1]) / (2 * step), rel=1e-3)
    assert height == pytest.approx(Profile.of(tip(*BLUNT))(0.5 * r)[0] / 0.5)


@pytest.mark.parametrize(
    "area",
    [
        pytest.param((np.pi * np.tan(np.radians(88.0)) ** 2,), id="cone"),
        pytest.param((0.0, 2 * np.pi * 1e6), id="paraboloid"),
        pytest.param((2576.0, 2e5), id="rounded"),
        pytest.param((2576.0, 1e4, 1e6), id="flattened"),
    ],
)
def test_elastic_loading_is_sneddons(area):
    """Shallow tips, so that the boundary condition of the solution is the solver's."""
    protocol = trapezoid(0.02, 1.0, 0.0, 1.0, points=40)
    coefficients = LAWS["elastic"].coefficients({"youngs_modulus": MODULUS, "poisson_ratio": RATIO})
    (outcome,) = indent_batch([Case(Specimen(coefficients), tip(*area), protocol, RESOLUTIONS["fine"])])
    assert not outcome.reason
    depth, load = sneddon(Profile.of(tip(*area)), np.geomspace(1e-3, 30.0, 120))
    exact = CubicSpline(load, depth)(protocol.sample_load[:20])
    assert outcome.depth[3:20] == pytest.approx(exact[3:], rel=0.01)


def test_a_tip_of_one_term_is_the_cone():
    area = np.pi * np.tan(np.radians(70.3)) ** 2
    protocol = trapezoid(1.0, 30.0, 10.0, 30.0)
    curves = [
        simulate(Specification("nonlinear_burgers", BURGERS, indenter, protocol, kinematics="large")).depth
        for indenter in (Indenter("cone", 70.3), tip(area))
    ]
    assert curves[1][2:] == pytest.approx(curves[0][2:], rel=3e-3), "the first samples are those of another mesh"


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_a_lane_does_not_depend_on_what_runs_beside_it(kinematics):
    """Three tips with friction together, and each alone; meshes are measured in units that differ by rounding."""
    protocol = trapezoid(1.0, 30.0, 5.0, 30.0, points=30)
    tips = [tip(*BLUNT, friction=0.2), tip(24.5, 1000.0, friction=0.2), Indenter("sphero_cone", 70.3, 200.0, 0.2)]
    specifications = [
        Specification("nonlinear_burgers", BURGERS | {"youngs_modulus": 2.5 + k}, shape, protocol, kinematics)
        for k, shape in enumerate(tips)
    ]
    for specification, together in zip(specifications, simulate_batch(specifications), strict=True):
        alone = simulate(specification)
        assert alone.status == together.status == "ok"
        assert together.depth == pytest.approx(alone.depth, rel=0.0, abs=1e-8 * alone.depth.max())


def test_a_metal_is_pressed_and_released_at_large_strains():
    metal = {"youngs_modulus": 70.0, "poisson_ratio": 0.33, "yield_stress": 0.25, "hardening": 0.5}
    protocol = trapezoid(10.0, 10.0, 5.0, 10.0)
    curves = {
        shape: simulate(Specification("bilinear_plasticity", metal, indenter, protocol, kinematics="large"))
        for shape, indenter in (("sharp", Indenter("cone", 70.3)), ("blunt", tip(*BLUNT)))
    }
    assert all(curve.status == "ok" for curve in curves.values())
    assert curves["blunt"].depth[:40].max() < curves["sharp"].depth[:40].max()


def test_derivatives_by_the_material_are_those_of_differences_on_one_mesh():
    protocol = trapezoid(1.0, 30.0, 0.0, 30.0, points=20)
    specification = Specification("nonlinear_burgers", BURGERS, tip(*BLUNT), protocol, kinematics="small")
    radii = mesh_radii(specification.specimen, specification.indenter, protocol, RESOLUTIONS["standard"])
    _, exact = sensitivities(specification, ["youngs_modulus"], radii)

    def depth(modulus):
        return simulate(replace(specification, parameters=BURGERS | {"youngs_modulus": modulus}), radii).depth

    modulus = BURGERS["youngs_modulus"]
    difference = (depth(1.0001 * modulus) - depth(0.9999 * modulus)) / (2e-4 * modulus)
    loaded = protocol.sample_load > 0.0  # elsewhere each simulation may divide the step by itself
    assert exact[loaded, 0] == pytest.approx(difference[loaded], abs=1e-4 * np.abs(difference).max())


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "area is None"),
        ({"area": "24.5"}, "expected coefficients"),
        ({"area": []}, "expected coefficients"),
        ({"area": [24.5, True]}, "expected coefficients"),
        ({"area": [24.5, float("nan")]}, "expected coefficients"),
        ({"area": [-1.0]}, "is positive and grows over no stretch of depths"),
        ({"area": [24.5, -1.0e6]}, "is positive and grows over no stretch of depths"),
        ({"area": [24.5], "half_angle": 70.3}, "no parameter 'half_angle'"),
    ],
)
def test_what_is_no_tip_is_refused(values, words):
    with pytest.raises(InputError, match=words):
        Indenter.from_mapping({"shape": "area_function", **values})
