# Recordings from curves of another finite-element code, in resumable groups:
# snakemake --cores 2 independent --config data=FOLDER
from studies.independent import DRAWS, GROUP
from studies.independent.bodies import BODIES

INDEPENDENT = "results/independent"
INDEPENDENT_GROUPS = range(-(-2 * DRAWS * len(BODIES) // GROUP))


rule independent:
    input:
        f"{INDEPENDENT}/summary.csv",


rule independent_truth:
    output:
        f"{INDEPENDENT}/sealed.json",
    log:
        f"{INDEPENDENT}/logs/truth.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/independent/scripts/seal.py"),
    script:
        "scripts/seal.py"


rule independent_diagnoses:
    input:
        truth=f"{INDEPENDENT}/sealed.json",
        study=f"{HERE}/config/challenge.yaml",
    output:
        directory(f"{INDEPENDENT}/diagnoses/{{group}}"),
    log:
        f"{INDEPENDENT}/logs/{{group}}_diagnoses.log",
    wildcard_constraints:
        group=r"\d+",
    conda:
        "../../envs/palpate.yaml"
    params:
        curves=config.get("data", "data"),
        code=code("studies/independent/scripts/diagnoses.py"),
    script:
        "scripts/diagnoses.py"


rule independent_summary:
    input:
        truth=f"{INDEPENDENT}/sealed.json",
        diagnoses=expand(f"{INDEPENDENT}/diagnoses/{{group}}", group=INDEPENDENT_GROUPS),
    output:
        summary=f"{INDEPENDENT}/summary.csv",
        bodies=f"{INDEPENDENT}/bodies.csv",
        sets=f"{INDEPENDENT}/sets.csv",
    log:
        f"{INDEPENDENT}/logs/summary.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/independent/scripts/summary.py"),
    script:
        "scripts/summary.py"
