"""A study's YAML file as checked objects."""
