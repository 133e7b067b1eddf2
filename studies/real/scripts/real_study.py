"""Diagnose a study of real recordings, draw what was found, and write its page."""

import functools

from palpate.configuration.study_file import load_study
from palpate.output import diagnosis_page as page
from palpate.output.figures import explained_curves, style
from palpate.workflow_support import job
from palpate.workflow_support.result_files import write_json
from studies.real.diagnose_source import diagnose_source


def main(snakemake):
    study = load_study(snakemake.input.study, data=snakemake.params.data)
    content, curves = diagnose_source(study, functools.partial(job.note, snakemake.log[0]))
    write_json(snakemake.output.result, content)
    curves.to_csv(snakemake.output.curves, index=False)
    style.write(snakemake.output.figure, explained_curves.compose, content, curves, study.title, False)
    page.write(content, study.declared, snakemake.output.figure, snakemake.output.page, study.title)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
