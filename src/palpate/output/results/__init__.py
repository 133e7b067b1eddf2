"""Results as objects: a calibration, a diagnosis, and the answer that a report begins with."""
