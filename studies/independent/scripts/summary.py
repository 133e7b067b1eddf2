"""Open the seal and put the scores of all sets together."""

from pathlib import Path

import pandas as pd

from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies.blind_trial.cases import Case
from studies.independent import score


def main(snakemake):
    cases = {values["name"]: Case(**values) for values in read_json(snakemake.input.truth)}
    files = [file for folder in snakemake.input.diagnoses for file in sorted(Path(folder).glob("*.json"))]
    table = pd.DataFrame([score.row(cases[file.stem], read_json(file)) for file in files])
    table.to_csv(snakemake.output.sets, index=False)
    score.by_body(table).to_csv(snakemake.output.bodies)
    summary = score.summary(table)
    summary.to_csv(snakemake.output.summary, index=False)
    print(summary.to_string(index=False, float_format="{:.3f}".format))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
