"""Write the recordings of some cases of the trial."""

from pathlib import Path

from palpate import job
from palpate.challenge.cases import draw
from palpate.challenge.laboratory import write
from palpate.config import load_study


def main(snakemake):
    study = load_study(snakemake.params.study, data=snakemake.params.data)
    folders = [Path(folder) for folder in snakemake.output]
    names = {folder.name for folder in folders}
    write(study, [case for case in draw(study) if case.name in names], folders[0].parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
