"""Constitutive laws: every module of this folder that defines ``LAW`` is found by itself."""

from palpate import kernel_cache
from palpate.discovery import discover
from palpate.materials.law import Law

kernel_cache.require()

LAWS: dict[str, Law] = {law.key: law for law in discover(__name__, __path__, "LAW")}

__all__ = ["LAWS", "Law"]
