"""Axisymmetric finite elements for indentation: mesh, element, contact, Newton, load history."""

from palpate.base import kernel_cache

kernel_cache.require()
