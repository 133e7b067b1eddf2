"""Fit what every mechanism does to the curves of one condition."""

import joblib

from palpate import job, steps
from palpate.config import load_study
from palpate.diagnosis import effects


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    condition = study.condition(snakemake.wildcards.condition)
    fitted = effects.fit_effects(study, condition, snakemake.params.folder)
    joblib.dump(fitted, snakemake.output.model)
    steps.write_json(snakemake.output.summary, effects.summary(fitted))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
