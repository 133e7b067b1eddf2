"""Open the seal for one case and score its diagnosis."""

import json
from pathlib import Path

from palpate.challenge.cases import Case
from palpate.challenge.trial import score_case
from palpate.config import load_study
from palpate.steps import write_json


def main(snakemake):
    study, names = load_study(snakemake.params.study), snakemake.params.conditions
    base = dict(zip(names, snakemake.input.surrogates, strict=True))
    effects = dict(zip(names, snakemake.input.effects, strict=True))
    truths = json.loads(Path(snakemake.input.truth).read_text(encoding="utf-8"))
    case = Case(**next(truth for truth in truths if truth["name"] == snakemake.wildcards.case))
    paths = Path(snakemake.input.diagnosis), Path(snakemake.input.recordings)
    write_json(snakemake.output[0], score_case(study, case, *paths, base, effects))


if "snakemake" in globals():
    main(snakemake)  # noqa: F821
