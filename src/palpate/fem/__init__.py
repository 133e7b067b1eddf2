"""Axisymmetric finite elements for indentation: mesh, element, contact, Newton, load history."""
