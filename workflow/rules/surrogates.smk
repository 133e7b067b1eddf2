# One surrogate a condition, and the store that MLflow keeps them in.
SNAPSHOTS = {
    condition: [file for batch in BATCHES for file in batch.under(condition)]
    for condition in CALIBRATED
}


rule tracking_store:
    output:
        touch(f"{FOLDER}/.tracking"),
    log:
        f"{FOLDER}/logs/tracking_store.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        study=STUDY.name,
    script:
        "../../scripts/tracking_store.py"


rule surrogate:
    input:
        tracking=f"{FOLDER}/.tracking",
        snapshots=lambda wildcards: SNAPSHOTS[wildcards.condition],
    output:
        model=f"{FOLDER}/surrogates/{{condition}}.joblib",
        summary=f"{FOLDER}/surrogates/{{condition}}.json",
    log:
        f"{FOLDER}/logs/surrogate_{{condition}}.log",
    conda:
        "../../envs/palpate.yaml"
    resources:
        mlflow_db=1,
    params:
        study=STUDY_FILE,
        data=DATA,
        settings=STUDY.surrogate,
        levels=STUDY.levels,
        code=code("scripts/surrogate.py"),
    script:
        "../../scripts/surrogate.py"
