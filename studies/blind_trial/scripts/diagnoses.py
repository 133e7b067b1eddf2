"""Diagnose some cases of the trial."""

import time
from pathlib import Path

from palpate.workflow_support import job
from palpate.workflow_support.result_files import write_json
from studies.blind_trial.trial import diagnose_case


def main(snakemake):
    study = job.study(snakemake)
    with open(snakemake.log[0], "w", encoding="utf-8", buffering=1) as log:
        for folder in map(Path, snakemake.input.recordings):
            begin = time.process_time()
            print(folder.name, file=log)
            content, _ = diagnose_case(study, folder, lambda line: print(line, file=log))
            content["cpu_seconds"] = time.process_time() - begin
            write_json(Path(snakemake.output[0]) / f"{folder.name}.json", content)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
