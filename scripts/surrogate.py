"""Fit the surrogate of one condition and log it."""

from pathlib import Path

import joblib

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job, steps, tracking


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    condition = snakemake.wildcards.condition
    model, parameters, curves, summary = steps.fit_surrogate(study, snakemake.input.snapshots)
    joblib.dump(model, snakemake.output.model)
    steps.write_json(snakemake.output.summary, summary)
    metrics = {name: value for name, value in summary.items() if isinstance(value, int | float)}
    with tracking.nested_run(study.name, f"surrogate {condition}", "surrogate", study.file, {"condition": condition}):
        tracking.log_grid(study.levels)
        tracking.log_surrogate(model, parameters, curves, metrics)
        tracking.log_files([Path(snakemake.output.summary)])


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
