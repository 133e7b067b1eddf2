"""A study of real recordings in one process: a vendor's table becomes a diagnosis."""

import numpy as np
import pytest
import yaml

from palpate.configuration.study_file import load_study
from palpate.errors import InputError
from palpate.solver.simulation import simulate, specification_from
from studies.real.diagnose_source import diagnose_source

pytestmark = pytest.mark.slow

MATERIAL = {"model": "elastic", "poisson_ratio": 0.35}
INDENTER = {"shape": "cone", "half_angle": 70.3}
COMPLIANCE = 60.0


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    truth = MATERIAL | {"youngs_modulus": 3.0}
    protocol = {"max_load": 2.0, "loading_time": 20, "hold_time": 10, "unloading_time": 20, "points": 150}
    mechanisms = {"frame_compliance": {"compliance": COMPLIANCE}}
    found = simulate(
        specification_from(
            {
                "material": truth,
                "indenter": INDENTER,
                "protocol": protocol,
                "mechanisms": mechanisms,
                "kinematics": "small",
            }
        )
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
        "points": 12,
        "material": MATERIAL,
        "parameters": {"youngs_modulus": [2.0, 3.0, 4.0]},
        "indenter": INDENTER,
        "conditions": [{"name": "A", "load_history": "recorded"}],
        "recordings": {"vendor": "results/small/recordings/vendor"},
        "diagnosis": {"mechanisms": ["frame_compliance"], "bootstrap": 300},
    }
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(settings))
    return load_study("study.yaml")


def test_a_file_becomes_a_diagnosis(study):
    content, curves = diagnose_source(study, report=lambda line: None)
    assert content["verdict"] in ("adequate", "suspected")
    assert content["mechanisms"] == [], "one recording alone names nothing: a length in no library may do the same"
    (stiff,) = (tried for tried in content["tried"] if tried["mechanisms"] == ["frame_compliance"])
    assert stiff["parameters"]["frame_compliance.compliance"] == pytest.approx(COMPLIANCE, rel=0.25)
    assert content["inclusion"]["frame_compliance"] > 0.1
    assert 0.0 < content["p_value"] <= 1.0
    assert content["sentence"]
    assert set(curves["condition"]) == {"A"}
    _, load, depth = np.loadtxt("table.csv", delimiter=",", skiprows=1).T
    pressed = (depth.max() - COMPLIANCE * load.max()) / np.sqrt(load.max())
    told = curves["load_mN"].to_numpy()
    assert curves["recorded_nm"].to_numpy() == pytest.approx(pressed * np.sqrt(told) + COMPLIANCE * told, abs=2.0)


def test_a_study_without_a_file_says_so(study):
    object.__setattr__(study, "source", {})
    with pytest.raises(InputError, match="no vendor's file"):
        diagnose_source(study, report=print)
