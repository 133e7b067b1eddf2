"""Outcomes of the thesis' studies, as their files hold them, of made-up numbers: for tests of the figures."""

import numpy as np

ALUMINIUM = ("youngs_modulus", "yield_stress", "hardening")
EPOXY = (
    "youngs_modulus", "steady_coefficient", "steady_exponent", "transient_coefficient", "transient_exponent",
    "retardation_time",
)  # fmt: skip
KERNELS = ("linear", "cubic", "multiquadric", "gaussian", "inverse_multiquadric")
TIMES = ("30", "45", "60", "240")
RAMP, RANGE = [0.0, 1.0, 2.0], (1.0, 3.0)


def estimate(name, **more):
    return {"parameter": name, "estimate": 2.0, "lower": 1.5, "upper": 2.5, "identified": True, "truth": 2.1} | more


def variance(factors):
    means = {name: {"levels": [1.0, 2.0], "means": [3.0, 4.0]} for name in factors}
    shares = {name: 100.0 / (k + 2) for k, name in enumerate(factors)}
    effects = {"main_effects": means, "depth_effects": means}
    return {"series": effects | dict.fromkeys(("contributions", "depth_contributions", "thesis"), shares)}


def aluminium():
    curves = {f"{source}_{grid}": RAMP for source in ("surrogate", "fe") for grid in ("64", "36")}
    series = {"time": RAMP, "load": RAMP, "recorded": RAMP, "bounds": dict.fromkeys(ALUMINIUM, RANGE)} | curves
    rows = [estimate(name, snapshots=grid) for name in ALUMINIUM for grid in ("64", "36")]
    return {"series": series, "tables": {"parameters": rows}}


def epoxy():
    names = [f"P{load}_T{time}" for load in ("1.00", "0.50") for time in TIMES]
    part = {"time": RAMP, "misfit": RAMP, "role": "calibrate"}
    errors = [{"condition": name, "rmse_nm": 3.0, "thesis_rmse_nm": 4.0} for name in names]
    series = {"misfit": dict.fromkeys(names, part), "levels": dict.fromkeys(EPOXY, RANGE)}
    tables = {"errors of every test": errors, "parameters": [estimate(name) for name in EPOXY]}
    return {"series": series, "tables": tables}


def rbf():
    grids, modes, shapes = ("64", "36"), ("one mode", "all modes"), (0.5, 1.5)
    scaled = {f"{kernel}_{what}": 2.0 for kernel in KERNELS[2:] for what in ("percent", "condition")}
    kernels = [
        {"snapshots": grid, "modes": mode, "kernel": kernel, "midpoint_percent": 2.0}
        for grid in grids for mode in modes for kernel in KERNELS
    ]  # fmt: skip
    noises = {f"noise_{level}_percent": 2.0 + level for level in (0, 1, 5)}
    series = {
        "kernels": kernels,
        "noise": [{"snapshots": grid, "kernel": kernel, **noises} for grid in grids for kernel in KERNELS],
        "shapes": [{"modes": mode, "shape": shape, **scaled} for mode in modes for shape in shapes],
        "printed_shapes": [{"shape": shape, **scaled} for shape in shapes],
        "spectra": {grid: {"eigenvalues": [1e8 / 10**k for k in range(16)]} for grid in grids},
        "map": {"youngs_modulus": [60.0, 70.0], "yield_stress": [0.1, 0.2], "percent": [[1.0, 2.0], [3.0, 4.0]]},
    }
    return {"series": series}


def friction():
    rows = [
        {"kinematics": "large", "friction": coefficient, "max_load": 1.0, "loading_time": float(time)}
        | {"max_depth_reduction_percent": 0.5, "residual_depth_reduction_percent": None if time == "30" else 1.0}
        for coefficient in (0.125, 0.25, 0.5) for time in TIMES
    ]  # fmt: skip
    return {"series": {"rows": rows}}


def sensitivity():
    row = {"max_depth_percent": -3.0, "residual_depth_percent": 4.0}
    return {"series": {"rows": [{"condition": f"P1.00_T0{t}", "parameter": n, **row} for t in TIMES for n in EPOXY]}}


def optimisers():
    reached = {"10": [100, 0.1], "1": [1000, 1.0]}
    runs = [{"optimiser": name, "seed": k, "best": 1.0, "reached": reached} for name in ("a", "b") for k in (1, 2)]
    return {"series": {"runs": runs, "budget": 120000, "least": 1.0}}


def identifiability():
    names = [*EPOXY, "poisson_ratio"]
    profile = {"values": RAMP, "chi_square": [4.0, 0.0, 4.0], "truth": 1.0}
    widths = {tests: np.geomspace(0.01, 99.0, len(names)).tolist() for tests in ("four tests", "with a hold")}
    return {"series": {"widths": widths, "names": names, "profiles": dict.fromkeys(EPOXY, profile)}}


def designs():
    error = {"rmse_nm": 1.0, "largest_nm": 5.0}
    kinds = ("full factorial", "Sobol", "Latin hypercube")
    return {"series": {"rows": [{"design": kind, "snapshots": size, **error} for kind in kinds for size in (72, 288)]}}


def dimensionless():
    error = {"rmse_nm": 1.0, "largest_nm": 5.0}
    return {"series": {"curve": [{"snapshots": size, **error} for size in (32, 256)], "separate": error}}


def baselines():
    moduli = [
        {"recording": "elastic, cone", "method": method, "modulus_GPa": 3.3, "truth_GPa": 3.0, "error_percent": error}
        for method, error in (("Oliver-Pharr", 10.0), ("Oliver-Pharr, Ngan", -2.0))
    ]
    curve = {"time": RAMP, "depth": RAMP, "loading and hold": [0.0, 1.0, None], "whole": RAMP, "solver": RAMP}
    return {"series": {"moduli": moduli, "curves": dict.fromkeys(("linear", "epoxy"), curve)}}


OUTCOMES = {
    "aluminium": aluminium(),
    "anova_aluminium": variance(ALUMINIUM),
    "anova_epoxy": variance(EPOXY),
    "baselines": baselines(),
    "designs": designs(),
    "dimensionless": dimensionless(),
    "epoxy": epoxy(),
    "friction": friction(),
    "identifiability": identifiability(),
    "optimisers": optimisers(),
    "rbf": rbf(),
    "sensitivity": sensitivity(),
}
