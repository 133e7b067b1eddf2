"""Make the MLflow store and this execution's parent run before several jobs write to it."""

from palpate.workflow_support import job, tracking


def main(snakemake):
    tracking.connect(snakemake.params.study)
    tracking.parent_run(snakemake.params.study)


if "snakemake" in globals():
    with job.logged(snakemake.log[0]):  # noqa: F821
        main(snakemake)  # noqa: F821
