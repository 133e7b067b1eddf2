"""Calibration: the parameters of a law that explain recordings, with intervals."""

from palpate.calibration.calibrate import CalibrationSettings, calibrate
from palpate.calibration.genetic import GeneticSettings
from palpate.calibration.observation import Observation
from palpate.calibration.result import Calibration, Estimate

__all__ = ["Calibration", "CalibrationSettings", "Estimate", "GeneticSettings", "Observation", "calibrate"]
