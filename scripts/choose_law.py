"""Choose the law of a study by its recordings.

input: recordings (CSV) of the first set. output: law (JSON: law, levels of its parameters, all that were compared),
record (JSON: the run for MLflow). settings: `material.family`, `calibration`, `seed`.
"""

from functools import partial

from palpate.choice.choose import choose
from palpate.workflow_support import job
from palpate.workflow_support.result_files import write_json
from palpate.workflow_support.run_records import tracked_runs
from palpate.workflow_support.runs_of_results import of_choice


def main(snakemake):
    study, output = job.study(snakemake), snakemake.output
    with tracked_runs(study.name, output.record) as record:
        choice = choose(study, partial(job.note, snakemake.log[0]))
        write_json(output.law, choice)
        record.runs.append(of_choice(study, choice, output.law))


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
