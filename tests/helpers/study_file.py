"""A study's file of the smallest content, changed key by key."""

import yaml

from palpate.configuration.study_file import load_study

STUDY = {
    "study": "s",
    "material": {"model": "nonlinear_burgers", "poisson_ratio": 0.34},
    "parameters": {
        "youngs_modulus": [3.0, 3.5],
        "steady_coefficient": [0.05, 0.1],
        "steady_exponent": [0.2],
        "transient_coefficient": [0.24],
        "transient_exponent": [0.4],
        "retardation_time": [0.25],
    },
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "conditions": [{"name": "P1_T30", "max_load": 1.0, "loading_time": 30, "unloading_time": 30}],
}
TRUTH = {name: levels[0] for name, levels in STUDY["parameters"].items()}
CONDITION = STUDY["conditions"][0]


def load(folder, **changes):
    file = folder / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY | changes, sort_keys=False))
    return load_study(file)
