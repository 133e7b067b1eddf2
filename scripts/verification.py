"""Verify the solver and write the report."""

import shutil
from pathlib import Path

from palpate.verification import runner
from palpate.verification.case import Settings
from palpate.workflow_support import job


def main(snakemake):
    parameters = snakemake.params
    program = None if parameters.quick else shutil.which("ccx")
    reference = Path(parameters.reference) if parameters.reference else None
    settings = Settings(bool(parameters.quick), Path(program) if program else None, reference)
    runner.write(runner.run(settings, print), Path(snakemake.output.report).parent)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
