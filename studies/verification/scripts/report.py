"""Verify the solver and write the report.

input: reference curves (CSV), if there are any. output: report (HTML), result (JSON). settings: `quick`, `reference`.
"""

from pathlib import Path

from palpate.workflow_support import job
from studies.verification import runner
from studies.verification.case import Settings


def main(snakemake):
    reference = snakemake.params.reference
    settings = Settings.found(snakemake.params.quick, Path(reference) if reference else None)
    runner.write(runner.run(settings, print), Path(snakemake.output.report).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
