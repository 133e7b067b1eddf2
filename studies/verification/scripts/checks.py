"""End with an error when a check of the solver failed.

input: report (HTML), result (JSON).
"""

from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies.verification.runner import refuse_failed


def main(snakemake):
    refuse_failed(read_json(snakemake.input.result), snakemake.input.report)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
