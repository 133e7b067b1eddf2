# The blind trial: the truth is sealed first, the diagnosis never reads it, and the score opens it last.
from studies.blind_trial.cases import divided, draw

TRIAL = f"{FOLDER}/trial"
RECORDED = (
    [f"{TRIAL}/recordings/{case.name}" for case in draw(STUDY)]
    if "challenge" in config
    else []
)
WRITTEN = divided(RECORDED, 48)  # many simulations together share SIMD lanes
GROUPS = divided(RECORDED, 8)


rule challenge:
    input:
        f"{TRIAL}/summary.csv",


rule sealed_truth:
    output:
        truth=f"{TRIAL}/sealed.json",
        checksum=f"{TRIAL}/checksum.txt",
    log:
        f"{FOLDER}/logs/sealed_truth.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        settings=constant(STUDY.challenge),
        code=code("studies/blind_trial/scripts/seal.py"),
    script:
        "scripts/seal.py"


for group, folders in WRITTEN.items():

    rule:
        name:
            f"trial_recordings_{group}"
        output:
            [directory(folder) for folder in folders],
        log:
            f"{FOLDER}/logs/trial/{group}_recordings.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            settings=constant(STUDY.challenge),
            code=code("studies/blind_trial/scripts/recordings.py"),
        message:
            f"{len(folders)} sets of recordings, {group} of {len(WRITTEN)}"
        script:
            "scripts/recordings.py"


rule trial_diagnoses:
    input:
        checksum=f"{TRIAL}/checksum.txt",
        recordings=lambda wildcards: GROUPS[wildcards.group],
    output:
        directory(f"{TRIAL}/diagnoses/{{group}}"),
    log:
        f"{FOLDER}/logs/trial/{{group}}_diagnoses.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        settings=constant([STUDY.diagnosis, STUDY.calibration]),
        code=code("studies/blind_trial/scripts/diagnoses.py"),
    script:
        "scripts/diagnoses.py"


rule trial_scores:
    input:
        truth=f"{TRIAL}/sealed.json",
        diagnoses=f"{TRIAL}/diagnoses/{{group}}",
        recordings=lambda wildcards: GROUPS[wildcards.group],
    output:
        f"{TRIAL}/scores/{{group}}.json",
    log:
        f"{FOLDER}/logs/trial/{{group}}_scores.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/blind_trial/scripts/scores.py"),
    script:
        "scripts/scores.py"


rule trial_summary:
    input:
        expand(f"{TRIAL}/scores/{{group}}.json", group=GROUPS),
    output:
        summary=f"{TRIAL}/summary.csv",
        cases=f"{TRIAL}/cases.csv",
        reliability=f"{TRIAL}/reliability.csv",
        figure=f"{TRIAL}/power.png",
    log:
        f"{FOLDER}/logs/trial_summary.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("studies/blind_trial/scripts/summary.py"),
    script:
        "scripts/summary.py"
