"""Calibration: the parameters that bring simulation and recordings together, and how well the data fix them."""

from palpate.calibration.calibrate import Calibration, calibrate
from palpate.calibration.genetic import GeneticSettings, evolve
from palpate.calibration.noise import Observation, observe

__all__ = ["Calibration", "GeneticSettings", "Observation", "calibrate", "evolve", "observe"]
