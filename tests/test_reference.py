"""The solver against curves that CalculiX computed beforehand, within the refinement errors stated for them."""

from pathlib import Path

import pytest

from palpate.verification import reference
from palpate.verification.case import Settings

FOLDER = Path(__file__).parent.parent.parent / "shared/reference"
pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="the reference curves are not part of the repository (folder shared/reference)"
)


@pytest.mark.parametrize("curve", reference.REFERENCES, ids=lambda curve: curve.name)
def test_agrees_with_calculix_at_every_sample_from_15_per_cent_of_the_load_on(monkeypatch, curve):
    monkeypatch.setattr(reference, "REFERENCES", (curve,))
    checked = [row for row in reference.run(Settings(reference=FOLDER)).rows if row.allowed]
    assert checked
    assert all(row.passed for row in checked), checked
