"""Verify the solver and write the report.

input: reference curves (CSV), if there are any. output: report (HTML), result (JSON). settings: `quick`, `reference`.
"""

from pathlib import Path

from palpate.verification import runner
from palpate.verification.case import Settings
from palpate.workflow_support import job


def main(snakemake):
    reference = snakemake.params.reference
    settings = Settings.found(snakemake.params.quick, Path(reference) if reference else None)
    runner.write(runner.run(settings, print), Path(snakemake.output.report).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
