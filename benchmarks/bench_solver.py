"""Cost and accuracy of one snapshot on one core: pytest benchmarks --benchmark-only (set OMP_NUM_THREADS=1)."""

import subprocess
import sys
from dataclasses import replace
from time import process_time

import numpy as np
import pytest

from palpate.configuration.study_file import load_study
from palpate.solver.simulation import simulate, simulate_batch, specification_from
from studies.verification.reference_materials import BURGERS as EPOXY

BURGERS = {"model": "nonlinear_burgers", **EPOXY}


def specification(kinematics="small", accuracy="standard", time=30.0):
    return specification_from(
        {
            "material": BURGERS,
            "indenter": {"shape": "cone", "half_angle": 70.3},
            "protocol": {"max_load": 1.0, "loading_time": time, "unloading_time": time, "points": 100},
            "kinematics": kinematics,
            "accuracy": accuracy,
        }
    )


@pytest.mark.parametrize("kinematics", ["small", "large"])
@pytest.mark.parametrize("time", [30.0, 240.0])
def test_snapshot(benchmark, kinematics, time):
    spec = specification(kinematics, time=time)
    simulate(spec)
    simulation = benchmark.pedantic(simulate, args=(spec,), rounds=10)
    fine = simulate(specification(kinematics, "fine", time))
    benchmark.extra_info["largest_deviation_from_fine_percent"] = float(
        100 * np.abs(simulation.depth / fine.depth - 1).max()
    )
    benchmark.extra_info["solver_seconds"] = simulation.solver_seconds


@pytest.mark.parametrize("condition", ["P1.00_T030", "P1.00_T240"])
def test_batch(benchmark, condition):
    """One job of the epoxy study against the single solver on a sample of it, by turns and in CPU time."""
    study = load_study("config/config.yaml")
    test = next(c for c in study.conditions if c.name == condition)
    job = [study.specification(cell, test) for cell in study.cells[: study.cells_per_job]]
    sample = job[:: len(job) // 6]
    simulate(job[0]), simulate_batch(job[:2])
    single, batched = [], []

    def turn():
        began = process_time()
        together = simulate_batch(job)
        between = process_time()
        alone = [simulate(spec) for spec in sample]
        batched.append((between - began) / len(job))
        single.append((process_time() - between) / len(sample))
        return together[:: len(job) // 6], alone

    curves = benchmark.pedantic(turn, rounds=3)
    differences = [np.abs(a.depth - b.depth).max() / b.depth.max() for a, b in zip(*curves, strict=True)]
    benchmark.extra_info["largest_difference_over_peak"] = float(max(differences))
    benchmark.extra_info["cpu_seconds_single"] = min(single)
    benchmark.extra_info["cpu_seconds_batched"] = min(batched)
    benchmark.extra_info["times_faster"] = min(single) / min(batched)


@pytest.mark.parametrize("kinematics", ["small", "large"])
@pytest.mark.parametrize("mechanism", [{"friction": {"coefficient": 0.2}}, {"adhesion": {"work": 100.0}}], ids=str)
def test_surface_in_lanes(benchmark, kinematics, mechanism):
    """Eight materials in lanes against eight times one simulation, in CPU time."""
    once = replace(specification(kinematics), mechanisms=mechanism)
    moduli = once.parameters["youngs_modulus"] * np.linspace(0.9, 1.1, 8)
    eight = [replace(once, parameters={**once.parameters, "youngs_modulus": float(modulus)}) for modulus in moduli]
    simulate(once), simulate_batch(eight)
    single, together = [], []

    def turn():
        began = process_time()
        simulate_batch(eight)
        between = process_time()
        simulate(once)
        together.append(between - began)
        single.append(process_time() - between)

    benchmark.pedantic(turn, rounds=5)
    benchmark.extra_info["times_faster"] = 8 * min(single) / min(together)


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_flow_that_hardens(benchmark, kinematics):
    """Eight materials with Eyring flow, one that hardens, and a back stress beside it, by turns in CPU time."""
    plain = {"reference_rate": 1e-6, "eyring_stress": 0.01, "pressure_coefficient": 0.1}
    flows = {
        "eyring": plain,
        "hardening_eyring": plain | {"hardening": 0.1},
        "hardening_eyring+kinematic_hardening": plain | {"hardening": 0.1, "kinematic_modulus": 0.2},
    }
    once, seconds = specification(kinematics), {model: [] for model in flows}

    def eight(model):
        moduli = 3.28 * np.linspace(0.9, 1.1, 8)
        hooke = [{"youngs_modulus": float(modulus), "poisson_ratio": 0.34} for modulus in moduli]
        return [replace(once, model=model, parameters=own | flows[model]) for own in hooke]

    def turn():
        for model in flows:
            began = process_time()
            simulate_batch(eight(model))
            seconds[model].append(process_time() - began)

    turn()
    benchmark.pedantic(turn, rounds=4)
    for model in flows:
        benchmark.extra_info[f"{model}_over_eyring"] = min(seconds[model]) / min(seconds["eyring"])


def test_memory_of_a_process_that_simulates(benchmark):
    code = (
        "import resource, sys; sys.path.insert(0, 'benchmarks'); import bench_solver as b; "
        "b.simulate(b.specification()); print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
    )
    run = benchmark.pedantic(subprocess.run, args=([sys.executable, "-c", code],), kwargs={"capture_output": True})
    benchmark.extra_info["peak_memory_mb"] = float(run.stdout)
