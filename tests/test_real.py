"""A vendor's table with the frame's compliance left in: from the file to the diagnosis in one process."""

import numpy as np
import pytest
import yaml

from palpate.config import load_study
from palpate.errors import InputError
from palpate.model import simulate, specification_from
from palpate.real import diagnose_source

MATERIAL = {"model": "elastic", "poisson_ratio": 0.35}
INDENTER = {"shape": "cone", "half_angle": 70.3}


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    truth = MATERIAL | {"youngs_modulus": 3.0}
    protocol = {"max_load": 2.0, "loading_time": 20, "hold_time": 10, "unloading_time": 20, "points": 150}
    mechanisms = {"frame_compliance": {"compliance": 60.0}}
    found = simulate(
        specification_from({"material": truth, "indenter": INDENTER, "protocol": protocol, "mechanisms": mechanisms})
    )
    depth = found.depth + 0.3 * np.random.default_rng(3).standard_normal(len(found.depth))
    rows = np.column_stack([found.time, found.load, depth])
    rows = np.vstack([np.zeros(3), rows[np.isfinite(rows).all(axis=1)]])
    np.savetxt("table.csv", rows, delimiter=",", header="Time,Load,Depth", comments="")
    columns = {"time": "Time", "load": "Load", "depth": "Depth"}
    units = {"time": "s", "load": "mN", "depth": "nm"}
    source = {"file": "table.csv", "recordings": "vendor", "condition": "A", "columns": columns, "units": units}
    settings = {
        "study": "small",
        "source": source,
        "points": 40,
        "material": MATERIAL,
        "parameters": {"youngs_modulus": [2.0, 2.5, 3.0, 3.5]},
        "indenter": INDENTER,
        "conditions": [{"name": "A", "load_history": "recorded"}],
        "recordings": {"vendor": "results/small/recordings/vendor"},
        "diagnosis": {"mechanisms": ["frame_compliance"], "snapshots": 8, "bootstrap": 200},
    }
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(settings))
    return load_study("study.yaml")


def test_a_concealed_frame_is_what_explains_it_best(study):
    content, curves = diagnose_source(study, report=lambda line: None)
    assert content["verdict"] == "ambiguous", "one recording alone names nothing for certain"
    found = content["candidates"][0]
    assert found["mechanisms"] == ["frame_compliance"]
    value = found["parameters"]["frame_compliance.compliance"]
    assert value["lower"] < 60.0 < value["upper"]
    assert set(curves["condition"]) == {"A"}


def test_a_study_without_a_file_says_so(study):
    object.__setattr__(study, "source", {})
    with pytest.raises(InputError, match="no vendor's file"):
        diagnose_source(study)
