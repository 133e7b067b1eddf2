"""Isotropic linear elasticity (Hooke)."""

from __future__ import annotations

from palpate.materials.law import Law

LAW = Law("elastic", "linear elasticity", (), lambda values: ())
