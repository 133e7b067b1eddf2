r"""Load over the square of the unloading stiffness, which tells materials apart wherever the depth is counted from.

    P / S^2 = (pi / (4 beta^2)) H / E_r^2

of a body without a length of its own under a sharp tip: the contact area drops out, and with it every error of contact
and of the area function (D.L. Joslin and W.C. Oliver, J. Mater. Res. 5 (1990) 123-126). The compliance of the frame,
a nose of creep and a spherical tip change it, by less than materials differ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress

from indentation_files.recording import Recording
from palpate.classical.oliver_pharr import fit_unloading
from palpate.errors import InputError

UNLIKE = 3.0  # chosen: ratio from which on two tests seem to be of two materials; replicates differ by up to 1.5


def load_over_stiffness_squared(recording: Recording) -> float:
    """Return P / S^2 [1/GPa] of a test; NaN where it is not unloaded or recovers nothing."""
    with suppress(InputError):
        stiffness = fit_unloading(recording.load, recording.depth).stiffness
        return 1e-6 * float(recording.load.max()) / stiffness**2 if stiffness > 0.0 else math.nan
    return math.nan


def different_materials(recordings: Sequence[Recording]) -> str | None:
    """Return a sentence on tests that differ in P / S^2 as different materials do; None where none do."""
    values = {recording.name: load_over_stiffness_squared(recording) for recording in recordings}
    known = {name: value for name, value in values.items() if not math.isnan(value)}
    if not known:
        return None
    least, most = (end(known, key=lambda name: known[name]) for end in (min, max))
    if known[most] <= UNLIKE * known[least]:
        return None
    return (
        f"the tests look like different materials: the load over the square of the unloading stiffness, which does not "
        f"depend on contact, is {known[least]:.3g} /GPa in {least} and {known[most]:.3g} /GPa in {most}"
    )
