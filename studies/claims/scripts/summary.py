"""Open the seals and put the scores of the sets together whose groups were diagnosed."""

from pathlib import Path

import pandas as pd

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json, write_json
from studies.claims import score
from studies.claims.sets import Case


def main(snakemake):
    smallest = load_study(Path(snakemake.input.study)).diagnosis.smallest_effect
    cases = {values["name"]: Case(**values) for file in snakemake.input.truths for values in read_json(file)}
    stated = [each for file in snakemake.input.diagnoses for each in read_json(file)]
    table = pd.DataFrame([score.row(cases[each["name"]], each, smallest) for each in stated])
    families = pd.DataFrame([row for each in stated for row in score.inclusions(cases[each["name"]], each, smallest)])
    table.to_csv(snakemake.output.sets, index=False)
    summary = score.summary(table)
    summary.to_csv(snakemake.output.summary, index=False)
    write_json(snakemake.output.calibration, score.calibration(families))
    score.reliability(families).to_csv(snakemake.output.reliability, index=False)
    score.class_scores(table).to_csv(snakemake.output.classes)
    print(summary.to_string(index=False, float_format="{:.3f}".format))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
