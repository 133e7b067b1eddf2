"""Diagnose one set of recordings, beginning where calibration ended, and draw the result.

input: recordings (CSV), calibration (JSON). output: result (JSON), curves (CSV), figure (PNG), page (HTML), record
(JSON: the runs for MLflow). settings: `diagnosis`, `calibration`, `seed`.
"""

from functools import partial

from palpate.diagnosis.study_diagnosis import run_diagnosis
from palpate.output import diagnosis_page
from palpate.output.figures import explained_curves, style
from palpate.recordings.recording_file import holds_synthetic
from palpate.workflow_support import job
from palpate.workflow_support.result_files import estimate_of, write_json
from palpate.workflow_support.run_records import answer_of, of_diagnosis, tracked_runs


def main(snakemake):
    study, output, answer = job.study(snakemake), snakemake.output, {}
    recordings, calibrated = snakemake.wildcards.recordings, estimate_of(snakemake.input.calibration)
    with tracked_runs(study.name, output.record, answer) as runs:
        report, synthetic = partial(job.note, snakemake.log[0]), holds_synthetic(study.recordings[recordings])
        content, curves = run_diagnosis(study, recordings, calibrated, report, snakemake.threads)
        write_json(output.result, content)
        curves.to_csv(output.curves, index=False)
        style.write(output.figure, explained_curves.compose, content, curves, study.title, synthetic)
        diagnosis_page.write(content, study.declared, output.figure, output.page, f"{study.title}: {recordings}")
        settings = {**study.diagnosis, "seed": study.seed}
        runs += of_diagnosis(content, settings, [output.result, output.curves, output.page, output.figure])
        answer.update(answer_of(content))


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
