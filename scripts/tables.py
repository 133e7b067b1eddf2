"""Write error and parameter tables of one set of recordings, and their figures."""

from palpate.configuration.study_file import load_study
from palpate.output.figures import estimates_figure, search_history
from palpate.workflow_support import job, steps


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    recordings = snakemake.wildcards.recordings
    found = dict(zip(study.condition_sets, map(steps.read_json, snakemake.input.calibrations), strict=True))
    steps.error_table(found["all"]).to_csv(snakemake.output.errors, index=False)
    truth = study.laboratory.get(recordings, {}).get("parameters")
    table = steps.parameter_table(found, truth)
    table.to_csv(snakemake.output.parameters, index=False)
    synthetic = recordings in study.laboratory
    estimates_figure.draw(table, study.levels, study.declared.values(), snakemake.output.figure, study.title, synthetic)
    search_history.draw(found, snakemake.output.convergence, "genetic algorithm", synthetic)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
