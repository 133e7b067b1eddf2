"""Write error and parameter tables of one set of recordings, and their figures.

input: calibrations of all condition sets (JSON). output: errors, parameters (CSV), figure, convergence (PNG).
"""

from palpate.output.figures import estimates_figure, search_history
from palpate.recordings.recording_file import holds_synthetic
from palpate.workflow_support import job, steps
from palpate.workflow_support.result_files import read_json


def main(snakemake):
    study, output, recordings = job.study(snakemake), snakemake.output, snakemake.wildcards.recordings
    found = dict(zip(study.condition_sets, map(read_json, snakemake.input.calibrations), strict=True))
    steps.error_table(found["all"]).to_csv(output.errors, index=False)
    truth = study.laboratory.get(recordings, {}).get("parameters")
    table = steps.parameter_table(found, truth)
    table.to_csv(output.parameters, index=False)
    synthetic = holds_synthetic(study.recordings[recordings])
    estimates_figure.draw(table, study.levels, study.declared.values(), output.figure, study.title, synthetic)
    search_history.draw(found, output.convergence, "genetic algorithm", synthetic)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
