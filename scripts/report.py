"""Write the report of a study, and the checksums of the files behind it.

input: every result of the study that it shows. output: report (HTML), manifest (JSON). settings: `title`, `source`.
"""

from pathlib import Path

from palpate.workflow_support import job, manifest, study_report
from palpate.workflow_support.result_files import write_json


def main(snakemake):
    study, report = job.study(snakemake), Path(snakemake.output.report)
    made_from = manifest.of(study, job.plain(snakemake.config), report.parent)
    write_json(snakemake.output.manifest, made_from)
    study_report.write(study, report.parent, report, made_from)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
