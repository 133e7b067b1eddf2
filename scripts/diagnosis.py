"""Diagnose one set of recordings, draw what was found, and log it."""

from palpate.configuration.study_file import load_study
from palpate.diagnosis.run import run_diagnosis
from palpate.output import diagnosis_page as page
from palpate.output.figures import explained_curves as figure
from palpate.workflow_support import job, steps, tracking


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    recordings = snakemake.wildcards.recordings
    starts = [steps.estimate_of(snakemake.input.calibration)]
    with open(snakemake.log[0], "w", encoding="utf-8") as log:
        content, curves = run_diagnosis(study, recordings, starts, lambda line: print(line, file=log, flush=True))
    steps.write_json(snakemake.output.result, content)
    curves.to_csv(snakemake.output.curves, index=False)
    figure.draw(content, curves, snakemake.output.figure, study.title, synthetic=recordings in study.laboratory)
    page.write(content, study.declared, snakemake.output.figure, snakemake.output.page, f"{study.title}: {recordings}")
    tags = {"recordings": recordings}
    with tracking.nested_run(study.name, f"diagnosis {recordings}", "diagnosis", study.file, tags):
        tracking.log_diagnosis(content, {**study.diagnosis, "seed": study.seed})
        tracking.log_files(snakemake.output)
    tracking.log_explanations(study.name, content, study.file, tags)
    tracking.log_answer(study.name, recordings, content)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
