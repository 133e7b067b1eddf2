"""Write the recordings of some cases of the trial."""

from pathlib import Path

from palpate.workflow_support import job
from studies.blind_trial.cases import draw
from studies.blind_trial.laboratory import write


def main(snakemake):
    study = job.study(snakemake)
    folders = [Path(folder) for folder in snakemake.output]
    names = {folder.name for folder in folders}
    write(study, [case for case in draw(study) if case.name in names], folders[0].parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
