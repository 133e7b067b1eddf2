"""Diagnose one case of the trial."""

from pathlib import Path

from palpate.challenge.trial import diagnose_case
from palpate.config import load_study
from palpate.steps import write_json


def main(snakemake):
    study, names = load_study(snakemake.params.study), snakemake.params.conditions
    base = dict(zip(names, snakemake.input.surrogates, strict=True))
    effects = dict(zip(names, snakemake.input.effects, strict=True))
    with open(snakemake.log[0], "w", encoding="utf-8", buffering=1) as log:
        folder = Path(snakemake.input.recordings)
        content, _ = diagnose_case(study, folder, base, effects, lambda line: print(line, file=log))
    write_json(snakemake.output[0], content)


if "snakemake" in globals():
    main(snakemake)  # noqa: F821
