"""Draw the quality of all surrogates.

input: summaries of the surrogates (JSON). output: figure (PNG).
"""

from pathlib import Path

from palpate.output.figures import surrogate_errors
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json


def main(snakemake):
    summaries = {Path(file).stem: read_json(file) for file in snakemake.input}
    surrogate_errors.draw(summaries, snakemake.output[0], snakemake.params.title)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
