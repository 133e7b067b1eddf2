"""Open the seals and put the scores of all sets together."""

from palpate.configuration.settings import CalibrationSettings
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies.coverage import score
from studies.coverage.sets import Case


def main(snakemake):
    cases = {values["name"]: Case(**values) for file in snakemake.input.truths for values in read_json(file)}
    table = score.table(cases, [row for file in snakemake.input.fits for row in read_json(file)])
    table.to_csv(snakemake.output.sets, index=False)
    summary = score.summary(table[table["law_error"] == CalibrationSettings().law_error])
    summary.to_csv(snakemake.output.summary, index=False)
    score.of_law_errors(table).to_csv(snakemake.output.law_errors)
    print(summary.to_string(index=False, float_format="{:.3f}".format))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
