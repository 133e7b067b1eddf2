"""Addresses, the store, and what happens to failures."""

import copy
import json
import math
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest
import yaml

from palpate.base import kernel_cache, source_code
from palpate.base.checksum import content
from palpate.base.fingerprint import closure
from palpate.base.source_code import canonical
from palpate.configuration.study_file import load_study
from palpate.errors import InputError, PalpateError
from palpate.solver import store
from palpate.solver.simulation import Simulation, simulate
from palpate.study.indenter import Indenter
from palpate.study.protocol import Protocol, trapezoid
from palpate.study.specification import Specification

STUDY = {
    "study": "s",
    "material": {"model": "elastic", "poisson_ratio": 0.3},
    "parameters": {"youngs_modulus": [1.0, 2.0, 3.0]},
    "indenter": {"shape": "cone", "half_angle": 70.3},
    "points": 10,
    "cells_per_job": 2,
    "conditions": [
        {"name": "a", "max_load": 1.0, "loading_time": 1, "unloading_time": 1},
        {"name": "v", "max_load": 2.0, "loading_time": 1, "unloading_time": 1, "role": "validate"},
    ],
}


def study(folder, **changes):
    file = folder / "study.yaml"
    file.write_text(yaml.safe_dump(STUDY | changes))
    return load_study(file)


def snapshots_under(chosen, condition):
    batches = [batch for batch in store.plan(chosen) if condition in [each.name for each in batch.conditions]]
    return [snapshot for batch in batches for snapshot in batch.snapshots if snapshot.condition == condition]


def fake(specifications):
    return [linear(specification) for specification in specifications]


def linear(specification):
    t = specification.protocol.sample_time
    depth = specification.parameters["youngs_modulus"] * t
    return Simulation(t, specification.protocol.sample_load, depth, "ok", "", 0.1)


def failing(specifications):
    return [failed(s) if s.parameters["youngs_modulus"] == 2.0 else linear(s) for s in specifications]


def failed(specification):
    t = specification.protocol.sample_time
    return Simulation(t, t, np.full(len(t), np.nan), "failed", "no equilibrium", 0.1)


def run(study, folder, solve=fake):
    """Return how many snapshots each batch computed."""
    counts = []

    def counted(specifications):
        counts[-1] += len(specifications)
        return solve(specifications)

    for batch in store.plan(study):
        counts.append(0)
        store.computed(batch.snapshots, folder, lambda line: None, counted)
    return counts


def test_only_calibrate_conditions_are_planned_in_batches(tmp_path):
    batches = store.plan(study(tmp_path))
    assert [len(batch.snapshots) for batch in batches] == [2, 1]
    assert {snapshot.condition for batch in batches for snapshot in batch.snapshots} == {"a"}


def test_a_batch_is_known_by_what_it_computes(tmp_path):
    one, again, other = (store.plan(study(tmp_path, **c)) for c in ({}, {"title": "t"}, {"kinematics": "small"}))
    assert [batch.identity for batch in one] == [batch.identity for batch in again]
    assert not {batch.identity for batch in one} & {batch.identity for batch in other}
    assert len({batch.identity for batch in one}) == 2


def test_nothing_is_computed_twice_across_levels_and_studies(tmp_path):
    assert run(study(tmp_path), tmp_path) == [2, 1]
    assert run(study(tmp_path), tmp_path) == [0, 0]
    assert run(study(tmp_path, parameters={"youngs_modulus": [1.0, 1.5, 2.0, 3.0]}), tmp_path) == [1, 0]
    assert run(study(tmp_path, study="other"), tmp_path) == [0, 0]


@pytest.mark.parametrize(
    ("indenter", "solved"),
    [({"shape": "cone", "half_angle": 70.3}, [3, 3]), ({"shape": "sphere", "radius": 5000.0}, [3, 3, 3])],
)
def test_conditions_that_differ_in_size_alone_share_their_simulations(tmp_path, simulated, indenter, solved):
    """Two of three: one lasts longer. Under a sphere, which is a length, none do."""
    conditions = [
        {"name": name, "max_load": load, "loading_time": time, "unloading_time": 1}
        for name, load, time in (("a", 1.0, 1), ("slow", 1.0, 5), ("b", 4.0, 1))
    ]
    s = study(tmp_path, conditions=conditions, indenter=indenter, cells_per_job=3, diagnosis={"enabled": False})
    for batch in store.plan(s):
        store.computed(batch.snapshots, tmp_path, lambda line: None)
    assert simulated == solved
    for condition in s.conditions:
        snapshots = snapshots_under(s, condition.name)
        assert len(snapshots) == 3
        for stored in store.computed(snapshots, tmp_path, lambda line: None):
            alone = simulate(s.specification(stored["parameters"], condition))
            assert stored["condition"] == condition.name
            assert stored["load"] == pytest.approx(alone.load)
            assert stored["depth"] == pytest.approx(alone.depth, rel=1e-6, abs=1e-4)


@pytest.mark.parametrize(
    "change",
    [
        {"material": {"model": "elastic", "poisson_ratio": 0.31}},
        {"indenter": {"shape": "cone", "half_angle": 70.0}},
        {"kinematics": "small"},
        {"accuracy": "fine"},
        {"points": 11},
    ],
)
def test_whatever_decides_the_curve_changes_the_address(tmp_path, change):
    one, other = study(tmp_path), study(tmp_path, **change)
    addresses = [{snapshot.address for snapshot in snapshots_under(s, "a")} for s in (one, other)]
    assert not addresses[0] & addresses[1]


SPECIFICATION = Specification(
    "elastic",
    {"youngs_modulus": 3.0, "poisson_ratio": 0.3},
    Indenter("cone", half_angle=70.3),
    trapezoid(1.0, 1.0, 0.0, 1.0, points=10),
    kinematics="small",
)


def another(value):
    """Return a value of the same kind that differs."""
    if is_dataclass(value):
        name = next(f.name for f in fields(value) if f.init)
        return with_field(value, name, another(getattr(value, name)))
    if isinstance(value, dict):
        return value | {"another": {"x": 1.0}}
    if isinstance(value, np.ndarray):
        return np.append(value[:-1], np.nextafter(value[-1], np.inf))
    if isinstance(value, tuple):
        return (*value, 1.0)
    if isinstance(value, str):
        return f"{value}, another"
    if value is None:
        return 1.0
    return not value if isinstance(value, bool) else (np.nextafter(value, np.inf) if math.isfinite(value) else 1.0)


def with_field(value, name, changed):
    """Return a copy of a frozen object with one field changed, unchecked, so that any value will do."""
    copied = copy.copy(value)
    object.__setattr__(copied, name, changed)
    return copied


def given(kind):
    return [f.name for f in fields(kind) if f.init and f.compare]


@pytest.mark.parametrize(
    ("part", "name"),
    [(None, name) for name in given(Specification)]
    + [("indenter", name) for name in given(Indenter)]
    + [("protocol", name) for name in given(Protocol)],
)
def test_every_field_is_in_the_address(part, name):
    """To the last digit: fields are not listed anywhere, so that one that is added cannot be forgotten."""
    whole = getattr(SPECIFICATION, part) if part else SPECIFICATION
    changed = with_field(whole, name, another(getattr(whole, name)))
    other = with_field(SPECIFICATION, part, changed) if part else changed
    assert store.address(other) != store.address(SPECIFICATION)


@pytest.mark.parametrize(
    "length", [{"film_thickness": 500.0}, {"size_length": 100.0}, {"adhesion": 50.0}, {"substrate_modulus": 80.0}]
)
def test_curves_that_differ_in_a_length_of_the_specimen_alone_do_not_share_an_address(length):
    parts = SPECIFICATION.model, SPECIFICATION.parameters, SPECIFICATION.indenter, SPECIFICATION.protocol
    film = {"film_thickness": 1000.0, "substrate_modulus": 70.0}
    addresses = {store.address(Specification(*parts, **lengths)) for lengths in (film, film | length)}
    assert len(addresses) == 2


def test_equal_numbers_of_any_kind_have_the_same_address():
    """Whole, of NumPy, or a negative zero, in a different order of keys."""
    indenter = Indenter("cone", half_angle=np.float64(70.3), radius=0, friction=-0.0)
    parameters = {"poisson_ratio": 0.3, "youngs_modulus": 3}
    same = Specification(
        "elastic", parameters, indenter, SPECIFICATION.protocol, film_thickness=np.inf, kinematics="small"
    )
    assert store.address(same) == store.address(SPECIFICATION)


def test_content_is_written_in_json_that_restores_it():
    written = json.dumps(content(SPECIFICATION))
    assert json.loads(written)["Specification"]["film_thickness"] == math.inf
    assert json.loads(written) == content(SPECIFICATION)


def test_what_has_no_content_is_refused():
    with pytest.raises(TypeError, match="function has no content"):
        content({"law": fake})


def test_a_failure_is_kept_with_its_reason_and_left_out_of_the_matrix(tmp_path):
    s = study(tmp_path)
    snapshots = snapshots_under(s, "a")
    contents = store.computed(snapshots, tmp_path, lambda line: None, failing)
    assert list(store.table(snapshots, contents)["status"]) == ["ok", "failed", "ok"]
    parameters, curves, failures = store.matrix(contents, s.levels)
    assert parameters.ravel().tolist() == [1.0, 3.0]
    assert len(curves) == 2
    assert "no equilibrium" in failures[0]
    with pytest.raises(PalpateError, match="no equilibrium"):
        store.matrix(contents[1:2], s.levels)


@pytest.mark.faults(before="a traceback at the surrogate")
@pytest.mark.parametrize("fault", ["cut", "altered", "empty", "compressed in no known way", "another's"])
def test_a_damaged_snapshot_is_recognised_and_computed_again(tmp_path, fault):
    s = study(tmp_path)
    run(s, tmp_path)
    snapshot, other, *_ = snapshots_under(s, "a")
    file = store.place(snapshot.address, tmp_path)
    whole = file.read_bytes()
    middle, method = len(whole) // 2, whole.rindex(b"PK\1\2") + 10
    faults = {
        "cut": whole[:middle],
        "altered": whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :],
        "empty": b"",
        "compressed in no known way": whole[:method] + b"?" + whole[method + 1 :],
        "another's": store.place(other.address, tmp_path).read_bytes(),
    }
    file.write_bytes(faults[fault])
    assert run(s, tmp_path) == [1, 0]
    assert file.read_bytes() == whole


@pytest.mark.faults(before="a traceback")
def test_a_folder_in_the_place_of_a_curve_is_named(tmp_path):
    s = study(tmp_path)
    file = store.place(snapshots_under(s, "a")[0].address, tmp_path)
    file.mkdir(parents=True)
    with pytest.raises(InputError, match=f"{file.name}: is a folder where a curve is kept; remove it"):
        run(s, tmp_path)


def tables(study, folder):
    """Write the curves of every batch, as its job does, and return the files."""
    files = []
    for batch in store.plan(study):
        files.append(folder / f"{batch.name}.parquet")
        contents = store.computed(batch.snapshots, folder, lambda line: None)
        store.table(batch.snapshots, contents).to_parquet(files[-1], index=False)
    return files


def test_a_batch_keeps_its_curves_in_one_file_to_the_last_bit(tmp_path):
    s = study(tmp_path)
    run(s, tmp_path)
    files = tables(s, tmp_path)
    expected = store.computed(snapshots_under(s, "a"), tmp_path, lambda line: None)
    for one, other in zip(store.curves_under(files, "a"), expected, strict=True):
        assert one["parameters"] == other["parameters"]
        for key in store.CURVES.values():
            np.testing.assert_array_equal(one[key], other[key])


def test_a_curve_that_another_study_left_serves_though_its_grid_has_other_parameters(tmp_path):
    run(study(tmp_path), tmp_path)
    levels = STUDY["parameters"] | {"poisson_ratio": [0.3]}
    s = study(tmp_path, material={"model": "elastic"}, parameters=levels)
    assert run(s, tmp_path) == [0, 0]
    contents = store.curves_under(tables(s, tmp_path), "a")
    parameters, *_ = store.matrix(contents, s.levels)
    assert [dict(zip(s.levels, row, strict=True)) for row in parameters.tolist()] == s.cells


@pytest.mark.faults(before="held")
def test_a_killed_job_leaves_no_half_file(tmp_path):
    def killed(specifications):
        raise KeyboardInterrupt

    s = study(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        run(s, tmp_path, killed)
    assert not list(tmp_path.rglob("*.npz"))


@pytest.mark.faults(before="held")
def test_a_full_disk_leaves_no_half_file(tmp_path, monkeypatch):
    def full(stream, **arrays):
        stream.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store.np, "savez", full)
    with pytest.raises(OSError, match="No space left"):
        run(study(tmp_path), tmp_path)
    assert [file.name for file in tmp_path.rglob("*") if file.is_file()] == ["study.yaml"]


@pytest.mark.faults(before="held")
def test_a_killed_job_keeps_what_it_solved_before(tmp_path, monkeypatch):
    def killed_at_the_third(specifications):
        if specifications[0].parameters["youngs_modulus"] == 3.0:
            raise KeyboardInterrupt
        return fake(specifications)

    monkeypatch.setattr(store, "AT_ONCE", 2)
    s = study(tmp_path, cells_per_job=3)
    with pytest.raises(KeyboardInterrupt):
        run(s, tmp_path, killed_at_the_third)
    assert run(s, tmp_path) == [1]


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text,
        lambda text: text[: len(text) // 2],
        lambda text: "[1]",
        lambda text: '{"a": 1, "b": 2, "c": 3}',
    ],
    ids=["whole", "cut", "no table", "another table"],
)
def test_what_is_remembered_of_source_code_is_what_is_found_anew(tmp_path, monkeypatch, damage):
    monkeypatch.setattr(kernel_cache, "kept", lambda name: tmp_path)
    file, remembered = tmp_path / "law.py", tmp_path / "sources.json"
    file.write_text("import numpy\nx = 1\n")
    found = []
    for _ in range(2):
        monkeypatch.setattr(source_code, "_known", {})
        source_code.source_code.cache_clear()
        with source_code.known():
            found.append(source_code.source_code(file))
        remembered.write_text(damage(remembered.read_text()))
    assert found[0] == found[1]
    file.write_text("import numpy\nx = 2\n")
    source_code.source_code.cache_clear()
    assert source_code.source_code(file).identity != found[0].identity


def test_fingerprint_ignores_comments_and_docstrings_but_not_formulas():
    plain = '"""A."""\nx = f"{1}"\n'
    for same in ('"""B\nb"""\nx = f"{1}"  # one\n', '\n\nx  =  f"{1}"\n'):
        assert canonical(same) == canonical(plain)
    for other in ('x = f"{2}"\n', 'y = f"{1}"\n', 'x = "1"\n'):
        assert canonical(other) != canonical(plain)


@pytest.mark.parametrize("rule", ["calibration", "diagnosis", "vendor_recordings"])
def test_a_changed_reader_changes_the_fingerprints_of_results_and_of_no_curve(rule):
    reader = "kla.py"
    assert reader in {file.name for file in closure(Path(__file__).parents[2] / f"scripts/{rule}.py")}
    assert reader not in {file.name for file in closure("palpate.solver.simulation")}


def test_addresses_know_all_code_that_decides_a_curve():
    names = {file.name for file in closure("palpate.solver.simulation")}
    assert {
        "contact.py",
        "contact_3d.py",
        "nonlinear_burgers.py",
        "radial.py",
        "friction.py",
        "area_function.py",
    } <= names
    assert not {"genetic.py", "store.py", "errors.py"} & names
