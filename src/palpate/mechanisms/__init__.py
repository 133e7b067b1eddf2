"""Mechanisms of missing physics: every module of this folder that defines ``MECHANISM`` is found by itself."""

from palpate.discovery import discover
from palpate.mechanisms.mechanism import Mechanism, Range, Scale

MECHANISMS: dict[str, Mechanism] = {found.key: found for found in discover(__name__, __path__, "MECHANISM")}

__all__ = ["MECHANISMS", "Mechanism", "Range", "Scale"]
