"""What a calibrated law predicts of imprints: the residual profile by finite elements, beside the recorded one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from palpate.data.measures import root_mean_square
from palpate.errors import PalpateError
from palpate.inference.explanation import Fit
from palpate.models.imprints import residual_profile


def imprint_predictions(fit: Fit, report: Callable[[str], None]) -> dict[str, dict[str, Any]]:
    """Return for each imprint by its name errors, the height of the pile-up, and the predicted profile.

    ``percent_error`` is the root mean square error in per cent of the recorded depth. An imprint whose test cannot be
    simulated is left out, and `report` is called with the reason.
    """
    found = {}
    for imprint in fit.problem.imprints:
        profile = imprint.profile
        try:
            radius, height = residual_profile(fit.model.specification(fit.z, imprint.condition))
        except PalpateError as error:
            report(f"imprint {profile.name} has no errors: {error}")
            continue
        predicted = np.interp(profile.radius, radius, height)
        rmse = root_mean_square(predicted - profile.height)
        curve = {"radius_nm": profile.radius, "height_nm": profile.height, "predicted_nm": predicted}
        found[profile.name] = {
            "of": imprint.condition.name,
            "role": "validate",
            "rmse_nm": rmse,
            "percent_error": 100.0 * rmse / float(-profile.height.min()),
            "depth_nm": float(-profile.height.min()),
            "predicted_depth_nm": float(-predicted.min()),
            "pile_up_nm": float(profile.height.max()),
            "predicted_pile_up_nm": float(predicted.max()),
            "curve": {name: [float(f"{x:.7g}") for x in values] for name, values in curve.items()},
        }
    return found
