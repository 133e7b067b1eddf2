"""Log every surrogate and fit of the thesis' studies: one job, so that MLflow is loaded once."""

from pathlib import Path

import joblib

from palpate.workflow_support import job, tracking


def main(snakemake):
    for file in snakemake.input.fitted:
        configuration, fits = joblib.load(file)
        for fit in fits:
            with tracking.nested_run("thesis", fit.name, fit.kind, configuration, {"thesis_study": Path(file).stem}):
                if fit.model is not None:
                    tracking.log_surrogate(fit.model, fit.parameters, fit.curves, fit.metrics)
                elif fit.calibration is not None:
                    tracking.log_calibration(fit.calibration, fit.settings)
                else:
                    tracking.log_fit(fit.settings, fit.metrics, fit.series)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
