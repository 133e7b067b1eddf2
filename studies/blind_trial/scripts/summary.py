"""Put the scores of all cases together."""

import pandas as pd

from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json
from studies.blind_trial import power_figure, score


def main(snakemake):
    table = pd.DataFrame([row for file in snakemake.input for row in read_json(file)])
    table.to_csv(snakemake.output.cases, index=False)
    score.summary(table).to_csv(snakemake.output.summary, index=False)
    score.reliability(table).to_csv(snakemake.output.reliability)
    kinds = {"all cases": table, "single effects": table[table["kind"] == "one"]}
    power_figure.draw(table, {name: score.reliability(part) for name, part in kinds.items()}, snakemake.output.figure)
    print(score.summary(table).to_string(index=False), f"\nBrier score {score.brier(table):.3f}")


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
