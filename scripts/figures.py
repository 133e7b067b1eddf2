"""Draw the figures of a study from its saved results, each with its numbers and its caption beside it.

input: every result that they show. output: a folder of figures (SVG, CSV, TXT).
"""

from pathlib import Path

from palpate.output.written_figures import write_figures
from palpate.workflow_support import job
from palpate.workflow_support.saved_results import saved_sets


def main(snakemake):
    folder = Path(snakemake.output[0])
    write_figures(saved_sets(job.study(snakemake), folder.parent), folder)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
