"""Make the tables of one study of the thesis from its curves, and the records of what it fitted."""

import time
from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job
from palpate.workflow_support.result_files import write_json
from palpate.workflow_support.run_records import tracked_runs
from studies import thesis


def main(snakemake):
    began, key = time.perf_counter(), snakemake.wildcards.key
    context = thesis.Context(
        studies={Path(file).stem: load_study(file) for file in snakemake.input.studies},
        curves={Path(file).stem: thesis.Curves.load_from(file) for file in snakemake.input.designs},
    )
    fitted = Path(snakemake.output.fitted)
    fitted.mkdir(parents=True, exist_ok=True)
    with tracked_runs("thesis", snakemake.output.record) as record:
        outcome = thesis.STUDIES[key].run(context)
        record.runs += [each.run(fitted, key) for each in outcome.fitted]
    seconds = {"seconds": time.perf_counter() - began}
    write_json(snakemake.output.outcome, outcome.to_mapping() | seconds)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
