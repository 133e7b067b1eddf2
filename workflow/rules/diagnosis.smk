# What every mechanism does to a curve, computed once for a study, and the diagnosis of each set of recordings.
EFFECT_BATCHES = design.plan(STUDY) if STUDY.diagnosis["enabled"] else []

for number, batch in enumerate(EFFECT_BATCHES):

    rule:
        name:
            batch.name
        output:
            batch.files,
        log:
            f"{FOLDER}/logs/effects/{batch.name}.log",
        conda:
            "../../envs/palpate.yaml"
        params:
            study=STUDY_FILE,
            data=DATA,
            batch=batch.name,
            effects=True,
        message:
            f"{batch.name}: {len(batch.files)} simulations, batch {number + 1} of {len(EFFECT_BATCHES)}"
        script:
            "../../scripts/snapshots.py"


rule effects:
    input:
        lambda wildcards: [
            file
            for batch in EFFECT_BATCHES
            for file in batch.under(wildcards.condition)
        ],
    output:
        model=f"{FOLDER}/effects/{{condition}}.joblib",
        summary=f"{FOLDER}/effects/{{condition}}.json",
    log:
        f"{FOLDER}/logs/effects_{{condition}}.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        study=STUDY_FILE,
        data=DATA,
        folder=f"{FOLDER}/effects/{{condition}}",
        settings=STUDY.diagnosis,
        code=SURROGATE_CODE + DIAGNOSIS_CODE,
    script:
        "../../scripts/effects.py"


rule diagnosis:
    input:
        tracking=f"{FOLDER}/.tracking",
        recordings=lambda wildcards: files_of(STUDY, wildcards.recordings),
        surrogates=expand(f"{FOLDER}/surrogates/{{name}}.joblib", name=CALIBRATED),
        effects=expand(f"{FOLDER}/effects/{{name}}.joblib", name=CALIBRATED),
    output:
        result=f"{FOLDER}/{{recordings}}/diagnosis.json",
        curves=f"{FOLDER}/{{recordings}}/diagnosis.curves.csv",
        page=f"{FOLDER}/{{recordings}}/diagnosis.html",
        figure=f"{FOLDER}/{{recordings}}/figures/diagnosis.png",
    log:
        f"{FOLDER}/logs/diagnosis_{{recordings}}.log",
    conda:
        "../../envs/palpate.yaml"
    resources:
        mlflow_db=1,
    params:
        study=STUDY_FILE,
        data=DATA,
        title=STUDY.title,
        conditions=CALIBRATED,
        settings=[STUDY.diagnosis, STUDY.calibration],
        seed=STUDY.seed,
        curves=curves(STUDY.cells[0], None),
        code=DIAGNOSIS_CODE + FIGURE_CODE,
    script:
        "../../scripts/diagnosis.py"
