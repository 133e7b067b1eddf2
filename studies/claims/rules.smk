# How often claims are true, in closed form, in resumable groups; of some of the sets by --config sets=N:
# snakemake --cores 2 claims
from studies.claims import COUNT, GROUP

CLAIMS = "results/claims"
CLAIMS_GROUPS = range(int(config.get("sets", COUNT)) // GROUP)
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
