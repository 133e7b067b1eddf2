# Tables, figures and the report, from saved results alone.
rule tables:
    input:
        calibrations=expand(
            f"{FOLDER}/{{{{recordings}}}}/calibrations/{{name}}.json",
            name=STUDY.condition_sets,
        ),
        main=f"{FOLDER}/{{recordings}}/calibration.json",
    output:
        errors=f"{FOLDER}/{{recordings}}/errors.csv",
        parameters=f"{FOLDER}/{{recordings}}/parameters.csv",
        figure=f"{FOLDER}/{{recordings}}/figures/parameters.png",
        convergence=f"{FOLDER}/{{recordings}}/figures/convergence.png",
    log:
        f"{FOLDER}/logs/tables_{{recordings}}.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        study=STUDY_FILE,
        data=DATA,
        title=STUDY.title,
        code=code("scripts/tables.py"),
    script:
        "../../scripts/tables.py"


rule surrogate_figure:
    input:
        expand(f"{FOLDER}/surrogates/{{condition}}.json", condition=CALIBRATED),
    output:
        f"{FOLDER}/figures/surrogates.png",
    log:
        f"{FOLDER}/logs/surrogate_figure.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        code=code("scripts/surrogate_figure.py"),
        title=f"Surrogates of {STUDY.title}",
    script:
        "../../scripts/surrogate_figure.py"


rule report:
    input:
        index=f"{FOLDER}/snapshots.csv",
        surrogates=f"{FOLDER}/figures/surrogates.png",
        tables=expand(
            f"{FOLDER}/{{name}}/{{file}}.csv",
            name=STUDY.recordings,
            file=["errors", "parameters"],
        ),
        diagnoses=expand(f"{FOLDER}/{{name}}/diagnosis.json", name=DIAGNOSED),
    output:
        f"{FOLDER}/report.html",
    log:
        f"{FOLDER}/logs/report.log",
    conda:
        "../../envs/palpate.yaml"
    params:
        study=STUDY_FILE,
        data=DATA,
        title=STUDY.title,
        source=STUDY.source,
        code=code("scripts/report.py"),
    script:
        "../../scripts/report.py"
