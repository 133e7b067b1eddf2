"""Diagnose one set of recordings, draw what was found, and log it."""

from palpate import job, steps, tracking
from palpate.config import load_study
from palpate.diagnosis import page
from palpate.diagnosis.steps import run_diagnosis
from palpate.figures import diagnosis as figure


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    recordings, names = snakemake.wildcards.recordings, snakemake.params.conditions
    base = dict(zip(names, snakemake.input.surrogates, strict=True))
    effects = dict(zip(names, snakemake.input.effects, strict=True))
    with open(snakemake.log[0], "w", encoding="utf-8") as log:
        content, curves = run_diagnosis(
            study, recordings, base, effects, lambda line: print(line, file=log, flush=True)
        )
    steps.write_json(snakemake.output.result, content)
    curves.to_csv(snakemake.output.curves, index=False)
    figure.draw(content, curves, snakemake.output.figure, study.title, synthetic=recordings in study.laboratory)
    page.write(content, study.declared, snakemake.output.figure, snakemake.output.page, f"{study.title}: {recordings}")
    with tracking.nested_run(
        study.name, f"diagnosis {recordings}", "diagnosis", study.file, {"recordings": recordings}
    ):
        tracking.log_diagnosis(content, {**study.diagnosis, "seed": study.seed})
        tracking.log_files(snakemake.output)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
