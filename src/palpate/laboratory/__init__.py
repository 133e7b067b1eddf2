"""A virtual laboratory: synthetic recordings of a known material, with known effects concealed in them."""
