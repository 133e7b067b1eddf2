"""Files of instruments: readers, recordings, contact, segments, drift and survey; usable without palpate's solver."""
