"""Fit the surrogate of one condition.

input: curves of the batches of snapshots. output: model (arrays), summary (JSON: figures of merit), record (JSON: the
run for MLflow). settings: `surrogate`.
"""

from palpate.solver import store
from palpate.surrogate.saved import save
from palpate.workflow_support import job, steps
from palpate.workflow_support.result_files import write_json
from palpate.workflow_support.run_records import tracked_runs
from palpate.workflow_support.runs_of_results import of_surrogate


def main(snakemake):
    study, condition = job.study(snakemake), snakemake.wildcards.condition
    with tracked_runs(study.name, snakemake.output.record) as record:
        contents = store.curves_under(snakemake.input.snapshots, condition)
        model, parameters, curves, summary = steps.fit_surrogate(study, condition, contents)
        save(model, parameters, curves, snakemake.output.model)
        write_json(snakemake.output.summary, summary)
        print(summary["missing"], end="\n" if summary["missing"] else "")
        run = of_surrogate(study, condition, model, summary)
        run.files, run.surrogate = [snakemake.output.summary], snakemake.output.model
        record.runs.append(run)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
