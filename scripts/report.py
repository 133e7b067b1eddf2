"""Write the report of a study, and the checksums of the files behind it.

input: every result of the study that it shows. output: report (HTML), answers (JSON: the first screen), manifest
(JSON), record (JSON: the runs for MLflow). settings: `title`, `source`.
"""

from pathlib import Path

from palpate.workflow_support import job, manifest, study_report
from palpate.workflow_support.result_files import write_json
from palpate.workflow_support.run_records import tracked_runs
from palpate.workflow_support.runs_of_results import of_sets


def main(snakemake):
    study, output = job.study(snakemake), snakemake.output
    folder = Path(output.report).parent
    with tracked_runs(study.name, output.record) as record:
        made_from = manifest.of(study, job.plain(snakemake.config), folder)
        write_json(output.manifest, made_from)
        of_sets(record, study_report.write(study, folder, made_from), folder)


if "snakemake" in globals():
    with job.logged(snakemake.log[0], snakemake.output, snakemake.rule):  # noqa: F821
        main(snakemake)  # noqa: F821
