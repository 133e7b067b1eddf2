# Figures and the report, from saved results alone.
RECORDS = [
    *([f"{FOLDER}/tracking/law.json"] if STUDY.family else []),
    *expand(f"{FOLDER}/tracking/surrogates/{{name}}.json", name=CALIBRATED),
    *expand(
        f"{FOLDER}/tracking/{{recordings}}/calibrations/{{name}}.json",
        recordings=STUDY.recordings,
        name=STUDY.condition_sets,
    ),
    *expand(f"{FOLDER}/tracking/{{name}}/diagnosis.json", name=DIAGNOSED),
    f"{FOLDER}/tracking/report.json",
]
RESULTS = [
    *LAW,
    f"{FOLDER}/snapshots.csv",
    *expand(
        f"{FOLDER}/surrogates/{{name}}.{{kind}}", name=CALIBRATED, kind=["npz", "json"]
    ),
    *expand(f"{FOLDER}/{{name}}/calibration.json", name=STUDY.recordings),
    *expand(
        f"{FOLDER}/{{recordings}}/calibrations/{{name}}.{{kind}}",
        recordings=STUDY.recordings,
        name=STUDY.condition_sets,
        kind=["json", "curves.csv"],
    ),
    *expand(
        f"{FOLDER}/{{name}}/diagnosis.{{kind}}",
        name=DIAGNOSED,
        kind=["json", "curves.csv"],
    ),
    *INSTRUMENT,
]


# Marked for snakemake --report, which shows each figure with its caption.
rule figures:
    input:
        RESULTS,
        all_recordings,
    output:
        report(
            directory(f"{FOLDER}/figures"),
            patterns=["{figure}.svg"],
            caption="../report/figure.rst",
            category="Figures",
        ),
    log:
        f"{FOLDER}/logs/figures.log",
    localrule: True
    conda:
        "../../envs/palpate.yaml"
    params:
        captions=captions(),
        laboratory=constant(STUDY.laboratory),
        code=code("scripts/figures.py"),
    message:
        "figures"
    script:
        "../../scripts/figures.py"


rule report:
    input:
        RESULTS,
        all_recordings,
        f"{FOLDER}/figures",
    output:
        report=f"{FOLDER}/report.html",
        answers=f"{FOLDER}/report.json",
        manifest=f"{FOLDER}/report.manifest.json",
        record=f"{FOLDER}/tracking/report.json",
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
