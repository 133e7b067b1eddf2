"""Draw the figure of one study of the thesis from its saved outcome, with its numbers and caption beside it."""

from pathlib import Path

from palpate.output.written_figures import write_figure
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies.thesis.figures import FIGURES


def main(snakemake):
    stem = Path(snakemake.output[0]).with_suffix("")
    write_figure(FIGURES[snakemake.wildcards.key], read_json(snakemake.input[0]), stem, True, ("svg", "pdf"))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
