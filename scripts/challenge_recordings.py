"""Write the recordings of some cases of the trial."""

from pathlib import Path

from palpate.challenge.cases import divided, draw
from palpate.challenge.laboratory import write
from palpate.config import load_study


def main(snakemake):
    study = load_study(snakemake.params.study)
    write(study, divided(draw(study))[snakemake.wildcards.group], Path(snakemake.output[0]))


if "snakemake" in globals():
    main(snakemake)  # noqa: F821
