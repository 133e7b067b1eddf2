"""Write the recordings of a group of sets, and diagnose them."""

import functools
import tempfile
import time
from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json, write_json
from studies.blind_trial.cases import Case
from studies.blind_trial.trial import diagnose_case
from studies.independent import GROUP
from studies.independent.recordings import write


def main(snakemake):
    study, first = load_study(Path(snakemake.input.study)), GROUP * int(snakemake.wildcards.group)
    report = functools.partial(job.note, snakemake.log[0])
    for values in read_json(snakemake.input.truth)[first : first + GROUP]:
        case, begin = Case(**values), time.process_time()
        report(case.name)
        with tempfile.TemporaryDirectory() as folder:
            write(study, case, Path(snakemake.params.curves), Path(folder))
            content, _ = diagnose_case(study, Path(folder), report)
        content["cpu_seconds"] = time.process_time() - begin
        write_json(Path(snakemake.output[0]) / f"{case.name}.json", content)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
