"""Diagnose one set of recordings, beginning where calibration ended.

input: recordings (CSV), calibration (JSON). output: result (JSON), curves (CSV), record (JSON: the runs for MLflow).
settings: `diagnosis`, `calibration`, `seed`.
"""

from functools import partial

from palpate.diagnosis.study_diagnosis import run_diagnosis
from palpate.workflow_support import job
from palpate.workflow_support.result_files import calibration_of, write_json
from palpate.workflow_support.run_records import tracked_runs
from palpate.workflow_support.runs_of_results import of_diagnosis


def main(snakemake):
    study, output = job.study(snakemake), snakemake.output
    recordings, calibration = snakemake.wildcards.recordings, calibration_of(snakemake.input.calibration)
    with tracked_runs(study.name, output.record) as record:
        report = partial(job.note, snakemake.log[0])
        content, curves = run_diagnosis(study, recordings, calibration, report, snakemake.threads)
        write_json(output.result, content)
        curves.to_csv(output.curves, index=False)
        record.runs += of_diagnosis(content, study, [output.result, output.curves])


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
