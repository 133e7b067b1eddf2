"""Whether verdicts depend on the settings of the search: each halved and doubled in turn.

The forward model is a cone in closed form, and what mechanisms add to its depth is sketched in closed forms, too.

    python tests/helpers/settings_varied.py

prints, for each setting and both values, the verdicts that differ from those by the default settings.
"""

from collections.abc import Iterator
from dataclasses import fields, replace
from functools import partial
from unittest.mock import patch

import numpy as np
from closed_forms import TRUTH, cone
from diagnosis_problem import STUDY, problem, recordings

from palpate.diagnosis.diagnose import diagnose
from palpate.diagnosis.policy import SearchPolicy
from palpate.diagnosis.search import Search
from palpate.inference.fit_policy import FitPolicy
from palpate.inference.fitting import Fitter

SEED = 20261127
# The first changes nothing that is found (test_verdicts.py); others act where bodies yield, or in calibrations.
NOT_VARIED = ("threads", "finer_meshes", "finer_steps", "first_order", "single_start", "base_searches")
RECORDED = ("thermal_drift", "frame_compliance", "zero_offset")


def depth_of(protocol):
    return np.maximum(cone(protocol, **TRUTH), 1.0)


def rounded(protocol, values):
    lost = 0.06 * values["radius"] + 1e-9
    return -lost * -np.expm1(-depth_of(protocol) / lost)


def harder_when_small(protocol, values):
    return depth_of(protocol) * ((1.0 + values["length"] / depth_of(protocol)) ** -0.25 - 1.0)


def later(protocol, values):
    return -values["lag"] * np.gradient(depth_of(protocol), protocol.sample_time)


def retarded(protocol, values):
    grown = -np.expm1(-protocol.sample_time / values["retardation_time"])
    return 0.3 * values["coefficient"] * grown * protocol.sample_load ** values["exponent"] * depth_of(protocol)


BODILY = {
    "tip_rounding": rounded,
    "size_effect": harder_when_small,
    "controller_lag": later,
    "second_voigt": retarded,
}
EFFECTS = {
    "thermal_drift": lambda c, r: (0.1 + 0.01 * r) * c.protocol.sample_time,
    "frame_compliance": lambda c, r: 6.0 * c.protocol.sample_load,
    "zero_offset": lambda c, r: 4.0 + 0.5 * r,
    "tip_rounding": lambda c, r: rounded(c.protocol, {"radius": 150.0}),
    "size_effect": lambda c, r: harder_when_small(c.protocol, {"length": 80.0}),
    "controller_lag": lambda c, r: later(c.protocol, {"lag": 0.2}),
}
PAIRS = [
    ("thermal_drift", "frame_compliance"),
    ("zero_offset", "frame_compliance"),
    ("tip_rounding", "thermal_drift"),
    ("size_effect", "controller_lag"),
]


def concealed() -> Iterator[tuple[str, dict]]:
    """Yield what each set of recordings conceals, and the set."""
    for number, names in enumerate([(), *((name,) for name in EFFECTS), *PAIRS]):

        def effect(condition, replicate, names=names):
            return sum((EFFECTS[name](condition, replicate) for name in names), 0.0)

        yield " and ".join(names) or "nothing", recordings(np.random.default_rng([SEED, number]), effect)


def verdict(observed, search_policy, fit_policy):
    """Return the verdict on recordings, and the explanations that are accepted, in words."""
    keys, rng = [*RECORDED, *BODILY], np.random.default_rng(SEED)
    with patch("palpate.diagnosis.search.Fitter", partial(Fitter, policy=fit_policy)):
        search = Search(STUDY, problem(observed, **BODILY), keys, rng, TRUTH, policy=search_policy)
        found = diagnose(search, lambda said: None)
    return " ".join([found.verdict, *sorted("+".join(sorted(each.fit.explanation)) for each in found.accepted)])


def varied() -> Iterator[tuple[str, SearchPolicy, FitPolicy]]:
    """Yield each setting with its default and the other value, and the policies with that."""
    default = {"search": SearchPolicy(), "fit": FitPolicy()}
    for kind, policy in default.items():
        for setting in [each.name for each in fields(policy) if each.name not in NOT_VARIED]:
            usual = getattr(policy, setting)
            for other in (-(-usual // 2) if isinstance(usual, int) else usual / 2.0, 2 * usual):
                both = default | {kind: replace(policy, **{setting: other})}
                yield f"{setting} {other:g} (default {usual:g})", both["search"], both["fit"]


if __name__ == "__main__":
    sets = dict(concealed())
    usual = {name: verdict(observed, SearchPolicy(), FitPolicy()) for name, observed in sets.items()}
    for name, found in usual.items():
        print(f"{name}: {found}", flush=True)
    for setting, search_policy, fit_policy in varied():
        now = {name: verdict(observed, search_policy, fit_policy) for name, observed in sets.items()}
        other = [f"{name}: {now[name]}" for name in sets if now[name] != usual[name]]
        print(f"{setting}: {len(other)} of {len(sets)} differ", *other, sep="\n    ", flush=True)
