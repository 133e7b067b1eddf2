"""Calibrate one condition set on one set of recordings, and draw the fit.

input: recordings (CSV), surrogates. output: result (JSON), curves (CSV), figure (PNG), record (JSON: the runs
for MLflow). settings: `calibration`, `seed`.
"""

from palpate.output.figures import fitted_curves, style
from palpate.recordings.recording_file import holds_synthetic
from palpate.workflow_support import job, steps
from palpate.workflow_support.result_files import write_json
from palpate.workflow_support.run_records import of_calibration, tracked_runs


def main(snakemake):
    study, output = job.study(snakemake), snakemake.output
    recordings, condition_set = snakemake.wildcards.recordings, snakemake.wildcards.condition_set
    with tracked_runs(study.name, output.record) as runs:
        models = dict(zip(study.condition_sets[condition_set], snakemake.input.surrogates, strict=True))
        result, curves = steps.run_calibration(study, recordings, condition_set, models)
        content = result.to_mapping(study=study.name, recordings=recordings, condition_set=condition_set)
        write_json(output.result, content)
        curves.to_csv(output.curves, index=False)
        synthetic = holds_synthetic(study.recordings[recordings])
        title = f"{study.title}: calibrated on the condition set “{condition_set}”"
        style.write(output.figure, fitted_curves.compose, curves, title, synthetic)
        runs.append(of_calibration(content, study.calibration, [output.result, output.curves, output.figure]))


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
