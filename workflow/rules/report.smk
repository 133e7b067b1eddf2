# Tables, figures and the report, from saved results alone.
RECORDS = [
    *expand(f"{FOLDER}/tracking/surrogates/{{name}}.json", name=CALIBRATED),
    *expand(
        f"{FOLDER}/tracking/{{recordings}}/calibrations/{{name}}.json",
        recordings=STUDY.recordings,
        name=STUDY.condition_sets,
    ),
    *expand(f"{FOLDER}/tracking/{{name}}/diagnosis.json", name=DIAGNOSED),
]
RESULTS = [
    f"{FOLDER}/snapshots.csv",
    *expand(
        f"{FOLDER}/surrogates/{{name}}.{{kind}}", name=CALIBRATED, kind=["npz", "json"]
    ),
    f"{FOLDER}/figures/surrogates.png",
    *expand(
        f"{FOLDER}/{{recordings}}/{{file}}",
        recordings=STUDY.recordings,
        file=[
            "calibration.json",
            "errors.csv",
            "parameters.csv",
            "figures/parameters.png",
            "figures/convergence.png",
            *(f"calibrations/{name}.json" for name in STUDY.condition_sets),
            *(f"calibrations/{name}.curves.csv" for name in STUDY.condition_sets),
            *(f"figures/fit_{name}.png" for name in STUDY.condition_sets),
        ],
    ),
    *expand(
        f"{FOLDER}/{{recordings}}/{{file}}",
        recordings=DIAGNOSED,
        file=[
            "diagnosis.json",
            "diagnosis.html",
            "diagnosis.curves.csv",
            "figures/diagnosis.png",
        ],
    ),
]


rule tables:
    input:
        calibrations=expand(
            f"{FOLDER}/{{{{recordings}}}}/calibrations/{{name}}.json",
            name=STUDY.condition_sets,
        ),
    output:
        errors=f"{FOLDER}/{{recordings}}/errors.csv",
        parameters=f"{FOLDER}/{{recordings}}/parameters.csv",
        figure=f"{FOLDER}/{{recordings}}/figures/parameters.png",
        convergence=f"{FOLDER}/{{recordings}}/figures/convergence.png",
    log:
        f"{FOLDER}/logs/tables/{{recordings}}.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    params:
        title=constant(STUDY.title),
        laboratory=constant(STUDY.laboratory),
        code=code("scripts/tables.py"),
    message:
        "tables and figures of {wildcards.recordings}"
    script:
        "../../scripts/tables.py"


rule report:
    input:
        RESULTS,
        all_recordings,
    output:
        report=f"{FOLDER}/report.html",
        manifest=f"{FOLDER}/report.manifest.json",
    log:
        f"{FOLDER}/logs/report.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    params:
        title=constant(STUDY.title),
        configuration=constant(manifest.without_data(job.plain(config))),
        code=code("scripts/report.py"),
    message:
        "report"
    script:
        "../../scripts/report.py"


rule tracking:
    input:
        RECORDS,
    output:
        f"{FOLDER}/tracking/receipt.json",
    log:
        f"{FOLDER}/logs/tracking.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    params:
        attempt=attempt(f"{FOLDER}/tracking/receipt.json"),
    message:
        "sending runs to MLflow"
    script:
        "../../scripts/tracking.py"
