"""Open the seal for some cases and score their diagnoses."""

from pathlib import Path

from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json, write_json
from studies.blind_trial.cases import Case
from studies.blind_trial.trial import score_case


def main(snakemake):
    study = job.study(snakemake)
    truths = read_json(snakemake.input.truth)
    rows = []
    for folder in map(Path, snakemake.input.recordings):
        case = Case(**next(truth for truth in truths if truth["name"] == folder.name))
        diagnosis = Path(snakemake.input.diagnoses) / f"{folder.name}.json"
        rows.append(score_case(study, case, diagnosis, folder))
    write_json(snakemake.output[0], rows)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
