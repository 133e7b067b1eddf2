"""Diagnosis: where simulation and recordings differ, and what physics was left out."""
