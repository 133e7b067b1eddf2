"""Diagnose a study of real recordings, and draw what was found."""

import functools
from pathlib import Path

from palpate.configuration.study_file import load_study
from palpate.data.study_recordings import check
from palpate.output.saved_set import SavedSet
from palpate.output.written_figures import write_figures
from palpate.workflow_support import job
from palpate.workflow_support.result_files import write_json
from studies.real.diagnose_source import diagnose_source


def main(snakemake):
    study, output = load_study(snakemake.input.study, data=snakemake.params.data), snakemake.output
    name = snakemake.wildcards.recordings
    content, curves = diagnose_source(study, functools.partial(job.note, snakemake.log[0]))
    write_json(output.result, content)
    curves.to_csv(output.curves, index=False)
    saved = SavedSet(study, name, check(study, name), {}, {}, content, curves)
    write_figures([saved], Path(output.figures), ("svg", "png"))


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
