"""Fit a group of sets, every few of them with half and double the default of the law's discrepancy, too."""

from palpate.configuration.settings import CalibrationSettings
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json, write_json
from studies.coverage import EVERY, LAW_ERRORS
from studies.coverage.fits import fitted
from studies.coverage.sets import Case


def main(snakemake):
    rows, default = [], [CalibrationSettings().law_error]
    for place, values in enumerate(read_json(snakemake.input[0])):
        rows += [fitted(Case(**values), each) for each in (LAW_ERRORS if place % EVERY == 0 else default)]
        job.note(snakemake.log[0], values["name"])
    write_json(snakemake.output[0], rows)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
