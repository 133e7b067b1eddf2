"""Diagnose some cases of the trial."""

import functools
import time
from pathlib import Path

from palpate.workflow_support import job
from palpate.workflow_support.result_files import write_json
from studies.blind_trial.trial import diagnose_case


def main(snakemake):
    study = job.study(snakemake)
    report = functools.partial(job.note, snakemake.log[0])
    for folder in map(Path, snakemake.input.recordings):
        begin = time.process_time()
        report(folder.name)
        content, _ = diagnose_case(study, folder, report)
        content["cpu_seconds"] = time.process_time() - begin
        write_json(Path(snakemake.output[0]) / f"{folder.name}.json", content)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
