"""Write the recordings of one case of the trial."""

from pathlib import Path

from palpate.challenge.trial import write_recordings
from palpate.config import load_study


def main(snakemake):
    study = load_study(snakemake.params.study)
    write_recordings(study, snakemake.wildcards.case, Path(snakemake.output[0]))


if "snakemake" in globals():
    main(snakemake)  # noqa: F821
