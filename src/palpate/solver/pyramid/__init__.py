"""Finite elements in three dimensions, for indenters that are no bodies of revolution: one sixth of the half-space."""

from palpate.base import kernel_cache

kernel_cache.require()
