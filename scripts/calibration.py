"""Calibrate one condition set on one set of recordings.

input: recordings (CSV), surrogates, summaries of all surrogates (JSON). output: result (JSON), curves (CSV), record
(JSON: the runs for MLflow). settings: `calibration`, `seed`.
"""

from functools import partial
from pathlib import Path

from palpate.output.saved_set import SavedSet
from palpate.workflow_support import job, steps
from palpate.workflow_support.result_files import read_json, write_json
from palpate.workflow_support.run_records import tracked_runs
from palpate.workflow_support.runs_of_results import of_calibration


def main(snakemake):
    study, output = job.study(snakemake), snakemake.output
    recordings, condition_set = snakemake.wildcards.recordings, snakemake.wildcards.condition_set
    with tracked_runs(study.name, output.record) as record:
        models = dict(zip(study.condition_sets[condition_set], snakemake.input.surrogates, strict=True))
        report = partial(job.note, snakemake.log[0])
        result, curves = steps.run_calibration(study, recordings, condition_set, models, report)
        content = result.to_mapping(study=study.name, recordings=recordings, condition_set=condition_set)
        write_json(output.result, content)
        curves.to_csv(output.curves, index=False)
        summaries = {Path(file).stem: read_json(file) for file in snakemake.input.summaries}
        saved = SavedSet(study, recordings, {}, {condition_set: content}, {}, surrogates=summaries)
        record.runs.append(of_calibration(saved, condition_set, [output.result, output.curves]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
