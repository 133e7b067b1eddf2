"""Make the tables of one study of the thesis from its curves."""

import time
from pathlib import Path

import joblib

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job, steps
from studies import thesis


def main(snakemake):
    began = time.perf_counter()
    context = thesis.Context(
        studies={Path(file).stem: load_study(file) for file in snakemake.input.studies},
        curves={Path(file).stem: thesis.Curves.load_from(file) for file in snakemake.input.designs},
        outcomes={Path(file).stem: steps.read_json(file) for file in snakemake.input.outcomes},
    )
    outcome = thesis.STUDIES[snakemake.wildcards.key].run(context)
    joblib.dump((Path(snakemake.input.studies[0]), outcome.fitted), snakemake.output.fitted)
    seconds = {"seconds": time.perf_counter() - began}
    steps.write_json(snakemake.output.outcome, outcome.to_mapping() | seconds)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
