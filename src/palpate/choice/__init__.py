"""The choice of the constitutive law of a study by its recordings."""
