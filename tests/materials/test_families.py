"""Families of laws: what a law that contains the base law is where its further parameters are neutral."""

import numpy as np
import pytest

from palpate.draft.guesses import ranges
from palpate.draft.solid import Solid
from palpate.materials import law_of
from palpate.materials.families import FAMILIES, neutral
from palpate.materials.flow.uniaxial import response_to

LOADING = 20.0  # s
HOOKE = {"youngs_modulus": 3.0, "poisson_ratio": 0.35}
NESTED = [
    (family, law) for family, of in FAMILIES.items() for law in of.others if "eyring" not in law and law != "elastic"
]
TENSION = np.linspace(0.0, 0.05, 60)
RATE = 0.1 / LOADING  # 1/s


def stress(model, values):
    """Return the stress [GPa] in tension, compression and tension again, at a constant rate."""
    strain = np.concatenate([TENSION, TENSION[-2::-1], -TENSION[1:]])
    time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(strain)))]) / RATE
    law = law_of(model)
    row = law.coefficients({p.name: values[p.name] for p in law.parameters if p.name in values})
    return response_to(row, time, strain)


def base_of(family):
    law = law_of(FAMILIES[family].base)
    return HOOKE | {name: value for name, value in law.example.items() if name != "elements"}


@pytest.mark.parametrize(("family", "model"), NESTED)
def test_a_law_with_neutral_parameters_is_the_base_law(family, model):
    """To a few per cent where hardening saturates, or some compliance is left."""
    base = base_of(family)
    expected, found = stress(FAMILIES[family].base, base), stress(model, neutral(base, LOADING))
    near = "voce" in model or ("spectrum" in model and "spectrum" not in FAMILIES[family].base)
    assert np.abs(found - expected).max() < (0.1 if near else 1e-4) * expected.max()


@pytest.mark.parametrize("family", FAMILIES)
def test_each_law_guesses_ranges_of_its_parameters(family):
    stiff = {"polymer": 3.0, "metal": 200.0, "glass": 70.0, "gel": 1e-5}[family]
    for law in FAMILIES[family].laws:
        found = ranges(law, Solid(0.6 * stiff, stiff, 0.06 * stiff), LOADING)
        assert found["youngs_modulus"].values[0] < stiff < found["youngs_modulus"].values[1]
