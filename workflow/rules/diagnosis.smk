# The diagnosis of each set of recordings; its search begins where calibration ended.
rule diagnosis:
    input:
        tracking=f"{FOLDER}/.tracking",
        recordings=lambda wildcards: files_of(STUDY, wildcards.recordings),
        calibration=f"{FOLDER}/{{recordings}}/calibration.json",
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
        settings=[STUDY.diagnosis, STUDY.calibration],
        seed=STUDY.seed,
        curves=curves(STUDY.cells[0], None),
        code=code("scripts/diagnosis.py"),
    script:
        "../../scripts/diagnosis.py"
