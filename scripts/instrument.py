"""Keep what a diagnosis found of the effects that other studies on the same instrument share.

input: diagnosis, recordings (CSV). output: the joint posterior and what it rests on (JSON).
"""

from pathlib import Path

from palpate.configuration.instrument_section import instrument_record
from palpate.workflow_support import job
from palpate.workflow_support.result_files import read_json, write_json


def main(snakemake):
    study, (diagnosis,) = job.study(snakemake), snakemake.input.diagnosis
    files = map(Path, snakemake.input.recordings)
    found = read_json(diagnosis)["instrument"]
    write_json(snakemake.output[0], instrument_record(study.name, study.instrument, found, files))


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
