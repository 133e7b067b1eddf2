"""Send the records of surrogates and fits to MLflow; what cannot be sent stays on disk, and the receipt says so.

input: records (JSON). output: the receipt (JSON), in the folder of the records.
"""

from pathlib import Path

from palpate.workflow_support import job, tracking
from palpate.workflow_support.result_files import write_json


def main(snakemake):
    receipt = Path(snakemake.output[0])
    pending = tracking.send(receipt.parent)
    status, attempt = "pending" if pending else "sent", snakemake.params.attempt
    write_json(receipt, {"status": status, "pending": pending, "attempt": attempt})


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
