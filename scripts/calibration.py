"""Calibrate one condition set on one set of recordings, draw the fit, and log both."""

from palpate.configuration.study_file import load_study
from palpate.output.figures import fitted_curves
from palpate.workflow_support import job, steps, tracking


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    recordings, condition_set = snakemake.wildcards.recordings, snakemake.wildcards.condition_set
    models = dict(zip(study.condition_sets[condition_set], snakemake.input.surrogates, strict=True))
    result, curves = steps.run_calibration(study, recordings, condition_set, models)
    content = result.to_mapping(study=study.name, recordings=recordings, condition_set=condition_set)
    steps.write_json(snakemake.output.result, content)
    curves.to_csv(snakemake.output.curves, index=False)
    title = f"{study.title}: calibrated on the condition set “{condition_set}”"
    fitted_curves.draw(curves, snakemake.output.figure, title, synthetic=recordings in study.laboratory)
    tags = {"recordings": recordings, "condition_set": condition_set}
    with tracking.nested_run(study.name, f"fit {recordings} {condition_set}", "calibration", study.file, tags):
        tracking.log_calibration(content, study.calibration)
        tracking.log_files(snakemake.output)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
