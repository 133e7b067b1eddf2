# How often claims are true, in closed form, in resumable groups: snakemake --cores 2 claims
# Of the groups that are there already: snakemake --cores 2 claims_so_far
from pathlib import Path

from studies.claims import COUNT, GROUP

CLAIMS = "results/claims"
CLAIMS_GROUPS = range(COUNT // GROUP)
CLAIMS_DONE = sorted(
    int(file.stem) for file in Path(f"{CLAIMS}/diagnoses").glob("*.json")
)
CLAIMS_STUDY = f"{HERE}/config/challenge.yaml"  # whose settings a diagnosis has


rule claims:
    input:
        f"{CLAIMS}/summary.csv",


rule claims_truth:
    output:
        f"{CLAIMS}/sealed/{{group}}.json",
    log:
        f"{CLAIMS}/logs/{{group}}_truth.log",
    wildcard_constraints:
        group=r"\d+",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/claims/scripts/seal.py"),
    script:
        "scripts/seal.py"


rule claims_diagnoses:
    input:
        truth=f"{CLAIMS}/sealed/{{group}}.json",
        study=CLAIMS_STUDY,
    output:
        f"{CLAIMS}/diagnoses/{{group}}.json",
    log:
        f"{CLAIMS}/logs/{{group}}_diagnoses.log",
    wildcard_constraints:
        group=r"\d+",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/claims/scripts/diagnoses.py"),
    script:
        "scripts/diagnoses.py"


rule claims_summary:
    input:
        study=CLAIMS_STUDY,
        truths=expand(f"{CLAIMS}/sealed/{{group}}.json", group=CLAIMS_GROUPS),
        diagnoses=expand(f"{CLAIMS}/diagnoses/{{group}}.json", group=CLAIMS_GROUPS),
    output:
        summary=f"{CLAIMS}/summary.csv",
        sets=f"{CLAIMS}/sets.csv",
        calibration=f"{CLAIMS}/calibration.json",
        reliability=f"{CLAIMS}/reliability.csv",
        classes=f"{CLAIMS}/classes.csv",
    log:
        f"{CLAIMS}/logs/summary.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/claims/scripts/summary.py"),
    script:
        "scripts/summary.py"


use rule claims_summary as claims_so_far with:
    input:
        study=CLAIMS_STUDY,
        truths=expand(f"{CLAIMS}/sealed/{{group}}.json", group=CLAIMS_DONE),
        diagnoses=expand(f"{CLAIMS}/diagnoses/{{group}}.json", group=CLAIMS_DONE),
    output:
        summary=f"{CLAIMS}/so_far/summary.csv",
        sets=f"{CLAIMS}/so_far/sets.csv",
        calibration=f"{CLAIMS}/so_far/calibration.json",
        reliability=f"{CLAIMS}/so_far/reliability.csv",
        classes=f"{CLAIMS}/so_far/classes.csv",
    log:
        f"{CLAIMS}/logs/so_far.log",
