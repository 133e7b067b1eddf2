"""Large strains against closed forms of a homogeneous body, and against what CalculiX found under the cone."""

from dataclasses import replace

import numpy as np
import pytest
from palpate.materials.radial import BULK, SHEAR, step_weights

from palpate.fem import hencky
from palpate.fem.mesh import _integration
from palpate.materials import LAWS
from palpate.model import simulate
from palpate.specification import Specification
from palpate.verification.kinematics import EPOXY, WAYS
from palpate.verification.materials import CONE, HOOKE

ELASTIC = LAWS["elastic"].coefficients(HOOKE)


def block(radius=1e6):
    """A unit square far from the axis: shape function gradients, volumes, and the nodes."""
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) + np.array([radius, 0.0])
    gradients, volumes = (part[0] for part in _integration(nodes[None]))
    return gradients, volumes, nodes


@pytest.mark.parametrize(("wide", "high"), [(1.0, 0.7), (1.2, 0.8), (0.9, 1.3), (0.8, 0.8)])
def test_true_stress_is_hookes_law_in_logarithmic_strain(wide, high):
    """F = diag(wide, high, 1): the force on a face is its present area times K ln J + 2 G (ln stretch - ln J / 3)."""
    gradients, volumes, nodes = block()
    stretched = (nodes - nodes[0]) * [wide - 1.0, high - 1.0]
    ke, fe = np.zeros((9, 9)), np.zeros(9)
    points = (np.zeros((4, 4)), np.zeros(4), np.zeros(4), step_weights(ELASTIC, 1.0), ELASTIC, np.empty((4, 4)))
    assert hencky.element(gradients, volumes, stretched.ravel(), *points, ke, fe)
    swelling = np.log(wide * high)
    around = 2 * np.pi * nodes[:, 0].mean()
    for stretch, face, force in ((high, wide, fe[5] + fe[7]), (wide, high, fe[2] + fe[4])):
        stress = ELASTIC[BULK] * swelling + 2 * ELASTIC[SHEAR] * (np.log(stretch) - swelling / 3)
        assert force == pytest.approx(stress * face * around, rel=1e-5)


@pytest.fixture(scope="module")
def epoxy():
    def run(kinematics, friction):
        indenter = replace(CONE, friction=friction)
        specification = Specification(EPOXY.law, EPOXY.values, indenter, EPOXY.protocol, kinematics=kinematics)
        return simulate(specification).depth[list(EPOXY.samples)]

    return {way: run(*way) for way in WAYS}


@pytest.mark.parametrize("way", WAYS)
def test_depths_are_those_of_calculix(epoxy, way):
    """0.4 % stated by CalculiX, 0.5 % between the solver's standard and fine meshes."""
    assert epoxy[way] == pytest.approx(EPOXY.reference[way], rel=0.009)


@pytest.mark.parametrize("way", WAYS[1:])
def test_large_strains_and_friction_change_what_they_change_in_calculix(epoxy, way):
    """Ratios to small strains without friction, in which the errors of both meshes drop out."""
    expected = np.array(EPOXY.reference[way]) / EPOXY.reference[WAYS[0]]
    assert epoxy[way] / epoxy[WAYS[0]] == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize("excess", [7.3e-9, 8.9e-9, 9.1e-9])
@pytest.mark.parametrize("angle", [0.1, 0.5, 1.2])
def test_an_element_that_shrinks_to_a_point_is_inside_out(angle, excess):
    """F = -excess Q with a rotation Q: its determinant is above zero, but all digits of its stretches are lost."""
    gradients, _, nodes = block(1.0)
    turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = (nodes - nodes[0]) @ (-excess * turned - np.eye(2)).T + [1.0, 0.0]
    out = np.empty(3), np.empty((4, 8)), np.empty(7)
    assert not any(hencky.strain_at(point, moved.ravel(), *out) for point in gradients)
